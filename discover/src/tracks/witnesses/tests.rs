//! discover tests: factors of few runs.

use super::Witnesses;
use statrs::distribution::{ChiSquared, ContinuousCDF, FisherSnedecor};

/// A mean of eleven runs, and three numbers on one axis: Box's χ² against the F distribution that holds exactly there,
/// `n ln(1 + qF/ν)` being twice the gain. His next term is of
/// order 1/n², times the square of the gain: under a tenth of these probabilities.
#[test]
fn exact_f_of_few_runs() {
    let w = Witnesses { runs: 11, axes: 1 };
    for (known, tested, f) in [(0, 1, 17.2), (0, 1, 4.0), (0, 3, 12.5), (2, 1, 9.0)] {
        let (n, q, spare) = (11.0, f64::from(tested), 11.0 - f64::from(known + tested));
        let gain = n * (q * f / spare).ln_1p();
        let exact = FisherSnedecor::new(q, spare).expect("positive").sf(f);
        let box_1949 = ChiSquared::new(q).expect("positive").sf(gain * w.factor(known as usize, tested as usize));
        assert!((box_1949 / exact - 1.0).abs() < 0.1, "{known} {tested}: {box_1949} {exact}");
    }
}

/// `(n − p − q/2 − 1)/n` with 4/3 known and 2/3 tested numbers on each of three axes.
#[test]
fn pub_factor_of_three_axes() {
    let factor = Witnesses { runs: 11, axes: 3 }.factor(4, 2);
    assert!((factor - (11.0 - 4.0 / 3.0 - 1.0 / 3.0 - 1.0) / 11.0).abs() < 1e-15, "{factor}");
}
