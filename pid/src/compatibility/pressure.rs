//! pid: tunnel speed against dynamic pressure. In: V_W, q_W, p_s, T_s of all runs. Out: scale and delay of √(2 q_W/ρ) against V_W.
//!
//! Two noisy witnesses of one tunnel speed, which neither shows: `v = V + e`, `w = κ V(t − τ) + e'` with `w = √(2 q_W/ρ)`, dry air.
//! V is twice integrated Brownian motion, its intensity and both noises by the likelihood of each record alone; κ and τ maximise the
//! likelihood of both together (innovations of a Kalman filter; the cross-correlation's peak, weighted by what each frequency is worth:
//! Knapp and Carter 1976). A q_W that was computed from V_W shares its noise and says nothing of it: only ρ is tested then.

use crate::interval::{NORMAL_95, ci95};
use crate::not_noise::NOT_NOISE;
use crate::output_error::{Liveliness, liveliness, low_frequency_p};
use nalgebra::{Matrix2, Matrix3, RowVector3, Vector2, Vector3};
use realfft::RealFftPlanner;
use serde::{Deserialize, Serialize};
use statrs::distribution::{ChiSquared, ContinuousCDF};
use windfall_model::{Campaign, Data};

/// Correlation of both records' noise from which one was computed from the other.
const SHARED: f64 = 0.9;
/// What moisture can do to κ: saturated air at 20 °C and 101 kPa is 0.87 % lighter than dry air, so w is 0.44 % too low.
const MOISTURE: f64 = 0.005;
/// Delays tried first, s, in these steps.
const LONGEST_S: f64 = 1.0;
const TRIED_S: f64 = 0.05;
const ITERATIONS: usize = 20;
/// A delay is told where the longest ones, either way, are worse than the best tried by this much in −2 ln of the likelihood: 95 % of a
/// squared normal number.
const TELLS: f64 = NORMAL_95 * NORMAL_95;

/// Dynamic pressure against tunnel speed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Pressure {
    /// True where q_W shares V_W's noise, so that it was computed from it.
    pub computed_from_speed: bool,
    /// √(2 q_W/ρ) is this times V_W.
    pub speed_scale: f64,
    /// Its 95 % interval.
    pub speed_scale_ci95: [f64; 2],
    /// q_W is this times ½ρV_W²: the square.
    pub pressure_scale: f64,
    /// Its 95 % interval.
    pub pressure_scale_ci95: [f64; 2],
    /// q_W lags V_W by this, s; none where V_W hardly changes or q_W is computed.
    pub delay_s: Option<f64>,
    /// Its 95 % interval.
    pub delay_ci95_s: Option<[f64; 2]>,
    /// Probability of as much or more when both agree; 1 for a computed q_W within what moisture can do.
    pub p_value: f64,
    /// Probability that noise looks as coloured as what is left; intervals are widened where it is below 1 %.
    pub whiteness_p: f64,
}

/// Both witnesses in one run.
struct Witnesses {
    v: Vec<f64>,
    w: Vec<f64>,
    interval_s: f64,
    /// Intensity, and both noises' variances.
    intensity: f64,
    variance: [f64; 2],
}

pub(super) fn examine(campaign: &Campaign) -> Option<Pressure> {
    let pairs: Vec<Witnesses> = campaign
        .runs
        .iter()
        .filter_map(|run| match &run.data {
            Data::Tunnel(record) => {
                let q = record.qw_pa.as_ref()?;
                let density =
                    record.ps_pa.iter().zip(&record.ts_k).map(|(p, t)| campaign.plant.environment.density_kg_m3(*p, *t));
                let w: Vec<f64> = q.iter().zip(density).map(|(q, rho)| indicated(*q, rho)).collect();
                (w.len() >= 32 && w.iter().chain(&record.vw_m_s).all(|x| x.is_finite()))
                    .then(|| Witnesses::new(&record.vw_m_s, w, record.interval_s()))
            }
            Data::Point(_) => None,
        })
        .collect();
    if pairs.is_empty() {
        return None;
    }
    if shared(&pairs) >= SHARED { Some(computed(&pairs)) } else { measured(&pairs) }
}

/// Speed of a dynamic pressure.
fn indicated(qw_pa: f64, density_kg_m3: f64) -> f64 {
    (2.0 * qw_pa / density_kg_m3).sqrt()
}

impl Witnesses {
    fn new(v: &[f64], w: Vec<f64>, interval_s: f64) -> Self {
        let [one, other]: [Liveliness; 2] = [v, w.as_slice()].map(|x| liveliness(x, interval_s));
        // The less noisy record tells more of how the speed moves.
        let intensity = if one.noise_std <= other.noise_std { one.intensity } else { other.intensity };
        let floor = (1e-9 * v[0]).powi(2).max(f64::MIN_POSITIVE);
        let variance = [one, other].map(|l| l.noise_std.powi(2).max(floor));
        Self { v: v.to_vec(), w, interval_s, intensity, variance }
    }

