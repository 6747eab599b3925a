//! scenarios: columns of a run file with their names read. In: columns. Out: which of them is the time, a speed, a pressure, a temperature:
//! a guess agrees with the unit in its name and passes a range.

use super::name::{Name, Said, readings};
use crate::column_unit::{ColumnUnit, UnitQuantity as Q};
use crate::columns::Columns;

/// A column that was taken for one of ours, with its unit in words of `[columns]`, and why.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Found {
    pub(super) ours: &'static str,
    pub(super) name: String,
    pub(super) unit: String,
    pub(super) why: String,
}

/// A column whose name looks right, and why it was not taken.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Refused {
    pub(super) name: String,
    pub(super) why: String,
}

/// One column.
pub(super) struct Column<'a> {
    pub(super) name: &'a str,
    pub(super) values: &'a [f64],
    pub(super) readings: Vec<Name>,
}

/// All columns of a file.
pub(super) struct Sheet<'a> {
    pub(super) columns: Vec<Column<'a>>,
    pub(super) program: Option<&'static str>,
}

impl<'a> Sheet<'a> {
    pub(super) fn new(c: &'a Columns) -> Self {
        let row = |i: usize| c.units.get(i).map(String::as_str);
        let one =
            |(i, (name, values)): (usize, (&'a String, &'a Vec<f64>))| Column { name, values, readings: readings(name, row(i)) };
        Self { columns: c.all().enumerate().map(one).collect(), program: c.program }
    }
    pub(super) fn get(&self, name: &str) -> Option<&'a [f64]> {
        self.columns.iter().find(|c| c.name == name).map(|c| c.values)
    }
}

pub(super) fn median(v: &[f64]) -> f64 {
    crate::units::median(v)
}

/// Least and greatest of the finite values.
pub(super) fn extent(v: &[f64]) -> [f64; 2] {
    v.iter().filter(|x| x.is_finite()).fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], x| [a.min(*x), b.max(*x)])
}

pub(super) fn span(v: &[f64]) -> f64 {
    let [low, high] = extent(v);
    high - low
}

/// A number that stands alone for a whole column: what it is called, and what it may be.
struct Wanted {
    ours: &'static str,
    what: &'static str,
    quantity: Q,
    /// One of these is among the name's words, the likelier first; the others are among `beside`.
    core: &'static [&'static str],
    beside: &'static [&'static str],
    /// Units that a median without one may be in.
    sizes: &'static [&'static str],
    /// Medians in our unit: where the file says the unit, and where it does not and a room's are taken.
    said: [f64; 2],
    typical: [f64; 2],
    /// Without a unit it is one only where it hardly moves.
    steady: bool,
}

const AIR: &[&str] =
    &["air", "tunnel", "room", "ambient", "test", "section", "static", "s", "w", "abs", "absolute", "mean", "measured"];

/// Ranges where a unit is said are those of the run file's reader; a room has 0.5 to 1.2 bar and -43 to 57 degC.
const SPEED: Wanted = Wanted {
    ours: "VW_m_s",
    what: "a tunnel speed",
    quantity: Q::Speed,
    core: &["vw", "airspeed", "windspeed", "tunnelspeed", "fanspeed", "wind", "fan", "speed", "velocity", "flow", "v"],
    beside: &[
        "air",
        "tunnel",
        "room",
        "test",
        "section",
        "free",
        "stream",
        "freestream",
        "mean",
        "measured",
        "true",
        "fan",
        "w",
        "wind",
    ],
    sizes: &["m/s"],
    said: [-0.5, 150.0],
    typical: [0.5, 100.0],
    steady: false,
};
const PRESSURE: Wanted = Wanted {
    ours: "ps_Pa",
    what: "a static pressure",
    quantity: Q::Pressure,
    core: &["ps", "pstatic", "pstat", "staticpressure", "pressure", "baro", "barometer", "p"],
    beside: AIR,
    sizes: &["Pa", "hPa", "kPa", "bar", "psi"],
    said: [200.0, 1e8],
    typical: [5e4, 1.2e5],
    steady: true,
};
const TEMPERATURE: Wanted = Wanted {
    ours: "Ts_K",
    what: "a static temperature",
    quantity: Q::Temperature,
    core: &["ts", "tstatic", "tstat", "temperature", "temp", "t"],
    beside: AIR,
    sizes: &["K", "degC"],
    said: [100.0, 1000.0],
    typical: [230.0, 330.0],
    steady: true,
};
/// Spread over median of a pressure or temperature without a unit: a tenth, more than a room's changes in a run.
const STEADY: f64 = 0.1;

