//! discover: what to fly next so that rivals part and bounds sharpen. In: a campaign. Out: for each pair of sets that its runs cannot tell
//! apart, and for bounds that are wide, the run that says most for its tunnel time, with expected odds, and the odds when it is flown.
//!
//! Runs are flown by the model that was found, released at an angle, with spin, off the axis, in steady or swinging tunnel speed. What a run
//! says is its information on every number (Fisher), from one pass of the filter; expected odds follow from the normal equations alone. The
//! best run is then flown with noise as each rival says, and both rivals fitted to old and new runs together.

use crate::DiscoverError;
use crate::close::runs_of;
use nalgebra::DMatrix;
use rayon::prelude::*;
use serde::Serialize;
use windfall_likelihood::{Engine, Model, RivalPair, Rivals, Unseen, discover, log_odds};
use windfall_model::{Campaign, Data, Flight, Plant, Run, TestSection, TunnelSpeed, Use};
use windfall_replay::{Replay, ReplayError};
use windfall_sim::{End, Seed, fly};

/// Odds below which two sets are rivals, and from which a run decides between them.
const ODDS: f64 = 20.0;
/// Release angles, deg, in pitch and yaw alike; roll rates, deg/s; distances off the axis, m; swings of tunnel speed, as shares.
const RELEASES_DEG: [f64; 4] = [3.0, 12.0, 22.0, 32.0];
const SPINS_DEG_S: [f64; 3] = [0.0, 60.0, 180.0];
const OFFSETS_M: [f64; 2] = [0.0, 0.4];
const SWINGS: [f64; 2] = [0.0, 0.08];
/// Lengths, s: all runs are tried at the second, the best at all.
const LENGTHS_S: [f64; 3] = [8.0, 16.0, 40.0];
/// Period of a swing of tunnel speed, s.
const SWING_S: f64 = 8.0;
/// Most pairs, bounds, and runs for each.
const MOST: usize = 6;
const RUNS: usize = 3;
/// A bound is wide where its standard error exceeds this share of the largest plausible size.
const WIDE: f64 = 0.02;

/// A run that could be flown.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct NextRun {
    /// Angle at release, in pitch and in yaw, deg.
    pub release_deg: f64,
    /// Roll rate at release, deg/s.
    pub spin_deg_s: f64,
    /// Distance of the release from the tunnel's axis, m.
    pub offset_m: f64,
    /// Swing of the tunnel speed about its mean, as a share of it.
    pub speed_swing: f64,
    /// Length, s.
    pub duration_s: f64,
    /// Tunnel time with what lies between runs, s.
    pub tunnel_time_s: f64,
}

/// A run with what it is expected to say between two rivals.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Deciding {
    /// The run.
    pub run: NextRun,
    /// Expected log odds of the first, were it true, and of the second, were that.
    pub log_odds: [f64; 2],
    /// Log odds of each when such a run was flown as it says and both were fitted; of the best run only.
    pub simulated: Option<[f64; 2]>,
}

/// Two sets that the campaign cannot tell apart.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Separated {
    /// What was named.
    pub families: Vec<String>,
    /// What could stand in its place.
    pub rival: Vec<String>,
    /// Log odds of the first over the second as things are.
    pub log_odds_now: f64,
    /// Runs, best for their tunnel time first; empty where none parts them.
    pub runs: Vec<Deciding>,
}

/// A bound with the run that sharpens it most for its tunnel time.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Sharpened {
    /// Family.
    pub family: String,
    /// Parameter.
    pub parameter: String,
    /// Unit.
    pub unit: String,
    /// Standard error as things are, and with the run.
    pub std_error_now: f64,
    /// With the run.
    pub std_error_then: f64,
    /// The run.
    pub run: NextRun,
}

/// What to fly next.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Separation {
    /// Campaign.
    pub campaign: String,
    /// What was named.
    pub families: Vec<String>,
    /// What the check of the record had to say, a sentence each.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub record: Vec<String>,
    /// Runs that were tried.
    pub tried: usize,
    /// Pairs of rivals, closest first.
    pub pairs: Vec<Separated>,
    /// Wide bounds, widest first.
    pub bounds: Vec<Sharpened>,
}

impl Separation {
    /// Whether every pair has a run whose expected odds decide.
    #[must_use]
    pub fn is_within_reach(&self) -> bool {
        self.pairs.iter().all(|p| p.runs.first().is_some_and(|r| worse(r.log_odds) > ODDS.ln()))
    }
}

fn worse(odds: [f64; 2]) -> f64 {
    odds[0].min(odds[1])
}

/// A run that was tried.
struct Tried {
    run: NextRun,
    information: DMatrix<f64>,
}

