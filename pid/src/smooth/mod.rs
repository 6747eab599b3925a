//! pid: smoothing. In: a run record with noise. Out: values and first and second time derivatives of its seven motion signals.

mod banded;
mod bspline;
mod fourier;
mod local;
mod spline;
mod wide;

use crate::PidError;
use std::f64::consts::TAU;
use windfall_model::{CHANNEL_NAMES, PerChannel, Record, Recording, RunChannel};

/// Cutoff frequencies of thesis Table 3.1, Hz, in channel order.
pub const TABLE_3_1_HZ: PerChannel<f64> = [1.5, 1.5, 1.5, 1.5, 2.5, 2.5, 1.5];

/// A smoothed signal at the sample times: m, rad or m/s, and per s and s².
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Signal {
    /// Value.
    pub value: Vec<f64>,
    /// First time derivative.
    pub rate: Vec<f64>,
    /// Second time derivative.
    pub second: Vec<f64>,
}

/// A smoothed run.
#[derive(Clone, Debug, PartialEq)]
pub struct Smoothed {
    /// Sample times, s.
    pub t_s: Vec<f64>,
    /// Sample interval, s.
    pub interval_s: f64,
    /// X, Y, Z (m), R_x, R_y, R_z (rad), V_W (m/s).
    pub channels: PerChannel<Signal>,
    /// Static pressure, Pa, as recorded.
    pub ps_pa: Vec<f64>,
    /// Static temperature, K, as recorded.
    pub ts_k: Vec<f64>,
    /// Estimated standard deviation of each channel's noise, in the channel's unit.
    pub noise_std: PerChannel<f64>,
    /// For each sample, how precise its second derivatives are against those inside the run, in (0, 1]: the factor that rows
    /// of a regression deserve. Ones for the thesis' smoothing.
    pub weight: Vec<f64>,
    /// What the smoother chose: cutoff frequency (thesis) or half of the knot rate (spline), or 1/(4·half-width) (local), Hz.
    pub bandwidth_hz: PerChannel<f64>,
}

/// How to smooth.
#[derive(Clone, Debug, PartialEq)]
pub enum Smoother {
    /// Global Fourier smoothing with odd reflection and Wiener filter, eqs 3.2-3.19. An infinite cutoff leaves all of the spectrum.
    /// Of a record that is a window of its recording the whole recording is smoothed, then cropped (§5.1).
    Thesis {
        /// Cutoff frequency of each channel, Hz.
        cutoffs_hz: PerChannel<f64>,
    },
    /// The same, cutoffs where the spectrum sinks into its noise floor.
    ThesisAuto,
    /// No smoothing: values as recorded, derivatives by a least-squares quadratic over five samples, done twice for the second
    /// (Appendix C; Klein and Morelli, Aircraft System Identification, 2006, ch. 11, as their `deriv` does).
    Unsmoothed,
    /// Local polynomials (Savitzky and Golay 1964), windows shifted inward at the ends.
    Local {
        /// Half-width of each channel's window, s.
        half_width_s: PerChannel<f64>,
        /// Degree, 2 to 12.
        degree: usize,
    },
    /// Least-squares spline of given knot interval: one for all channels, so that smoothing takes the same from both sides of
    /// the equations of motion.
    Spline {
        /// Knot interval, s.
        knot_s: f64,
    },
    /// [`Smoother::Spline`] with the knot interval that generalised cross-validation finds for all channels together (Craven and
    /// Wahba 1979).
    Auto,
}

impl Smoother {
    /// The thesis' ways of smoothing in words; none of those that choose for themselves.
    pub(crate) fn words(&self) -> Option<String> {
        match self {
            Self::Thesis { cutoffs_hz } => {
                let one = |(name, hz): (&str, &f64)| format!("{name} {hz}");
                let all: Vec<String> = CHANNEL_NAMES.into_iter().zip(cutoffs_hz).map(one).collect();
                Some(format!("Fourier series of each whole recording, cut-off frequencies in Hz: {}", all.join(", ")))
            }
            Self::Unsmoothed => Some("none; derivatives by quadratics through five samples".to_owned()),
            Self::ThesisAuto | Self::Local { .. } | Self::Spline { .. } | Self::Auto => None,
        }
    }
}

