//! discover: coefficients that follow settings, where they were flown. In: a fit. Out: the least and the most over the runs identified on.
//!
//! A coefficient at settings of zero, which may be far from any launch, is any number. At the settings flown it is one that a body can have.

use super::amounts::{at_settings, over_runs};
use super::contest::TrackContest;
use super::settings::Settings;
use crate::close::{FlownCoefficient, FlownValue};
use crate::tracks::{Free, TrackFit};
use windfall_model::{Campaign, Net};

/// Of the effect at a place of the best fit: what it adds, and of an amount that is never negative also what there is in all.
pub(super) fn coefficients(found: &TrackContest<'_>, settings: &Settings, place: usize) -> Vec<FlownCoefficient> {
    let (campaign, fit) = (found.campaign, &found.best.fit);
    let parameters = &fit.hypothesis.effects[place].parameters;
    let of = |(constant, slopes): (usize, Vec<(usize, usize)>)| {
        let p = &parameters[constant];
        let name = p.name.trim_end_matches("_constant");
        let added = added(campaign, settings.runs(), fit, place, constant, &slopes);
        let in_all = p.net.map_or_else(Vec::new, |Net(of)| over_runs(campaign, settings.runs(), fit, &of));
        [line(campaign, name, false, &added), line(campaign, name, true, &in_all)].into_iter().flatten().collect::<Vec<_>>()
    };
    settings.followers(parameters).into_iter().flat_map(of).collect()
}

/// Run, value and standard error of what an effect adds, at every setting.
fn added(
    campaign: &Campaign,
    runs: &[usize],
    fit: &TrackFit,
    k: usize,
    constant: usize,
    slopes: &[(usize, usize)],
) -> Vec<(usize, f64, f64)> {
    let values = &fit.hypothesis.effects[k].values;
    let place = |i: usize| fit.free.iter().position(|f| *f == Free::Effect(k, i));
    let one = |run: usize, inputs: &[f64]| {
        let terms: Vec<(usize, f64)> = std::iter::once((constant, 1.0))
            .chain(slopes.iter().map(|(i, input)| (*i, inputs.get(*input).copied().unwrap_or(0.0))))
            .collect();
        let value: f64 = terms.iter().map(|(i, u)| values[*i] * u).sum();
        let pairs = terms.iter().flat_map(|a| terms.iter().map(move |b| (a, b)));
        let covariance =
            |((i, u), (j, v)): (&(usize, f64), &(usize, f64))| Some(u * v * fit.covariance[(place(*i)?, place(*j)?)]);
        let variance: f64 = pairs.filter_map(covariance).sum();
        (run, value, variance.max(0.0).sqrt())
    };
    let plants = runs.iter().flat_map(|&r| at_settings(campaign, r, &campaign.plant).into_iter().map(move |p| (r, p)));
    plants.map(|(r, p)| one(r, &p.point.inputs)).collect()
}

fn line(campaign: &Campaign, name: &str, in_all: bool, all: &[(usize, f64, f64)]) -> Option<FlownCoefficient> {
    let value = |(run, estimate, std_error): &(usize, f64, f64)| FlownValue {
        run: campaign.runs[*run].name.clone(),
        estimate: *estimate,
        std_error: *std_error,
    };
    let least = all.iter().min_by(|a, b| a.1.total_cmp(&b.1)).map(value)?;
    let most = all.iter().max_by(|a, b| a.1.total_cmp(&b.1)).map(value)?;
    Some(FlownCoefficient { name: name.to_owned(), in_all, least, most })
}
