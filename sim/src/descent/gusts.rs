//! sim: gusts along a descent. In: sizes and scales over height, three streams of normal numbers, time steps. Out: gust velocity.
//!
//! Dryden forms (MIL-F-8785C 1980): longitudinal along the vertical, lateral toward north and east. Their shaping filters are taken over
//! a step in exact discrete form, with airspeed, scale and size of the step's beginning.

use crate::{Channel, Seed};
use windfall_model::Turbulence;
use windfall_model::planet::GustProfile;

/// Filters of the three components under way; states have the stationary covariance of unit gusts.
pub(super) struct Gusts<'a, I> {
    profile: &'a GustProfile,
    normals: [I; 3],
    /// North and east: `ẋ₁ = −a x₁ + √(2a) w`, `ẋ₂ = −a x₂ + a x₁`, with a = V/L.
    lateral: [[f64; 2]; 2],
    /// Down: `ẋ = −a x + √(2a) w`.
    axial: f64,
}

/// Share of each lateral state in a unit gust: transfer `(√3 s + a)/(s + a)²`, variance 1 by [`COVARIANCE`].
const LATERAL: [f64; 2] = {
    const ROOT_3: f64 = 1.732_050_807_568_877_2;
    const PER_ROOT_2: f64 = std::f64::consts::FRAC_1_SQRT_2;
    [ROOT_3 * PER_ROOT_2, (1.0 - ROOT_3) * PER_ROOT_2]
};
/// Stationary covariance of the lateral states: `var x₁ = 1`, `cov = var x₂ = ½`.
const COVARIANCE: [f64; 3] = [1.0, 0.5, 0.5];

/// Streams of the gusts of one flight.
pub(super) fn streams(seed: Seed) -> [impl Iterator<Item = f64>; 3] {
    [0, 1, 2].map(|axis| seed.normals(Channel::Gust(axis)))
}

impl<'a, I: Iterator<Item = f64>> Gusts<'a, I> {
    /// Filters in their stationary state.
    pub(super) fn new(profile: &'a GustProfile, mut normals: [I; 3]) -> Self {
        let root = root(COVARIANCE);
        let lateral = [0, 1].map(|k| {
            let z = [draw(&mut normals[k]), draw(&mut normals[k])];
            [root[0] * z[0], root[1] * z[0] + root[2] * z[1]]
        });
        let axial = draw(&mut normals[2]);
        Self { profile, normals, lateral, axial }
    }
    /// Gust toward north, east, down at a height, m/s.
    pub(super) fn now(&self, height_m: f64) -> [f64; 3] {
        let t = self.profile.at(height_m);
        let lateral = |x: [f64; 2]| t.lateral_rms_m_s * (LATERAL[0] * x[0] + LATERAL[1] * x[1]);
        [lateral(self.lateral[0]), lateral(self.lateral[1]), t.axial_rms_m_s * self.axial]
    }
    /// Goes on by `step_s` at an airspeed and height.
    pub(super) fn advance(&mut self, step_s: f64, speed_m_s: f64, height_m: f64) {
        let Turbulence { axial_scale_m, lateral_scale_m, .. } = self.profile.at(height_m);
        let (f11, f21, q) = lateral_step(speed_m_s * step_s / lateral_scale_m);
        for (x, normals) in self.lateral.iter_mut().zip(&mut self.normals) {
            let z = [draw(normals), draw(normals)];
            *x = [f11 * x[0] + q[0] * z[0], f21 * x[0] + f11 * x[1] + q[1] * z[0] + q[2] * z[1]];
        }
        let kept = (-speed_m_s * step_s / axial_scale_m).exp();
        self.axial = kept * self.axial + (1.0 - kept * kept).max(0.0).sqrt() * draw(&mut self.normals[2]);
    }
}

fn draw(normals: &mut impl Iterator<Item = f64>) -> f64 {
    normals.next().unwrap_or(0.0)
}

/// Lower triangular root of a 2×2 covariance given as `[11, 21, 22]`, as `[11, 21, 22]`.
fn root([a, b, c]: [f64; 3]) -> [f64; 3] {
    let first = a.max(0.0).sqrt();
    let second = if first > 0.0 { b / first } else { 0.0 };
    [first, second, (c - second * second).max(0.0).sqrt()]
}

/// Diagonal and lower element of the transition, root of the noise.
type Lateral = (f64, f64, [f64; 3]);

/// Transition and root of the noise covariance `P − Φ P Φᵀ` of the lateral states for `x = a·step`:
/// `Φ = e⁻ˣ [[1, 0], [x, 1]]`.
fn lateral_step(x: f64) -> Lateral {
    let kept = (-x).exp();
    let k2 = kept * kept;
    let [p11, p21, p22] = COVARIANCE;
    let noise = [p11 * (1.0 - k2), p21 - k2 * (p21 + x * p11), p22 - k2 * (p22 + 2.0 * x * p21 + x * x * p11)];
    (kept, kept * x, root(noise))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::realise;
    use windfall_model::{Disturbance, Entry, Shape};

    const RMS: f64 = 1.7;

    /// Impulse response of the exact step: with one normal number and zeros after it, sequences of this filter and of the tunnel's
    /// ([`realise`]: matrix exponential, Lyapunov equation) have the same covariance at all lags, `Σ_k g(k) g(k + lag)`.
    fn covariances(series: impl Fn(usize) -> Vec<f64>, inputs: usize) -> Vec<f64> {
        let all: Vec<Vec<f64>> = (0..inputs).map(series).collect();
        // At a late time the sum over all inputs of products of responses is the covariance.
        (0..12).map(|lag| all.iter().map(|s| s[40] * s[40 + lag]).sum()).collect()
    }

    /// Bound: round-off of some hundred products of size one.
    #[test]
    fn exact_lateral_gusts_are_those_of_the_tunnel() {
        let (speed, scale, step, n) = (9.0, 5.0, 0.2, 60);
        let unit = |i: usize| (0..).map(move |k| if k == i { 1.0 } else { 0.0 });
        let disturbance = |shape| Disturbance { entry: Entry::AirVelocity(1), rms: RMS, shape };
        let time_s = scale / speed;
        let lateral = disturbance(Shape::DrydenLateral { time_s });
        let axial = disturbance(Shape::DrydenLongitudinal { time_s });
        let turbulence =
            Turbulence { axial_rms_m_s: RMS, lateral_rms_m_s: RMS, axial_scale_m: scale, lateral_scale_m: scale, bandwidth: 0.0 };
        let profile = GustProfile::steady(turbulence).expect("sound");
        let own = |axis: usize| {
            let profile = &profile;
            move |i: usize| {
                let mut gusts = Gusts::new(profile, [unit(i), unit(i), unit(i)]);
                let mut next = || {
                    let g = gusts.now(0.0)[axis];
                    gusts.advance(step, speed, 0.0);
                    g
                };
                (0..n).map(|_| next()).collect::<Vec<f64>>()
            }
        };
        for (axis, disturbance) in [(0, lateral), (1, lateral), (2, axial)] {
            let tunnel = covariances(|i| realise(&disturbance, step, n, unit(i)), 2 * n + 2);
            let here = covariances(own(axis), 2 * n + 2);
            assert!((here[0] - RMS * RMS).abs() < 1e-12, "{axis}: variance {}", here[0]);
            for (lag, (a, b)) in here.iter().zip(&tunnel).enumerate() {
                assert!((a - b).abs() < 1e-11, "{axis}, lag {lag}: {a} {b}");
            }
        }
    }
}
