//! pid: do the clocks of pose and tunnel speed agree? In: records. Out: by how much V_W is late, with its error.
//!
//! A model that is held up by its drag shows the speed of the air: its weight alone fixes how speed and acceleration go together,
//! `V_W + v_x = K √(1 − a_x/g)`, whatever its drag coefficient is. The constant `K` of each run, and its change with the angle of attack,
//! are fitted at every lag; the lag at which the recorded V_W follows that speed best is the offset of the clocks.
//!
//! The offset is believed where the speeds of both lags, asked together, say so (Davidson and MacKinnon 1981): the share θ of the speed at
//! the offset, beside that at the declared lag, is above one half by more than chance leaves. Without variation of V_W its noise alone makes
//! θ one half. And the offset explains at least three quarters of the variance that the declared lag leaves: otherwise something else is wrong.

use super::contest::CLOSED;
use super::motion::{FEWEST, HALF_S, SLOWEST_S, weights};
use super::{GrossFault, short};
use serde::{Deserialize, Serialize};
use statrs::distribution::{ContinuousCDF, StudentsT};
use std::collections::BTreeMap;
use windfall_model::Record;

/// Interval of the instants that are looked at, s: a fourteenth of a window of the motion.
const EVERY_S: f64 = 0.05;
/// Step of the lags that are tried, s: the same.
const STEP_S: f64 = 0.05;
/// Length of a block within which residuals may go together, s: two of the tunnel's slowest motions of 1 Hz.
const BLOCK_S: f64 = 2.0;
/// Lags this near the declared one are no slip of clocks, s: twice what gusts and undeclared effects moved the best lag by (measured:
/// 0.1 s at most on 27 campaigns of two simulators). The likelihood finds such delays from nothing.
const NEAR_S: f64 = 0.2;
/// Share of a run up to which a lag is looked for.
const LONGEST: f64 = 1.0 / 3.0;
/// Fewest instants of a run at a lag.
const FEWEST_INSTANTS: usize = 40;
/// Least root mean square of the change of sin²α_T that counts as one: 3° all along.
const LEAST_ANGLES: f64 = 2e-3;
/// Chance of an offset in a record without one, all lags together (chosen).
const FALSE_ALARM: f64 = 1e-4;

/// Whether a declared lag is one that the record is set to one clock for.
pub(super) fn is_far(lag_s: f64) -> bool {
    lag_s.abs() > NEAR_S
}

/// How much later than the pose the tunnel speed was recorded.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Lag {
    /// Offset, s: the recorded V_W is that of so long ago where the pose is current; negative: V_W is early, or the pose late.
    pub lag_s: f64,
    /// Standard error, s.
    pub std_error_s: f64,
    /// What is left between recorded speed and the speed that the accelerations ask for: at the declared lag and at this one, root mean
    /// square, m/s.
    pub left_m_s: [f64; 2],
}

impl Lag {
    /// In words: `1.800 ± 0.006 s late`.
    #[must_use]
    pub fn words(&self) -> String {
        let side = if self.lag_s > 0.0 { "late" } else { "early" };
        format!("{:.3} ± {:.3} s {side}", self.lag_s.abs(), self.std_error_s)
    }
    /// Where the V_W that belongs to a pose stands: later in the file, or earlier.
    #[must_use]
    pub fn side(&self) -> &'static str {
        if self.lag_s > 0.0 { "later" } else { "earlier" }
    }
    /// What speaks for it.
    #[must_use]
    pub fn evidence(&self) -> String {
        let [declared, here] = self.left_m_s.map(short);
        format!(
            "the speed that the vertical accelerations ask for is then within {here} m/s (rms) of V_W, as declared within {declared} m/s"
        )
    }
}

/// One run: what its pose asks of the speed, and the speed as recorded.
struct Asked {
    interval_s: f64,
    /// V_W and its rate at every sample, smoothed as the pose is; the first and last `margin` have none.
    speed: Vec<[f64; 2]>,
    margin: usize,
    instants: Vec<Instant>,
}

