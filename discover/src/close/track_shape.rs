//! discover: how the residuals of tracks are distributed and follow from one another, for the page. In: residuals of bodies without attitude
//! or of poses, before and after. Out: a histogram and an autocorrelation for every channel.

use super::figure::{Figure, Role, Series, Topic, histogram, short};
use crate::tracks::TrackResidual;
use windfall_pid::NORMAL_95;
use windfall_replay::quantile;

/// Lags of an autocorrelation.
const LAGS: usize = 50;
/// Share of a side's residuals inside its reach.
const INSIDE: f64 = 0.995;
/// A histogram ends at so many reaches of the narrowest side: a model that is far off would leave the other as one bin.
const WIDEST: f64 = 3.0;

/// A channel to draw.
pub(super) struct ShapeChannel {
    /// Place in [`TrackResidual::residual_m`].
    pub(super) place: usize,
    pub(super) name: &'static str,
    /// Factor to the unit of the page, and that unit.
    pub(super) per_unit: f64,
    pub(super) unit: &'static str,
    /// Sensor noise of one sample as stated, in the unit of the record; zero where none is.
    pub(super) stated_std: f64,
}

/// Two figures of a channel; none where it was not measured.
pub(super) fn shapes(c: &ShapeChannel, sides: &[(Role, Vec<TrackResidual>)]) -> Vec<Figure> {
    let of = |runs: &[TrackResidual]| -> Vec<Vec<f64>> {
        let own = runs.iter().filter_map(|r| r.residual_m[c.place].as_ref());
        own.map(|e| e.iter().map(|x| c.per_unit * x).collect()).collect()
    };
    let sides: Vec<(Role, Vec<Vec<f64>>)> =
        sides.iter().map(|(role, runs)| (*role, of(runs))).filter(|(_, runs)| runs.iter().any(|r| r.len() > 1)).collect();
    if sides.is_empty() { Vec::new() } else { vec![distribution(c, &sides), correlation(c, &sides)] }
}

fn distribution(c: &ShapeChannel, sides: &[(Role, Vec<Vec<f64>>)]) -> Figure {
    let reach = |(_, runs): &(Role, Vec<Vec<f64>>)| {
        let mut sizes: Vec<f64> = runs.iter().flatten().map(|x| x.abs()).collect();
        sizes.sort_by(f64::total_cmp);
        quantile(&sizes, INSIDE)
    };
    let (least, most) = sides.iter().map(reach).fold((f64::INFINITY, 0.0), |(a, b): (f64, f64), r| (a.min(r), b.max(r)));
    let std = c.per_unit * c.stated_std;
    let end = most.min(WIDEST * least).max(4.0 * std).max(f64::MIN_POSITIVE);
    let mut series = Vec::new();
    // A bell much narrower than the residual would be a spike that hides it.
    if std > 0.05 * end {
        let x: Vec<f64> = (-40..=40).map(|k| short(f64::from(k) * 0.1 * std)).collect();
        let bell = |x: &f64| short((-0.5 * (x / std).powi(2)).exp() / (std * std::f64::consts::TAU.sqrt()));
        series.push(Series { role: Role::Noise, y: x.iter().map(bell).collect(), x, ..Series::default() });
    }
    series.extend(sides.iter().map(|(role, runs)| histogram(*role, &runs.concat(), [-end, end])));
    Figure {
        topic: Topic::Shape,
        title: format!("{}: distribution of the residual", c.name),
        x_label: format!("residual ({})", c.unit),
        y_label: format!("density (1/{})", c.unit),
        series,
        ..Figure::default()
    }
}

fn correlation(c: &ShapeChannel, sides: &[(Role, Vec<Vec<f64>>)]) -> Figure {
    let lags: Vec<f64> = (1..=LAGS).map(|k| k as f64).collect();
    let count: usize = sides[0].1.iter().map(Vec::len).sum();
    let bound = short(NORMAL_95 / (count.max(1) as f64).sqrt());
    let flat = |y: f64| Series { role: Role::Noise, x: lags.clone(), y: vec![y; LAGS], ..Series::default() };
    let mut series = vec![flat(bound), flat(-bound)];
    series.extend(sides.iter().map(|(role, runs)| Series {
        role: *role,
        x: lags.clone(),
        y: autocorrelation(runs),
        ..Series::default()
    }));
    Figure {
        topic: Topic::Shape,
        title: format!("{}: autocorrelation of the residual", c.name),
        x_label: "lag (samples)".to_owned(),
        y_label: "correlation (1)".to_owned(),
        series,
        ..Figure::default()
    }
}

