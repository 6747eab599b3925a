//! likelihood: noise of the pose channels, learnt from the record. In: records. Out: size and colour of each channel's noise.
//!
//! Above the motion's frequencies the spectrum of a channel's differences is its noise alone. White noise plus a first-order
//! autoregressive one is fitted there by Whittle's likelihood (Whittle 1953); what is declared is a prior where little is seen.

use crate::spectrum::periodogram;
use windfall_model::{CHANNELS, POSE, PerChannel, Record, Sensors};

/// Noise of one channel: variance of its samples' white part, and variance and lag-one correlation of its coloured part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChannelNoise {
    /// Variance of the white part, SI (rad).
    pub white: f64,
    /// Variance of the coloured part.
    pub coloured: f64,
    /// Correlation of the coloured part from one sample to the next, in [0, 1).
    pub correlation: f64,
}

impl ChannelNoise {
    /// White noise of that standard deviation.
    #[must_use]
    pub fn white(std: f64) -> Self {
        Self { white: std * std, coloured: 0.0, correlation: 0.0 }
    }
    /// Standard deviation of a sample.
    #[must_use]
    pub fn std(&self) -> f64 {
        (self.white + self.coloured).sqrt()
    }
    /// Logarithm of the noise's variance in a spectrum over this one's, and the variance of that logarithm; none of too few ordinates of noise alone.
    fn log_ratio(&self, spectrum: &[Ordinate]) -> Option<[f64; 2]> {
        let r = self.correlation;
        let expected = |o: &Ordinate| self.white + self.coloured * (1.0 - r * r) / (1.0 + r * r - 2.0 * r * o.w.cos());
        let ratios: Vec<f64> = spectrum.iter().filter(|o| o.noise_alone).map(|o| o.power / expected(o)).collect();
        let n = ratios.len() as f64;
        // A window makes neighbours alike: half of the ordinates are independent.
        (ratios.len() >= FEWEST).then(|| [mean_of_exponential(&ratios).ln(), 2.0 / n])
    }
    /// With that many times the variance.
    #[must_use]
    pub(crate) fn times(self, ratio: f64) -> Self {
        Self { white: ratio * self.white, coloured: ratio * self.coloured, ..self }
    }
    /// The coloured part of means of `m` samples in a row, by which the last sample leads to the next mean: a mean of a first-order process is
    /// none itself.
    pub(crate) fn of_means(&self, m: usize) -> MeanNoise {
        let (n, r) = (m as f64, self.correlation);
        let power = |k: usize| r.powi(i32::try_from(k).unwrap_or(i32::MAX));
        let drive = self.coloured * (1.0 - r * r);
        // What sample j's own noise does to the mean and to the last sample.
        let in_mean = |j: usize| (j..=m).map(|i| power(i - j)).sum::<f64>() / n;
        let sum = |f: &dyn Fn(usize) -> f64| drive * (1..=m).map(f).sum::<f64>();
        let added = [sum(&|j| in_mean(j).powi(2)), sum(&|j| in_mean(j) * power(m - j)), sum(&|j| power(m - j).powi(2))];
        let by_last = [(1..=m).map(power).sum::<f64>() / n, power(m)];
        let [a, b] = by_last;
        let stationary = [a * a, a * b, b * b].map(|x| x * self.coloured);
        MeanNoise { by_last, added, stationary: std::array::from_fn(|i| stationary[i] + added[i]) }
    }
}

/// Coloured noise of means of samples: the mean and its last sample, by the last sample before. Covariances are those of mean and mean, mean and
/// last, last and last.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MeanNoise {
    pub(crate) by_last: [f64; 2],
    pub(crate) added: [f64; 3],
    pub(crate) stationary: [f64; 3],
}

/// Lowest frequency that is noise alone, Hz, at least this share of the sample rate; and from where motion is told from noise by its
/// steep spectrum, Hz.
const ABOVE_HZ: f64 = 10.0;
const ABOVE_SHARE: f64 = 0.08;
const WITH_MOTION_HZ: f64 = 3.5;
/// Above its modes, motion under forces with spectra that fall with the square of frequency has one that falls with the sixth power.
const STEEP: i32 = 6;
/// Gain of log-likelihood that speaks for coloured noise, and for colours that differ between channels.
const COLOUR: f64 = 20.0;
const DIFFERENT: f64 = 60.0;

/// Declared noise of the channels.
#[must_use]
pub fn declared(s: &Sensors) -> PerChannel<ChannelNoise> {
    s.std_by_channel().map(ChannelNoise::white)
}

