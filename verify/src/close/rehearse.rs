//! verify: what the method itself does to its answer. In: a fit. Out: the bias of every number, from a flight whose truth is known.
//!
//! The fitted model is flown like every run without noise and fitted by the very same processing; what comes back differs from
//! what was put in by the bias of smoothing and projection alone (Gouriéroux, Monfort and Renault 1993, indirect inference, to
//! first order). Random inputs are not in such a flight, so a fit that has any is left as it is.

use super::{Options, problem};
use crate::resimulate::fly_like;
use crate::trace::{Evidence, Fit, Free, TunnelEvidence};
use rayon::prelude::*;
use windfall_model::{Campaign, Data};

/// Copies for the weights of a fit to data without noise.
const COPIES: usize = 8;

/// Bias of each free number of a fit; `None` where it cannot be measured.
pub(super) fn bias(campaign: &Campaign, indices: &[usize], fit: &Fit, options: &Options) -> Option<Vec<(Free, f64)>> {
    let plant = fit.hypothesis.plant(&campaign.plant);
    if campaign.is_point_mass() || !plant.disturbances(1.0).is_empty() {
        return None;
    }
    let flown: Vec<(usize, Data)> = indices
        .par_iter()
        .map(|&i| {
            let Data::Tunnel(record) = &campaign.runs[i].data else { return None };
            let own = campaign.plant_for(&plant, i);
            Some((i, Data::Tunnel(fly_like(record, &own, None, None).ok()?.record)))
        })
        .collect::<Option<_>>()?;
    let mut rehearsal = campaign.clone();
    for (i, data) in flown {
        rehearsal.runs[i].data = data;
    }
    let mut evidence =
        TunnelEvidence::new(&rehearsal, indices, &campaign.plant, COPIES.min(options.copies), options.seed).ok()?;
    evidence.settle(&plant);
    evidence.forget_copies();
    let again = problem(&rehearsal, &evidence).fit(&fit.hypothesis, true);
    let known = again.log_likelihood.is_finite() && again.free == fit.free;
    known.then(|| fit.free.iter().map(|f| (*f, again.hypothesis.get(*f) - fit.hypothesis.get(*f))).collect())
}
