//! The operator and the fan: he sees the height late, asks for speed, and the fan follows as an oscillator.

use crate::chance::Chance;
use std::f64::consts::TAU;

/// States: speed, its rate, height as seen.
#[derive(Clone, Debug)]
pub(crate) struct Hand {
    pub(crate) trim: f64,
    gain: f64,
    lead: f64,
    lag: f64,
    fan: f64,
    unsteady: [(f64, f64, f64); 4],
}

impl Hand {
    pub(crate) fn new(trim: f64, c: &mut Chance) -> Self {
        let unsteady =
            std::array::from_fn(|j| (c.uniform(0.01, 0.045), TAU * (0.07 + 0.13 * j as f64) * c.uniform(0.8, 1.2), c.phase()));
        Self {
            trim,
            gain: c.uniform(0.18, 0.32),
            lead: c.uniform(0.9, 1.4),
            lag: c.uniform(0.15, 0.3),
            fan: TAU * c.uniform(0.6, 1.0),
            unsteady,
        }
    }
    /// The same before a model of another size: times grow with its root, as speeds do.
    pub(crate) fn sized(self, size: f64) -> Self {
        let slow = size.sqrt();
        Self {
            gain: self.gain / slow,
            lead: self.lead * slow,
            lag: self.lag * slow,
            fan: self.fan / slow,
            unsteady: self.unsteady.map(|(a, w, phase)| (a * slow, w / slow, phase)),
            ..self
        }
    }
    pub(crate) fn start(&self, height: f64) -> [f64; 3] {
        [self.trim, 0.0, height]
    }
    pub(crate) fn rates(&self, t: f64, height: f64, sinking: f64, [speed, rate, seen]: [f64; 3]) -> [f64; 3] {
        let shaking: f64 = self.unsteady.iter().map(|(a, w, phase)| a * (w * t + phase).sin()).sum();
        let wanted = self.trim + self.gain * seen + shaking;
        [rate, self.fan * self.fan * (wanted - speed) - 1.6 * self.fan * rate, (height + self.lead * sinking - seen) / self.lag]
    }
}
