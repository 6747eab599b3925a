//! pid: what every interval is made with. In: an estimate and its standard error. Out: factors and percentages.

/// Standard errors on either side of a 95 % interval of a normal estimate.
pub const NORMAL_95: f64 = 1.959_963_985;

/// Standard error over estimate, percent (thesis eq. 4.21); none where that is no number: of zero, or of what is not finite.
///
/// ```
/// assert_eq!(windfall_pid::relative_percent(0.5, -2.0), Some(25.0));
/// assert_eq!(windfall_pid::relative_percent(0.5, 0.0), None);
/// ```
#[must_use]
pub fn relative_percent(std_error: f64, estimate: f64) -> Option<f64> {
    Some(100.0 * std_error / estimate.abs()).filter(|r| r.is_finite())
}

/// Ends of the 95 % interval of a normal estimate with its standard error, in its unit.
///
/// ```
/// let [low, high] = windfall_pid::ci95(3.0, 0.5);
/// assert!((low - 2.02).abs() < 1e-4 && (high - 3.98).abs() < 1e-4);
/// ```
#[must_use]
pub fn ci95(estimate: f64, std_error: f64) -> [f64; 2] {
    either_side(estimate, NORMAL_95, std_error)
}

/// So many standard errors on either side.
pub(crate) fn either_side(estimate: f64, half: f64, std_error: f64) -> [f64; 2] {
    [estimate - half * std_error, estimate + half * std_error]
}

#[cfg(test)]
mod tests;
