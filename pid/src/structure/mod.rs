//! pid: which terms the data carry. In: a campaign. Out: chosen terms of every coefficient, by several criteria, with estimates.
//!
//! Smoothed derivatives leave residuals of a strong colour. On rows taken as white a spurious column then explains by chance what
//! `N/N_eff` white ones would, and what is chosen in one run does not hold in the next (thesis §4.1.1 gave up on it). Here rows are
//! cosine amplitudes over the root of the residuals' own spectrum, in which noise is white with unit variance; that spectrum comes
//! from all candidates together, so that a missing term is not taken for noise. A spurious column then gains a χ² of one degree
//! of freedom, whatever the colour, and criteria err as often as their theory says.

mod criterion;
mod data;
mod likely;
mod pool;
mod select;
mod shape;
#[cfg(test)]
mod tests;

pub use criterion::Criterion;
pub use pool::{Candidate, Pool, Symmetry, pools};
pub use select::FAMILY_ERROR;
pub use shape::{ShapeFit, ShapeSearch, Shaped};

use crate::PidError;
use crate::declared::left_out;
use crate::equation_error::{RunRows, processed};
use crate::interval::ci95;
use crate::smooth::Smoother;
use data::{PoolData, plain};
use likely::{Likely, likely, swept};
use select::Reduced;
use serde::{Deserialize, Serialize};
use windfall_model::{Aero, Campaign, Contribution, Structure};

/// What the runs of a campaign say about its structure.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Choice {
    /// By which the terms were chosen.
    pub criterion: Criterion,
    /// Runs that were used.
    pub runs: Vec<String>,
    /// One for each set of coefficients that are one vector.
    pub coefficients: Vec<CoefficientChoice>,
    /// What a user should know.
    pub warnings: Vec<String>,
}

impl Choice {
    /// The chosen structure with its estimates, as a structure file and `[aero.<name>]` declare it.
    #[must_use]
    pub fn aero(&self, name: &str) -> Aero {
        let mut structure = Structure { name: name.to_owned(), parameters: Vec::new(), contributions: Vec::new() };
        let mut values = Vec::new();
        let pools = pools();
        let candidates = || pools.iter().flat_map(|p| &p.candidates);
        for coefficient in &self.coefficients {
            for term in &coefficient.chosen {
                let Some(candidate) = candidates().find(|c| c.name == term.name) else { continue };
                let width = coefficient.shape.as_ref().filter(|s| s.name == term.name).map(|s| s.width_rad);
                let own = width.map_or_else(|| candidate.contributions.clone(), |w| data::with_width(candidate, w));
                let parameter = values.len();
                structure.parameters.push(term.name.clone());
                values.push(term.estimate);
                let contribution = |(coefficient, term)| Contribution { coefficient, parameter, term };
                structure.contributions.extend(own.into_iter().map(contribution));
            }
        }
        Aero::new(structure, values)
    }
}

/// One coefficient, or two that are one vector.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CoefficientChoice {
    /// `CA`, `CN` (with C_Y), `Cl`, `Cm` (with C_n).
    pub coefficient: String,
    /// Whitened rows: what the runs can tell, in independent numbers.
    pub rows: usize,
    /// Chosen terms.
    pub chosen: Vec<TermEstimate>,
    /// All candidates.
    pub candidates: Vec<CandidateReport>,
    /// What is not linear, where the pool has such.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shape: Option<ShapeReport>,
    /// What each criterion chooses.
    pub criteria: Vec<CriterionChoice>,
}

/// Estimate of a chosen term, dimensionless.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TermEstimate {
    /// Parameter name.
    pub name: String,
    /// Estimate.
    pub estimate: f64,
    /// Its standard error.
    pub std_error: f64,
    /// 95 % interval.
    pub ci95: [f64; 2],
}

