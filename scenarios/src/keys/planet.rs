//! scenarios: keys of planet scenarios. In: nothing. Out: names, units, ranges and meanings, for the checks and the reference.

use super::{Key, Kind, TINY, TableSpec, num, optional, other, plant, uncertain, vec3};

pub(crate) static PLANET_FILE: TableSpec = TableSpec {
    path: "",
    meaning: "A planet scenario: a body in free flight over a turning ellipsoid. A scenario file is one when its [environment] says which \
              `gravity`, or its flights have [flight.initial].",
    keys: &[
        optional(Key {
            name: "seed",
            kind: Kind::Integer,
            unit: "-",
            range: [0.0, 9_007_199_254_740_992.0],
            needed: false,
            meaning: "seed of `windfall descend`; a single flight leaves nothing to chance",
        }),
        other("scenario", Kind::Table, "name and note"),
        other("vehicle", Kind::Table, "mass side"),
        optional(other("tether", Kind::Table, "refused: bodies fly free")),
        other("environment", Kind::Table, "planet and air"),
        optional(other("sensors", Kind::Table, "read and not used: the truth alone is written")),
        other("aero", Kind::Table, "the aerodynamics, [aero.<name>]; [aero.point_mass] is a body without attitude"),
        optional(other("uncertainty", Kind::Table, "what differs from one descent to the next, for `windfall descend`")),
        optional(other("numerics", Kind::Table, "integrator settings; tolerances are 1e-13 when absent")),
        other("flight", Kind::Tables, "flights, [[flight]], or one [flight]"),
        optional(other("provenance", Kind::Table, "written by the program")),
    ],
};
pub(crate) static VEHICLE_PLANET: TableSpec = TableSpec {
    path: "vehicle",
    meaning: "Mass side and reference lengths. Coefficients are referred to area S, span b (roll, yaw) and chord c (pitch): L = q S b C_l, \
              M = q S c C_m, rates p b/2V, q c/2V, r b/2V. The diameter d stands for those that are absent: S = pi d^2/4, b = c = d; it is \
              needed unless all three are there (for a point mass: the area). A point mass needs mass and area alone.",
    keys: &[
        plant("vehicle.mass_kg"),
        optional(other("inertia_kg_m2", Kind::Table, "moments and products of inertia about the c.m.; needed by a rigid body")),
        optional(plant("vehicle.center_of_mass_m")),
        optional(plant("vehicle.reference_diameter_m")),
        optional(num("reference_area_m2", "m2", TINY, 1e6, "reference area S")),
        optional(num("reference_span_m", "m", TINY, 1e4, "reference length b of roll and yaw")),
        optional(num("reference_chord_m", "m", TINY, 1e4, "reference length c of pitch")),
    ],
};
pub(crate) static ENVIRONMENT_PLANET: TableSpec = TableSpec {
    path: "environment",
    meaning: "Planet and air. `uniform`: gravity_m_s2 everywhere, along the local vertical; `central`: mu/r^2; `j2`: that and the second \
              zonal harmonic.",
    keys: &[
        other("gravity", Kind::Choice(&["uniform", "central", "j2"]), "how gravity depends on the place"),
        optional(num("gravity_m_s2", "m/s2", 0.0, 1e3, "size of uniform gravity; needed by it, and by it alone")),
        optional(num("mu_m3_s2", "m3/s2", 1.0, 1e21, "gravitational parameter; needed by central and j2")),
        num("equatorial_radius_m", "m", 1.0, 1e9, "equatorial radius of the ellipsoid over which heights are measured"),
        optional(num("flattening", "-", 0.0, 0.5, "its flattening, (a - b)/a; needed by j2, absent: a sphere")),
        optional(num("j2", "-", -0.1, 0.1, "second zonal harmonic, not normalised; needed by j2")),
        optional(num(
            "rotation_rad_s",
            "rad/s",
            -1.0,
            1.0,
            "rate of turning, east positive; needed by j2, absent: it does not turn",
        )),
        optional(other(
            "atmosphere",
            Kind::WordOrTable(&["us-1976", "venus"]),
            "air over geometric height: U.S. Standard Atmosphere 1976 (-5 to 86 km), Venus (Seiff and others 1985, 0 to 72 km), or a file; \
             absent: a vacuum",
        )),
        optional(other("wind", Kind::Table, "where the air goes to; absent: it turns with the planet")),
        optional(other("turbulence", Kind::Table, "gusts, for `windfall descend`; absent: the air flows evenly")),
    ],
};
pub(crate) static ATMOSPHERE_PLANET: TableSpec = TableSpec {
    path: "environment.atmosphere",
    meaning: "Air from a file; a flight that leaves its heights is an error. Between rows temperature and gas constant are linear, and \
              pressure is as in hydrostatic equilibrium.",
    keys: &[other(
        "file",
        Kind::Text,
        "columns height_m (geometric, ascending), pressure_Pa, temperature_K, gas_constant_J_kg_K; .csv or .parquet",
    )],
};
pub(crate) static WIND_PLANET: TableSpec = TableSpec {
    path: "environment.wind",
    meaning: "Velocity of the air over the ground: the same at all heights, or a file; linear between its rows, held beyond its ends.",
    keys: &[
        optional(num("north_m_s", "m/s", -1e3, 1e3, "toward north")),
        optional(num("east_m_s", "m/s", -1e3, 1e3, "toward east")),
        optional(other("file", Kind::Text, "columns height_m (ascending), north_m_s, east_m_s; .csv or .parquet")),
    ],
};
pub(crate) static TURBULENCE_PLANET: TableSpec = TableSpec {
    path: "environment.turbulence",
    meaning: "Gusts of Dryden form (MIL-F-8785C 1980) for `windfall descend`: longitudinal along the vertical, lateral toward north and \
              east. The same at all heights, or a file; linear between its rows, held beyond its ends.",
    keys: &[
        optional(num("axial_rms_m_s", "m/s", 0.0, 1e3, "rms of vertical gusts")),
        optional(num("lateral_rms_m_s", "m/s", 0.0, 1e3, "rms of horizontal gusts, each axis")),
        optional(num("axial_scale_m", "m", 1e-2, 1e6, "integral scale of vertical gusts")),
        optional(num("lateral_scale_m", "m", 1e-2, 1e6, "scale L of horizontal gusts in the Dryden form")),
        optional(other(
            "file",
            Kind::Text,
            "columns height_m (ascending), axial_rms_m_s, lateral_rms_m_s, axial_scale_m, lateral_scale_m; .csv or .parquet",
        )),
    ],
};
pub(crate) static UNCERTAINTY_PLANET: TableSpec = TableSpec {
    path: "uncertainty",
    meaning: "Standard uncertainties (1 sigma), normal and independent, drawn by `windfall descend`. Those of the coefficients come with \
              its --model.",
    keys: &[
        optional(other("vehicle", Kind::Table, "of the mass side; the same body for a whole descent")),
        optional(other("initial", Kind::Table, "of the state at the first sample; another one in each descent")),
    ],
};
pub(crate) static UNCERTAINTY_VEHICLE_PLANET: TableSpec = TableSpec {
    path: "uncertainty.vehicle",
    meaning: "Standard uncertainties of the mass side.",
    keys: &[
        uncertain("vehicle.mass_kg"),
        optional(other("inertia_kg_m2", Kind::Table, "moments and products of inertia about the c.m.")),
        uncertain("vehicle.center_of_mass_m"),
    ],
};
const fn std3(name: &'static str, unit: &'static str, limit: f64, meaning: &'static str) -> Key {
    optional(Key { name, kind: Kind::Numbers(3), unit, range: [0.0, limit], needed: false, meaning })
}
pub(crate) static UNCERTAINTY_INITIAL: TableSpec = TableSpec {
    path: "uncertainty.initial",
    meaning: "Standard deviations of the state at the first sample.",
    keys: &[
        std3("velocity_ned_m_s", "m/s", 1e4, "of the velocity toward north, east, down"),
        std3("attitude_body_deg", "deg", 180.0, "of a turn of the body about its own axes x, y, z"),
        std3("rates_deg_s", "deg/s", 1e4, "of p, q, r"),
    ],
};
pub(crate) static FLIGHT_PLANET: TableSpec = TableSpec {
    path: "flight",
    meaning: "One flight. It ends where height 0 is reached, unless it starts there.",
    keys: &[
        optional(other("name", Kind::Text, "name of the flight; \"flight\" when absent")),
        optional(other("kind", Kind::Text, "your word, read and not used")),
        optional(other("use", Kind::Choice(&super::USES), "read and not used")),
        num("duration_s", "s", 1e-6, 1e7, "duration; with rate_hz at most a million samples"),
        num("rate_hz", "Hz", 1e-4, 1e5, "sample rate"),
        optional(other("sensor_noise", Kind::Bool, "false: the truth alone is written")),
        other("initial", Kind::Table, "state at the first sample"),
    ],
};
pub(crate) static INITIAL: TableSpec = TableSpec {
    path: "flight.initial",
    meaning: "State of the c.m. at the first sample, geodetic.",
    keys: &[
        num("latitude_deg", "deg", -90.0, 90.0, "geodetic latitude"),
        num("longitude_deg", "deg", -360.0, 360.0, "longitude, east positive"),
        num("height_m", "m", -1e7, 1e8, "height over the ellipsoid, zero or more"),
        vec3("velocity_ned_m_s", "m/s", 1e5, "velocity over the ground toward north, east, down"),
        optional(vec3("attitude_ned_deg", "deg", 360.0, "roll, pitch, yaw from north-east-down; needed by a rigid body")),
        optional(vec3("rates_deg_s", "deg/s", 1e5, "p, q, r against inertial axes; needed by a rigid body")),
    ],
};

/// Tables of a planet scenario in the order of the reference.
pub(crate) static PLANET_TABLES: [&TableSpec; 17] = [
    &PLANET_FILE,
    &super::SCENARIO,
    &VEHICLE_PLANET,
    &super::INERTIA,
    &ENVIRONMENT_PLANET,
    &ATMOSPHERE_PLANET,
    &WIND_PLANET,
    &TURBULENCE_PLANET,
    &UNCERTAINTY_PLANET,
    &UNCERTAINTY_VEHICLE_PLANET,
    &super::UNCERTAINTY_INERTIA,
    &UNCERTAINTY_INITIAL,
    &super::AERO,
    &super::NUMERICS,
    &FLIGHT_PLANET,
    &INITIAL,
    &super::PROVENANCE,
];
