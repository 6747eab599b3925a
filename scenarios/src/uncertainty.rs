//! scenarios: `[uncertainty.*]`, standard uncertainties of declared numbers. In: open tables and the plant. Out: uncertain constants, in
//! SI and rad, and priors of aerodynamic parameters.

use crate::keys::{self, Kind, TableSpec};
use crate::table::{Table, allowed_range, number};
use windfall_model::{Constant, Knowledge, PLANT_NUMBERS, Plant, PlantNumber};

/// Reads the uncertainties of a campaign or scenario file. Zero is exact: no constant is made of it.
pub(crate) fn read_uncertainty(file: &Table<'_>, plant: &Plant, point_mass: bool, into: &mut Knowledge) {
    let Some(outer) = file.table_if(&keys::UNCERTAINTY) else { return };
    let specs: &[(&str, &'static TableSpec)] = if plant.free_flight.is_some() {
        &[
            ("vehicle", &keys::UNCERTAINTY_VEHICLE),
            ("free_flight", &keys::UNCERTAINTY_FREE_FLIGHT),
            ("environment", &keys::UNCERTAINTY_ENVIRONMENT_POINT),
            ("sensors", &keys::UNCERTAINTY_SENSORS_FREE),
        ]
    } else if point_mass {
        &[
            ("vehicle", &keys::UNCERTAINTY_VEHICLE_POINT),
            ("pivot", &keys::UNCERTAINTY_PIVOT),
            ("tether", &keys::UNCERTAINTY_TETHER),
            ("environment", &keys::UNCERTAINTY_ENVIRONMENT_POINT),
            ("sensors", &keys::UNCERTAINTY_SENSORS_POINT),
        ]
    } else {
        &[
            ("vehicle", &keys::UNCERTAINTY_VEHICLE),
            ("tether", &keys::UNCERTAINTY_TETHER),
            ("environment", &keys::UNCERTAINTY_ENVIRONMENT),
            ("sensors", &keys::UNCERTAINTY_SENSORS),
        ]
    };
    for &(name, spec) in specs {
        let Some(t) = outer.has(name).then(|| outer.table_named(name, spec)).flatten() else { continue };
        if name == "tether" && plant.tether.is_none() {
            let what = "is about a tether, and the file declares none";
            t.source.fault(Some(t.span.clone()), "[uncertainty.tether]", "", what, "add [tether], or remove this table");
            continue;
        }
        if name == "pivot" && plant.point.pivot.is_none() {
            let what = "is about a pivot, and the file declares none";
            t.source.fault(Some(t.span.clone()), "[uncertainty.pivot]", "", what, "add [pivot], or remove this table");
            continue;
        }
        table(&t, name, spec, &mut into.constants);
    }
    if outer.has("free_flight") && plant.free_flight.is_none() {
        let what = "is about a rigid body in free flight, and the file declares none";
        outer.source.fault(
            outer.at("free_flight"),
            "[uncertainty.free_flight]",
            "",
            what,
            "add [free_flight], or remove this table",
        );
    }
    if outer.has("aero") {
        aero(&outer, plant, into);
    }
}

fn table(t: &Table<'_>, path: &str, spec: &'static TableSpec, into: &mut Vec<Constant>) {
    for key in spec.keys.iter().filter(|k| t.has(k.name)) {
        let full = format!("{path}.{}", key.name);
        if key.kind == Kind::Table {
            if let Some(inner) = t.table_named(key.name, &keys::UNCERTAINTY_INERTIA) {
                table(&inner, &full, &keys::UNCERTAINTY_INERTIA, into);
            }
            continue;
        }
        let list = t.value(key.name).is_some_and(|v| v.get_ref().as_array().is_some());
        let stds = if list || key.kind != Kind::Number { t.numbers::<3>(key.name) } else { [t.number(key.name); 3] };
        let numbers = PLANT_NUMBERS.iter().filter(|n| n.key == full);
        into.extend(numbers.zip(stds).filter(|(_, std)| *std > 0.0).map(|(n, std)| constant(n, std)));
    }
}

fn constant(n: &PlantNumber, std: f64) -> Constant {
    Constant { key: n.key, component: n.component, unit: n.unit, lens: n.lens, std: n.inside(std) }
}

/// `[uncertainty.aero.<name>]`: how far each parameter may be from its starting value.
fn aero(outer: &Table<'_>, plant: &Plant, into: &mut Knowledge) {
    let structure = &plant.aero.structure;
    let Some(models) = outer.table_named("aero", &keys::UNCERTAINTY_AERO) else { return };
    for (name, body) in models.entries() {
        if name.get_ref().as_ref() != structure.name {
            models.unknown(name, body, &[structure.name.as_str()]);
            continue;
        }
        let Some(table) = body.get_ref().as_table() else {
            let what = "must be a table of parameter = standard uncertainty";
            models.source.fault(Some(body.span()), models.full(name.get_ref()), "", what, "a table");
            continue;
        };
        let t = Table::new(
            models.source,
            &format!("uncertainty.aero.{}", structure.name),
            table,
            body.span(),
            &keys::UNCERTAINTY_AERO,
        );
        for (key, value) in t.entries() {
            let Some(i) = structure.index(key.get_ref()) else {
                t.unknown(key, value, &structure.parameters.iter().map(String::as_str).collect::<Vec<_>>());
                continue;
            };
            match number(value).filter(|x| x.is_finite() && *x > 0.0) {
                Some(std) => into.priors.push((i, std)),
                None => {
                    let what = format!("{}, above zero", allowed_range([0.0, 1e9], "-"));
                    let remedy = "a standard uncertainty; what is known exactly is held by identify --hold";
                    t.source.fault(Some(value.span()), t.full(key.get_ref()), t.source.snippet(value.span()), what, remedy);
                }
            }
        }
    }
}
