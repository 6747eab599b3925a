//! discover: which effects produce the published figures. In: setup and options. Out: explanations, judged on fresh runs.

use super::ensemble::{Rows, fly_runs};
use super::hypothesis::{Hypothesis, Place};
use super::judge::{self, Spread};
use super::{Explanation, Screened, StatisticsClosing, StatisticsError, StatisticsOptions, StatisticsSetup, numerics};
use nalgebra::{DMatrix, DVector};
use std::cell::Cell;
use std::ops::Range;
use windfall_model::effects::Effect;
use windfall_model::{Acts, CATALOGUE};
use windfall_pid::simplex;

mod verdict;

use verdict::Judged;

/// First run number of the judgement: fresh chance, never seen by the search.
const FINAL: u64 = 1_000_000;
/// An effect moves the figures when, somewhere in its plausible range, a figure changes by this many spreads over runs.
const MOVES: f64 = 3.0;
/// An effect leads when it closes this share of the gap alone, somewhere in its plausible range.
const LEADS: f64 = 0.25;
/// Fall of the strengths of a first effect, as places in [0, 1], over the points at which a second one is tried beside it.
const WEAKER: f64 = 0.2;
/// Means within this part of the test count as closed.
const WITHIN: f64 = 0.15;
/// Step of places in [0, 1] for derivatives: smaller ones show the chance of few runs.
const STEP: f64 = 0.05;
/// The search integrates with tolerances that much larger; the judgement does not.
const COARSER: f64 = 10.0;
/// Sample rate of the search, Hz: twenty times the highest cutoff of the smoothing.
const COARSE_RATE_HZ: f64 = 50.0;
/// First steps of the coarse and of the fine search, as places in [0, 1].
const COARSE_REACH: f64 = 0.15;
const FINE_REACH: f64 = 0.04;
/// What a shape across its whole plausible range from its typical value costs in the coarse search, as misfit: shapes that hardly
/// matter stay typical.
const SHAPE_COST: f64 = 4.0;
/// Standard deviation, of the logarithm of a figure, by which its spread is widened in the coarse search: a third of [`WITHIN`].
/// Few runs tell a covariance poorly, and far from the test a narrow one would blind the search.
const FLOOR: f64 = WITHIN / 3.0;

/// Finds the effects of the catalogue that produce the published figures, alone and in pairs.
///
/// # Errors
/// A declared model that cannot be flown, or too few runs.
pub fn close_statistics(setup: &StatisticsSetup, options: &StatisticsOptions) -> Result<StatisticsClosing, StatisticsError> {
    let used = setup.fitted();
    let needed = used.len() as u64 + 2;
    for (what, runs) in [("fine_runs", options.fine_runs), ("final_runs", options.final_runs)] {
        if runs < needed {
            return Err(StatisticsError::TooFewRuns { what, runs, figures: used.len(), needed });
        }
    }
    let [setup, coarse] = &flown(setup, options);
    Search { test: judge::logs(&setup.test_row(), &used), setup, coarse, options, used, flights: Cell::new(0) }.run()
}

/// As the judgement flies, and as the search does.
fn flown(setup: &StatisticsSetup, options: &StatisticsOptions) -> [StatisticsSetup; 2] {
    let with = |tolerance: f64| {
        let mut s = setup.clone();
        s.flown.numerics = numerics(tolerance);
        s
    };
    let (fine, mut coarse) = (with(options.relative_tolerance), with(COARSER * options.relative_tolerance));
    coarse.flown.rate_hz = setup.flight.rate_hz.min(COARSE_RATE_HZ);
    [fine, coarse]
}

struct Search<'a> {
    setup: &'a StatisticsSetup,
    coarse: &'a StatisticsSetup,
    options: &'a StatisticsOptions,
    used: Vec<usize>,
    test: DVector<f64>,
    flights: Cell<u64>,
}

/// A hypothesis at a place, and its misfit there.
#[derive(Clone)]
struct Found {
    h: Hypothesis,
    x: Place,
    misfit: f64,
}

/// What a few runs show.
struct Look {
    /// Logarithms of the mean figures.
    mean: DVector<f64>,
    /// Minus twice the normal log likelihood of the test by the mean and covariance of these runs (synthetic likelihood, Wood,
    /// Nature 466, 2010), every figure's spread widened by [`FLOOR`].
    misfit: f64,
}

