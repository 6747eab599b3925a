//! sim: where a body is over an ellipsoid, without angles. In: a position. Out: height and the local axes.
#![expect(
    clippy::imprecise_flops,
    reason = "lengths of a planet's size neither overflow nor vanish, and hypot takes ten times as long"
)]

use windfall_model::frames::{Inertial, Vec3};
use windfall_model::planet::Spheroid;

/// Height and north-east-down axes of a place.
#[derive(Clone, Copy, Debug)]
pub(super) struct LocalAxes {
    pub(super) height_m: f64,
    pub(super) north: Vec3<Inertial>,
    pub(super) east: Vec3<Inertial>,
    pub(super) down: Vec3<Inertial>,
}

/// Rounds of Bowring's iteration (1976): within 100 km of an Earth two leave less than 1e-14 rad.
const ROUNDS: usize = 2;

/// The place of a position, m; at a pole east is that of longitude 0.
#[inline]
pub(super) fn local(figure: &Spheroid, p: Vec3<Inertial>) -> LocalAxes {
    let (x, y, z) = (p.x(), p.y(), p.z());
    let across = (x * x + y * y).sqrt();
    let (cos_lon, sin_lon) = if across > 0.0 { (x / across, y / across) } else { (1.0, 0.0) };
    let (height_m, sin, cos) = if figure.flattening == 0.0 {
        let r = (across * across + z * z).sqrt();
        (r - figure.equatorial_radius_m, z / r, across / r)
    } else {
        ellipsoidal(figure, across, z)
    };
    LocalAxes {
        height_m,
        north: Vec3::new(-sin * cos_lon, -sin * sin_lon, cos),
        east: Vec3::new(-sin_lon, cos_lon, 0.0),
        down: Vec3::new(-cos * cos_lon, -cos * sin_lon, -sin),
    }
}

/// Height, sine and cosine of the geodetic latitude.
fn ellipsoidal(figure: &Spheroid, across: f64, z: f64) -> (f64, f64, f64) {
    let (a, e2, f) = (figure.equatorial_radius_m, figure.eccentricity2(), figure.flattening);
    let (b, second) = (a * (1.0 - f), e2 / (1.0 - e2));
    // As the sine and cosine of a direction, so that a pole is a place like any other.
    let unit = |s: f64, c: f64| {
        let n = (s * s + c * c).sqrt();
        (s / n, c / n)
    };
    let (mut s, mut c) = unit(z * (1.0 - f), across * (1.0 - e2));
    let (mut sin, mut cos) = (0.0, 1.0);
    for _ in 0..ROUNDS {
        (sin, cos) = unit(z + second * b * s * s * s, across - e2 * a * c * c * c);
        (s, c) = unit((1.0 - f) * sin, cos);
    }
    (across * cos + z * sin - a * (1.0 - e2 * sin * sin).sqrt(), sin, cos)
}

#[cfg(test)]
mod tests {
    use super::*;
    use windfall_model::planet::Geodetic;

    /// Bounds: round-off of a radius of 6e6 m (1e-9 m times a few) and of unit vectors.
    #[test]
    fn exact_as_by_angles() {
        for flattening in [0.0, 1.0 / 298.257_223_563, 0.02] {
            let figure = Spheroid { equatorial_radius_m: 6_378_137.0, flattening };
            for (lat, lon, height_m) in
                [(-90.0, 0.0, 5.0), (-41.0, 170.0, 0.0), (0.0, -3.0, 1e4), (60.0, 60.0, 1e5), (90.0, 0.0, 1.0)]
            {
                let g = Geodetic { latitude_rad: f64::to_radians(lat), longitude_rad: f64::to_radians(lon), height_m };
                let (at, r) = (local(&figure, figure.position(&g)), g.r_inertial_ned());
                assert!((at.height_m - height_m).abs() < 1e-8, "{flattening} {lat}: {}", at.height_m - height_m);
                for (axis, k) in [(at.north, 0), (at.east, 1), (at.down, 2)] {
                    // Half a metre beside the pole (round-off of its position) the meridians already turn.
                    let far = (axis.xyz - r.matrix.column(k)).norm();
                    assert!(far < 1e-11 || lat.abs() > 89.0 && k < 2, "{flattening} {lat} axis {k}: {far}");
                }
            }
        }
    }
}
