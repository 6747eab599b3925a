//! sim: the method of Dormand and Prince, 5(4) with dense output (Dormand & Prince 1980; Hairer, Nørsett & Wanner 1993, §II.4-6),
//! on lanes. In: where a step begins and the rates there. Out: where it ends, its error, the states between.

use super::adaptive::{Control, EmbeddedPair, Rhs, StepStart, Tolerance, ahead, root, weighted};
use super::lane::Lanes;
use super::track::LANES_MAX;
use pulp::Simd;

/// Stages after the first: part of the step, and weights of the stages before.
const STAGES: [(f64, &[(usize, f64)]); 6] = [
    (0.2, &[(0, 0.2)]),
    (0.3, &[(0, 3.0 / 40.0), (1, 9.0 / 40.0)]),
    (0.8, &[(0, 44.0 / 45.0), (1, -56.0 / 15.0), (2, 32.0 / 9.0)]),
    (8.0 / 9.0, &[(0, 19372.0 / 6561.0), (1, -25360.0 / 2187.0), (2, 64448.0 / 6561.0), (3, -212.0 / 729.0)]),
    (1.0, &[(0, 9017.0 / 3168.0), (1, -355.0 / 33.0), (2, 46732.0 / 5247.0), (3, 49.0 / 176.0), (4, -5103.0 / 18656.0)]),
    (1.0, &[(0, 35.0 / 384.0), (2, 500.0 / 1113.0), (3, 125.0 / 192.0), (4, -2187.0 / 6784.0), (5, 11.0 / 84.0)]),
];
/// Fifth order less fourth.
const E: &[(usize, f64)] = &[
    (0, 71.0 / 57600.0),
    (2, -71.0 / 16695.0),
    (3, 71.0 / 1920.0),
    (4, -17253.0 / 339_200.0),
    (5, 22.0 / 525.0),
    (6, -1.0 / 40.0),
];
/// Fifth coefficient of the dense output.
const D: &[(usize, f64)] = &[
    (0, -12_715_105_075.0 / 11_282_082_432.0),
    (2, 87_487_479_700.0 / 32_700_410_799.0),
    (3, -10_690_763_975.0 / 1_880_347_072.0),
    (4, 701_980_252_875.0 / 199_316_789_632.0),
    (5, -1_453_857_185.0 / 822_651_844.0),
    (6, 69_997_945.0 / 29_380_423.0),
];

/// Rates of the stages; the last is at the end of the step.
pub(super) struct Dopri5<S: Simd, const N: usize> {
    k: [[Lanes<S>; N]; 7],
}

impl<S: Simd, const N: usize> EmbeddedPair<S, N> for Dopri5<S, N> {
    const CONTROL: Control = Control { order: 5.0, beta: 0.04, shrink: 0.2, grow: 10.0 };
    type Dense = [[Lanes<S>; N]; 4];

    #[inline(always)]
    fn new(simd: S) -> Self {
        Self { k: [[Lanes::zero(simd); N]; 7] }
    }

    #[inline(always)]
    fn attempt(&mut self, simd: S, from: &StepStart<S, N>, rhs: &mut Rhs<'_, '_, S>) -> [Lanes<S>; N] {
        self.k[0] = from.rate;
        let mut y = from.y;
        for (stage, (part, weights)) in STAGES.iter().enumerate() {
            y = ahead(simd, from, &self.k, weights);
            // The last two stages are at the same time.
            if stage < 5 {
                rhs.look_ahead(from, *part);
            }
            self.k[stage + 1] = rhs.rate(&y);
        }
        y
    }

    #[inline(always)]
    fn errors(&self, simd: S, from: &StepStart<S, N>, end: &[Lanes<S>; N], tolerance: &Tolerance<S>) -> [f64; LANES_MAX] {
        let mut error = from.y;
        for (i, e) in error.iter_mut().enumerate() {
            *e = from.h * weighted(simd, &self.k, E, i);
        }
        root(tolerance.sum(simd, &error, &from.y, end).scale(1.0 / (N + 1) as f64))
    }

    #[inline(always)]
    fn rate_at_end(&mut self, _end: &[Lanes<S>; N], _rhs: &mut Rhs<'_, '_, S>) -> [Lanes<S>; N] {
        self.k[6]
    }

    #[inline(always)]
    fn dense(&mut self, simd: S, from: &StepStart<S, N>, end: &[Lanes<S>; N], _rhs: &mut Rhs<'_, '_, S>) -> Self::Dense {
        let mut out = [from.y; 4];
        for i in 0..N {
            let rise = end[i] - from.y[i];
            let bend = from.h * self.k[0][i] - rise;
            out[0][i] = rise;
            out[1][i] = bend;
            out[2][i] = rise - from.h * self.k[6][i] - bend;
            out[3][i] = from.h * weighted(simd, &self.k, D, i);
        }
        out
    }
}