impl Search<'_> {
    fn run(&self) -> Result<StatisticsClosing, StatisticsError> {
        let o = self.options;
        let null = Hypothesis::none(self.setup.flight.duration_s);
        let (before, _) = self.fly(&null, &[], FINAL..FINAL + o.final_runs)?;
        let (screened, starts) = self.screen(&null, &before);
        let singles = self.refined(self.ranked(starts), o.kept[0]);
        let pairs = self.pairs(&singles, &screened);
        let mut judged: Vec<Judged> = singles.iter().chain(&pairs).filter_map(|f| self.judge(f)).collect();
        let rank = |e: &Explanation| (!e.closes, !e.possible);
        judged.sort_by(|a, b| {
            let (a, b) = (&a.explanation, &b.explanation);
            rank(a).cmp(&rank(b)).then(a.score.total_cmp(&b.score))
        });
        self.result(&before, screened, &judged)
    }

    fn fly(&self, h: &Hypothesis, x: &[f64], runs: Range<u64>) -> Result<(Rows, f64), StatisticsError> {
        self.flights.set(self.flights.get() + runs.end - runs.start);
        fly_runs(self.setup, &h.plant(&self.setup.plant, x), runs)
    }

    /// Spread over the runs of the fine search.
    fn spread(&self, f: &Found) -> Option<Spread> {
        let runs = self.options.fine_runs;
        self.flights.set(self.flights.get() + runs);
        let (rows, _) = fly_runs(self.coarse, &f.h.plant(&self.setup.plant, &f.x), 0..runs).ok()?;
        Spread::with_floor(&rows, &self.used, FLOOR)
    }

    /// Logarithms of the mean figures over the runs of the fine search; none where a flight fails (a shape that cannot fly is no
    /// explanation).
    fn mean(&self, h: &Hypothesis, x: &[f64]) -> Option<DVector<f64>> {
        self.look(h, x, self.options.fine_runs).map(|l| l.mean)
    }

    fn look(&self, h: &Hypothesis, x: &[f64], runs: u64) -> Option<Look> {
        self.flights.set(self.flights.get() + runs);
        let (rows, _) = fly_runs(self.coarse, &h.plant(&self.setup.plant, x), 0..runs).ok()?;
        let n = rows.len() as f64;
        let mean: Vec<f64> = (0..rows[0].len()).map(|i| rows.iter().map(|r| r[i]).sum::<f64>() / n).collect();
        let mean = judge::logs(&mean, &self.used);
        let misfit = Spread::with_floor(&rows, &self.used, FLOOR)?.surprise(&self.test);
        misfit.is_finite().then_some(Look { mean, misfit })
    }

    /// Mean square of the log ratios of mean figures to the test.
    fn gap(&self, mean: &DVector<f64>) -> f64 {
        (mean - &self.test).norm_squared() / self.test.len() as f64
    }

    /// Flies every effect over its plausible range; gives those that lead, each at its best point.
    fn screen(&self, null: &Hypothesis, before: &Rows) -> (Vec<Screened>, Vec<Found>) {
        let Some(spread) = Spread::of(before, &self.used) else { return (Vec::new(), Vec::new()) };
        let declared = self.look(null, &[], self.options.screen_runs).map_or_else(|| spread.mean.clone(), |l| l.mean);
        let start = self.gap(&declared);
        let nothing = Found { h: null.clone(), x: Vec::new(), misfit: f64::INFINITY };
        let mut screened = Vec::new();
        let mut starts = Vec::new();
        for effect in pool() {
            let points = self.cover(&null.with(effect), &nothing, self.options.screen_points, self.options.screen_runs);
            let largest_change = points.iter().map(|(_, m)| change(&declared, m, &spread)).fold(0.0, f64::max);
            let gap_closed = points.iter().map(|(_, m)| closed(start, self.gap(m))).fold(0.0, f64::max);
            let best = points.into_iter().min_by(|a, b| a.0.misfit.total_cmp(&b.0.misfit));
            let leads = gap_closed >= LEADS;
            screened.push(Screened { family: effect.family, largest_change, gap_closed, moves: largest_change >= MOVES, leads });
            if let (Some((found, _)), true) = (best, leads) {
                starts.push(found);
            }
        }
        starts.sort_by(|a, b| a.misfit.total_cmp(&b.misfit));
        starts.truncate(self.options.leads);
        (screened, starts)
    }

    /// The hypothesis `both` at points over the range of the parameters that it has beyond `lead`. The strengths of `lead` fall
    /// off from where it acts alone to nearly nothing, its shapes are in turn as found and typical: what was stretched to do
    /// all the work is not what is needed beside another.
    fn cover(&self, both: &Hypothesis, lead: &Found, points: usize, runs: u64) -> Vec<(Found, DVector<f64>)> {
        let at = |k: usize| {
            let (mut h, mut place) = (both.clone(), lead.x.clone());
            place.resize(h.dimension(), 0.5);
            h.cover(lead.x.len(), k, &mut place);
            for i in lead.h.searched() {
                place[i] = if lead.h.is_strength(i) {
                    weaker(place[i], k, points)
                } else if k % 2 == 1 {
                    lead.h.typical(i)
                } else {
                    place[i]
                };
            }
            let look = self.look(&h, &place, runs)?;
            Some((Found { misfit: look.misfit, h, x: place }, look.mean))
        };
        (0..points).filter_map(at).collect()
    }

    /// Downhill from a found place, by the misfit of a few runs.
    fn search(&self, from: &Found) -> Found {
        let found = self.downhill(from, COARSE_REACH, |h, x| self.coarse_value(h, x));
        Found { misfit: self.misfit(&found.h, &found.x), ..found }
    }

    fn coarse_value(&self, h: &Hypothesis, x: &[f64]) -> f64 {
        self.misfit(h, x) + SHAPE_COST * h.shape_distance(x)
    }

    fn misfit(&self, h: &Hypothesis, x: &[f64]) -> f64 {
        self.look(h, x, self.options.coarse_runs).map_or(f64::INFINITY, |l| l.misfit)
    }

    /// Downhill from what is needed of a found place, by the misfit of more runs and, each figure for itself, by what counts as
    /// closed.
    fn refine(&self, from: &Found) -> Found {
        self.downhill(&self.spare(from), FINE_REACH, |h, x| self.fine_value(h, x))
    }

    fn fine_value(&self, h: &Hypothesis, x: &[f64]) -> f64 {
        let Some(look) = self.look(h, x, self.options.fine_runs) else { return f64::INFINITY };
        look.misfit + (look.mean - &self.test).norm_squared() / WITHIN.powi(2)
    }

    fn downhill(&self, from: &Found, reach: f64, value: impl Fn(&Hypothesis, &[f64]) -> f64) -> Found {
        let searched = from.h.searched();
        let start: Vec<f64> = searched.iter().map(|&i| from.x[i]).collect();
        let whole = |part: &[f64]| {
            let mut x = from.x.clone();
            searched.iter().zip(part).for_each(|(&i, v)| x[i] = *v);
            x
        };
        let steps = self.options.steps_per_parameter * (searched.len() + 2);
        let found = simplex::minimise(|part| value(&from.h, &whole(part)), &start, reach, steps);
        Found { h: from.h.clone(), x: whole(&found.at), misfit: found.value }
    }

    /// Misfit over the runs of the fine search, and two for every parameter (Akaike 1974).
    fn score(&self, f: &Found) -> f64 {
        let look = self.look(&f.h, &f.x, self.options.fine_runs);
        look.map_or(f64::INFINITY, |l| l.misfit + 2.0 * f.h.searched().len() as f64)
    }

    /// Holds what is not needed: strengths without which the score is no worse, one after another; then, each shape at the best
    /// of its place and the values that the catalogue tries, shapes that move no figure by a spread over runs (the number of a
    /// wave among them, which is whole).
    fn spare(&self, from: &Found) -> Found {
        let mut best = from.clone();
        let mut score = self.score(&best);
        for i in from.h.strengths() {
            let tried = Found { h: best.h.without(i), ..best.clone() };
            let without = self.score(&tried);
            if without <= score && !tried.h.strengths().is_empty() {
                (best, score) = (tried, without);
            }
        }
        let strengths = best.h.strengths();
        let shapes: Vec<usize> = best.h.searched().into_iter().filter(|i| !strengths.contains(i)).collect();
        for &i in &shapes {
            for &value in best.h.tried(i) {
                let mut tried = best.clone();
                tried.x[i] = best.h.place(i, value);
                let there = self.score(&tried);
                if there <= score {
                    (best, score) = (tried, there);
                }
            }
        }
        let spread = self.spread(&best);
        let derivative = self.mean(&best.h, &best.x).and_then(|at| self.derivative(&best, &at));
        let (Some(spread), Some(derivative)) = (spread, derivative) else { return best };
        for (k, i) in best.h.searched().into_iter().enumerate().filter(|(_, i)| shapes.contains(i)) {
            if spread.whiten(&derivative.column(k).into_owned()).norm() < 1.0 {
                best.h = best.h.holding(i, best.h.value(i, best.x[i]));
            }
        }
        best
    }

    /// Pairs of an effect that leads and one that moves the figures, searched coarsely; best first.
    fn pairs(&self, singles: &[Found], screened: &[Screened]) -> Vec<Found> {
        let moves = |e: &Effect| screened.iter().any(|s| s.moves && s.family == e.family);
        let others: Vec<&'static Effect> = pool().filter(|e| moves(e)).collect();
        let mut all: Vec<Found> = Vec::new();
        for lead in singles {
            for effect in others.iter().filter(|e| !lead.h.families().contains(&e.family)) {
                all.extend(self.beside(lead, effect));
            }
        }
        all.sort_by(|a, b| a.misfit.total_cmp(&b.misfit));
        let mut ranked = self.ranked(distinct(all).into_iter().take(self.options.pairs).collect());
        // What helps beside one lead is tried beside the others too.
        let beside_others = |f: &Found| {
            let others = singles.iter().filter(|l| !f.h.families().contains(&l.h.families()[0]));
            others.map(|l| f.beside(l)).collect::<Vec<_>>()
        };
        let twins = ranked.iter().take(self.options.kept[1]).flat_map(|(f, _)| beside_others(f)).collect();
        ranked.extend(self.ranked(twins));
        ranked.sort_by(|a, b| a.1.total_cmp(&b.1));
        let ranked = distinct(ranked.iter().map(|(f, _)| f.clone()).collect());
        ranked.iter().take(self.options.kept[1]).map(|f| self.refine(f)).collect()
    }

    /// Searched coarsely; best score first.
    fn ranked(&self, starts: Vec<Found>) -> Vec<(Found, f64)> {
        let mut scored: Vec<(Found, f64)> = starts.iter().map(|s| self.search(s)).map(|f| (f.clone(), self.score(&f))).collect();
        scored.sort_by(|a, b| a.1.total_cmp(&b.1));
        scored
    }

    /// The first `kept`, searched finely.
    fn refined(&self, ranked: Vec<(Found, f64)>, kept: usize) -> Vec<Found> {
        ranked.iter().take(kept).map(|(f, _)| self.refine(f)).collect()
    }

    /// Starts of a pair: the best point for each strength of the second effect, one at a time (more is beyond what the figures
    /// could decide).
    fn beside(&self, lead: &Found, effect: &'static Effect) -> Vec<Found> {
        let both = lead.h.with(effect);
        let own: Vec<usize> = both.strengths().into_iter().filter(|i| *i >= lead.x.len()).collect();
        let best = |one: &usize| {
            let alone = own.iter().filter(|i| *i != one).fold(both.clone(), |h, i| h.without(*i));
            let points = self.cover(&alone, lead, self.options.pair_points, self.options.screen_runs);
            points.into_iter().map(|(f, _)| f).min_by(|a, b| a.misfit.total_cmp(&b.misfit))
        };
        own.iter().filter_map(best).collect()
    }

    /// Derivative of the mean log figures `at` a place with respect to it, by differences toward the middle of [0, 1].
    fn derivative(&self, f: &Found, at: &DVector<f64>) -> Option<DMatrix<f64>> {
        let column = |k: usize| {
            let step = if f.x[k] > 0.5 { -STEP } else { STEP };
            let mut x = f.x.clone();
            x[k] += step;
            Some((self.mean(&f.h, &x)? - at) / step)
        };
        Some(DMatrix::from_columns(&f.h.searched().into_iter().map(column).collect::<Option<Vec<_>>>()?))
    }
}

