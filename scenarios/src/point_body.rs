//! scenarios: what campaigns of bodies without attitude say of body, air, pivot, drag and sensors. In: open tables. Out: parts of a
//! plant, and what a run has of its own.

use crate::keys;
use crate::profile::{atmosphere, rows};
use crate::table::{Source, Table, Value, number};
use windfall_model::{
    CoefficientTable, Constant, Environment, Knowledge, Measured, PLANT_NUMBERS, Pivot, Plant, PointMass, Sensors,
};

/// Columns of a file of drag over Mach number.
const DRAG_COLUMNS: [&str; 2] = ["mach", "CD"];

/// `CD` of `[aero.point_mass]` where it is a table; `None` with a fault, `Some(None)` where it is a number.
pub(crate) fn drag_table(t: &Table<'_>, campaign: bool) -> Option<Option<CoefficientTable>> {
    let given = t.entries().find(|(k, _)| k.get_ref() == "CD").filter(|(_, v)| v.get_ref().as_table().is_some());
    let Some((_, at)) = given else { return Some(None) };
    if !campaign {
        let what = "is a table over Mach number, which campaigns of bodies without attitude alone may have";
        t.source.fault(Some(at.span()), t.full("CD"), "", what, "CD = a number");
        return None;
    }
    for (key, value) in t.entries().filter(|(k, _)| !["CD", "declared"].contains(&k.get_ref().as_ref())) {
        t.unknown(key, value, &["CD", "declared"]);
    }
    table_of(t.source, &t.full("CD"), at).map(Some)
}

/// One table of C_D: points, or a file of them.
fn table_of(source: &Source<'_>, path: &str, at: Value<'_>) -> Option<CoefficientTable> {
    let t = Table::new(source, path, at.get_ref().as_table()?, at.span(), &keys::AERO_TABLE);
    t.choice("over")?;
    if t.has("file") == (t.has("at") || t.has("values")) {
        let what = "must have either `file`, or `at` and `values`";
        source.fault(Some(t.span.clone()), path, "", what, "{ over = \"mach\", file = \"drag.csv\" }");
        return None;
    }
    let (at, values): (Vec<f64>, Vec<f64>) = if t.has("file") {
        rows(&t, DRAG_COLUMNS, |_| Ok(()))?.into_iter().map(|[m, c]| (m, c)).unzip()
    } else {
        for key in ["at", "values"].into_iter().filter(|k| !t.has(k)) {
            source.fault(Some(t.span.clone()), t.full(key), "", "is missing; a table has both", format!("{key} = [...]"));
        }
        (if t.has("at") { t.series("at") } else { Vec::new() }, if t.has("values") { t.series("values") } else { Vec::new() })
    };
    if source.has_faults() {
        return None;
    }
    let made = CoefficientTable::new(at, values);
    if made.is_none() {
        let what = "must have as many values as points, which ascend";
        source.fault(Some(t.span.clone()), path, "", what, "at = [0.0, 0.8], values = [0.5, 0.6]");
    }
    made
}

/// `[environment]`: gravity; density, atmosphere and launch height into the body's air.
pub(crate) fn environment(t: &Table<'_>, into: &mut PointMass) -> Environment {
    let environment = Environment { gravity_m_s2: t.number("gravity_m_s2"), gas_constant_j_kg_k: f64::NAN };
    let density = t.number_if("air_density_kg_m3");
    if t.has("atmosphere") {
        into.atmosphere = atmosphere(t);
        into.launch_height_m = t.number_if("launch_height_m").unwrap_or(0.0);
        let own = into.atmosphere.as_ref().map(|a| a.at(into.launch_height_m).density_kg_m3());
        into.air_density_kg_m3 = density.or(own).unwrap_or(f64::NAN);
        return environment;
    }
    if t.has("launch_height_m") {
        let what = "says where in an atmosphere the launch is, and there is none";
        t.source.fault(t.at("launch_height_m"), t.full("launch_height_m"), "", what, "atmosphere = \"us-1976\", or remove it");
    }
    if density.is_none() {
        let what = "is missing; it has no default";
        t.source.fault(
            Some(t.span.clone()),
            t.full("air_density_kg_m3"),
            "",
            what,
            "air_density_kg_m3 = ..., or atmosphere = \"us-1976\" and launch_height_m",
        );
    }
    into.air_density_kg_m3 = density.unwrap_or(f64::NAN);
    environment
}

