//! discover: rates of what was recorded without them, for the page. In: a series with its times. Out: its slope at every time.

/// Half of the window, s, and fewest samples on either side.
const HALF_S: f64 = 0.05;
const FEWEST: usize = 2;
/// Rounding of times, s: windows of even samples are as wide before as after.
const ROUNDING_S: f64 = 1e-7;

/// Slope of a straight line by least squares through the samples within a twentieth of a second, two on either side at least; NaN where
/// fewer than two are known. Times in s, even or not; measured and simulated series go through the same.
pub(super) fn slope(t_s: &[f64], x: &[f64]) -> Vec<f64> {
    let n = t_s.len().min(x.len());
    let (mut from, mut to) = (0, 0);
    let one = |i: usize| {
        while t_s[from] < t_s[i] - HALF_S - ROUNDING_S {
            from += 1;
        }
        while to < n && t_s[to] <= t_s[i] + HALF_S + ROUNDING_S {
            to += 1;
        }
        let window = from.min(i.saturating_sub(FEWEST))..to.max(i + FEWEST + 1).min(n);
        line(t_s, x, window)
    };
    (0..n).map(one).collect()
}

fn line(t_s: &[f64], x: &[f64], window: std::ops::Range<usize>) -> f64 {
    let known: Vec<(f64, f64)> = window.map(|k| (t_s[k], x[k])).filter(|(_, x)| x.is_finite()).collect();
    let n = known.len() as f64;
    let (t, y) = known.iter().fold((0.0, 0.0), |(a, b), (t, x)| (a + t / n, b + x / n));
    let (across, along) = known.iter().fold((0.0, 0.0), |(a, b), (s, x)| (a + (s - t) * (x - y), b + (s - t).powi(2)));
    if along > 0.0 { across / along } else { f64::NAN }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A straight line has its slope at uneven times and with a hole; of a parabola the symmetric window gives the slope in the middle.
    #[test]
    fn exact_slopes() {
        let t: Vec<f64> = (0..60).map(|i| 0.01 * f64::from(i) + if i % 3 == 0 { 0.002 } else { 0.0 }).collect();
        let mut x: Vec<f64> = t.iter().map(|t| 3.0 - 2.5 * t).collect();
        x[30] = f64::NAN;
        assert!(slope(&t, &x).iter().all(|v| (v + 2.5).abs() < 1e-9));
        let t: Vec<f64> = (0..60).map(|i| 0.01 * f64::from(i)).collect();
        let x: Vec<f64> = t.iter().map(|t| 4.9 * t * t).collect();
        assert!(slope(&t, &x)[6..54].iter().zip(&t[6..54]).all(|(v, t)| (v - 9.8 * t).abs() < 1e-9));
        // Ten samples a second: two on either side all the same.
        let t: Vec<f64> = (0..20).map(|i| 0.1 * f64::from(i)).collect();
        assert!(slope(&t, &t).iter().all(|v| (v - 1.0).abs() < 1e-9));
        assert!(slope(&[0.0], &[1.0])[0].is_nan());
    }

    /// Of a cubic at uneven times, dense at first and sparse then: least squares by a factorisation, over the samples no further
    /// than a twentieth of a second or two places away. Far from zero of place and time, where sums of squares about zero would be
    /// rounding: a straight line whose numbers are exact has its slope to nine digits.
    #[test]
    fn exact_slopes_by_a_factorisation() {
        let t: Vec<f64> = (0..30).map(|i| if i < 18 { 0.013 * f64::from(i) } else { 0.221 + 0.07 * f64::from(i - 17) }).collect();
        let x: Vec<f64> = t.iter().map(|t| 2.0 - t + 3.0 * t * t * t).collect();
        for (i, found) in slope(&t, &x).iter().enumerate() {
            let near: Vec<usize> = (0..30_usize).filter(|j| (t[*j] - t[i]).abs() < 0.05 || j.abs_diff(i) <= 2).collect();
            let a = nalgebra::DMatrix::from_fn(near.len(), 2, |r, c| if c == 0 { 1.0 } else { t[near[r]] });
            let b = nalgebra::DVector::from_fn(near.len(), |r, _| x[near[r]]);
            let line = a.svd(true, true).solve(&b, 1e-12).expect("a solution");
            assert!((found - line[1]).abs() < 1e-10, "{i}: {found} {}", line[1]);
        }
        let t: Vec<f64> = (0..40).map(|k| 4096.0 + f64::from(k) / 64.0).collect();
        let x: Vec<f64> = (0..40).map(|k| 1_999_999_999.0 + 0.375 * f64::from(k)).collect();
        assert!(slope(&t, &x).iter().all(|v| (v / 24.0 - 1.0).abs() < 1e-8), "{:?}", slope(&t, &x));
    }
}
