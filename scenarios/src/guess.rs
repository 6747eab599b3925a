//! scenarios: a first campaign file for run files. In: the runs' columns. Out: commented TOML in which every guess is marked as one,
//! what no record tells is left as `nan` (which the reader refuses with what is allowed), and every column that is left out is named.

mod agree;
mod axes;
mod draft;
mod fall;
mod name;
mod sheet;
mod still;
mod vectors;

use crate::columns::{Columns, fault, some_of};
use crate::error::ReadError;
use crate::formats::{read_columns, stem};
use agree::agree;
use axes::{AxesGuess, flying, mean, nearness, of_angles, of_quaternion, upright};
use fall::{falls, far};
use sheet::{Clock, Found, Refused, Sheet};
use std::path::{Path, PathBuf};
use still::{Still, still};
use vectors::{Euler, Position, Quaternion};

/// The kinds of campaign that runs can be of.
///
/// ```
/// use windfall_scenarios::DraftKind;
/// assert_eq!(DraftKind::of_name("free-flight"), Some(DraftKind::FreeFlight));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum DraftKind {
    /// A model with attitude in a vertical wind tunnel, on a tether or free.
    Tunnel,
    /// A rigid body in free flight through air at rest.
    FreeFlight,
    /// A body without attitude, by its positions or by an accelerometer.
    Point,
    /// A body on a pivot, by its angle.
    Pivot,
}

impl DraftKind {
    /// All of them, in the order of their names.
    pub const ALL: [Self; 4] = [Self::Tunnel, Self::FreeFlight, Self::Point, Self::Pivot];
    /// Its word on the command line.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Tunnel => "tunnel",
            Self::FreeFlight => "free-flight",
            Self::Point => "point",
            Self::Pivot => "pivot",
        }
    }
    /// What it is, for help.
    #[must_use]
    pub const fn help(self) -> &'static str {
        match self {
            Self::Tunnel => "a model with attitude in a vertical wind tunnel, on a tether or free",
            Self::FreeFlight => "a rigid body in free flight through air at rest",
            Self::Point => "a body without attitude, by its positions or by an accelerometer",
            Self::Pivot => "a body on a pivot, by its angle",
        }
    }
    /// The kind of that word.
    #[must_use]
    pub fn of_name(word: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|k| k.name() == word)
    }
}

/// A first campaign.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Draft {
    /// The campaign file.
    pub campaign: String,
    /// Name and content of the structure file that it names, where it names one.
    pub structure: Option<(&'static str, String)>,
}

