//! pid: the search for parameters and turbulence of largest likelihood. In: a campaign. Out: the contract's identification.
//!
//! Sizes of gusts come first, their scales held: a problem with one peak whatever it is that the declared model lacks. Scales are
//! freed from there, and held again where they run away, as they do when what is left has not the colour of gusts. Where gusts do not
//! explain the runs at all, white moments are allowed for beside them (process noise on the body rates; Jategaonkar 2015, ch. 5).

use super::filter::Filter;
use super::likelihood::{LocalLikelihood, inverse, local, log_likelihood2};
use super::point::{RANDOM, SCALE_PRIOR, SIZES, SearchPoint, Sought};
use super::report::data_set;
use crate::equations::Transition;
use crate::identifiability::of_runs;
use crate::identification::{ALL_RUNS, DataSet, Identification};
use crate::output_error::{EstimateOptions, PreparedRun, kinds, ready, run_plants, unknowns};
use crate::plant::START_SCALE_M;
use crate::{Method, PidError, SearchKind, StopReason};
use nalgebra::{DMatrix, DVector};
use windfall_model::{Campaign, PerChannel, Unknowns};

/// Sizes tried for a start, m/s: from 1 % of the tunnel speed by this factor, up or down, within these bounds.
const START_SIZE_M_S: f64 = 0.08;
const SIZE_FACTOR: f64 = 3.0;
const SIZES_M_S: std::ops::Range<f64> = 8e-4..2.0;
/// A tenth of the tunnel speed: about larger gusts the filter's linearisation says little, and moments are tried instead.
const LARGE_M_S: f64 = 0.5;
/// Gusts beside which turning is sought at first, m/s, and the turning tried about x and across it, rad/s per root second.
const BESIDE_TURNING_M_S: f64 = 0.02;
const START_TURNING: [f64; 2] = [0.01, 0.1];
const TURNINGS: std::ops::Range<f64> = 1e-4..20.0;
/// Standard deviations from its prior at which a scale has run away.
const AWAY: f64 = 2.0;
/// Largest growth and largest shrinking of a logarithm in a step.
const TRUST: [f64; 2] = [0.7, 1.6];
/// By how much twice the log-likelihood may fall in a step: the score leaves out how the gain depends on the parameters.
const SLACK: f64 = 0.1;
/// Levenberg's share of the information's diagonal: at first, and where no step helps any more.
const FIRST_DAMPING: f64 = 0.1;
const LAST_DAMPING: f64 = 1e4;
/// By how much the damping also shortens the whole step.
const SHORTENING: f64 = 0.1;
/// A gust whose logarithm has a larger standard error cannot be distinguished from none, unless twice the log-likelihood falls by more than
/// this without it (99 % of chi-squared with two degrees).
const VAGUE_STD: f64 = 0.5;
const SIGNIFICANT: f64 = 9.2;
/// Most iterations for sizes, and for scales once sizes are found.
const MOST_ITERATIONS: usize = 20;
const SCALE_ITERATIONS: usize = 6;
/// The search ends when no unknown moves by more than this part of its standard error, or all together by less than a tenth.
const SETTLED: f64 = 0.02;
const SETTLED_TOGETHER: f64 = 0.1;

/// Identifies a campaign's declared parameters together with its turbulence.
///
/// # Errors
/// As [`crate::output_error::identify`].
pub fn identify(campaign: &Campaign, options: &EstimateOptions) -> Result<Identification, PidError> {
    let plants = run_plants(campaign)?;
    let runs = ready(campaign, &plants)?;
    let unknowns = started(campaign, options)?;
    let identifiability = if unknowns.free() > 0 { of_runs(&runs, &unknowns) } else { None };
    let mut warnings = Vec::new();
    let mut data_sets = Vec::new();
    let all: Vec<usize> = (0..runs.len()).collect();
    let mut solve = |name: &str, members: &[usize], begin: Begin| -> Result<(DataSet, SearchPoint), PidError> {
        let mut search = Search::new(&runs, members, options);
        let found = search.find(begin).map_err(|stop| no_answer(stop, campaign, name))?;
        let set = data_set(campaign, name, &search.filters, &found.point, &found.local, &found.covariance, &mut warnings);
        Ok((set, found.point))
    };
    let (combined, point) = solve(ALL_RUNS, &all, Begin::From(unknowns))?;
    let mut left_out = Vec::new();
    for (kind, members) in if options.combined_only { Vec::new() } else { kinds(&plants) } {
        match solve(&kind, &members, Begin::Near(point.clone())) {
            Ok((set, _)) => data_sets.push(set),
            Err(e) => left_out.push(format!("data set {kind}: left out: {e}")),
        }
    }
    warnings.extend(left_out);
    data_sets.push(combined);
    Ok(Identification {
        envelopes: Vec::new(),
        method: Method::FilterError.name().to_owned(),
        data_sets,
        warnings,
        reason: None,
        smoothing: None,
        identifiability,
        compatibility: None,
    })
}

