//! scenarios: exports of motion-capture programs. In: text of a Vicon (CSV), OptiTrack Motive (CSV) or Qualisys (TSV, 6DOF) export. Out:
//! columns with units, one row per frame, and a time in seconds; none for any other text.
//!
//! Vicon: a section name, the rate, a row of bodies, a row of components, a row of units, frames. Motive: one row of settings, rows of
//! types, names and parents, a row of kinds (rotation, position), a row of axes, frames. Qualisys: rows of settings, a row of components of
//! which the first of a body carries its name, frames.

use super::cell::number;
use crate::columns::{Columns, fault, some_of};
use crate::error::ReadError;
use std::path::Path;

/// One column of a body or marker.
struct Channel {
    place: usize,
    body: String,
    component: String,
    unit: &'static str,
    /// A marker beside the bodies.
    marker: bool,
}

/// What an export says before its frames.
struct Sheet {
    program: &'static str,
    channels: Vec<Channel>,
    /// Cell of the time, s; else of the frame with the frames a second and the cell of the part of a frame.
    clock: Clock,
    /// Rows of frames, by their place in the text.
    rows: std::ops::Range<usize>,
    header: usize,
    separator: u8,
    notes: Vec<String>,
    /// A body that was not seen has zeros.
    zeros: bool,
}

enum Clock {
    Time { cell: usize },
    Frame { cell: usize, part: Option<usize>, rate_hz: f64 },
    Row { rate_hz: f64 },
}

/// The columns of an export; none when the text is none.
pub(super) fn read(path: &Path, text: &str) -> Option<Result<Columns, ReadError>> {
    let lines: Vec<&str> = text.lines().collect();
    let first = lines.iter().position(|l| !l.trim().is_empty())?;
    let separator =
        [b'\t', b';', b','].into_iter().max_by_key(|c| lines[first..].iter().take(12).map(|l| count(l, *c)).sum::<usize>())?;
    let head = cells(lines[first], separator);
    let sheet = match head[0].as_str() {
        "Format Version" => motive(&lines, separator, first),
        "FILE_VERSION" | "NO_OF_FRAMES" => qualisys(&lines),
        "Objects" | "Segments" | "Trajectories" | "Joints" | "Model Outputs" | "Devices" => {
            let rate = cells(lines.get(first + 1)?, separator);
            rate[0].parse::<f64>().ok()?;
            vicon(&lines, separator)
        }
        _ => return None,
    };
    Some(
        sheet
            .and_then(|s| columns(&lines, s))
            .map_err(|(line, what, remedy)| ReadError::Faults(vec![fault(path, Some(line), "file", "", &what, remedy)])),
    )
}

/// Line, what is wrong, what to do.
type Wrong = (usize, String, &'static str);

fn count(line: &str, c: u8) -> usize {
    line.bytes().filter(|b| *b == c).count()
}

fn cells(line: &str, separator: u8) -> Vec<String> {
    line.split(char::from(separator)).map(|c| c.trim().trim_matches('"').to_owned()).collect()
}

fn cell(row: &[String], k: usize) -> &str {
    row.get(k).map_or("", String::as_str)
}

/// Length and angle by the name that a setting or a row of units has.
fn unit(word: &str) -> &'static str {
    match word.trim().to_ascii_lowercase().as_str() {
        "mm" | "millimeters" | "millimetres" => "mm",
        "cm" | "centimeters" | "centimetres" => "cm",
        "m" | "meters" | "metres" => "m",
        "in" | "inches" => "in",
        "ft" | "feet" => "ft",
        "deg" | "degrees" | "°" => "deg",
        "rad" | "radians" => "rad",
        _ => "",
    }
}

