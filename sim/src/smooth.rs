//! sim: a smooth function of time through uniform samples. In: samples. Out: value and rate, continuous to the second derivative.

/// Piecewise quintic through uniform samples from t = 0, twice continuously differentiable: at each sample the first and second
/// derivative are those of the polynomial through the seven nearest samples (errors of sixth and fifth order in the interval),
/// and each interval carries the quintic that meets value and both derivatives at its ends. Local: a sample acts only within
/// four intervals. Held beyond both ends.
#[derive(Clone, Debug, PartialEq)]
pub struct Smooth {
    per_interval: f64,
    end: f64,
    first: f64,
    last: f64,
    pieces: Vec<[f64; 6]>,
}

impl Smooth {
    /// Interpolant of `samples` at `interval_s` (s, positive). No samples: zero; one: constant.
    #[must_use]
    pub fn new(interval_s: f64, samples: &[f64]) -> Self {
        let n = samples.len();
        let stencils = stencils(n);
        let mut left = if n > 0 { derivatives(samples, 0, &stencils) } else { [0.0; 2] };
        let pieces = (1..n)
            .map(|i| {
                let right = derivatives(samples, i, &stencils);
                quintic([samples[i - 1], samples[i]], [std::mem::replace(&mut left, right), right])
            })
            .collect();
        let edge = |x: Option<&f64>| x.copied().unwrap_or(0.0);
        Self {
            per_interval: 1.0 / interval_s,
            end: n.saturating_sub(1) as f64,
            first: edge(samples.first()),
            last: edge(samples.last()),
            pieces,
        }
    }
    /// Value and rate at `t_s`.
    #[must_use]
    #[inline]
    pub fn at(&self, t_s: f64) -> (f64, f64) {
        let x = t_s * self.per_interval;
        if x <= 0.0 && (x < 0.0 || self.pieces.is_empty()) {
            return (self.first, 0.0);
        }
        if x > self.end {
            return (self.last, 0.0);
        }
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 ≤ x ≤ number of pieces")]
        let i = (x as usize).min(self.pieces.len() - 1);
        evaluate(&self.pieces[i], x - i as f64, self.per_interval)
    }
    /// Number of intervals.
    #[must_use]
    pub fn intervals(&self) -> usize {
        self.pieces.len()
    }
}

/// The same function as [`Smooth`], bit for bit, for times that never go back: its pieces are made on the way, nothing is stored.
#[derive(Clone, Debug)]
pub(crate) struct Stream<'a> {
    samples: &'a [f64],
    per_interval: f64,
    stencils: [Stencil; 7],
    /// The piece at hand and its number.
    piece: [f64; 6],
    number: usize,
    /// Derivatives at the piece's right end.
    right: [f64; 2],
}

impl<'a> Stream<'a> {
    /// As [`Smooth::new`].
    pub(crate) fn new(interval_s: f64, samples: &'a [f64]) -> Self {
        let stencils = stencils(samples.len());
        let mut stream =
            Self { samples, per_interval: 1.0 / interval_s, stencils, piece: [0.0; 6], number: usize::MAX, right: [0.0; 2] };
        if !samples.is_empty() {
            stream.right = derivatives(samples, 0, &stencils);
        }
        stream
    }
    /// As [`Smooth::at`]; `t_s` at least that of the call before, less one interval.
    #[inline]
    pub(crate) fn at(&mut self, t_s: f64) -> (f64, f64) {
        let x = t_s * self.per_interval;
        let n = self.samples.len();
        let Some(last) = n.checked_sub(1) else { return (0.0, 0.0) };
        if x <= 0.0 && (x < 0.0 || last == 0) {
            return (self.samples[0], 0.0);
        }
        if x > last as f64 {
            return (self.samples[last], 0.0);
        }
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 ≤ x ≤ number of pieces")]
        let i = (x as usize).min(last - 1);
        if i != self.number {
            self.turn_to(i);
        }
        let s = x - i as f64;
        if s == 0.0 {
            // The sample itself: a flight's steps often meet the samples of its history.
            return (self.piece[0], self.piece[1] * self.per_interval);
        }
        evaluate(&self.piece, s, self.per_interval)
    }
    fn turn_to(&mut self, i: usize) {
        let next = self.number.wrapping_add(1) == i;
        let left = if next { self.right } else { derivatives(self.samples, i, &self.stencils) };
        self.right = derivatives(self.samples, i + 1, &self.stencils);
        self.piece = quintic([self.samples[i], self.samples[i + 1]], [left, self.right]);
        self.number = i;
    }
}