impl Wanted {
    fn place(&self, words: &[String]) -> Option<usize> {
        let all = words.iter().all(|w| self.core.contains(&w.as_str()) || self.beside.contains(&w.as_str()));
        let first = self.core.iter().position(|c| words.iter().any(|w| w == c));
        first.filter(|_| all)
    }
    /// The column read so, or why it is not.
    fn read(&self, c: &Column<'_>, unit: Option<&Said>) -> Result<Found, String> {
        let level = median(c.values);
        if !level.is_finite() {
            return Err("holds no numbers".to_owned());
        }
        let within = |word: &str, [low, high]: [f64; 2]| {
            ColumnUnit::of(self.quantity, word).is_some_and(|u| (low..=high).contains(&u.ours(level)))
        };
        let found = |unit: &str, why: String| Ok(Found { ours: self.ours, name: c.name.to_owned(), unit: unit.to_owned(), why });
        match unit {
            Some(Said::Known(q, word)) if *q == self.quantity => {
                if within(word, self.said) {
                    return found(word, "unit as the file says".to_owned());
                }
                Err(format!("a median of {level:.4} {word} is not {}", self.what))
            }
            Some(Said::Known(_, word)) => Err(format!("{word} is no unit of {}", self.what)),
            Some(Said::Other(word)) => Err(format!("{word} is no unit of {}", self.what)),
            None if self.steady && span(c.values) > STEADY * level.abs() => {
                Err(format!("without a unit it moves too much for {}: by {:.4} about {level:.4}", self.what, span(c.values)))
            }
            None => match self.sizes.iter().find(|word| within(word, self.typical)) {
                Some(word) => found(word, format!("GUESS: its median is {level:.4}")),
                None => {
                    Err(format!("without a unit, and a median of {level:.4} is not {} in {}", self.what, self.sizes.join(", ")))
                }
            },
        }
    }
}

/// The best column for what is wanted, and those that look like it and are not.
fn best(sheet: &Sheet<'_>, wanted: &Wanted, may_be: impl Fn(&Column<'_>, &Name) -> bool) -> (Option<Found>, Vec<Refused>) {
    let (mut all, mut refused) = (Vec::new(), Vec::new());
    for (at, c) in sheet.columns.iter().enumerate() {
        let mut why = None;
        for name in c.readings.iter().filter(|n| may_be(c, n)) {
            let Some(place) = wanted.place(&name.words) else { continue };
            match wanted.read(c, name.unit.as_ref()) {
                Ok(found) => {
                    all.push((name.unit.is_none(), place, at, found));
                    why = None;
                    break;
                }
                Err(words) => why = why.or(Some(words)),
            }
        }
        refused.extend(why.map(|why| Refused { name: c.name.to_owned(), why }));
    }
    all.sort_by_key(|(unsaid, place, at, _)| (*unsaid, *place, *at));
    let mut all = all.into_iter().map(|(.., f)| f);
    let first = all.next();
    if let Some(first) = &first {
        refused.extend(all.map(|f| Refused { name: f.name, why: format!("{} is read from {}", first.ours, first.name) }));
    }
    (first, refused)
}

/// Tunnel speed, static pressure and static temperature; `time` is none of them.
pub(super) fn air(sheet: &Sheet<'_>, time: &str) -> (Vec<Found>, Vec<Refused>) {
    let (mut found, mut refused) = (Vec::new(), Vec::new());
    for wanted in [&SPEED, &PRESSURE, &TEMPERATURE] {
        // A small t is the time.
        let capital = |c: &Column<'_>, n: &Name| n.words[0] != "t" || c.name.trim().starts_with('T');
        let may_be = |c: &Column<'_>, n: &Name| c.name != time && (wanted.quantity != Q::Temperature || capital(c, n));
        let (one, not) = best(sheet, wanted, may_be);
        found.extend(one);
        refused.extend(not);
    }
    (found, refused)
}