/// The section of bodies, or that of markers where there is no other.
fn vicon(lines: &[&str], separator: u8) -> Result<Sheet, Wrong> {
    let at = |name: &str| lines.iter().position(|l| cells(l, separator)[0] == name);
    let start = ["Objects", "Segments", "Trajectories"].into_iter().find_map(at).ok_or((
        1,
        "is a Vicon export without a section of Objects, Segments or Trajectories".to_owned(),
        "export the segments of the rigid body",
    ))?;
    let row = |k: usize| lines.get(start + k).map_or_else(Vec::new, |l| cells(l, separator));
    let (rate, bodies, names, units) = (row(1), row(2), row(3), row(4));
    let line = start + 1;
    let rate_hz: f64 = cell(&rate, 0).parse().ok().filter(|r: &f64| *r > 0.0).ok_or((
        line + 1,
        "has no frames a second below the section's name".to_owned(),
        "export it again",
    ))?;
    let frame = names.iter().position(|n| n == "Frame").ok_or((
        line + 3,
        "has no row Frame, Sub Frame, …".to_owned(),
        "export it with its header",
    ))?;
    let part = names.iter().position(|n| n == "Sub Frame");
    let mut body = String::new();
    let mut channels = Vec::new();
    for (place, name) in names.iter().enumerate() {
        if !cell(&bodies, place).is_empty() {
            cell(&bodies, place).clone_into(&mut body);
        }
        if place != frame && Some(place) != part && !name.is_empty() {
            let unit = unit(cell(&units, place));
            channels.push(Channel { place, body: body.clone(), component: name.clone(), unit, marker: false });
        }
    }
    let from = start + 5;
    let to = lines[from.min(lines.len())..].iter().position(|l| l.trim().is_empty()).map_or(lines.len(), |n| from + n);
    Ok(Sheet {
        program: "Vicon",
        channels,
        clock: Clock::Frame { cell: frame, part, rate_hz },
        rows: from..to,
        header: start + 4,
        separator,
        notes: Vec::new(),
        zeros: false,
    })
}

fn motive(lines: &[&str], separator: u8, first: usize) -> Result<Sheet, Wrong> {
    let head = cells(lines[first], separator);
    let setting = |name: &str| head.iter().position(|c| c == name).map(|k| cell(&head, k + 1).to_owned()).unwrap_or_default();
    let is_axes = |l: &&str| {
        let c = cells(l, separator);
        cell(&c, 0).eq_ignore_ascii_case("Frame") && cell(&c, 1).to_ascii_lowercase().starts_with("time")
    };
    let at = lines.iter().position(is_axes).filter(|at| *at > first).ok_or((
        first + 1,
        "is a Motive export without a row Frame, Time (Seconds), …".to_owned(),
        "export it with the header information and the column headers",
    ))?;
    let (axes, kinds) = (cells(lines[at], separator), cells(lines[at - 1], separator));
    let labelled = |name: &str| {
        let row = lines[first..at].iter().map(|l| cells(l, separator));
        row.into_iter().find(|c| c.iter().take(2).any(|w| w.eq_ignore_ascii_case(name))).unwrap_or_default()
    };
    let (types, names) = (labelled("Type"), labelled("Name"));
    let length = unit(&setting("Length Units"));
    let mut channels = Vec::new();
    for place in 2..axes.len() {
        let (kind, axis) = (cell(&kinds, place), cell(&axes, place));
        let turned = kind.eq_ignore_ascii_case("rotation");
        // Of markers that a rigid body was solved from there are two, one of them measured.
        let kin = cell(&types, place);
        let own = cell(&names, place);
        let body = if kin.eq_ignore_ascii_case("Rigid Body Marker") { format!("{own} (solved)") } else { own.to_owned() };
        let same = |k: &usize| cell(&names, *k) == own && cell(&types, *k) == kin && cell(&kinds, *k) == kind;
        let quaternion = turned && (2..axes.len()).filter(same).any(|k| cell(&axes, k) == "W");
        let (component, unit) = match (turned, quaternion) {
            (true, true) => (format!("q{}", axis.to_ascii_lowercase()), ""),
            (true, false) => (format!("R{axis}"), "deg"),
            _ if kind.eq_ignore_ascii_case("position") => (axis.to_owned(), length),
            _ => (format!("{kind} {axis}").trim().to_owned(), ""),
        };
        channels.push(Channel { place, body, component, unit, marker: kin.to_ascii_lowercase().ends_with("marker") });
    }
    let set = ["Rotation Type", "Length Units", "Coordinate Space"].map(|n| (n, setting(n)));
    let notes = set.iter().filter(|(_, v)| !v.is_empty()).map(|(n, v)| format!("{n}: {v}")).collect::<Vec<_>>().join(", ");
    Ok(Sheet {
        program: "OptiTrack Motive",
        channels,
        clock: Clock::Time { cell: 1 },
        rows: at + 1..lines.len(),
        header: at + 1,
        separator,
        notes: vec![notes],
        zeros: true,
    })
}

