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
        let width = n.min(7);
        let stencils: [Stencil; 7] = std::array::from_fn(|at| if at < width { stencil(width, at) } else { [[0.0; 2]; 7] });
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
        let s = x - i as f64;
        let [a, b, c, d, e, f] = self.pieces[i];
        let value = a + s * (b + s * (c + s * (d + s * (e + s * f))));
        let slope = b + s * (2.0 * c + s * (3.0 * d + s * (4.0 * e + s * 5.0 * f)));
        (value, slope * self.per_interval)
    }
    /// Number of intervals.
    #[must_use]
    pub fn intervals(&self) -> usize {
        self.pieces.len()
    }
}

/// First and second derivative at sample `i`, per interval, of the polynomial through the (up to) seven nearest samples.
#[inline]
fn derivatives(samples: &[f64], i: usize, stencils: &[Stencil; 7]) -> [f64; 2] {
    let width = samples.len().min(7);
    let start = i.saturating_sub(width / 2).min(samples.len() - width);
    let near = &samples[start..start + width];
    let mut out = [0.0; 2];
    for (w, sample) in stencils[i - start].iter().zip(near) {
        // Differences against sample i, so that a constant gives exactly zero.
        let difference = sample - samples[i];
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
