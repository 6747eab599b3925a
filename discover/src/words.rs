//! discover: numbers, names and lists in words. In: numbers and keys. Out: short text for people.

/// A number in four digits, as short as its size allows.
///
/// ```
/// assert_eq!(windfall_discover::words::number(0.0199812), "0.01998");
/// assert_eq!(windfall_discover::words::number(-3.2e-7), "-3.200e-7");
/// ```
#[must_use]
pub fn number(x: f64) -> String {
    let size = x.abs();
    if x == 0.0 {
        "0".to_owned()
    } else if !x.is_finite() {
        "–".to_owned()
    } else if !(1e-4..1e5).contains(&size) {
        format!("{x:.3e}")
    } else {
        // Four significant digits: 0.001234, 1.234, 12.34, 1234.
        let whole = [1e3, 1e2, 1e1, 1.0, 1e-1, 1e-2, 1e-3].iter().position(|t| size >= *t).unwrap_or(7);
        format!("{x:.whole$}")
    }
}

/// A probability in two digits.
///
/// ```
/// assert_eq!(windfall_discover::words::p_value(0.031), "0.031");
/// assert_eq!(windfall_discover::words::p_value(0.0), "< 1e-300");
/// ```
#[must_use]
pub fn p_value(p: f64) -> String {
    if !p.is_finite() {
        "–".to_owned()
    } else if p < 1e-300 {
        "< 1e-300".to_owned()
    } else if p < 1e-3 {
        format!("{p:.0e}")
    } else if p < 0.1 {
        format!("{p:.3}")
    } else {
        format!("{p:.2}")
    }
}

/// A p-value with its sign.
///
/// ```
/// use windfall_discover::words::p_with_sign;
/// assert_eq!([p_with_sign(0.02), p_with_sign(0.0)], ["p = 0.020", "p < 1e-300"]);
/// ```
#[must_use]
pub fn p_with_sign(p: f64) -> String {
    let words = p_value(p);
    if words.starts_with('<') { format!("p {words}") } else { format!("p = {words}") }
}

/// Endings of keys and the units that they stand for, longer ones first.
const UNITS: [(&str, &str); 16] = [
    ("_n_m_s", "N m s"),
    ("_deg_s", "deg/s"),
    ("_m_s2", "m/s²"),
    ("_kg_m2", "kg m²"),
    ("_rad_s", "rad/s"),
    ("_n_s_m", "N s/m"),
    ("_n_s", "N s"),
    ("_m_s", "m/s"),
    ("_n_m", "N m"),
    ("_deg", "deg"),
    ("_rad", "rad"),
    ("_hz", "Hz"),
    ("_kg", "kg"),
    ("_n", "N"),
    ("_m", "m"),
    ("_s", "s"),
];

/// A key in words and the unit at its end, if it has one.
///
/// ```text
/// axial_rms_m_s: axial rms, m/s
/// ```
#[must_use]
pub fn plain_key(key: &str) -> (String, Option<&'static str>) {
    let found = UNITS.iter().find_map(|(ending, unit)| Some((key.strip_suffix(ending).filter(|k| !k.is_empty())?, *unit)));
    let (name, unit) = found.map_or((key, None), |(name, unit)| (name, Some(unit)));
    (name.replace(['_', '-'], " "), unit)
}

/// A list as people write it: `a`, `a and b`, `a, b and c`.
#[must_use]
pub fn listed<S: AsRef<str>>(items: &[S]) -> String {
    match items {
        [] => String::new(),
        [one] => one.as_ref().to_owned(),
        [head @ .., last] => format!("{} and {}", head.iter().map(AsRef::as_ref).collect::<Vec<_>>().join(", "), last.as_ref()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_numbers_have_four_digits() {
        for (x, text) in [
            (6.662, "6.662"),
            (-205.4289, "-205.4"),
            (0.012_345, "0.01235"),
            (0.5, "0.5000"),
            (12_345.6, "12346"),
            (1e7, "1.000e7"),
        ] {
            assert_eq!(number(x), text);
        }
        assert_eq!(number(f64::NAN), "–");
    }

    #[test]
    fn exact_keys_in_words() {
        assert_eq!(plain_key("axial_rms_m_s"), ("axial rms".to_owned(), Some("m/s")));
        assert_eq!(plain_key("damping-shape"), ("damping shape".to_owned(), None));
        assert_eq!(plain_key("line_rate_n_s_m"), ("line rate".to_owned(), Some("N s/m")));
        assert_eq!(plain_key("x_m"), ("x".to_owned(), Some("m")));
    }

    #[test]
    fn exact_lists() {
        assert_eq!(listed(&["a"]), "a");
        assert_eq!(listed(&["a", "b", "c"]), "a, b and c");
    }
}