/// One instant of the pose.
struct Instant {
    sample: usize,
    /// Vertical speed, m/s, X down.
    down_m_s: f64,
    /// √(1 − a_x/g), and the same times the square of the sine of the total angle between body and tunnel.
    by: [f64; 2],
}

/// What a run leaves at a lag: residual, slope of the speed by the lag with `by` taken out of both, and block.
struct Row {
    left: f64,
    slope: f64,
    block: usize,
}

impl Asked {
    /// None of a run whose clock or length lets nothing be said.
    fn new(r: &Record, gravity_m_s2: f64) -> Option<Self> {
        let dt = r.interval_s();
        if !(dt > 0.0 && dt <= SLOWEST_S && gravity_m_s2 > 0.0) {
            return None;
        }
        let window = |half_s: f64| -> Option<(usize, [Vec<f64>; 3])> {
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a positive count of samples")]
            let half = ((half_s / dt).round() as usize).max(FEWEST);
            (r.len() > 2 * half + 1).then(|| weights(half, dt).map(|w| (half, w)))?
        };
        let (wide, narrow) = (window(HALF_S[0])?, window(HALF_S[1])?);
        let margin = wide.0.max(narrow.0);
        let at = |x: &[f64], i: usize, (half, weights): &(usize, [Vec<f64>; 3])| {
            // Differences from the sample itself lose nothing to a large mean.
            let sum = |order: usize| weights[order].iter().zip(&x[i - half..]).map(|(w, v)| w * (v - x[i])).sum::<f64>();
            [x[i] + sum(0), sum(1), sum(2)]
        };
        let inside = margin..r.len() - margin;
        let speed = |i: usize| {
            let [value, rate, _] = if inside.contains(&i) { at(&r.vw_m_s, i, &wide) } else { [f64::NAN; 3] };
            [value, rate]
        };
        let instant = |i: usize| {
            let [_, down_m_s, rate] = at(&r.position_m[0], i, &wide);
            let cosines = [1, 2].map(|k| at(&r.attitude_rad[k], i, &narrow)[0].cos());
            let root = (1.0 - rate / gravity_m_s2).max(0.0).sqrt();
            Instant { sample: i, down_m_s, by: [root, root * (1.0 - (cosines[0] * cosines[1]).powi(2))] }
        };
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a positive count of samples")]
        let stride = ((EVERY_S / dt).round() as usize).max(1);
        Some(Self {
            interval_s: dt,
            speed: (0..r.len()).map(speed).collect(),
            margin,
            instants: inside.clone().step_by(stride).map(instant).collect(),
        })
    }

    fn duration_s(&self) -> f64 {
        self.interval_s * self.speed.len() as f64
    }

    /// Speed and rate that were recorded a lag after a sample; none beyond what is smoothed.
    fn speed_at(&self, sample: usize, lag_s: f64) -> Option<[f64; 2]> {
        let x = sample as f64 + lag_s / self.interval_s;
        if x < self.margin as f64 || x > (self.speed.len() - 1 - self.margin) as f64 {
            return None;
        }
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between 0 and the last sample")]
        let i = x as usize;
        let s = x - i as f64;
        let (a, b) = (self.speed[i], if s > 0.0 { self.speed[i + 1] } else { self.speed[i] });
        Some([0, 1].map(|k| a[k] + s * (b[k] - a[k])))
    }

    /// Residuals at a lag, over the instants at which all of these lags have a speed; `slope` from that speed and rate. Empty where they are few.
    fn rows(&self, lag_s: f64, all: &[f64], slope: impl Fn(&Instant, [f64; 2]) -> f64) -> Vec<Row> {
        let seen: Vec<(&Instant, [f64; 2])> = self
            .instants
            .iter()
            .filter(|i| all.iter().all(|l| self.speed_at(i.sample, *l).is_some()))
            .filter_map(|i| Some((i, self.speed_at(i.sample, lag_s)?)))
            .collect();
        if seen.len() < FEWEST_INSTANTS {
            return Vec::new();
        }
        let by = |k: usize| seen.iter().map(|(i, _)| i.by[k]).collect::<Vec<f64>>();
        let first = unit(by(0), 0.0);
        // Without angles the second is none.
        let second = unit(without(by(1), &first), LEAST_ANGLES * (seen.len() as f64).sqrt());
        let clean = |x: Vec<f64>| without(without(x, &first), &second);
        let y = clean(seen.iter().map(|(i, [v, _])| v + i.down_m_s).collect());
        let x = clean(seen.iter().map(|(i, v)| slope(i, *v)).collect());
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a positive count of blocks")]
        let block = |i: usize| (seen[i].0.sample as f64 * self.interval_s / BLOCK_S) as usize;
        (0..seen.len()).map(|i| Row { left: y[i], slope: x[i], block: block(i) }).collect()
    }

