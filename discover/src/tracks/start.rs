//! discover: the initial state of a track. In: a plant. Out: the state that flies nearest to the record, and what it leaves.

use super::track::{STATE_STEP, Track};
use nalgebra::{DMatrix, DVector};
use windfall_model::{Measured, Plant};

/// Largest last step of an initial state over its unit (velocities times the duration), of tracks up to a hundred units long; in
/// proportion beyond.
const TOLERANCE: f64 = 1e-11;
/// Share of the stated noise below which steps of an initial state that shrink no more are done with.
const NEGLIGIBLE: f64 = 1e-4;
/// Share of a swing's samples that its start is guessed from.
const FIRST_SHARE: usize = 25;
/// Steps of the search for an initial state.
pub(super) const STEPS: usize = 40;

impl Track {
    /// What an initial state leaves of the record.
    pub(super) fn left(&self, own: &Plant, theta: &DVector<f64>) -> Option<DVector<f64>> {
        Some(&self.measured - self.flown(own, theta)?)
    }

    /// Initial state of least squares by Gauss-Newton from a start, and its residual.
    pub(super) fn least_squares(&self, own: &Plant, start: DVector<f64>) -> Option<(DVector<f64>, DVector<f64>)> {
        if self.kind() == Measured::SpecificForce {
            return self.launched(own);
        }
        if self.given {
            let e = self.left(own, &start)?;
            return Some((start, e));
        }
        let mut theta = start;
        for _ in 0..STEPS {
            let (flown, jacobian) = self.linearised(own, &theta)?;
            let step = jacobian.svd(true, true).solve(&(&self.measured - flown), 1e-12).ok()?;
            theta += &step;
            if step.amax() < 1e-9 {
                break;
            }
        }
        let e = self.left(own, &theta)?;
        Some((theta, e))
    }

    /// Initial state of the best parabola per axis; of an angle, which swings, of the best cubic over its first samples.
    pub(super) fn guess(&self) -> Option<DVector<f64>> {
        let (all, end) = (self.t_s.len(), self.duration_s());
        let swings = self.kind() == Measured::Angle;
        let (n, terms) = if swings { ((all / FIRST_SHARE).max(8).min(all), 4) } else { (all, 3) };
        let powers = DMatrix::from_fn(n, terms, |i, k| (self.t_s[i] / end).powi(k as i32));
        let svd = powers.svd(true, true);
        let moves = self.motions();
        let mut theta = DVector::zeros(moves + self.axes.len());
        for a in 0..moves {
            let c = svd.solve(&self.measured.rows(a * all, n), 1e-12).ok()?;
            theta[a] = self.scales[a] * c[0];
            theta[moves + a] = self.scales[a] * c[1];
        }
        Some(theta)
    }

    /// What would be recorded and its change with the initial state. With the place exact where nothing depends on it; central differences
    /// otherwise, and for velocities, of a tenth of a millimetre at the end.
    pub(super) fn linearised(&self, own: &Plant, theta: &DVector<f64>) -> Option<(DVector<f64>, DMatrix<f64>)> {
        let (n, m) = (self.t_s.len(), self.axes.len());
        let placeless = match self.kind() {
            Measured::Position if own.point.atmosphere.is_none() => m,
            Measured::Pose => 3,
            _ => 0,
        };
        let states = self.motions() + m;
        let mut jacobian = DMatrix::zeros(self.measured.len(), states);
        for a in 0..states {
            if a < placeless {
                jacobian.column_mut(a).rows_mut(a * n, n).fill(1.0 + own.sensors.length_scale);
                continue;
            }
            let h = STATE_STEP * self.size;
            let mut moved = theta.clone();
            moved[a] += h;
            let up = self.flown(own, &moved)?;
            moved[a] -= 2.0 * h;
            let down = self.flown(own, &moved)?;
            jacobian.set_column(a, &((up - down) / (2.0 * h)));
        }
        Some((self.flown(own, theta)?, jacobian))
    }

    /// Initial state under a plant, and the residual that it leaves, orthogonal to the state basis; Broyden's (1965) method
    /// from the state under the plant of the bases, so that the answer depends on the plant alone.
    pub(super) fn estimated(&self, plant: &Plant) -> Option<(DVector<f64>, DVector<f64>)> {
        let own = self.own(plant);
        if self.kind() == Measured::SpecificForce {
            return self.launched(&own);
        }
        let mut theta = self.start.clone();
        let mut inverse = self.state_inverse.clone();
        if self.given {
            return self.least_squares(&own, theta);
        }
        let mut e = self.left(&own, &theta)?;
        let mut g = self.state_basis.tr_mul(&e);
        for _ in 0..STEPS {
            let step = &inverse * &g;
            theta += &step;
            e = self.left(&own, &theta)?;
            if step.amax() < TOLERANCE * self.size {
                return Some((theta, e));
            }
            let next = self.state_basis.tr_mul(&e);
            improve(&mut inverse, &step, &(&g - &next));
            g = next;
        }
        self.estimated_by_newton(&own)
    }

    /// The same by Newton's method with a Jacobian at every step, for swings, long climbs and falls by much more drag that Broyden's does not follow. Where a flight is no
    /// smooth function of its start - a table has kinks - steps come to go to and fro; that is an answer where they are far below the noise.
    fn estimated_by_newton(&self, own: &Plant) -> Option<(DVector<f64>, DVector<f64>)> {
        let mut theta = self.start.clone();
        let mut last = f64::INFINITY;
        for _ in 0..STEPS {
            let (flown, jacobian) = self.linearised(own, &theta)?;
            let e = &self.measured - flown;
            let step = (self.state_basis.transpose() * jacobian).try_inverse()? * self.state_basis.tr_mul(&e);
            theta += &step;
            let size = step.amax();
            if self.is_last(size, last) {
                let e = self.left(own, &theta)?;
                return Some((theta, e));
            }
            last = size;
        }
        None
    }

    /// Whether a search is done with a step of that size, after one of size `last`: at round-off, or where steps shrink no more and
    /// are far below the noise.
    fn is_last(&self, size: f64, last: f64) -> bool {
        size < 1e-9 * self.size || (size > 0.5 * last && size < NEGLIGIBLE * self.std)
    }
}

/// Broyden's rank-one change of an inverse, after which it takes the change `y` that was seen to the step that made it:
/// `inverse += (step − inverse·y) stepᵀ·inverse / (stepᵀ·inverse·y)`.
fn improve(inverse: &mut DMatrix<f64>, step: &DVector<f64>, y: &DVector<f64>) {
    let by = &*inverse * y;
    let scale = step.dot(&by);
    if scale.abs() > 0.0 {
        let row = inverse.tr_mul(step);
        *inverse += (step - by) * row.transpose() / scale;
    }
}

#[cfg(test)]
mod tests;
