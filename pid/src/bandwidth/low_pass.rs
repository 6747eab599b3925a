//! pid: was a group of channels smoothed? In: their series. Out: the low-pass filter that shaped their noise, if one did.
//!
//! Above the motion's frequencies a spectrum is the instrument's noise. Two models of it are held against each other by Whittle's likelihood
//! (Whittle 1953) of means over bands: a flat floor with coloured noise or a resonance, and a floor that a low-pass filter shaped with a
//! rest of rounding. Both have the steep upper end of the motion's spectrum beside them. Lines, such as the mains, are left out before.

use realfft::RealFftPlanner;
use realfft::num_complex::Complex;
use std::f64::consts::{LN_2, PI, TAU};

/// A low-pass filter: power `1 / (1 + x^2m)^j` with `x = tan(πf/fs) / tan(πfc/fs)` (Butterworth, by the bilinear transform).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LowPass {
    /// Corner, Hz.
    pub(crate) corner_hz: f64,
    /// Order of the filter, and how often it ran: twice where it ran forward and backward.
    pub(crate) order: i32,
    pub(crate) runs: i32,
    /// Rate of the samples, Hz.
    rate_hz: f64,
    /// Gain of log-likelihood over noise that no filter shaped.
    pub(crate) gain: f64,
}

/// Orders and numbers of runs that are tried; one of the first order that ran once is the coloured noise of a sound record.
const FORMS: [(i32, i32); 11] = [(1, 2), (2, 1), (2, 2), (3, 1), (3, 2), (4, 1), (4, 2), (6, 1), (6, 2), (8, 1), (8, 2)];
/// Gain of log-likelihood that speaks for a filter: e^-20 is no chance, whatever is tried. Real filters gain hundreds.
const ENOUGH: f64 = 20.0;
/// Frequency above which the motion's spectrum is its steep upper end alone, Hz and at most as a share of the rate; above its modes, motion
/// under forces with spectra that fall with the square of frequency has one that falls with the sixth power.
const WITH_MOTION_HZ: f64 = 3.5;
const MOTION_SHARE: f64 = 0.2;
const STEEP: i32 = 6;
/// Bands, and fewest ordinates of a spectrum. A filter of the eighth order that ran twice falls to 0.37 of its power within one band.
const BANDS: usize = 96;
const FEWEST: usize = 48;
/// Chance that noise without a line has one, in a spectrum.
const CHANCE_OF_LINE: f64 = 1e-3;
/// Ordinates on each side that a line is judged by, and those that go with it: half the main lobe of Hann's window.
const BESIDE: usize = 8;
const LOBE: usize = 2;
/// Least size of the noise that was smoothed, as a share of the declared one: below it the spectrum may be the motion's.
const OF_DECLARED: f64 = 0.1;
/// Independent ordinates of a spectrum behind Hann's window, as a share of all: (Σw²)² / (n Σw⁴) = 18/35.
const INDEPENDENT: f64 = 18.0 / 35.0;
/// Corners tried, from just above the motion to just below half of the rate, before the best is refined.
const CORNERS: usize = 24;
/// Quality factors of resonances that are tried, at the frequency of each band.
const QUALITIES: [f64; 3] = [2.0, 5.0, 12.0];
/// Correlations of coloured noise from one sample to the next that are tried.
const CORRELATIONS: [f64; 14] = [0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.85, 0.9, 0.93, 0.96, 0.985];

impl LowPass {
    /// Power that it passes at a frequency.
    fn power(&self, hz: f64) -> f64 {
        let x = (PI * hz / self.rate_hz).tan() / (PI * self.corner_hz / self.rate_hz).tan();
        (1.0 + x.powi(2 * self.order)).powi(-self.runs)
    }
    /// Frequency at which half of the power passes, Hz. Sampled at twice that frequency, noise folds back there as much as was taken off, and is
    /// nearly white again.
    pub(crate) fn half_power_hz(&self) -> f64 {
        let x = (2.0_f64.powf(1.0 / f64::from(self.runs)) - 1.0).powf(0.5 / f64::from(self.order));
        (x * (PI * self.corner_hz / self.rate_hz).tan()).atan() * self.rate_hz / PI
    }
}

/// Mean power over a band.
#[derive(Clone, Copy, Debug)]
struct Band {
    hz: f64,
    power: f64,
    /// Independent ordinates.
    weight: f64,
}

