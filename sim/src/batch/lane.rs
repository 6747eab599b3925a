//! sim: numbers side by side. In: a vector unit chosen at run time. Out: arithmetic, arc tangent and exponential on all lanes.
//!
//! Every operation acts on each lane by itself, so a lane's result never depends on its neighbours. Everything is inlined into
//! the function that the vector unit's instructions are enabled for; a call would leave it.

use pulp::Simd;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// One `f64` for each lane of the vector unit `S`. In memory on lines of the cache: across two of them a flight takes up to 1.4 times
/// as long, and where the stack begins is chance.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(super) struct Lanes<S: Simd> {
    simd: S,
    x: S::f64s,
}

/// 1.5·2⁵²: added to a number of magnitude below 2⁵¹ it rounds to the nearest whole number, half to even.
const ROUNDING: f64 = 6_755_399_441_055_744.0;

impl<S: Simd> Lanes<S> {
    /// The same number in all lanes.
    #[inline(always)]
    pub(super) fn splat(simd: S, x: f64) -> Self {
        Self { simd, x: simd.splat_f64s(x) }
    }
    /// Lanes from a slice of `S::F64_LANES` numbers.
    #[inline(always)]
    pub(super) fn load(simd: S, slice: &[f64]) -> Self {
        Self { simd, x: S::as_simd_f64s(slice).0[0] }
    }
    /// Lanes into a slice of `S::F64_LANES` numbers.
    #[inline(always)]
    pub(super) fn store(self, slice: &mut [f64]) {
        S::as_mut_simd_f64s(slice).0[0] = self.x;
    }
    /// Zero in all lanes.
    #[inline(always)]
    pub(super) fn zero(simd: S) -> Self {
        Self::splat(simd, 0.0)
    }
    #[inline(always)]
    fn like(self, x: f64) -> Self {
        Self::splat(self.simd, x)
    }
    #[inline(always)]
    fn with(self, x: S::f64s) -> Self {
        Self { simd: self.simd, x }
    }
    /// `self·b + c`, rounded once on every unit: with all else rounded correctly, a lane's bits do not depend on the unit.
    #[inline(always)]
    pub(super) fn mul_add(self, b: Self, c: Self) -> Self {
        self.with(self.simd.mul_add_f64s(self.x, b.x, c.x))
    }
    /// `c − self·b`, rounded once.
    #[inline(always)]
    pub(super) fn neg_mul_add(self, b: Self, c: Self) -> Self {
        self.with(self.simd.negate_mul_add_f64s(self.x, b.x, c.x))
    }
    /// `self + k`.
    #[inline(always)]
    pub(super) fn plus(self, k: f64) -> Self {
        self + self.like(k)
    }
    /// `self·k`.
    #[inline(always)]
    pub(super) fn scale(self, k: f64) -> Self {
        self * self.like(k)
    }
    /// Square root, correctly rounded.
    #[inline(always)]
    pub(super) fn sqrt(self) -> Self {
        self.with(self.simd.sqrt_f64s(self.x))
    }
    /// `1/self`, correctly rounded.
    #[inline(always)]
    pub(super) fn recip(self) -> Self {
        self.like(1.0) / self
    }
    /// Absolute value.
    #[inline(always)]
    pub(super) fn abs(self) -> Self {
        // All bits but the sign's; the unit's own function is not inlined.
        self.with(self.simd.and_f64s(self.x, self.like(f64::from_bits(!(1 << 63))).x))
    }
    /// Where `self > limit`: `yes`, elsewhere (and where either is NaN): `no`.
    #[inline(always)]
    pub(super) fn where_above(self, limit: f64, yes: Self, no: Self) -> Self {
        let mask = self.simd.greater_than_f64s(self.x, self.like(limit).x);
        self.with(self.simd.select_f64s(mask, yes.x, no.x))
    }
    /// The larger of the two.
    #[inline(always)]
    pub(super) fn max(self, o: Self) -> Self {
        self.with(self.simd.max_f64s(self.x, o.x))
    }
    /// Nearest whole number, for magnitudes below 2⁵¹.
    #[inline(always)]
    pub(super) fn round(self) -> Self {
        let magic = self.like(ROUNDING);
        (self + magic) - magic
    }
    /// `self` with the sign bit of `s` put over its own.
    #[inline(always)]
    fn xor_sign(self, s: Self) -> Self {
        let sign = self.simd.and_f64s(s.x, self.like(-0.0).x);
        self.with(self.simd.xor_f64s(self.x, sign))
    }