impl Found {
    /// The second effect as it is here, beside another lead, whose strengths are a little weaker than alone.
    fn beside(&self, lead: &Found) -> Found {
        let own = self.h.dimension() - self.h.of_last();
        let mut h = lead.h.with(self.h.effects()[1]);
        let mut x = lead.x.clone();
        for i in lead.h.strengths() {
            x[i] = (x[i] - 0.25 * WEAKER).max(0.0);
        }
        for i in own..self.h.dimension() {
            h.copy(x.len(), &self.h, i);
            x.push(self.x[i]);
        }
        Found { h, x, misfit: f64::INFINITY }
    }
}

/// Largest change of a figure's logarithm, in spreads over runs.
fn change(declared: &DVector<f64>, mean: &DVector<f64>, spread: &Spread) -> f64 {
    (0..mean.len()).map(|i| (mean[i] - declared[i]).abs() / spread.covariance[(i, i)].sqrt()).fold(0.0, f64::max)
}

/// Share of a gap that is closed, of mean squares before and after.
fn closed(before: f64, after: f64) -> f64 {
    1.0 - (after / before).sqrt()
}

/// Place of a first effect's strength at point `k` of those at which a second one is tried beside it.
fn weaker(place: f64, k: usize, points: usize) -> f64 {
    (place - WEAKER * (k as f64 + 0.5) / points as f64).max(0.0)
}

/// The first of each set of families.
fn distinct(all: Vec<Found>) -> Vec<Found> {
    let families = |f: &Found| {
        let mut names = f.h.families();
        names.sort_unstable();
        names
    };
    let mut kept: Vec<Found> = Vec::new();
    for f in all {
        if !kept.iter().any(|k| families(k) == families(&f)) {
            kept.push(f);
        }
    }
    kept
}

/// Effects that statistics of runs can tell: without the records neither drift nor what differs between runs is seen.
fn pool() -> impl Iterator<Item = &'static Effect> {
    CATALOGUE.into_iter().filter(|e| e.acts.on(Acts::Lander) && e.acts != Acts::Runs)
}

#[cfg(test)]
mod tests;
