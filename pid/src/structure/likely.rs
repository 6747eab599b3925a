//! pid: terms by the likelihood of trajectories. In: a campaign, pools, terms to start from. Out: chosen terms of all pools.
//!
//! Regression takes the air's speed and angles as measured; in gusts they are not, the body answers to what nobody measured, and
//! terms enter that mend it (an error in variables, which no weight of the residuals takes away). Filter error has the gusts among its
//! states. About its likeliest point its innovations are white, of known variance, and linear in the parameters of any wider
//! structure, zero or not: a regression again, on which subsets are compared. The point moves with the terms until they stay.

use super::pool::Pool;
use super::select::{FAMILY_ERROR, Reduced, SelectionRows, threshold};
use crate::PidError;
use crate::filter_error::linearised;
use windfall_model::{Aero, Campaign, Contribution, Structure};

/// Most rounds of choosing and searching again.
const ROUNDS: usize = 4;
/// Most sweeps over the pools, each chosen given the others.
const SWEEPS: usize = 6;

/// Columns of each pool among those of all.
type FreeColumns = Vec<Vec<usize>>;

/// A choice with the regression that it was made on.
pub(crate) struct Likely {
    pub(crate) reduced: Reduced,
    /// Columns of each pool; their candidates are those given.
    pub(crate) columns: FreeColumns,
    /// Chosen columns of each pool.
    pub(crate) chosen: FreeColumns,
    /// False where the terms still changed after the last round.
    pub(crate) settled: bool,
}

/// The structure of some candidates of each pool, all values zero.
pub(crate) fn structure(pools: &[Pool], candidates: &[Vec<usize>], name: &str) -> Structure {
    let mut structure = Structure { name: name.to_owned(), parameters: Vec::new(), contributions: Vec::new() };
    for (pool, some) in pools.iter().zip(candidates) {
        for &c in some {
            let parameter = structure.parameters.len();
            structure.parameters.push(pool.candidates[c].name.to_owned());
            let own = pool.candidates[c].contributions.iter();
            structure.contributions.extend(own.map(|(coefficient, term)| Contribution {
                coefficient: *coefficient,
                parameter,
                term: term.clone(),
            }));
        }
    }
    structure
}

/// Terms of largest likelihood, from a first choice; `candidates`: those of each pool that the runs excite.
///
/// # Errors
/// As [`crate::filter_error::identify`].
pub(crate) fn likely(
    campaign: &Campaign,
    pools: &[Pool],
    candidates: &[Vec<usize>],
    first: &[Vec<usize>],
) -> Result<Likely, PidError> {
    let all = structure(pools, candidates, "candidates");
    let wide = Aero { values: vec![0.0; all.parameters.len()], structure: all, extra: campaign.plant.aero.extra.clone() };
    let columns = columns_of(candidates);
    // A choice as candidates of its pool.
    let mut now: Vec<Vec<usize>> = first.to_vec();
    for round in 1.. {
        let mut narrow = campaign.clone();
        let own = structure(pools, &now, "chosen");
        narrow.declared = vec![true; own.parameters.len()];
        narrow.plant.aero = Aero { values: vec![0.0; own.parameters.len()], structure: own, extra: wide.extra.clone() };
        let rows = linearised(&narrow, &wide)?.into_iter().map(|(x, y)| SelectionRows { x, y }).collect();
        let reduced = Reduced::new(rows).without_rows();
        let place = |pool: usize, c: &usize| candidates[pool].iter().position(|k| k == c).map(|k| columns[pool][k]);
        let before: FreeColumns =
            now.iter().enumerate().map(|(p, some)| some.iter().filter_map(|c| place(p, c)).collect()).collect();
        let chosen = swept(&reduced, &reduced.runs(), &columns, before.clone());
        let settled = chosen == before;
        if settled || round == ROUNDS {
            return Ok(Likely { reduced, columns, chosen, settled });
        }
        now = chosen.iter().zip(candidates).zip(&columns).map(|((some, own), all)| back(some, own, all)).collect();
    }
    unreachable!("the rounds end by themselves")
}

/// A column for each candidate, pool after pool.
fn columns_of(candidates: &[Vec<usize>]) -> FreeColumns {
    let mut columns: FreeColumns = Vec::new();
    for some in candidates {
        let start = columns.iter().map(Vec::len).sum::<usize>();
        columns.push((start..start + some.len()).collect());
    }
    columns
}

/// Chosen columns of a pool as its candidates.
fn back(chosen: &[usize], candidates: &[usize], columns: &[usize]) -> Vec<usize> {
    chosen.iter().map(|c| candidates[c - columns[0]]).collect()
}

/// Each pool's best subset given the others', in turn until none changes.
pub(crate) fn swept(reduced: &Reduced, runs: &[usize], columns: &FreeColumns, mut chosen: FreeColumns) -> FreeColumns {
    let variance = reduced.variance();
    for _ in 0..SWEEPS {
        let before = chosen.clone();
        for pool in 0..columns.len() {
            let given: Vec<usize> = (0..columns.len()).filter(|p| *p != pool).flat_map(|p| chosen[p].clone()).collect();
            let penalty = threshold(FAMILY_ERROR / columns[pool].len().max(1) as f64, 1.0);
            if let Some(best) = reduced.subset(runs, &given, &columns[pool], variance, penalty) {
                chosen[pool] = best;
            }
        }
        if chosen == before {
            break;
        }
    }
    chosen
}

#[cfg(test)]
mod tests;
