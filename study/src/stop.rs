//! study: how well a study knows its asked-for quantity. In: rows in parts. Out: an estimate with its interval, and whether it is
//! enough.

use statrs::distribution::{Beta, ContinuousCDF, StudentsT};
use windfall_model::study::{CellKind, Row, StopRule};

/// Half of what the 95 % interval leaves out.
const TAIL: f64 = 0.025;

/// Count, mean and scatter of numbers, or count and hits of flags.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moments {
    /// Numbers.
    pub n: u64,
    /// Their mean.
    pub mean: f64,
    /// Sum of squared deviations from the mean.
    pub m2: f64,
}

impl Moments {
    /// Adds one number (Welford 1962).
    pub fn push(&mut self, x: f64) {
        self.n += 1;
        let d = x - self.mean;
        self.mean += d / self.n as f64;
        self.m2 += d * (x - self.mean);
    }
    /// Adds what came after (Chan, Golub and LeVeque 1983).
    pub fn add(&mut self, other: &Self) {
        if other.n == 0 {
            return;
        }
        let n = (self.n + other.n) as f64;
        let d = other.mean - self.mean;
        self.m2 += other.m2 + d * d * (self.n as f64 * other.n as f64 / n);
        self.mean += d * (other.n as f64 / n);
        self.n += other.n;
    }
    /// Standard deviation, n − 1 in its denominator; none of fewer than two.
    #[must_use]
    pub fn std(&self) -> Option<f64> {
        (self.n > 1).then(|| (self.m2 / (self.n - 1) as f64).sqrt())
    }
    /// 95 % interval of the mean by Student's t; none of fewer than two numbers.
    #[must_use]
    pub fn mean_ci95(&self) -> Option<[f64; 2]> {
        let half =
            self.std()? / (self.n as f64).sqrt() * StudentsT::new(0.0, 1.0, (self.n - 1) as f64).ok()?.inverse_cdf(1.0 - TAIL);
        Some([self.mean - half, self.mean + half])
    }
    /// 95 % interval: of the mean, or of the rate when the numbers are flags.
    #[must_use]
    pub fn ci95(&self, kind: CellKind) -> Option<[f64; 2]> {
        match kind {
            CellKind::Number => self.mean_ci95(),
            CellKind::Flag => (self.n > 0).then(|| clopper_pearson(self.hits(), self.n)),
            CellKind::Word => None,
        }
    }
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a whole number of hits, at most n")]
    fn hits(&self) -> u64 {
        (self.mean * self.n as f64).round() as u64
    }
}

/// 95 % interval of a rate of which `hits` of `n` were seen (Clopper and Pearson 1934): covers at least 95 % whatever the rate.
#[must_use]
pub fn clopper_pearson(hits: u64, n: u64) -> [f64; 2] {
    let quantile = |a: u64, b: u64, p: f64| Beta::new(a as f64, b as f64).map_or(f64::NAN, |d| d.inverse_cdf(p));
    let low = if hits == 0 { 0.0 } else { quantile(hits, n - hits + 1, TAIL) };
    let high = if hits >= n { 1.0 } else { quantile(hits + 1, n - hits, 1.0 - TAIL) };
    [low, high]
}

/// The asked-for quantity over whole parts in the order of their index, so that when a study ends depends on nothing else.
#[derive(Clone, Debug)]
pub struct Progress {
    stop: StopRule,
    place: usize,
    kind: CellKind,
    moments: Moments,
    draws: u64,
}

impl Progress {
    /// Nothing seen yet; `place` and `kind` are those of the rule's column.
    #[must_use]
    pub fn new(stop: StopRule, place: usize, kind: CellKind) -> Self {
        Self { stop, place, kind, moments: Moments::default(), draws: 0 }
    }
    /// What a part says of the quantity; its rows sorted by draw.
    #[must_use]
    pub fn of_part(&self, rows: &[Row]) -> Moments {
        let mut m = Moments::default();
        rows.iter().filter_map(|r| r.cells.get(self.place)?.number()).for_each(|x| m.push(x));
        m
    }
    /// Adds the next part; true when the study may end with it.
    pub fn add(&mut self, part: &Moments, draws: u64) -> bool {
        self.moments.add(part);
        self.draws += draws;
        let half = self.moments.ci95(self.kind).map_or(f64::INFINITY, |[a, b]| 0.5 * (b - a));
        self.draws >= self.stop.least_draws && half <= self.stop.half_width
    }
    /// Estimate and interval so far.
    #[must_use]
    pub fn seen(&self) -> (f64, Option<[f64; 2]>) {
        (self.moments.mean, self.moments.ci95(self.kind))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// With no hits the upper end solves (1 − p)ⁿ = 0.025; by symmetry all hits give the mirror image. The library's inverse is
    /// good to 1e-9 or so; a wrong tail or parameter is off by percents.
    #[test]
    fn exact_clopper_pearson_in_closed_form() {
        for n in [1_u64, 10, 400] {
            let end = 1.0 - 0.025_f64.powf(1.0 / n as f64);
            let ([a, b], [c, d]) = (clopper_pearson(0, n), clopper_pearson(n, n));
            assert!(a == 0.0 && d >= 1.0 && (b - end).abs() < 1e-8 && (c - (1.0 - end)).abs() < 1e-8, "{n}: {b} {c} {end}");
        }
    }

    /// Interval of 81 in 263 as published: [0.2527, 0.3676] (Newcombe 1998, Table I, method 5, exact).
    #[test]
    fn pub_clopper_pearson_of_newcombe() {
        let [a, b] = clopper_pearson(81, 263);
        assert!((a - 0.2527).abs() < 6e-5 && (b - 0.3676).abs() < 6e-5, "{a} {b}");
    }

    #[test]
    fn law_moments_of_parts_are_moments_of_all() {
        let x: Vec<f64> = (0..100).map(|i| f64::from(i * i % 37) - 5.0).collect();
        let of = |x: &[f64]| {
            let mut m = Moments::default();
            x.iter().for_each(|v| m.push(*v));
            m
        };
        let mut joined = of(&x[..30]);
        joined.add(&of(&x[30..]));
        let whole = of(&x);
        assert!(joined.n == whole.n && (joined.mean - whole.mean).abs() < 1e-13 && (joined.m2 / whole.m2 - 1.0).abs() < 1e-13);
    }

    /// Student's interval of 1, 2, 3: t(2) = 4.302653, s = 1.
    #[test]
    fn exact_interval_of_three_numbers() {
        let mut m = Moments::default();
        [1.0, 2.0, 3.0].iter().for_each(|x| m.push(*x));
        let [a, b] = m.mean_ci95().expect("three numbers");
        let half = 4.302_653 / 3.0_f64.sqrt();
        assert!((a - (2.0 - half)).abs() < 1e-6 && (b - (2.0 + half)).abs() < 1e-6);
    }

    /// The same interval, in two parts, ends a study where half of it is little enough and draws are many enough.
    #[test]
    fn exact_end_of_a_study() {
        let part = |x: &[f64]| {
            let mut m = Moments::default();
            x.iter().for_each(|x| m.push(*x));
            m
        };
        for (half_width, least_draws, ends) in [(2.485, 7, true), (2.484, 7, false), (2.485, 8, false)] {
            let stop = StopRule { column: "x".to_owned(), half_width, least_draws };
            let mut progress = Progress::new(stop, 0, CellKind::Number);
            assert!(!progress.add(&part(&[3.0]), 3));
            assert_eq!(progress.add(&part(&[1.0, 2.0]), 4), ends, "{half_width} {least_draws}");
        }
    }
}
