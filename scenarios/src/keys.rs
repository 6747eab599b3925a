//! scenarios: every key of every table, once. In: nothing. Out: names, units, ranges and meanings, for the checks and the reference.

mod columns;
mod free_flight;
mod planet;
pub(crate) mod spec;
mod wind_tunnel;

use crate::limits;
pub(crate) use columns::{COLUMN, COLUMNS, COLUMNS_ATTITUDE, COLUMNS_AXES};
pub(crate) use free_flight::{
    FLIGHT_FREE, FREE_FILE, FREE_FLIGHT, PART, RELEASE_FREE, SENSORS_FREE, THRUST, UNCERTAINTY_FREE_FLIGHT,
    UNCERTAINTY_SENSORS_FREE,
};
pub(crate) use planet::{
    ATMOSPHERE_PLANET, ENVIRONMENT_PLANET, FLIGHT_PLANET, INITIAL, PLANET_FILE, TURBULENCE_PLANET, UNCERTAINTY_INITIAL,
    UNCERTAINTY_PLANET, UNCERTAINTY_VEHICLE_PLANET, VEHICLE_PLANET, WIND_PLANET,
};
pub(crate) use spec::{Key, Kind, TableSpec};
pub(crate) use wind_tunnel::WIND_TUNNEL;
use windfall_model::PLANT_NUMBERS;

const fn num(name: &'static str, unit: &'static str, low: f64, high: f64, meaning: &'static str) -> Key {
    Key { name, kind: Kind::Number, unit, range: [low, high], needed: true, meaning }
}
const fn vec3(name: &'static str, unit: &'static str, limit: f64, meaning: &'static str) -> Key {
    Key { name, kind: Kind::Numbers(3), unit, range: [-limit, limit], needed: true, meaning }
}
const fn other(name: &'static str, kind: Kind, meaning: &'static str) -> Key {
    Key { name, kind, unit: "-", range: [f64::NEG_INFINITY, f64::INFINITY], needed: true, meaning }
}
const fn optional(mut key: Key) -> Key {
    key.needed = false;
    key
}

/// Words of what a run is for, in the order of [`Use::ALL`].
const USES: [&str; 3] = ["identify", "select", "hold-out"];

