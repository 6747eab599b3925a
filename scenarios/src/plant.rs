//! scenarios: the tables that campaign and scenario files share. In: open tables. Out: parts of a plant, in SI and rad.

use crate::free_flight;
use crate::keys;
use crate::point_body;
use crate::structure::{DeclaredAero, read_aero};
use crate::table::Table;
use crate::uncertainty::read_uncertainty;
use windfall_model::frames::Vec3;
use windfall_model::{
    ApparentMass, Environment, Inertia, Knowledge, MeanFlow, Measured, Plant, PointMass, Sensors, Structure, Tether, Turbulence,
    Vehicle, WakeShedding,
};

/// A plant as declared, with what the file says besides.
pub(crate) struct Declared {
    pub(crate) plant: Plant,
    pub(crate) declared: Vec<bool>,
    /// Uncertainties and whether noise is exact; declared effects are read by who knows the runs.
    pub(crate) knowledge: Knowledge,
    pub(crate) structure_file: Option<String>,
    pub(crate) point_mass: bool,
    /// Whether aerodynamic parameters without a prior are exact.
    pub(crate) held: bool,
    /// What the runs of a point mass measured.
    pub(crate) measured: Measured,
    /// Static pressure (Pa) and temperature (K), in scenario files.
    pub(crate) air: [f64; 2],
}

/// Reads `[vehicle]`, `[tether]`, `[environment]`, `[sensors]` and `[aero]` of a campaign or, with `scenario`, a scenario file.
pub(crate) fn read_declared(file: &Table<'_>, scenario: bool) -> Option<Declared> {
    let aero = read_aero(file, !scenario);
    let point_mass = aero.as_ref().is_some_and(|a| a.aero.structure.name == Structure::point_mass().name);
    let free = (!scenario && file.has("free_flight")).then(|| free_flight::free_flight(file));
    if let Some([what, instead]) = no_point_mass(scenario, free.is_some()).filter(|_| point_mass) {
        file.source.fault(None, "[aero.point_mass]", "", what, instead);
        return None;
    }
    let vehicle = if point_mass { vehicle_point(file) } else { vehicle(file, scenario, free.is_some()) };
    let tether = tether(file, point_mass);
    let mut point = PointMass::default();
    let (environment, air) = environment(file, scenario, (point_mass || free.is_some()).then_some(&mut point));
    let read = match (point_mass, &free) {
        (true, _) => point_body::sensors(file, &mut point),
        (false, Some(_)) => free_flight::sensors(file),
        (false, None) => sensors(file),
    };
    if point_mass {
        point.pivot = point_body::pivot(file);
    } else if file.has("pivot") && free.is_none() {
        file.source.fault(file.at("pivot"), "[pivot]", "", "holds a body without attitude", "[aero.point_mass]");
    }
    let DeclaredAero { aero, mut declared, structure_file, drag_over_mach } = aero?;
    point.drag_over_mach = drag_over_mach;
    point_body::fits(file, &point);
    let (free_flight, held) = free.map_or(Some((None, false)), |f| f.map(|(free, held)| (Some(free), held)))?;
    let (sensors, measured, exact_noise) = read?;
    let plant = Plant {
        vehicle: vehicle?,
        aero,
        tether,
        flow: MeanFlow::default(),
        turbulence: Turbulence::default(),
        shedding: WakeShedding::default(),
        drift: Default::default(),
        scatter: Default::default(),
        contacts: Vec::new(),
        environment: environment?,
        sensors,
        point,
        free_flight,
    };
    if plant.free_flight.is_some() {
        free_flight::fits(file, &plant);
    }
    let mut knowledge = Knowledge { exact_noise, ..Knowledge::default() };
    read_uncertainty(file, &plant, point_mass, &mut knowledge);
    if point_mass {
        point_body::prior_of_drag(&mut declared, &plant, &mut knowledge);
    }
    Some(Declared { plant, declared, knowledge, structure_file, point_mass, held, measured, air })
}

/// Why the body must be one with attitude, and what to declare instead.
fn no_point_mass(scenario: bool, free: bool) -> Option<[&'static str; 2]> {
    match (scenario, free) {
        (true, _) => {
            Some(["a scenario flies a body with attitude; point masses are read from campaigns only", "[aero.axisymmetric]"])
        }
        (false, true) => Some([
            "is a body without attitude, and [free_flight] is of a rigid one",
            "[aero.<name>] with structure = \"file.toml\", or no [free_flight]",
        ]),
        (false, false) => None,
    }
}

fn vehicle(file: &Table<'_>, scenario: bool, free: bool) -> Option<Vehicle> {
    let t = file.table(&keys::VEHICLE)?;
    let (inertia, mass_kg, diameter_m) = (inertia_of(&t, !free), t.number("mass_kg"), t.number("reference_diameter_m"));
    // A campaign's records say more of what is wrong with its constants; they are asked later.
    if let Some(inertia) = inertia.as_ref().filter(|_| scenario) {
        gyration(&t, inertia, mass_kg, diameter_m);
    }
    Some(Vehicle {
        mass_kg,
        p_origin_cm: Vec3::from_array(t.numbers("center_of_mass_m")),
        diameter_m,
        inertia: inertia?,
        apparent: ApparentMass::default(),
        loose: None,
    })
}

