//! verify tests: printed numbers are met; the angle off the vertical.

use super::*;
use crate::tests::{pass, with_setups};

#[test]
fn pub_numbers_of_the_thesis() {
    with_setups(|s| pass(&checks(s).expect("flies")));
}

/// The angle between the body's and the tunnel's x axis, by the rotation's first component.
#[test]
fn exact_angle_off_the_vertical() {
    for [rx_rad, ry_rad, rz_rad] in [[0.7, 0.31, -0.52], [-1.2, -0.8, 0.25], [0.1, 1.9, 0.4]] {
        let x = EulerXyz { rx_rad, ry_rad, rz_rad }.r_tunnel_body().matrix[(0, 0)];
        assert!((off_vertical_rad([rx_rad, ry_rad, rz_rad]).cos() - x).abs() < 1e-15);
    }
}