    /// Four-quadrant arc tangent of `self/x`, rad, in [−π, π], within 2 ulp (see the test); `atan2(±0, 0) = ±0`. For finite
    /// arguments whose larger magnitude is normal.
    ///
    /// The quotient of the smaller by the larger magnitude is brought below tan(π/8) by `(a − 1)/(a + 1)`; there
    /// `atan t = t + t³ P(t²)` with the minimax polynomial `P` of degree 11 (relative error 5e-20, by Remez exchange).
    #[inline(always)]
    pub(super) fn atan2(self, x: Self) -> Self {
        let simd = self.simd;
        let (ay, ax) = (self.abs(), x.abs());
        let steep = simd.greater_than_f64s(ay.x, ax.x);
        let low = self.with(simd.min_f64s(ay.x, ax.x));
        let high = self.with(simd.max_f64s(ay.x, ax.x)).max(self.like(f64::MIN_POSITIVE));
        let wide = simd.greater_than_f64s(low.x, high.scale(TAN_PI_8).x);
        let (num, den) = (simd.select_f64s(wide, (low - high).x, low.x), simd.select_f64s(wide, (low + high).x, high.x));
        let t = self.with(num) / self.with(den);
        let z = t * t;
        // Even and odd coefficients apart: two short chains instead of a long one.
        let zz = z * z;
        let (mut even, mut odd) = (self.like(ATAN[10]), self.like(ATAN[11]));
        for k in [8, 6, 4, 2, 0] {
            even = even.mul_add(zz, self.like(ATAN[k]));
            odd = odd.mul_add(zz, self.like(ATAN[k + 1]));
        }
        let series = t * z * odd.mul_add(z, even);
        // Multiples of π/4 in two parts: the small one joins the series.
        let zero = self.like(0.0);
        let base = self.with(simd.select_f64s(wide, self.like(0.25 * PI).x, zero.x));
        let rest = self.with(simd.select_f64s(wide, self.like(0.25 * PI_LOW).x, zero.x));
        let angle = [base, t, series + rest];
        let angle = Self::reflect(angle, steep, 0.5 * PI, 0.5 * PI_LOW);
        let [a, b, c] = Self::reflect(angle, simd.less_than_f64s(x.x, zero.x), PI, PI_LOW);
        (a + (b + c)).xor_sign(self)
    }

    /// Where `mask`: the angle given as a sum of three, taken from `whole + part`.
    #[inline(always)]
    fn reflect([a, b, c]: [Self; 3], mask: S::m64s, whole: f64, part: f64) -> [Self; 3] {
        let s = a.simd;
        [
            a.with(s.select_f64s(mask, (a.like(whole) - a).x, a.x)),
            b.with(s.select_f64s(mask, (-b).x, b.x)),
            c.with(s.select_f64s(mask, (c.like(part) - c).x, c.x)),
        ]
    }

    /// `eˣ` for x ≤ 0, within 2 ulp (see the test); below −700 it stays at e⁻⁷⁰⁰, 1e-304.
    ///
    /// `eˣ = 2ᵏ eʳ` with |r| ≤ ½ ln 2 and the Taylor polynomial of degree 13 (remainder 5e-18).
    #[inline(always)]
    pub(super) fn exp_of_negative(self) -> Self {
        let simd = self.simd;
        let x = self.max(self.like(-700.0));
        let shifted = x.mul_add(self.like(std::f64::consts::LOG2_E), self.like(ROUNDING));
        let k = shifted - self.like(ROUNDING);
        let r = k.neg_mul_add(self.like(LN2_LOW), k.neg_mul_add(self.like(LN2_HIGH), x));
        let mut p = self.like(TAYLOR[13]);
        for k in [12, 11, 10, 9, 8, 7, 6, 5, 4, 3, 2, 1, 0] {
            p = p.mul_add(r, self.like(TAYLOR[k]));
        }
        // The whole number k is in the low bits of `shifted`: k + 1023 moved up by 52 places is 2ᵏ.
        let exponent = simd.add_u64s(simd.transmute_u64s_f64s(shifted.x), simd.splat_u64s(1023));
        let power = simd.transmute_f64s_u64s(simd.mul_u64s(exponent, simd.splat_u64s(1 << 52)));
        p * self.with(power)
    }

