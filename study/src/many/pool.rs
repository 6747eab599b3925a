//! study: one number measured by several campaigns. In: estimates with standard errors. Out: mean and spread between campaigns.
//!
//! The random-effects model y_i = μ + u_i + e_i: u_i normal of variance τ² between campaigns, e_i normal of the standard error s_i that its
//! campaign states, which is taken as known. Estimates of one campaign's different parameters are pooled one by one.

use serde::{Deserialize, Serialize};
use statrs::distribution::{ChiSquared, ContinuousCDF, StudentsT};
use statrs::function::erf::erfc;
use std::f64::consts::SQRT_2;

/// Mean and spread of one number over campaigns, in the number's unit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Pooled {
    /// Number of campaigns, two or more.
    pub n: usize,
    /// Mean over campaigns, weights 1/(s_i² + τ²).
    pub mean: f64,
    /// Its standard error (Hartung and Knapp 2001; never below that of known weights, as Knapp and Hartung 2003 propose).
    pub std_error: f64,
    /// Its 95 % interval, Student with n − 1 degrees of freedom (Hartung and Knapp 2001).
    pub ci95: [f64; 2],
    /// Standard deviation between campaigns: that with which Q is n − 1 (Paule and Mandel 1982), zero where it is less without.
    pub tau: f64,
    /// Its 95 % interval by the profile of Q (Viechtbauer 2007).
    pub tau_ci95: [f64; 2],
    /// Where the number of one more campaign lies with 95 %, its own error left out: over the confidence distribution of τ (Nagashima, Noma
    /// and Furukawa 2019), here that of the profile of Q, and the mean's error with each; never inside the mean's own interval; none of two campaigns.
    pub prediction95: Option<[f64; 2]>,
    /// Heterogeneity: Σ (y_i − ȳ)²/s_i² about the mean of weights 1/s_i² (Cochran 1954).
    pub q: f64,
    /// Chance of as large a Q where campaigns differ by their stated errors alone: chi-squared, n − 1 degrees of freedom.
    pub p_value: f64,
}

/// Pools estimates with standard errors; none of fewer than two, or where one is not finite or an error not above zero.
///
/// ```
/// use windfall_study::many::pool;
/// // Equal errors: τ² is the estimates' variance less the square of the error, 4 − 3.
/// let p = pool(&[(8.0, 3_f64.sqrt()), (10.0, 3_f64.sqrt()), (12.0, 3_f64.sqrt())]).unwrap();
/// assert!((p.mean - 10.0).abs() < 1e-12 && (p.tau - 1.0).abs() < 1e-9);
/// ```
#[must_use]
pub fn pool(estimates: &[(f64, f64)]) -> Option<Pooled> {
    let sound = |(y, s): &(f64, f64)| y.is_finite() && s.is_finite() && *s > 0.0;
    let n = estimates.len();
    if n < 2 || !estimates.iter().all(sound) {
        return None;
    }
    // In units of the largest error or distance, about the first estimate: figures lose nothing to a large mean or a small unit.
    let origin = estimates[0].0;
    let unit = estimates.iter().map(|(y, s)| (y - origin).abs().max(*s)).fold(0.0, f64::max);
    let all = Sample(estimates.iter().map(|(y, s)| [(y - origin) / unit, (s / unit).powi(2)]).collect());
    let free = (n - 1) as f64;
    // Q is then what is expected of it.
    let tau2 = all.where_q_is(free);
    let at = all.at(tau2);
    let std_error = (at.q / free).max(1.0).sqrt() * at.weights.sqrt().recip();
    let reach = StudentsT::new(0.0, 1.0, free).ok()?.inverse_cdf(0.975) * std_error;
    let chi = ChiSquared::new(free).ok()?;
    let q = all.at(0.0).q;
    let ci95 = [-1.0, 1.0].map(|side| origin + unit * (at.mean + side * reach));
    let next = || all.next(&chi).map(|x| origin + unit * x);
    Some(Pooled {
        n,
        mean: origin + unit * at.mean,
        std_error: unit * std_error,
        ci95,
        tau: unit * tau2.sqrt(),
        tau_ci95: [0.975, 0.025].map(|p| unit * all.where_q_is(chi.inverse_cdf(p)).sqrt()),
        prediction95: (n > 2).then(next).map(|[low, high]| [low.min(ci95[0]), high.max(ci95[1])]),
        q,
        p_value: chi.sf(q),
    })
}

