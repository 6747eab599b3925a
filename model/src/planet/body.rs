//! model: what is flown over a planet. In: checked numbers of a scenario file. Out: the order that the simulator carries out.

use super::{Dispersions, Geodetic, Planet};
use crate::aero::Aero;
use crate::frames::{Body, Ned, Vec3};
use crate::scenario::Numerics;
use crate::vehicle::Vehicle;

/// What coefficients are referred to: `L = q S b C_l`, `M = q S c C_m`, `N = q S b C_n`, with rates `p b/2V`, `q c/2V`, `r b/2V`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reference {
    /// Area S, m².
    pub area_m2: f64,
    /// Length b of roll and yaw, m.
    pub span_m: f64,
    /// Length c of pitch, m.
    pub chord_m: f64,
}

impl Reference {
    /// A body of revolution of diameter d (m): S = π d²/4, b = c = d.
    #[must_use]
    pub fn of_diameter(diameter_m: f64) -> Self {
        Self { area_m2: std::f64::consts::FRAC_PI_4 * diameter_m * diameter_m, span_m: diameter_m, chord_m: diameter_m }
    }
}

/// A body in free flight.
#[derive(Clone, Debug, PartialEq)]
pub struct PlanetBody {
    /// Mass side; of a point mass only the mass is used. Its diameter is not: lengths are in `reference`.
    pub vehicle: Vehicle,
    /// Reference area and lengths.
    pub reference: Reference,
    /// Aerodynamics: of a point mass its first parameter, C_D.
    pub aero: Aero,
    /// True for a body without attitude.
    pub point: bool,
}

/// State at the first sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlightStart {
    /// Geodetic place of the c.m.; the longitude is the planet's.
    pub place: Geodetic,
    /// Velocity over the ground, m/s.
    pub v_ground: Vec3<Ned>,
    /// Roll, pitch and yaw from the local north-east-down axes, rad, in the sequence yaw-pitch-roll.
    pub attitude_rad: [f64; 3],
    /// Body rates against inertial axes, rad/s.
    pub w_inertial_body: Vec3<Body>,
}

/// One flight.
#[derive(Clone, Debug, PartialEq)]
pub struct PlanetFlight {
    /// Its name.
    pub name: String,
    /// Duration, s.
    pub duration_s: f64,
    /// Sample rate, Hz.
    pub rate_hz: f64,
    /// State at the first sample.
    pub start: FlightStart,
    /// Integrator settings.
    pub numerics: Numerics,
}

impl PlanetFlight {
    /// Integrator settings of a flight that gives none: a relative tolerance of 1e-13 is 6e-7 m of a planet's radius in a step.
    #[must_use]
    pub fn default_numerics() -> Numerics {
        Numerics { relative_tolerance: 1e-13, absolute_tolerance: 1e-13, ..Numerics::default() }
    }
}

/// A planet, a body, flights.
#[derive(Clone, Debug, PartialEq)]
pub struct PlanetScenario {
    /// Name.
    pub name: String,
    /// Where.
    pub planet: Planet,
    /// What.
    pub body: PlanetBody,
    /// Flights, in order.
    pub flights: Vec<PlanetFlight>,
    /// What differs from one descent to the next; a single flight has none of it.
    pub dispersions: Dispersions,
}