/// Learnt noise of the pose channels of these runs together. White noise is measured above the motion; where there is colour, one
/// correlation for all channels is fitted from lower frequencies on, with the motion's steep spectrum beside it, or one for each channel
/// where that says much more.
#[must_use]
pub(crate) fn learn(records: &[&Record], sensors: &Sensors) -> PerChannel<ChannelNoise> {
    let std = sensors.std_by_channel();
    let share = |c: usize| records.iter().map(|r| r.noise_share(c)).fold(1.0, f64::min);
    let prior = std::array::from_fn(|c| ChannelNoise::white(std[c] * share(c).sqrt()));
    let spectra: PerChannel<Vec<Ordinate>> = std::array::from_fn(|c| records.iter().flat_map(|r| spectrum(r, c)).collect());
    if spectra.iter().any(|s| s.iter().filter(|o| o.noise_alone).count() < FEWEST) {
        return prior;
    }
    let plain: PerChannel<f64> = std::array::from_fn(|c| {
        let alone: Vec<Ordinate> = spectra[c].iter().copied().filter(|o| o.noise_alone).collect();
        Search { spectrum: &alone, motion: false }.at(0.0, 0.0).1
    });
    let coloured = (0..CHANNELS).any(|c| {
        let alone: Vec<Ordinate> = spectra[c].iter().copied().filter(|o| o.noise_alone).collect();
        let search = Search { spectrum: &alone, motion: false };
        search.at(0.0, 0.0).0 - best(&[search]).0 > COLOUR
    });
    let white = plain.map(|v| ChannelNoise { white: v, coloured: 0.0, correlation: 0.0 });
    if !coloured {
        return white;
    }
    let searches: Vec<Search<'_>> = spectra.iter().map(|s| Search { spectrum: s, motion: true }).collect();
    let (shared_cost, share, r) = best(&searches);
    let own: Vec<(f64, f64, f64)> = searches.iter().map(|s| best(std::slice::from_ref(s))).collect();
    let own_cost: f64 = own.iter().map(|o| o.0).sum();
    let none: f64 = searches.iter().map(|s| s.at(0.0, 0.0).0).sum();
    if none - shared_cost.min(own_cost) < COLOUR {
        return white;
    }
    std::array::from_fn(|c| {
        let (share, r) = if shared_cost - own_cost > DIFFERENT { (own[c].1, own[c].2) } else { (share, r) };
        let variance = searches[c].at(share, r).1;
        ChannelNoise { white: (1.0 - share) * variance, coloured: share * variance, correlation: r }
    })
}

/// Fewest ordinates of noise alone from which a run's own noise is learnt.
const FEWEST: usize = 50;

/// Variance of the pose noise in each run over that in all runs together, by channel. The ratios are drawn towards one by as much as their own
/// error explains their spread (empirical Bayes: Efron and Morris 1973).
#[must_use]
pub(crate) fn by_run(records: &[&Record], noise: &PerChannel<ChannelNoise>) -> Vec<PerChannel<f64>> {
    let mut all = vec![[1.0; CHANNELS]; records.len()];
    for (c, whole) in noise.iter().enumerate().take(POSE) {
        let seen: Vec<Option<[f64; 2]>> = records.iter().map(|r| whole.log_ratio(&spectrum(r, c))).collect();
        all.iter_mut().zip(shrunk(&seen)).for_each(|(run, log)| run[c] = log.exp());
    }
    all
}

/// Numbers with their variances, drawn towards zero by what their own variances leave of their spread; zero of what is not known.
fn shrunk(seen: &[Option<[f64; 2]>]) -> Vec<f64> {
    let squares: Vec<f64> = seen.iter().flatten().map(|[x, variance]| x * x - variance).collect();
    let spread = (squares.iter().sum::<f64>() / squares.len().max(1) as f64).max(0.0);
    seen.iter().map(|seen| seen.map_or(0.0, |[x, variance]| x * spread / (spread + variance))).collect()
}

/// One ordinate of a spectrum.
#[derive(Clone, Copy, Debug)]
struct Ordinate {
    /// Frequency, rad a sample, and in units of the lowest with motion.
    w: f64,
    ratio: f64,
    power: f64,
    noise_alone: bool,
}

/// Periodogram of a channel from its first differences, motion's lowest frequencies left out.
fn spectrum(record: &Record, channel: usize) -> Vec<Ordinate> {
    let (mut series, measured) = filled(record, channel);
    let mut dt = record.interval_s();
    if let Some(rows) = record.wind_rows.filter(|_| channel == POSE) {
        series = series.into_iter().skip(rows.first).step_by(rows.every).collect();
        dt *= rows.every as f64;
    }
    let n = series.len().saturating_sub(1);
    if n < 64 {
        return Vec::new();
    }
    let steps: Vec<f64> = series.windows(2).map(|w| w[1] - w[0]).collect();
    let mean = steps.iter().sum::<f64>() / n as f64;
    let Some(seen) = periodogram(steps.iter().map(|s| s - mean)) else { return Vec::new() };
    let turn = std::f64::consts::TAU;
    let alone = (ABOVE_HZ * dt).clamp(ABOVE_SHARE, 0.3) * turn;
    let least = (WITH_MOTION_HZ * dt).min(0.2) * turn;
    seen.power
        .iter()
        .enumerate()
        .map(|(k, p)| (turn * k as f64 / n as f64, p / seen.window))
        .filter(|(w, _)| *w > least && *w < 0.99 * std::f64::consts::PI)
        .map(|(w, p)| Ordinate { w, ratio: w / least, power: measured * p / (2.0 - 2.0 * w.cos()), noise_alone: w > alone })
        .collect()
}