    /// tanh x = ±(1 − e^(−2|x|))/(1 + e^(−2|x|)): to an absolute error of two ulp of 1.
    #[inline(always)]
    pub(super) fn tanh(self) -> Self {
        let e = self.abs().scale(-2.0).exp_of_negative();
        let size = (self.like(1.0) - e) * e.plus(1.0).recip();
        self.where_above(0.0, size, -size)
    }

    /// sech² x = 4e/(1 + e)² with e = e^(−2|x|).
    #[inline(always)]
    pub(super) fn sech2(self) -> Self {
        let e = self.abs().scale(-2.0).exp_of_negative();
        let per = e.plus(1.0).recip();
        (e * per).scale(4.0) * per
    }
}

const PI: f64 = std::f64::consts::PI;
/// What π is larger than [`PI`].
const PI_LOW: f64 = 1.224_646_799_147_353_2e-16;
const TAN_PI_8: f64 = std::f64::consts::SQRT_2 - 1.0;
/// ln 2 in two parts, the first with 32 bits, so that its product with k is exact.
const LN2_HIGH: f64 = 0.693_147_180_369_123_8;
const LN2_LOW: f64 = 1.908_214_929_270_587_7e-10;
/// 1/k!.
const TAYLOR: [f64; 14] = {
    let (mut c, mut factorial, mut k) = ([1.0; 14], 1.0, 1);
    while k < 14 {
        factorial *= k as f64;
        c[k] = 1.0 / factorial;
        k += 1;
    }
    c
};
const ATAN: [f64; 12] = [
    -0.333_333_333_333_333_26,
    0.199_999_999_999_977_06,
    -0.142_857_142_853_925_12,
    0.111_111_110_884_596_31,
    -0.090_909_081_547_320_84,
    0.076_922_829_900_904_99,
    -0.066_662_301_847_090_06,
    0.058_770_554_513_678_123,
    -0.052_186_215_963_599_1,
    0.045_044_349_474_762_29,
    -0.033_495_126_434_590_96,
    0.015_216_200_458_410_67,
];

