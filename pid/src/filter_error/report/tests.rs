//! pid tests: what filter error reports, by hand.

use super::*;
use crate::filter_error::filter::tests::{NOISE, shaken};
use crate::filter_error::likelihood::tests::point;
use crate::filter_error::point::Sought;
use crate::output_error::PreparedRun;
use crate::output_error::flown::erring;
use nalgebra::DVector;

/// Standard deviations by column, four unknowns first, and correlations that nothing here may look at.
fn covariance(random: [f64; RANDOM]) -> DMatrix<f64> {
    let std: Vec<f64> = [0.01; 4].into_iter().chain(random).collect();
    DMatrix::from_fn(std.len(), std.len(), |i, j| if i == j { std[i] * std[i] } else { 0.01 * std[i] * std[j] })
}

/// A logarithm's standard error s makes an estimate e one of e s, between e exp(∓1.96 s); a size that cannot be told has its limit
/// instead, and neither it nor its scale is estimated.
#[test]
fn exact_random_estimates() {
    let plant = erring();
    let here = point(&plant);
    let relative = [0.11, 0.23, 0.31, 0.43, 0.57, 0.13];
    let free = random_estimates(&here, &covariance(relative));
    assert_eq!(free.iter().map(|e| e.name.as_str()).collect::<Vec<_>>(), NAMES.map(|n| n.1));
    for (k, e) in free.iter().enumerate() {
        let (value, s) = (here.random[k].exp(), relative[k]);
        let expected = [value, value * s, value * (-1.959_964 * s).exp(), value * (1.959_964 * s).exp()];
        for (found, expected) in [e.estimate, e.std_error, e.ci95[0], e.ci95[1]].into_iter().zip(expected) {
            assert!((found / expected - 1.0).abs() < 1e-6, "{k}: {e:?}");
        }
    }
    let without = SearchPoint { negligible: [Some(0.004), None, None, None], ..here.clone() };
    let left = random_estimates(&without, &covariance(relative));
    assert_eq!(left.iter().map(|e| e.name.as_str()).collect::<Vec<_>>(), [0, 1, 3, 4, 5].map(|k| NAMES[k].1));
    assert!(left[0].estimate == 0.0 && (left[0].std_error - 0.004).abs() < 1e-15 && left[0].ci95[0] == 0.0);
    assert!((left[0].ci95[1] - 1.959_964 * 0.004).abs() < 1e-8, "{:?}", left[0]);
    // Scales that were not sought are named, but for that of the gust that is not there.
    let held = held_scales(&SearchPoint { sought: Sought { scales: false, turning: true }, ..without });
    assert!(held.len() == 1 && held[0].name == NAMES[3].1 && (held[0].value - here.random[3].exp()).abs() < 1e-15, "{held:?}");
    assert!(held_scales(&here).is_empty());
}

/// A scale whose logarithm is told no better than half its prior's is the prior's; one that is held is nobody's.
#[test]
fn pub_warnings_of_the_random_drive() {
    let plant = erring();
    let warned = |scales: bool, random: [f64; RANDOM]| {
        let mut warnings = Vec::new();
        let here = SearchPoint { sought: Sought { scales, turning: false }, ..point(&plant) };
        report_random("x", &here, &covariance(random), &mut warnings);
        warnings
    };
    assert!(warned(true, [0.9, 0.9, 0.49, 0.49, 0.9, 0.9]).is_empty());
    for k in [2, 3] {
        let mut random = [0.3; RANDOM];
        random[k] = 0.51;
        let found = warned(true, random);
        assert!(found.len() == 1 && found[0].contains(&format!("{} is determined by its prior", NAMES[k].1)), "{found:?}");
    }
    let held = warned(false, [0.9; RANDOM]);
    assert!(held.len() == 1 && held[0].contains("held at 0.6 m"), "{held:?}");
}

/// Two runs: what is left over the sum of squares about each run's mean, and the root of what is left by sample, angles in degrees.
#[test]
fn exact_fits_of_the_channels() {
    let plant = erring();
    let record = shaken(&plant);
    let run = PreparedRun::new("shaken", &record, &plant).expect("it can be integrated");
    let white = |s: f64| std::array::from_fn(|c| (0..27).map(|i| (f64::from(7 * i * i) * s + c as f64).sin()).collect());
    let now = LocalLikelihood {
        log_likelihood2: 0.0,
        score: DVector::zeros(0),
        information: DMatrix::zeros(0, 0),
        whitened: vec![white(1.0), white(0.7)],
        left: std::array::from_fn(|c| 0.003 * (1.3 + c as f64)),
        samples: 54.0,
    };
    let fits = channel_fits(&[Filter::new(&run, NOISE), Filter::new(&run, NOISE)], &now);
    for (c, fit) in fits.iter().enumerate() {
        let x = record.channels()[c];
        let total = 2.0 * (x.iter().map(|v| v * v).sum::<f64>() - x.iter().sum::<f64>().powi(2) / 27.0);
        let unit = if (3..6).contains(&c) { 180.0 / std::f64::consts::PI } else { 1.0 };
        // Positions and speeds of order 7 squared, less a mean's: rounding 1e-13 of sums of order 0.1.
        assert!((fit.r2 - (1.0 - now.left[c] / total)).abs() < 1e-9 * (1.0 + now.left[c] / total), "{c}: {fit:?} {total}");
        assert!((fit.residual_std / (unit * (now.left[c] / 54.0).sqrt()) - 1.0).abs() < 1e-13, "{c}: {fit:?}");
    }
}

/// Correlations of two estimates: eigenvalues 1 ± r, whatever their units.
#[test]
fn exact_condition_number_of_two() {
    for (a, b, r) in [(0.3, 7.0, 0.6), (1e-4, 50.0, -0.96)] {
        let m = DMatrix::from_row_slice(2, 2, &[a * a, a * b * r, a * b * r, b * b]);
        let expected = f64::sqrt((1.0 + f64::abs(r)) / (1.0 - f64::abs(r)));
        assert!((condition_number(&m) / expected - 1.0).abs() < 1e-13, "{}", condition_number(&m));
    }
}
