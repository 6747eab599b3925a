//! discover: a figure as series. In: nothing. Out: what `figures.json` holds.

use serde::{Deserialize, Serialize};

/// Longest curve, points.
const POINTS: usize = 300;
/// Bins of a histogram.
const BINS: usize = 40;

/// What a series is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Role {
    /// Measured.
    #[default]
    Measured,
    /// With the declared model.
    Before,
    /// With the effects added.
    After,
    /// What noise alone would leave.
    Noise,
}

/// One curve.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Series {
    /// What it is.
    pub role: Role,
    /// Abscissae, in the unit that the figure's label names.
    pub x: Vec<f64>,
    /// Ordinates.
    pub y: Vec<f64>,
    /// Lower and upper ends of a band about it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub band: Option<[Vec<f64>; 2]>,
    /// Drawn as points, and its band as error bars; in the order of the abscissae.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub points: bool,
}

/// What a figure is about.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Topic {
    /// Held-out runs flown again.
    Trajectory,
    /// Residual over a variable.
    #[default]
    Variable,
    /// Spectrum of a residual.
    Spectrum,
    /// How Θ and ω_q,r of runs held out are distributed.
    Distribution,
    /// How the residuals of tracks are distributed and correlated.
    Shape,
    /// Static coefficients against wind-tunnel points.
    Static,
    /// Whitened residuals of tracks.
    Whitened,
    /// What every run lacks over its settings.
    Setting,
}

/// One figure.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Figure {
    /// What it is about.
    pub topic: Topic,
    /// Title.
    pub title: String,
    /// Abscissa with unit.
    pub x_label: String,
    /// Ordinate with unit.
    pub y_label: String,
    /// Whether ordinates are read on a logarithmic scale.
    pub log_y: bool,
    /// Whether abscissae are.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub log_x: bool,
    /// Abscissae that are marked by a line.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub marks: Vec<f64>,
    /// Abscissae between which the ordinates set the scale, where not all do: curves may leave the figure beyond.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub interior: Option<[f64; 2]>,
    /// Curves.
    pub series: Vec<Series>,
}

/// Every so-manieth point, so that a curve has at most [`POINTS`].
pub(super) fn thinned(role: Role, x: &[f64], y: &[f64]) -> Series {
    let n = x.len().min(y.len());
    let stride = n.div_ceil(POINTS).max(1);
    let some = |s: &[f64]| s[..n].iter().step_by(stride).map(|v| short(*v)).collect();
    Series { role, x: some(x), y: some(y), ..Series::default() }
}

/// Every so-manieth time, from the first sample.
pub(super) fn times(t_s: &[f64], thin: usize) -> Vec<f64> {
    t_s.iter().step_by(thin).map(|t| short(t - t_s[0])).collect()
}

/// Six digits: more cannot be seen.
pub(crate) fn short(x: f64) -> f64 {
    format!("{x:.5e}").parse().unwrap_or(x)
}

/// Density of all values in bins of equal width between two ends, as steps: both ends of every bin. What lies beyond is not drawn, so that
/// the area is the share inside.
pub(super) fn histogram(role: Role, values: &[f64], [low, high]: [f64; 2]) -> Series {
    let width = (high - low) / BINS as f64;
    let mut counts = [0_u32; BINS];
    let usable = || values.iter().filter(|v| v.is_finite());
    for v in usable() {
        if let Some(n) = bin((v - low) / width).and_then(|b| counts.get_mut(b)) {
            *n += 1;
        }
    }
    let whole = usable().count().max(1) as f64 * width;
    let (mut x, mut y) = (Vec::with_capacity(2 * BINS), Vec::with_capacity(2 * BINS));
    for (k, n) in counts.iter().enumerate() {
        let left = low + k as f64 * width;
        x.extend([short(left), short(left + width)]);
        y.extend([short(f64::from(*n) / whole); 2]);
    }
    Series { role, x, y, ..Series::default() }
}

/// Number of the bin at a place along bins of width one; none below the first.
pub(super) fn bin(place: f64) -> Option<usize> {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "not below zero; too large is beyond any bin")]
    (place >= 0.0).then_some(place as usize)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of four values one lies beyond the ends: the area is three quarters, and no bin stands for what is outside.
    #[test]
    fn exact_a_histogram_is_cut_at_its_ends() {
        let s = histogram(Role::After, &[-0.88, 0.11, 0.12, 7.0], [-1.0, 1.0]);
        let area: f64 = s.x.chunks(2).zip(s.y.chunks(2)).map(|(x, y)| (x[1] - x[0]) * y[0]).sum();
        assert!((area - 0.75).abs() < 1e-4, "{area}");
        assert!(s.y[2 * BINS - 1] == 0.0 && s.y[4] > 0.0, "{:?}", s.y);
    }

    /// Forty bins from −1.3 to 0.9 are 0.055 wide, each with both of its ends.
    #[test]
    fn exact_ends_of_bins() {
        let s = histogram(Role::After, &[], [-1.3, 0.9]);
        assert_eq!(s.x.len(), 80);
        for (k, x) in s.x.chunks(2).enumerate() {
            let left = -1.3 + 0.055 * k as f64;
            // Six digits are kept.
            assert!((x[0] - left).abs() < 1e-5 && (x[1] - left - 0.055).abs() < 1e-5, "{k}: {x:?}");
        }
    }
}