/// A channel with noise where samples were bridged too, and the ratio of the noise where five neighbours were measured to that everywhere.
fn filled(record: &Record, channel: usize) -> (Vec<f64>, f64) {
    let mut series = record.channels()[channel].to_vec();
    if !record.bridged.iter().any(|b| *b) {
        return (series, 1.0);
    }
    // Fourth differences: the motion's are small.
    let fourth = |series: &[f64], all: bool| {
        let each: Vec<f64> = series
            .windows(5)
            .zip(record.bridged.windows(5))
            .filter(|(_, b)| all || b.iter().all(|b| !b))
            .map(|(s, _)| (s[0] - 4.0 * s[1] + 6.0 * s[2] - 4.0 * s[3] + s[4]).powi(2) / 70.0)
            .collect();
        each.iter().sum::<f64>() / each.len().max(1) as f64
    };
    let measured = fourth(&series, false);
    // A bridge has about half the variance of its ends, and the sequence without memory has the other half: phases that grow with the square
    // of the place are spread evenly and without correlation (Weyl 1916), of each channel by another number.
    let (std, mut phase, mut turn) = (measured.sqrt(), 0.0, 0.5);
    for (x, _) in series.iter_mut().zip(&record.bridged).filter(|(_, b)| **b) {
        *x += std * (std::f64::consts::TAU * phase).cos();
        turn = (turn + 0.754_877_666_246_692_7_f64 * (1.0 + channel as f64)) % 1.0;
        phase = (phase + turn) % 1.0;
    }
    let ratio = measured / fourth(&series, true).max(1e-300);
    (series, ratio)
}

/// Mean of numbers that are spread exponentially; those far beyond it, as of lines, count as far as such a tail goes.
fn mean_of_exponential(all: &[f64]) -> f64 {
    let n = all.len() as f64;
    let mut mean = all.iter().sum::<f64>() / n;
    for _ in 0..3 {
        mean = all.iter().map(|p| p.min(12.0 * mean)).sum::<f64>() / n;
    }
    mean
}

/// White plus first-order noise, beside a motion's steep spectrum or not, on one channel.
struct Search<'a> {
    spectrum: &'a [Ordinate],
    motion: bool,
}

impl Search<'_> {
    /// Whittle's cost (Whittle 1953) and the noise's variance at a share of coloured noise and its correlation; the motion's size by
    /// trying decades, the variance concentrated out. Ordinates far beyond the mean, as of lines, count as far as an exponential's tail goes.
    fn at(&self, share: f64, r: f64) -> (f64, f64) {
        let shapes: Vec<f64> =
            self.spectrum.iter().map(|o| (1.0 - share) + share * (1.0 - r * r) / (1.0 + r * r - 2.0 * r * o.w.cos())).collect();
        let mut best = (f64::INFINITY, 0.0);
        let sizes: &[f64] =
            if self.motion { &[0.0, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0, 300.0, 1e3, 3e3, 1e4, 1e5] } else { &[0.0] };
        for motion in sizes {
            let whole: Vec<f64> = self.spectrum.iter().zip(&shapes).map(|(o, s)| s + motion * o.ratio.powi(-STEEP)).collect();
            let each: Vec<f64> = self.spectrum.iter().zip(&whole).map(|(o, s)| o.power / s).collect();
            let variance = mean_of_exponential(&each);
            let cost = whole.len() as f64 * variance.ln()
                + whole.iter().map(|s| s.ln()).sum::<f64>()
                + each.iter().map(|p| p.min(12.0 * variance)).sum::<f64>() / variance;
            if cost < best.0 {
                best = (cost, variance);
            }
        }
        best
    }
}

/// Most likely share and correlation for channels together, on a grid that narrows: cost, share, correlation.
fn best(searches: &[Search<'_>]) -> (f64, f64, f64) {
    const LAST: f64 = 0.985;
    let mut best = (f64::INFINITY, 0.0, 0.0);
    let (mut share, mut r) = ([0.0, 1.0], [0.0, LAST]);
    for _ in 0..3 {
        let grid = |[a, b]: [f64; 2], k: usize| a + (b - a) * k as f64 / 8.0;
        for i in 0..=8 {
            for k in 0..=8 {
                let (s, q) = (grid(share, i), grid(r, k));
                let cost: f64 = searches.iter().map(|x| x.at(s, q).0).sum();
                if cost < best.0 {
                    best = (cost, s, q);
                }
            }
        }
        let narrowed = |centre: f64, [a, b]: [f64; 2], high: f64| {
            let width = 0.2 * (b - a);
            [(centre - width).max(0.0), (centre + width).min(high)]
        };
        (share, r) = (narrowed(best.1, share, 1.0), narrowed(best.2, r, LAST));
    }
    best
}

#[cfg(test)]
mod tests;
