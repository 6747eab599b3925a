//! model: a planet to fly over. In: position and velocity in inertial axes. Out: place, gravity and air there.
//!
//! The planet is an ellipsoid of revolution that turns about its axis; gravity, air and wind do not depend on longitude, so nothing
//! here depends on time: an inertial longitude becomes the planet's own by taking off what it has turned.

mod atmosphere;
mod body;
mod dispersion;
mod gravity;
mod spheroid;
mod us_1976;
mod venus;
mod wind;

pub use atmosphere::{Air, Atmosphere, AtmosphereTable};
pub use body::{FlightStart, PlanetBody, PlanetFlight, PlanetScenario, Reference};
pub use dispersion::{Dispersions, GustProfile, StartDispersion, UncertainNumber, VehicleDispersion, VehicleLens};
pub use gravity::Gravity;
pub use spheroid::{Geodetic, Spheroid};
pub use wind::{WindTable, Winds};

use crate::frames::{Inertial, Ned, Rotation, Vec3};

/// A planet: figure, turning, gravity, air.
#[derive(Clone, Debug, PartialEq)]
pub struct Planet {
    /// Its surface.
    pub figure: Spheroid,
    /// Rate at which it turns about its north pole, rad/s; negative for retrograde.
    pub rotation_rad_s: f64,
    /// Its gravity.
    pub gravity: Gravity,
    /// Its air; none for a vacuum.
    pub atmosphere: Option<Atmosphere>,
    /// Motion of the air over the ground.
    pub wind: Winds,
}

/// What surrounds a body at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surroundings {
    /// Where it is; the longitude is inertial.
    pub place: Geodetic,
    /// Attitude of the local north-east-down axes.
    pub r_inertial_ned: Rotation<Inertial, Ned>,
    /// Gravitational acceleration, m/s²; the centrifugal part is not in it.
    pub gravity: Vec3<Inertial>,
    /// Velocity of the body seen from the ground, m/s.
    pub v_ground: Vec3<Inertial>,
    /// Velocity of the body seen from the air, m/s.
    pub v_air: Vec3<Inertial>,
    /// Acceleration of the air following the body, m/s²; the turning of north as the body moves over the ground is left out of it (wind
    /// times speed over radius, below 1e-3 m/s² at 60 m/s).
    pub a_air: Vec3<Inertial>,
    /// State of the air; none in a vacuum. Beyond the atmosphere's heights that at its end.
    pub air: Option<Air>,
}

impl Planet {
    /// Velocity of the ground (and of air at rest) at a position, m/s: `ω × p`.
    #[must_use]
    pub fn ground_velocity(&self, p: Vec3<Inertial>) -> Vec3<Inertial> {
        self.turning().cross(p)
    }

    fn turning(&self) -> Vec3<Inertial> {
        Vec3::new(0.0, 0.0, self.rotation_rad_s)
    }

    /// Place, gravity and air at position `p` (m) and velocity `v` (m/s).
    #[must_use]
    pub fn surroundings(&self, p: Vec3<Inertial>, v: Vec3<Inertial>) -> Surroundings {
        let place = self.figure.geodetic(p);
        let r_inertial_ned = place.r_inertial_ned();
        let v_ground = v - self.ground_velocity(p);
        let down = r_inertial_ned * Vec3::new(0.0, 0.0, 1.0);
        let (wind, shear) = self.wind.at(place.height_m);
        let wind = r_inertial_ned * wind;
        let climb = -v_ground.dot(down);
        Surroundings {
            place,
            r_inertial_ned,
            gravity: self.gravity.acceleration(p, down, &self.figure),
            v_ground,
            v_air: v_ground - wind,
            a_air: self.turning().cross(v + wind) + r_inertial_ned * shear * climb,
            air: self.atmosphere.as_ref().map(|a| a.at(place.height_m)),
        }
    }
}
