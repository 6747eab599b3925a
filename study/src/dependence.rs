//! study: what right answers of closings hang on. In: whether each draw was right, and what was varied. Out: for every varied quantity how
//! strongly right and wrong draws differ in it, and the share of right ones over it.

use super::reliability::ReliabilityPoint;
use serde::{Deserialize, Serialize};

/// Intervals of equal count of a varied quantity; a quantity with no more values has each by itself.
const INTERVALS: usize = 6;
/// Fewest draws of which anything is said.
const LEAST: usize = 12;

/// How right answers hang on one varied quantity.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DependenceLine {
    /// Key that is varied.
    pub name: String,
    /// Score of Mann and Whitney (1947) in standard deviations: above zero where right draws have the larger values; beyond ±2 by chance in
    /// one of twenty quantities. None where all draws are right, or none is.
    pub score: Option<f64>,
    /// Mean value of each interval, in ascending order.
    pub values: Vec<f64>,
    /// Share of right draws in it; `stated` is that of all draws.
    pub shares: Vec<ReliabilityPoint>,
}

/// The line of a quantity; draws without a number are left out. None of few draws, or where nothing differs.
pub(super) fn dependence(name: &str, values: &[Option<f64>], right: &[Option<bool>]) -> Option<DependenceLine> {
    let mut all: Vec<(f64, bool)> = values.iter().zip(right).filter_map(|(v, r)| Some(((*v)?, (*r)?))).collect();
    all.retain(|(v, _)| v.is_finite());
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    let groups: Vec<&[(f64, bool)]> = all.chunk_by(|a, b| a.0.total_cmp(&b.0).is_eq()).collect();
    if all.len() < LEAST || groups.len() < 2 {
        return None;
    }
    let few = groups.len() <= INTERVALS;
    let intervals = if few { groups.clone() } else { all.chunks(all.len().div_ceil(INTERVALS)).collect() };
    let count = |of: &[(f64, bool)]| of.iter().filter(|p| p.1).count() as u64;
    let whole = count(&all) as f64 / all.len() as f64;
    Some(DependenceLine {
        name: name.to_owned(),
        score: score(&groups),
        values: intervals.iter().map(|g| g.iter().map(|p| p.0).sum::<f64>() / g.len() as f64).collect(),
        shares: intervals.iter().map(|g| ReliabilityPoint::new(whole, count(g), g.len() as u64)).collect(),
    })
}

/// Ranks of right draws less what chance has, over their standard deviation with its correction for equal values.
fn score(groups: &[&[(f64, bool)]]) -> Option<f64> {
    let (mut before, mut ranks, mut right, mut ties) = (0.0, 0.0, 0.0, 0.0);
    for g in groups {
        let (n, own) = (g.len() as f64, g.iter().filter(|p| p.1).count() as f64);
        ranks += own * (before + 0.5 * (n + 1.0));
        right += own;
        before += n;
        ties += n * (n * n - 1.0);
    }
    let (n, wrong) = (before, before - right);
    let variance = right * wrong / 12.0 * (n + 1.0 - ties / (n * (n - 1.0)));
    (variance > 0.0).then(|| (ranks - 0.5 * right * (n + 1.0)) / variance.sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Twelve draws, the six larger ones right: U = 36 of a mean of 18 and a variance of 6·6·13/12 = 39, so a score of 18/√39; intervals of
    /// two. Turned about, the sign turns.
    #[test]
    fn exact_right_where_large() {
        let values: Vec<Option<f64>> = (0..12).map(|k| Some(f64::from(k))).chain([None, Some(f64::NAN)]).collect();
        let right: Vec<Option<bool>> = (0..12).map(|k| Some(k >= 6)).chain([Some(true), Some(true)]).collect();
        let line = dependence("mass", &values, &right).expect("a line");
        assert!((line.score.expect("both") - 18.0 / 39.0_f64.sqrt()).abs() < 1e-12, "{:?}", line.score);
        let counts: Vec<(u64, u64)> = line.shares.iter().map(|s| (s.count, s.of)).collect();
        assert_eq!(counts, [(0, 2), (0, 2), (0, 2), (2, 2), (2, 2), (2, 2)]);
        assert_eq!(line.values, [0.5, 2.5, 4.5, 6.5, 8.5, 10.5]);
        let turned: Vec<Option<f64>> = values.iter().map(|v| v.map(|x| -x)).collect();
        assert!(dependence("mass", &turned, &right).expect("a line").score.expect("both") < -2.0);
    }

    /// Two values, each its own interval: with 3 of 6 right in both, nothing hangs on it.
    #[test]
    fn exact_two_values_and_no_dependence() {
        let values: Vec<Option<f64>> = (0..12).map(|k| Some(if k < 6 { 1.0 } else { 2.0 })).collect();
        let right: Vec<Option<bool>> = (0..12).map(|k| Some(k % 2 == 0)).collect();
        let line = dependence("rate", &values, &right).expect("a line");
        assert!(line.score.expect("both").abs() < 1e-12 && line.values == [1.0, 2.0]);
        assert!(dependence("rate", &values[..6], &right[..6]).is_none(), "too few");
        let same = vec![Some(1.0); 12];
        assert!(dependence("rate", &same, &right).is_none());
        assert_eq!(dependence("rate", &values, &[Some(true); 12]).expect("a line").score, None);
    }

    /// With ties: each draw has the mean rank of its value, and the right ones' sum of ranks has, over all ways to choose as many draws, the
    /// mean n₁(n + 1)/2 and the variance n₁n₀/(n(n − 1))·Σ(rank − mean)² of drawing without replacement (any textbook of sampling).
    #[test]
    fn exact_score_with_ties() {
        let values = [1.0, 1.0, 1.0, 2.0, 3.0, 3.0, 4.0, 4.0, 4.0, 4.0, 4.0, 5.0, 6.0];
        let right = [false, true, false, false, false, true, false, true, true, true, false, true, true];
        let rank = |v: f64| {
            let below = values.iter().filter(|x| **x < v).count() as f64;
            let same = values.iter().filter(|x| x.total_cmp(&v).is_eq()).count() as f64;
            below + f64::midpoint(same, 1.0)
        };
        let n = 13.0;
        let own = right.iter().filter(|r| **r).count() as f64;
        let sum: f64 = values.iter().zip(right).filter(|(_, r)| *r).map(|(v, _)| rank(*v)).sum();
        let squares: f64 = values.iter().map(|v| (rank(*v) - 7.0).powi(2)).sum();
        let by_hand = (sum - own * 7.0) / (own * (n - own) / (n * (n - 1.0)) * squares).sqrt();
        let line = dependence("mass", &values.map(Some), &right.map(Some)).expect("a line");
        assert!((line.score.expect("both") - by_hand).abs() < 1e-12, "{:?} {by_hand}", line.score);
    }
}
