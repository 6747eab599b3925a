//! discover tests: settings in standard units against their covariance by hand, and coefficients in either units.

use super::*;
use crate::close::tests::{body, campaign};
use windfall_model::effects::find;
use windfall_model::{Acts, PointRecord};

fn flown(names: &[&str], inputs: &[Vec<f64>]) -> Campaign {
    campaign(body(), names, inputs.iter().map(|u| (u.clone(), PointRecord::default())).collect())
}

fn standard(c: &Campaign) -> Vec<Vec<f64>> {
    let runs: Vec<usize> = (0..c.runs.len()).collect();
    Settings::of(c, &runs).standardised(c).runs.into_iter().map(|r| r.inputs).collect()
}

fn mean_product(all: &[Vec<f64>], i: usize, j: usize) -> f64 {
    all.iter().map(|u| u[i] * u[j]).sum::<f64>() / all.len() as f64
}

const TWO: [[f64; 2]; 5] = [[20.0, 0.3], [35.0, 0.1], [28.0, 0.45], [50.0, 0.2], [41.0, 0.38]];

/// Correlated settings of unlike units have no mean, unit scatter and no correlation. One that no run changes by more than
/// rounding, or that follows another one, adds no direction. To rounding of an eigenvalue problem.
#[test]
fn exact_standard_settings_are_uncorrelated() {
    let two: Vec<Vec<f64>> = TWO.iter().map(|u| u.to_vec()).collect();
    let s = standard(&flown(&["rev_s", "tilt"], &two));
    for i in 0..2 {
        assert!(s.iter().map(|u| u[i]).sum::<f64>().abs() < 1e-12);
        assert!((0..2).all(|j| (mean_product(&s, i, j) - f64::from(u8::from(i == j))).abs() < 1e-12), "{s:?}");
    }
    // Scatters of 1e-5 and 5e-7 of the mean.
    for (step, differs) in [(0.01, 1.0), (5e-4, 0.0)] {
        let one: Vec<Vec<f64>> = [-1.0, 1.0].map(|k| vec![1000.0 + k * step]).to_vec();
        let s = standard(&flown(&["speed"], &one));
        assert!((mean_product(&s, 0, 0) - differs).abs() < 1e-6, "{step}: {s:?}");
    }
    let tied: Vec<Vec<f64>> = TWO.iter().map(|u| vec![u[0], 3.0 - 0.2 * u[0]]).collect();
    let s = standard(&flown(&["rev_s", "tilt"], &tied));
    let mut scatter = [mean_product(&s, 0, 0), mean_product(&s, 1, 1)];
    scatter.sort_by(f64::total_cmp);
    assert!(scatter[0] < 1e-12 && (scatter[1] - 1.0).abs() < 1e-12, "{scatter:?}");
}

/// A run whose setting was recorded row by row counts as 64 of them, from the first to the last: of 64 rows each one, of 127 every
/// other one.
#[test]
fn exact_mean_of_recorded_settings() {
    for rows in [64, 127] {
        let series: Vec<f64> = (0..rows).map(|i| 5.0 + (i * i) as f64 / 300.0).collect();
        let by = rows / 63;
        let mean = (0..64).map(|i| series[by * i]).sum::<f64>() / 64.0;
        let mut c = flown(&["tilt"], &[vec![0.0], vec![7.5]]);
        if let Data::Point(record) = &mut c.runs[0].data {
            record.recorded_inputs = vec![(0, series)];
        }
        let s = Settings::of(&c, &[0, 1]);
        assert!((s.mean[0] - f64::midpoint(mean, 7.5)).abs() < 1e-12, "{rows}: {} {mean}", s.mean[0]);
    }
}

/// A coefficient at the settings of any run is the same in either units, whatever its constant and slopes; and back. Constant and
/// slopes are within what a body can have, 1.5.
#[test]
fn law_coefficients_are_the_same_in_either_units() {
    let two: Vec<Vec<f64>> = TWO.iter().map(|u| u.to_vec()).collect();
    let c = flown(&["rev_s", "tilt"], &two);
    let settings = Settings::of(&c, &[0, 1, 2, 3, 4]);
    let instance = settings.null(find("spin-lift", Acts::PointMass).expect("in the catalogue"), &c);
    for p in &instance.parameters {
        assert!((p.low + 1.5).abs() < 1e-15 && (p.high - 1.5).abs() < 1e-15 && (p.step - 1.5e-3).abs() < 1e-15, "{p:?}");
    }
    // Two slopes and a constant of lift, then of side force.
    let values = [0.3, -0.7, 0.9, 0.2, 1.1, -0.4];
    let own = settings.outward_map(&instance.parameters) * DVector::from_column_slice(&values);
    let at = |k: &[f64], u: &[f64]| k[0] * u[0] + k[1] * u[1] + k[2];
    for (u, s) in two.iter().zip(standard(&c)) {
        for from in [0, 3] {
            let (a, b) = (at(&own.as_slice()[from..], u), at(&values[from..], &s));
            assert!((a - b).abs() < 1e-12, "{a} {b}");
        }
    }
    let back = settings.inward(instance, own.as_slice()).values;
    assert!(back.iter().zip(values).all(|(a, b)| (a - b).abs() < 1e-9), "{back:?}");
}