/// The filter that shaped the noise of series of one rate, each with its declared standard deviation; `None` where nothing speaks for one.
pub(crate) fn low_pass(series: &[(Vec<f64>, f64)], rate_hz: f64) -> Option<LowPass> {
    let least_hz = WITH_MOTION_HZ.min(MOTION_SHARE * rate_hz);
    let all: Vec<(Vec<Band>, f64)> = series
        .iter()
        .filter(|(_, declared)| *declared > 0.0)
        .filter_map(|(x, declared)| Some((bands(x, rate_hz, least_hz)?, declared * declared)))
        .collect();
    if all.is_empty() {
        return None;
    }
    let unshaped: Vec<f64> = all.iter().map(|(b, _)| coloured(b, rate_hz)).collect();
    let sound: f64 = unshaped.iter().sum();
    let best_of_all: f64 = all.iter().map(|(b, _)| b.iter().map(|b| b.weight * (1.0 + b.power.ln())).sum::<f64>()).sum();
    if sound - best_of_all < ENOUGH {
        return None;
    }
    let cost = |f: &LowPass| all.iter().map(|(b, _)| shaped(b, f).0).sum::<f64>();
    let (from, to) = ((1.2 * least_hz).ln(), (0.45 * rate_hz).ln());
    let step = (to - from) / (CORNERS - 1) as f64;
    let at = |ln_hz: f64, (order, runs): (i32, i32)| LowPass { corner_hz: ln_hz.exp(), order, runs, rate_hz, gain: 0.0 };
    let tried = FORMS.iter().flat_map(|form| (0..CORNERS).map(move |k| (from + step * k as f64, *form)));
    let (_, ln_hz, form) = tried.map(|(x, form)| (cost(&at(x, form)), x, form)).min_by(|a, b| a.0.total_cmp(&b.0))?;
    let corner = crate::golden::minimise(|x| cost(&at(x, form)), [ln_hz - step, ln_hz + step], 0.01 * step);
    let found = at(corner, form);
    let shaped_cost = cost(&found);
    if sound - shaped_cost < ENOUGH {
        return None;
    }
    let gain = all.iter().zip(&unshaped).map(|((b, _), own)| own.min(resonant(b))).sum::<f64>() - shaped_cost;
    let noise = |(b, declared): &(Vec<Band>, f64)| shaped(b, &found).1 > OF_DECLARED * OF_DECLARED * declared;
    (gain > ENOUGH && all.iter().any(noise)).then_some(LowPass { gain, ..found })
}

/// Spectrum of a series in bands of equal ratio; from second differences, which take the motion down before the window.
fn bands(x: &[f64], rate_hz: f64, least_hz: f64) -> Option<Vec<Band>> {
    let n = x.len().checked_sub(2).filter(|n| *n > FEWEST)?;
    let window = |i: usize| 0.5 - 0.5 * (TAU * (i as f64 + 0.5) / n as f64).cos();
    let mut input: Vec<f64> = x.windows(3).enumerate().map(|(i, w)| window(i) * (w[2] - 2.0 * w[1] + w[0])).collect();
    let squares: f64 = (0..n).map(|i| window(i).powi(2)).sum();
    let plan = RealFftPlanner::new().plan_fft_forward(n);
    let mut output = plan.make_output_vec();
    plan.process(&mut input, &mut output).ok()?;
    let ordinate = |(k, z): (usize, &Complex<f64>)| {
        let w = TAU * k as f64 / n as f64;
        (w / TAU * rate_hz, z.norm_sqr() / squares / (2.0 - 2.0 * w.cos()).powi(2))
    };
    // The last ordinates are next to the fold.
    let within = |(hz, _): &(f64, f64)| *hz > least_hz && *hz <= 0.495 * rate_hz;
    let ordinates = without_lines(&output.iter().enumerate().skip(1).map(ordinate).filter(within).collect::<Vec<_>>());
    let ratio = (0.5 * rate_hz / least_hz).ln();
    let mut bands = [[0.0_f64; 3]; BANDS];
    for (hz, power) in &ordinates {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between 0 and BANDS")]
        let place = (((hz / least_hz).ln() / ratio * BANDS as f64) as usize).min(BANDS - 1);
        let b = &mut bands[place];
        *b = [b[0] + hz, b[1] + power, b[2] + 1.0];
    }
    let filled = bands.iter().filter(|b| b[2] > 0.0 && b[1] > 0.0);
    let all = filled.map(|[hz, power, n]| Band { hz: hz / n, power: power / n, weight: INDEPENDENT * n });
    (ordinates.len() >= FEWEST).then(|| all.collect())
}