const TIMES: [&str; 8] = ["t", "time", "timestamp", "seconds", "sec", "clock", "epoch", "stamp"];
const OF_TIMES: [&str; 8] = ["unix", "elapsed", "rel", "relative", "since", "start", "s", "rec"];
/// Seconds since 1970 in the years 2001 to 2040.
const UNIX_S: [f64; 2] = [1e9, 2.2e9];
/// Share of the steps of a time that go on.
const GOES_ON: f64 = 0.9;

/// How many of a unit of time are a second.
pub(super) fn per_s(unit: &str) -> f64 {
    [("ms", 1e3), ("us", 1e6), ("ns", 1e9), ("min", 1.0 / 60.0)].iter().find(|(k, _)| *k == unit).map_or(1.0, |(_, k)| *k)
}

/// A column of time, and how many samples a second it has.
pub(super) struct Clock {
    pub(super) found: Found,
    pub(super) rate_hz: f64,
}

/// Times in s, from the first one.
pub(super) fn seconds(t: &[f64], unit: &str) -> Vec<f64> {
    let start = t.iter().copied().find(|x| x.is_finite()).unwrap_or(0.0);
    t.iter().map(|x| (x - start) / per_s(unit)).collect()
}

fn clock(c: &Column<'_>, unit: Option<&Said>) -> Result<Clock, String> {
    let steps: Vec<f64> = c.values.windows(2).map(|w| w[1] - w[0]).filter(|x| x.is_finite()).collect();
    let (step, level) = (median(&steps), median(c.values));
    let on = steps.iter().filter(|x| **x > 0.0).count() as f64;
    if !(step > 0.0 && on >= GOES_ON * steps.len() as f64) {
        return Err("does not increase as a time does".to_owned());
    }
    let units = [("s", 1.0), ("ms", 1e3), ("us", 1e6), ("ns", 1e9)];
    let unix = units.iter().find(|(_, k)| (UNIX_S[0]..UNIX_S[1]).contains(&(level / k)));
    let (unit, why) = match unit {
        Some(Said::Known(Q::Time, word)) if step / per_s(word) > 1.0 => {
            (*word, format!("unit as the file says; a step of {step:.4} {word} is long: is it another unit?"))
        }
        Some(Said::Known(Q::Time, word)) => (*word, "unit as the file says".to_owned()),
        Some(Said::Known(_, word)) => return Err(format!("{word} is no unit of time")),
        Some(Said::Other(word)) => return Err(format!("{word} is no unit of time")),
        None => match unix {
            Some((word, _)) => (*word, format!("GUESS: {level:.0} is a Unix time of this century")),
            // Records have between 5 and 5000 samples a second.
            None => {
                let by_size = units.iter().find(|(_, k)| step / k <= 0.2).map_or("s", |(u, _)| u);
                (by_size, format!("GUESS: the median step is {step}"))
            }
        },
    };
    let found = Found { ours: "t_s", name: c.name.to_owned(), unit: unit.to_owned(), why };
    Ok(Clock { rate_hz: per_s(unit) / step, found })
}

/// The column of time: `T` is one only where no other is.
pub(super) fn time(sheet: &Sheet<'_>) -> (Option<Clock>, Vec<Refused>) {
    let (mut all, mut refused) = (Vec::new(), Vec::new());
    for (at, c) in sheet.columns.iter().enumerate() {
        for name in &c.readings {
            let is = |w: &String| TIMES.contains(&w.as_str()) || OF_TIMES.contains(&w.as_str());
            let place = TIMES.iter().position(|k| name.words.iter().any(|w| w == k)).filter(|_| name.words.iter().all(is));
            // A unit of time says it in any language, where the numbers go on as a time does.
            let by_unit = matches!(name.unit, Some(Said::Known(Q::Time, _))).then_some(TIMES.len());
            let Some(place) = place.or(by_unit) else { continue };
            match clock(c, name.unit.as_ref()) {
                Ok(found) => {
                    all.push((c.name.trim().starts_with('T') && name.words[0] == "t", place, at, found));
                    break;
                }
                Err(why) => refused.push(Refused { name: c.name.to_owned(), why }),
            }
        }
    }
    all.sort_by_key(|(capital, place, at, _)| (*capital, *place, *at));
    (all.into_iter().next().map(|(.., f)| f), refused)
}
