//! discover tests: the share of variance between intervals of a variable, and its chance, against one-way analysis of variance by
//! hand.

use super::*;

/// Tail of the F distribution of 9 and 10 degrees of freedom, as the second is even: a finite sum (Abramowitz and Stegun 1964,
/// 26.6.5).
fn tail(f: f64) -> f64 {
    let w = 10.0 / (10.0 + 9.0 * f);
    let (mut term, mut sum) = (1.0, 0.0);
    for j in 0..5 {
        sum += term;
        term *= (4.5 + f64::from(j)) / f64::from(j + 1) * w;
    }
    1.0 - (1.0 - w).powf(4.5) * sum
}

/// 200 samples in no order, ten intervals of twenty: the mean of each, what is between them, and the F test of a tenth as many. To
/// rounding of the incomplete beta function.
#[test]
fn exact_analysis_of_variance() {
    let x: Vec<f64> = (0..200).map(|i| f64::from(77 * i % 200)).collect();
    let y: Vec<f64> =
        x.iter().enumerate().map(|(i, x)| 3.0 + 0.4 * (0.05 * x).floor().powi(2).sin() + (31 * i % 7) as f64 / 3.0).collect();
    let c = curve(&x, &y).expect("enough samples");
    let of =
        |g: usize| -> Vec<f64> { (0..200).filter(|i| (0.0..1.0).contains(&(x[*i] / 20.0 - g as f64))).map(|i| y[i]).collect() };
    let mean = |y: &[f64]| y.iter().sum::<f64>() / y.len() as f64;
    let square = |y: &[f64]| y.iter().map(|v| (v - mean(y)).powi(2)).sum::<f64>();
    let within: f64 = (0..10).map(|g| square(&of(g))).sum();
    let total = square(&y);
    let f = ((total - within) / 9.0) / (within / 10.0);
    assert!((c.share - (1.0 - within / total)).abs() < 1e-12, "{}", c.share);
    assert!((c.p_value / tail(f) - 1.0).abs() < 1e-9 && (0.01..0.999).contains(&c.p_value), "{} {}", c.p_value, tail(f));
    for (g, (at, value)) in c.points.iter().enumerate() {
        assert!((at - (20.0 * g as f64 + 9.5)).abs() < 1e-12 && (value - mean(&of(g))).abs() < 1e-12, "{g}: {at} {value}");
    }
    assert!(curve(&x[..199], &y).is_none());
}

#[test]
fn exact_words_of_a_curve() {
    let c = Curve { share: 0.374, p_value: 0.0, points: vec![(0.25, 0.0131), (1.5, -2e-4)] };
    let words = follows("speed (m/s)", &c);
    assert!(words.contains("; 37 % of") && words.ends_with("follows speed (m/s): 0.250→+1.31e-2, 1.500→-2.00e-4"), "{words}");
}
