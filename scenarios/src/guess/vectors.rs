//! scenarios: columns that are parts of a position, a quaternion, three angles, a specific force. In: a sheet. Out: which they are, by the
//! words and units of their names and by their size, and those that look like it and are not.

use super::name::{Name, Said};
use super::sheet::{Column, Found, Refused, Sheet, extent, median, span};
use crate::column_unit::{ColumnUnit, UnitQuantity as Q};

/// A part of something: whose it is (words before), which part, and the column's place in the sheet.
struct Part {
    owner: Vec<String>,
    part: usize,
    at: usize,
    unit: Option<Said>,
    /// Which way the part points where its name says it: a height is up.
    up: Option<bool>,
}

/// Words of a name that say that it is no position, angle or quaternion of the body, but a rate, an error, a set point.
const NOT: [&str; 32] = [
    "rate",
    "rates",
    "vel",
    "velocity",
    "v",
    "speed",
    "acc",
    "accel",
    "acceleration",
    "a",
    "mag",
    "gyro",
    "omega",
    "std",
    "sigma",
    "error",
    "err",
    "target",
    "sp",
    "setpoint",
    "ref",
    "cmd",
    "command",
    "force",
    "f",
    "wind",
    "encoder",
    "count",
    "imu",
    "dot",
    "residual",
    "ned",
];
const POSITIONS: [&str; 10] = ["pos", "position", "p", "translation", "trans", "loc", "location", "origin", "t", "xyz"];
const QUATERNIONS: [&str; 8] = ["q", "quat", "quaternion", "orientation", "rotation", "rot", "attitude", "att"];
const TURNS: [&str; 8] = ["r", "rot", "rotation", "euler", "angle", "ang", "attitude", "att"];
const FORCES: [&str; 8] = ["f", "a", "acc", "accel", "accelerometer", "acceleration", "accl", "imu"];
const AXES: [&str; 3] = ["x", "y", "z"];

/// The last word as one of `parts`, alone behind a word of `kinds` or fused with one (`px`, `qw`); the words before both.
fn fused<'n>(words: &'n [String], kinds: &[&str], parts: &[&str]) -> Option<(&'n [String], usize, bool)> {
    let (last, before) = words.split_last()?;
    if let Some(part) = parts.iter().position(|p| last == p) {
        return Some(match before.split_last() {
            Some((kind, owner)) if kinds.contains(&kind.as_str()) => (owner, part, true),
            _ => (before, part, false),
        });
    }
    let (part, kind) = parts.iter().enumerate().find_map(|(i, p)| Some((i, last.strip_suffix(p)?)))?;
    kinds.contains(&kind).then_some((before, part, true))
}

/// A part of a position: x, y, z, or north, east, down, up, height.
fn of_position(name: &Name) -> Option<(Vec<String>, usize, Option<bool>)> {
    const PLACES: [(&str, usize, Option<bool>); 7] = [
        ("north", 0, None),
        ("east", 1, None),
        ("down", 2, Some(false)),
        ("up", 2, Some(true)),
        ("height", 2, Some(true)),
        ("altitude", 2, Some(true)),
        ("alt", 2, Some(true)),
    ];
    let mut words = name.words.clone();
    // `x pos` is `pos x`.
    if words.len() > 1 && POSITIONS[..2].contains(&words[words.len() - 1].as_str()) {
        let n = words.len();
        words.swap(n - 1, n - 2);
    }
    let last = words.last()?;
    if let Some((_, part, up)) = PLACES.iter().find(|(w, ..)| w == last) {
        let before = &words[..words.len() - 1];
        let owner = before.split_last().filter(|(k, _)| POSITIONS.contains(&k.as_str())).map_or(before, |(_, o)| o);
        return Some((owner.to_vec(), *part, *up));
    }
    let (owner, part, kind) = fused(&words, &POSITIONS, &AXES)?;
    let turned = |w: &String| [&QUATERNIONS[..], &TURNS[..]].concat().contains(&w.as_str());
    (kind || !owner.last().is_some_and(turned)).then(|| (owner.to_vec(), part, None))
}

fn is_of_body(owner: &[String]) -> bool {
    !owner.iter().any(|w| NOT.contains(&w.as_str()))
}

/// Parts by owner, in the order of the file; each part of an owner once.
fn owners(parts: Vec<Part>) -> Vec<Vec<Part>> {
    let mut all: Vec<Vec<Part>> = Vec::new();
    for p in parts {
        match all.iter_mut().find(|g| g[0].owner == p.owner) {
            Some(group) if group.iter().all(|o| o.part != p.part) => group.push(p),
            Some(_) => {}
            None => all.push(vec![p]),
        }
    }
    all
}

