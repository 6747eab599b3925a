//! likelihood: what moves the model at random, as states driven by white noise. In: a plant's disturbances. Out: their transitions.
//!
//! A gust has Dryden's form (MIL-F-8785C 1980), seen through a short lag that makes its rate a state, so that what follows the gust's rate
//! (α̇, apparent mass) feels a finite one. A narrow-band moment is an oscillator.

use nalgebra::{Matrix3, SMatrix, SVector, Vector3};
use windfall_model::{Disturbance, Entry, Plant, Shape};

/// States of one random input.
pub(crate) const ORDER: usize = 3;
/// The short lag over the gust's own time, and its bounds, s.
const FAST: f64 = 0.1;
const FAST_S: [f64; 2] = [0.002, 0.02];

/// A matrix over one input's states.
pub(crate) type Block = [[f64; ORDER]; ORDER];

/// One random input ready for a step. Its first state is the input itself.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Input {
    pub(crate) entry: Entry,
    /// Rate of the input by its states (a gust's); zero for others.
    pub(crate) rate: [f64; ORDER],
    /// Transition over half a step and a whole one.
    pub(crate) half: Block,
    pub(crate) whole: Block,
    /// Covariance that a step adds, and in the long run.
    pub(crate) added: Block,
    pub(crate) stationary: Block,
}

/// The random inputs of a plant at mean speed, for steps of `step_s`.
pub(crate) fn inputs(plant: &Plant, speed_m_s: f64, step_s: f64) -> Vec<Input> {
    plant.disturbances(speed_m_s).iter().map(|d| input(d, step_s)).collect()
}

fn input(d: &Disturbance, step_s: f64) -> Input {
    // Rates of the states, and where white noise enters.
    let (a, b, gust) = match d.shape {
        Shape::DrydenLongitudinal { time_s } => gust(time_s, 1.0),
        Shape::DrydenLateral { time_s } => gust(time_s, 3.0_f64.sqrt()),
        Shape::Narrow { centre_rad_s: w, bandwidth_rad_s } => {
            (Matrix3::new(0.0, 1.0, 0.0, -w * w, -bandwidth_rad_s, 0.0, 0.0, 0.0, -1.0), Vector3::new(0.0, 1.0, 0.0), false)
        }
    };
    let mut p = lyapunov(&a, &b);
    p *= d.rms * d.rms / p[(0, 0)];
    let (half, whole) = ((a * (0.5 * step_s)).exp(), (a * step_s).exp());
    let added = p - whole * p * whole.transpose();
    let rows = |m: &Matrix3<f64>| -> Block { std::array::from_fn(|i| std::array::from_fn(|k| m[(i, k)])) };
    Input {
        entry: d.entry,
        rate: if gust { std::array::from_fn(|k| a[(0, k)]) } else { [0.0; ORDER] },
        half: rows(&half),
        whole: rows(&whole),
        added: rows(&added),
        stationary: rows(&p),
    }
}

/// `(1 + ζ T s)/(1 + T s)²` behind a short lag: ζ = 1 along the stream, √3 across it.
fn gust(time_s: f64, zeta: f64) -> (Matrix3<f64>, Vector3<f64>, bool) {
    let fast = 1.0 / (FAST * time_s).clamp(FAST_S[0], FAST_S[1]);
    let per = 1.0 / time_s;
    // The form's state and, in units of 1/T, its rate.
    let a = Matrix3::new(-fast, fast, fast * zeta, 0.0, 0.0, per, 0.0, -per, -2.0 * per);
    (a, Vector3::new(0.0, 0.0, 1.0), true)
}

/// Stationary covariance: `A P + P Aᵀ + b bᵀ = 0`.
fn lyapunov(a: &Matrix3<f64>, b: &Vector3<f64>) -> Matrix3<f64> {
    let mut m = SMatrix::<f64, 9, 9>::zeros();
    for i in 0..3 {
        for k in 0..3 {
            for l in 0..3 {
                m[(3 * i + k, 3 * l + k)] += a[(i, l)];
                m[(3 * i + k, 3 * i + l)] += a[(k, l)];
            }
        }
    }
    let right = SVector::<f64, 9>::from_fn(|j, _| -b[j / 3] * b[j % 3]);
    let p = m.lu().solve(&right).unwrap_or_default();
    Matrix3::from_fn(|i, k| 0.5 * (p[3 * i + k] + p[3 * k + i]))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The gust's own variance is what was asked for, at every length, and its covariance stays what it is from step to step.
    #[test]
    fn exact_stationary_covariance() {
        for time_s in [0.01, 0.08, 0.5] {
            let d = Disturbance { entry: Entry::AirVelocity(1), rms: 0.3, shape: Shape::DrydenLateral { time_s } };
            let i = input(&d, 0.02);
            assert!((i.stationary[0][0] - 0.09).abs() < 1e-15);
            let of = |b: &Block| Matrix3::from_fn(|r, c| b[r][c]);
            let (a, b, _) = gust(time_s, 3.0_f64.sqrt());
            let p = of(&i.stationary);
            let left = a * p + p * a.transpose();
            // All of the driving noise is in the last state.
            let driven = left[(2, 2)];
            assert!(driven < 0.0 && (left - b * b.transpose() * driven).amax() < 1e-9 * driven.abs());
        }
    }
}
