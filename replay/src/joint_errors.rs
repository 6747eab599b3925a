//! replay: parameters drawn as an identification knows them. In: a data set with covariance, a plant, chance. Out: other plants, each as
//! probable as the runs leave it.

use crate::ReplayError;
use nalgebra::{DMatrix, DVector};
use windfall_model::{Campaign, Plant, Structure};
use windfall_pid::DataSet;
use windfall_sim::{Channel, Seed};

/// Joint normal distribution of a structure's parameters about their estimates. Parameters that were held or not identified do not
/// scatter.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct JointErrors {
    root: DMatrix<f64>,
}

impl JointErrors {
    /// Of the estimates of a data set.
    pub(crate) fn of(set: &DataSet, structure: &Structure) -> Result<Self, ReplayError> {
        set.covariance_of(structure).map(Self::new).ok_or(ReplayError::NoCovariance)
    }
    /// Of this covariance, which may be singular.
    pub(crate) fn new(covariance: DMatrix<f64>) -> Self {
        Self { root: root(covariance) }
    }
    /// Moves values by one drawn error.
    pub(crate) fn scatter(&self, values: &mut [f64], mut normals: impl Iterator<Item = f64>) {
        let z = DVector::from_fn(self.root.ncols(), |_, _| normals.next().unwrap_or(0.0));
        values.iter_mut().zip((&self.root * z).iter()).for_each(|(v, d)| *v += d);
    }
    /// The plant of one draw, a function of its seed alone.
    pub(crate) fn plant(&self, estimated: &Plant, seed: Seed) -> Plant {
        let mut own = estimated.clone();
        self.scatter(&mut own.aero.values, seed.normals(Channel::Varied(127)));
        own
    }
}

/// `n` plants drawn from what a data set says of a campaign's parameters: estimates ([`DataSet::plant_in`]) and their joint normal
/// errors. Draw i is a function of the seed and i alone. Gusts, constants and effects, and what was held, are the same in all.
///
/// # Errors
/// [`ReplayError::NoCovariance`] for a set without covariance; an estimate that the plant has no place for.
pub fn drawn(campaign: &Campaign, set: &DataSet, n: usize, seed: u64) -> Result<Vec<Plant>, ReplayError> {
    let estimated = set.plant_in(campaign)?;
    let errors = JointErrors::of(set, &estimated.aero.structure)?;
    Ok((0..n).map(|i| errors.plant(&estimated, Seed { campaign: seed, run: i as u64 })).collect())
}

/// Symmetric root of a covariance that may be singular: parameters of unequal size are scaled to unit variance first.
fn root(covariance: DMatrix<f64>) -> DMatrix<f64> {
    let std = covariance.diagonal().map(|v| v.max(0.0).sqrt());
    let inverse = std.map(|s| if s > 0.0 { 1.0 / s } else { 0.0 });
    let unit = DMatrix::from_diagonal(&inverse) * covariance * DMatrix::from_diagonal(&inverse);
    let eigen = unit.symmetric_eigen();
    let roots = eigen.eigenvalues.map(|v| v.max(0.0).sqrt());
    DMatrix::from_diagonal(&std) * eigen.eigenvectors * DMatrix::from_diagonal(&roots)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_root_of_a_singular_covariance() {
        // Singular, and of unequal size.
        let c = DMatrix::from_row_slice(3, 3, &[4.0, 2e-3, 0.0, 2e-3, 1e-6, 0.0, 0.0, 0.0, 0.0]);
        let r = root(c.clone());
        assert!((&r * r.transpose() - c).abs().max() < 1e-12);
    }
}