/// The owner with most parts; of equals one without a marker in its name, then one without a name, then the first.
fn chosen(mut all: Vec<Vec<Part>>) -> Option<(Vec<Part>, Vec<Part>)> {
    let marker = |g: &[Part]| g[0].owner.iter().any(|w| w.starts_with("marker"));
    let rank = |g: &Vec<Part>| (marker(g), 3 - g.len().min(3), usize::from(!g[0].owner.is_empty()));
    let best = (0..all.len()).min_by_key(|i| (rank(&all[*i]), *i))?;
    let mut group = all.remove(best);
    group.sort_by_key(|p| p.part);
    Some((group, all.into_iter().flatten().collect()))
}

/// What a unit says of a part that must be of a quantity, or have none (`None`).
fn contradiction(unit: Option<&Said>, quantity: Option<Q>, what: &str) -> Option<String> {
    match unit {
        Some(Said::Known(q, _)) if Some(*q) == quantity => None,
        Some(Said::Known(_, word)) => Some(format!("{word} is no unit of {what}")),
        Some(Said::Other(word)) => Some(format!("{word} is no unit of {what}")),
        None => None,
    }
}

/// All parts of one kind, and those whose unit contradicts it.
fn parts(
    sheet: &Sheet<'_>,
    quantity: Option<Q>,
    what: &str,
    read: impl Fn(&Name) -> Option<(Vec<String>, usize, Option<bool>)>,
) -> (Vec<Part>, Vec<Refused>) {
    let (mut all, mut refused) = (Vec::new(), Vec::new());
    for (at, c) in sheet.columns.iter().enumerate() {
        for name in &c.readings {
            let Some((owner, part, up)) = read(name).filter(|(owner, ..)| is_of_body(owner)) else { continue };
            match contradiction(name.unit.as_ref(), quantity, what) {
                None => {
                    all.push(Part { owner, part, at, unit: name.unit.clone(), up });
                    break;
                }
                Some(why) => refused.push(Refused { name: c.name.to_owned(), why }),
            }
        }
    }
    (all, refused)
}

fn others(sheet: &Sheet<'_>, rest: &[Part], what: &str, read: &str) -> Vec<Refused> {
    let one =
        |p: &Part| Refused { name: sheet.columns[p.at].name.to_owned(), why: format!("another {what}; read is that of {read}") };
    rest.iter().map(one).collect()
}

/// Where the body is.
pub(super) struct Position {
    pub(super) found: Vec<Found>,
    /// `[axes] down` where a name says it.
    pub(super) down: Option<String>,
}

/// Largest size of a place that is read, m; a body without attitude may be as high as air reaches.
const FARTHEST_M: f64 = 1e6;
/// Largest span of a position without a unit that is still in m: wider than any tunnel or hall.
const WIDEST_M: f64 = 20.0;

/// Columns of the position.
pub(super) fn position(sheet: &Sheet<'_>) -> (Option<Position>, Vec<Refused>) {
    let (all, mut refused) = parts(sheet, Some(Q::Length), "a position", of_position);
    let Some((group, rest)) = chosen(owners(all)) else { return (None, refused) };
    let values = |p: &Part| sheet.columns[p.at].values;
    let wide = group.iter().map(|p| span(values(p))).fold(0.0, f64::max);
    let size = if wide > WIDEST_M { "mm" } else { "m" };
    // East, north, up are right-handed in that order, north, east, down in theirs.
    let turned = group.iter().any(|p| p.up == Some(true)) && group.iter().any(|p| named(sheet, p, "east"));
    let ours = ["X_m", "Y_m", "Z_m"];
    let mut down = None;
    let mut found = Vec::new();
    for p in &group {
        let name = sheet.columns[p.at].name;
        let part = if turned && p.part < 2 { 1 - p.part } else { p.part };
        let (unit, why) = match &p.unit {
            Some(Said::Known(_, word)) => (*word, "unit as the file says".to_owned()),
            _ => (size, format!("GUESS: the widest axis spans {wide:.4}")),
        };
        let level = ColumnUnit::of(Q::Length, unit).map_or(f64::NAN, |u| u.ours(median(values(p))));
        if level.abs() > FARTHEST_M || !level.is_finite() {
            let why = format!("a median of {level:.4e} m is no position");
            refused.push(Refused { name: name.to_owned(), why });
            continue;
        }
        down = down.or(p.up.map(|up| format!("{}{}", if up { "-" } else { "+" }, ["X", "Y", "Z"][part])));
        found.push(Found { ours: ours[part], name: name.to_owned(), unit: unit.to_owned(), why });
    }
    found.sort_by_key(|f| f.ours);
    let Some(first) = found.first() else { return (None, refused) };
    refused.extend(others(sheet, &rest, "position", &first.name));
    (Some(Position { down, found }), refused)
}