/// Estimates with the squares of their errors.
struct Sample(Vec<[f64; 2]>);

/// Sums at a variance between campaigns; weights w = 1/(s² + τ²).
struct At {
    /// Σw.
    weights: f64,
    /// Weighted mean.
    mean: f64,
    /// Q = Σw(y − mean)².
    q: f64,
}

/// Quantiles by which the confidence distribution of τ² is taken, evenly in probability.
const QUANTILES: u32 = 100;

impl Sample {
    fn at(&self, tau2: f64) -> At {
        let (weights, sum) = self.0.iter().fold((0.0, 0.0), |(n, x), [y, s2]| (n + 1.0 / (s2 + tau2), x + y / (s2 + tau2)));
        let mean = sum / weights;
        At { weights, mean, q: self.0.iter().map(|[y, s2]| (y - mean) * (y - mean) / (s2 + tau2)).sum() }
    }
    /// Largest distance of two estimates, squared.
    fn range2(&self) -> f64 {
        let ends = self.0.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], [y, _]| [a.min(*y), b.max(*y)]);
        (ends[1] - ends[0]).powi(2)
    }
    /// τ² at which Q = Σw(y − mean)², which falls with τ², has come down to this; zero where it begins below.
    fn where_q_is(&self, wanted: f64) -> f64 {
        let beyond = |t: f64| self.at(t).q - wanted;
        if beyond(0.0) <= 0.0 {
            return 0.0;
        }
        // Σ(y − mean)² ≤ n·range², so that Q is below what is wanted from here on.
        bisect([0.0, self.0.len() as f64 * self.range2() / wanted], beyond)
    }
    /// Ends between which one more draw of the distribution between campaigns lies with 95 %: a mixture of normals, one for each quantile of
    /// τ², of variance τ² + 1/Σw about the mean of these weights.
    fn next(&self, chi: &ChiSquared) -> [f64; 2] {
        let one = |k: u32| {
            let tau2 = self.where_q_is(chi.inverse_cdf((f64::from(k) + 0.5) / f64::from(QUANTILES)));
            let at = self.at(tau2);
            [at.mean, (tau2 + 1.0 / at.weights).sqrt()]
        };
        let normals: Vec<[f64; 2]> = (0..QUANTILES).map(one).collect();
        let below = |x: f64| normals.iter().map(|[mean, std]| 0.5 * erfc((mean - x) / (std * SQRT_2))).sum::<f64>();
        let ends = normals
            .iter()
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], [mean, std]| [a.min(mean - 8.0 * std), b.max(mean + 8.0 * std)]);
        [0.025, 0.975].map(|p| bisect(ends, |x| p * f64::from(QUANTILES) - below(x)))
    }
}

