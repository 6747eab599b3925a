//! verify: the tether's weights traced to an effect. In: Table 2.3. Out: residuals in speed of a tether of pure drag, and of one
//! that also has weight, against the reading errors.
//!
//! The thesis hung weights on the tether and read the tunnel speed that carried them. A tether of pure drag, `F = q (C_D S)`,
//! leaves a residual; the line's own weight, `F = q (C_D S) − W` (B.32), is the effect that it lacks. A second candidate of as
//! many numbers, drag along the line that grows with speed instead of its square (`F = q (C_D S) + k V`, Stokes), is fitted
//! beside it, so that the weight is named against a rival and not by default: it fits as well, but only with a pull of the
//! wrong sign.

use statrs::distribution::{ChiSquared, ContinuousCDF};
use windfall_pid::tether_fit::{DENSITY_SLUG_FT3, TABLE_2_3_LBF_FT_S};

/// Reading error of the tunnel speed, ft/s: the table's speeds are whole numbers, and the tunnel was set by hand.
pub const SPEED_ERROR_FT_S: f64 = 1.0;
/// Reading error of the weights, lbf: one in the last printed digit.
pub const WEIGHT_ERROR_LBF: f64 = 0.0001;

/// One tether model fitted to the measurements.
#[derive(Clone, Debug, PartialEq)]
pub struct TetherModel {
    /// What it has, in words.
    pub name: &'static str,
    /// (C_D S), ft².
    pub drag_area_ft2: f64,
    /// Second number: weight in lbf, or pull per speed in lbf s/ft; zero when the model has none.
    pub second: f64,
    /// Measured less predicted speed at each weight, ft/s.
    pub residual_ft_s: Vec<f64>,
    /// Sum of squared residuals over their variances.
    pub chi2: f64,
    /// Measurements less fitted numbers.
    pub degrees: usize,
    /// Probability of as much from reading errors alone.
    pub p_value: f64,
}

impl TetherModel {
    /// Largest residual, ft/s.
    #[must_use]
    pub fn worst_ft_s(&self) -> f64 {
        self.residual_ft_s.iter().fold(0.0, |m, r| m.max(r.abs()))
    }
}

/// What the five measurements say.
#[derive(Clone, Debug, PartialEq)]
pub struct TetherTrace {
    /// Declared: pure drag.
    pub before: TetherModel,
    /// With the line's weight.
    pub after: TetherModel,
    /// With the rival of as many numbers.
    pub rival: TetherModel,
    /// Probability that reading errors alone would let the weight explain so much (χ² of one degree).
    pub weight_p_value: f64,
    /// The same for the rival.
    pub rival_p_value: f64,
}

/// Traces Table 2.3 from a tether of pure drag; the reading errors are taken as standard deviations.
#[must_use]
pub fn tether_weights() -> TetherTrace {
    trace(&TABLE_2_3_LBF_FT_S, SPEED_ERROR_FT_S, WEIGHT_ERROR_LBF)
}

/// The same for other measurements (lbf, ft/s) and reading errors.
#[must_use]
pub fn trace(measured: &[(f64, f64)], speed_error_ft_s: f64, weight_error_lbf: f64) -> TetherTrace {
    let errors = (speed_error_ft_s, weight_error_lbf);
    let before = fit(measured, errors, "drag", |_| None);
    let after = fit(measured, errors, "drag and weight", |_| Some(-1.0));
    let rival = fit(measured, errors, "drag and a pull in proportion to speed", Some);
    let one = |m: &TetherModel| ChiSquared::new(1.0).map_or(1.0, |c| c.sf((before.chi2 - m.chi2).max(0.0)));
    TetherTrace { weight_p_value: one(&after), rival_p_value: one(&rival), before, after, rival }
}

fn q_lbf_ft2(v: f64) -> f64 {
    0.5 * DENSITY_SLUG_FT3 * v * v
}

/// Weighted least squares in speed: each force residual is divided by what both reading errors make of it at the fitted slope
/// dF/dV, iterated until the weights settle; predicted speeds solve the fitted force for V.
fn fit(measured: &[(f64, f64)], errors: (f64, f64), name: &'static str, second: impl Fn(f64) -> Option<f64>) -> TetherModel {
    let free = if second(1.0).is_some() { 2 } else { 1 };
    let (mut a, mut b) = (0.01, 0.0);
    let slope = |a: f64, b: f64, v: f64| {
        let h = 1e-3;
        let force = |v: f64| a * q_lbf_ft2(v) + b * second(v).unwrap_or(0.0);
        (force(v + h) - force(v - h)) / (2.0 * h)
    };
    for _ in 0..50 {
        let (mut aa, mut ab, mut bb, mut af, mut bf) = (0.0, 0.0, 0.0, 0.0, 0.0);
        for &(f, v) in measured {
            let w = 1.0 / ((slope(a, b, v) * errors.0).powi(2) + errors.1.powi(2));
            let (x, y) = (q_lbf_ft2(v), second(v).unwrap_or(0.0));
            (aa, ab, bb) = (aa + w * x * x, ab + w * x * y, bb + w * y * y);
            (af, bf) = (af + w * x * f, bf + w * y * f);
        }
        let det = aa * bb - ab * ab;
        (a, b) = if free == 2 { ((bb * af - ab * bf) / det, (aa * bf - ab * af) / det) } else { (af / aa, 0.0) };
    }
    let residual = |f: f64, v: f64| {
        let mut p = v;
        for _ in 0..50 {
            p -= (a * q_lbf_ft2(p) + b * second(p).unwrap_or(0.0) - f) / slope(a, b, p);
        }
        v - p
    };
    let residual_ft_s: Vec<f64> = measured.iter().map(|&(f, v)| residual(f, v)).collect();
    let chi2 = residual_ft_s
        .iter()
        .zip(measured)
        .map(|(r, &(_, v))| r * r / (errors.0.powi(2) + (errors.1 / slope(a, b, v)).powi(2)))
        .sum();
    let degrees = measured.len() - free;
    let p_value = ChiSquared::new(degrees as f64).map_or(1.0, |c| c.sf(chi2));
    TetherModel { name, drag_area_ft2: a, second: b, residual_ft_s, chi2, degrees, p_value }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pub_table_2_3_traces_to_the_lines_weight() {
        let t = tether_weights();
        // Thesis Table B.1: (C_D S)_tr 0.0140 ft², W_tr 0.0037 lb; weights by speed errors move the last printed digits.
        assert!((t.after.drag_area_ft2 - 0.0140).abs() < 0.0005, "{t:?}");
        assert!((t.after.second - 0.0037).abs() < 0.0005, "{t:?}");
        assert!(t.before.worst_ft_s() > SPEED_ERROR_FT_S && t.before.p_value < 0.01, "{t:?}");
        assert!(t.after.worst_ft_s() <= SPEED_ERROR_FT_S && t.after.p_value > 0.05, "{t:?}");
        assert!(t.weight_p_value < 0.001, "{t:?}");
        // The rival needs a pull against the stream, which no drag gives.
        assert!(t.rival.second < 0.0, "{t:?}");
    }

    #[test]
    fn law_nothing_is_traced_in_a_tether_of_pure_drag() {
        let exact: Vec<(f64, f64)> = [20.0, 25.0, 30.0, 35.0, 40.0].iter().map(|&v| (0.014 * q_lbf_ft2(v), v)).collect();
        let t = trace(&exact, 1.0, 1e-4);
        assert!(t.before.worst_ft_s() < 1e-9 && t.after.second.abs() < 1e-12 && t.weight_p_value > 0.99, "{t:?}");
    }
}