/// A key that is a number of the plant, or the list of its components.
const fn plant(path: &str) -> Key {
    let (mut found, mut components, mut i) = (None, 0, 0);
    while i < PLANT_NUMBERS.len() {
        if same(PLANT_NUMBERS[i].key, path) {
            (found, components) = (Some(&PLANT_NUMBERS[i]), components + 1);
        }
        i += 1;
    }
    let Some(n) = found else { panic!("no number of the plant has this key") };
    let kind = if components == 1 { Kind::Number } else { Kind::Numbers(components) };
    Key { name: last_word(n.key), kind, unit: n.file_unit(), range: n.range, needed: true, meaning: n.meaning }
}
/// Standard uncertainty of such a key, in its shape.
const fn uncertain(path: &str) -> Key {
    let key = plant(path);
    Key { range: [0.0, key.range[1]], needed: false, ..key }
}
/// The same with one number for all components; a list is read as well.
const fn alike(path: &str) -> Key {
    Key { kind: Kind::Number, ..uncertain(path) }
}
const fn same(a: &str, b: &str) -> bool {
    let (a, b) = (a.as_bytes(), b.as_bytes());
    let mut i = 0;
    while i < a.len() && i < b.len() && a[i] == b[i] {
        i += 1;
    }
    i == a.len() && i == b.len()
}
const fn last_word(path: &'static str) -> &'static str {
    let bytes = path.as_bytes();
    let mut start = bytes.len();
    while start > 0 && bytes[start - 1] != b'.' {
        start -= 1;
    }
    path.split_at(start).1
}
/// Whether the declared noise is to be believed.
const NOISE: Key = optional(other(
    "noise",
    Kind::Choice(&["learnt", "exact"]),
    "learnt: these are a first belief, and the record says more; exact: they hold; learnt when absent",
));

/// Smallest positive value that a key may have where zero makes no sense.
const TINY: f64 = 1e-12;

pub(crate) static CAMPAIGN_FILE: TableSpec = TableSpec {
    path: "",
    meaning: "A campaign file: one vehicle, its declared model, its runs.",
    keys: &[
        other("campaign", Kind::Table, "name and note"),
        other("vehicle", Kind::Table, "mass side"),
        optional(other("tether", Kind::Table, "safety tether; absent: free flight")),
        optional(other("axes", Kind::Table, "axes of a point mass' files")),
        optional(other("pivot", Kind::Table, "pivot that holds a point mass; absent: it flies")),
        optional(other("free_flight", Kind::Table, "what a rigid body in free flight through air at rest has beyond its mass")),
        optional(other("part", Kind::Tables, "point masses that run inputs move, [[part]], with [free_flight]")),
        optional(other("thrust", Kind::Tables, "thrusts, [[thrust]], with [free_flight]")),
        other("environment", Kind::Table, "gravity and gas"),
        other("sensors", Kind::Table, "noise of the instruments"),
        optional(other("uncertainty", Kind::Table, "standard uncertainties of declared numbers, [uncertainty.<table>]")),
        other("aero", Kind::Table, "one declared model, [aero.<name>]"),
        optional(other("effects", Kind::Table, "effects that the declared model has, [effects.<family>]")),
        optional(other("columns", Kind::Table, "names, units, axes and attitudes of the run files where they are others")),
        optional(other(
            "wind_tunnel",
            Kind::Tables,
            "static coefficients of wind-tunnel tests, [[wind_tunnel]], for comparison alone",
        )),
        other("run", Kind::Tables, "runs, [[run]]"),
    ],
};
pub(crate) static CAMPAIGN: TableSpec = TableSpec {
    path: "campaign",
    meaning: "Name of the campaign.",
    keys: &[other("name", Kind::Text, "name"), optional(other("note", Kind::Text, "anything"))],
};
pub(crate) static VEHICLE: TableSpec = TableSpec {
    path: "vehicle",
    meaning: "Mass side of a body with attitude; body axes, x out of the nose.",
    keys: &[
        plant("vehicle.mass_kg"),
        other("inertia_kg_m2", Kind::Table, "moments and products of inertia about the c.m."),
        plant("vehicle.center_of_mass_m"),
        plant("vehicle.reference_diameter_m"),
    ],
};
pub(crate) static INERTIA: TableSpec = TableSpec {
    path: "vehicle.inertia_kg_m2",
    meaning: "Inertia about the c.m., body axes; products are the positive integrals of x y dm.",
    keys: &[
        plant("vehicle.inertia_kg_m2.xx"),
        plant("vehicle.inertia_kg_m2.yy"),
        plant("vehicle.inertia_kg_m2.zz"),
        plant("vehicle.inertia_kg_m2.xy"),
        plant("vehicle.inertia_kg_m2.xz"),
        plant("vehicle.inertia_kg_m2.yz"),
    ],
};
pub(crate) static VEHICLE_POINT: TableSpec = TableSpec {
    path: "vehicle",
    meaning: "A body without attitude (with [aero.point_mass]).",
    keys: &[plant("vehicle.mass_kg"), plant("vehicle.reference_diameter_m")],
};
pub(crate) static TETHER: TableSpec = TableSpec {
    path: "tether",
    meaning: "Pull toward the ring, q (C_D S)_tr - W_tr.",
    keys: &[
        plant("tether.attachment_m"),
        plant("tether.ring_m"),
        plant("tether.drag_area_m2"),
        plant("tether.effective_weight_n"),
    ],
};
pub(crate) static AXES: TableSpec = TableSpec {
    path: "axes",
    meaning: "How the axes of a point mass' files lie. Tunnel X is down; Y and Z follow right-handed.",
    keys: &[other("down", Kind::Choice(&["+X", "-X", "+Y", "-Y", "+Z", "-Z"]), "file axis that points down")],
};
pub(crate) static ENVIRONMENT: TableSpec = TableSpec {
    path: "environment",
    meaning: "Gravity and the tunnel's gas.",
    keys: &[plant("environment.gravity_m_s2"), plant("environment.gas_constant_j_kg_k")],
};
pub(crate) static ENVIRONMENT_SCENARIO: TableSpec = TableSpec {
    path: "environment",
    meaning: "Gravity, the tunnel's gas and its state (scenario files).",
    keys: &[
        plant("environment.gravity_m_s2"),
        plant("environment.gas_constant_j_kg_k"),
        num("static_pressure_pa", "Pa", 1.0, 1e8, "static pressure of every flight"),
        num("static_temperature_k", "K", 10.0, 2e3, "static temperature of every flight"),
    ],
};
pub(crate) static ENVIRONMENT_POINT: TableSpec = TableSpec {
    path: "environment",
    meaning: "Gravity and still air (point mass): one density, or an atmosphere over height.",
    keys: &[
        plant("environment.gravity_m_s2"),
        optional(Key {
            meaning: "density of the air; with an atmosphere that at the launch, and the atmosphere's own where it is absent",
            ..plant("environment.air_density_kg_m3")
        }),
        optional(other(
            "atmosphere",
            Kind::WordOrTable(&["us-1976", "venus"]),
            "how the air thins and cools over height: U.S. Standard Atmosphere 1976, Venus (Seiff and others 1985), or a file as in planet \
             scenarios; absent: the same density everywhere",
        )),
        optional(plant("environment.launch_height_m")),
    ],
};
pub(crate) static PIVOT: TableSpec = TableSpec {
    path: "pivot",
    meaning: "A pivot with a level axis that holds a point mass (a pendulum), as declared. The runs have `angle_deg` from hanging down.",
    keys: &[plant("pivot.arm_m"), plant("pivot.inertia_kg_m2"), plant("pivot.viscous_n_m_s")],
};
pub(crate) static UNCERTAINTY_PIVOT: TableSpec = TableSpec {
    path: "uncertainty.pivot",
    meaning: "Standard uncertainties of the pivot.",
    keys: &[uncertain("pivot.arm_m"), uncertain("pivot.inertia_kg_m2"), uncertain("pivot.viscous_n_m_s")],
};
pub(crate) static AERO_TABLE: TableSpec = TableSpec {
    path: "aero.point_mass.CD",
    meaning: "C_D of a point mass as a table, linear between its points and held beyond their ends. The parameter is then `CD_scale`, a \
              factor on the table that starts at 1: fitted where `declared` names it or is absent, 1 otherwise. Either `at` and `values`, \
              or a file with the columns `mach` and `CD`. It needs an [environment] atmosphere, for the speed of sound.",
    keys: &[
        other("over", Kind::Choice(&["mach"]), "variable of the table"),
        optional(Key { range: [0.0, 100.0], ..other("at", Kind::Series, "values of the variable, ascending") }),
        optional(Key { range: [-1e3, 1e3], ..other("values", Kind::Series, "C_D there") }),
        optional(other("file", Kind::Text, "columns mach (ascending) and CD; .csv or .parquet, beside this file")),
    ],
};
pub(crate) static RUN_VEHICLE: TableSpec = TableSpec {
    path: "run.vehicle",
    meaning: "What this run's body (point mass) has otherwise than [vehicle].",
    keys: &[optional(plant("vehicle.mass_kg")), optional(plant("vehicle.reference_diameter_m"))],
};
pub(crate) static RUN_ENVIRONMENT: TableSpec = TableSpec {
    path: "run.environment",
    meaning: "What this run's air (point mass) has otherwise than [environment]. With a launch height of its own and no density, the density \
              is the campaign's in the proportion of the atmosphere at both.",
    keys: &[optional(plant("environment.air_density_kg_m3")), optional(plant("environment.launch_height_m"))],
};
pub(crate) static RUN_AERO: TableSpec = TableSpec {
    path: "run.aero",
    meaning: "This run's table of C_D (point mass), in place of the campaign's; the factor is common.",
    keys: &[other("CD", Kind::Table, "a table as in [aero.point_mass]")],
};
pub(crate) static INPUT: TableSpec = TableSpec {
    path: "run.inputs.<input>",
    meaning: "An input that the run file has row by row (point mass): (value - zero)/(one - zero) of a column; between two rows their mean \
              acts. A column's name alone is read as it stands.",
    keys: &[
        other("column", Kind::Text, "column of the run file"),
        optional(num("zero", "-", -1e12, 1e12, "what the column has where the input is 0; 0 when absent")),
        optional(num("one", "-", -1e12, 1e12, "what the column has where the input is 1; 1 when absent")),
    ],
};
pub(crate) static SENSORS: TableSpec = TableSpec {
    path: "sensors",
    meaning: "Standard deviations of the instruments (thesis Table A.3).",
    keys: &[
        plant("sensors.position_std_m"),
        plant("sensors.roll_std_deg"),
        plant("sensors.pitch_yaw_std_deg"),
        plant("sensors.wind_std_m_s"),
        NOISE,
    ],
};
pub(crate) static SENSORS_POINT: TableSpec = TableSpec {
    path: "sensors",
    meaning: "What measured a point mass, and its standard deviation: position, specific force, both, or angle. Position: any of \
              X_m, Y_m, Z_m, the vertical one among them. Specific force: any of fX_m_s2, fY_m_s2, fZ_m_s2 (an accelerometer on a body that \
              keeps its attitude; zero in free fall in a vacuum), with an offset of its own in every run; beside positions those of axes whose \
              position is there, in the same rows. Angle: angle_deg, with [pivot].",
    keys: &[
        optional(plant("sensors.position_std_m")),
        optional(plant("sensors.specific_force_std_m_s2")),
        optional(plant("sensors.angle_std_deg")),
        optional(other(
            "height",
            Kind::Choice(&["tracked", "pressure"]),
            "pressure: heights are a pressure altimeter's, whose vents may see the dynamic pressure; tracked when absent",
        )),
        NOISE,
    ],
};
pub(crate) static UNCERTAINTY: TableSpec = TableSpec {
    path: "uncertainty",
    meaning: "Standard uncertainties (1 sigma, JCGM 100:2008) of declared numbers, under the same table and key names and in the same \
              shapes; what is absent or zero is exact.",
    keys: &[
        optional(other("vehicle", Kind::Table, "of [vehicle]")),
        optional(other("tether", Kind::Table, "of [tether]")),
        optional(other("pivot", Kind::Table, "of [pivot]")),
        optional(other("free_flight", Kind::Table, "of [free_flight]")),
        optional(other("environment", Kind::Table, "of [environment]")),
        optional(other("sensors", Kind::Table, "of [sensors], and of what the instruments do to the truth")),
        optional(other("aero", Kind::Table, "of the starting values in [aero.<name>], before the runs")),
    ],
};
pub(crate) static UNCERTAINTY_VEHICLE: TableSpec = TableSpec {
    path: "uncertainty.vehicle",
    meaning: "Standard uncertainties of the mass side.",
    keys: &[
        uncertain("vehicle.mass_kg"),
        optional(other("inertia_kg_m2", Kind::Table, "moments and products of inertia about the c.m.")),
        uncertain("vehicle.center_of_mass_m"),
        uncertain("vehicle.reference_diameter_m"),
    ],
};
pub(crate) static UNCERTAINTY_INERTIA: TableSpec = TableSpec {
    path: "uncertainty.vehicle.inertia_kg_m2",
    meaning: "Standard uncertainties of the inertia.",
    keys: &[
        uncertain("vehicle.inertia_kg_m2.xx"),
        uncertain("vehicle.inertia_kg_m2.yy"),
        uncertain("vehicle.inertia_kg_m2.zz"),
        uncertain("vehicle.inertia_kg_m2.xy"),
        uncertain("vehicle.inertia_kg_m2.xz"),
        uncertain("vehicle.inertia_kg_m2.yz"),
    ],
};
pub(crate) static UNCERTAINTY_VEHICLE_POINT: TableSpec = TableSpec {
    path: "uncertainty.vehicle",
    meaning: "Standard uncertainties of a body without attitude.",
    keys: &[uncertain("vehicle.mass_kg"), uncertain("vehicle.reference_diameter_m")],
};
pub(crate) static UNCERTAINTY_TETHER: TableSpec = TableSpec {
    path: "uncertainty.tether",
    meaning: "Standard uncertainties of the tether.",
    keys: &[
        uncertain("tether.attachment_m"),
        uncertain("tether.ring_m"),
        uncertain("tether.drag_area_m2"),
        uncertain("tether.effective_weight_n"),
    ],
};
pub(crate) static UNCERTAINTY_ENVIRONMENT: TableSpec = TableSpec {
    path: "uncertainty.environment",
    meaning: "Standard uncertainties of gravity and gas.",
    keys: &[uncertain("environment.gravity_m_s2"), uncertain("environment.gas_constant_j_kg_k")],
};
pub(crate) static UNCERTAINTY_ENVIRONMENT_POINT: TableSpec = TableSpec {
    path: "uncertainty.environment",
    meaning: "Standard uncertainties of gravity and still air (point mass).",
    keys: &[
        uncertain("environment.gravity_m_s2"),
        uncertain("environment.air_density_kg_m3"),
        uncertain("environment.launch_height_m"),
    ],
};
pub(crate) static UNCERTAINTY_SENSORS: TableSpec = TableSpec {
    path: "uncertainty.sensors",
    meaning: "Standard uncertainties of the noise, and of systematic errors of the instruments, which are declared to be zero.",
    keys: &[
        uncertain("sensors.position_std_m"),
        uncertain("sensors.roll_std_deg"),
        uncertain("sensors.pitch_yaw_std_deg"),
        uncertain("sensors.wind_std_m_s"),
        alike("sensors.pose_misalignment_deg"),
        uncertain("sensors.wind_scale"),
        uncertain("sensors.length_scale"),
        uncertain("sensors.time_base"),
    ],
};
pub(crate) static UNCERTAINTY_SENSORS_POINT: TableSpec = TableSpec {
    path: "uncertainty.sensors",
    meaning: "Standard uncertainties of the noise, and of systematic errors of the instruments, which are declared to be zero (point mass).",
    keys: &[uncertain("sensors.position_std_m"), uncertain("sensors.length_scale"), uncertain("sensors.time_base")],
};
pub(crate) static UNCERTAINTY_AERO: TableSpec = TableSpec {
    path: "uncertainty.aero.<name>",
    meaning: "Standard uncertainty of the starting value of each parameter that is named, above zero: a prior.",
    keys: &[],
};
pub(crate) static CAMPAIGN_EFFECTS: TableSpec = TableSpec {
    path: "effects.<family>",
    meaning: "An effect that the declared model has; families and parameters are those of the catalogue, values are starting points. A \
              strength that is not given starts at zero, a shape at a typical value; instants and runs must be given.",
    keys: &[],
};
pub(crate) static AERO: TableSpec = TableSpec {
    path: "aero.<name>",
    meaning: "The declared model: `axisymmetric`, `point_mass`, or any name with `structure = \"file.toml\"`; one key per parameter of \
              the structure with its starting value; optional `declared = [...]` names those that the declared model has (default: \
              all), the others are zero until an effect brings them.",
    keys: &[],
};
pub(crate) static RUN: TableSpec = TableSpec {
    path: "run",
    meaning: "One run.",
    keys: &[
        other("file", Kind::Text, "run file, beside the campaign file"),
        other("kind", Kind::Text, "perturbed, unperturbed, drop, launch, or your word"),
        other("use", Kind::Choice(&USES), "fit on it, choose between sets of effects by it, or only report predictions of it"),
        optional(Key {
            name: "window_s",
            kind: Kind::Numbers(2),
            unit: "s",
            range: [-1e11, 1e11],
            needed: false,
            meaning: "part of the file that is used, [from, to] in the file's time, which may be that of Unix",
        }),
        optional(other(
            "inputs",
            Kind::Table,
            "known settings of this run, name = number; of a point mass also name = \"column\" or { column, zero, one }",
        )),
        optional(other("vehicle", Kind::Table, "this run's body where it is not the campaign's (point mass)")),
        optional(other("environment", Kind::Table, "this run's air where it is not the campaign's (point mass)")),
        optional(other("aero", Kind::Table, "this run's drag where it is not the campaign's (point mass)")),
        optional(other(
            "recording",
            Kind::Text,
            "recording that this run is a window of (point mass); windows of one recording are not independent",
        )),
        optional(other("columns", Kind::Table, "[columns] of this run's file, in place of the campaign's")),
    ],
};
const SEED: Key = Key {
    name: "seed",
    kind: Kind::Integer,
    unit: "-",
    range: [0.0, 9_007_199_254_740_992.0],
    needed: false,
    meaning: "seed of all chance; 1 when absent, written out in the resolved file",
};
pub(crate) static SCENARIO_FILE: TableSpec = TableSpec {
    path: "",
    meaning: "A scenario file: what is flown.",
    keys: &[
        SEED,
        other("scenario", Kind::Table, "name and note"),
        other("vehicle", Kind::Table, "mass side"),
        optional(other("tether", Kind::Table, "safety tether; absent: free flight")),
        other("environment", Kind::Table, "gravity and gas"),
        other("sensors", Kind::Table, "noise of the instruments"),
        optional(other("uncertainty", Kind::Table, "uncertainties that campaigns made of this scenario declare")),
        other("aero", Kind::Table, "the true aerodynamics, [aero.<name>]"),
        optional(other("effects", Kind::Table, "effects beyond the declared model, [effects.<family>]")),
        optional(other("section", Kind::Table, "walls and nets; absent: none")),
        optional(other("numerics", Kind::Table, "integrator settings")),
        other("flight", Kind::Tables, "flights, [[flight]]"),
        optional(other("provenance", Kind::Table, "written by the program")),
    ],
};
pub(crate) static SCENARIO: TableSpec = TableSpec {
    path: "scenario",
    meaning: "Name of the scenario.",
    keys: &[other("name", Kind::Text, "name"), optional(other("note", Kind::Text, "anything"))],
};
pub(crate) static EFFECTS: TableSpec = TableSpec {
    path: "effects.<family>",
    meaning: "An effect in the truth that campaigns made of this scenario do not declare; families and parameters are those of the \
              catalogue. A strength that is not given is zero; shapes, instants and runs must be given.",
    keys: &[],
};
pub(crate) static SECTION: TableSpec = TableSpec {
    path: "section",
    meaning: "A flight ends with a named event when the c.m. leaves.",
    keys: &[
        num("radius_m", "m", TINY, 1e6, "largest horizontal distance from the axis"),
        num("top_x_m", "m", -1e6, 1e6, "tunnel X (down) of the upper net"),
        num("bottom_x_m", "m", -1e6, 1e6, "tunnel X (down) of the lower net"),
    ],
};
pub(crate) static NUMERICS: TableSpec = TableSpec {
    path: "numerics",
    meaning: "Integrator; what is absent takes the program's default and is written out in the resolved file.",
    keys: &[
        optional(other("method", Kind::Choice(&["dopri5", "dop853"]), "integrator")),
        optional(num("relative_tolerance", "-", 1e-14, 1e-2, "relative tolerance")),
        optional(num("absolute_tolerance", "SI", 1e-16, 1e-2, "absolute tolerance")),
    ],
};
pub(crate) static PROVENANCE: TableSpec = TableSpec {
    path: "provenance",
    meaning: "Where a resolved file came from; read and ignored.",
    keys: &[
        optional(other("windfall", Kind::Text, "version of the program")),
        optional(other("input", Kind::Text, "name of the scenario file or bundled scenario")),
        optional(other("input_hash", Kind::Text, "FNV-1a 64-bit hash of its bytes")),
    ],
};
pub(crate) static FLIGHT: TableSpec = TableSpec {
    path: "flight",
    meaning: "One flight; exactly one of [flight.speed.operator], [flight.speed.history], [flight.speed.constant].",
    keys: &[
        other("name", Kind::Text, "name of the run it makes"),
        other("kind", Kind::Text, "perturbed, unperturbed, drop, or your word"),
        other("use", Kind::Choice(&USES), "use in the campaign that is made"),
        num("duration_s", "s", 0.01, 1e4, "duration; with rate_hz at most a million samples"),
        num("rate_hz", "Hz", 0.1, 1e5, "sample rate"),
        other("sensor_noise", Kind::Bool, "whether the record carries sensor noise"),
        optional(Key {
            name: "window_s",
            kind: Kind::Numbers(2),
            unit: "s",
            range: [0.0, 1e4],
            needed: false,
            meaning: "part of the record that the campaign uses, [from, to] from the first sample; absent: all",
        }),
        optional(other("push", Kind::Tables, "pushes of a pole, [[flight.push]]")),
        other("release", Kind::Table, "state at the first sample"),
        other("speed", Kind::Table, "tunnel speed"),
    ],
};
pub(crate) static RELEASE: TableSpec = TableSpec {
    path: "flight.release",
    meaning: "State of the c.m. at the first sample.",
    keys: &[
        vec3("position_m", "m", 1e6, "position, tunnel axes (X down)"),
        vec3("velocity_m_s", "m/s", 1e5, "velocity, tunnel axes"),
        vec3("attitude_deg", "deg", 360.0, "R_x, R_y, R_z; T = Rx Ry Rz maps body to tunnel"),
        vec3("rates_deg_s", "deg/s", 1e5, "p, q, r"),
    ],
};
pub(crate) static PUSH: TableSpec = TableSpec {
    path: "flight.push",
    meaning: "A push of a pole: a pulse that goes as sin² in time. What identifies never sees it; a window that starts at its end leaves it out.",
    keys: &[
        num("start_s", "s", -2.0, 1e4, "when it begins, from the first sample"),
        num("duration_s", "s", 0.01, 10.0, "how long it lasts"),
        vec3("impulse_n_s", "N s", 5.0, "linear impulse, body axes"),
        vec3("angular_impulse_n_m_s", "N m s", 1.0, "angular impulse about the c.m., body axes"),
    ],
};
pub(crate) static SPEED: TableSpec = TableSpec {
    path: "flight.speed",
    meaning: "Exactly one of these.",
    keys: &[
        optional(other("operator", Kind::Table, "a hand that throttles to hold the model's height")),
        optional(other("history", Kind::Table, "a given history")),
        optional(other("constant", Kind::Table, "a constant")),
    ],
};
pub(crate) static OPERATOR: TableSpec = TableSpec {
    path: "flight.speed.operator",
    meaning: "Operator and fan.",
    keys: &[
        optional(num("trim_m_s", "m/s", 0.0, 1e4, "speed around which the hand works; absent: the plant's trim speed")),
        num("height_gain_per_s", "(m/s)/m", 0.0, 1e3, "speed for sinking below the held height"),
        num("rate_gain", "(m/s)/(m/s)", 0.0, 1e3, "speed for the rate of sinking"),
        num("integral_gain_per_s2", "(m/s)/(m s)", 0.0, 1e3, "integral gain"),
        num("lag_s", "s", 1e-3, 1e3, "first-order lag of hand and fan"),
        num("unsteady_rms_m_s", "m/s", 0.0, 10.0, "rms of the unsteady hand, before the lag"),
        num("unsteady_time_s", "s", 1e-3, 1e4, "correlation time of the unsteady hand"),
        num("hold_x_m", "m", -1e6, 1e6, "height that is held, tunnel X of the c.m."),
    ],
};
pub(crate) static HISTORY: TableSpec = TableSpec {
    path: "flight.speed.history",
    meaning: "A given history of V_W, uniform from the first sample, held beyond its end.",
    keys: &[
        num("interval_s", "s", 1e-6, 1e5, "sample interval"),
        Key { name: "vw_m_s", kind: Kind::Series, unit: "m/s", range: [0.0, 1e4], needed: true, meaning: "speeds" },
    ],
};
pub(crate) static CONSTANT: TableSpec = TableSpec {
    path: "flight.speed.constant",
    meaning: "A constant V_W.",
    keys: &[num("vw_m_s", "m/s", 0.0, 1e4, "speed, upward; 0 for a drop in still air")],
};
pub(crate) static STRUCTURE_FILE: TableSpec = TableSpec {
    path: "",
    meaning: "A structure file: the aerodynamics of another vehicle as parameter x term.",
    keys: &[
        other("parameters", Kind::Words, "parameter names, in order"),
        other("term", Kind::Tables, "what each parameter adds to a coefficient, [[term]]"),
    ],
};
pub(crate) static TERM: TableSpec = TableSpec {
    path: "term",
    meaning: "One contribution: parameter x scale x product of factors.",
    keys: &[
        other("coefficient", Kind::Choice(&["CA", "CY", "CN", "Cl", "Cm", "Cn"]), "coefficient at the geometric origin"),
        other("parameter", Kind::Text, "one of `parameters`"),
        num("scale", "-", -1e9, 1e9, "constant factor, usually 1 or -1"),
        other(
            "factors",
            Kind::Tables,
            "list of [\"variable\", power 1 to 9], { bump = \"variable\", width = number }, { sin_clock = n } or { cos_clock = n }",
        ),
    ],
};

pub(crate) static STUDY_FILE: TableSpec = TableSpec {
    path: "",
    meaning: "A study file: many draws around a scenario or a measured campaign.",
    keys: &[
        other("study", Kind::Table, "name, what is drawn from, how often"),
        optional(other("do", Kind::Table, "what is done to each draw after it is flown; absent: nothing")),
        optional(other("keep", Kind::Table, "what is kept of each draw; absent: all")),
        optional(other("vary", Kind::Tables, "what varies beside noise and gusts, [[vary]]")),
        optional(other("correlation", Kind::Tables, "what varies together, [[correlation]]")),
        optional(other(
            "effects",
            Kind::Table,
            "effects in the truth beside the scenario's, or in place of one of the same family",
        )),
        optional(other("histories", Kind::Table, "recorded tunnel speeds, of which each draw takes one")),
        optional(other("stop", Kind::Table, "when the study may end before all draws; absent: never")),
    ],
};
pub(crate) static STUDY: TableSpec = TableSpec {
    path: "study",
    meaning: "Exactly one of `scenario` and `campaign`. A campaign's runs are flown again with their recorded tunnel speed, from the \
              initial state estimated from each.",
    keys: &[
        other("name", Kind::Text, "name"),
        optional(other("note", Kind::Text, "anything")),
        optional(other("scenario", Kind::Text, "bundled scenario, or scenario file beside the study file")),
        optional(other("campaign", Kind::Text, "campaign file beside the study file")),
        optional(other(
            "model",
            Kind::Text,
            "identification.json that is flown, with `campaign`; absent: the campaign's own values",
        )),
        Key {
            name: "draws",
            kind: Kind::Integer,
            unit: "-",
            range: [1.0, limits::DRAWS],
            needed: true,
            meaning: "number of draws",
        },
        Key {
            name: "seed",
            kind: Kind::Integer,
            unit: "-",
            range: [0.0, 9_007_199_254_740_992.0],
            needed: true,
            meaning: "seed of all chance",
        },
        optional(Key {
            name: "part_draws",
            kind: Kind::Integer,
            unit: "-",
            range: [1.0, limits::PART_DRAWS],
            needed: false,
            meaning: "draws in each part of the results; 256 when absent",
        }),
    ],
};
pub(crate) static DO: TableSpec = TableSpec {
    path: "do",
    meaning: "What is done to each draw after it is flown.",
    keys: &[
        optional(other(
            "identify",
            Kind::Words,
            "methods to identify with, as equation-error; `windfall identify --help` has all",
        )),
        optional(other(
            "resimulate",
            Kind::Bool,
            "fly each identified model against the draw's runs, hold-out ones where there are any",
        )),
        optional(other("close", Kind::Bool, "close the loop")),
    ],
};
pub(crate) static KEEP: TableSpec = TableSpec {
    path: "keep",
    meaning: "What is kept of each draw beside its number, its failure and what varied; each true when absent.",
    keys: &[
        optional(other("flights", Kind::Bool, "duration, largest angle and Table 5.6's statistics of each flight's truth")),
        optional(other("estimates", Kind::Bool, "estimate, error, standard error, whether the interval covers the truth")),
        optional(other("intervals", Kind::Bool, "ends of the 95 % intervals")),
        optional(other("resimulation", Kind::Bool, "errors of the re-simulation")),
        optional(other("closing", Kind::Bool, "verdict, effects and their numbers")),
    ],
};
pub(crate) static VARY: TableSpec = TableSpec {
    path: "vary",
    meaning: "One number that varies. `quantity` is a key of the scenario file with its table (`vehicle.mass_kg`, \
              `flight.release.attitude_deg.Ry`), `aero.<parameter>` or `effects.<family>.<parameter>`; values have that key's unit. \
              Exactly one of normal, uniform, log_normal, choice.",
    keys: &[
        other("quantity", Kind::Text, "what varies"),
        optional(other("flights", Kind::Words, "flights concerned, for `flight.` and `environment.static_`; absent: all")),
        optional(other("known", Kind::Bool, "the declared model has each draw's value; absent: false, it keeps the nominal one")),
        optional(other("normal", Kind::Table, "normal distribution, cut where low and high say")),
        optional(other("uniform", Kind::Table, "uniform distribution")),
        optional(other("log_normal", Kind::Table, "median times exp(sigma z)")),
        optional(other("choice", Kind::Table, "one of some values, each as likely")),
    ],
};
const WIDE: f64 = 1e15;
pub(crate) static NORMAL: TableSpec = TableSpec {
    path: "vary.normal",
    meaning: "Normal distribution.",
    keys: &[
        num("mean", "-", -WIDE, WIDE, "mean, before cutting"),
        num("std", "-", 1e-30, WIDE, "standard deviation, before cutting"),
        optional(num("low", "-", -WIDE, WIDE, "nothing below")),
        optional(num("high", "-", -WIDE, WIDE, "nothing above")),
    ],
};
pub(crate) static UNIFORM: TableSpec = TableSpec {
    path: "vary.uniform",
    meaning: "Uniform distribution.",
    keys: &[num("low", "-", -WIDE, WIDE, "smallest"), num("high", "-", -WIDE, WIDE, "largest")],
};
pub(crate) static LOG_NORMAL: TableSpec = TableSpec {
    path: "vary.log_normal",
    meaning: "Log-normal distribution.",
    keys: &[
        num("median", "-", -WIDE, WIDE, "median; its sign is that of every draw"),
        num("sigma", "-", 1e-9, 10.0, "standard deviation of the logarithm"),
    ],
};
pub(crate) static CHOICE: TableSpec = TableSpec {
    path: "vary.choice",
    meaning: "One of these, each as likely.",
    keys: &[Key { name: "values", kind: Kind::Series, unit: "-", range: [-WIDE, WIDE], needed: true, meaning: "values" }],
};
pub(crate) static CORRELATION: TableSpec = TableSpec {
    path: "correlation",
    meaning: "Correlation of the standard normals behind two quantities that vary (a Gaussian copula; for two uncut normals it is theirs).",
    keys: &[
        other("between", Kind::Words, "two quantities of [[vary]]"),
        num("coefficient", "-", -0.999_999, 0.999_999, "correlation coefficient"),
    ],
};
pub(crate) static HISTORIES: TableSpec = TableSpec {
    path: "histories",
    meaning: "Recorded tunnel speeds in place of the flights' own; held beyond their end.",
    keys: &[
        other("files", Kind::Words, "run files beside the study file; their V_W is taken"),
        optional(other("flights", Kind::Words, "flights concerned; absent: all")),
    ],
};
pub(crate) static STOP: TableSpec = TableSpec {
    path: "stop",
    meaning: "The study ends with the first whole part after which the 95 % interval of the asked-for quantity is narrow enough; parts \
              count in the order of their index, so that the end depends on nothing else.",
    keys: &[
        other("column", Kind::Text, "column of the results: of numbers the mean is asked for, of true and false the rate"),
        num("half_width", "-", 1e-30, WIDE, "half width of the interval that is enough, in the column's unit"),
        optional(Key {
            name: "least_draws",
            kind: Kind::Integer,
            unit: "-",
            range: [1.0, limits::DRAWS],
            needed: false,
            meaning: "fewest draws; 100 when absent",
        }),
    ],
};

/// All tables in the order of the reference: campaign files, scenario files, scenarios in free flight, planet scenarios, structure files, study files.
pub(crate) static ALL: [(&str, &[&TableSpec]); 6] = [
    (
        "Campaign file",
        &[
            &CAMPAIGN_FILE,
            &CAMPAIGN,
            &VEHICLE,
            &INERTIA,
            &VEHICLE_POINT,
            &TETHER,
            &AXES,
            &ENVIRONMENT,
            &ENVIRONMENT_POINT,
            &ATMOSPHERE_PLANET,
            &PIVOT,
            &FREE_FLIGHT,
            &PART,
            &THRUST,
            &SENSORS,
            &SENSORS_POINT,
            &SENSORS_FREE,
            &UNCERTAINTY,
            &UNCERTAINTY_VEHICLE,
            &UNCERTAINTY_INERTIA,
            &UNCERTAINTY_VEHICLE_POINT,
            &UNCERTAINTY_TETHER,
            &UNCERTAINTY_PIVOT,
            &UNCERTAINTY_FREE_FLIGHT,
            &UNCERTAINTY_ENVIRONMENT,
            &UNCERTAINTY_ENVIRONMENT_POINT,
            &UNCERTAINTY_SENSORS,
            &UNCERTAINTY_SENSORS_POINT,
            &UNCERTAINTY_SENSORS_FREE,
            &UNCERTAINTY_AERO,
            &AERO,
            &AERO_TABLE,
            &CAMPAIGN_EFFECTS,
            &WIND_TUNNEL,
            &RUN,
            &INPUT,
            &RUN_VEHICLE,
            &RUN_ENVIRONMENT,
            &RUN_AERO,
            &COLUMNS,
            &COLUMN,
            &COLUMNS_AXES,
            &COLUMNS_ATTITUDE,
        ],
    ),
    (
        "Scenario file",
        &[
            &SCENARIO_FILE,
            &SCENARIO,
            &VEHICLE,
            &INERTIA,
            &TETHER,
            &ENVIRONMENT_SCENARIO,
            &SENSORS,
            &UNCERTAINTY,
            &AERO,
            &EFFECTS,
            &SECTION,
            &NUMERICS,
            &FLIGHT,
            &PUSH,
            &RELEASE,
            &SPEED,
            &OPERATOR,
            &HISTORY,
            &CONSTANT,
            &PROVENANCE,
        ],
    ),
    ("Scenario in free flight", &[&FREE_FILE, &FLIGHT_FREE, &RELEASE_FREE]),
    ("Planet scenario", &planet::PLANET_TABLES),
    ("Structure file", &[&STRUCTURE_FILE, &TERM]),
    (
        "Study file",
        &[
            &STUDY_FILE,
            &STUDY,
            &DO,
            &KEEP,
            &VARY,
            &NORMAL,
            &UNIFORM,
            &LOG_NORMAL,
            &CHOICE,
            &CORRELATION,
            &EFFECTS,
            &HISTORIES,
            &STOP,
        ],
    ),
];
