//! verify: the loop closed with measured data. In: a campaign and its declared model. Out: what the model lacks, its numbers,
//! and the error on held-out runs before and after.
//!
//! Tunnel runs by the one likelihood of `windfall_likelihood` (`likely`), tracks of bodies without attitude by a contest of sets whose
//! covariance has what every run has of its own (`points`). Nothing here knows a family by name.

use crate::VerifyError;
use crate::trace::{Evidence, Fit, Free, Hypothesis, PointEvidence, Problem, TunnelEvidence};
use windfall_model::{Campaign, Plant, Use};

mod figures;
mod lead;
mod likely;
mod points;
mod result;

pub use figures::{Figure, Role, Series, Topic, figures};
pub(crate) use likely::LEFT;
pub use result::{
    After, Bound, CandidateLine, ChannelResidual, Check, Closing, ConstantLine, EffectLine, Form, HeldOut, HeldOutTrajectory,
    NoiseLine, ParameterLine, SetLine, Shift, Unexplained, Verdict,
};

/// Error rates and effort.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Chance of calling what is left unexplained where it is noise.
    pub false_alarm: f64,
    /// Noisy copies of the data by which the figures' noise is measured.
    pub copies: usize,
    /// Seed of the copies.
    pub seed: u64,
    /// Flights of each held-out run when the model has random inputs; 0: held-out runs are not flown again.
    pub flights: usize,
}

impl Default for Options {
    fn default() -> Self {
        Self { false_alarm: 0.005, copies: 48, seed: 1, flights: 8 }
    }
}

/// Evidence of the runs of one use.
fn evidence(campaign: &Campaign, indices: &[usize], plant: &Plant, options: &Options) -> Result<Box<dyn Evidence>, VerifyError> {
    Ok(if campaign.is_point_mass() {
        Box::new(PointEvidence::new(campaign, indices, plant)?)
    } else {
        Box::new(TunnelEvidence::new(campaign, indices, plant, options.copies, options.seed)?)
    })
}

pub(crate) fn runs_of(campaign: &Campaign, used: Use) -> Vec<usize> {
    (0..campaign.runs.len()).filter(|&i| campaign.runs[i].used == used).collect()
}

/// Closes the loop of a campaign.
///
/// # Errors
/// A record that is not what its campaign says it is, no run to identify on, runs too short, or a declared model that cannot be fitted.
pub fn close(campaign: &Campaign, options: &Options) -> Result<Closing, VerifyError> {
    windfall_pid::plausible::plausible(campaign)?;
    if campaign.is_point_mass() { points::close(campaign, options) } else { likely::close(campaign, options) }
}

fn problem<'a>(campaign: &'a Campaign, evidence: &'a dyn Evidence) -> Problem<'a> {
    Problem { evidence, base: &campaign.plant, declared: &campaign.declared, inputs: &campaign.inputs }
}

/// Evidence of a campaign's runs to identify on and the fit of its declared model, for those who look beneath the loop.
///
/// # Errors
/// As [`close`].
pub fn declared(campaign: &Campaign, options: &Options) -> Result<(Box<dyn Evidence>, Fit), VerifyError> {
    let mut proof = evidence(campaign, &runs_of(campaign, Use::Identify), &campaign.plant, options)?;
    let fit = declared_fit(campaign, proof.as_mut())?;
    Ok((proof, fit))
}

/// Declared model alone: fitted, noise measured at the fit, fitted again.
fn declared_fit(campaign: &Campaign, proof: &mut dyn Evidence) -> Result<Fit, VerifyError> {
    let generic = vec![0.0; proof.generic().len()];
    let mut h = Hypothesis { declared: campaign.plant.aero.values.clone(), constants: Vec::new(), effects: Vec::new(), generic };
    for round in 0..3 {
        let fit = problem(campaign, proof).fit(&h, false);
        if !fit.log_likelihood.is_finite() {
            return Err(VerifyError::Fit { campaign: campaign.name.clone(), reason: fit.stop.words() });
        }
        h = fit.hypothesis.clone();
        if round == 2 {
            return Ok(fit);
        }
        proof.settle(&h.plant(&campaign.plant));
    }
    Err(VerifyError::Fit { campaign: campaign.name.clone(), reason: "no fit was made" })
}

/// Probability that the best of several families does so well by chance (Šidák 1967).
fn p_value_of_best(p: f64, families: usize) -> f64 {
    -f64::exp_m1(families as f64 * f64::ln_1p(-p.min(1.0 - 1e-16)))
}

fn parameter_lines(campaign: &Campaign, fit: &Fit) -> Vec<ParameterLine> {
    let structure = &campaign.plant.aero.structure;
    (0..structure.parameters.len())
        .filter(|&i| campaign.declared[i])
        .map(|i| {
            let f = Free::Declared(i);
            let coefficient = structure.contributions.iter().find(|c| c.parameter == i).map_or("", |c| c.coefficient.name());
            ParameterLine::new(coefficient, &structure.parameters[i], fit.hypothesis.get(f), fit.std_error(f), "-")
        })
        .collect()
}

fn p_least(c: &[ChannelResidual]) -> f64 {
    let least = c.iter().map(|x| x.p_value).fold(1.0, f64::min);
    p_value_of_best(least, c.len())
}
