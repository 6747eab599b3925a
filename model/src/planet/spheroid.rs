//! model: the figure of a planet. In: geodetic coordinates or a position. Out: the other, and the axes of the place.

use crate::frames::{Inertial, Ned, Rotation, Vec3};
use nalgebra::Matrix3;

/// An ellipsoid of revolution about the polar axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spheroid {
    /// Equatorial radius, m.
    pub equatorial_radius_m: f64,
    /// Flattening `(a − b)/a`, in [0, 1); 0 for a sphere.
    pub flattening: f64,
}

/// Geodetic coordinates: latitude of the ellipsoid's normal, longitude, height along the normal.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Geodetic {
    /// Latitude, rad, in [−π/2, π/2].
    pub latitude_rad: f64,
    /// Longitude, rad, east positive.
    pub longitude_rad: f64,
    /// Height over the ellipsoid, m.
    pub height_m: f64,
}

/// Rounds of the latitude's iteration at most; each gains a factor of the flattening squared times height over radius, so that two or
/// three reach round-off anywhere a lander flies.
const ROUNDS: usize = 12;

impl Spheroid {
    /// First eccentricity squared, `f (2 − f)`.
    #[must_use]
    pub fn eccentricity2(&self) -> f64 {
        self.flattening * (2.0 - self.flattening)
    }

    /// Position from the centre, m (Torge and Müller 2012, eq. 4.27).
    #[must_use]
    pub fn position(&self, g: &Geodetic) -> Vec3<Inertial> {
        let (sin_lat, cos_lat) = g.latitude_rad.sin_cos();
        let (sin_lon, cos_lon) = g.longitude_rad.sin_cos();
        let e2 = self.eccentricity2();
        let normal_m = self.equatorial_radius_m / (1.0 - e2 * sin_lat * sin_lat).sqrt();
        let across = (normal_m + g.height_m) * cos_lat;
        Vec3::new(across * cos_lon, across * sin_lon, (normal_m * (1.0 - e2) + g.height_m) * sin_lat)
    }

    /// Geodetic coordinates of a position, to round-off: Bowring's iteration (1976) of the reduced latitude until it stands still.
    /// Not for places within `e² a` (43 km on Earth) of the centre, where normals cross. At a pole the longitude is 0.
    #[must_use]
    pub fn geodetic(&self, p: Vec3<Inertial>) -> Geodetic {
        let (x, y, z) = (p.x(), p.y(), p.z());
        let across = x.hypot(y);
        let (a, e2) = (self.equatorial_radius_m, self.eccentricity2());
        let b = a * (1.0 - self.flattening);
        let second = e2 / (1.0 - e2);
        let mut tan_reduced = z / across * (1.0 - self.flattening) / (1.0 - e2);
        let mut latitude_rad = if across > 0.0 { f64::NAN } else { std::f64::consts::FRAC_PI_2.copysign(z) };
        if across > 0.0 {
            for _ in 0..ROUNDS {
                let cos = 1.0 / tan_reduced.hypot(1.0);
                let sin = tan_reduced * cos;
                let next = (z + second * b * sin.powi(3)).atan2(across - e2 * a * cos.powi(3));
                let settled = (next - latitude_rad).abs() <= f64::EPSILON;
                latitude_rad = next;
                if settled {
                    break;
                }
                tan_reduced = (1.0 - self.flattening) * latitude_rad.tan();
            }
        }
        let (sin, cos) = latitude_rad.sin_cos();
        let height_m = across * cos + z * sin - a * (1.0 - e2 * sin * sin).sqrt();
        Geodetic { latitude_rad, longitude_rad: y.atan2(x), height_m }
    }
}

impl Geodetic {
    /// North-east-down axes of the place, down along the ellipsoid's normal.
    #[must_use]
    pub fn r_inertial_ned(&self) -> Rotation<Inertial, Ned> {
        let (sin_lat, cos_lat) = self.latitude_rad.sin_cos();
        let (sin_lon, cos_lon) = self.longitude_rad.sin_cos();
        #[rustfmt::skip]
        let m = Matrix3::new(
            -sin_lat * cos_lon, -sin_lon, -cos_lat * cos_lon,
            -sin_lat * sin_lon,  cos_lon, -cos_lat * sin_lon,
             cos_lat,            0.0,     -sin_lat,
        );
        Rotation::from_matrix(m)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WGS_84: Spheroid = Spheroid { equatorial_radius_m: 6_378_137.0, flattening: 1.0 / 298.257_223_563 };

    /// There and back at all latitudes from 10 km below to a geostationary orbit, Earth and a body as flat as Saturn. Bound: a few
    /// units of round-off of the radius, 1e-9 m at 6.4e6 m.
    #[test]
    fn law_geodetic_round_trip() {
        for (figure, least_m) in
            [(WGS_84, -1e4), (Spheroid { flattening: 0.098, ..WGS_84 }, 0.0), (Spheroid { flattening: 0.0, ..WGS_84 }, -1e4)]
        {
            for step in -18_i32..=18 {
                for height_m in [least_m, 0.0, 9144.0, 1e5, 3.6e7] {
                    let g = Geodetic { latitude_rad: f64::from(step) * 5_f64.to_radians(), longitude_rad: 2.0, height_m };
                    let back = figure.geodetic(figure.position(&g));
                    let size = figure.equatorial_radius_m + height_m;
                    assert!((back.height_m - height_m).abs() < 1e-15 * size, "{figure:?} {g:?} {back:?}");
                    assert!((back.latitude_rad - g.latitude_rad).abs() < 1e-15, "{figure:?} {g:?} {back:?}");
                    assert!(step.abs() == 18 || (back.longitude_rad - 2.0).abs() < 1e-15);
                }
            }
        }
    }

    /// Down is against the gradient of the height, north and east along those of the angles.
    #[test]
    fn law_axes_follow_the_coordinates() {
        let g = Geodetic { latitude_rad: 0.7, longitude_rad: -2.3, height_m: 2e4 };
        let p = WGS_84.position(&g);
        let r = g.r_inertial_ned();
        let moved = |d: Vec3<Ned>| WGS_84.geodetic(p + r * d);
        let (north, east, down) =
            (moved(Vec3::new(1.0, 0.0, 0.0)), moved(Vec3::new(0.0, 1.0, 0.0)), moved(Vec3::new(0.0, 0.0, 1.0)));
        // Curvature of the ground over one metre: 1 m² / 2a = 8e-8 m.
        assert!((down.height_m - g.height_m + 1.0).abs() < 1e-8);
        assert!((north.height_m - g.height_m).abs() < 1e-7 && (east.height_m - g.height_m).abs() < 1e-7);
        assert!(north.latitude_rad > g.latitude_rad + 1.5e-7 && east.longitude_rad > g.longitude_rad + 1.5e-7);
        assert!((east.latitude_rad - g.latitude_rad).abs() < 1e-13 && (north.longitude_rad - g.longitude_rad).abs() < 1e-15);
    }
}