/// Mass, size and inertia must be of one body.
fn gyration(t: &Table<'_>, inertia: &Inertia, mass_kg: f64, diameter_m: f64) {
    let [low, high] = Inertia::GYRATION_OVER_DIAMETER;
    for (name, moment) in [("xx", inertia.xx), ("yy", inertia.yy), ("zz", inertia.zz)] {
        let ratio = (moment / mass_kg).sqrt() / diameter_m;
        if ratio.is_finite() && !(low..=high).contains(&ratio) {
            let what = format!(
                "with mass_kg = {mass_kg} gives a radius of gyration of {ratio:.3e} reference_diameter_m; a body has {low} to {high}"
            );
            let remedy = "inertia in kg m2 (1e-4 x kg cm2), mass in kg, diameter in m";
            t.source.fault(t.at("inertia_kg_m2"), t.full("inertia_kg_m2"), format!("{name} = {moment}"), what, remedy);
            return;
        }
    }
}

/// Moments and products of inertia of `[vehicle]`, which must be a real body's.
pub(crate) fn inertia(t: &Table<'_>) -> Option<Inertia> {
    inertia_of(t, true)
}

/// The same; in free flight through air as heavy as the body (`real` is false), what is declared may have the air's share in it, which no
/// triangle binds: the reader of campaigns warns of it.
fn inertia_of(t: &Table<'_>, real: bool) -> Option<Inertia> {
    t.table(&keys::INERTIA).map(|i| {
        let read = Inertia {
            xx: i.number("xx"),
            yy: i.number("yy"),
            zz: i.number("zz"),
            xy: i.number("xy"),
            xz: i.number("xz"),
            yz: i.number("yz"),
        };
        let all = [read.xx, read.yy, read.zz, read.xy, read.xz, read.yz];
        let can_be = if real { read.is_physical() } else { read.is_positive() };
        if all.iter().all(|x| x.is_finite()) && !can_be {
            let what =
                "is not the inertia of a real body: eigenvalues must be positive and none larger than the sum of the others";
            let try_ = "check units (kg m2) and the sign of products (positive integrals of x y dm)";
            t.source.fault(Some(i.span.clone()), t.full("inertia_kg_m2"), t.source.snippet(i.span.clone()), what, try_);
        }
        read
    })
}

fn vehicle_point(file: &Table<'_>) -> Option<Vehicle> {
    let t = file.table(&keys::VEHICLE_POINT)?;
    Some(Vehicle {
        mass_kg: t.number("mass_kg"),
        diameter_m: t.number("reference_diameter_m"),
        inertia: Inertia::default(),
        p_origin_cm: Vec3::zero(),
        apparent: ApparentMass::default(),
        loose: None,
    })
}

fn tether(file: &Table<'_>, point_mass: bool) -> Option<Tether> {
    if !file.has("tether") {
        return None;
    }
    let t = file.table(&keys::TETHER)?;
    if point_mass {
        t.source.fault(Some(t.span.clone()), "[tether]", "", "a point mass has no tether", "remove the table");
    }
    let (hook, ring) = (t.numbers::<3>("attachment_m"), t.numbers::<3>("ring_m"));
    if hook.iter().chain(&ring).all(|x| x.is_finite()) && Vec3::<windfall_model::frames::Tunnel>::from_array(ring).norm() < 1e-6 {
        t.source.fault(
            t.at("ring_m"),
            t.full("ring_m"),
            "",
            "must not be the tunnel origin: the line's direction is undefined",
            "[-3.0, 0.0, 0.0]",
        );
    }
    Some(Tether::declared(
        Vec3::from_array(hook),
        Vec3::from_array(ring),
        t.number("drag_area_m2"),
        t.number("effective_weight_n"),
    ))
}

/// Environment, and the state of the air of a scenario (NaN otherwise); of a point mass its air goes into `point`.
fn environment(file: &Table<'_>, scenario: bool, point: Option<&mut PointMass>) -> (Option<Environment>, [f64; 2]) {
    let spec = match (scenario, point.is_some()) {
        (true, _) => &keys::ENVIRONMENT_SCENARIO,
        (false, true) => &keys::ENVIRONMENT_POINT,
        (false, false) => &keys::ENVIRONMENT,
    };
    let Some(t) = file.table_named("environment", spec) else { return (None, [f64::NAN; 2]) };
    if let Some(point) = point {
        return (Some(point_body::environment(&t, point)), [f64::NAN; 2]);
    }
    let environment =
        Environment { gravity_m_s2: t.number("gravity_m_s2"), gas_constant_j_kg_k: t.number("gas_constant_j_kg_k") };
    let air = if scenario { [t.number("static_pressure_pa"), t.number("static_temperature_k")] } else { [f64::NAN; 2] };
    (Some(environment), air)
}

/// Instruments of a body with attitude, and whether their noise is exact.
fn sensors(file: &Table<'_>) -> Option<(Sensors, Measured, bool)> {
    let t = file.table(&keys::SENSORS)?;
    let exact = t.has("noise") && t.choice("noise") == Some(1);
    let all = Sensors {
        position_std_m: t.number("position_std_m"),
        roll_std_rad: t.number("roll_std_deg").to_radians(),
        pitch_yaw_std_rad: t.number("pitch_yaw_std_deg").to_radians(),
        wind_std_m_s: t.number("wind_std_m_s"),
        ..Sensors::default()
    };
    Some((all, Measured::Position, exact))
}
