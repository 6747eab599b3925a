//! report: numbers and conclusions in words. In: results. Out: short text for people.

use windfall_discover::NORMAL_95;
use windfall_discover::close::{Closing, EffectLine, HeldOut, ParameterLine, Verdict};

/// A number in four digits, as short as its size allows.
///
/// ```
/// assert_eq!(windfall_report::number(0.0199812), "0.01998");
/// assert_eq!(windfall_report::number(-3.2e-7), "-3.200e-7");
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

/// An estimate with half its 95 % interval: two digits of the half, as many places of the estimate; four digits of an estimate that
/// has no interval.
///
/// ```
/// let (estimate, half) = windfall_report::with_interval(6.662_034, Some(1.152e-4));
/// assert_eq!((estimate.as_str(), half.as_deref()), ("6.66203", Some("0.00012")));
/// ```
#[must_use]
pub fn with_interval(estimate: f64, half: Option<f64>) -> (String, Option<String>) {
    let Some(half) = half.filter(|h| h.is_finite() && *h > 0.0) else { return (number(estimate), None) };
    let places = 1.0 - half.log10().floor();
    let size = estimate.abs().max(half);
    if size < 1e-4 {
        // As many digits of the estimate as its interval needs, each with its own power of ten.
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 12")]
        let digits = (places + estimate.abs().max(f64::MIN_POSITIVE).log10().floor()).clamp(0.0, 12.0) as usize;
        let estimate = if estimate.abs() < f64::MIN_POSITIVE { "0".to_owned() } else { format!("{estimate:.digits$e}") };
        return (estimate, Some(format!("{half:.1e}")));
    }
    if !(..=9.0).contains(&places) || estimate.abs() >= 1e9 {
        return (number(estimate), Some(number(half)));
    }
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 9")]
    let places = places.max(0.0) as usize;
    (format!("{estimate:.places$}"), Some(format!("{half:.places$}")))
}

/// Ends of an interval in as many places as half of it needs.
///
/// ```
/// assert_eq!(windfall_report::interval([6.661_931, 6.662_149]), "[6.66193, 6.66215]");
/// ```
#[must_use]
pub fn interval(ends: [f64; 2]) -> String {
    let [low, high] = ends.map(|x| with_interval(x, Some(0.5 * (ends[1] - ends[0]))).0);
    format!("[{low}, {high}]")
}

/// A probability in two digits.
///
/// ```
/// assert_eq!(windfall_report::p_value(0.031), "0.031");
/// assert_eq!(windfall_report::p_value(0.0), "< 1e-300");
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
pub(crate) fn plain_key(key: &str) -> (String, Option<&'static str>) {
    let found = UNITS.iter().find_map(|(ending, unit)| Some((key.strip_suffix(ending).filter(|k| !k.is_empty())?, *unit)));
    let (name, unit) = found.map_or((key, None), |(name, unit)| (name, Some(unit)));
    (name.replace(['_', '-'], " "), unit)
}

/// A name with its unit, if it has one: `X (m)`.
pub(crate) fn with_unit(name: &str, unit: Option<&str>) -> String {
    unit.map_or_else(|| name.to_owned(), |u| format!("{name} ({u})"))
}

/// A channel of a record with its unit: `X_m` is `X (m)`.
pub(crate) fn channel(key: &str) -> String {
    let (name, unit) = plain_key(key);
    with_unit(&name, unit)
}

/// A list as people write it: `a`, `a and b`, `a, b and c`.
pub(crate) fn listed<S: AsRef<str>>(items: &[S]) -> String {
    match items {
        [] => String::new(),
        [one] => one.as_ref().to_owned(),
        [head @ .., last] => format!("{} and {}", head.iter().map(AsRef::as_ref).collect::<Vec<_>>().join(", "), last.as_ref()),
    }
}

/// Whether effects are named of which none has the form that acts: something stands out beside them.
pub(crate) fn no_form_holds(c: &Closing) -> bool {
    c.effects.iter().all(|e| e.form.as_ref().is_some_and(|f| !f.ok)) && !c.unexplained.is_empty()
}