fn qualisys(lines: &[&str]) -> Result<Sheet, Wrong> {
    let separator = b'\t';
    let setting =
        |name: &str| lines.iter().take(60).map(|l| cells(l, separator)).find(|c| c[0] == name).map(|c| cell(&c, 1).to_owned());
    let is_header = |l: &&str| {
        let c = cells(l, separator);
        c.windows(3).any(|w| (w[0] == "X" || w[0].ends_with(" X")) && w[1].ends_with('Y') && w[2].ends_with('Z'))
    };
    let at = lines.iter().take(60).position(is_header).ok_or((
        1,
        "is a Qualisys export without a row of names (X, Y, Z, …)".to_owned(),
        "export the 6DOF data as TSV with its header and its column names",
    ))?;
    let names = cells(lines[at], separator);
    let mut body = setting("BODY_NAMES").unwrap_or_default();
    let mut channels = Vec::new();
    for (place, name) in names.iter().enumerate().filter(|(_, n)| !n.is_empty() && *n != "Frame" && *n != "Time") {
        // The first name of a body has the body before it.
        let component = match name.rsplit_once(' ') {
            Some((own, component)) if ["X", "Y", "Z"].contains(&component) => {
                own.clone_into(&mut body);
                component
            }
            _ => name,
        };
        let unit = match component {
            "X" | "Y" | "Z" | "Residual" => "mm",
            "Roll" | "Pitch" | "Yaw" => "deg",
            _ => "",
        };
        channels.push(Channel { place, body: body.clone(), component: component.to_owned(), unit, marker: false });
    }
    let rate_hz = setting("FREQUENCY").and_then(|f| f.parse::<f64>().ok()).filter(|f| *f > 0.0);
    let clock = match (names.iter().position(|n| n == "Time"), rate_hz) {
        (Some(cell), _) => Clock::Time { cell },
        (None, Some(rate_hz)) => names.iter().position(|n| n == "Frame").map_or(Clock::Row { rate_hz }, |cell| Clock::Frame {
            cell,
            part: None,
            rate_hz,
        }),
        (None, None) => {
            let what = "is a Qualisys export with neither a column Time nor a FREQUENCY".to_owned();
            return Err((at + 1, what, "export it with its header"));
        }
    };
    let angles = ["ROTATION_ORDER", "EULER_ORDER"].into_iter().find_map(setting).map(|o| format!("order of rotations: {o}"));
    Ok(Sheet {
        program: "Qualisys",
        channels,
        clock,
        rows: at + 1..lines.len(),
        header: at + 1,
        separator,
        notes: angles.into_iter().collect(),
        zeros: true,
    })
}

/// Names of the columns: components alone of the only body, behind the body's name where there are several, and of markers. What two columns
/// would share keeps its place as a number.
fn names(channels: &[Channel]) -> Vec<String> {
    let mut of_bodies = channels.iter().filter(|c| !c.marker).map(|c| c.body.as_str());
    let first = of_bodies.next();
    let several = of_bodies.any(|b| Some(b) != first);
    let mut all: Vec<String> = Vec::with_capacity(channels.len());
    for c in channels {
        let own =
            if (several || c.marker) && !c.body.is_empty() { format!("{} {}", c.body, c.component) } else { c.component.clone() };
        let twice = all.contains(&own) || own == TIME;
        all.push(if twice { format!("{own} {}", c.place + 1) } else { own });
    }
    all
}

/// The column of time.
const TIME: &str = "t";

