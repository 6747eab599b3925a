//! pid: likelihood of runs in gusts. In: filters, a point. Out: twice its logarithm there, score and information.

use super::filter::{Filter, FilteredRun, Pass};
use super::point::{RANDOM, SCALE_PRIOR, SIZES, SearchPoint};
use crate::equations::Transition;
use crate::output_error::FreeColumns;
use crate::plant::START_SCALE_M;
use nalgebra::{DMatrix, DVector};
use windfall_model::{CHANNELS, PerChannel};

/// Difference of a logarithm.
const STEP: f64 = 1e-3;

/// Likelihood at a point: twice its logarithm, score and information.
pub(super) struct LocalLikelihood {
    pub(super) log_likelihood2: f64,
    pub(super) score: DVector<f64>,
    pub(super) information: DMatrix<f64>,
    /// Whitened innovations of every run, by channel.
    pub(super) whitened: Vec<PerChannel<Vec<f64>>>,
    /// Sum of squared innovations by channel.
    pub(super) left: PerChannel<f64>,
    pub(super) samples: f64,
}

/// Twice the log-likelihood alone.
pub(super) fn log_likelihood2(filters: &[Filter<'_, '_>], point: &SearchPoint, work: &mut Transition) -> Option<f64> {
    let c = FreeColumns::of(&point.unknowns);
    let without = c.held();
    let mut sum = 0.0;
    for filter in filters {
        sum += filter.run(&point.random(), &without, work)?.pass.log_likelihood2();
    }
    Some(sum - point.unknowns.prior_misfit()).filter(|s| s.is_finite())
}

/// Inverse by Cholesky of the matrix scaled to unit diagonal, or the column that spoils it.
pub(super) fn inverse(m: &DMatrix<f64>) -> Result<DMatrix<f64>, usize> {
    let scale: Vec<f64> = m.diagonal().iter().map(|d| d.sqrt()).collect();
    if let Some(column) = scale.iter().position(|s| !s.is_normal()) {
        return Err(column);
    }
    let scaled = DMatrix::from_fn(m.nrows(), m.ncols(), |i, j| m[(i, j)] / (scale[i] * scale[j]));
    let inverse = scaled.cholesky().ok_or(0_usize)?.inverse();
    Ok(DMatrix::from_fn(m.nrows(), m.ncols(), |i, j| inverse[(i, j)] / (scale[i] * scale[j])))
}

/// Likelihood of the runs at a point with its slopes; `None` where the flight cannot go on.
pub(super) fn local(filters: &[Filter<'_, '_>], point: &SearchPoint, work: &mut Transition) -> Option<LocalLikelihood> {
    let c = FreeColumns::of(&point.unknowns);
    let without = c.held();
    let (free, base) = (c.free, point.random());
    let count = free + RANDOM;
    let mut out = LocalLikelihood {
        log_likelihood2: 0.0,
        score: DVector::zeros(count),
        information: DMatrix::zeros(count, count),
        whitened: Vec::new(),
        left: [0.0; CHANNELS],
        samples: 0.0,
    };
    for filter in filters {
        let seen = filter.run(&base, &c, work)?;
        let mut varied: [Option<Pass>; RANDOM] = Default::default();
        for (k, varied) in varied.iter_mut().enumerate().filter(|(k, _)| !point.held(free + k)) {
            let other = point.varied(k, STEP);
            let pass = if SIZES.contains(&k) { filter.again(&other, &seen) } else { filter.run(&other, &without, work)?.pass };
            *varied = Some(pass);
        }
        out.add(&seen, &varied, free);
    }
    for (column, off, std) in point.unknowns.priors() {
        out.log_likelihood2 -= (off / std).powi(2);
        out.score[column] += off / (std * std);
        out.information[(column, column)] += std.powi(-2);
    }
    for k in 2..4 {
        let off = point.random[k] - START_SCALE_M.ln();
        out.log_likelihood2 -= (off / SCALE_PRIOR).powi(2);
        out.score[free + k] -= off / SCALE_PRIOR.powi(2);
        out.information[(free + k, free + k)] += SCALE_PRIOR.powi(-2);
    }
    for index in (0..count).filter(|i| point.held(*i)) {
        out.score[index] = 0.0;
        out.information.row_mut(index).fill(0.0);
        out.information.column_mut(index).fill(0.0);
        out.information[(index, index)] = 1.0;
    }
    (out.log_likelihood2.is_finite() && out.score.iter().all(|v| v.is_finite())).then_some(out)
}

impl LocalLikelihood {
    /// Adds a run: `−Σ ν²/s + ln s`, its score and its expected information (Harvey 1989, eq. 3.4.70).
    fn add(&mut self, seen: &FilteredRun, varied: &[Option<Pass>; RANDOM], free: usize) {
        let pass = &seen.pass;
        self.log_likelihood2 += pass.log_likelihood2();
        let mut whitened: PerChannel<Vec<f64>> = Default::default();
        // Slopes of an innovation in its own standard deviations.
        let mut slopes = DVector::zeros(free + RANDOM);
        for (row, (innovation, variance)) in pass.innovation.iter().zip(&pass.variance).enumerate() {
            let std = variance.sqrt();
            let e = innovation / std;
            for j in 0..free {
                slopes[j] = seen.by_parameter[row * free + j] / std;
            }
            let mut bends = [0.0; RANDOM];
            for (k, v) in varied.iter().enumerate().filter_map(|(k, v)| Some((k, v.as_ref()?))) {
                slopes[free + k] = (v.innovation[row] - innovation) / (STEP * std);
                bends[k] = (v.variance[row] / variance).ln() / STEP;
            }
            self.score.axpy(-e, &slopes, 1.0);
            self.information.syger(1.0, &slopes, &slopes, 1.0);
            for k in 0..RANDOM {
                self.score[free + k] += 0.5 * (e * e - 1.0) * bends[k];
                (0..=k).for_each(|j| self.information[(free + k, free + j)] += 0.5 * bends[k] * bends[j]);
            }
            whitened[row % CHANNELS].push(e);
            self.left[row % CHANNELS] += innovation * innovation;
        }
        self.information.fill_upper_triangle_with_lower_triangle();
        self.samples += (pass.innovation.len() / CHANNELS) as f64;
        self.whitened.push(whitened);
    }
}

#[cfg(test)]
pub(super) mod tests;
