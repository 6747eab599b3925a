//! verify: which effects produce the published figures. In: setup and options. Out: explanations, judged on fresh runs.

use super::ensemble::{Rows, fly_runs, quantile, true_runs};
use super::hypothesis::{Hypothesis, Place};
use super::judge::{self, Spread, Tangent};
use super::simplex;
use super::table::conclusions;
use super::{
    Estimated, Explanation, Figure, FigureOver, Screened, Separation, StatisticsClosing, StatisticsError, StatisticsOptions,
    StatisticsSetup, numerics,
};
use nalgebra::{DMatrix, DVector};
use std::cell::Cell;
use std::ops::Range;
use windfall_model::effects::Effect;
use windfall_model::{Acts, CATALOGUE};

/// First run number of the judgement: fresh chance, never seen by the search.
const FINAL: u64 = 1_000_000;
/// An effect moves the figures when, somewhere in its plausible range, a figure changes by this many spreads over runs.
const MOVES: f64 = 3.0;
/// An effect leads when it closes this share of the gap alone, somewhere in its plausible range.
const LEADS: f64 = 0.25;
/// Points over the range of a second effect that are tried beside the best of the first.
const PAIR_POINTS: usize = 3;
/// Means within this part of the test count as closed.
const WITHIN: f64 = 0.15;
/// Level of rejection.
const LEVEL: f64 = 0.05;
/// Step of places in [0, 1] for derivatives.
const STEP: f64 = 0.02;
/// The coarse search integrates with tolerances that much larger; what is left of that goes in the fine search.
const COARSER: f64 = 10.0;
/// What a shape across its whole plausible range from its typical value costs in the coarse search, as rms of log ratios: shapes
/// that hardly matter stay typical.
const ASTRAY: f64 = 0.15;

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
    let with = |tolerance: f64| {
        let mut s = setup.clone();
        s.flown.numerics = numerics(tolerance);
        s
    };
    let (setup, coarse) = (&with(options.relative_tolerance), &with(COARSER * options.relative_tolerance));
    Search { test: judge::logs(&setup.test_row(), &used), setup, coarse, options, used, flights: Cell::new(0) }.run()
}

struct Search<'a> {
    setup: &'a StatisticsSetup,
    coarse: &'a StatisticsSetup,
    options: &'a StatisticsOptions,
    used: Vec<usize>,
    test: DVector<f64>,
    flights: Cell<u64>,
}

/// A hypothesis at a place, and how far its mean is from the test there (rms of log ratios, squared).
#[derive(Clone)]
struct Found {
    h: Hypothesis,
    x: Place,
    distance: f64,
}

/// A judged explanation with what later comparisons need.
struct Judged {
    explanation: Explanation,
    rows: Rows,
    spread: Spread,
    tangent: Tangent,
    found: Found,
}