fn columns(lines: &[&str], sheet: Sheet) -> Result<Columns, Wrong> {
    let Sheet { program, channels, clock, rows, header, separator, mut notes, zeros } = sheet;
    if channels.is_empty() {
        return Err((header, format!("is a {program} export without a body"), "export the 6DOF data of the rigid body"));
    }
    let rows: Vec<(usize, Vec<String>)> =
        rows.filter(|k| !lines[*k].trim().is_empty()).map(|k| (k + 1, cells(lines[k], separator))).collect();
    let value = |line: usize, row: &[String], k: usize| {
        number(cell(row, k), separator).ok_or_else(|| {
            (
                line,
                format!("has \"{}\" where a number belongs", cell(row, k)),
                "a number, or an empty cell where nothing was measured",
            )
        })
    };
    let mut data: Vec<Vec<f64>> = vec![Vec::with_capacity(rows.len()); channels.len()];
    for (line, row) in &rows {
        for (c, column) in channels.iter().zip(&mut data) {
            column.push(value(*line, row, c.place)?);
        }
    }
    let mut t = Vec::with_capacity(rows.len());
    let parts = match &clock {
        // Samples a frame: one more than the largest part.
        Clock::Frame { part: Some(k), .. } => {
            let all = rows.iter().map(|(line, row)| value(*line, row, *k)).collect::<Result<Vec<f64>, Wrong>>()?;
            all.into_iter().filter(|x| x.is_finite()).fold(0.0, f64::max) + 1.0
        }
        _ => 1.0,
    };
    for (i, (line, row)) in rows.iter().enumerate() {
        t.push(match &clock {
            Clock::Time { cell } => value(*line, row, *cell)?,
            Clock::Frame { cell, part, rate_hz } => {
                let part = part.map_or(Ok(0.0), |k| value(*line, row, k))?;
                (value(*line, row, *cell)? + part / parts) / rate_hz
            }
            Clock::Row { rate_hz } => i as f64 / rate_hz,
        });
    }
    if zeros {
        notes.extend(unseen(&channels, &mut data));
    }
    let mut all = vec![TIME.to_owned()];
    all.extend(names(&channels));
    notes.insert(0, format!("{program} export of {}: columns {}", bodies(&channels), some_of(&all)));
    let units = std::iter::once("s").chain(channels.iter().map(|c| c.unit)).map(str::to_owned).collect();
    data.insert(0, t);
    if rows.is_empty() {
        return Err((header, "has a header and no frames".to_owned(), "one row per frame"));
    }
    let mut columns = Columns::new(all, data, rows.iter().map(|(line, _)| *line).collect());
    columns.header = Some(header);
    columns.units = units;
    columns.program = Some(program);
    columns.notes = notes.into_iter().filter(|n| !n.is_empty()).collect();
    Ok(columns)
}

fn bodies(channels: &[Channel]) -> String {
    let mut all: Vec<&str> = channels.iter().map(|c| c.body.as_str()).filter(|b| !b.is_empty()).collect();
    all.dedup();
    if all.is_empty() { "one body".to_owned() } else { some_of(&all) }
}

/// Frames in a row that repeat the one before from which on a body was not seen: one that is tracked gives no two frames alike (chosen).
const FROZEN: usize = 10;

/// Frames in which a body has exact zeros for X, Y and Z, or repeats the frame before for long: it was not seen, and all its numbers are none.
fn unseen(channels: &[Channel], data: &mut [Vec<f64>]) -> Vec<String> {
    let mut notes = Vec::new();
    let mut from = 0;
    while from < channels.len() {
        let body = &channels[from].body;
        let to = from + channels[from..].iter().take_while(|c| c.body == *body).count();
        let place = |axis: &str| (from..to).find(|k| channels[*k].component == axis);
        if let (Some(x), Some(y), Some(z)) = (place("X"), place("Y"), place("Z")) {
            let zero = |v: f64| v.abs() < f64::MIN_POSITIVE;
            let gone: Vec<usize> = (0..data[x].len()).filter(|i| [x, y, z].iter().all(|k| zero(data[*k][*i]))).collect();
            for &i in &gone {
                data[from..to].iter_mut().for_each(|column| column[i] = f64::NAN);
            }
            if !gone.is_empty() {
                notes.push(format!("{body} was not seen in {} frames, whose position is zero", gone.len()));
            }
            let frozen = frozen(&data[from..to]);
            for &i in &frozen {
                data[from..to].iter_mut().for_each(|column| column[i] = f64::NAN);
            }
            if !frozen.is_empty() {
                notes.push(format!("{body} was not seen in {} frames, which repeat the frame before", frozen.len()));
            }
        }
        from = to;
    }
    notes
}

/// Frames of stretches of [`FROZEN`] or more that repeat the frame before in every number that there is.
fn frozen(body: &[Vec<f64>]) -> Vec<usize> {
    let rows = body.first().map_or(0, Vec::len);
    let same = |i: usize| body.iter().all(|c| c[i].to_bits() == c[i - 1].to_bits()) && body.iter().any(|c| c[i].is_finite());
    let (mut all, mut start) = (Vec::new(), 0);
    for i in 1..=rows {
        if i == rows || !same(i) {
            if i - start > FROZEN {
                all.extend(start + 1..i);
            }
            start = i;
        }
    }
    all
}
