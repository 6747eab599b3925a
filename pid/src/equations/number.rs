//! pid: numbers that carry their derivatives (forward mode; Wengert 1964). In: values with slopes. Out: the same of any formula.
//!
//! Fixed width and plain arrays: the compiler keeps them in vector registers, which a width known only at run time, or an
//! optional derivative, forbids.

use std::ops::{Add, Mul, Neg, Sub};

/// What the equations of motion are written in: plain numbers, or numbers with derivatives.
pub trait Scalar:
    Copy
    + Default
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Neg<Output = Self>
    + Add<f64, Output = Self>
    + Mul<f64, Output = Self>
{
    /// A constant.
    fn real(value: f64) -> Self;
    /// Its value.
    fn value(self) -> f64;
    /// A function of one number: its value and slope here.
    fn chain(self, value: f64, slope: f64) -> Self;
    /// A function of two numbers: its value and both slopes here.
    fn chain2(self, other: Self, value: f64, slopes: [f64; 2]) -> Self;

    /// Square root.
    #[inline(always)]
    fn sqrt(self) -> Self {
        let root = self.value().sqrt();
        self.chain(root, 0.5 / root)
    }
    /// Sine and cosine.
    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        let (s, c) = self.value().sin_cos();
        (self.chain(s, c), self.chain(c, -s))
    }
    /// One over it.
    #[inline(always)]
    fn recip(self) -> Self {
        let r = 1.0 / self.value();
        self.chain(r, -r * r)
    }
    /// Absolute value.
    #[inline(always)]
    fn abs(self) -> Self {
        self.chain(self.value().abs(), self.value().signum())
    }
    /// Power, of a small whole exponent.
    #[inline(always)]
    fn powi(self, n: u8) -> Self {
        match n {
            0 => Self::real(1.0),
            1 => self,
            2 => self * self,
            _ => {
                let below = self.value().powi(i32::from(n) - 1);
                self.chain(below * self.value(), f64::from(n) * below)
            }
        }
    }
    /// sech²(self/width).
    #[inline(always)]
    fn bump(self, width: f64) -> Self {
        let x = self.value() / width;
        let value = x.cosh().powi(-2);
        self.chain(value, -2.0 * value * x.tanh() / width)
    }
    /// Hyperbolic tangent.
    #[inline(always)]
    fn tanh(self) -> Self {
        let t = self.value().tanh();
        self.chain(t, 1.0 - t * t)
    }
    /// Angle of the point (x, self).
    #[inline(always)]
    fn atan2(self, x: Self) -> Self {
        let (b, a) = (self.value(), x.value());
        let square = a * a + b * b;
        self.chain2(x, b.atan2(a), [a / square, -b / square])
    }
}

impl Scalar for f64 {
    #[inline(always)]
    fn real(value: f64) -> Self {
        value
    }
    #[inline(always)]
    fn value(self) -> f64 {
        self
    }
    #[inline(always)]
    fn chain(self, value: f64, _: f64) -> Self {
        value
    }
    #[inline(always)]
    fn chain2(self, _: Self, value: f64, _: [f64; 2]) -> Self {
        value
    }
}

/// A value and its derivatives along `N` directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dual<const N: usize> {
    /// The value.
    pub value: f64,
    /// Its derivatives.
    pub slopes: [f64; N],
}

impl<const N: usize> Dual<N> {
    /// The variable of direction `direction`.
    #[inline(always)]
    #[must_use]
    pub fn variable(value: f64, direction: usize) -> Self {
        let mut slopes = [0.0; N];
        slopes[direction] = 1.0;
        Self { value, slopes }
    }
    #[inline(always)]
    fn mix(self, other: Self, value: f64, a: f64, b: f64) -> Self {
        let mut slopes = [0.0; N];
        for ((s, x), y) in slopes.iter_mut().zip(&self.slopes).zip(&other.slopes) {
            *s = a * x + b * y;
        }
        Self { value, slopes }
    }
}

impl<const N: usize> Default for Dual<N> {
    #[inline(always)]
    fn default() -> Self {
        Self::real(0.0)
    }
}

impl<const N: usize> Scalar for Dual<N> {
    #[inline(always)]
    fn real(value: f64) -> Self {
        Self { value, slopes: [0.0; N] }
    }
    #[inline(always)]
    fn value(self) -> f64 {
        self.value
    }
    #[inline(always)]
    fn chain(mut self, value: f64, slope: f64) -> Self {
        self.value = value;
        self.slopes.iter_mut().for_each(|s| *s *= slope);
        self
    }
    #[inline(always)]
    fn chain2(self, other: Self, value: f64, [a, b]: [f64; 2]) -> Self {
        self.mix(other, value, a, b)
    }
}

impl<const N: usize> Add for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn add(mut self, o: Self) -> Self {
        self.value += o.value;
        self.slopes.iter_mut().zip(&o.slopes).for_each(|(a, b)| *a += b);
        self
    }
}
impl<const N: usize> Sub for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn sub(mut self, o: Self) -> Self {
        self.value -= o.value;
        self.slopes.iter_mut().zip(&o.slopes).for_each(|(a, b)| *a -= b);
        self
    }
}
impl<const N: usize> Mul for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, o: Self) -> Self {
        self.mix(o, self.value * o.value, o.value, self.value)
    }
}
impl<const N: usize> Neg for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.chain(-self.value, -1.0)
    }
}
impl<const N: usize> Add<f64> for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn add(mut self, o: f64) -> Self {
        self.value += o;
        self
    }
}
impl<const N: usize> Mul<f64> for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, o: f64) -> Self {
        self.chain(self.value * o, o)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A formula that uses every operation.
    fn formula<S: Scalar>(x: S, y: S) -> S {
        let (s, c) = (x * y).sin_cos();
        let r = (x * x + y * y).sqrt();
        s * 2.0 + (c - x).abs() + r.recip() * y.atan2(x) - r.powi(3) + (-y).bump(0.7) * x.powi(2) + 1.5
    }

    #[test]
    fn exact_value_is_that_of_plain_numbers_and_slopes_those_of_differences() {
        let (x, y) = (0.8, -0.35);
        let d = formula(Dual::<2>::variable(x, 0), Dual::variable(y, 1));
        assert!((d.value - formula(x, y)).abs() < 1e-15);
        let h = 1e-6;
        let dx = (formula(x + h, y) - formula(x - h, y)) / (2.0 * h);
        let dy = (formula(x, y + h) - formula(x, y - h)) / (2.0 * h);
        // Central differences: third derivative of order 10 times h²/6, and rounding 1e-16/h.
        assert!((d.slopes[0] - dx).abs() < 1e-9 && (d.slopes[1] - dy).abs() < 1e-9, "{d:?} {dx} {dy}");
    }
}