    /// All of both records at a scale and a delay of `shift` samples and `rest_s`.
    fn innovations(&self, scale: f64, shift: isize, rest_s: f64) -> Innovations {
        let h = self.interval_s;
        #[rustfmt::skip]
        let phi = Matrix3::new(
            1.0, h,   0.5 * h * h,
            0.0, 1.0, h,
            0.0, 0.0, 1.0,
        );
        let see = [
            (RowVector3::new(1.0, 0.0, 0.0), self.variance[0]),
            (scale * RowVector3::new(1.0, -rest_s, 0.5 * rest_s * rest_s), self.variance[1]),
        ];
        let mut x = Vector3::new(self.v[0], 0.0, 0.0);
        let mut p = Matrix3::from_diagonal_element(1e8 * self.variance[0].max(self.variance[1]));
        let mut out = Innovations { each: Vec::new(), minus_twice_log: 0.0, w_from: 0_usize.saturating_add_signed(-shift) };
        let v_from = 0_usize.saturating_add_signed(shift);
        let at = |x: &[f64], first: usize, i: usize| i.checked_sub(first).and_then(|k| x.get(k)).copied();
        // From the first sample of either record to the last.
        for i in 0..self.v.len() + shift.unsigned_abs() {
            for ((row, variance), y) in see.iter().zip([at(&self.v, v_from, i), at(&self.w, out.w_from, i)]) {
                let Some(y) = y else {
                    out.each.push(0.0);
                    continue;
                };
                let s = (row * p * row.transpose())[0] + variance;
                let e = y - (row * x)[0];
                // The first samples only fix the state.
                out.each.push(if i < 3 { 0.0 } else { e / s.sqrt() });
                out.minus_twice_log += e * e / s + s.ln();
                let gain = p * row.transpose() / s;
                x += gain * e;
                p -= gain * row * p;
                p = 0.5 * (p + p.transpose());
            }
            x = phi * x;
            p = phi * p * phi.transpose();
            p[(2, 2)] += self.intensity * h;
        }
        out
    }
    fn shift(&self, delay_s: f64) -> isize {
        #[expect(clippy::cast_possible_truncation, reason = "a delay of some samples")]
        let samples = (delay_s / self.interval_s).round() as isize;
        samples
    }
    fn at(&self, [scale, delay_s]: [f64; 2], shift: isize) -> Innovations {
        self.innovations(scale, shift, delay_s - shift as f64 * self.interval_s)
    }
}

/// What a filter of both records leaves.
struct Innovations {
    /// Over their standard deviations, v's and w's by turns from the first sample of either; zero where there is none, and at first.
    each: Vec<f64>,
    /// −2 ln of the likelihood of both records, but for a constant.
    minus_twice_log: f64,
    /// Where w begins.
    w_from: usize,
}

/// Correlation of what changes from sample to sample, which is noise, over all runs.
fn shared(pairs: &[Witnesses]) -> f64 {
    let second = |x: &[f64]| -> Vec<f64> { x.windows(3).map(|w| w[0] - 2.0 * w[1] + w[2]).collect() };
    let (mut vv, mut vw, mut ww) = (0.0, 0.0, 0.0);
    for p in pairs {
        for (a, b) in second(&p.v).into_iter().zip(second(&p.w)) {
            vv += a * a;
            vw += a * b;
            ww += b * b;
        }
    }
    if vv * ww > 0.0 { vw / (vv * ww).sqrt() } else { 0.0 }
}

fn computed(pairs: &[Witnesses]) -> Pressure {
    let ratios: Vec<f64> =
        pairs.iter().flat_map(|p| p.w.iter().zip(&p.v).map(|(w, v)| w / v)).filter(|r| r.is_finite()).collect();
    let n = ratios.len() as f64;
    let mean = ratios.iter().sum::<f64>() / n;
    let std = (ratios.iter().map(|r| (r - mean).powi(2)).sum::<f64>() / (n - 1.0)).sqrt();
    let agrees = (mean - 1.0).abs() <= MOISTURE;
    Pressure { computed_from_speed: true, ..result(mean, std / n.sqrt(), None, if agrees { 1.0 } else { 0.0 }, 1.0) }
}

fn result(scale: f64, std_error: f64, delay: Option<[f64; 2]>, p_value: f64, whiteness_p: f64) -> Pressure {
    let speed_scale_ci95 = ci95(scale, std_error);
    Pressure {
        computed_from_speed: false,
        speed_scale: scale,
        speed_scale_ci95,
        pressure_scale: scale * scale,
        pressure_scale_ci95: speed_scale_ci95.map(|k| k * k),
        delay_s: delay.map(|[d, _]| d),
        delay_ci95_s: delay.map(|[d, std]| ci95(d, std)),
        p_value,
        whiteness_p,
    }
}

/// Score, information and middle of the sandwich, and the innovations of w.
struct Local {
    score: Vector2<f64>,
    information: Matrix2<f64>,
    middle: Matrix2<f64>,
    of_w: Vec<Vec<f64>>,
}

/// Lags of the scores' covariance, s.
const LAGS_S: f64 = 0.5;