    /// Logarithm of likelihood at a lag over that at another, on the same instants.
    fn gain(&self, lag_s: f64, other_s: f64) -> f64 {
        if lag_s.abs() > LONGEST * self.duration_s() {
            return 0.0;
        }
        let both = [lag_s, other_s];
        let rows = |lag: f64| self.rows(lag, &both, |_, _| 0.0);
        let (here, there) = (rows(lag_s), rows(other_s));
        let square = |rows: &[Row]| rows.iter().map(|r| r.left * r.left).sum::<f64>();
        let independent = here.len() as f64 * EVERY_S * super::balance::PER_S;
        let gain = 0.5 * independent * (square(&there) / square(&here)).ln();
        if gain.is_finite() { gain } else { 0.0 }
    }
}

/// A vector over its length; zero where it is not longer than that.
fn unit(mut x: Vec<f64>, least: f64) -> Vec<f64> {
    let length = x.iter().map(|v| v * v).sum::<f64>().sqrt();
    let factor = if length > least { 1.0 / length } else { 0.0 };
    x.iter_mut().for_each(|v| *v *= factor);
    x
}

/// What is left of a vector without its part along a unit vector.
fn without(mut x: Vec<f64>, along: &[f64]) -> Vec<f64> {
    let part: f64 = x.iter().zip(along).map(|(x, a)| x * a).sum();
    x.iter_mut().zip(along).for_each(|(x, a)| *x -= part * a);
    x
}

/// Estimate of one slope over all runs, with a standard error for residuals that go together within a block, and degrees of freedom.
fn slope(runs: &[Vec<Row>]) -> Option<(f64, f64, f64)> {
    let sum = |f: &dyn Fn(&Row) -> f64| runs.iter().flatten().map(f).sum::<f64>();
    let information = sum(&|r| r.slope * r.slope);
    if information <= 0.0 {
        return None;
    }
    let estimate = sum(&|r| r.slope * r.left) / information;
    let mut blocks: BTreeMap<(usize, usize), f64> = BTreeMap::new();
    for (k, rows) in runs.iter().enumerate() {
        rows.iter().for_each(|r| *blocks.entry((k, r.block)).or_default() += r.slope * (r.left - estimate * r.slope));
    }
    let count = blocks.len() as f64;
    let square = blocks.values().map(|b| b * b).sum::<f64>() * count / (count - 1.0);
    let std = square.sqrt() / information;
    (count > 2.0 && std.is_finite()).then_some((estimate, std, count - 1.0))
}

/// Runs that are asked together.
pub(super) struct Clocks {
    runs: Vec<Asked>,
}

impl Clocks {
    pub(super) fn new(records: &[&Record], gravity_m_s2: f64) -> Self {
        Self { runs: records.iter().filter_map(|r| Asked::new(r, gravity_m_s2)).collect() }
    }