/// The ordinates (frequency, power) that belong to no line. Ordinates of noise over their mean are exponential; the mean beside one is the median
/// over ln 2. One that stands above it by more than chance allows is a line, and goes with the main lobe of the window.
fn without_lines(ordinates: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let allowed = (ordinates.len() as f64 / CHANCE_OF_LINE).ln();
    let is_line = |i: usize| {
        let beside = &ordinates[i.saturating_sub(BESIDE)..(i + BESIDE + 1).min(ordinates.len())];
        let mut powers: Vec<f64> = beside.iter().map(|o| o.1).collect();
        let middle = powers.len() / 2;
        let median = *powers.select_nth_unstable_by(middle, f64::total_cmp).1;
        ordinates[i].1 > allowed * median / LN_2
    };
    let lines: Vec<bool> = (0..ordinates.len()).map(is_line).collect();
    let near = |i: usize| lines[i.saturating_sub(LOBE)..(i + LOBE + 1).min(lines.len())].contains(&true);
    ordinates.iter().enumerate().filter(|(i, _)| !near(*i)).map(|(_, o)| *o).collect()
}

/// Cost of the likeliest white noise with first-order coloured noise.
fn coloured(bands: &[Band], rate_hz: f64) -> f64 {
    let of = |r: &f64| {
        let power = |b: &Band| (1.0 - r * r) / (1.0 + r * r - 2.0 * r * (TAU * b.hz / rate_hz).cos());
        with_floor(bands, |b| if *r > 0.0 { power(b) } else { 0.0 })
    };
    CORRELATIONS.iter().map(of).fold(f64::INFINITY, f64::min)
}

/// Cost of the likeliest white noise with a resonance.
fn resonant(bands: &[Band]) -> f64 {
    let at = |q: f64, hz: f64| {
        let power = |b: &Band| {
            let square = (b.hz / hz).powi(2);
            1.0 / ((1.0 - square).powi(2) + square / (q * q))
        };
        with_floor(bands, power)
    };
    QUALITIES.iter().flat_map(|q| bands.iter().map(move |b| at(*q, b.hz))).fold(f64::INFINITY, f64::min)
}

/// Cost of motion, a flat floor and a third part.
fn with_floor(bands: &[Band], third: impl Fn(&Band) -> f64) -> f64 {
    let parts = |b: &Band| [motion(bands, b), 1.0, third(b)];
    mixture(bands, &bands.iter().map(parts).collect::<Vec<_>>()).0
}

/// Cost of noise and motion that a filter shaped, beside rounding; and the variance of that noise before the filter.
fn shaped(bands: &[Band], filter: &LowPass) -> (f64, f64) {
    let parts = |b: &Band| {
        let g = filter.power(b.hz);
        [motion(bands, b) * g, g, 1.0]
    };
    let (cost, sizes) = mixture(bands, &bands.iter().map(parts).collect::<Vec<_>>());
    (cost, sizes[1])
}

fn motion(bands: &[Band], b: &Band) -> f64 {
    (b.hz / bands[0].hz).powi(-STEEP)
}

/// Likeliest sizes, none negative, of three parts of a spectrum, and minus the log-likelihood there: by multiplicative steps (Févotte and Idier
/// 2011, section 4.3: of exponent one).
fn mixture(bands: &[Band], parts: &[[f64; 3]]) -> (f64, [f64; 3]) {
    const STEPS: usize = 60;
    let total: f64 = bands.iter().map(|b| b.weight).sum();
    let mean = bands.iter().map(|b| b.weight * b.power).sum::<f64>() / total;
    let mut sizes: [f64; 3] = std::array::from_fn(|i| {
        let own = parts.iter().map(|p| p[i]).sum::<f64>() / parts.len() as f64;
        if own > 0.0 { mean / (3.0 * own) } else { 0.0 }
    });
    let whole = |sizes: &[f64; 3], p: &[f64; 3]| (0..3).map(|i| sizes[i] * p[i]).sum::<f64>().max(1e-300);
    for _ in 0..STEPS {
        let (mut up, mut down) = ([0.0; 3], [0.0; 3]);
        for (b, p) in bands.iter().zip(parts) {
            let inverse = b.weight / whole(&sizes, p);
            let seen = inverse * b.power / whole(&sizes, p);
            (0..3).for_each(|i| {
                up[i] += seen * p[i];
                down[i] += inverse * p[i];
            });
        }
        (0..3).filter(|i| down[*i] > 0.0).for_each(|i| sizes[i] *= up[i] / down[i]);
    }
    let each = |(b, p): (&Band, &[f64; 3])| {
        let s = whole(&sizes, p);
        b.weight * (b.power / s + s.ln())
    };
    (bands.iter().zip(parts).map(each).sum(), sizes)
}

#[cfg(test)]
mod tests;