fn local(pairs: &[Witnesses], at: [f64; 2]) -> Local {
    let mut l = Local { score: Vector2::zeros(), information: Matrix2::zeros(), middle: Matrix2::zeros(), of_w: Vec::new() };
    for p in pairs {
        let shift = p.shift(at[1]);
        let Innovations { each: e, w_from, .. } = p.at(at, shift);
        let slope = |by: [f64; 2], h: f64| -> Vec<f64> {
            let side = |s: f64| p.at([at[0] + s * by[0], at[1] + s * by[1]], shift);
            side(1.0).each.into_iter().zip(side(-1.0).each).map(|(a, b)| (b - a) / (2.0 * h)).collect()
        };
        let (by_scale, by_delay) = (slope([1e-5, 0.0], 1e-5), slope([0.0, 1e-4], 1e-4));
        let g: Vec<Vector2<f64>> = by_scale.into_iter().zip(by_delay).map(|(a, b)| Vector2::new(a, b)).collect();
        // Both witnesses of one sample as one score.
        let scores: Vec<Vector2<f64>> = g.chunks(2).zip(e.chunks(2)).map(|(g, e)| g[0] * e[0] + g[1] * e[1]).collect();
        l.score += scores.iter().sum::<Vector2<f64>>();
        l.information += g.iter().map(|g| g * g.transpose()).sum::<Matrix2<f64>>();
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "half a second of samples")]
        let lags = (LAGS_S / p.interval_s) as usize;
        for lag in 0..=lags.min(scores.len() - 1) {
            let sum: Matrix2<f64> = scores.iter().zip(&scores[lag..]).map(|(a, b)| a * b.transpose()).sum();
            // Bartlett's weights (Newey and West 1987).
            let weight = 1.0 - lag as f64 / (lags + 1) as f64;
            l.middle += if lag == 0 { sum } else { weight * (sum + sum.transpose()) };
        }
        l.of_w.push(e.into_iter().skip(1).step_by(2).skip(w_from).take(p.w.len()).collect());
    }
    l
}

fn measured(pairs: &[Witnesses]) -> Option<Pressure> {
    let sum = |f: &dyn Fn(&Witnesses) -> f64| pairs.iter().map(f).sum::<f64>();
    let scale = sum(&|p| p.w.iter().sum()) / sum(&|p| p.v.iter().sum());
    let minus_twice_log = |delay: f64| sum(&|p| p.at([scale, delay], p.shift(delay)).minus_twice_log);
    #[expect(clippy::cast_possible_truncation, reason = "twenty")]
    let tried = (LONGEST_S / TRIED_S) as i32;
    let tried: Vec<[f64; 2]> = (-tried..=tried).map(|k| f64::from(k) * TRIED_S).map(|d| [minus_twice_log(d), d]).collect();
    let [least, start] = tried.iter().copied().min_by(|a, b| a[0].total_cmp(&b[0]))?;
    let mut at = Vector2::new(scale, start);
    for _ in 0..ITERATIONS {
        let l = local(pairs, at.into());
        let step = scaled_inverse(&l.information)? * l.score;
        at += step;
        at[1] = at[1].clamp(-2.0 * LONGEST_S, 2.0 * LONGEST_S);
        if step[0].abs() < 1e-9 && step[1].abs() < 1e-7 {
            break;
        }
    }
    let l = local(pairs, at.into());
    let inverse = scaled_inverse(&l.information)?;
    let interval: Vec<f64> = pairs.iter().map(|p| p.interval_s).collect();
    let series: Vec<&[f64]> = l.of_w.iter().map(Vec::as_slice).collect();
    let whiteness_p = low_frequency_p(&series, &interval, &mut RealFftPlanner::new());
    let mut covariance = inverse;
    if whiteness_p < NOT_NOISE {
        let sandwich = inverse * l.middle * inverse;
        if (0..2).all(|k| sandwich[(k, k)] >= inverse[(k, k)]) {
            covariance = sandwich;
        }
    }
    let off = at - Vector2::new(1.0, 0.0);
    // Noise alone has slopes, by which a delay of a constant speed would seem known.
    let told = [tried.first()?, tried.last()?].iter().all(|end| end[0] - least > TELLS);
    let determined = told && NORMAL_95 * covariance[(1, 1)].sqrt() < LONGEST_S;
    let (square, degrees) = if determined {
        (off.dot(&(scaled_inverse(&covariance)? * off)), 2.0)
    } else {
        (off[0] * off[0] / covariance[(0, 0)], 1.0)
    };
    let p_value = ChiSquared::new(degrees).ok()?.sf(square);
    Some(result(at[0], covariance[(0, 0)].sqrt(), determined.then(|| [at[1], covariance[(1, 1)].sqrt()]), p_value, whiteness_p))
}

/// Inverse with rows and columns scaled to a diagonal of ones.
fn scaled_inverse(m: &Matrix2<f64>) -> Option<Matrix2<f64>> {
    let scale = Matrix2::from_diagonal(&Vector2::new(1.0 / m.m11.sqrt(), 1.0 / m.m22.sqrt()));
    Some(scale * (scale * m * scale).try_inverse()? * scale).filter(|i| i.iter().all(|v| v.is_finite()))
}

#[cfg(test)]
mod tests;
