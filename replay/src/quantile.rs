//! replay: quantiles. In: numbers in ascending order. Out: the number below which a share of them lies.

/// Quantile of sorted numbers by linear interpolation of order statistics (Hyndman and Fan 1996, type 7); `p` from 0 to 1, at least one
/// number.
///
/// ```
/// assert_eq!(windfall_replay::quantile(&[1.0, 2.0, 4.0], 0.75), 3.0);
/// ```
#[must_use]
pub fn quantile(sorted: &[f64], p: f64) -> f64 {
    let last = sorted.len() - 1;
    let place = p * last as f64;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 ≤ place ≤ length − 1")]
    let below = (place.floor() as usize).min(last);
    sorted[below] + (place - below as f64) * (sorted[(below + 1).min(last)] - sorted[below])
}

#[cfg(test)]
mod tests;
