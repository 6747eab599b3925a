//! discover: whitened residuals of tracks for the page. In: evidence and the plants before and after. Out: for each axis their size over
//! frequency and their distribution.

use super::figure::{Figure, Role, Series, Topic, histogram, short};
use super::sides::Sides;
use crate::tracks::TrackEvidence;

/// Bands of frequency, even on a logarithmic axis.
const BANDS: usize = 24;
/// Ends of the histogram, standard deviations; what lies beyond is in the outermost bins.
const REACH: f64 = 5.0;

/// Two figures of each axis; none of poses.
pub(super) fn whitened(evidence: &TrackEvidence, sides: &Sides, name: impl Fn(usize) -> &'static str) -> Vec<Figure> {
    let all: Vec<(Role, Vec<_>)> = sides.each().map(|(role, p)| (role, evidence.whitened(&evidence.residual(p)))).collect();
    let Some((_, first)) = all.first() else { return Vec::new() };
    let one = |k: usize| {
        let axis = name(first[k].0);
        let of: Vec<(Role, &[[f64; 2]])> =
            all.iter().filter_map(|(role, axes)| Some((*role, axes.get(k)?.1.as_slice()))).collect();
        [over_frequency(axis, &of), distribution(axis, &of)]
    };
    (0..first.len()).flat_map(one).collect()
}

fn over_frequency(axis: &str, sides: &[(Role, &[[f64; 2]])]) -> Figure {
    let mut series: Vec<Series> = sides.iter().map(|(role, numbers)| banded(*role, numbers)).collect();
    let ends = series.iter().flat_map(|s| &s.x).fold([f64::INFINITY, 0.0_f64], |[a, b], f| [a.min(*f), b.max(*f)]);
    series.insert(0, Series { role: Role::Noise, x: ends.to_vec(), y: vec![1.0; 2], ..Series::default() });
    Figure {
        topic: Topic::Whitened,
        title: format!("{axis}: whitened residual over frequency"),
        x_label: "frequency (Hz)".to_owned(),
        y_label: "rms (standard deviations of the noise)".to_owned(),
        log_y: true,
        log_x: true,
        series,
        ..Figure::default()
    }
}

/// Root mean squares in bands.
fn banded(role: Role, numbers: &[[f64; 2]]) -> Series {
    let ends = numbers.iter().fold([f64::INFINITY, 0.0_f64], |[a, b], x| [a.min(x[0]), b.max(x[0])]);
    let ratio = (ends[1] / ends[0]).ln().max(f64::MIN_POSITIVE);
    let mut sums = [(0.0, 0.0, 0.0); BANDS];
    for [hz, z] in numbers {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a band")]
        let band = (((hz / ends[0]).ln() / ratio * BANDS as f64) as usize).min(BANDS - 1);
        let s = &mut sums[band];
        *s = (s.0 + hz, s.1 + z * z, s.2 + 1.0);
    }
    let filled = sums.iter().filter(|s| s.2 > 0.0);
    let (x, y) = filled.map(|s| (short(s.0 / s.2), short((s.1 / s.2).sqrt()))).unzip();
    Series { role, x, y, ..Series::default() }
}

fn distribution(axis: &str, sides: &[(Role, &[[f64; 2]])]) -> Figure {
    let x: Vec<f64> = (-40..=40).map(|k| f64::from(k) * 0.1).collect();
    let bell = |x: &f64| short((-0.5 * x * x).exp() / std::f64::consts::TAU.sqrt());
    let mut series = vec![Series { role: Role::Noise, y: x.iter().map(bell).collect(), x, ..Series::default() }];
    let values = |numbers: &[[f64; 2]]| numbers.iter().map(|n| n[1]).collect::<Vec<f64>>();
    series.extend(sides.iter().map(|(role, numbers)| histogram(*role, &values(numbers), [-REACH, REACH])));
    Figure {
        topic: Topic::Whitened,
        title: format!("{axis}: distribution of the whitened residual"),
        x_label: "standard deviations of the noise".to_owned(),
        y_label: "density (1)".to_owned(),
        series,
        ..Figure::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers of size two below 1 Hz and of size one above: bands say so, whatever their signs.
    #[test]
    fn exact_size_over_frequency() {
        let numbers: Vec<[f64; 2]> = (1..=400)
            .map(|k| 0.01 * f64::from(k))
            .map(|f| [f, if f < 1.0 { 2.0 } else { 1.0 } * if f.sin() > 0.0 { 1.0 } else { -1.0 }])
            .collect();
        let s = banded(Role::Before, &numbers);
        for (f, y) in s.x.iter().zip(&s.y) {
            assert!(*f > 0.85 && *f < 1.15 || (y - if *f < 1.0 { 2.0 } else { 1.0 }).abs() < 1e-9, "{f} {y}");
        }
    }

    /// Twenty-four bands, each with its mean frequency; numbers of one size have it in all of them.
    #[test]
    fn exact_every_band_is_there() {
        let numbers: Vec<[f64; 2]> = (1..=4000).map(|k| [0.01 * f64::from(k), 1.7]).collect();
        let s = banded(Role::After, &numbers);
        assert!(s.y.len() > 20 && s.y.iter().all(|y| (y - 1.7).abs() < 1e-5), "{s:?}");
        let last: Vec<f64> = numbers.iter().map(|n| n[0]).filter(|f| *f >= 40.0 * 4000.0_f64.powf(-1.0 / 24.0)).collect();
        let mean = last.iter().sum::<f64>() / last.len() as f64;
        assert!((s.x[s.x.len() - 1] / mean - 1.0).abs() < 1e-4, "{} {mean}", s.x[s.x.len() - 1]);
    }

    /// The standard normal density, and a histogram between five standard deviations to either side.
    #[test]
    fn exact_bell_and_ends() {
        let numbers = [[1.0, 0.3], [2.0, -4.9]];
        let f = distribution("X", &[(Role::Before, &numbers)]);
        let (bell, own) = (&f.series[0], &f.series[1]);
        assert!((bell.x[0] + 4.0).abs() < 1e-12 && (bell.x[80] - 4.0).abs() < 1e-12, "{:?}", bell.x);
        // Tables of the normal density.
        for (at, density) in [(0, 0.000_133_830), (30, 0.241_971), (40, 0.398_942), (55, 0.129_518)] {
            assert!((bell.y[at] - density).abs() < 1e-6, "{at}: {}", bell.y[at]);
        }
        assert!((own.x[0] + 5.0).abs() < 1e-12 && (own.x[79] - 5.0).abs() < 1e-12);
        assert!((own.y[0] - 2.0).abs() < 1e-5 && own.y.iter().filter(|y| **y > 0.0).count() == 4, "{:?}", own.y);
    }
}