/// A commented campaign for run files: the last of several is held out, those without the columns of a run are left out and named. `kind` in
/// place of the guess.
///
/// # Errors
/// Files of which none is a run file; one that cannot be read, or without what its kind of campaign needs; two files of one name.
pub fn draft_campaign(files: &[PathBuf], kind: Option<DraftKind>) -> Result<Draft, ReadError> {
    let read = files.iter().map(|f| Ok((f.as_path(), read_columns(f)?))).collect::<Result<Vec<_>, ReadError>>()?;
    let mut names: Vec<Option<String>> = files.iter().map(|f| stem(f)).collect();
    names.sort();
    if let Some(twice) = names.windows(2).find(|w| w[0] == w[1]) {
        let what = "is the name of two of the files, and runs are told by their names";
        let name = twice[0].clone().unwrap_or_default();
        return Err(one_fault(&files[files.len() - 1], None, "file", &name, what, "rename one of them"));
    }
    let all: Vec<(&Path, Sheet<'_>, &Columns)> = read.iter().map(|(f, c)| (*f, Sheet::new(c), c)).collect();
    let (mut guesses, mut sheets, mut not_read) = (Vec::new(), Vec::new(), Vec::new());
    for (file, sheet, columns) in all {
        match Guess::new(file, &sheet, columns) {
            Ok(guess) => {
                guesses.push(guess);
                sheets.push((file, sheet, columns));
            }
            Err(why) => not_read.push(why),
        }
    }
    if guesses.is_empty()
        && let Some(why) = not_read.pop()
    {
        return Err(why);
    }
    agree(&mut guesses, &sheets);
    let Some(first) = guesses.first() else {
        return Err(one_fault(Path::new(""), None, "file", "", "is missing: a campaign has runs", "windfall init mine run.csv"));
    };
    let (kind, why) = match kind {
        Some(kind) => (kind, "as asked for".to_owned()),
        None => first.kind(),
    };
    let readings = guesses
        .iter()
        .zip(&sheets)
        .map(|(g, (file, sheet, columns))| g.reading(kind, file, sheet, columns))
        .collect::<Result<Vec<_>, _>>()?;
    let not_read: Vec<String> = not_read.iter().map(ToString::to_string).collect();
    Ok(draft::draft(kind, &why, &readings, &not_read))
}

fn one_fault(path: &Path, line: Option<usize>, key: &str, value: &str, what: &str, remedy: &str) -> ReadError {
    ReadError::Faults(vec![fault(path, line, key, value, what, remedy)])
}

/// How the body is turned.
enum Attitude {
    Quaternion(Quaternion),
    Euler(Euler),
}

impl Attitude {
    fn names(&self) -> &[String] {
        match self {
            Self::Quaternion(q) => &q.names,
            Self::Euler(e) => &e.names,
        }
    }
}

/// What the columns of one file seem to be.
struct Guess {
    clock: Clock,
    position: Option<Position>,
    attitude: Option<Attitude>,
    air: Vec<Found>,
    force: Vec<Found>,
    angle: Option<Found>,
    refused: Vec<Refused>,
    /// Matrices body to room, sample by sample.
    turns: Vec<Option<[[f64; 3]; 3]>>,
    /// How clearly the record falls along one of its axes.
    falls: Option<(String, f64)>,
}

/// What is read of a file in a campaign of a kind.
pub(super) struct Reading {
    file: PathBuf,
    columns: Vec<Found>,
    attitude: Option<Attitude>,
    axes: Option<AxesGuess>,
    /// `[axes] down` of a body without attitude, and why.
    down: (String, String),
    rate_hz: f64,
    still: Option<Still>,
    left_out: Vec<Refused>,
    notes: Vec<String>,
}

impl Reading {
    /// Whether the same tables read both files.
    fn reads_like(&self, other: &Self) -> bool {
        let found = |r: &Self| r.columns.iter().map(|f| (f.ours, f.name.clone(), f.unit.clone())).collect::<Vec<_>>();
        let turned = |r: &Self| match &r.attitude {
            Some(Attitude::Quaternion(q)) => (q.names.to_vec(), if q.last { "last" } else { "first" }, ""),
            Some(Attitude::Euler(e)) => (e.names.to_vec(), e.sequence, e.unit),
            None => (Vec::new(), "", ""),
        };
        found(self) == found(other) && turned(self) == turned(other)
    }
}

impl Guess {
    fn new(path: &Path, sheet: &Sheet<'_>, columns: &Columns) -> Result<Self, ReadError> {
        let (clock, mut refused) = sheet::time(sheet);
        let (position, not) = vectors::position(sheet);
        refused.extend(not);
        let (quaternion, not) = vectors::quaternion(sheet);
        refused.extend(not);
        let (euler, not) = vectors::euler(sheet);
        refused.extend(not);
        let (force, not) = vectors::specific_force(sheet);
        refused.extend(not);
        let angle = vectors::pivot_angle(sheet);
        let measured = position.is_some() || !force.is_empty() || angle.is_some();
        let Some(clock) = clock.filter(|_| measured) else {
            let has = some_of(columns.names());
            let why: Vec<String> = refused.iter().map(|r| format!("{}: {}", r.name, r.why)).collect();
            let why = if why.is_empty() { String::new() } else { format!(" ({})", why.join("; ")) };
            let what =
                format!("has no columns that could be a time and a position, an acceleration or an angle; it has {has}{why}");
            let remedy = "name them t and x, y, z (or t_s and X_m, Y_m, Z_m) in the file's header";
            return Err(one_fault(path, columns.header, "columns", "", &what, remedy));
        };
        let (air, not) = sheet::air(sheet, &clock.found.name);
        refused.extend(not);
        let mut attitude = quaternion.map(Attitude::Quaternion).or(euler.map(Attitude::Euler));
        let turns = attitude.as_mut().map_or_else(Vec::new, |a| settled(sheet, a));
        let position = position.map(|p| if air.is_empty() { far(sheet, &clock, p) } else { p });
        let falls = position.as_ref().and_then(|p| falls(sheet, &clock, &p.found));
        Ok(Self { clock, position, attitude, air, force, angle, refused, turns, falls })
    }

    /// The kind of campaign, and what speaks for it.
    fn kind(&self) -> (DraftKind, String) {
        let guess = |kind, why: &str| (kind, format!("GUESS: {why}; --kind says another"));
        let three = self.position.as_ref().is_some_and(|p| p.found.len() == 3);
        match (&self.position, self.attitude.as_ref().filter(|_| three), &self.angle) {
            (None, None, Some(_)) if self.force.is_empty() => guess(DraftKind::Pivot, "the file has an angle and no position"),
            (Some(_), Some(_), _) if !self.air.is_empty() => {
                guess(DraftKind::Tunnel, "the file has an attitude and the tunnel's air")
            }
            (Some(_), Some(_), _) => guess(DraftKind::FreeFlight, "the file has an attitude and no tunnel speed"),
            (Some(_), None, _) => guess(DraftKind::Point, "the file has no attitude beside a position along three axes"),
            (None, ..) => guess(DraftKind::Point, "the file has an acceleration and no position"),
        }
    }

    /// What a campaign of that kind reads.
    fn reading(&self, kind: DraftKind, path: &Path, sheet: &Sheet<'_>, columns: &Columns) -> Result<Reading, ReadError> {
        let position = self.position.as_ref().map_or(&[][..], |p| &p.found);
        let lacks = |what: &str| {
            let what =
                format!("has no {what}, which a campaign of the kind {} needs; it has {}", kind.name(), some_of(columns.names()));
            let remedy = "another --kind, or names in the file's header that say it";
            Err(one_fault(path, columns.header, "columns", "", &what, remedy))
        };
        let with_attitude = matches!(kind, DraftKind::Tunnel | DraftKind::FreeFlight);
        if with_attitude && (position.len() < 3 || self.attitude.is_none()) {
            return lacks("position along three axes with an attitude");
        }
        let mut read = vec![self.clock.found.clone()];
        match kind {
            DraftKind::Tunnel => read.extend(position.iter().chain(&self.air).cloned()),
            DraftKind::FreeFlight => read.extend(position.iter().cloned()),
            DraftKind::Point if position.is_empty() && self.force.is_empty() => return lacks("position and no acceleration"),
            DraftKind::Point if position.is_empty() => read.extend(self.force.iter().cloned()),
            DraftKind::Point => read.extend(position.iter().cloned()),
            DraftKind::Pivot => match &self.angle {
                Some(angle) => read.push(angle.clone()),
                None => return lacks("angle"),
            },
        }
        let attitude = self.attitude.as_ref().filter(|_| with_attitude).map(copy);
        let (down, why) = self.down(sheet);
        let axes = match kind {
            DraftKind::Tunnel => upright(mean(self.turns.iter().flatten().copied())),
            DraftKind::FreeFlight => Some(self.flight(sheet, &down, &why)),
            DraftKind::Point | DraftKind::Pivot => None,
        };
        let used: Vec<&str> =
            read.iter().map(|f| f.name.as_str()).chain(attitude.iter().flat_map(Attitude::names).map(String::as_str)).collect();
        let still = still(sheet, &self.clock, &used);
        Ok(Reading {
            file: path.canonicalize().unwrap_or_else(|_| path.to_owned()),
            left_out: self.left_out(kind, &used, sheet, columns),
            columns: read,
            attitude,
            axes,
            down: (down, why),
            rate_hz: self.clock.rate_hz,
            still,
            notes: columns.notes.clone(),
        })
    }

    /// Every column that is not read, with the reason where its name looked right.
    fn left_out(&self, kind: DraftKind, used: &[&str], sheet: &Sheet<'_>, columns: &Columns) -> Vec<Refused> {
        let mut attitude: Vec<&str> = self.attitude.iter().flat_map(Attitude::names).map(String::as_str).collect();
        attitude.retain(|n| !used.contains(n));
        let why = |name: &str| {
            let refused = self.refused.iter().find(|r| r.name == name).map(|r| r.why.clone());
            if attitude.contains(&name) {
                return format!("part of an attitude, which the kind {} does not read", kind.name());
            }
            if self.force.iter().any(|f| f.name == name) {
                return "an acceleration: beside positions it needs specific_force_std_m_s2 in [sensors] and a known direction"
                    .to_owned();
            }
            if self.air.iter().any(|f| f.name == name) {
                return format!("the air, which the kind {} takes as known", kind.name());
            }
            refused.unwrap_or_default()
        };
        let all = sheet.columns.iter().map(|c| c.name).filter(|n| !used.contains(n));
        let texts =
            columns.left_out().iter().map(|name| Refused { name: name.clone(), why: "holds no plain numbers".to_owned() });
        all.map(|name| Refused { name: name.to_owned(), why: why(name) }).chain(texts).collect()
    }

    /// The axis of the file that is down, with its sign, and why.
    fn down(&self, sheet: &Sheet<'_>) -> (String, String) {
        let Some(position) = &self.position else {
            let axis = self.force.last().map_or('Z', |f| f.ours.chars().nth(1).unwrap_or('Z'));
            let why = "GUESS: an accelerometer at rest reads upward; +".to_owned();
            return (format!("-{axis}"), format!("{why}{axis} where its axis points down"));
        };
        if let Some(down) = &position.down {
            return (down.clone(), "as the column's name says".to_owned());
        }
        if let Some((axis, a)) = &self.falls {
            return (axis.clone(), format!("GUESS: along it the record accelerates by {a:.2} m/s2 on average"));
        }
        match sheet.program {
            Some("OptiTrack Motive") => {
                ("-Y".to_owned(), "GUESS: exports of OptiTrack Motive have y up unless it was changed".to_owned())
            }
            Some(program) => ("-Z".to_owned(), format!("GUESS: exports of {program} have z up unless it was changed")),
            None => ("-Z".to_owned(), "GUESS: z up; the record does not tell".to_owned()),
        }
    }

    /// Axes of a body in free flight, by the way that it takes.
    fn flight(&self, sheet: &Sheet<'_>, down: &str, why: &str) -> AxesGuess {
        let sign = if down.starts_with('-') { -1.0 } else { 1.0 };
        let axis = "XYZ".find(down.chars().last().unwrap_or('Z')).unwrap_or(2);
        let found = self.position.as_ref().map_or(&[][..], |p| &p.found);
        let places: Vec<&[f64]> = found.iter().filter_map(|f| sheet.get(&f.name)).collect();
        let step: Vec<[f64; 3]> =
            (1..self.turns.len()).map(|i| [0, 1, 2].map(|k| places.get(k).map_or(f64::NAN, |p| p[i] - p[i - 1]))).collect();
        let (mut way, mut low, mut n) = ([0.0; 3], [0.0; 3], 0.0_f64);
        for (turn, step) in self.turns.iter().skip(1).zip(step) {
            let length = step.iter().map(|x| x * x).sum::<f64>().sqrt();
            let Some(m) = turn.filter(|_| length.is_finite() && length > 0.0) else { continue };
            for k in 0..3 {
                way[k] += (0..3).map(|j| m[j][k] * step[j]).sum::<f64>() / length;
                low[k] += m[axis][k] * sign;
            }
            n += 1.0;
        }
        let mean = |v: [f64; 3]| v.map(|x| x / n.max(1.0));
        flying((axis, sign), &format!("down is {down}: {why}"), mean(way), mean(low))
    }
}

fn copy(a: &Attitude) -> Attitude {
    match a {
        Attitude::Quaternion(q) => Attitude::Quaternion(Quaternion { names: q.names.clone(), ..*q }),
        Attitude::Euler(e) => Attitude::Euler(Euler { names: e.names.clone(), why: e.why.clone(), ..*e }),
    }
}

/// Matrices of an attitude, sample by sample; what its names leave open is read so that an axis of the body stays near one of the room, if
/// only one reading does that.
fn settled(sheet: &Sheet<'_>, attitude: &mut Attitude) -> Vec<Option<[[f64; 3]; 3]>> {
    let series = |names: &[String]| names.iter().map(|n| sheet.get(n).unwrap_or(&[])).collect::<Vec<_>>();
    match attitude {
        Attitude::Quaternion(q) => {
            let s = series(&q.names);
            let read = |last: bool| -> Vec<Option<[[f64; 3]; 3]>> {
                let order = if last { [0, 1, 2, 3] } else { [1, 2, 3, 0] };
                (0..s[0].len()).map(|i| of_quaternion(order.map(|k| s[k][i]))).collect()
            };
            let (one, other) = (read(q.last), read(!q.last));
            if !q.told && stays_other(&one, &other) {
                q.last = !q.last;
                return other;
            }
            one
        }
        Attitude::Euler(e) => {
            let s = series(&e.names);
            let rad = if e.unit == "rad" { 1.0 } else { 1.0_f64.to_radians() };
            let read = |order: [usize; 3], sequence: &str| -> Vec<Option<[[f64; 3]; 3]>> {
                let row = |i: usize| order.map(|k| rad * s[k][i]);
                let finite = |a: [f64; 3]| a.iter().all(|x| x.is_finite()).then(|| of_angles(a, sequence));
                (0..s[0].len()).map(|i| finite(row(i))).collect()
            };
            let instead = if e.sequence == "zyx" { "xyz" } else { "zyx" };
            let (one, other) = (read([0, 1, 2], e.sequence), read([2, 1, 0], instead));
            if stays_other(&one, &other) {
                e.sequence = instead;
                e.names.reverse();
                return other;
            }
            one
        }
    }
}

/// Whether an axis of the body stays near one of the room by the other reading and not by this one.
fn stays_other(one: &[Option<[[f64; 3]; 3]>], other: &[Option<[[f64; 3]; 3]>]) -> bool {
    let stays = |all: &[Option<[[f64; 3]; 3]>]| nearness(mean(all.iter().flatten().copied())) > axes::PARALLEL;
    !stays(one) && stays(other)
}

#[cfg(test)]
mod tests;
