//! scenarios: the table `[columns]`. In: the table as it stands. Out: what it says, or faults by line.

use super::attitude::{Attitude, GivenAttitude, OwnAxes, SEQUENCES, determinant};
use super::{ANGLES, Origin, Own, POSITION};
use crate::column_unit::{ColumnUnit, UnitQuantity};
use crate::keys;
use crate::run_columns::{RUN_COLUMNS, RunColumn};
use crate::table::{Table, Value, number};

/// `[columns]` of a campaign or `[run.columns]` of a run; nothing when it is absent. `point`: files of a body without attitude.
pub(crate) fn read(parent: &Table<'_>, point: bool) -> Option<Own> {
    if !parent.has("columns") {
        return None;
    }
    parent.table(&keys::COLUMNS).map(|t| own(&t, point))
}

fn own(t: &Table<'_>, point: bool) -> Own {
    let mut own = Own::default();
    for column in &RUN_COLUMNS {
        if let Some(at) = t.has(column.name).then(|| t.value(column.name)).flatten()
            && let Some(origin) = origin(t, column, at)
        {
            own.origins.push((column.name, origin));
        }
    }
    taken_twice(t, &own);
    for key in ["axes", "attitude"].into_iter().filter(|k| point && t.has(k)) {
        let what = "a point mass has no attitude, and [axes] down says how its axes lie";
        t.source.fault(t.at(key), t.full(key), "", what, "remove it");
    }
    if t.has("axes") && !point {
        own.axes = axes(t).unwrap_or_default();
    }
    if t.has("attitude") && !point {
        own.attitude = t.table(&keys::COLUMNS_ATTITUDE).and_then(|a| attitude(&a));
        for ours in ANGLES.into_iter().filter(|n| t.has(n)) {
            t.source.fault(
                t.at(ours),
                t.full(ours),
                "",
                "stands beside [columns.attitude], which makes it",
                "remove one of them",
            );
        }
    }
    own
}

fn origin(t: &Table<'_>, column: &RunColumn, at: Value<'_>) -> Option<Origin> {
    let (ours, quantity) = (column.name, column.quantity);
    let say = |allowed: String, remedy: String| {
        t.source.fault(Some(at.span()), t.full(ours), t.source.snippet(at.span()), allowed, remedy);
        None
    };
    if let Some(name) = at.get_ref().as_str() {
        return Some(Origin::Columns { parts: vec![(name.to_owned(), 1.0)], unit: quantity.ours() });
    }
    if let Some(value) = number(at) {
        if !column.may_be_constant {
            let constant: Vec<&str> = RUN_COLUMNS.iter().filter(|c| c.may_be_constant).map(|c| c.name).collect();
            let what = format!("must be the name of a column; only {} may be one number", constant.join(", "));
            return say(what, format!("{ours} = \"name of the column\""));
        }
        if !value.is_finite() {
            return say("must be a finite number".to_owned(), format!("{ours} in {}", quantity.ours().word));
        }
        return Some(Origin::Constant(value));
    }
    if at.get_ref().as_table().is_none() {
        let what = "must be a name, a number or { name = ..., unit = ... }".to_owned();
        return say(what, format!("{ours} = {{ name = \"name\", unit = \"{}\" }}", quantity.ours().word));
    }
    let t = t.table_named(ours, &keys::COLUMN)?;
    let parts = if t.has("names") || t.has("along") {
        along(&t)?
    } else {
        vec![(t.text_if("name").unwrap_or_else(|| ours.to_owned()), 1.0)]
    };
    Some(Origin::Columns { parts, unit: unit(&t, quantity)? })
}

/// Three columns of a vector and the direction along which its component is taken, made of unit length.
fn along(t: &Table<'_>) -> Option<Vec<(String, f64)>> {
    foreign(t, &["name"], "names");
    let remedy = "names = [\"x\", \"y\", \"z\"], along = [0.0, 0.0, 1.0]";
    let there = needs(t, "names", "along", remedy);
    if !(needs(t, "along", "names", remedy) && there) {
        return None;
    }
    let names = names::<3>(t, "names")?;
    let direction = t.numbers::<3>("along");
    let length = direction.iter().map(|x| x * x).sum::<f64>().sqrt();
    if length < 1e-9 {
        t.source.fault(t.at("along"), t.full("along"), "", "must be a direction, not zero", remedy);
        return None;
    }
    Some(names.into_iter().zip(direction.map(|x| x / length)).collect())
}

fn unit(t: &Table<'_>, quantity: UnitQuantity) -> Option<ColumnUnit> {
    let Some(word) = t.text_if("unit") else { return Some(quantity.ours()) };
    let found = ColumnUnit::of(quantity, &word);
    if found.is_none() {
        let words = quantity.words();
        let all: Vec<&str> = words.split(", ").collect();
        let near = crate::table::nearest(&word, &all).unwrap_or("one of these, or values converted before");
        t.source.fault(t.at("unit"), t.full("unit"), word, format!("must be one of {words}"), near);
    }
    found
}

/// A column with one of our names that is read for another: what that other one is must be said.
fn taken_twice(t: &Table<'_>, own: &Own) {
    for (ours, origin) in &own.origins {
        for name in origin.names() {
            let free = RUN_COLUMNS.iter().any(|c| c.name == name) && own.origin(name).is_none() && name != *ours;
            if free {
                let what = format!("is the name of another column of the run file, and {name} itself is not said");
                t.source.fault(t.at(ours), t.full(ours), name, what, format!("{name} = \"its column\""));
            }
            if own.origins.iter().any(|(n, o)| n != ours && o == origin) && POSITION.contains(ours) {
                t.source.fault(t.at(ours), t.full(ours), name, "is read for two axes", "a column for each axis");
            }
        }
    }
}

