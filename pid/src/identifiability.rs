//! pid: what the data can carry, before anything is fitted. In: a campaign. Out: rank and condition of the information on its declared
//! parameters, their correlations, which of them these runs cannot separate, and the errors to expect.
//!
//! Output error's sensitivities along the smoothed records (initial states and tunnel speed eliminated), at the parameters that
//! regression gives or at the declared ones; singular values of columns scaled to unit length (Belsley, Kuh and Welsch 1980, §3.2; Klein and Morelli 2006,
//! §5.5).

use crate::equations::Transition;
use crate::error::PidError;
use crate::identification::ALL_RUNS;
use crate::identify::{Method, identify_with};
use crate::information::{Correlation, Identifiability};
use crate::output_error::{EstimateOptions, FreeColumns, PreparedRun, ready, run_plants, sensitivities, unknowns};
use crate::smooth::Smoother;
use crate::{SearchKind, StopReason};
use nalgebra::DMatrix;
use windfall_model::{Campaign, Unknowns};

/// Share of the largest singular value below which a combination of parameters counts as not determined at all.
const RANK_TOLERANCE: f64 = 1e-10;
/// Part of a unit vector from which a parameter counts as belonging to a combination.
const BELONGS: f64 = 0.1;
/// Correlation from which two parameters are reported.
const REPORTED: f64 = 0.9;

/// Examines a campaign.
///
/// # Errors
/// As [`crate::output_error::identify`], but nothing is searched.
pub fn identifiability(campaign: &Campaign, options: &EstimateOptions) -> Result<Identifiability, PidError> {
    let campaign = &campaign.with_effects_in_plant();
    let plants = run_plants(campaign)?;
    let runs = ready(campaign, &plants)?;
    let mut unknowns = unknowns(campaign, options)?;
    if unknowns.free() == 0 {
        return Err(PidError::NothingToEstimate { campaign: campaign.name.clone() });
    }
    if let Ok(first) = identify_with(campaign, Method::EquationError, &Smoother::Auto)
        && let Some(set) = first.of_all_runs()
    {
        unknowns.start(&set.values(&campaign.plant.aero.structure, &unknowns.parameters()));
    }
    of_runs(&runs, &unknowns).ok_or_else(|| PidError::NoAnswer {
        campaign: campaign.name.clone(),
        set: ALL_RUNS.to_owned(),
        search: SearchKind::Identifiability,
        stop: StopReason::FlightFails,
    })
}

/// Examines runs made ready, at these unknowns; `None` where the flight cannot go on.
pub(crate) fn of_runs(runs: &[PreparedRun<'_>], unknowns: &Unknowns) -> Option<Identifiability> {
    let (c, mut work) = (FreeColumns::of(unknowns), Transition::default());
    let one = |run: &PreparedRun<'_>| run.linearise(&run.smoothed, &c, &run.noise_std.map(|s| s.max(1e-9)), &mut work);
    let linear: Vec<_> = runs.iter().map(one).collect::<Option<_>>()?;
    Some(examine(sensitivities(&linear, c.free), &unknowns.names(), &unknowns.values()))
}

/// Examines sensitivities, a row per whitened measurement.
pub(crate) fn examine(mut a: DMatrix<f64>, names: &[String], values: &[f64]) -> Identifiability {
    let free = names.len();
    let scale: Vec<f64> = a.column_iter().map(|c| c.norm()).map(|s| if s.is_normal() { s } else { 1.0 }).collect();
    a.column_iter_mut().zip(&scale).for_each(|(mut c, s)| c /= *s);
    let svd = a.svd(false, true);
    let (singular, Some(v_t)) = (&svd.singular_values, &svd.v_t) else {
        return Identifiability {
            free,
            rank: 0,
            condition: f64::MAX,
            correlations: Vec::new(),
            inseparable: Vec::new(),
            expected: Vec::new(),
        };
    };
    let largest = singular.max();
    let determined = |s: f64| s > RANK_TOLERANCE * largest;
    let rank = singular.iter().filter(|s| determined(**s)).count();
    let mut inseparable: Vec<Vec<String>> = Vec::new();
    for (k, _) in singular.iter().enumerate().filter(|(_, s)| !determined(**s)) {
        inseparable.push((0..free).filter(|j| v_t[(k, *j)].abs() > BELONGS).map(|j| names[j].clone()).collect());
    }
    let (mut correlations, mut expected) = (Vec::new(), Vec::new());
    if rank == free {
        let covariance = |i: usize, j: usize| (0..free).map(|k| v_t[(k, i)] * v_t[(k, j)] / singular[k].powi(2)).sum::<f64>();
        let errors: Vec<f64> = (0..free).map(|i| covariance(i, i).sqrt()).collect();
        for i in 0..free {
            expected.push((names[i].clone(), errors[i] / scale[i]));
            for j in i + 1..free {
                let correlation = covariance(i, j) / (errors[i] * errors[j]);
                if correlation.abs() >= REPORTED {
                    if [i, j].iter().all(|k| errors[*k] / scale[*k] > values[*k].abs()) {
                        inseparable.push(vec![names[i].clone(), names[j].clone()]);
                    }
                    correlations.push(Correlation { first: names[i].clone(), second: names[j].clone(), correlation });
                }
            }
        }
        correlations.sort_by(|a, b| b.correlation.abs().total_cmp(&a.correlation.abs()));
    }
    let condition = (largest / singular.min()).min(f64::MAX);
    Identifiability { free, rank, condition, correlations, inseparable, expected }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(n: usize) -> Vec<String> {
        ["a", "b", "c"][..n].iter().map(|s| (*s).to_owned()).collect()
    }

    /// Two parameters with sensitivities at an angle whose cosine is r have errors correlated by −r, and var = 1/(N (1 − r²)).
    #[test]
    fn exact_two_correlated_parameters() {
        let r = 0.95_f64;
        let a = DMatrix::from_row_slice(2, 2, &[2.0, 2.0 * r, 0.0, 2.0 * (1.0 - r * r).sqrt()]);
        let found = examine(a.clone(), &names(2), &[1.7, -1.7]);
        assert_eq!(examine(a, &names(2), &[1.0, 1.0]).inseparable, vec![names(2)], "errors of 1.6");
        assert_eq!((found.rank, found.correlations.len(), found.inseparable.len()), (2, 1, 0));
        assert!((found.correlations[0].correlation + r).abs() < 1e-12, "{found:?}");
        for (_, e) in &found.expected {
            assert!((e - 0.5 / (1.0 - r * r).sqrt()).abs() < 1e-12, "{found:?}");
        }
        assert!((found.condition - ((1.0 + r) / (1.0 - r)).sqrt()).abs() < 1e-10, "{found:?}");
    }

    /// Unit columns at an angle δ have singular values √2 and δ/√2: their ratio is δ/2, to rounding of 1e-16.
    #[test]
    fn exact_rank_to_a_share_of_the_largest() {
        for (angle, rank) in [(1.9e-10, 1), (2.1e-10, 2)] {
            let a = DMatrix::from_row_slice(2, 2, &[1.0, 1.0, 0.0, angle]);
            assert_eq!(examine(a, &names(2), &[1.0; 2]).rank, rank, "{angle}");
        }
    }

    #[test]
    fn exact_inseparable_parameters_are_named() {
        let a = DMatrix::from_row_slice(3, 3, &[1.0, 2.0, 0.0, 3.0, 6.0, 1.0, -1.0, -2.0, 1.0]);
        let found = examine(a, &names(3), &[1.0; 3]);
        assert_eq!((found.rank, found.inseparable), (2, vec![names(2)]));
    }
}
