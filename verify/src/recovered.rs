//! verify: what was planted is found again (thesis Appendix C). In: the exact run. Out: errors of both methods.

use super::{Bound, Check, CheckKind, Setups, first};
use crate::VerifyError;
use windfall_model::Plant;
use windfall_pid::output_error::EstimateOptions;
use windfall_pid::smooth::Smoother;
use windfall_pid::{Method, identify};
use windfall_replay::{Reconstructed, Recovery, campaign_of, parameters_of, recover, recover_by};
use windfall_sim::{Seed, fly};

/// Largest error of a parameter from exact data, percent: of the issue.
const EXACT_PERCENT: f64 = 1e-3;
/// Window of the pushed run, s: from the end of the push to a second before the end.
const PUSHED_S: [f64; 2] = [8.6, 23.0];

pub(super) fn checks(setups: &Setups<'_>) -> Result<Vec<Check>, VerifyError> {
    let (plant, flight) = first(setups.appendix_c)?;
    let seed = Seed { campaign: setups.appendix_c.seed, run: 0 };
    let own = recover(plant, flight, seed, Method::EquationError)?;
    let unsmoothed = EstimateOptions { smoother: Some(Smoother::Unsmoothed), ..EstimateOptions::default() };
    let thesis = recover_by(plant, flight, seed, Method::Thesis, &unsmoothed)?;
    let mut all = reconstructed(&own);
    all.extend(parameters(
        &own,
        Bound::at_most(EXACT_PERCENT),
        "Appendix C with exact data; bound of the issue; beside it Table C.1",
    ));
    all.extend(parameters(
        &thesis,
        Bound::default(),
        "the thesis' method on the same run, not smoothed, derivatives by quadratics through five samples; beside it Table C.1",
    ));
    all.extend(pushed(setups)?);
    Ok(all)
}

/// The thesis' method on a pushed run in its own order: the whole run smoothed with Table 3.1's cutoffs, then cropped to where the pole has
/// left.
fn pushed(setups: &Setups<'_>) -> Result<Vec<Check>, VerifyError> {
    let (plant, flight) = first(setups.pole_push)?;
    let whole = fly(plant, flight, Seed { campaign: setups.pole_push.seed, run: 0 })?.record;
    let row = |t_s: f64| whole.t_s.partition_point(|t| *t < t_s);
    let declared = Plant { contacts: Vec::new(), ..plant.clone() };
    let campaign = campaign_of(&declared, &[(flight, whole.window(row(PUSHED_S[0])..row(PUSHED_S[1])))]);
    let found = identify(&campaign, Method::Thesis)?;
    let all = parameters_of(plant, &found).into_iter().map(|p| {
        let id = format!("pole-push-thesis-{}-{}", p.coefficient, p.name);
        let what = format!("{} from {}, thesis: {:.6} planted, {:.6} found", p.name, p.coefficient, p.truth, p.estimate);
        let source = "the thesis' method in its order: the whole run smoothed with Table 3.1's cutoffs, then cropped";
        Check::new(CheckKind::Recovered, id, what, (p.percent_error.abs(), "%"), Bound::default(), source)
    });
    Ok(all.collect())
}

fn parameters(r: &Recovery, bound: Bound, source: &str) -> Vec<Check> {
    r.parameters
        .iter()
        .map(|p| {
            let id = format!("appendix-c-{}-{}-{}", r.method, p.coefficient, p.name);
            let what =
                format!("{} from {}, {}: {:.6} planted, {:.6} found", p.name, p.coefficient, r.method, p.truth, p.estimate);
            let check = Check::new(CheckKind::Recovered, id, what, (p.percent_error.abs(), "%"), bound, source);
            match p.thesis_percent_error {
                Some(t) => check.beside(t),
                None => check,
            }
        })
        .collect()
}

/// Largest error of a state over its own largest value, and of a coefficient over the largest coefficient of its kind.
fn reconstructed(r: &Recovery) -> Vec<Check> {
    let relative = |s: &Reconstructed| s.largest_error / s.largest;
    let worst = |of: &[Reconstructed]| of.iter().map(relative).fold(0.0, f64::max);
    vec![
        Check::new(
            CheckKind::Recovered,
            "appendix-c-states",
            "position, velocity, rates, airspeed and angle from the record alone: largest error over largest value",
            (worst(&r.states), "1"),
            Bound::at_most(1e-5),
            "Figure C.2; splines of fifth degree at the ends of the run",
        ),
        Check::new(
            CheckKind::Recovered,
            "appendix-c-coefficients",
            "the six coefficients from the record alone: largest error over largest value",
            (worst(&r.coefficients), "1"),
            Bound::at_most(1e-3),
            "Figure C.3; second derivatives at the ends of the run",
        ),
    ]
}

#[cfg(test)]
mod tests;