/// What is said of a candidate.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CandidateReport {
    /// Parameter name.
    pub name: String,
    /// Which bodies may have it.
    pub symmetry: Symmetry,
    /// What it is.
    pub why: String,
    /// Partial F: of a chosen term when it leaves, of another when it enters.
    pub partial_f: f64,
    /// Share of the runs left out in turn without which it is still among the terms that predict them best; none for one run.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fold_share: Option<f64>,
    /// True where it is chosen.
    pub chosen: bool,
}

/// A term whose width was sought too.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ShapeReport {
    /// Parameter name.
    pub name: String,
    /// True where it joins the candidates, with this width.
    pub found: bool,
    /// By how much the best subset with it is better, each of its other terms paid for.
    pub gain: f64,
    /// What chance would give once in a stated number of pools.
    pub needed: f64,
    /// Likeliest width, rad.
    pub width_rad: f64,
    /// Its standard error, rad.
    pub std_error_rad: f64,
    /// 95 % interval, rad.
    pub ci95_rad: [f64; 2],
}

/// Terms by one criterion.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CriterionChoice {
    /// Criterion.
    pub criterion: Criterion,
    /// Its terms, in the pool's order.
    pub terms: Vec<String>,
    /// Its value with those terms; none for stepwise ones.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub value: Option<f64>,
}

/// Chooses the terms of every coefficient on the runs to identify on, whatever the campaign declares.
///
/// # Errors
/// No usable run or a faulty record; nothing that can be determined. Where no trajectory follows the runs, [`Criterion::Likelihood`] becomes
/// [`Criterion::Subset`] with a warning.
pub fn choose(campaign: &Campaign, criterion: Criterion) -> Result<Choice, PidError> {
    let (declaring, campaign) = (campaign, &campaign.with_effects_in_plant());
    let runs = processed(campaign, &Smoother::Auto)?;
    let mut warnings = Vec::new();
    let (mut pools, mut works) = (pools(), Vec::new());
    let shapes: Vec<Option<ShapeReport>> = pools.iter_mut().map(|pool| shaped(pool, &runs, campaign)).collect();
    for (pool, shape) in pools.iter().zip(shapes) {
        match Work::new(pool, &runs, campaign, shape) {
            Some(work) => works.push(work),
            None => warnings.push(format!(
                "{}: these runs do not tell its candidates apart from noise; no terms chosen: add longer runs",
                label(pool)
            )),
        }
    }
    if works.is_empty() {
        return Err(PidError::NothingToEstimate { campaign: campaign.name.clone() });
    }
    let mut taken = criterion;
    let mut likelihood = None;
    if criterion == Criterion::Likelihood {
        match by_likelihood(campaign, &works) {
            Ok(found) => {
                if !found.settled {
                    warnings.push(
                        "terms and point still changed each other after the last round: the data do not settle on one structure"
                            .to_owned(),
                    );
                }
                likelihood = Some(found);
            }
            Err(e) => {
                taken = Criterion::Subset;
                warnings.push(format!("terms are chosen by regression, in which gusts can bring terms that are not there: {e}"));
            }
        }
    }
    warnings.extend(left_out(declaring, taken == Criterion::Likelihood, &format!("criterion {}", taken.name())));
    let coefficients = works.iter().enumerate().map(|(i, w)| w.report(taken, likelihood.as_ref().map(|l| (i, l)))).collect();
    Ok(Choice { criterion: taken, runs: runs.iter().map(|r| r.name.clone()).collect(), coefficients, warnings })
}

fn label(pool: &Pool) -> &'static str {
    pool.coefficients.last().map_or("", |c| c.name())
}

