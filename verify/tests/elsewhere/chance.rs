//! Random numbers of one campaign: a seeded generator and what is drawn with it.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha12Rng;
use rand_distr::{Distribution, StandardNormal, StudentT};

/// One stream.
pub(crate) struct Chance(ChaCha12Rng);

impl Chance {
    /// Stream `stream` of a seed: what is drawn from one does not move another.
    pub(crate) fn new(seed: u64, stream: u64) -> Self {
        let mut rng = ChaCha12Rng::seed_from_u64(seed ^ 0x0065_6C73_6577_6865);
        rng.set_stream(stream);
        Self(rng)
    }
    pub(crate) fn uniform(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.0.random::<f64>()
    }
    /// Uniform in the logarithm.
    pub(crate) fn factor(&mut self, low: f64, high: f64) -> f64 {
        low * (high / low).powf(self.0.random::<f64>())
    }
    pub(crate) fn sign(&mut self) -> f64 {
        if self.0.random::<bool>() { 1.0 } else { -1.0 }
    }
    pub(crate) fn normal(&mut self) -> f64 {
        StandardNormal.sample(&mut self.0)
    }
    /// Student's t of three degrees of freedom, scaled to variance one.
    pub(crate) fn heavy(&mut self) -> f64 {
        let t: f64 = StudentT::new(3.0).expect("three degrees").sample(&mut self.0);
        t / 3.0_f64.sqrt()
    }
    /// 0 … n − 1.
    pub(crate) fn below(&mut self, n: usize) -> usize {
        self.0.random_range(0..n)
    }
    pub(crate) fn happens(&mut self, probability: f64) -> bool {
        self.0.random::<f64>() < probability
    }
    /// A number from 0 to 2π.
    pub(crate) fn phase(&mut self) -> f64 {
        self.uniform(0.0, std::f64::consts::TAU)
    }
}
