//! report: numbers in words. In: results. Out: short text for people.

pub(crate) use windfall_discover::words::plain_key;
pub use windfall_discover::words::{number, p_value, p_with_sign};

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

/// A name with its unit, if it has one: `X (m)`.
pub(crate) fn with_unit(name: &str, unit: Option<&str>) -> String {
    unit.map_or_else(|| name.to_owned(), |u| format!("{name} ({u})"))
}

/// A channel of a record with its unit: `X_m` is `X (m)`.
pub(crate) fn channel(key: &str) -> String {
    let (name, unit) = plain_key(key);
    with_unit(&name, unit)
}

#[cfg(test)]
mod tests {
    use super::*;

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
}
