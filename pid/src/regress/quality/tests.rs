//! pid tests: whiteness by the sums of Ljung and Box (Biometrika 65(2), 1978). In: short series. Out: the probability.

use super::*;

/// Three series, of which one is too short to test; the tail of χ² at even freedom 2m is `e^{−q/2} Σ_{j<m} (q/2)^j / j!`.
#[test]
fn exact_whiteness_is_ljung_and_box_by_hand() {
    let series: Vec<Vec<f64>> = [40, 41, 67]
        .map(|n: usize| (0..n).map(|i| 0.3 * ((i * i + n) as f64).sin() + 0.2 * (0.9 * i as f64).cos()).collect())
        .to_vec();
    let q: f64 = series[1..]
        .iter()
        .map(|v| {
            let (n, r0) = (v.len(), v.iter().map(|x| x.powi(2)).sum::<f64>());
            let term = |k: usize| ((k..n).map(|i| v[i] * v[i - k]).sum::<f64>() / r0).powi(2) / (n - k) as f64;
            (n * (n + 2)) as f64 * (1..=20).map(term).sum::<f64>()
        })
        .sum();
    let (mut term, mut tail) = (1.0, 0.0);
    for j in 1..=20 {
        tail += term;
        term *= q / 2.0 / f64::from(j);
    }
    let p = tail * (-q / 2.0).exp();
    // Tail of the library: round-off of a sum of that many terms.
    assert!((ljung_box(&series) / p - 1.0).abs() < 1e-10, "{} {p}", ljung_box(&series));
}
