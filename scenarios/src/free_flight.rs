//! scenarios: what campaigns of rigid bodies in free flight say of body, parts, thrusts and sensors. In: open tables. Out: parts of a plant.

use crate::keys::{self, TableSpec};
use crate::table::{Table, Value, number};
use windfall_model::frames::{Body, Vec3};
use windfall_model::{Factor, FreeFlight, Measured, MovedPart, Plant, Sensors, Setting, Thrust};

/// `[free_flight]`, without parts and thrusts, and whether its coefficients are held.
pub(crate) fn free_flight(file: &Table<'_>) -> Option<(FreeFlight, bool)> {
    let t = file.table(&keys::FREE_FLIGHT)?;
    let free = FreeFlight {
        area_m2: t.number("reference_area_m2"),
        wind_axes: t.choice("coefficient_axes")? == 1,
        buoyancy_kg: t.number("buoyancy_kg"),
        p_origin_buoyancy: Vec3::from_array(t.numbers("center_of_buoyancy_m")),
        rate_damping_n_m_s: t.numbers("rate_damping_n_m_s"),
        ..FreeFlight::default()
    };
    Some((free, t.choice("coefficients")? == 0))
}

/// `[sensors]` of such a body, what they measure, and whether their noise is exact.
pub(crate) fn sensors(file: &Table<'_>) -> Option<(Sensors, Measured, bool)> {
    let t = file.table(&keys::SENSORS_FREE)?;
    let exact = t.has("noise") && t.choice("noise") == Some(1);
    let sensors = Sensors {
        position_std_m: t.number("position_std_m"),
        roll_std_rad: t.number("roll_std_deg").to_radians(),
        pitch_yaw_std_rad: t.number("pitch_yaw_std_deg").to_radians(),
        ..Sensors::default()
    };
    Some((sensors, Measured::Pose, exact))
}

/// What such a campaign may not have: a tether, a pivot, air that thins, terms that need the rates of the flow's angles.
pub(crate) fn fits(file: &Table<'_>, plant: &Plant) {
    let refuse = |key: &str, what: &str, remedy: &str| file.source.fault(file.at(key), format!("[{key}]"), "", what, remedy);
    if file.has("tether") {
        refuse("tether", "holds a body that [free_flight] lets go", "remove one of the tables");
    }
    if file.has("pivot") {
        refuse("pivot", "holds a body without attitude", "remove one of the tables");
    }
    if plant.point.atmosphere.is_some() {
        refuse(
            "environment",
            "has an atmosphere over height, and [free_flight] is through air of one density",
            "air_density_kg_m3",
        );
    }
    if plant.aero.structure.contributions.iter().any(|c| c.term.factors.iter().any(|f: &Factor| f.needs_rates())) {
        let what = "has a term of q_alpha_dot_hat or r_beta_dot_hat, which [free_flight] does not fly";
        refuse("aero", what, "p_hat, q_hat, r_hat, or rate_damping_n_m_s");
    }
}

/// `[[part]]` and `[[thrust]]`, whose places and sizes name inputs of the runs, into the plant's body in free flight.
pub(crate) fn parts_and_thrusts(file: &Table<'_>, inputs: &[String], plant: &mut Plant) {
    let Some(free) = plant.free_flight.as_mut() else {
        for key in [&keys::PART, &keys::THRUST].map(|t| t.name()).into_iter().filter(|k| file.has(k)) {
            let what = "is for a rigid body in free flight";
            file.source.fault(file.at(key), format!("[[{key}]]"), "", what, "[free_flight], or remove it");
        }
        return;
    };
    let open = |spec: &'static TableSpec| if file.has(spec.name()) { file.tables(spec) } else { Vec::new() };
    let part = |t: &Table<'_>| Some(MovedPart { mass_kg: t.number("mass_kg"), place_m: place(t, inputs)? });
    free.parts = open(&keys::PART).iter().filter_map(part).collect();
    free.thrusts = open(&keys::THRUST).iter().filter_map(|t| thrust(t, inputs)).collect();
}

fn thrust(t: &Table<'_>, inputs: &[String]) -> Option<Thrust> {
    let direction = Vec3::<Body>::from_array(t.numbers("direction"));
    let length = direction.norm();
    if length == 0.0 {
        t.source.fault(t.at("direction"), t.full("direction"), "", "has no direction", "[1.0, 0.0, 0.0]");
    }
    let size_n = setting(t, "size_n", t.value("size_n")?, inputs)?;
    Some(Thrust { size_n, direction: direction * (1.0 / length), place_m: place(t, inputs)? })
}

fn place(t: &Table<'_>, inputs: &[String]) -> Option<[Setting; 3]> {
    let at = t.value("place_m")?;
    let list = at.get_ref().as_array().filter(|l| l.len() == 3);
    let Some(list) = list else {
        let what = "must be three numbers or names of run inputs";
        t.source.fault(Some(at.span()), t.full("place_m"), t.source.snippet(at.span()), what, "[0.0, 0.0, \"slide_m\"]");
        return None;
    };
    let all: Vec<Setting> = list.iter().filter_map(|v| setting(t, "place_m", v, inputs)).collect();
    all.try_into().ok()
}

/// A number, or the name of an input that all runs have.
fn setting(t: &Table<'_>, key: &str, at: Value<'_>, inputs: &[String]) -> Option<Setting> {
    if let Some(x) = number(at).filter(|x| x.is_finite() && x.abs() <= 1e9) {
        return Some(Setting::Fixed(x));
    }
    let found = at.get_ref().as_str().and_then(|name| inputs.iter().position(|n| n == name));
    if found.is_none() {
        let known = if inputs.is_empty() { "none".to_owned() } else { inputs.join(", ") };
        let what = format!("must be a number from -1e9 to 1e9 or the name of a run input; inputs of the runs: {known}");
        t.source.fault(Some(at.span()), t.full(key), t.source.snippet(at.span()), what, "[run] inputs = { name = number }");
    }
    found.map(Setting::Input)
}