/// `[pivot]`.
pub(crate) fn pivot(file: &Table<'_>) -> Option<Pivot> {
    let t = file.table_if(&keys::PIVOT)?;
    Some(Pivot {
        arm_m: t.number("arm_m"),
        inertia_kg_m2: t.number("inertia_kg_m2"),
        viscous_n_m_s: t.number("viscous_n_m_s"),
        dry_n_m: 0.0,
    })
}

/// `[sensors]`: noise, what was measured, and whether heights are an altimeter's; whether the noise is exact.
pub(crate) fn sensors(file: &Table<'_>, into: &mut PointMass) -> Option<(Sensors, Measured, bool)> {
    let t = file.table(&keys::SENSORS_POINT)?;
    let exact = t.has("noise") && t.choice("noise") == Some(1);
    let all = [
        ("position_std_m", Measured::Position),
        ("specific_force_std_m_s2", Measured::SpecificForce),
        ("angle_std_deg", Measured::Angle),
    ];
    let given: Vec<Measured> = all.iter().filter(|(k, _)| t.has(k)).map(|(_, m)| *m).collect();
    let measured = match given[..] {
        [one] => one,
        [Measured::Position, Measured::SpecificForce] => Measured::PositionAndForce,
        _ => {
            let what = "must say what the runs measured: one of position_std_m, specific_force_std_m_s2 and angle_std_deg, or the \
                        first two";
            t.source.fault(Some(t.span.clone()), "[sensors]", "", what, "position_std_m = ...");
            return None;
        }
    };
    if (measured == Measured::Angle) != file.has("pivot") {
        let what = "an angle is that of a body on a pivot, whose angle alone is measured";
        t.source.fault(Some(t.span.clone()), "[sensors]", "", what, "angle_std_deg together with [pivot]");
    }
    into.altimeter = t.has("height") && t.choice("height") == Some(1);
    if into.altimeter && !matches!(measured, Measured::Position | Measured::PositionAndForce) {
        t.source.fault(t.at("height"), t.full("height"), "", "is of measured positions", "remove it");
    }
    let sensors = Sensors {
        position_std_m: t.number_if("position_std_m").unwrap_or(0.0),
        specific_force_std_m_s2: t.number_if("specific_force_std_m_s2").unwrap_or(0.0),
        angle_std_rad: t.number_if("angle_std_deg").unwrap_or(0.0).to_radians(),
        ..Sensors::default()
    };
    Some((sensors, measured, exact))
}

/// Drag over Mach number needs the speed of sound; a pivot none of it.
pub(crate) fn fits(file: &Table<'_>, point: &PointMass) {
    if point.drag_over_mach.is_some() && point.atmosphere.is_none() {
        let what = "is a table over Mach number, and the air has no speed of sound";
        file.source.fault(None, "[aero.point_mass] CD", "", what, "[environment] atmosphere = \"us-1976\" and launch_height_m");
    }
    if point.pivot.is_some() && (point.atmosphere.is_some() || point.drag_over_mach.is_some()) {
        let what = "holds a body whose height hardly changes";
        file.source.fault(None, "[pivot]", "", what, "air_density_kg_m3 and CD as numbers");
    }
}

/// A prior of the drag as an uncertain constant, by which the closing of bodies without attitude knows it.
pub(crate) fn prior_of_drag(declared: &mut [bool], plant: &Plant, knowledge: &mut Knowledge) {
    for (i, std) in std::mem::take(&mut knowledge.priors) {
        if !declared[i] {
            continue;
        }
        declared[i] = false;
        let scale = plant.aero.structure.parameters[i] == "CD_scale";
        knowledge.constants.push(Constant {
            key: if scale { "aero.point_mass.CD_scale" } else { "aero.point_mass.CD" },
            component: "",
            unit: "-",
            lens: |p| p.aero.values.first_mut(),
            std,
        });
    }
}

