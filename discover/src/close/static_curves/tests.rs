//! discover tests: angles of static curves, and bars of wind-tunnel points.

use super::*;
use crate::close::tests::sage;
use windfall_model::{Coefficient, StaticPoint};

/// Sixty steps up to the last angle, of points or of runs; the axisymmetric lander's normal force there. Bars are 1.96 standard
/// deviations, none long where a test states none.
#[test]
fn exact_angles_and_bars() {
    let mut c = sage(1.5);
    let point = |alpha_t_rad, value, std| StaticPoint { alpha_t_rad, value, std };
    let points = vec![point(0.1, 0.5, Some(0.04)), point(0.3, 1.1, None)];
    c.knowledge.wind_tunnel = vec![StaticPoints { test: "t".to_owned(), coefficient: Coefficient::CN, points }];
    for (reached, end) in [(0.25, 0.3), (0.42, 0.42)] {
        let f = &figures(&c, &[(Role::Before, &c.plant)], reached)[0];
        let (curve, points) = (&f.series[0], &f.series[1]);
        assert_eq!(curve.x.len(), 61);
        let aero = |name: &str| c.plant.aero.value(name).expect("a parameter");
        for (k, (x, y)) in curve.x.iter().zip(&curve.y).enumerate() {
            let angle: f64 = end * k as f64 / 60.0;
            let normal = aero("CN_sin") * angle.sin() + aero("CN_sin3") * angle.sin().powi(3);
            assert!((x - angle.to_degrees()).abs() < 1e-12 && (y - normal).abs() < 1e-12, "{k}: {x} {y}");
        }
        let [low, high] = points.band.as_ref().expect("bars");
        let bar = 1.959_964 * 0.04;
        assert!((low[0] - 0.5 + bar).abs() < 1e-7 && (high[0] - 0.5 - bar).abs() < 1e-7, "{low:?} {high:?}");
        assert!((low[1] - 1.1).abs() < 1e-15 && (high[1] - 1.1).abs() < 1e-15);
    }
}