/// Unknowns where regression says; where it cannot, at the declared values.
pub(super) fn started(campaign: &Campaign, options: &EstimateOptions) -> Result<Unknowns, PidError> {
    let mut unknowns = unknowns(campaign, options)?;
    if let Ok(first) = crate::equation_error::JOINT.identify(campaign, &crate::smooth::Smoother::Auto, false)
        && let Some(set) = first.of_all_runs()
    {
        unknowns.start(&set.values(&campaign.plant.aero.structure, &unknowns.parameters()));
    }
    Ok(unknowns)
}

/// Where a search begins.
pub(super) enum Begin {
    /// Parameters alone.
    From(Unknowns),
    /// What other runs gave.
    Near(SearchPoint),
}

/// As an error of a data set.
pub(super) fn no_answer(stop: StopReason, campaign: &Campaign, set: &str) -> PidError {
    PidError::NoAnswer { campaign: campaign.name.clone(), set: set.to_owned(), search: SearchKind::FilterError, stop }
}

/// Noise of each channel, root mean square over runs.
pub(super) fn noise_of(runs: &[&PreparedRun<'_>]) -> PerChannel<f64> {
    std::array::from_fn(|c| (runs.iter().map(|r| r.noise_std[c].powi(2)).sum::<f64>() / runs.len() as f64).sqrt().max(1e-9))
}

/// Where a search ended.
pub(super) struct Found {
    pub(super) point: SearchPoint,
    local: LocalLikelihood,
    covariance: DMatrix<f64>,
}

pub(super) struct Search<'r, 'a> {
    filters: Vec<Filter<'r, 'a>>,
    work: Transition,
    iterations: usize,
}

impl<'r, 'a> Search<'r, 'a> {
    pub(super) fn new(runs: &'r [PreparedRun<'a>], members: &[usize], options: &EstimateOptions) -> Self {
        let noise = noise_of(&members.iter().map(|&i| &runs[i]).collect::<Vec<_>>());
        let filters = members.iter().map(|&i| Filter::new(&runs[i], noise)).collect();
        Self { filters, work: Transition::default(), iterations: options.iterations }
    }

    pub(super) fn find(&mut self, begin: Begin) -> Result<Found, StopReason> {
        let mut start = match begin {
            Begin::Near(point) => return self.near(point),
            Begin::From(unknowns) => SearchPoint::new(unknowns, START_SIZE_M_S),
        };
        self.likeliest(&mut start, &[0, 1], SIZES_M_S);
        let sizes = if start.random[0] < LARGE_M_S.ln() {
            self.climb(start.clone(), MOST_ITERATIONS)
        } else {
            Err(StopReason::NoDescent)
        };
        match sizes {
            Ok(found) if found.point.is_still() => Ok(found),
            Ok(found) => {
                let freed = SearchPoint { sought: Sought { scales: true, turning: false }, ..found.point.clone() };
                Ok(self.climb(freed, SCALE_ITERATIONS).unwrap_or(found))
            }
            Err(StopReason::NotExcited) => Err(StopReason::NotExcited),
            Err(_) => self.turning(start.unknowns),
        }
    }

    /// With moments at random beside gusts.
    fn turning(&mut self, unknowns: Unknowns) -> Result<Found, StopReason> {
        let mut start = SearchPoint::new(unknowns, BESIDE_TURNING_M_S);
        start.sought.turning = true;
        (start.random[4], start.random[5]) = (START_TURNING[0].ln(), START_TURNING[1].ln());
        self.likeliest(&mut start, &[5], TURNINGS);
        self.likeliest(&mut start, &[4], TURNINGS);
        self.climb(start, MOST_ITERATIONS)
    }

    /// From another data set's point, scales held where they run away.
    fn near(&mut self, mut point: SearchPoint) -> Result<Found, StopReason> {
        if point.sought.scales {
            if let Ok(found) = self.climb(point.clone(), SCALE_ITERATIONS) {
                return Ok(found);
            }
            point.sought.scales = false;
            (point.random[2], point.random[3]) = (START_SCALE_M.ln(), START_SCALE_M.ln());
        }
        let unknowns = point.unknowns.clone();
        match self.climb(point, MOST_ITERATIONS) {
            Err(stop) if !matches!(stop, StopReason::NotExcited | StopReason::ScaleAway) => self.turning(unknowns),
            other => other,
        }
    }

    /// Climbs to the likelihood's peak by scoring.
    fn climb(&mut self, mut point: SearchPoint, most: usize) -> Result<Found, StopReason> {
        let flown = |l: Option<LocalLikelihood>| l.ok_or(StopReason::FlightFails);
        let mut now = flown(local(&self.filters, &point, &mut self.work))?;
        let mut damping = FIRST_DAMPING;
        let free = point.unknowns.free();
        for _ in 0..self.iterations.min(most) {
            let covariance = inverse(&now.information)
                .map_err(|column| if column < free { StopReason::NotExcited } else { StopReason::NoDescent })?;
            if self.give_up_negligible(&mut point, &covariance, now.log_likelihood2) {
                now = flown(local(&self.filters, &point, &mut self.work))?;
                continue;
            }
            let step = &covariance * &now.score;
            let together = step.dot(&now.score).max(0.0).sqrt();
            if together < SETTLED_TOGETHER || (0..step.len()).all(|i| step[i].abs() < SETTLED * covariance[(i, i)].sqrt()) {
                return Ok(Found { point, local: now, covariance });
            }
            loop {
                let step = damped(&now, free, damping).unwrap_or_else(|| step.clone());
                if let Some(there) = self.attempt(&point, &step, now.log_likelihood2) {
                    (point, now) = there;
                    damping *= 0.1;
                    break;
                }
                damping *= 5.0;
                if damping > LAST_DAMPING {
                    return Err(StopReason::NoDescent);
                }
            }
            let off = |k: usize| (point.random[k] - START_SCALE_M.ln()).abs();
            if off(2).max(off(3)) > AWAY * SCALE_PRIOR {
                return Err(StopReason::ScaleAway);
            }
        }
        Err(StopReason::Iterations)
    }

    /// The point a step away, where the step is short enough and the likelihood no smaller.
    fn attempt(
        &mut self,
        point: &SearchPoint,
        step: &DVector<f64>,
        log_likelihood2: f64,
    ) -> Option<(SearchPoint, LocalLikelihood)> {
        let random = step.rows(point.unknowns.free(), RANDOM);
        if random.max() > TRUST[0] || random.min() < -TRUST[1] {
            return None;
        }
        let next = point.moved(step);
        let there = local(&self.filters, &next, &mut self.work)?;
        (there.log_likelihood2 > log_likelihood2 - SLACK).then_some((next, there))
    }

    /// Takes gusts that the data cannot distinguish from none for none; true where there was one.
    fn give_up_negligible(&mut self, point: &mut SearchPoint, covariance: &DMatrix<f64>, now: f64) -> bool {
        let (free, mut any) = (point.unknowns.free(), false);
        for (size, k) in SIZES.into_iter().enumerate() {
            if point.held(free + k) || point.kept[size] || covariance[(free + k, free + k)].sqrt() < VAGUE_STD {
                continue;
            }
            let without = point.without(size);
            let there = log_likelihood2(&self.filters, &without, &mut self.work);
            if there.is_some_and(|there| there > now - SIGNIFICANT) {
                (*point, any) = (without, true);
            } else {
                point.kept[size] = true;
            }
        }
        any
    }

    /// Starts from the likeliest size, equal for those named, found by climbing from the one there.
    fn likeliest(&mut self, point: &mut SearchPoint, which: &[usize], range: std::ops::Range<f64>) {
        let with = |size: f64| {
            let mut other = point.clone();
            which.iter().for_each(|&k| other.random[k] = size.ln());
            other
        };
        let mut value = |size: f64| log_likelihood2(&self.filters, &with(size), &mut self.work).unwrap_or(f64::NEG_INFINITY);
        let mut size = point.random[which[0]].exp();
        let mut best = value(size);
        for factor in [SIZE_FACTOR, 1.0 / SIZE_FACTOR] {
            let mut climbed = false;
            while range.contains(&(size * factor)) {
                let next = value(size * factor);
                if next <= best {
                    break;
                }
                (size, best, climbed) = (size * factor, next, true);
            }
            if climbed {
                break;
            }
        }
        *point = with(size);
    }
}

/// Scoring step with Levenberg's damping of the random drive, whose logarithms bend the likelihood; what is left after shortening the
/// whole.
fn damped(now: &LocalLikelihood, free: usize, damping: f64) -> Option<DVector<f64>> {
    let mut m = now.information.clone();
    (free..free + RANDOM).for_each(|k| m[(k, k)] *= 1.0 + damping);
    let covariance = inverse(&m).ok()?;
    Some(covariance * &now.score / (1.0 + SHORTENING * damping))
}

#[cfg(test)]
mod tests;
