//! scenarios: `[[wind_tunnel]]`, static coefficients that identified curves are held against. In: the tables and their files. Out: points.

use crate::columns::{Columns, fault};
use crate::error::{Fault, ReadError};
use crate::formats::{read_columns, stem};
use crate::plant::Declared;
use crate::table::Table;
use crate::{keys, limits};
use std::path::Path;
use windfall_model::{Coefficient, StaticPoint, StaticPoints};

/// Column of the angle.
const ANGLE: &str = "alpha_T_deg";
/// Columns of coefficients, each with that of its standard uncertainty.
const COEFFICIENTS: [(Coefficient, &str, &str); 3] =
    [(Coefficient::CA, "CA", "CA_std"), (Coefficient::CN, "CN", "CN_std"), (Coefficient::Cm, "Cm", "Cm_std")];
/// Largest size of a coefficient.
const LARGEST: f64 = 1e6;

/// All tests of a campaign file.
pub(crate) fn tests(file: &Table<'_>, declared: &Declared) -> Vec<StaticPoints> {
    if !file.has("wind_tunnel") {
        return Vec::new();
    }
    let all = file.tables(&keys::WIND_TUNNEL);
    if let Some(t) = all.first().filter(|_| declared.point_mass || declared.plant.free_flight.is_some()) {
        let what = "has coefficients over the total angle of attack, which is for tunnel runs with attitude";
        t.source.fault(Some(t.span.clone()), "[[wind_tunnel]]", "", what, "remove the table");
        return Vec::new();
    }
    limits::of_file(file.source, "wind_tunnel", all.len(), 0.0);
    all.iter().flat_map(|t| test(t, declared.plant.vehicle.diameter_m)).collect()
}

fn test(t: &Table<'_>, diameter_m: f64) -> Vec<StaticPoints> {
    let word = t.text("file");
    let (name, reference_m) = (t.text_if("name"), t.number_if("moment_reference_m").unwrap_or(0.0));
    let path = limits::beside(t.source, t.at("file"), &t.full("file"), &word);
    if t.source.has_faults() {
        return Vec::new();
    }
    let columns = match read_columns(&path).and_then(|c| c.complain(|_| true).map(|()| c)) {
        Ok(columns) => columns,
        Err(ReadError::Faults(faults)) => {
            t.source.add(&faults);
            return Vec::new();
        }
        Err(e) => {
            t.source.fault(t.at("file"), t.full("file"), word, e.to_string(), "a path beside the campaign file");
            return Vec::new();
        }
    };
    let faults = faults(&path, &columns);
    if !faults.is_empty() {
        t.source.add(&faults);
        return Vec::new();
    }
    let name = name.unwrap_or_else(|| stem(&path).unwrap_or_else(|| word.clone()));
    let mut all = points(&name, &columns);
    if reference_m.abs() > 0.0
        && let Some(k) = all.iter().position(|s| s.coefficient == Coefficient::Cm)
    {
        let normal = all.iter().find(|s| s.coefficient == Coefficient::CN);
        match normal.and_then(|n| all[k].about_origin(n, reference_m / diameter_m)) {
            Some(moment) => all[k] = moment,
            None => {
                let what = "takes Cm to the geometric origin by CN, which the file has not at all of its angles";
                let remedy = "a column CN, or Cm about the origin without this key";
                t.source.fault(t.at("moment_reference_m"), t.full("moment_reference_m"), reference_m.to_string(), what, remedy);
            }
        }
    }
    all
}

fn points(test: &str, columns: &Columns) -> Vec<StaticPoints> {
    let Some(angles) = columns.get(ANGLE) else { return Vec::new() };
    let one = |(coefficient, name, std_name): &(Coefficient, &str, &str)| {
        let (values, std) = (columns.get(name)?, columns.get(std_name));
        let point = |(i, value): (usize, &f64)| {
            value.is_finite().then(|| StaticPoint { alpha_t_rad: angles[i].to_radians(), value: *value, std: std.map(|s| s[i]) })
        };
        let points: Vec<StaticPoint> = values.iter().enumerate().filter_map(point).collect();
        (!points.is_empty()).then(|| StaticPoints { test: test.to_owned(), coefficient: *coefficient, points })
    };
    COEFFICIENTS.iter().filter_map(one).collect()
}

fn faults(path: &Path, columns: &Columns) -> Vec<Fault> {
    let known: Vec<&str> = COEFFICIENTS.iter().flat_map(|(_, name, std)| [*name, *std]).collect();
    let list = format!("{ANGLE}, {}", known.join(", "));
    let mut faults = Vec::new();
    let mut say = |line: Option<usize>, key: &str, value: String, what: &str, remedy: &str| {
        faults.push(fault(path, line, key, &value, what, remedy));
    };
    for name in columns.names().iter().filter(|n| n.as_str() != ANGLE && !known.contains(&n.as_str())) {
        say(columns.header, "column", name.clone(), "is not known here", &list);
    }
    let Some(angles) = columns.get(ANGLE) else {
        say(columns.header, ANGLE, String::new(), "column is missing", &list);
        return faults;
    };
    for (i, a) in angles.iter().enumerate() {
        if !(0.0..=180.0).contains(a) {
            say(Some(columns.lines[i]), ANGLE, a.to_string(), "must be from 0 to 180", "the total angle of attack, deg");
        } else if i > 0 && *a <= angles[i - 1] {
            say(
                Some(columns.lines[i]),
                ANGLE,
                a.to_string(),
                "must be above that of the row before",
                "one row per angle, ascending",
            );
        }
    }
    for (_, name, std_name) in &COEFFICIENTS {
        let (values, std) = (columns.get(name), columns.get(std_name));
        if std.is_some() && values.is_none() {
            say(columns.header, std_name, String::new(), "is the uncertainty of a column that is missing", name);
        }
        for (i, x) in values.into_iter().flatten().enumerate().filter(|(_, x)| x.abs() > LARGEST) {
            say(Some(columns.lines[i]), name, x.to_string(), "must be from -1e6 to 1e6", "a dimensionless coefficient");
        }
        for (i, (s, x)) in std.into_iter().flatten().zip(values.into_iter().flatten()).enumerate() {
            if x.is_finite() && !(0.0..LARGEST).contains(s) {
                say(Some(columns.lines[i]), std_name, s.to_string(), "must be zero or more", "a standard uncertainty (1 sigma)");
            }
        }
    }
    let measured = |name: &&str| columns.get(name).is_some_and(|c| c.iter().any(|x| x.is_finite()));
    if !COEFFICIENTS.iter().map(|(_, name, _)| name).any(measured) {
        say(columns.header, "columns", String::new(), "have no coefficient", &list);
    }
    faults
}