/// Smooths a record.
///
/// # Errors
/// Faults of the record (length, NaN, time not uniform to 1 %, too few samples) and settings out of range.
pub fn smooth(record: &Record, smoother: &Smoother) -> Result<Smoothed, PidError> {
    check(record)?;
    let dt = record.interval_s();
    let raw = record.channels();
    let fit = match smoother {
        Smoother::Thesis { cutoffs_hz } => whole(record, |raw, dt| fourier::smooth(raw, dt, Some(*cutoffs_hz)))?,
        Smoother::ThesisAuto => whole(record, |raw, dt| fourier::smooth(raw, dt, None))?,
        Smoother::Unsmoothed => whole(record, |raw, dt| Ok(local::unsmoothed(raw, dt)))?,
        Smoother::Local { half_width_s, degree } => local::smooth(raw, dt, half_width_s, *degree)?,
        Smoother::Spline { knot_s } => spline::smooth(raw, dt, Some(*knot_s))?,
        Smoother::Auto => spline::smooth(raw, dt, None)?,
    };
    Ok(Smoothed {
        t_s: record.t_s.clone(),
        interval_s: dt,
        channels: fit.channels,
        ps_pa: record.ps_pa.clone(),
        ts_k: record.ts_k.clone(),
        noise_std: fit.noise_std,
        weight: fit.weight,
        bandwidth_hz: fit.bandwidth_hz,
    })
}

/// Smooths all of the recording that a record is a window of, then crops.
fn whole(record: &Record, smooth: impl Fn(PerChannel<&[f64]>, f64) -> Result<Fit, PidError>) -> Result<Fit, PidError> {
    let usable = record.recording.as_ref().filter(|r| r.rows.len() == record.len() && check(&r.whole).is_ok());
    let Some(Recording { whole, rows }) = usable else { return smooth(record.channels(), record.interval_s()) };
    let mut fit = smooth(whole.channels(), whole.interval_s())?;
    for (c, signal) in fit.channels.iter_mut().enumerate() {
        for series in [&mut signal.value, &mut signal.rate, &mut signal.second] {
            *series = series[rows.clone()].to_vec();
        }
        // Where turns are counted from is the window's own.
        let turns = ((whole.channels()[c][rows.start] - record.channels()[c][0]) / TAU).round() * TAU;
        if RunChannel::ALL[c].is_angle() && turns != 0.0 {
            signal.value.iter_mut().for_each(|x| *x -= turns);
        }
    }
    fit.weight = fit.weight[rows.clone()].to_vec();
    Ok(fit)
}

/// What a smoother gives for the seven channels.
struct Fit {
    channels: PerChannel<Signal>,
    noise_std: PerChannel<f64>,
    weight: Vec<f64>,
    bandwidth_hz: PerChannel<f64>,
}

/// Fewest samples of a run that can be smoothed.
const FEWEST: usize = 16;

fn check(r: &Record) -> Result<(), PidError> {
    let n = r.len();
    if n < FEWEST {
        return Err(PidError::TooFewSamples { what: "a run".to_owned(), samples: n, needed: FEWEST });
    }
    let named = CHANNEL_NAMES.into_iter().zip(r.channels());
    for (channel, x) in named.chain([("ps_Pa", r.ps_pa.as_slice()), ("Ts_K", r.ts_k.as_slice()), ("t_s", r.t_s.as_slice())]) {
        if x.len() != n {
            return Err(PidError::Length { channel, found: x.len(), expected: n });
        }
        if let Some(index) = x.iter().position(|v| !v.is_finite()) {
            return Err(PidError::NotFinite { channel, index, value: x[index] });
        }
    }
    check_uniform(&r.t_s, r.interval_s())
}

fn check_uniform(t: &[f64], dt: f64) -> Result<(), PidError> {
    // Printed times are rounded: the step may be off by 1 %, or by the last printed digit (1e-6 s).
    let allowed = (0.01 * dt).max(1.0e-6);
    for (i, pair) in t.windows(2).enumerate() {
        let offset_s = pair[1] - pair[0] - dt;
        if offset_s.abs() > allowed || pair[1] <= pair[0] {
            return Err(PidError::NotUniform { index: i + 1, offset_s, interval_s: dt });
        }
    }
    Ok(())
}