/// Searches for the runs that part a campaign's rivals and sharpen its bounds; `between_s` passes between runs. `accept_record`:
/// also of a record that the check refuses.
///
/// # Errors
/// A campaign without tunnel runs, or one that cannot be closed or flown.
pub fn separate(campaign: &Campaign, between_s: f64, accept_record: bool) -> Result<Separation, DiscoverError> {
    let looked = windfall_pid::plausible::looked(campaign, accept_record)?;
    let campaign = &looked.with_difference();
    let used = runs_of(campaign, Use::Identify);
    let mut engine = Engine::new(campaign, &used).ok_or(ReplayError::NoRuns { what: "identify" })?;
    let found = discover(&mut engine).map_err(|words| DiscoverError::NoEnd { campaign: campaign.name.clone(), words })?;
    let fault = || DiscoverError::NoEnd { campaign: campaign.name.clone(), words: "the model that was found departs".to_owned() };
    let rivals = Rivals::new(&engine, &found).ok_or_else(fault)?;
    let range = Range::new(campaign, &used, &found.after.model.plant(engine.campaign()), between_s)?;
    let mut pairs = rivals.pairs(ODDS);
    pairs.truncate(MOST);
    let tried = tried(&range, &engine, &rivals, &pairs);
    let pairs = pairs.into_iter().map(|p| parted(&range, &engine, &rivals, &tried, p)).collect();
    Ok(Separation {
        campaign: campaign.name.clone(),
        record: looked.notes(),
        families: found.after.model.members.iter().map(|m| m.effect.family.to_owned()).collect(),
        tried: tried.len(),
        pairs,
        bounds: sharpened(&rivals, &tried),
    })
}

/// All runs of one length, and the best of them at the others.
fn tried(range: &Range<'_>, engine: &Engine, rivals: &Rivals<'_>, pairs: &[RivalPair]) -> Vec<Tried> {
    let mut grid = Vec::new();
    for release_deg in RELEASES_DEG {
        for spin_deg_s in SPINS_DEG_S {
            for offset_m in OFFSETS_M {
                for speed_swing in SWINGS {
                    grid.push(range.run(release_deg, spin_deg_s, offset_m, speed_swing, LENGTHS_S[1]));
                }
            }
        }
    }
    let one = |run: &NextRun| {
        let other = range.engine(engine, &[range.flown(&range.plant, *run, 0)?])?;
        Some(Tried { run: *run, information: rivals.information(&other)? })
    };
    let mut all: Vec<Tried> = grid.par_iter().filter_map(one).collect();
    let mut best: Vec<NextRun> = Vec::new();
    for pair in pairs {
        for (i, _) in ranked(rivals, &all, *pair).into_iter().take(RUNS) {
            if !best.contains(&all[i].run) {
                best.push(all[i].run);
            }
        }
    }
    let others: Vec<NextRun> = best
        .iter()
        .flat_map(|r| [LENGTHS_S[0], LENGTHS_S[2]].map(|s| range.run(r.release_deg, r.spin_deg_s, r.offset_m, r.speed_swing, s)))
        .collect();
    all.extend(others.par_iter().filter_map(one).collect::<Vec<_>>());
    all
}

/// Runs by what they say between a pair: those that decide first, by tunnel time; then the others, by log odds for their tunnel time.
fn ranked(rivals: &Rivals<'_>, tried: &[Tried], pair: RivalPair) -> Vec<(usize, [f64; 2])> {
    let expected = |(i, t): (usize, &Tried)| Some((i, rivals.expected(pair, &t.information)?));
    let mut all: Vec<(usize, [f64; 2])> = tried.iter().enumerate().filter_map(expected).collect();
    rank(&mut all, |i| tried[i].run.tunnel_time_s);
    all
}

fn rank(all: &mut [(usize, [f64; 2])], tunnel_time_s: impl Fn(usize) -> f64) {
    let sure = 2.0 * ODDS.ln();
    let rate = |(i, odds): &(usize, [f64; 2])| {
        let enough = worse(*odds).min(sure);
        (enough >= sure, enough / tunnel_time_s(*i))
    };
    all.sort_by(|a, b| {
        let ((x, p), (y, q)) = (rate(a), rate(b));
        y.cmp(&x).then(q.total_cmp(&p)).then(worse(b.1).total_cmp(&worse(a.1)))
    });
}

fn parted(range: &Range<'_>, engine: &Engine, rivals: &Rivals<'_>, tried: &[Tried], pair: RivalPair) -> Separated {
    let words = |set: usize| rivals.families(set).iter().map(|f| (*f).to_owned()).collect();
    let mut runs: Vec<Deciding> = ranked(rivals, tried, pair)
        .into_iter()
        .take(RUNS)
        .map(|(i, log_odds)| Deciding { run: tried[i].run, log_odds, simulated: None })
        .collect();
    if let Some(best) = runs.first_mut() {
        best.simulated = simulated(range, engine, [&rivals.model(pair.best), &rivals.model(pair.rival)], best.run);
    }
    Separated { families: words(pair.best), rival: words(pair.rival), log_odds_now: pair.log_odds, runs }
}

/// Log odds of each model over the other when a run was flown as it says, old and new runs together.
fn simulated(range: &Range<'_>, engine: &Engine, [one, two]: [&Model; 2], run: NextRun) -> Option<[f64; 2]> {
    let odds = |truth: &Model, other: &Model, seed: u64| {
        let plant = truth.plant(engine.campaign());
        let all = range.engine_with(engine, range.flown(&plant, run, seed)?)?;
        log_odds(&all, truth, other)
    };
    Some([odds(one, two, 1)?, odds(two, one, 2)?])
}

