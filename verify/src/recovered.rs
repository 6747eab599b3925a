//! verify: what was planted is found again (thesis Appendix C). In: the exact run. Out: errors of both methods.

use super::{Bound, Check, CheckKind, Setups, first};
use crate::VerifyError;
use windfall_pid::Method;
use windfall_replay::{Reconstructed, Recovery, recover};
use windfall_sim::Seed;

/// Largest error of a parameter from exact data, percent: of the issue.
const EXACT_PERCENT: f64 = 1e-3;

pub(super) fn checks(setups: &Setups<'_>) -> Result<Vec<Check>, VerifyError> {
    let (plant, flight) = first(setups.appendix_c)?;
    let seed = Seed { campaign: setups.appendix_c.seed, run: 0 };
    let own = recover(plant, flight, seed, Method::EquationError)?;
    let thesis = recover(plant, flight, seed, Method::Thesis)?;
    let mut all = reconstructed(&own);
    all.extend(parameters(
        &own,
        Bound::at_most(EXACT_PERCENT),
        "Appendix C with exact data; bound of the issue; beside it Table C.1",
    ));
    all.extend(parameters(
        &thesis,
        Bound::default(),
        "the thesis' method with Table 3.1's cutoffs on the same run; beside it Table C.1",
    ));
    Ok(all)
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
