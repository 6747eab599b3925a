//! discover tests: chances against the exponential tail of two degrees of freedom and the binomial law.

use super::*;

/// χ² of two degrees has the tail e^(−x/2), and the best of n independent tries does as well as one does with 1 − (1 − p)ⁿ: of none
/// never, of what is certain always. To rounding of the incomplete gamma function.
#[test]
fn exact_best_of_several() {
    for (x, tried) in [(3.1_f64, 1), (5.7, 3), (0.4, 11)] {
        let none = (0..tried).map(|_| 1.0 - (-0.5 * x).exp()).product::<f64>();
        let p = p_value(x, 2, tried);
        assert!((p - (1.0 - none)).abs() < 1e-12, "{p} {none}");
    }
    let near = |a: f64, b: f64| (a - b).abs() < 1e-15;
    assert!(near(p_value_of_best(1.0, 0), 0.0) && near(p_value_of_best(1.0, 3), 1.0));
    let line = |p_value| ChannelResidual { channel: String::new(), rms: 1.0, expected_rms: 1.0, p_value };
    assert!(near(p_least(&[line(0.3), line(0.1), line(0.7)]), 0.271) && near(p_least(&[]), 0.0));
}
