//! pid: where filter error's search is. In: unknown parameters and logarithms of what drives the runs at random. Out: the same, moved,
//! with some taken for none.

use super::filter::Random;
use crate::plant::START_SCALE_M;
use nalgebra::DVector;
use windfall_model::{Turbulence, Unknowns};

/// Numbers that describe the random drive: rms and scale of axial and lateral gusts, intensity of turning about x and across it.
pub(super) const RANDOM: usize = 6;
/// Which of them are sizes.
pub(super) const SIZES: [usize; 4] = [0, 1, 4, 5];

/// A scale that the data do not tell stays near its start: prior standard deviation of its logarithm, so 0.08 to 4 m are likely.
pub(super) const SCALE_PRIOR: f64 = 1.0;
/// Size of a gust that is not there, m/s; of turning in its own unit.
pub(crate) const NONE_M_S: f64 = 1e-6;

/// What of the random drive is sought beside the sizes of gusts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Sought {
    pub(super) scales: bool,
    pub(super) turning: bool,
}

/// A point of the search.
#[derive(Clone)]
pub(super) struct SearchPoint {
    pub(super) unknowns: Unknowns,
    /// Logarithms: rms (m/s), scale (m), turning (rad/s per root second).
    pub(super) random: [f64; RANDOM],
    /// Sizes that cannot be distinguished from none, by [`SIZES`]: the size at which that was found.
    pub(super) negligible: [Option<f64>; SIZES.len()],
    /// Sizes that looked negligible, but without which the likelihood is smaller.
    pub(super) kept: [bool; SIZES.len()],
    pub(super) sought: Sought,
}

impl SearchPoint {
    /// Gusts of a size, at the scale where the search starts, and no turning.
    pub(super) fn new(unknowns: Unknowns, size_m_s: f64) -> Self {
        let (size, scale) = (size_m_s.ln(), START_SCALE_M.ln());
        let random = [size, size, scale, scale, f64::NEG_INFINITY, f64::NEG_INFINITY];
        Self { unknowns, random, negligible: [None; 4], kept: [false; 4], sought: Sought::default() }
    }
    pub(super) fn random(&self) -> Random {
        let [axial_rms_m_s, lateral_rms_m_s, axial_scale_m, lateral_scale_m, roll, across] = self.random.map(f64::exp);
        Random {
            turbulence: Turbulence { axial_rms_m_s, lateral_rms_m_s, axial_scale_m, lateral_scale_m, bandwidth: 0.0 },
            turning: [roll, across],
        }
    }
    pub(super) fn moved(&self, step: &DVector<f64>) -> Self {
        let free = self.unknowns.free();
        let mut moved = self.clone();
        moved.unknowns = self.unknowns.moved(&step.as_slice()[..free], 1.0);
        moved.random.iter_mut().enumerate().for_each(|(k, r)| *r += step[free + k]);
        moved
    }
    /// Without one of the sizes.
    pub(super) fn without(&self, size: usize) -> Self {
        let mut without = self.clone();
        let k = SIZES[size];
        without.negligible[size] = Some(self.random[k].exp());
        without.random[k] = NONE_M_S.ln();
        if k < 2 {
            without.random[2 + k] = START_SCALE_M.ln();
        }
        without
    }
    /// True for an unknown that stays where it is.
    pub(super) fn held(&self, index: usize) -> bool {
        match index.checked_sub(self.unknowns.free()) {
            None => false,
            Some(k @ (2 | 3)) => !self.sought.scales || self.negligible[k - 2].is_some(),
            Some(k) => {
                (k > 3 && !self.sought.turning)
                    || SIZES.iter().zip(&self.negligible).any(|(s, negligible)| *s == k && negligible.is_some())
            }
        }
    }
    /// True when nothing drives the runs at random.
    pub(super) fn is_still(&self) -> bool {
        self.negligible[..2].iter().all(Option::is_some)
            && (!self.sought.turning || self.negligible[2..].iter().all(Option::is_some))
    }
    pub(super) fn varied(&self, k: usize, by: f64) -> Random {
        let mut other = self.clone();
        other.random[k] += by;
        other.random()
    }
}

#[cfg(test)]
mod tests;
