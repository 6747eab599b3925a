//! pid: how far runs went (thesis Table 5.1). In: a record and its plant. Out: duration, largest angle and rates, airspeed, Reynolds number.

use crate::PidError;
use crate::smooth::{Smoothed, Smoother, smooth};
use crate::states::{State, state_at};
use serde::{Deserialize, Serialize};
use std::ops::Range;
use windfall_model::{Plant, Record};

/// Ends of a smoothed record from which no rate and no speed is taken, in periods of the smoother's fastest channel; chosen: the rows of a
/// regression are faded over as many.
const END_PERIODS: f64 = 3.0;

/// What a run, or a set of runs, reached: the row of the thesis' Table 5.1, and the range in which what is identified on it is valid. Beyond
/// it a model is extrapolated. All is of the record, smoothed by splines, of a window all of its recording; angles and speeds are those of the
/// c.m. against the mean flow. Rates and speeds leave out the ends of the recording, some tenths of a second, where the smoother hangs on one
/// side and the noise of its derivatives is many times that inside.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Envelope {
    /// Duration, s; of several runs their sum.
    pub duration_s: f64,
    /// Largest total angle of attack α_T, deg, 0 to 180 (eq. B.47).
    pub max_alpha_t_deg: f64,
    /// Largest size of the roll rate p, deg/s (eq. 3.20).
    pub max_p_deg_s: f64,
    /// Largest size of the pitch rate q, deg/s.
    pub max_q_deg_s: f64,
    /// Largest size of the yaw rate r, deg/s.
    pub max_r_deg_s: f64,
    /// Least and largest airspeed V_∞, m/s (eq. B.39).
    pub speed_m_s: [f64; 2],
    /// Reynolds number ρ V_∞ d/μ of the reference diameter (eq. B.59), mean over the samples; viscosity of air by Sutherland's formula (US
    /// Standard Atmosphere 1976). None of a gas that is not air.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reynolds_number: Option<f64>,
}

/// A run's row.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RunEnvelope {
    /// Name of the run.
    pub name: String,
    /// Its kind.
    pub kind: String,
    /// `identify`, `select` or `hold-out`.
    pub used: String,
    /// What it reached.
    #[serde(flatten)]
    pub envelope: Envelope,
}

/// A data set's row.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SetEnvelope {
    /// A kind of run, or `combined`.
    pub name: String,
    /// Names of the runs in it.
    pub runs: Vec<String>,
    /// What they reached.
    #[serde(flatten)]
    pub envelope: Envelope,
}

impl Envelope {
    /// What a record reached. `plant` gives the centre of mass, the mean flow, the gas and the reference diameter.
    ///
    /// # Errors
    /// A record that cannot be smoothed; [`PidError::NoFlow`] where the airspeed vanishes or the nose is horizontal.
    pub fn of_record(record: &Record, plant: &Plant) -> Result<Self, PidError> {
        let whole = record.recording.as_ref().filter(|r| r.rows.len() == record.len());
        let of_whole = whole.and_then(|r| Some((smooth(&r.whole, &Smoother::Auto).ok()?, r.rows.clone())));
        let (smoothed, rows) = match of_whole {
            Some(found) => found,
            // Not a window, or of a recording that cannot be smoothed as a whole.
            None => (smooth(record, &Smoother::Auto)?, 0..record.len()),
        };
        let all = rows.clone().map(|i| {
            let state = state_at(&smoothed, plant, i);
            state.checked().map(|()| state)
        });
        let all = all.collect::<Result<Vec<State>, PidError>>()?;
        let inner = interior(&smoothed, &rows).map_or(&all[..], |r| &all[r]);
        let reynolds_number = reynolds(&all, &smoothed.ts_k[rows], plant);
        Ok(Self { duration_s: record.duration_s(), reynolds_number, ..Self::of_states(&all, inner) })
    }
    /// Angles of all states, rates and speeds of those `inner` that lie away from the ends of what was smoothed.
    fn of_states(all: &[State], inner: &[State]) -> Self {
        let largest = |of: &[State], value: fn(&State) -> f64| of.iter().map(|s| value(s).abs()).fold(0.0, f64::max).to_degrees();
        Self {
            duration_s: 0.0,
            max_alpha_t_deg: largest(all, |s| s.alpha_t),
            max_p_deg_s: largest(inner, |s| s.pqr[0]),
            max_q_deg_s: largest(inner, |s| s.pqr[1]),
            max_r_deg_s: largest(inner, |s| s.pqr[2]),
            speed_m_s: inner.iter().fold([f64::INFINITY, 0.0], |[low, high], s| [low.min(s.speed), high.max(s.speed)]),
            reynolds_number: None,
        }
    }
    /// What several runs reached together: durations add, Reynolds numbers are weighted by them. None of no run.
    #[must_use]
    pub fn joined<'a>(all: impl IntoIterator<Item = &'a Self>) -> Option<Self> {
        all.into_iter().cloned().reduce(|a, b| a.with(&b))
    }
    fn with(&self, other: &Self) -> Self {
        let duration_s = self.duration_s + other.duration_s;
        let share = if duration_s > 0.0 { other.duration_s / duration_s } else { 0.5 };
        let mean = |(a, b): (f64, f64)| a + share * (b - a);
        Self {
            duration_s,
            max_alpha_t_deg: self.max_alpha_t_deg.max(other.max_alpha_t_deg),
            max_p_deg_s: self.max_p_deg_s.max(other.max_p_deg_s),
            max_q_deg_s: self.max_q_deg_s.max(other.max_q_deg_s),
            max_r_deg_s: self.max_r_deg_s.max(other.max_r_deg_s),
            speed_m_s: [self.speed_m_s[0].min(other.speed_m_s[0]), self.speed_m_s[1].max(other.speed_m_s[1])],
            reynolds_number: self.reynolds_number.zip(other.reynolds_number).map(mean),
        }
    }
}

/// Mean Reynolds number of states at temperatures, K; none of a gas that is not air.
fn reynolds(all: &[State], ts_k: &[f64], plant: &Plant) -> Option<f64> {
    let per_sample = all.iter().zip(ts_k).map(|(s, t)| {
        let viscosity_pa_s = plant.environment.viscosity_pa_s(*t)?;
        Some(s.density * s.speed * plant.vehicle.diameter_m / viscosity_pa_s)
    });
    per_sample.sum::<Option<f64>>().map(|sum| sum / all.len().max(1) as f64)
}

/// Those of `rows` at which the smoother does not hang on one side, counted from the first of them; none where there are none.
fn interior(smoothed: &Smoothed, rows: &Range<usize>) -> Option<Range<usize>> {
    let fastest_hz = smoothed.bandwidth_hz.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "positive; saturates, and is then beyond every row"
    )]
    let end = (END_PERIODS / (fastest_hz * smoothed.interval_s)).ceil() as usize;
    let last = smoothed.t_s.len().saturating_sub(end).min(rows.end);
    let first = end.max(rows.start);
    (first < last).then(|| first - rows.start..last - rows.start)
}

#[cfg(test)]
pub(crate) mod tests;