impl Search<'_> {
    fn run(&self) -> Result<StatisticsClosing, StatisticsError> {
        let o = self.options;
        let null = Hypothesis::none(self.setup.flight.duration_s);
        let (before, _) = self.fly(&null, &[], FINAL..FINAL + o.final_runs)?;
        let (screened, starts) = self.screen(&null, &before);
        let mut singles: Vec<(Found, f64)> = starts.iter().map(|s| self.refine(&self.search(s))).collect();
        singles.sort_by(|a, b| a.1.total_cmp(&b.1));
        singles.truncate(o.kept[0]);
        let pairs = self.pairs(&singles, &screened);
        let mut judged: Vec<Judged> = singles.iter().chain(&pairs).filter_map(|(f, _)| self.judge(f)).collect();
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

    /// Logarithms of the mean figures over the runs of the fine search; none where a flight fails (a shape that cannot fly is no
    /// explanation).
    fn mean(&self, h: &Hypothesis, x: &[f64]) -> Option<DVector<f64>> {
        self.mean_of(self.setup, h, x, self.options.fine_runs)
    }

    fn mean_of(&self, setup: &StatisticsSetup, h: &Hypothesis, x: &[f64], runs: u64) -> Option<DVector<f64>> {
        self.flights.set(self.flights.get() + runs);
        let (rows, _) = fly_runs(setup, &h.plant(&setup.plant, x), 0..runs).ok()?;
        let n = rows.len() as f64;
        let mean: Vec<f64> = (0..rows[0].len()).map(|i| rows.iter().map(|r| r[i]).sum::<f64>() / n).collect();
        Some(judge::logs(&mean, &self.used)).filter(|m| m.iter().all(|v| v.is_finite()))
    }

    fn gap(&self, mean: Option<&DVector<f64>>) -> f64 {
        mean.map_or(f64::INFINITY, |m| (m - &self.test).norm_squared() / self.test.len() as f64)
    }

    /// Flies every effect over its plausible range; gives those that lead, each at its best point.
    fn screen(&self, null: &Hypothesis, before: &Rows) -> (Vec<Screened>, Vec<Found>) {
        let Some(spread) = Spread::of(before, &self.used) else { return (Vec::new(), Vec::new()) };
        let declared = self.mean_of(self.coarse, null, &[], self.options.screen_runs).unwrap_or_else(|| spread.mean.clone());
        let start = self.gap(Some(&declared));
        let mut screened = Vec::new();
        let mut starts = Vec::new();
        for effect in CATALOGUE.into_iter().filter(|e| e.acts == Acts::Lander) {
            let points = self.cover(&null.with(effect), &[], self.options.screen_points, self.options.screen_runs);
            let change = |m: &DVector<f64>| {
                (0..m.len()).map(|i| (m[i] - declared[i]).abs() / spread.covariance[(i, i)].sqrt()).fold(0.0, f64::max)
            };
            let largest_change = points.iter().map(|(_, m)| change(m)).fold(0.0, f64::max);
            let best = points.into_iter().min_by(|a, b| a.0.distance.total_cmp(&b.0.distance));
            let gap_closed = best.as_ref().map_or(0.0, |(f, _)| 1.0 - (f.distance / start).sqrt());
            let leads = gap_closed >= LEADS;
            screened.push(Screened { family: effect.family, largest_change, gap_closed, moves: largest_change >= MOVES, leads });
            if let (Some((found, _)), true) = (best, leads) {
                starts.push(found);
            }
        }
        starts.sort_by(|a, b| a.distance.total_cmp(&b.distance));
        starts.truncate(self.options.leads);
        (screened, starts)
    }

    /// The hypothesis `both` at points over the range of its parameters from number `x.len()` on, the others at `x`.
    fn cover(&self, both: &Hypothesis, x: &[f64], points: usize, runs: u64) -> Vec<(Found, DVector<f64>)> {
        let at = |k: usize| {
            let (mut h, mut place) = (both.clone(), x.to_vec());
            place.resize(h.dimension(), 0.5);
            h.cover(x.len(), k, &mut place);
            let mean = self.mean_of(self.coarse, &h, &place, runs)?;
            Some((Found { distance: self.gap(Some(&mean)), h, x: place }, mean))
        };
        (0..points).filter_map(at).collect()
    }

    /// Downhill from a found place, by log ratios of means over a few runs.
    fn search(&self, from: &Found) -> Found {
        let h = &from.h;
        let searched = h.searched();
        let start: Vec<f64> = searched.iter().map(|&i| from.x[i]).collect();
        let whole = |part: &[f64]| {
            let mut x = from.x.clone();
            searched.iter().zip(part).for_each(|(&i, v)| x[i] = *v);
            x
        };
        let gap = |x: &[f64]| self.gap(self.mean_of(self.coarse, h, x, self.options.coarse_runs).as_ref());
        let value = |part: &[f64]| {
            let x = whole(part);
            gap(&x) + ASTRAY * ASTRAY * h.astray(&x)
        };
        let steps = self.options.steps_per_parameter * (searched.len() + 2);
        let (part, _) = simplex::minimise(value, &start, 0.15, steps);
        let x = whole(&part);
        Found { h: h.clone(), distance: gap(&x), x }
    }

    /// The fine search: Gauss and Newton's steps, differences weighted by the covariance over runs at the coarse estimate (two
    /// steps, Hansen 1982) and by what counts as closed. Gives its score too (see [`Explanation::score`]).
    fn refine(&self, from: &Found) -> (Found, f64) {
        let spare = self.spare(from);
        let best = self.stepped(&spare).unwrap_or(spare);
        let score = self.score(&best);
        (best, score)
    }

    fn score(&self, f: &Found) -> f64 {
        let spread = self.fly(&f.h, &f.x, 0..self.options.fine_runs).ok().and_then(|(r, _)| Spread::of(&r, &self.used));
        spread.map_or(f64::INFINITY, |s| s.surprise(&self.test) + 2.0 * f.h.searched().len() as f64)
    }

    /// Holds what is not needed: strengths without which the score is no worse, one after another, then shapes that move no
    /// figure by a spread over runs across their plausible range.
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
        let spread = self.fly(&best.h, &best.x, 0..self.options.fine_runs).ok().and_then(|(r, _)| Spread::of(&r, &self.used));
        let derivative = self.mean(&best.h, &best.x).and_then(|at| self.derivative(&best, &at));
        let (Some(spread), Some(derivative)) = (spread, derivative) else { return best };
        let strengths = best.h.strengths();
        for (k, i) in best.h.searched().into_iter().enumerate().filter(|(_, i)| !strengths.contains(i)) {
            if spread.whiten(&derivative.column(k).into_owned()).norm() < 1.0 {
                best.h = best.h.without(i);
            }
        }
        best
    }

    fn stepped(&self, from: &Found) -> Option<Found> {
        let mut best = from.clone();
        let (rows, _) = self.fly(&from.h, &from.x, 0..self.options.fine_runs).ok()?;
        let spread = Spread::of(&rows, &self.used)?;
        let closed = 1.0 / (WITHIN * (self.used.len() as f64).sqrt());
        let stack = |d: &DVector<f64>| {
            let w = spread.whiten(d);
            DVector::from_iterator(2 * d.len(), w.iter().copied().chain(d.iter().map(|v| v * closed)))
        };
        let mut mean = self.mean(&best.h, &best.x)?;
        for _ in 0..self.options.fine_steps {
            let Some(derivative) = self.derivative(&best, &mean) else { break };
            let r = stack(&(&mean - &self.test));
            let columns: Vec<DVector<f64>> = derivative.column_iter().map(|c| stack(&c.into_owned())).collect();
            let a = DMatrix::from_columns(&columns);
            // A step of a tenth of the range costs one spread: what the figures do not decide stays where it is.
            let normal = a.transpose() * &a + DMatrix::identity(a.ncols(), a.ncols()) * 100.0_f64.min(r.norm_squared());
            let Some(step) = normal.lu().solve(&(-(a.transpose() * &r))) else { break };
            let tried = [1.0, 0.3].into_iter().find_map(|part| {
                let mut x = best.x.clone();
                best.h.searched().into_iter().zip(step.iter()).for_each(|(i, s)| x[i] = (x[i] + part * s).clamp(0.0, 1.0));
                let m = self.mean(&best.h, &x)?;
                (stack(&(&m - &self.test)).norm_squared() < r.norm_squared()).then_some((x, m))
            });
            let Some((x, m)) = tried else { break };
            best = Found { distance: self.gap(Some(&m)), x, h: best.h };
            mean = m;
        }
        Some(best)
    }

    /// Pairs of an effect that leads and one that moves the figures, searched coarsely; best first.
    fn pairs(&self, singles: &[(Found, f64)], screened: &[Screened]) -> Vec<(Found, f64)> {
        let moves = |e: &Effect| screened.iter().any(|s| s.moves && s.family == e.family);
        let others: Vec<&'static Effect> = CATALOGUE.into_iter().filter(|e| e.acts == Acts::Lander && moves(e)).collect();
        let mut all: Vec<Found> = Vec::new();
        for (lead, _) in singles {
            for effect in others.iter().filter(|e| !lead.h.families().contains(&e.family)) {
                // One strength of the second effect at a time: more than the figures could decide.
                let both = lead.h.with(effect);
                let own: Vec<usize> = both.strengths().into_iter().filter(|i| *i >= lead.x.len()).collect();
                for one in &own {
                    let alone = own.iter().filter(|i| *i != one).fold(both.clone(), |h, i| h.without(*i));
                    let points = self.cover(&alone, &lead.x, PAIR_POINTS, self.options.coarse_runs);
                    all.extend(points.into_iter().map(|(f, _)| f).min_by(|a, b| a.distance.total_cmp(&b.distance)));
                }
            }
        }
        all.sort_by(|a, b| a.distance.total_cmp(&b.distance));
        let mut kept: Vec<Found> = Vec::new();
        for f in all {
            let mut families = f.h.families();
            families.sort_unstable();
            let known = kept.iter().any(|k| {
                let mut other = k.h.families();
                other.sort_unstable();
                other == families
            });
            if !known {
                kept.push(f);
            }
        }
        kept.truncate(2 * self.options.kept[1]);
        let mut found: Vec<Found> = kept.iter().map(|f| self.search(f)).collect();
        found.sort_by(|a, b| a.distance.total_cmp(&b.distance));
        found.truncate(self.options.kept[1]);
        let mut refined: Vec<(Found, f64)> = found.iter().map(|f| self.refine(f)).collect();
        refined.sort_by(|a, b| a.1.total_cmp(&b.1));
        refined
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

    fn judge(&self, f: &Found) -> Option<Judged> {
        let runs = self.options.final_runs;
        let (rows, left_section) = self.fly(&f.h, &f.x, FINAL..FINAL + runs).ok()?;
        let spread = Spread::of(&rows, &self.used)?;
        let at = self.mean(&f.h, &f.x)?;
        let tangent = Tangent::new(&spread, &self.derivative(f, &at)?);
        let z = spread.whiten(&(&self.test - &spread.mean));
        let figures = over(&self.setup.figures, &rows);
        let p_value = judge::p_value(&spread, &tangent, &rows, &self.test, &self.used);
        let closes = figures.iter().filter(|f| f.fitted).all(|f| f.inside && f.relative.abs() <= WITHIN);
        let explanation = Explanation {
            families: f.h.families(),
            parameters: parameters(f, &tangent.std_errors(self.options.fine_runs as usize)),
            figures,
            j: tangent.left(&z),
            degrees: tangent.degrees(),
            p_value,
            possible: p_value >= LEVEL,
            closes,
            score: spread.surprise(&self.test) + 2.0 * tangent.rank() as f64,
            left_section,
        };
        Some(Judged { explanation, rows, spread, tangent, found: f.clone() })
    }

    fn result(&self, before: &Rows, screened: Vec<Screened>, judged: &[Judged]) -> Result<StatisticsClosing, StatisticsError> {
        let o = self.options;
        let nothing = Spread::of(before, &self.used).map(|s| {
            let t = Tangent::new(&s, &DMatrix::zeros(self.used.len(), 0));
            judge::p_value(&s, &t, before, &self.test, &self.used)
        });
        let before_p_value = nothing.unwrap_or(0.0);
        let explanations: Vec<Explanation> = judged.iter().map(|j| j.explanation.clone()).collect();
        let processing = judged.first().map_or(Ok(Vec::new()), |j| self.processing(&j.found))?;
        let separations = self.separations(judged);
        let verdict = match explanations.first() {
            _ if before_p_value >= LEVEL => "consistent",
            Some(e) if e.closes => "effect",
            _ => "unexplained",
        };
        let mut closing = StatisticsClosing {
            verdict,
            name: self.setup.name.clone(),
            source: self.setup.source.clone(),
            options: *o,
            seed: self.setup.seed,
            search_runs: [0, o.fine_runs],
            final_runs: [FINAL, FINAL + o.final_runs],
            source_simulation: self.setup.figures.iter().map(|f| f.simulation).collect(),
            before: over(&self.setup.figures, before),
            before_p_value,
            screened,
            explanations,
            separations,
            processing,
            flights: self.flights.get(),
            conclusions: Vec::new(),
        };
        closing.conclusions = conclusions(&closing);
        Ok(closing)
    }

    fn separations(&self, judged: &[Judged]) -> Vec<Separation> {
        let possible: Vec<&Judged> = judged.iter().filter(|j| j.explanation.possible).collect();
        let mut all = Vec::new();
        for truth in &possible {
            for other in possible.iter().filter(|o| o.explanation.families != truth.explanation.families) {
                let power = judge::rejected(&other.spread, &other.tangent, &other.rows, &truth.rows, &self.used);
                let (truth, other) = (truth.explanation.families.clone(), other.explanation.families.clone());
                all.push(Separation { truth, other, power });
            }
        }
        all
    }

    /// Mean figures of the record over those of the truth, less one, in the runs of the fine search.
    fn processing(&self, f: &Found) -> Result<Vec<f64>, StatisticsError> {
        let runs = self.options.fine_runs;
        let (rows, _) = self.fly(&f.h, &f.x, 0..runs)?;
        let plant = f.h.plant(&self.setup.plant, &f.x);
        let truth = true_runs(self.setup, &plant, 0..runs)?;
        let sum = |rows: &Rows, i: usize| rows.iter().map(|r| r[i]).sum::<f64>();
        Ok((0..rows[0].len()).map(|i| sum(&rows, i) / sum(&truth, i) - 1.0).collect())
    }
}

