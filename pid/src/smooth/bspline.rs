//! pid: B-splines of degree 7 on uniform knots with repeated ends. In: place. Out: the eight basis functions there, derivatives.
//!
//! de Boor, A Practical Guide to Splines, 2001, ch. IX-X. Knot interval 1, domain [0, intervals].

/// Degree: continuous to the sixth derivative, so the second derivative is itself a smooth quintic spline.
pub(super) const DEGREE: usize = 7;
/// Basis functions that are not zero at a place.
pub(super) const ORDER: usize = DEGREE + 1;

/// Reciprocals of knot differences 0..=7 (the first is never used).
const RECIPROCAL: [f64; ORDER] = [0.0, 1.0, 1.0 / 2.0, 1.0 / 3.0, 1.0 / 4.0, 1.0 / 5.0, 1.0 / 6.0, 1.0 / 7.0];

/// Uniform knots with the ends repeated.
#[derive(Clone, Copy, Debug)]
pub(super) struct Knots {
    /// Number of intervals.
    pub(super) intervals: usize,
}

impl Knots {
    /// Number of coefficients.
    pub(super) fn count(self) -> usize {
        self.intervals + DEGREE
    }
    /// The interval that holds x, which is also the first coefficient that acts there.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "x is in [0, intervals]")]
    pub(super) fn interval(self, x: f64) -> usize {
        (x as usize).min(self.intervals - 1)
    }
    fn knot(self, index: usize) -> usize {
        index.saturating_sub(DEGREE).min(self.intervals)
    }
    fn reciprocal(self, from: usize, to: usize) -> f64 {
        RECIPROCAL[self.knot(to) - self.knot(from)]
    }
    /// Values of the eight functions at x in `interval`.
    pub(super) fn values(self, interval: usize, x: f64) -> [f64; ORDER] {
        let mut n = [0.0; ORDER];
        self.climb(&mut n, interval, x, DEGREE);
        n
    }
    /// Cox-de Boor recursion up to `degree` (n has degree + 1 values in use).
    fn climb(self, n: &mut [f64; ORDER], interval: usize, x: f64, degree: usize) {
        let i = interval + DEGREE;
        n[0] = 1.0;
        for j in 1..=degree {
            let mut saved = 0.0;
            for (r, value) in n[..j].iter_mut().enumerate() {
                let (low, high) = (i + r + 1 - j, i + r + 1);
                let share = *value * self.reciprocal(low, high);
                *value = saved + (self.knot(high) as f64 - x) * share;
                saved = (x - self.knot(low) as f64) * share;
            }
            n[j] = saved;
        }
    }
    /// Derivative of the functions of degree q from what those of degree q − 1 give.
    fn derive(self, lower: [f64; ORDER], interval: usize, q: usize) -> [f64; ORDER] {
        let i = interval + DEGREE;
        let mut out = [0.0; ORDER];
        for (r, o) in out.iter_mut().enumerate().take(q + 1) {
            let j = i + r - q;
            let left = if r > 0 { lower[r - 1] * self.reciprocal(j, j + q) } else { 0.0 };
            let right = if r < q { lower[r] * self.reciprocal(j + 1, j + q + 1) } else { 0.0 };
            *o = q as f64 * (left - right);
        }
        out
    }
    /// First and second derivatives (per knot interval) of the eight functions at x.
    pub(super) fn slopes(self, interval: usize, x: f64) -> [[f64; ORDER]; 2] {
        let mut below = [[0.0; ORDER]; 2];
        self.climb(&mut below[0], interval, x, DEGREE - 1);
        self.climb(&mut below[1], interval, x, DEGREE - 2);
        let first = self.derive(below[0], interval, DEGREE);
        let second = self.derive(self.derive(below[1], interval, DEGREE - 1), interval, DEGREE);
        [first, second]
    }
}