fn named(sheet: &Sheet<'_>, p: &Part, word: &str) -> bool {
    sheet.columns[p.at].readings.iter().any(|n| n.words.iter().any(|w| w == word))
}

/// Four columns, and where the real part stands.
pub(super) struct Quaternion {
    pub(super) names: [String; 4],
    pub(super) last: bool,
    /// Whether the names say which is the real part: w does, 1 to 4 do not.
    pub(super) told: bool,
}

/// Largest difference of a quaternion's length from one, and share of the rows that may be off: those of the reader.
const LENGTH: (f64, f64) = (0.01, 0.05);

/// Columns of the quaternion.
pub(super) fn quaternion(sheet: &Sheet<'_>) -> (Option<Quaternion>, Vec<Refused>) {
    let mut refused = Vec::new();
    // Real part first where the names are numbered from 0, last where from 1, as their programs have it.
    let sets: [(&[&str], bool, bool); 4] = [
        (&["x", "y", "z", "w"], true, true),
        (&["x", "y", "z", "s"], true, true),
        (&["0", "1", "2", "3"], false, false),
        (&["1", "2", "3", "4"], true, false),
    ];
    for (set, last, told) in sets {
        let read = |n: &Name| {
            let (owner, part, kind) = fused(&n.words, &QUATERNIONS, set)?;
            kind.then(|| (owner.to_vec(), part, None))
        };
        let (all, not) = parts(sheet, None, "a quaternion", read);
        refused.extend(not);
        let mut groups = owners(all);
        groups.retain(|g| g.len() == 4);
        let Some((group, rest)) = chosen(groups) else { continue };
        let of = |k: usize| &sheet.columns[group[k].at];
        let rows = of(0).values.len();
        let length = |i: usize| (0..4).map(|k| of(k).values[i].powi(2)).sum::<f64>().sqrt();
        let lengths: Vec<f64> = (0..rows).map(length).filter(|l| l.is_finite() && *l > 0.0).collect();
        let off = lengths.iter().filter(|l| (*l - 1.0).abs() > LENGTH.0).count();
        let names = [0, 1, 2, 3].map(|k| of(k).name.to_owned());
        if lengths.is_empty() || off as f64 > LENGTH.1 * lengths.len() as f64 {
            let why = format!("{off} of {} rows are no quaternion of length one", lengths.len());
            refused.extend(names.map(|name| Refused { name, why: why.clone() }));
            continue;
        }
        refused.extend(others(sheet, &rest, "quaternion", &names[0]));
        return (Some(Quaternion { names, last, told }), refused);
    }
    (None, refused)
}

/// Three angles, in the order of their sequence.
pub(super) struct Euler {
    pub(super) names: [String; 3],
    pub(super) sequence: &'static str,
    pub(super) unit: &'static str,
    pub(super) why: String,
}

/// Half a turn and its rounding, rad: no second angle of a sequence is larger.
const HALF_TURN_RAD: f64 = 3.2;

