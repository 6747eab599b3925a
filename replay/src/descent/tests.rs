//! replay tests: the step of descents. In: made falls and gusts. Out: closed forms.

use super::*;
use windfall_model::planet::GustProfile;

/// Heights go down from 20 km in forty steps. A step is a tenth of a second, 0.3 rad of the fastest pitch mode, or an eighth of the time that the shortest gust passes in at the
/// largest speed, whichever is least.
#[test]
fn exact_step_resolves_pitch_and_gusts() {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/planet/venus-dispersions.toml");
    let mut s = windfall_scenarios::read_planet(&path).unwrap_or_else(|e| panic!("{e}")).scenario;
    let fall = |terminal_speed_m_s, pitch_frequency_hz| SteadyFall {
        height_m: 0.0,
        density_kg_m3: 1.0,
        terminal_speed_m_s,
        pitch_frequency_hz,
        pitch_damping_per_s: 0.0,
    };
    let near = |x: f64, y: f64| assert!((x / y - 1.0).abs() < 1e-14, "{x}, not {y}");
    let theory = [fall(31.0, Some(0.6)), fall(47.0, Some(1.7)), fall(29.0, None)];
    let with = |s: &mut PlanetScenario, scale_m: Option<f64>| {
        s.dispersions.gusts = scale_m.and_then(|m| {
            let gust = windfall_model::Turbulence { axial_scale_m: m, lateral_scale_m: 3.0 * m, ..Default::default() };
            GustProfile::steady(gust)
        });
    };
    let heights = heights(&s.flights[0]);
    assert!(heights.len() == 41 && heights.iter().zip(0..).all(|(h, k)| (h - 500.0 * f64::from(40 - k)).abs() < 1e-9));
    with(&mut s, None);
    near(step(&s, &theory), 0.3 / (2.0 * std::f64::consts::PI * 1.7));
    near(step(&s, &[fall(31.0, Some(0.06))]), 0.1);
    near(step(&s, &[fall(31.0, None)]), 0.1);
    with(&mut s, Some(5.3));
    near(step(&s, &theory), 5.3 / (8.0 * 47.0));
}
