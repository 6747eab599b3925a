//! scenarios: keys of campaigns of rigid bodies in free flight. In: nothing. Out: the tables of keys.

use super::{Key, Kind, NOISE, TableSpec, USES, alike, num, optional, other, plant, uncertain, vec3};

pub(crate) static FREE_FLIGHT: TableSpec = TableSpec {
    path: "free_flight",
    meaning: "A rigid body in free flight through air at rest, of one density. [vehicle] has mass, centre of mass and inertia without \
              parts; coefficients of [aero.<name>] are about the geometric origin, of `reference_area_m2`, moments of that times \
              reference_diameter_m. The runs have t_s, X_m, Y_m, Z_m and an attitude, in tunnel axes (X down) or in those that \
              [columns.axes] gives.",
    keys: &[
        plant("free_flight.reference_area_m2"),
        other(
            "coefficient_axes",
            Kind::Choice(&["body", "wind"]),
            "wind: CA is the drag C_D along the velocity, CY the side force C_S, CN the lift C_L, and moments are about the same axes, which \
             alpha and beta turn to the body's; body: as in a tunnel",
        ),
        other(
            "coefficients",
            Kind::Choice(&["held", "fitted"]),
            "held: those without an [uncertainty.aero.<name>] are exact; fitted: they are free",
        ),
        plant("free_flight.buoyancy_kg"),
        plant("free_flight.center_of_buoyancy_m"),
        plant("free_flight.rate_damping_n_m_s"),
    ],
};
pub(crate) static PART: TableSpec = TableSpec {
    path: "part",
    meaning: "A point mass beside the [vehicle], at a place that run inputs set: the centre of mass and the inertia follow.",
    keys: &[
        optional(other("name", Kind::Text, "anything")),
        num("mass_kg", "kg", 0.0, 1e7, "mass"),
        Key { unit: "m", ..other("place_m", Kind::Settings, "place from the geometric origin, body axes") },
    ],
};
pub(crate) static THRUST: TableSpec = TableSpec {
    path: "thrust",
    meaning: "A force along a direction of the body, its size and place set by run inputs or fixed.",
    keys: &[
        optional(other("name", Kind::Text, "anything")),
        Key { unit: "N", ..other("size_n", Kind::Setting, "size") },
        vec3("direction", "-", 1e3, "direction, body axes; its length is taken out"),
        Key { unit: "m", ..other("place_m", Kind::Settings, "where it acts from the geometric origin, body axes") },
    ],
};
pub(crate) static SENSORS_FREE: TableSpec = TableSpec {
    path: "sensors",
    meaning: "Standard deviations of the recorded pose of a body in free flight.",
    keys: &[plant("sensors.position_std_m"), plant("sensors.roll_std_deg"), plant("sensors.pitch_yaw_std_deg"), NOISE],
};
pub(crate) static UNCERTAINTY_FREE_FLIGHT: TableSpec = TableSpec {
    path: "uncertainty.free_flight",
    meaning: "Standard uncertainties of [free_flight], and of what is declared as zero: an error of the thrusts, of the places that inputs \
              set, of the point whose position is recorded.",
    keys: &[
        uncertain("free_flight.reference_area_m2"),
        uncertain("free_flight.buoyancy_kg"),
        uncertain("free_flight.center_of_buoyancy_m"),
        uncertain("free_flight.rate_damping_n_m_s"),
        uncertain("free_flight.thrust_excess"),
        uncertain("free_flight.thrust_unequal"),
        uncertain("free_flight.part_shift_m"),
        uncertain("free_flight.tracked_point_m"),
    ],
};
pub(crate) static UNCERTAINTY_SENSORS_FREE: TableSpec = TableSpec {
    path: "uncertainty.sensors",
    meaning: "Standard uncertainties of systematic errors of the recorded pose of a body in free flight, which are declared to be zero.",
    keys: &[alike("sensors.pose_misalignment_deg"), uncertain("sensors.length_scale"), uncertain("sensors.time_base")],
};
pub(crate) static FREE_FILE: TableSpec = TableSpec {
    path: "",
    meaning: "A scenario of a rigid body in free flight: the tables of its campaign, and flights in the place of runs.",
    keys: &[
        super::SEED,
        other("scenario", Kind::Table, "name and note"),
        other("vehicle", Kind::Table, "mass side"),
        optional(other("tether", Kind::Table, "refused: nothing holds a body in free flight")),
        optional(other("pivot", Kind::Table, "refused, as a tether")),
        other("free_flight", Kind::Table, "what a rigid body in free flight through air at rest has beyond its mass"),
        optional(other("part", Kind::Tables, "point masses that inputs of flights move, [[part]]")),
        optional(other("thrust", Kind::Tables, "thrusts, [[thrust]]")),
        other("environment", Kind::Table, "gravity and the air's density"),
        other("sensors", Kind::Table, "noise of the instruments"),
        optional(other("uncertainty", Kind::Table, "uncertainties that the campaign that is made declares")),
        other("aero", Kind::Table, "the true aerodynamics, [aero.<name>]"),
        optional(other("effects", Kind::Table, "effects beyond the declared model, [effects.<family>]")),
        other("flight", Kind::Tables, "flights, [[flight]]"),
        optional(other("provenance", Kind::Table, "written by the program")),
    ],
};
pub(crate) static FLIGHT_FREE: TableSpec = TableSpec {
    path: "flight",
    meaning: "One flight of a rigid body in free flight.",
    keys: &[
        other("name", Kind::Text, "name of the run it makes"),
        other("kind", Kind::Text, "your word"),
        other("use", Kind::Choice(&USES), "use in the campaign that is made"),
        num("duration_s", "s", 0.01, 1e4, "duration; with rate_hz at most a million samples"),
        num("rate_hz", "Hz", 0.1, 1e5, "sample rate; the integrator takes two steps in a sample"),
        other("sensor_noise", Kind::Bool, "whether the record carries sensor noise"),
        optional(other(
            "inputs",
            Kind::Table,
            "settings that parts and thrusts name, { name = number }; the same names in all flights",
        )),
        other("release", Kind::Table, "state at the first sample"),
    ],
};
pub(crate) static RELEASE_FREE: TableSpec = TableSpec {
    path: "flight.release",
    meaning: "State of the geometric origin at the first sample, in free flight.",
    keys: &[
        vec3("position_m", "m", 1e6, "position, tunnel axes (X down)"),
        vec3("velocity_body_m_s", "m/s", 1e5, "velocity, body axes"),
        vec3("attitude_level_deg", "deg", 360.0, "roll, pitch and heading from level; heading zero along tunnel Y"),
        vec3("rates_deg_s", "deg/s", 1e5, "p, q, r"),
    ],
};