impl<S: Simd> Add for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        self.with(self.simd.add_f64s(self.x, o.x))
    }
}
impl<S: Simd> Sub for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        self.with(self.simd.sub_f64s(self.x, o.x))
    }
}
impl<S: Simd> Mul for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, o: Self) -> Self {
        self.with(self.simd.mul_f64s(self.x, o.x))
    }
}
impl<S: Simd> Div for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn div(self, o: Self) -> Self {
        self.with(self.simd.div_f64s(self.x, o.x))
    }
}
impl<S: Simd> Neg for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.with(self.simd.xor_f64s(self.x, self.like(-0.0).x))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use pulp::{Arch, Scalar, WithSimd};

    #[derive(Clone, Copy)]
    enum Function {
        Atan2,
        Exp,
        Tanh,
        Sech2,
    }
    use Function::{Atan2, Exp, Sech2, Tanh};

    /// Applies a function of two numbers, or of the first, lane by lane.
    struct Both<'a>(&'a [[f64; 2]], Function);
    impl WithSimd for Both<'_> {
        type Output = Vec<f64>;
        #[inline(always)]
        fn with_simd<S: Simd>(self, simd: S) -> Vec<f64> {
            let mut out = Vec::new();
            for chunk in self.0.chunks(S::F64_LANES) {
                let pick = |k: usize| -> Vec<f64> { (0..S::F64_LANES).map(|i| chunk[i.min(chunk.len() - 1)][k]).collect() };
                let (a, b) = (Lanes::load(simd, &pick(0)), Lanes::load(simd, &pick(1)));
                let mut row = vec![0.0; S::F64_LANES];
                let value = match self.1 {
                    Atan2 => a.atan2(b),
                    Exp => a.exp_of_negative(),
                    Tanh => a.tanh(),
                    Sech2 => a.sech2(),
                };
                value.store(&mut row);
                out.extend(&row[..chunk.len()]);
            }
            out
        }
    }

    fn ulp(x: f64) -> f64 {
        let a = x.abs().max(f64::MIN_POSITIVE);
        f64::from_bits(a.to_bits() + 1) - a
    }

    /// Pairs over all quadrants and 80 decades of ratio, from a multiplicative sequence.
    fn pairs() -> Vec<[f64; 2]> {
        let frac = |k: u32, c: f64| (f64::from(k) * c).fract();
        (1..400_000)
            .map(|k| {
                let angle = std::f64::consts::TAU * frac(k, 0.618_033_988_749_895);
                let tilt = if k % 3 == 0 { 10_f64.powf(80.0 * frac(k, 0.414_213_562_373_095) - 40.0) } else { 1.0 };
                [tilt * angle.sin(), angle.cos()]
            })
            .collect()
    }

    /// The bound is the sum of what rounds: the last addition half an ulp, the series and its argument 1.2.
    #[test]
    fn exact_arc_tangent_within_two_ulp() {
        let pairs = pairs();
        for values in [Arch::new().dispatch(Both(&pairs, Atan2)), Both(&pairs, Atan2).with_simd(Scalar::new())] {
            let worst = pairs.iter().zip(&values).map(|([y, x], a)| (a - y.atan2(*x)).abs() / ulp(y.atan2(*x)));
            let worst = worst.fold(0.0, f64::max);
            assert!(worst <= 2.0, "{worst} ulp");
        }
    }

    #[test]
    fn exact_arc_tangent_on_the_axes() {
        let cases =
            [[0.0, 1.0], [-0.0, 1.0], [0.0, -1.0], [-0.0, -1.0], [1.0, 0.0], [-1.0, 0.0], [0.0, 0.0], [1.0, 1.0], [1.0, -1.0]];
        for ([y, x], a) in cases.iter().zip(Arch::new().dispatch(Both(&cases, Atan2))) {
            assert_eq!(a.to_bits(), y.atan2(*x).to_bits(), "atan2({y}, {x}) = {a}");
        }
    }

    /// Without a vector unit the bits are the same.
    #[test]
    fn exact_bits_on_every_unit() {
        let pairs: Vec<[f64; 2]> = pairs().into_iter().map(|[y, x]| [-y.abs(), x]).collect();
        for function in [Atan2, Exp, Tanh] {
            let (unit, scalar) = (Arch::new().dispatch(Both(&pairs, function)), Both(&pairs, function).with_simd(Scalar::new()));
            assert!(unit.iter().zip(&scalar).all(|(a, b)| a.to_bits() == b.to_bits()));
        }
    }

    /// The bound: half an ulp for the last product, one for the polynomial's last sum at eʳ ≥ 0.7 and its argument.
    #[test]
    fn exact_exponential_within_two_ulp() {
        let x: Vec<[f64; 2]> = (0..300_000).map(|k| [-0.002_333_1 * f64::from(k), 0.0]).collect();
        for values in [Arch::new().dispatch(Both(&x, Exp)), Both(&x, Exp).with_simd(Scalar::new())] {
            let worst = x.iter().zip(&values).map(|([x, _], e)| (e - x.exp()).abs() / ulp(x.exp())).fold(0.0, f64::max);
            assert!(worst <= 2.0, "{worst} ulp");
        }
        assert_eq!(Arch::new().dispatch(Both(&[[0.0, 0.0], [-1e300, 0.0]], Exp)), [1.0, (-700.0_f64).exp()]);
    }

    /// Both signs, and where e²ˣ is beyond numbers; the exponential is within two ulp, sums, quotients and products round once each, all of
    /// numbers of at most 2.
    #[test]
    fn exact_hyperbolic_functions() {
        let x: Vec<[f64; 2]> = (-700..700).map(|k| [0.031_7 * f64::from(k), 0.0]).chain([[-400.0, 0.0], [709.6, 0.0]]).collect();
        let values = [Tanh, Sech2].map(|function| Arch::new().dispatch(Both(&x, function)));
        for (k, [x, _]) in x.iter().enumerate() {
            assert!((values[0][k] - x.tanh()).abs() <= 4.0 * f64::EPSILON, "tanh {x} = {}", values[0][k]);
            assert!((values[1][k] - x.cosh().powi(-2)).abs() <= 4.0 * f64::EPSILON, "sech² {x} = {}", values[1][k]);
        }
    }
}