/// Columns of three angles: about x, y, z, or roll, pitch, yaw.
pub(super) fn euler(sheet: &Sheet<'_>) -> (Option<Euler>, Vec<Refused>) {
    const NAMES: [(&[&str], &str); 3] =
        [(&["roll", "pitch", "yaw"], "zyx"), (&["phi", "theta", "psi"], "zyx"), (&["roll", "pitch", "heading"], "zyx")];
    let mut refused = Vec::new();
    let about = |n: &Name| {
        let (owner, part, kind) = fused(&n.words, &TURNS, &AXES)?;
        kind.then(|| (owner.to_vec(), part, None))
    };
    let (all, not) = parts(sheet, Some(Q::Angle), "an angle", about);
    refused.extend(not);
    let mut tried = vec![(all, "xyz")];
    for (set, sequence) in NAMES {
        let read = |n: &Name| {
            let (last, before) = n.words.split_last()?;
            let owner = before.split_last().filter(|(k, _)| TURNS.contains(&k.as_str())).map_or(before, |(_, o)| o);
            Some((owner.to_vec(), set.iter().position(|s| s == last)?, None))
        };
        let (all, not) = parts(sheet, Some(Q::Angle), "an angle", read);
        refused.extend(not);
        tried.push((all, sequence));
    }
    for (all, sequence) in tried {
        let mut groups = owners(all);
        groups.retain(|g| g.len() == 3);
        let Some((group, rest)) = chosen(groups) else { continue };
        let of = |k: usize| &sheet.columns[group[k].at];
        let (unit, why) = angle_unit(&group, [of(0), of(1), of(2)]);
        // Qualisys' roll, pitch and yaw are about x, y and z in that order, unless its settings were changed.
        let sequence = if sheet.program == Some("Qualisys") { "xyz" } else { sequence };
        let mut names = [0, 1, 2].map(|k| of(k).name.to_owned());
        if sequence == "zyx" {
            names.reverse();
        }
        refused.extend(others(sheet, &rest, "attitude", &names[0]));
        return (Some(Euler { names, sequence, unit, why }), refused);
    }
    (None, refused)
}

fn angle_unit(group: &[Part], columns: [&Column<'_>; 3]) -> (&'static str, String) {
    let most = columns.iter().map(|c| span(c.values)).fold(0.0, f64::max);
    let [low, high] = extent(columns[1].values);
    let second = low.abs().max(high.abs());
    match &group[0].unit {
        Some(Said::Known(_, "rad")) if second > HALF_TURN_RAD => {
            ("deg", format!("GUESS: the file says rad, and {} reaches {second:.1}, more than half a turn", columns[1].name))
        }
        Some(Said::Known(_, word)) => (word, "unit as the file says".to_owned()),
        _ if most > 7.0 => ("deg", format!("GUESS: an angle spans {most:.3}")),
        _ => ("rad", format!("GUESS: no angle spans more than {most:.3}")),
    }
}

/// Largest median of a specific force, m/s2: that of the reader.
const HARDEST_M_S2: f64 = 1e4;

/// Columns of a specific force.
pub(super) fn specific_force(sheet: &Sheet<'_>) -> (Vec<Found>, Vec<Refused>) {
    let read = |n: &Name| {
        let (owner, part, kind) = fused(&n.words, &FORCES, &AXES)?;
        kind.then(|| (owner.to_vec(), part, None))
    };
    let (all, mut refused) = parts(sheet, Some(Q::Acceleration), "a specific force", read);
    let Some((group, _)) = chosen(owners(all)) else { return (Vec::new(), refused) };
    let mut found = Vec::new();
    for p in &group {
        let c = &sheet.columns[p.at];
        let (unit, why) = match &p.unit {
            Some(Said::Known(_, word)) => (*word, "unit as the file says".to_owned()),
            _ => ("m/s2", "GUESS: the file does not say the unit; g where it is about one at rest".to_owned()),
        };
        let level = ColumnUnit::of(Q::Acceleration, unit).map_or(f64::NAN, |u| u.ours(median(c.values)));
        if level.abs() <= HARDEST_M_S2 {
            found.push(Found {
                ours: ["fX_m_s2", "fY_m_s2", "fZ_m_s2"][p.part],
                name: c.name.to_owned(),
                unit: unit.to_owned(),
                why,
            });
        } else {
            refused.push(Refused { name: c.name.to_owned(), why: format!("a median of {level:.4e} m/s2 is no specific force") });
        }
    }
    (found, refused)
}

/// The angle of a body on a pivot.
pub(super) fn pivot_angle(sheet: &Sheet<'_>) -> Option<Found> {
    let is = |w: &String| ["angle", "theta", "swing", "phi", "pivot", "arm", "encoder"].contains(&w.as_str());
    let one = |c: &Column<'_>| {
        let name = c.readings.iter().find(|n| n.words.iter().all(is))?;
        let (unit, why) = match &name.unit {
            Some(Said::Known(Q::Angle, word)) => (*word, "unit as the file says".to_owned()),
            Some(_) => return None,
            None if span(c.values) > 7.0 => ("deg", format!("GUESS: it spans {:.3}", span(c.values))),
            None => ("rad", format!("GUESS: it spans {:.3}", span(c.values))),
        };
        Some(Found { ours: "angle_deg", name: c.name.to_owned(), unit: unit.to_owned(), why })
    };
    sheet.columns.iter().find_map(one)
}