fn parameters(f: &Found, std_errors: &[f64]) -> Vec<Estimated> {
    let searched = f.h.searched();
    (0..f.h.dimension())
        .filter(|i| f.h.held[*i].is_none_or(|v| v != 0.0))
        .map(|i| {
            let (effect, p) = &f.h.free[i];
            let reach = searched.iter().position(|s| *s == i).map_or(f64::INFINITY, |k| 1.96 * std_errors[k]);
            let (low, high) = ((f.x[i] - reach).max(0.0), (f.x[i] + reach).min(1.0));
            let mut ci95 = if reach.is_finite() { [f.h.value(i, low), f.h.value(i, high)] } else { [p.low, p.high] };
            ci95.sort_by(f64::total_cmp);
            Estimated {
                family: f.h.effects[*effect].family,
                name: p.name.clone(),
                unit: p.unit,
                estimate: f.h.value(i, f.x[i]),
                ci95,
                decided: high - low <= 0.5,
            }
        })
        .collect()
}

/// Figures of a distribution over runs beside the test.
fn over(figures: &[Figure], rows: &Rows) -> Vec<FigureOver> {
    let n = rows.len() as f64;
    let one = |(i, f): (usize, &Figure)| {
        let mut x: Vec<f64> = rows.iter().map(|r| r[i]).collect();
        let mean = x.iter().sum::<f64>() / n;
        let std = (x.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0)).sqrt();
        let central90 = [quantile(&mut x, 0.05), quantile(&mut x, 0.95)];
        FigureOver {
            quantity: f.quantity,
            statistic: f.statistic,
            fitted: f.fitted,
            test: f.test,
            mean,
            std,
            central90,
            relative: mean / f.test - 1.0,
            inside: (central90[0]..=central90[1]).contains(&f.test),
        }
    };
    figures.iter().enumerate().map(one).collect()
}