    /// The offset from a declared lag, where there is one: its total, not the difference.
    pub(super) fn offset(&self, declared_s: f64) -> Option<Lag> {
        let longest = self.runs.iter().map(Asked::duration_s).fold(0.0, f64::max) * LONGEST;
        #[expect(clippy::cast_possible_truncation, reason = "a few hundred steps")]
        let most = (longest / STEP_S).floor() as i32;
        let lags: Vec<f64> = (-most..=most).map(|k| f64::from(k) * STEP_S).collect();
        let gain = |lag: f64| self.runs.iter().map(|r| r.gain(lag, declared_s)).sum::<f64>();
        let all: Vec<(f64, f64)> = lags.iter().map(|l| (*l, gain(*l))).collect();
        let best = |near: bool| {
            let of = all.iter().filter(|l| ((l.0 - declared_s).abs() <= NEAR_S) == near);
            of.max_by(|a, b| a.1.total_cmp(&b.1)).copied()
        };
        let near = best(true).unwrap_or((declared_s, 0.0));
        let far = best(false).filter(|far| far.1 > near.1)?;
        // Speeds of both lags together: the share of the far one, which is 0 or 1 where one of them is right.
        let runs = self.each(far.0, |r| {
            let both = [near.0, far.0];
            r.rows(near.0, &both, |i, [v, _]| r.speed_at(i.sample, far.0).map_or(0.0, |[other, _]| v - other))
        });
        let (share, std, freedom) = slope(&runs)?;
        let t = (share - 0.5) / std;
        let chance = StudentsT::new(0.0, 1.0, freedom).ok()?.sf(t) * lags.len() as f64;
        if chance.is_nan() || chance >= FALSE_ALARM {
            return None;
        }
        self.peak(far.0, declared_s).filter(|lag| lag.left_m_s[1] < CLOSED * lag.left_m_s[0])
    }

    fn each(&self, lag_s: f64, rows: impl Fn(&Asked) -> Vec<Row>) -> Vec<Vec<Row>> {
        self.runs.iter().filter(|r| lag_s.abs() <= LONGEST * r.duration_s()).map(rows).collect()
    }

    /// The least squares' own lag near one of the grid, by its slope.
    fn peak(&self, from_s: f64, declared_s: f64) -> Option<Lag> {
        let mut lag_s = from_s;
        let mut std_error_s = f64::NAN;
        for _ in 0..4 {
            // The speed a little later is the speed and its rate: what is left grows by the rate.
            let (step, std, _) = slope(&self.each(from_s, |r| r.rows(lag_s, &[lag_s], |_, [_, rate]| -rate)))?;
            lag_s += step.clamp(-STEP_S, STEP_S);
            std_error_s = std;
        }
        let left = |lag: f64| {
            let rows = self.each(from_s, |r| r.rows(lag, &[lag_s, declared_s], |_, _| 0.0));
            let n = rows.iter().map(Vec::len).sum::<usize>().max(1) as f64;
            (rows.iter().flatten().map(|r| r.left * r.left).sum::<f64>() / n).sqrt()
        };
        Some(Lag { lag_s, std_error_s, left_m_s: [left(declared_s), left(lag_s)] })
    }
}

/// Runs whose clocks differ otherwise than those of the others: each is set by hand, no effect is of one run.
pub(super) fn apart(runs: &[(&str, &Record)], gravity_m_s2: f64, common_s: f64) -> Option<GrossFault> {
    if runs.len() < 2 {
        return None;
    }
    let own = |(name, r): &(&str, &Record)| Some(((*name).to_owned(), Clocks::new(&[r], gravity_m_s2).offset(common_s)?));
    let all: Vec<(String, Lag)> = runs.iter().filter_map(own).collect();
    let (_, first) = all.first()?;
    let list = |f: &dyn Fn(&(String, Lag)) -> String| all.iter().map(f).collect::<Vec<_>>().join(", ");
    Some(GrossFault {
        place: format!("{} {}", if all.len() > 1 { "runs" } else { "run" }, list(&|a| a.0.clone())),
        cause: "the clocks of pose and V_W differ otherwise than in the other runs".to_owned(),
        evidence: format!("V_W is {}; {}", list(&|(name, lag)| format!("{} in {name}", lag.words())), first.evidence()),
        change: format!(
            "pair each pose with the VW_m_s of its own time: {}",
            list(&|(name, lag)| format!("in {name} that recorded {:.3} s {}", lag.lag_s.abs(), lag.side()))
        ),
    })
}

#[cfg(test)]
mod tests;
