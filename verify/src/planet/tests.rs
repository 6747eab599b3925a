//! verify tests: the check cases are flown.

use super::*;
use crate::tests::pass;

#[test]
fn pub_check_cases_over_a_planet() {
    pass(&checks().expect("flies"));
}

/// The polar radius of WGS 84, m: NIMA TR8350.2, Table 3.3, to its last digit. Every case flies over the equator, where it is not seen.
#[test]
fn pub_polar_radius() {
    let Spheroid { equatorial_radius_m, flattening } = wgs_84(None, Winds::STILL).figure;
    assert!((equatorial_radius_m * (1.0 - flattening) - 6_356_752.314_2).abs() < 1e-4);
}

/// Wind from the west of 0.003 h − 20 ft/s: at the ground 20 ft/s from the east, at 30 000 ft 70 ft/s from the west.
#[test]
fn exact_shear() {
    for (height_ft, east_ft_s) in [(0.0, -20.0), (30_000.0, 70.0), (1e5, 280.0)] {
        let wind = shear().at(height_ft * 0.3048).0.to_array();
        assert!((wind[1] - east_ft_s * 0.3048).abs() < 1e-12 && wind[0].abs() < 1e-15, "{height_ft}: {wind:?}");
    }
}