/// Correlation with the residual one, two … samples earlier in the same run, about zero, all runs together.
fn autocorrelation(runs: &[Vec<f64>]) -> Vec<f64> {
    let product = |lag: usize| -> f64 { runs.iter().map(|x| x.iter().skip(lag).zip(x).map(|(a, b)| a * b).sum::<f64>()).sum() };
    let variance = product(0).max(f64::MIN_POSITIVE);
    (1..=LAGS).map(|lag| short(product(lag) / variance)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use windfall_model::Measured;

    fn residual(x: Vec<f64>) -> TrackResidual {
        let t_s = (0..x.len()).map(|i| i as f64).collect();
        let residual_m = [Some(x), None, None, None, None, None];
        TrackResidual { run: 0, measured: Measured::Position, t_s, residual_m, position_m: [0.0; 3], velocity_m_s: [0.0; 3] }
    }

    /// An alternating residual of 2 mm in a run of 1000 samples: two bins, correlation (−1)ᵏ(1 − k/1000); a channel not measured has nothing.
    #[test]
    fn exact_an_alternating_residual() {
        let x = (0..1000).map(|i| if i % 2 == 0 { 0.002 } else { -0.002 }).collect();
        let sides = [(Role::Before, vec![residual(x)])];
        let channel = |place| ShapeChannel { place, name: "X", per_unit: 1e3, unit: "mm", stated_std: 0.001 };
        let all = shapes(&channel(0), &sides);
        let (bell, own) = (&all[0].series[0], &all[0].series[1]);
        let peak = bell.y.iter().copied().fold(0.0, f64::max);
        assert!((peak - 0.398_942).abs() < 1e-5, "{peak}");
        // Each value stands twice, at both ends of its bin.
        assert_eq!(own.y.iter().filter(|d| **d > 0.0).count(), 4);
        let width = own.x[1] - own.x[0];
        assert!((own.y.iter().sum::<f64>() * width * 0.5 - 1.0).abs() < 1e-4);
        for (k, r) in all[1].series[2].y.iter().enumerate() {
            let lag = (k + 1) as f64;
            let sign = if k % 2 == 0 { -1.0 } else { 1.0 };
            assert!((r - sign * (1.0 - lag / 1000.0)).abs() < 1e-5, "{lag}: {r}");
        }
        assert!(shapes(&channel(1), &sides).is_empty());
    }

    /// Sides of ±1.7 and ±9 mm: the histogram ends at three times the lesser, or at four standard deviations of the stated noise
    /// where that is more; a bell is drawn where its standard deviation is over a twentieth of the end.
    #[test]
    fn exact_ends_and_bell_of_a_distribution() {
        let flat = |size: f64| vec![residual((0..60).map(|i| if i % 2 == 0 { size } else { -size }).collect())];
        let sides = [(Role::Before, flat(0.009)), (Role::After, flat(0.0017))];
        for (std_mm, end, drawn) in [(0.2, 5.1, false), (0.3, 5.1, true), (2.0, 8.0, true)] {
            let c = ShapeChannel { place: 0, name: "X", per_unit: 1e3, unit: "mm", stated_std: 1e-3 * std_mm };
            let all = shapes(&c, &sides);
            let own = &all[0].series[all[0].series.len() - 1];
            assert!((own.x[79] - end).abs() < 1e-4 && (own.x[0] + end).abs() < 1e-4, "{std_mm}: {:?}", own.x);
            assert_eq!(all[0].series[0].role == Role::Noise, drawn, "{std_mm}");
            if drawn {
                let bell = &all[0].series[0];
                assert!((bell.x[80] - 4.0 * std_mm).abs() < 1e-5 && (bell.x[50] - std_mm).abs() < 1e-5, "{:?}", bell.x);
                let one = (-0.5_f64).exp() / (std_mm * std::f64::consts::TAU.sqrt());
                assert!((bell.y[50] / one - 1.0).abs() < 1e-5, "{} {one}", bell.y[50]);
            }
            // 19 of 20 correlations of 60 numbers without any are within ±1.959964/√60, written to five digits.
            let bounds = [&all[1].series[0], &all[1].series[1]].map(|s| s.y[7]);
            assert!((bounds[0] - 0.253_03).abs() < 1e-9 && (bounds[1] + 0.253_03).abs() < 1e-9, "{bounds:?}");
        }
    }

    /// Two runs of crooked numbers: products within each, by hand.
    #[test]
    fn exact_correlation_of_two_short_runs() {
        let r = autocorrelation(&[vec![0.7, -1.9, 3.1], vec![0.4, 2.0]]);
        let square = 0.49 + 3.61 + 9.61 + 0.16 + 4.0;
        for (found, product) in r.iter().zip([-1.33 - 5.89 + 0.8, 2.17, 0.0]) {
            assert!((found - product / square).abs() < 1e-6, "{r:?}");
        }
    }
}