/// Value and rate of piece `k` at `s` in [0, 1].
#[inline]
fn evaluate(k: &[f64; 6], s: f64, per_interval: f64) -> (f64, f64) {
    let [a, b, c, d, e, f] = *k;
    let value = a + s * (b + s * (c + s * (d + s * (e + s * f))));
    let slope = b + s * (2.0 * c + s * (3.0 * d + s * (4.0 * e + s * 5.0 * f)));
    (value, slope * per_interval)
}

/// Weights for `n` samples, by place among the nearest seven.
fn stencils(n: usize) -> [Stencil; 7] {
    let width = n.min(7);
    std::array::from_fn(|at| if at < width { stencil(width, at) } else { [[0.0; 2]; 7] })
}

/// First and second derivative at sample `i`, per interval, of the polynomial through the (up to) seven nearest samples.
#[inline]
fn derivatives(samples: &[f64], i: usize, stencils: &[Stencil; 7]) -> [f64; 2] {
    let width = samples.len().min(7);
    let start = i.saturating_sub(width / 2).min(samples.len() - width);
    let (near, weights) = (&samples[start..start + width], &stencils[i - start]);
    match near.first_chunk::<7>() {
        // The same sum, its length known to the compiler.
        Some(seven) => weighted(seven, weights, samples[i]),
        None => weighted(near, weights, samples[i]),
    }
}

#[inline(always)]
fn weighted(near: &[f64], weights: &Stencil, sample: f64) -> [f64; 2] {
    let mut out = [0.0; 2];
    for (w, other) in weights.iter().zip(near) {
        // Differences against the sample itself, so that a constant gives exactly zero.
        let difference = other - sample;
        out[0] += w[0] * difference;
        out[1] += w[1] * difference;
    }
    out
}

/// Weights of first and second derivative, per node.
type Stencil = [[f64; 2]; 7];

/// Weights of first and second derivative at node `at` of the nodes 0..width (Fornberg, Math. Comp. 51, 1988).
fn stencil(width: usize, at: usize) -> Stencil {
    let mut c = [[0.0_f64; 3]; 7];
    c[0][0] = 1.0;
    let z = at as f64;
    let (mut c1, mut c4) = (1.0, -z);
    for i in 1..width {
        let c5 = c4;
        c4 = i as f64 - z;
        let mut c2 = 1.0;
        for j in 0..i {
            let c3 = i as f64 - j as f64;
            c2 *= c3;
            if j == i - 1 {
                for k in (1..3).rev() {
                    c[i][k] = c1 * (k as f64 * c[i - 1][k - 1] - c5 * c[i - 1][k]) / c2;
                }
                c[i][0] = -c1 * c5 * c[i - 1][0] / c2;
            }
            for k in (1..3).rev() {
                c[j][k] = (c4 * c[j][k] - k as f64 * c[j][k - 1]) / c3;
            }
            c[j][0] = c4 * c[j][0] / c3;
        }
        c1 = c2;
    }
    c.map(|[_, first, second]| [first, second])
}

/// Coefficients of the quintic on [0, 1] with these values and derivatives at its ends.
fn quintic(y: [f64; 2], d: [[f64; 2]; 2]) -> [f64; 6] {
    let ([y0, y1], [[v0, a0], [v1, a1]]) = (y, d);
    let (p, q, r) = (y1 - y0 - v0 - 0.5 * a0, v1 - v0 - a0, a1 - a0);
    [y0, v0, 0.5 * a0, 10.0 * p - 4.0 * q + 0.5 * r, -15.0 * p + 7.0 * q - r, 6.0 * p - 3.0 * q + 0.5 * r]
}

