//! scenarios: a column's name as words and a unit. In: the name, what the file's row of units has for it. Out: its readings, likelier first.

use crate::column_unit::UnitQuantity as Q;

/// The unit that a file gives a column.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Said {
    /// One that `[columns]` knows, in its word.
    Known(Q, &'static str),
    /// One that no column of a run is in, as the file has it.
    Other(String),
}

/// One reading of a column's name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Name {
    /// Its words in lower case, without the unit.
    pub(super) words: Vec<String>,
    pub(super) unit: Option<Said>,
}

/// A unit and its other spellings, without blanks, dots and carets, in lower case.
type Spelling = (Q, &'static str, &'static [&'static str]);
const SPELLINGS: &[Spelling] = &[
    (Q::Time, "s", &["s", "sec", "secs", "second", "seconds"]),
    (Q::Time, "ms", &["ms", "msec", "msecs", "millis", "millisecond", "milliseconds"]),
    (Q::Time, "us", &["us", "usec", "micros", "microsecond", "microseconds"]),
    (Q::Time, "ns", &["ns", "nsec", "nanos", "nanosecond", "nanoseconds"]),
    (Q::Time, "min", &["min", "mins", "minute", "minutes"]),
    (Q::Length, "m", &["m", "meter", "meters", "metre", "metres"]),
    (Q::Length, "mm", &["mm", "millimeter", "millimeters", "millimetre", "millimetres"]),
    (Q::Length, "cm", &["cm", "centimeter", "centimeters", "centimetre", "centimetres"]),
    (Q::Length, "um", &["um", "micrometer", "micrometers"]),
    (Q::Length, "km", &["km", "kilometer", "kilometers"]),
    (Q::Length, "in", &["in", "inch", "inches"]),
    (Q::Length, "ft", &["ft", "feet", "foot"]),
    (Q::Angle, "deg", &["deg", "degs", "degree", "degrees"]),
    (Q::Angle, "rad", &["rad", "radian", "radians"]),
    (Q::Angle, "mrad", &["mrad"]),
    (Q::Angle, "turn", &["turn", "turns"]),
    (Q::Pressure, "Pa", &["pa", "pascal"]),
    (Q::Pressure, "hPa", &["hpa"]),
    (Q::Pressure, "kPa", &["kpa"]),
    (Q::Pressure, "MPa", &["mpa"]),
    (Q::Pressure, "mbar", &["mbar", "millibar"]),
    (Q::Pressure, "bar", &["bar"]),
    (Q::Pressure, "atm", &["atm"]),
    (Q::Pressure, "mmHg", &["mmhg"]),
    (Q::Pressure, "Torr", &["torr"]),
    (Q::Pressure, "psi", &["psi", "psia"]),
    (Q::Pressure, "psf", &["psf"]),
    (Q::Speed, "m/s", &["m/s", "mps", "m_s", "ms-1"]),
    (Q::Speed, "mm/s", &["mm/s", "mmps", "mm_s"]),
    (Q::Speed, "cm/s", &["cm/s", "cmps", "cm_s"]),
    (Q::Speed, "km/h", &["km/h", "kmh", "km_h", "kph"]),
    (Q::Speed, "ft/s", &["ft/s", "ft_s", "fps", "ftps"]),
    (Q::Speed, "kn", &["kn", "kt", "kts", "knot", "knots"]),
    (Q::Speed, "mph", &["mph"]),
    (Q::Temperature, "K", &["k", "kelvin"]),
    (Q::Temperature, "degC", &["c", "degc", "celsius"]),
    (Q::Temperature, "degF", &["f", "degf", "fahrenheit"]),
    (Q::Acceleration, "m/s2", &["m/s2", "m_s2", "mps2", "m/s/s", "ms-2"]),
    (Q::Acceleration, "g", &["g", "gs"]),
    (Q::Acceleration, "ft/s2", &["ft/s2", "ft_s2", "fps2"]),
];

/// Units of what no column of a run measures: they say that a name which looks right is not.
const OTHERS: [&str; 30] = [
    "rad/s", "radps", "rad_s", "rads", "deg/s", "degps", "deg_s", "dps", "rad/s2", "rad_s2", "deg/s2", "deg_s2", "rpm", "hz",
    "khz", "n", "nm", "v", "mv", "a", "ma", "w", "pct", "percent", "%", "kg", "gauss", "ut", "count", "counts",
];
/// Units that are also symbols or words of their own at the end of a name: both readings are tried.
const ALSO_WORDS: [&str; 11] = ["s", "m", "k", "c", "f", "g", "in", "min", "atm", "bar", "turn"];
/// Words at the end of a name that are no unit there, though they are one in brackets.
const ONLY_IN_BRACKETS: [&str; 5] = ["n", "v", "a", "w", "ma"];

/// A unit by its spelling; `None` for any other word.
pub(super) fn unit_of(word: &str) -> Option<Said> {
    let plain: String = word
        .trim()
        .to_lowercase()
        .replace('°', "deg")
        .replace(['µ', 'μ'], "u")
        .replace('²', "2")
        .replace("⁻¹", "-1")
        .chars()
        .filter(|c| !" ^.·*()[]".contains(*c))
        .collect();
    let known = SPELLINGS.iter().find(|(_, _, all)| all.contains(&plain.as_str()));
    let other = || OTHERS.contains(&plain.as_str()).then(|| Said::Other(word.trim().to_owned()));
    known.map(|(quantity, word, _)| Said::Known(*quantity, word)).or_else(other)
}

/// Parts of a name between separators, as they are written.
fn parts(name: &str) -> Vec<&str> {
    name.split(|c: char| !c.is_alphanumeric() && c != '%' && c != '°').filter(|p| !p.is_empty()).collect()
}

/// A part in words, where a capital follows a small letter (`tunnelSpeed`), in lower case.
fn words(parts: &[&str]) -> Vec<String> {
    let mut all = Vec::new();
    for part in parts {
        let mut word = String::new();
        let mut small = false;
        for c in part.chars() {
            if small && c.is_uppercase() {
                all.push(std::mem::take(&mut word));
            }
            small = c.is_lowercase();
            word.extend(c.to_lowercase());
        }
        all.push(word);
    }
    all
}

/// Readings of a name: with the unit that the row of units or its own end says, and without where that end may be a word.
pub(super) fn readings(name: &str, row: Option<&str>) -> Vec<Name> {
    let row = row.map(|r| r.trim().trim_matches(['[', ']', '(', ')']).trim()).filter(|r| !r.is_empty() && *r != "-");
    if let Some(row) = row {
        let unit = unit_of(row).unwrap_or_else(|| Said::Other(row.to_owned()));
        let own = readings(name, None);
        // The name's own unit is no word of it where the row says the same.
        return own.into_iter().map(|n| Name { unit: Some(unit.clone()), ..n }).collect();
    }
    if let Some((head, inside)) = bracketed(name)
        && let Some(unit) = unit_of(inside)
    {
        return vec![Name { words: words(&parts(head)), unit: Some(unit) }];
    }
    let all = parts(name);
    let plain = Name { words: words(&all), unit: None };
    let end = (1..=3_usize).rev().filter(|k| *k < all.len()).find_map(|k| {
        let (head, tail) = all.split_at(all.len() - k);
        let spelt = tail.join("_").to_lowercase();
        let unit = unit_of(&spelt).filter(|_| !ONLY_IN_BRACKETS.contains(&spelt.as_str()))?;
        Some((Name { words: words(head), unit: Some(unit) }, ALSO_WORDS.contains(&spelt.as_str())))
    });
    match end {
        Some((with, true)) => vec![with, plain],
        Some((with, false)) => vec![with],
        None => vec![plain],
    }
}

/// What stands before and in the brackets that end a name.
fn bracketed(name: &str) -> Option<(&str, &str)> {
    let name = name.trim();
    let (open, close) = [('[', ']'), ('(', ')')].into_iter().find(|(_, close)| name.ends_with(*close))?;
    let at = name.rfind(open)?;
    name.get(at + 1..name.len() - close.len_utf8()).map(|inside| (&name[..at], inside))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn one(name: &str) -> (Vec<String>, Option<Said>) {
        let first = readings(name, None).swap_remove(0);
        (first.words, first.unit)
    }

    /// Names as people write them, each with its words and unit.
    #[test]
    fn exact_names_are_words_and_a_unit() {
        for (name, words, unit) in [
            ("tunnel_speed_mps", "tunnel speed", Some(Said::Known(Q::Speed, "m/s"))),
            ("VW_m_s", "vw", Some(Said::Known(Q::Speed, "m/s"))),
            ("TunnelSpeed [ft/s]", "tunnel speed", Some(Said::Known(Q::Speed, "ft/s"))),
            ("p_radps", "p", Some(Said::Other("radps".to_owned()))),
            ("yaw rate (deg/s)", "yaw rate", Some(Said::Other("deg/s".to_owned()))),
            ("Time (Seconds)", "time", Some(Said::Known(Q::Time, "s"))),
            ("accel_z_m_s2", "accel z", Some(Said::Known(Q::Acceleration, "m/s2"))),
            ("temp_degC", "temp", Some(Said::Known(Q::Temperature, "degC"))),
            ("p (hPa)", "p", Some(Said::Known(Q::Pressure, "hPa"))),
            ("pos.x", "pos x", None),
            ("posX", "pos x", None),
            ("q_w", "q w", None),
            ("pose(:,1)", "pose 1", None),
            ("speed [m s^-1]", "speed", Some(Said::Known(Q::Speed, "m/s"))),
            ("angle (°)", "angle", Some(Said::Known(Q::Angle, "deg"))),
        ] {
            let words: Vec<String> = words.split(' ').map(str::to_owned).collect();
            assert_eq!(one(name), (words, unit), "{name}");
        }
        // `p_s` is a pressure's symbol or a time: both are read.
        assert_eq!(readings("p_s", None).len(), 2);
        assert_eq!(readings("x", Some("[mm]"))[0].unit, Some(Said::Known(Q::Length, "mm")));
        assert_eq!(readings("x", Some("furlong"))[0].unit, Some(Said::Other("furlong".to_owned())));
    }

    /// Every unit of `[columns]` that has a spelling here is one there.
    #[test]
    fn law_spellings_are_units_of_columns() {
        for (quantity, word, all) in SPELLINGS {
            assert!(crate::column_unit::ColumnUnit::of(*quantity, word).is_some(), "{word}");
            assert!(all.iter().all(|s| unit_of(s) == Some(Said::Known(*quantity, word))), "{word}: {all:?}");
        }
    }
}