/// The verdict as a sentence or two.
#[must_use]
pub fn sentence(c: &Closing) -> String {
    match c.verdict {
        Verdict::Consistent => {
            format!(
                "What the declared model leaves is noise: no effect of the {} weighed is needed.{}",
                c.candidates.len(),
                moved_words(c)
            )
        }
        Verdict::Effect => {
            let names = listed(&c.effects.iter().map(effect_name).collect::<Vec<_>>());
            let (held_out, left) = (held_out_words(c), left_words(c));
            if no_form_holds(c) {
                let words = if c.effects.len() > 1 {
                    "come nearest to it, but the form of none of them holds"
                } else {
                    "comes nearest to it, but its form does not hold"
                };
                return format!("The declared model lacks something: {names} {words}.{held_out}{left}");
            }
            format!("The declared model lacks {names}.{held_out}{left}")
        }
        Verdict::Unexplained => {
            let channels: Vec<String> = c.unexplained.iter().map(|u| plain_key(&u.channel).0).collect();
            format!(
                "The declared model leaves a residual beyond noise in {} that no effect of the {} weighed accounts for.",
                listed(&channels),
                c.candidates.len()
            )
        }
    }
}

/// Declared parameters without which the model would not leave noise: those that the runs moved beyond their error.
fn moved_words(c: &Closing) -> String {
    let far = |p: &&ParameterLine| p.moved().is_some_and(|m| m.abs() > NORMAL_95);
    let one = |p: &ParameterLine| {
        let (estimate, half) = with_interval(p.estimate, p.std_error.map(|s| NORMAL_95 * s));
        let half = half.map_or_else(String::new, |h| format!(" ± {h}"));
        format!("{} at {estimate}{half} where the file has {}", p.name, number(p.declared.unwrap_or(f64::NAN)))
    };
    let all: Vec<String> = c.after.parameters.iter().filter(far).map(one).collect();
    // Tunnel runs are fitted from starting values, of which nothing is believed.
    if all.is_empty() || !c.is_of_tracks() { String::new() } else { format!(" It needs {}.", listed(&all)) }
}

fn effect_name(e: &EffectLine) -> String {
    if e.rivals.is_empty() {
        e.family.clone()
    } else {
        format!("{} (or {}, which these data cannot tell from it)", e.family, e.rivals.join(" or "))
    }
}

/// The figure that falls most, of position and attitude.
fn held_out_words(c: &Closing) -> String {
    let (Some(b), Some(a)) = (&c.before.hold_out, &c.after.hold_out) else { return String::new() };
    let angle = |h: &HeldOut| h.trajectory.and_then(|t| t.attitude_rms_deg);
    let attitude = angle(b).zip(angle(a)).map(|(b, a)| ("attitude", b, a, "°"));
    let position = b.position_rms_m.zip(a.position_rms_m).map(|(b, a)| ("position", 1e3 * b, 1e3 * a, "\u{a0}mm"));
    let ratio = |x: &(&str, f64, f64, &str)| x.2 / x.1;
    let most = [attitude, position].into_iter().flatten().min_by(|a, b| ratio(a).total_cmp(&ratio(b)));
    most.map_or_else(String::new, |(what, b, a, unit)| {
        let way = if a < b { "falls" } else { "goes" };
        let it = if c.effects.len() > 1 { "them" } else { "it" };
        format!(" With {it} in, the {what} error of runs held out {way} from {}{unit} to {}{unit} rms.", number(b), number(a))
    })
}

fn left_words(c: &Closing) -> String {
    let channels: Vec<&str> = c.unexplained.iter().map(|u| u.channel.as_str()).collect();
    if channels.is_empty() {
        " What remains is noise.".to_owned()
    } else {
        format!(" A residual beyond noise remains in {}.", listed(&channels))
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
    fn exact_places_follow_the_interval() {
        for (x, half, text) in [
            (-205.62, 3.42, "-205.6"),
            (0.001_001_6, 2.293e-6, "0.0010016"),
            (-1234.5, 420.0, "-1234"),
            (5.46e-8, 9.93e-8, "5.5e-8"),
            (-2.3456e-5, 4.2e-7, "-2.346e-5"),
        ] {
            assert_eq!(with_interval(x, Some(half)).0, text);
        }
        assert_eq!(with_interval(0.5, None), ("0.5000".to_owned(), None));
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
