//! model: gravity of a planet. In: a position. Out: gravitational acceleration, without the centrifugal part.

use super::Spheroid;
use crate::frames::{Inertial, Vec3};

/// How gravity depends on the place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Gravity {
    /// The same size everywhere, along the local vertical.
    Uniform {
        /// Size, m/s².
        gravity_m_s2: f64,
    },
    /// Of a point: `−μ p/r³`.
    Central {
        /// Gravitational parameter, m³/s².
        mu_m3_s2: f64,
    },
    /// Of a point with the second zonal harmonic (Vallado 2013, eq. 8-30).
    J2 {
        /// Gravitational parameter, m³/s².
        mu_m3_s2: f64,
        /// Second zonal harmonic, not normalised; 1.0826e-3 for the Earth.
        j2: f64,
    },
}

impl Gravity {
    /// Acceleration at position `p` (m), with `down` the unit vector along the local vertical; m/s².
    #[must_use]
    pub fn acceleration(&self, p: Vec3<Inertial>, down: Vec3<Inertial>, figure: &Spheroid) -> Vec3<Inertial> {
        let r2 = p.dot(p);
        match *self {
            Self::Uniform { gravity_m_s2 } => down * gravity_m_s2,
            Self::Central { mu_m3_s2 } => p * (-mu_m3_s2 / (r2 * r2.sqrt())),
            Self::J2 { mu_m3_s2, j2 } => {
                let k = 1.5 * j2 * figure.equatorial_radius_m * figure.equatorial_radius_m / r2;
                let z2 = 5.0 * p.z() * p.z() / r2;
                let (across, along) = (1.0 + k * (1.0 - z2), 1.0 + k * (3.0 - z2));
                Vec3::new(p.x() * across, p.y() * across, p.z() * along) * (-mu_m3_s2 / (r2 * r2.sqrt()))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::planet::Geodetic;

    const WGS_84: Spheroid = Spheroid { equatorial_radius_m: 6_378_137.0, flattening: 1.0 / 298.257_223_563 };
    const EARTH: Gravity = Gravity::J2 { mu_m3_s2: 3.986_004_418e14, j2: 1.082_629_82e-3 };

    /// The acceleration is the gradient of `U = μ/r (1 − J2 (a/r)² (3 sin²φ − 1)/2)`; bound: central differences over 10 m, whose
    /// error is `U''' h²/6 = μ h²/r⁴`, 2e-11 m/s², and round-off of U over 20 m, 1e-9.
    #[test]
    fn law_acceleration_is_the_gradient_of_the_potential() {
        let (mu, j2, a) = (3.986_004_418e14, 1.082_629_82e-3, WGS_84.equatorial_radius_m);
        let potential = |p: [f64; 3]| {
            let r = p[0].hypot(p[1]).hypot(p[2]);
            mu / r * (1.0 - 0.5 * j2 * (a / r).powi(2) * (3.0 * (p[2] / r).powi(2) - 1.0))
        };
        let p = [3.1e6, -4.0e6, 4.2e6];
        let g = EARTH.acceleration(Vec3::from_array(p), Vec3::zero(), &WGS_84).to_array();
        for k in 0..3 {
            let at = |d: f64| {
                let mut q = p;
                q[k] += d;
                potential(q)
            };
            assert!((g[k] - (at(10.0) - at(-10.0)) / 20.0).abs() < 2e-9);
        }
    }

    /// NASA/TM-2015-218675, check case 1, simulation 4: local gravitation 32.1065359519 ft/s² at 30 000 ft over the equator.
    #[test]
    fn pub_gravitation_of_nesc_case_1() {
        let place = Geodetic { height_m: 9144.0, ..Geodetic::default() };
        let g = EARTH.acceleration(WGS_84.position(&place), Vec3::zero(), &WGS_84).norm() / 0.3048;
        assert!((g - 32.106_535_951_9).abs() < 1e-10, "{g}");
    }
}