/// Cubic on [0, 1] over an interval `dt` with these values and rates at its ends.
pub(crate) fn hermite(x: f64, dt: f64, y: [f64; 2], rate: [f64; 2]) -> f64 {
    let (d, m0, m1) = (y[1] - y[0], rate[0] * dt, rate[1] * dt);
    y[0] + x * (m0 + x * ((3.0 * d - 2.0 * m0 - m1) + x * (m0 + m1 - 2.0 * d)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn worst(n: usize, f: impl Fn(f64) -> (f64, f64)) -> (f64, f64) {
        let h = 2.0 / n as f64;
        let s = Smooth::new(h, &(0..=n).map(|i| f(i as f64 * h).0).collect::<Vec<_>>());
        (0..1000).map(|k| f64::from(k) * 0.002).fold((0.0, 0.0), |(a, b), t| {
            let ((v, r), (v0, r0)) = (s.at(t), f(t));
            (f64::max(a, (v - v0).abs()), f64::max(b, (r - r0).abs()))
        })
    }

    #[test]
    fn exact_quintic_polynomial() {
        let f = |t: f64| {
            (1.0 + t * (2.0 - t * (0.5 + t * (1.0 - t * (0.3 - 0.7 * t)))), 2.0 - t * (1.0 + t * (3.0 - t * (1.2 - 3.5 * t))))
        };
        let (value, rate) = worst(40, f);
        // Round-off of values near 30, divided by the interval 0.05 for the rate.
        assert!(value < 1e-13 && rate < 3e-12, "{value} {rate}");
    }

    #[test]
    fn order_six_of_value_and_five_of_rate() {
        let f = |t: f64| ((3.0 * t).sin(), 3.0 * (3.0 * t).cos());
        let (coarse, fine) = (worst(40, f), worst(80, f));
        let (value, rate) = ((coarse.0 / fine.0).log2(), (coarse.1 / fine.1).log2());
        assert!(value > 5.5 && value < 7.5, "order of the value {value}");
        assert!(rate > 4.5 && rate < 6.8, "order of the rate {rate}");
    }

    #[test]
    fn law_stream_has_the_same_bits() {
        for n in [0, 1, 2, 3, 6, 7, 8, 40] {
            let samples: Vec<f64> = (0..n).map(|k| (f64::from(k) * 1.7).sin()).collect();
            let (stored, mut stream) = (Smooth::new(0.1, &samples), Stream::new(0.1, &samples));
            for t in (-10..500).map(|k| f64::from(k) * 0.01) {
                let bits = |(value, rate): (f64, f64)| (value.to_bits(), rate.to_bits());
                assert_eq!(bits(stream.at(t)), bits(stored.at(t)), "{n} samples, t = {t}");
            }
            assert_eq!(stream.at(0.05), stored.at(0.05));
        }
    }

    #[test]
    fn law_twice_continuous_and_held() {
        let s = Smooth::new(0.1, &[1.0, 3.0, -2.0, 0.5, 0.0, 4.0, 1.0, -1.0, 2.0]);
        for i in 1..8 {
            let (left, right) = (s.pieces[i - 1], s.pieces[i]);
            let sum = |p: [f64; 6], k: [f64; 6]| p.iter().zip(k).map(|(a, b)| a * b).sum::<f64>();
            assert!((sum(left, [1.0; 6]) - right[0]).abs() < 1e-12);
            assert!((sum(left, [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]) - right[1]).abs() < 1e-12);
            assert!((sum(left, [0.0, 0.0, 2.0, 6.0, 12.0, 20.0]) - 2.0 * right[2]).abs() < 1e-11);
        }
        assert_eq!(s.at(-0.5), (1.0, 0.0));
        assert_eq!(s.at(0.81), (2.0, 0.0));
        assert_eq!(Smooth::new(0.1, &[5.0]).at(0.0), (5.0, 0.0));
        assert_eq!(Smooth::new(0.1, &[5.0; 4]).at(0.17), (5.0, 0.0));
    }
}
