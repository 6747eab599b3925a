//! discover tests: series of tracks against a swing without gravity, which turns evenly.

use super::*;
use crate::close::tests::{body, campaign};
use windfall_model::{Pivot, PointRecord};

#[test]
fn exact_circle_of_an_area() {
    assert!((circle_m(std::f64::consts::PI * 0.09) - 0.6).abs() < 1e-15);
}

/// Without gravity and friction an arm turns evenly: what is simulated is the straight line by least squares, here by a
/// factorisation, and its rate, in degrees. The clock starts at 5 s.
#[test]
fn exact_angle_and_rate_of_an_arm_without_gravity() {
    let mut plant = body();
    plant.environment.gravity_m_s2 = 0.0;
    plant.point.pivot = Some(Pivot { arm_m: 0.3, inertia_kg_m2: 0.001, viscous_n_m_s: 0.0, dry_n_m: 0.0 });
    let t: Vec<f64> = (0..13).map(|i| 0.1 * f64::from(i)).collect();
    let angle: Vec<f64> = t.iter().map(|t| 0.3 + 0.5 * t + 0.02 * (900.0 * t * t).sin()).collect();
    let record = PointRecord {
        t_s: t.iter().map(|t| t + 5.0).collect(),
        position_m: [Some(angle.clone()), None, None],
        measured: Measured::Angle,
        ..PointRecord::default()
    };
    let c = campaign(plant, &[], vec![(Vec::new(), record)]);
    let sides = Sides { before: c.plant.clone(), after: None };
    let run = &points(&c, &sides, 1).expect("flies")[0];
    let a = nalgebra::DMatrix::from_fn(13, 2, |r, k| if k == 0 { 1.0 } else { t[r] });
    let line = a.svd(true, true).solve(&nalgebra::DVector::from_column_slice(&angle), 1e-12).expect("a line");
    let [swing, rate] = run.channels.as_slice() else { panic!("{run:?}") };
    // Six digits are kept.
    let near = |a: f64, b_rad: f64| (a - b_rad.to_degrees()).abs() < 1e-5 * a.abs();
    for i in 0..13 {
        assert!((run.t_s[i] - t[i]).abs() < 1e-9 && near(swing.measured[i], angle[i]), "{run:?}");
        assert!(near(swing.before[i], line[0] + line[1] * t[i]) && near(rate.before[i], line[1]), "{i}: {run:?} {line}");
    }
    let slope = (2.0 * (angle[7] - angle[3]) + angle[6] - angle[4]) / (10.0 * 0.1);
    assert!(near(rate.measured[5], slope), "{} {slope}", rate.measured[5]);
    assert!(swing.noise_std.is_some_and(|s| near(s, 0.01)), "{swing:?}");
}