fn sharpened(rivals: &Rivals<'_>, tried: &[Tried]) -> Vec<Sharpened> {
    widest(rivals.unseen(), |u: &Unseen| u.plausible)
        .into_iter()
        .take(MOST)
        .filter_map(|(u, now)| {
            let then = tried.iter().filter_map(|t| Some((rivals.sharpened(&u, &t.information)?, t.run)));
            let brings = |(then, run): &(f64, NextRun)| worth(now, *then, run.tunnel_time_s);
            let (std_error_then, run) = then.max_by(|a, b| brings(a).total_cmp(&brings(b)))?;
            Some(Sharpened {
                family: u.family.to_owned(),
                parameter: u.parameter.clone(),
                unit: u.unit.to_owned(),
                std_error_now: now,
                std_error_then,
                run,
            })
        })
        .collect()
}

/// Bounds that are wide with their standard errors, the widest for its plausible size first.
fn widest<T>(mut all: Vec<(T, f64)>, plausible: impl Fn(&T) -> f64) -> Vec<(T, f64)> {
    all.retain(|(u, std)| *std > WIDE * plausible(u));
    all.sort_by(|a, b| (b.1 / plausible(&b.0)).total_cmp(&(a.1 / plausible(&a.0))));
    all
}

/// Information that a run brings, by standard errors without and with it, for its tunnel time.
fn worth(now: f64, then: f64, tunnel_time_s: f64) -> f64 {
    (then.powi(-2) - now.powi(-2)) / tunnel_time_s
}

/// How runs of a campaign are flown.
struct Range<'a> {
    campaign: &'a Campaign,
    used: &'a [usize],
    plant: Plant,
    /// The first run, to be flown otherwise.
    like: Flight,
    mean_speed_m_s: f64,
    between_s: f64,
}

impl<'a> Range<'a> {
    fn new(campaign: &'a Campaign, used: &'a [usize], plant: &Plant, between_s: f64) -> Result<Self, DiscoverError> {
        let first = used.iter().find_map(|&i| match &campaign.runs[i].data {
            Data::Tunnel(record) => Some((i, record)),
            Data::Point(_) => None,
        });
        let (index, record) = first.ok_or(ReplayError::NoRuns { what: "identify" })?;
        let replay = Replay::new(record, &campaign.plant_for(plant, index))?;
        let mean_speed_m_s = replay.states().iter().map(|s| s.vw).sum::<f64>() / replay.states().len().max(1) as f64;
        let like = replay.order(replay.first());
        Ok(Self { campaign, used, plant: plant.clone(), like, mean_speed_m_s, between_s })
    }

    fn run(&self, release_deg: f64, spin_deg_s: f64, offset_m: f64, speed_swing: f64, duration_s: f64) -> NextRun {
        NextRun { release_deg, spin_deg_s, offset_m, speed_swing, duration_s, tunnel_time_s: duration_s + self.between_s }
    }

    fn flight(&self, run: NextRun) -> Flight {
        let mut flight = Flight { duration_s: run.duration_s, section: Some(TestSection::default()), ..self.like.clone() };
        let at = &mut flight.release;
        let angle = run.release_deg.to_radians();
        (at.attitude_rad, at.velocity_m_s) = ([at.attitude_rad[0], angle, angle], [0.0; 3]);
        at.rates_rad_s = [run.spin_deg_s.to_radians(), 0.0, 0.0];
        at.position_m[1] += run.offset_m;
        let interval_s = 0.05;
        let speed = |i: usize| {
            let phase = std::f64::consts::TAU * i as f64 * interval_s / SWING_S;
            self.mean_speed_m_s * (1.0 + run.speed_swing * phase.sin())
        };
        let samples = (run.duration_s / interval_s).ceil() as usize + 2;
        flight.speed = TunnelSpeed::History { interval_s, vw_m_s: (0..samples).map(speed).collect() };
        flight
    }

    /// The run as a plant flies it, with noise; `None` where it leaves the test section or fails.
    fn flown(&self, plant: &Plant, run: NextRun, seed: u64) -> Option<Run> {
        let flown = fly(plant, &self.flight(run), Seed { campaign: 0x5e9a_7a7e, run: seed }).ok()?;
        matches!(flown.end, End::Completed).then(|| Run {
            name: "next".to_owned(),
            kind: "next".to_owned(),
            used: Use::Identify,
            inputs: vec![0.0; self.campaign.inputs.len()],
            data: Data::Tunnel(flown.record),
            notes: Vec::new(),
        })
    }

    fn engine(&self, engine: &Engine, runs: &[Run]) -> Option<Engine> {
        let campaign = Campaign { runs: runs.to_vec(), ..self.campaign.clone() };
        engine.beside(&campaign, &(0..runs.len()).collect::<Vec<_>>())
    }

    fn engine_with(&self, engine: &Engine, run: Run) -> Option<Engine> {
        let mut all: Vec<Run> = self.used.iter().map(|&i| self.campaign.runs[i].clone()).collect();
        all.push(run);
        self.engine(engine, &all)
    }
}

#[cfg(test)]
mod tests;