/// The likelihood's choice. It starts from the declared terms and those usual for such bodies together: a spare term leaves in the
/// first round, a missing one can spoil the point; and where no trajectory of these follows the runs, from what regression chooses.
fn by_likelihood(campaign: &Campaign, works: &[Work<'_>]) -> Result<Likely, PidError> {
    let pools: Vec<Pool> = works.iter().map(|w| w.data.pool.clone()).collect();
    let candidates: Vec<Vec<usize>> = works.iter().map(|w| w.data.linear.clone()).collect();
    let usual: Vec<Vec<usize>> = works.iter().map(|w| w.data.usual(campaign)).collect();
    let regressed = || -> Vec<Vec<usize>> {
        works.iter().map(|w| w.reduced.best(&w.reduced.runs()).iter().map(|&c| w.data.linear[c]).collect()).collect()
    };
    likely(campaign, &pools, &candidates, &usual).or_else(|e| likely(campaign, &pools, &candidates, &regressed()).map_err(|_| e))
}

/// Widths in which a bump's is sought, rad: from what a swing passes in a sample or two to what no polynomial of the pool differs
/// from.
const WIDTHS_RAD: [f64; 2] = [0.01, 0.6];

/// Seeks the width of a pool's bump beside all its other candidates. Where the best subset with it gains what chance would give in
/// [`FAMILY_ERROR`] over the pool's size, the bump becomes a candidate like the others, of that width.
fn shaped(pool: &mut Pool, runs: &[RunRows], campaign: &Campaign) -> Option<ShapeReport> {
    let at = pool.candidates.iter().position(|c| c.shaped)?;
    let candidate = pool.candidates[at].clone();
    let (fit, gain, needed) = {
        let data = PoolData::new(pool, runs, &campaign.plant.aero)?;
        let column = |w: f64| data.shaped(&candidate, w);
        let reduced = data.reduced();
        let among = |columns: &[usize]| {
            let (linear, response) = data.base(columns);
            Shaped { linear: &linear, response: &response, column: &column, range: WIDTHS_RAD }.fit(ShapeSearch::GaussNewton)
        };
        let all: Vec<usize> = (0..reduced.columns()).collect();
        let first = among(&all)?;
        let own = reduced.columns();
        let wider = data.reduced_with(&column(first.shape)?[0]);
        let each = select::threshold(FAMILY_ERROR / own.max(1) as f64, 1.0);
        let with = wider.subset(&reduced.runs(), &[own], &all, wider.variance(), each)?;
        let gain = gained([&reduced, &wider], [&reduced.best(&reduced.runs()), &with], each)?;
        (among(&with)?, gain, select::threshold(FAMILY_ERROR / own.max(1) as f64, 2.0))
    };
    let found = gain > needed && fit.inside;
    if found {
        pool.candidates[at].contributions = data::with_width(&candidate, fit.shape);
        pool.candidates[at].shaped = false;
    }
    Some(ShapeReport {
        name: candidate.name.to_owned(),
        found,
        gain,
        needed,
        width_rad: fit.shape,
        std_error_rad: fit.shape_std_error,
        ci95_rad: ci95(fit.shape, fit.shape_std_error),
    })
}

/// By how much some terms with the last column of a wider regression are better than others without it, each term but that column at
/// its price.
fn gained([narrow, wider]: [&Reduced; 2], [without, with]: [&[usize]; 2], each: f64) -> Option<f64> {
    let variance = wider.variance();
    let rss = |r: &Reduced, columns: &[usize]| r.solve(&r.runs(), columns).map(|s| s.rss / variance);
    let cost = rss(wider, &[with, &[narrow.columns()]].concat())? + each * with.len() as f64;
    Some(rss(narrow, without)? + each * without.len() as f64 - cost)
}

/// One pool's data.
struct Work<'a> {
    data: PoolData<'a>,
    white: Reduced,
    reduced: Reduced,
    shape: Option<ShapeReport>,
}

impl<'a> Work<'a> {
    fn new(pool: &'a Pool, runs: &'a [RunRows], campaign: &Campaign, shape: Option<ShapeReport>) -> Option<Self> {
        let aero = &campaign.plant.aero;
        let data = PoolData::new(pool, runs, aero)?;
        Some(Self { white: plain(pool, &data.linear, runs, aero), reduced: data.reduced(), data, shape })
    }

    fn name(&self, column: usize) -> String {
        self.data.pool.candidates[self.data.linear[column]].name.to_owned()
    }