/// Root of a function that is positive at the first end and not at the second, to 1e-12 of the ends' size.
fn bisect([mut low, mut high]: [f64; 2], f: impl Fn(f64) -> f64) -> f64 {
    let least = 1e-30 * (high - low);
    while high - low > (1e-12 * low.abs().max(high.abs())).max(least) {
        let middle = 0.5 * (low + high);
        if f(middle) > 0.0 { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng as _;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution as _, StandardNormal};

    /// BCG vaccine against tuberculosis, thirteen trials: cases and others among vaccinated, cases and others among controls (Colditz et
    /// al. 1994, as table 1 of Viechtbauer 2010 prints them).
    const BCG: [[f64; 4]; 13] = [
        [4.0, 119.0, 11.0, 128.0],
        [6.0, 300.0, 29.0, 274.0],
        [3.0, 228.0, 11.0, 209.0],
        [62.0, 13_536.0, 248.0, 12_619.0],
        [33.0, 5036.0, 47.0, 5761.0],
        [180.0, 1361.0, 372.0, 1079.0],
        [8.0, 2537.0, 10.0, 619.0],
        [505.0, 87_886.0, 499.0, 87_892.0],
        [29.0, 7470.0, 45.0, 7232.0],
        [17.0, 1699.0, 65.0, 1600.0],
        [186.0, 50_448.0, 141.0, 27_197.0],
        [5.0, 2493.0, 3.0, 2338.0],
        [27.0, 16_886.0, 29.0, 17_825.0],
    ];

    /// Viechtbauer 2010 (Journal of Statistical Software 36, number 3), section 3, prints Q, the interval of τ² by the profile of Q and, with
    /// τ² = 0.3132 of the restricted likelihood, the mean with the standard error of known weights. The tolerance is half the last digit.
    #[test]
    fn pub_bcg_vaccine_trials() {
        let one = |[a, b, c, d]: [f64; 4]| {
            let risk = (a / (a + b)).ln() - (c / (c + d)).ln();
            (risk, (1.0 / a - 1.0 / (a + b) + 1.0 / c - 1.0 / (c + d)).sqrt())
        };
        let estimates = BCG.map(one);
        let p = pool(&estimates).expect("thirteen sound estimates");
        let at = Sample(estimates.map(|(y, s)| [y, s * s]).to_vec()).at(0.3132);
        let printed = [
            ("mean", at.mean, -0.7145),
            ("standard error", at.weights.sqrt().recip(), 0.1798),
            ("Q", p.q, 152.2330),
            ("tau2, lower", p.tau_ci95[0].powi(2), 0.1197),
            ("tau2, upper", p.tau_ci95[1].powi(2), 1.1115),
        ];
        for (what, x, text) in printed {
            assert!((x - text).abs() <= 0.5001e-4, "{what}: {x}, printed {text}");
        }
        // The empirical Bayes estimate is the same; 0.3181 is what the author's program metafor prints of it.
        assert!(p.p_value < 1e-4 && (p.tau.powi(2) - 0.3181).abs() < 0.5001e-4, "{p:?}");
    }

    /// Equal errors s: Q is n − 1 where τ² = variance − s², and the mean's error is
    /// the scatter over √n; Student's 97.5 % point of two degrees of freedom is 4.302653.
    #[test]
    fn exact_equal_errors() {
        let p = pool(&[(9.0, 1.0), (11.0, 1.0), (16.0, 1.0)]).expect("sound");
        assert!((p.mean - 12.0).abs() < 1e-12 && (p.tau - 12_f64.sqrt()).abs() < 1e-7, "{p:?}");
        let error = 13_f64.sqrt() / 3_f64.sqrt();
        assert!((p.std_error - error).abs() < 1e-7 && (p.ci95[1] - 12.0 - 4.302_653 * error).abs() < 1e-5, "{p:?}");
        assert!((p.ci95[0] - 12.0 + 4.302_653 * error).abs() < 1e-5, "{p:?}");
        assert!((p.q - 26.0).abs() < 1e-12 && (p.p_value - (-13_f64).exp()).abs() < 1e-15, "chi-squared of two is exp(−q/2)");
    }

    /// Errors that are nothing beside the spread: one more draw of a normal lies within Student's t·S·√(1 + 1/n) of the mean (any textbook);
    /// 2.364624 of seven degrees of freedom. τ² by 100 quantiles leaves out the last half percent at either end: 1 % is allowed.
    #[test]
    fn exact_one_more_campaign_without_errors() {
        let p = pool(&[1.0, 2.0, 4.0, 4.0, 5.0, 7.0, 8.0, 9.0].map(|y| (y, 1e-6))).expect("sound");
        let reach = 2.364_624 * (56_f64 / 7.0 * 1.125).sqrt();
        let [low, high] = p.prediction95.expect("of eight");
        assert!((high - 5.0 - reach).abs() < 0.01 * reach && (low - 5.0 + reach).abs() < 0.01 * reach, "{p:?}, {reach}");
    }

    /// Campaigns that agree better than their errors: no spread, and an interval that does not shrink to nothing.
    #[test]
    fn exact_agreeing_estimates() {
        let p = pool(&[(5.0, 0.2), (5.0, 0.2)]).expect("sound");
        assert!(p.tau.abs() < 1e-300 && (p.std_error - 0.2 / 2_f64.sqrt()).abs() < 1e-15 && p.prediction95.is_none(), "{p:?}");
        for bad in
            [&[(1.0, 0.1)][..], &[(1.0, 0.1), (2.0, 0.0)], &[(1.0, 0.1), (f64::NAN, 0.1)], &[(1.0, 0.1), (2.0, f64::INFINITY)]]
        {
            assert!(pool(bad).is_none(), "{bad:?}");
        }
    }

    /// Another origin and unit change the numbers as they must.
    #[test]
    fn law_origin_and_unit_are_free() {
        let some = [(1.0, 0.3), (2.5, 0.1), (1.7, 0.4), (0.2, 0.2)];
        let (p, other) = (pool(&some).expect("sound"), pool(&some.map(|(y, s)| (1e-9 * y - 3e-6, 1e-9 * s))).expect("sound"));
        // What is subtracted, 3e-6, costs its rounding: 4e-22 of 1e-9.
        assert!((1e-9 * p.mean - 3e-6 - other.mean).abs() < 1e-20 && (1e-9 * p.tau - other.tau).abs() < 1e-20);
    }

    /// How often each interval holds what was drawn: mean, spread, one more campaign; and how often p < 0.05.
    fn held(tau: f64, draws: u32) -> [f64; 4] {
        let mut chance = ChaCha8Rng::seed_from_u64(7);
        let mut counts = [0.0; 4];
        for _ in 0..draws {
            let mut campaign = |error: f64| {
                let [u, e]: [f64; 2] = [StandardNormal.sample(&mut chance), StandardNormal.sample(&mut chance)];
                10.0 + tau * u + error * e
            };
            let errors = [0.3, 0.4, 0.5, 0.6, 0.8, 1.0, 1.2, 1.5];
            let estimates = errors.map(|s| (campaign(s), s));
            let next = campaign(0.0);
            let p = pool(&estimates).expect("sound");
            let within = |[a, b]: [f64; 2], x: f64| f64::from(u8::from(a <= x && x <= b));
            let each = [
                within(p.ci95, 10.0),
                within(p.tau_ci95, tau),
                p.prediction95.map_or(0.0, |i| within(i, next)),
                f64::from(u8::from(p.p_value < 0.05)),
            ];
            counts.iter_mut().zip(each).for_each(|(c, x)| *c += x);
        }
        counts.map(|c| c / f64::from(draws))
    }

    /// Drawn with a known spread τ = 1 and without one. A rate over 4000 draws is known to √(0.95·0.05/4000) = 0.0034: bounds are four of
    /// them. τ's interval and p are exact. The mean's interval is exact for equal errors only, that of one more campaign where τ is large
    /// beside the errors: 0.01 more is allowed (measured 0.938 and 0.943); without spread the mean's holds more, as no error below that of
    /// known weights is stated (measured 0.987).
    #[test]
    fn recover_intervals_hold_what_was_drawn() {
        let bound = 4.0 * (0.95 * 0.05 / 4000_f64).sqrt();
        let [mean, tau, next, _] = held(1.0, 4000);
        assert!((mean - 0.95).abs() < bound + 0.01, "mean {mean}");
        assert!((tau - 0.95).abs() < bound, "tau {tau}");
        assert!((next - 0.95).abs() < bound + 0.01, "next {next}");
        let [mean, _, _, alarms] = held(0.0, 4000);
        assert!(mean > 0.95 - bound, "mean without spread {mean}");
        assert!((alarms - 0.05).abs() < bound, "p < 0.05 without spread {alarms}");
    }

    /// Two campaigns of equal errors s at a distance d: Q = d²/2/(s² + τ²), so that τ² = d²/(2χ²) − s²; chi-squared of one degree of freedom is
    /// below 0.000982069 with 2.5 %. And three, the first in the middle: τ² = 16 − 1, whatever the order.
    #[test]
    fn exact_spread_of_two_and_of_three_from_the_middle() {
        let p = pool(&[(3.0, 0.5), (7.0, 0.5)]).expect("sound");
        let upper = 8.0 / 0.000_982_069_117 - 0.25;
        assert!((p.tau_ci95[1].powi(2) / upper - 1.0).abs() < 1e-7 && (p.tau.powi(2) - 7.75).abs() < 1e-9, "{p:?}");
        let p = pool(&[(12.0, 1.0), (8.0, 1.0), (16.0, 1.0)]).expect("sound");
        assert!((p.tau.powi(2) - 15.0).abs() < 1e-9, "{p:?}");
    }

    /// A first campaign that knows little, far from two that agree: its weight is nothing beside theirs, so that Q is that of the two,
    /// d²/(2s²) = 4.5, and (y₁ − mean)²/s₁² = 1/25. What two numbers near 1 lose at a distance of 3e-8 is 1e-8 of it.
    #[test]
    fn exact_heterogeneity_beside_a_far_campaign() {
        let p = pool(&[(0.0, 5.0), (1.0, 1e-8), (1.0 + 3e-8, 1e-8)]).expect("sound");
        assert!((p.q - 4.54).abs() < 1e-6, "{}", p.q);
    }
}