/// What a `[[run]]` has otherwise than the campaign.
#[derive(Clone, Debug, Default)]
pub(crate) struct RunOwn {
    /// Keys of the plant's numbers, and their values here.
    pub(crate) numbers: Vec<(&'static str, f64)>,
    pub(crate) drag: Option<CoefficientTable>,
    pub(crate) recording: Option<String>,
}

/// Reads `vehicle`, `environment`, `aero` and `recording` of a `[[run]]`; `tracked`: of a body in free flight or on a pivot.
pub(crate) fn run_own(t: &Table<'_>, tracked: bool) -> RunOwn {
    let mut own = RunOwn::default();
    if !tracked {
        for key in ["vehicle", "environment", "aero", "recording"].into_iter().filter(|k| t.has(k)) {
            t.source.fault(t.at(key), t.full(key), "", "is for bodies without attitude", "remove it; [vehicle] is of all runs");
        }
        return own;
    }
    for (name, spec) in [("vehicle", &keys::RUN_VEHICLE), ("environment", &keys::RUN_ENVIRONMENT)] {
        let Some(inner) = t.has(name).then(|| t.table_named(name, spec)).flatten() else { continue };
        for key in spec.keys {
            let number = PLANT_NUMBERS.iter().find(|n| n.key.split_once('.') == Some((name, key.name)));
            if let (Some(n), Some(value)) = (number, inner.number_if(key.name)) {
                own.numbers.push((n.key, value));
            }
        }
    }
    if let Some(aero) = t.table_if(&keys::RUN_AERO)
        && let Some(at) = aero.value("CD")
    {
        own.drag = table_of(t.source, &aero.full("CD"), at);
    }
    own.recording = t.text_if("recording");
    own
}

impl RunOwn {
    /// Differences from the campaign's numbers, by their place in the table of the plant's numbers.
    pub(crate) fn departures(&self, plant: &Plant) -> Vec<(usize, f64)> {
        let place = |key: &str| PLANT_NUMBERS.iter().position(|n| n.key == key);
        let given = |key: &str| self.numbers.iter().find(|(k, _)| *k == key).map(|(_, v)| *v);
        let mut values = self.numbers.clone();
        let (height, density) = ("environment.launch_height_m", "environment.air_density_kg_m3");
        if let (Some(h), None, Some(atmosphere)) = (given(height), given(density), &plant.point.atmosphere) {
            let ratio = atmosphere.at(h).density_kg_m3() / atmosphere.at(plant.point.launch_height_m).density_kg_m3();
            values.push((density, plant.point.air_density_kg_m3 * ratio));
        }
        let mut campaigns = plant.clone();
        let departure = |(key, value): (&'static str, f64)| {
            let i = place(key)?;
            let x = (PLANT_NUMBERS[i].lens)(&mut campaigns).map(|x| *x)?;
            Some((i, value - x))
        };
        values.into_iter().filter_map(departure).collect()
    }
}

/// An input of a run: a number for all of it, or a column of its file.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum InputSource {
    Constant(f64),
    Column { name: String, zero: f64, one: f64 },
}

/// Reads one input; `None` with a fault. Columns are for bodies without attitude.
pub(crate) fn input(t: &Table<'_>, name: &str, at: Value<'_>, point: bool) -> Option<InputSource> {
    let path = format!("{}.{name}", t.full("inputs"));
    if let Some(x) = number(at).filter(|x| x.is_finite()) {
        return Some(InputSource::Constant(x));
    }
    if point && let Some(column) = at.get_ref().as_str() {
        return Some(InputSource::Column { name: column.to_owned(), zero: 0.0, one: 1.0 });
    }
    if point && let Some(table) = at.get_ref().as_table() {
        let inner = Table::new(t.source, &path, table, at.span(), &keys::INPUT);
        let (zero, one) = (inner.number_if("zero").unwrap_or(0.0), inner.number_if("one").unwrap_or(1.0));
        if zero.total_cmp(&one).is_eq() {
            t.source.fault(inner.at("one"), inner.full("one"), one.to_string(), "must differ from `zero`", "another value");
        }
        return Some(InputSource::Column { name: inner.text("column"), zero, one });
    }
    let allowed =
        if point { "must be a finite number, the name of a column, or { column, zero, one }" } else { "must be a finite number" };
    t.source.fault(Some(at.span()), path, t.source.snippet(at.span()), allowed, "a number");
    None
}
