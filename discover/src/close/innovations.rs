//! discover: shape of the innovations. In: whitened innovations before and after. Out: histograms and autocorrelations per channel.

use super::figure::{bin, short};
use serde::{Deserialize, Serialize};
use windfall_likelihood::{Engine, Innovations, Model};
use windfall_model::{CHANNEL_NAMES, POSE};

/// Ends of the histograms, standard deviations.
const ENDS: [f64; 2] = [-5.0, 5.0];
/// Bins of a histogram, and lags of an autocorrelation.
const BINS: usize = 40;
const LAGS: usize = 50;

/// Histogram and autocorrelation of a channel's whitened innovations, over all identified runs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct InnovationLine {
    /// Channel.
    pub channel: String,
    /// Time from one innovation to the next, s.
    pub step_s: f64,
    /// With the declared model.
    pub before: InnovationShape,
    /// With the effects added.
    pub after: InnovationShape,
}

/// How innovations are distributed, and how each follows from those before it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct InnovationShape {
    /// Number of innovations.
    pub count: usize,
    /// Lower and upper end of the histogram, standard deviations; what lies beyond is in no bin.
    pub ends: [f64; 2],
    /// Density of all in bins of equal width, so that their area is the share inside the ends: of standard normal innovations `exp(−x²/2)/√(2π)`.
    pub density: Vec<f64>,
    /// Correlation with the innovation one, two … steps earlier; of white noise within ±1.96/√count, 19 times of 20.
    pub autocorrelation: Vec<f64>,
}

/// Of every channel; none where a model departs.
pub(super) fn lines(engine: &Engine, before: &Model, after: &Model) -> Vec<InnovationLine> {
    let (Some(before), Some(after)) = (engine.innovations(before), engine.innovations(after)) else { return Vec::new() };
    let step_s = after.first().map_or(0.0, |r| r.step_s);
    (0..POSE)
        .map(|c| InnovationLine {
            channel: CHANNEL_NAMES[c].to_owned(),
            step_s,
            before: shape(&before, c),
            after: shape(&after, c),
        })
        .collect()
}

fn shape(runs: &[Innovations], channel: usize) -> InnovationShape {
    let width = (ENDS[1] - ENDS[0]) / BINS as f64;
    let mut counts = [0_u32; BINS];
    let mut products = [0.0; LAGS + 1];
    let mut count = 0;
    for run in runs {
        // An exact zero was not measured.
        let x: Vec<f64> = run.rows.iter().map(|r| r[channel]).collect();
        for v in x.iter().filter(|v| **v != 0.0 && v.is_finite()) {
            if let Some(n) = bin((v - ENDS[0]) / width).and_then(|b| counts.get_mut(b)) {
                *n += 1;
            }
            count += 1;
        }
        for (lag, p) in products.iter_mut().enumerate() {
            *p += x.iter().skip(lag).zip(&x).map(|(a, b)| a * b).sum::<f64>();
        }
    }
    let whole = count.max(1) as f64 * width;
    let variance = products[0].max(f64::MIN_POSITIVE);
    InnovationShape {
        count,
        ends: ENDS,
        density: counts.iter().map(|n| short(f64::from(*n) / whole)).collect(),
        autocorrelation: products[1..].iter().map(|p| short(p / variance)).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A series that alternates between one and minus one: two bins, correlation −1 at odd lags and 1 at even, less the ends.
    #[test]
    fn exact_an_alternating_series() {
        let rows = (0..1000).map(|i| [if i % 2 == 0 { 1.1 } else { -1.1 }; POSE]).collect();
        let s = shape(&[Innovations { run: 0, step_s: 0.02, rows }], 3);
        assert_eq!(s.count, 1000);
        assert_eq!(s.density.iter().filter(|d| **d > 0.0).count(), 2);
        assert!((s.density.iter().sum::<f64>() * 0.25 - 1.0).abs() < 1e-12, "a density");
        // Products of the overlap over all: (1000 − lag)/1000, in four digits.
        for (k, r) in s.autocorrelation.iter().enumerate() {
            let lag = (k + 1) as f64;
            let sign = if k % 2 == 0 { -1.0 } else { 1.0 };
            assert!((r - sign * (1.0 - lag / 1000.0)).abs() < 1e-4, "{lag}: {r}");
        }
    }

    /// Four crooked numbers: sums of products by hand.
    #[test]
    fn exact_correlation_of_four() {
        let x = [0.7, -1.9, 3.1, 0.4];
        let rows = x.iter().map(|x| [*x; POSE]).collect();
        let s = shape(&[Innovations { run: 0, step_s: 0.02, rows }], 1);
        let square = 0.49 + 3.61 + 9.61 + 0.16;
        let products = [-1.33 - 5.89 + 1.24, 2.17 - 0.76, 0.28, 0.0];
        assert!(s.autocorrelation.iter().zip(products).all(|(r, p)| (r - p / square).abs() < 1e-6), "{:?}", s.autocorrelation);
    }
}
