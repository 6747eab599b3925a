//! likelihood: how strong gusts are along a run. In: logarithms at knots. Out: the variance of an axis' gusts over its mean at any time.

/// Time between knots, s: half the pitch mode's period.
pub(crate) const KNOT_S: f64 = 0.5;

/// Variance of a run's gusts over its mean, by axis: logarithms at knots; one where there are none.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Intensity {
    pub(crate) logs: [Vec<f64>; 3],
}

/// Knot before a time and the share of the way to the next.
pub(crate) fn place(t_s: f64, knots: usize) -> (usize, f64) {
    let at = (t_s / KNOT_S).clamp(0.0, (knots - 1) as f64);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between zero and the number of knots")]
    let k = (at as usize).min(knots.saturating_sub(2));
    (k, at - k as f64)
}

impl Intensity {
    /// Variance over its mean of an axis' gusts.
    pub(crate) fn at(&self, axis: usize, t_s: f64) -> f64 {
        let logs = &self.logs[axis];
        if logs.len() < 2 {
            return 1.0;
        }
        let (k, share) = place(t_s, logs.len());
        ((1.0 - share) * logs[k] + share * logs[k + 1]).exp()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Logarithms along straight lines between knots; before the first and after the last those.
    #[test]
    fn exact_between_knots_and_beyond() {
        let intensity = Intensity { logs: [vec![], vec![0.3, -0.7, 1.9], vec![0.4]] };
        let of = |t_s| intensity.at(1, t_s).ln();
        for (t_s, log) in [(-3.0, 0.3), (0.0, 0.3), (0.2, -0.1), (0.6, -0.18), (0.95, 1.64), (1.0, 1.9), (1.4, 1.9), (50.0, 1.9)]
        {
            assert!((of(t_s) - log).abs() < 1e-14, "{t_s}: {}", of(t_s));
        }
        assert!([0, 2].map(|axis| intensity.at(axis, 0.3)).iter().all(|v| (v - 1.0).abs() < 1e-15));
    }
}
