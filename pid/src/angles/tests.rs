//! pid tests: the angle off the vertical against the rotation itself.

use super::*;
use windfall_model::frames::EulerXyz;

/// Angle between the body's x axis and the tunnel's, by the rotation's matrix: whatever the roll, beyond the horizontal too. An arc
/// cosine of 0.2 rad loses a digit.
#[test]
fn exact_angle_between_the_axes() {
    for [rx_rad, ry_rad, rz_rad] in [[0.3, -0.2, 0.1], [2.0, 0.7, -1.1], [-1.0, 2.1, 0.4]] {
        let along = EulerXyz { rx_rad, ry_rad, rz_rad }.r_tunnel_body().matrix[(0, 0)];
        assert!((off_vertical(ry_rad, rz_rad) - along.acos()).abs() < 1e-14);
    }
}