fn axes(t: &Table<'_>) -> Option<OwnAxes> {
    let t = t.table(&keys::COLUMNS_AXES)?;
    let room = rows(&t, "tunnel");
    let body = rows(&t, "body");
    let axes = OwnAxes { room: room?, body: body? };
    if determinant(&axes.room) * determinant(&axes.body) < 0.0 {
        let what =
            "one of tunnel and body is right-handed and the other left-handed, so that no rotation leads from one to the other";
        t.source.fault(Some(t.span.clone()), "[columns.axes]", "", what, "turn the sign of one axis");
        return None;
    }
    Some(axes)
}

/// Three axes of the owner; the axes themselves when the key is absent.
fn rows(t: &Table<'_>, key: &str) -> Option<[[f64; 3]; 3]> {
    if !t.has(key) {
        return Some(OwnAxes::default().room);
    }
    let words = t.words(key);
    let rows: Vec<[f64; 3]> = words.iter().filter_map(|(w, _)| OwnAxes::row(w)).collect();
    let found: Option<[[f64; 3]; 3]> = rows.try_into().ok().filter(|r| words.len() == 3 && determinant(r).abs() > 0.5);
    if found.is_none() && !words.is_empty() {
        let value = words.iter().map(|(w, _)| w.as_str()).collect::<Vec<_>>().join(", ");
        let what = "must be three of x, y, z, -x, -y, -z, each letter once";
        t.source.fault(t.at(key), t.full(key), value, what, format!("{key} = [\"-z\", \"x\", \"-y\"]"));
    }
    found
}

fn attitude(t: &Table<'_>) -> Option<Attitude> {
    let to_body = t.choice("rotates").map(|i| i == 1);
    let given = match (t.has("quaternion"), t.has("euler")) {
        (true, false) => quaternion(t),
        (false, true) => euler(t),
        _ => {
            let what = "must have exactly one of quaternion and euler";
            let remedy = "quaternion = [\"qw\", \"qx\", \"qy\", \"qz\"] and scalar = \"first\", or euler and sequence";
            t.source.fault(Some(t.span.clone()), "[columns.attitude]", "", what, remedy);
            None
        }
    };
    Some(Attitude { given: given?, to_body: to_body? })
}

/// Names of exactly N columns.
fn names<const N: usize>(t: &Table<'_>, key: &str) -> Option<[String; N]> {
    let words: Vec<String> = t.words(key).into_iter().map(|(w, _)| w).collect();
    let found = <[String; N]>::try_from(words).ok().filter(|n| (1..N).all(|i| !n[..i].contains(&n[i])));
    if found.is_none() {
        t.source.fault(t.at(key), t.full(key), "", format!("must be the names of {N} different columns"), "one name for each");
    }
    found
}

fn foreign(t: &Table<'_>, keys: &[&str], beside: &str) {
    for key in keys.iter().filter(|k| t.has(k)) {
        t.source.fault(t.at(key), t.full(key), "", format!("has no part beside {beside}"), "remove it");
    }
}

/// A key that another one needs.
fn needs(t: &Table<'_>, key: &str, by: &str, remedy: &str) -> bool {
    if !t.has(key) {
        t.source.fault(Some(t.span.clone()), t.full(key), "", format!("is missing; {by} needs it"), remedy);
    }
    t.has(key)
}

fn quaternion(t: &Table<'_>) -> Option<GivenAttitude> {
    foreign(t, &["sequence", "unit"], "quaternion");
    let there = needs(t, "scalar", "quaternion", "scalar = \"first\" or \"last\": where the real part stands");
    let [a, b, c, d] = names::<4>(t, "quaternion")?;
    let last = t.choice("scalar").filter(|_| there)? == 1;
    misplaced(t, [&a, &b, &c, &d], last);
    Some(GivenAttitude::Quaternion(if last { [d, a, b, c] } else { [a, b, c, d] }))
}

/// Names that say which is the real part (they end in w) must agree with `scalar`.
fn misplaced(t: &Table<'_>, names: [&String; 4], last: bool) {
    let ends = |letter: char| names.iter().position(|n| n.to_lowercase().ends_with(letter));
    let (Some(w), Some(_), Some(_), Some(_)) = (ends('w'), ends('x'), ends('y'), ends('z')) else { return };
    if w != if last { 3 } else { 0 } {
        let what = format!("takes {} for the real part, which by its name is {}", names[if last { 3 } else { 0 }], names[w]);
        let remedy = "scalar = \"first\" where w is the first of the names, \"last\" where it is the last";
        t.source.fault(t.at("scalar"), t.full("scalar"), if last { "last" } else { "first" }, what, remedy);
    }
}

fn euler(t: &Table<'_>) -> Option<GivenAttitude> {
    foreign(t, &["scalar"], "euler");
    let there = needs(t, "sequence", "euler", "sequence = \"zyx\" for yaw, pitch, roll");
    let there = needs(t, "unit", "euler", "unit = \"deg\" or \"rad\"") && there;
    let angles = names::<3>(t, "euler")?;
    let sequence = SEQUENCES[t.choice("sequence").filter(|_| there)?];
    let mut axes = [0; 3];
    axes.iter_mut().zip(sequence.bytes()).for_each(|(a, letter)| *a = usize::from(letter - b'x'));
    Some(GivenAttitude::Euler { angles, axes, unit: unit(t, UnitQuantity::Angle)? })
}