    /// What every criterion chooses, and what is said of the terms by that taken. `likelihood`: this pool's number, and the choice.
    fn report(&self, taken: Criterion, likelihood: Option<(usize, &Likely)>) -> CoefficientChoice {
        let mut criteria = Vec::new();
        let mut chosen = Vec::new();
        for criterion in Criterion::ALL {
            let rows = if matches!(criterion, Criterion::WhiteF | Criterion::WhitePse) { &self.white } else { &self.reduced };
            let found = match (criterion, likelihood) {
                (Criterion::Likelihood, Some((i, l))) => Some((l.own(i), Vec::new())),
                _ => rows.choose(criterion),
            };
            let Some((columns, values)) = found else { continue };
            criteria.push(CriterionChoice {
                criterion,
                terms: columns.iter().map(|&c| self.name(c)).collect(),
                value: values.get(columns.len()).copied(),
            });
            if criterion == taken {
                chosen = columns;
            }
        }
        let regressed = match likelihood {
            Some((i, l)) => l.regressed(i),
            None => Regressed::of(&self.reduced, &chosen),
        };
        let candidate = |k: usize| {
            let c = &self.data.pool.candidates[self.data.linear[k]];
            CandidateReport {
                name: c.name.to_owned(),
                symmetry: c.symmetry,
                why: c.why.to_owned(),
                partial_f: regressed.partial_f[k],
                fold_share: regressed.fold_share.as_ref().map(|s| s[k]),
                chosen: chosen.contains(&k),
            }
        };
        CoefficientChoice {
            coefficient: label(self.data.pool).to_owned(),
            rows: self.reduced.count,
            chosen: regressed.estimates.iter().map(|&(c, estimate, std_error)| self.estimate(c, estimate, std_error)).collect(),
            candidates: (0..self.data.linear.len()).map(candidate).collect(),
            shape: self.shape.clone(),
            criteria,
        }
    }

    fn estimate(&self, column: usize, estimate: f64, std_error: f64) -> TermEstimate {
        TermEstimate { name: self.name(column), estimate, std_error, ci95: ci95(estimate, std_error) }
    }
}

/// What a regression says of a pool's candidates.
pub(crate) struct Regressed {
    partial_f: Vec<f64>,
    fold_share: Option<Vec<f64>>,
    /// Column, estimate, standard error of each chosen term.
    estimates: Vec<(usize, f64, f64)>,
}

impl Regressed {
    fn of(reduced: &Reduced, chosen: &[usize]) -> Self {
        Self {
            partial_f: (0..reduced.columns()).map(|k| reduced.partial_f(chosen, k).unwrap_or(0.0)).collect(),
            fold_share: reduced.fold_shares(|runs| reduced.best(runs)),
            estimates: reduced.estimates(chosen),
        }
    }
}

impl Likely {
    /// A pool's chosen columns, counted from its first.
    fn own(&self, pool: usize) -> Vec<usize> {
        let first = self.columns[pool].first().copied().unwrap_or(0);
        self.chosen[pool].iter().map(|c| c - first).collect()
    }
    fn regressed(&self, pool: usize) -> Regressed {
        let all = self.chosen.concat();
        let (from, columns) = (self.columns[pool].first().copied().unwrap_or(0), &self.columns[pool]);
        let shares = self.reduced.fold_shares(|runs| swept(&self.reduced, runs, &self.columns, self.chosen.clone()).concat());
        let mine = |e: &(usize, f64, f64)| columns.contains(&e.0);
        Regressed {
            partial_f: columns.iter().map(|&k| self.reduced.partial_f(&all, k).unwrap_or(0.0)).collect(),
            fold_share: shares.map(|s| columns.iter().map(|&c| s[c]).collect()),
            estimates: self.reduced.estimates(&all).into_iter().filter(mine).map(|(c, e, s)| (c - from, e, s)).collect(),
        }
    }
}
