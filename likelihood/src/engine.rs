//! likelihood: passes over all runs, and climbing to the most likely numbers. In: campaign, model. Out: normal equations, fitted models.

use crate::columns::{Basis, SensitivityColumn, Site};
use crate::filter::{Departed, Keep, PassSetting, RunState, Seen, number_plants, pass};
use crate::gram::Gram;
use crate::hum::{Hum, take_off};
use crate::joined::joined;
use crate::model::{Id, Member, Model, Number, PLAUSIBLE, VAGUE_PRIOR};
use crate::noise::{ChannelNoise, by_run, declared, learn};
use crate::random::Spectra;
use crate::run::Prepared;
use crate::search::is_within;
use crate::shock::{Shock, shocks};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use windfall_model::{
    Campaign, Constant, Data, Disturbance, Effect, Entry, POSE, PerChannel, Plant, Record, Role, RunNumber, Shape,
};
use windfall_pid::StopReason;

/// Runs of a campaign made ready, with their noise.
#[derive(Clone, Debug)]
pub struct Engine {
    pub(crate) campaign: Campaign,
    pub(crate) runs: Vec<Prepared>,
    /// Noise of the pose channels.
    pub noise: PerChannel<ChannelNoise>,
    /// Lines of the instruments that were taken off the records.
    pub hum: Vec<Hum>,
    /// Freedom of the accelerations along and about each axis at a search's start, zero otherwise.
    pub(crate) slack: [f64; 6],
    /// Whether parameters in free accelerations stay within their own size of where they are declared; else each step of a fit stays within it.
    pub(crate) near_declared: bool,
    /// Prior standard deviations of effects' strengths, as a multiple of those with which sets are weighed.
    pub(crate) strength_priors: f64,
    /// Forms of the gusts' spectra.
    pub(crate) spectra: Spectra,
    /// Mean square of what is not seen of the gusts, as a multiple of what their form leaves: one but for [`Engine::robust`].
    pub(crate) unseen: f64,
    /// Slopes by sizes and lengths of gusts from passes of their own, not from filters beside the pass.
    pub(crate) exact_gusts: bool,
    /// What the changing variance of the gusts takes off the log-likelihood of models with gusts.
    pub(crate) bursts_price: f64,
    /// What it leaves of the logarithms of the gusts' sizes, along the stream and across it.
    pub(crate) bursts_std: [f64; 2],
    /// Numbers that fits leave as they are.
    pub(crate) held: Vec<Id>,
    /// Work of all passes so far, of this engine and its copies: nodes times columns and what a node costs without any.
    work: Arc<AtomicU64>,
}

/// Where a fit is.
#[derive(Clone, Debug)]
pub struct Fit {
    /// The model.
    pub model: Model,
    /// Its numbers, their covariance, in the same order.
    pub numbers: Vec<Number>,
    /// Covariance of the numbers.
    pub covariance: DMatrix<f64>,
    /// Log marginal likelihood by Laplace's approximation.
    pub total: f64,
    /// Log-likelihood.
    pub log_likelihood: f64,
    /// Sum of whitened squares of the pose over their count.
    pub chi: f64,
    /// Per channel: mean square of the innovations, of what is expected of them, of both's ratio, and count.
    pub channels: PerChannel<[f64; 4]>,
    /// Why it ended.
    pub stop: StopReason,
}

impl Fit {
    /// Standard error of one of its numbers; none of what was not fitted.
    #[must_use]
    pub fn std_error(&self, id: Id) -> Option<f64> {
        let place = self.numbers.iter().position(|n| n.id == id)?;
        Some(self.covariance[(place, place)].sqrt()).filter(|s| s.is_finite())
    }
}

/// A number that differs from run to run, in one run: what it is more than the common one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OfRun {
    /// Index of the run in the campaign.
    pub run: usize,
    /// Which number.
    pub number: RunNumber,
    /// Mean of its departure, in the unit of [`Plant::change`].
    pub value: f64,
    /// Standard deviation of that.
    pub std: f64,
}

/// Key of the instant at which a pose is taken within its sample interval: known to half of that interval where nothing is declared.
const STAMP: &str = "sensors.pose_delay_s";
/// Length of a node, s, where the sample interval is shorter: a fiftieth of the pitch mode's period.
const NODE_S: f64 = 0.02;
/// The same where a search only looks for its start.
const COARSE_S: f64 = 0.04;
/// Most samples of a run that is too short to be taken; of one that was thinned to its bandwidth, whose samples say more, twice the numbers of a start.
const SHORTEST: usize = 60;
const SHORTEST_THINNED: usize = 24;
/// What a node costs without columns, in columns.
const NODE_COST: u64 = 24;
/// What other random inputs beside a pass cost, in columns.
const BESIDE_COST: u64 = 5;
/// Most work of a search, in passes without columns: campaigns that a set explains take 100 to 600. Then climbs are of few steps.
const BUDGET: f64 = 1000.0;
const FEW: usize = 3;
/// A climb ends when no step exceeds this share of its standard error.
const SMALL: f64 = 0.05;
/// Longest step, in standard deviations of the prior.
const LONGEST: f64 = 3.0;

/// Sum over runs.
pub(crate) struct Summed {
    pub(crate) g: DMatrix<f64>,
    pub(crate) b: DVector<f64>,
    pub(crate) log_likelihood: f64,
    pub(crate) channels: PerChannel<[f64; 4]>,
    pub(crate) runs: Vec<Seen>,
}

/// A model with its normal equations and channels.
type SteppedModel = (Model, Gram, PerChannel<[f64; 4]>);

/// Normal equations of `n` numbers and log-likelihood of all runs.
pub(crate) fn totals(runs: &[Seen], n: usize) -> (DMatrix<f64>, DVector<f64>, f64) {
    let (mut g, mut b) = (DMatrix::zeros(n, n), DVector::zeros(n));
    for r in runs {
        g += &r.g;
        b += &r.b;
    }
    (g, b, runs.iter().map(|r| r.log_likelihood).sum())
}

/// What the prior takes off the log-likelihood.
pub(crate) fn penalty(numbers: &[Number]) -> f64 {
    0.5 * numbers.iter().map(|n| (n.value / n.prior).powi(2)).sum::<f64>()
}

/// Noise with the odds of its correlation, and its variance, changed by factors whose logarithms go with two numbers: as it is in the middle.
fn other_noise(n: ChannelNoise, u: &[f64]) -> ChannelNoise {
    let scale = (0.8 * (u[1] - 0.5)).exp();
    let odds = n.correlation / (1.0 - n.correlation.min(0.99)) * (2.0 * (u[0] - 0.5)).exp();
    ChannelNoise {
        white: n.white * scale,
        coloured: n.coloured * scale,
        correlation: if n.coloured > 0.0 { odds / (1.0 + odds) } else { 0.0 },
    }
}

/// Whether a noise's size differs from another's by more than a hundredth, or its colour.
fn is_other_noise(a: &ChannelNoise, b: &ChannelNoise) -> bool {
    (b.std() / a.std() - 1.0).abs() > 0.01 || (a.correlation - b.correlation).abs() > 0.005
}

/// Mean square of the fast part of a channel's whitened innovations, by their second differences: one where they are white and of unit variance.
/// None of too few.
fn fast_part<'a>(runs: impl Iterator<Item = &'a [[f64; POSE]]>, channel: usize) -> Option<f64> {
    let (mut squares, mut count) = (0.0, 0.0);
    for whitened in runs {
        for w in whitened.windows(3).filter(|w| w.iter().all(|x| x[channel] != 0.0)) {
            squares += (w[0][channel] - 2.0 * w[1][channel] + w[2][channel]).powi(2) / 6.0;
            count += 1.0;
        }
    }
    (count > 100.0).then(|| squares / count)
}

/// The share of a step at which no number goes farther than [`LONGEST`] of its prior.
fn within_longest(step: &DVector<f64>, numbers: &[Number]) -> f64 {
    1.0 / (0..step.len()).map(|i| step[i].abs() / (LONGEST * numbers[i].prior)).fold(1.0, f64::max)
}

/// The largest of a step's numbers, in standard errors.
fn in_errors(step: &DVector<f64>, covariance: &DMatrix<f64>) -> f64 {
    (0..step.len()).map(|i| step[i].abs() / covariance[(i, i)].sqrt().max(1e-300)).fold(0.0, f64::max)
}

/// Logarithm of the posterior density, but for a constant.
fn log_posterior(gram: &Gram) -> f64 {
    gram.log_likelihood - penalty(&gram.numbers)
}

impl Engine {
    /// Makes these runs of a campaign ready, those that go on where another ended as one, and learns their noise; `None` without a tunnel run.
    #[must_use]
    pub fn new(campaign: &Campaign, indices: &[usize]) -> Option<Self> {
        let mut owned = campaign.clone();
        // A declared pulse has its run and its instant in it.
        let pulse = |(effect, _): &(&Effect, Vec<f64>)| (effect.parameters)(&[]).iter().any(|p| p.role == Role::Run);
        let has_pulse = owned.knowledge.effects.iter().any(pulse);
        let indices = if has_pulse { indices.to_vec() } else { joined(&mut owned.runs, indices) };
        let mut hum = Vec::new();
        if !campaign.knowledge.exact_noise {
            for &i in &indices {
                if let Data::Tunnel(r) = &mut owned.runs[i].data {
                    hum.extend(take_off(r, &campaign.plant));
                }
            }
        }
        let records: Vec<(usize, &Record)> = indices
            .iter()
            .filter_map(|&i| match &owned.runs[i].data {
                Data::Tunnel(r) if r.len() > if r.bandwidth.is_empty() { SHORTEST } else { SHORTEST_THINNED } => Some((i, r)),
                _ => None,
            })
            .collect();
        if records.is_empty() {
            return None;
        }
        let sensors = &campaign.plant.sensors;
        let all: Vec<&Record> = records.iter().map(|(_, r)| *r).collect();
        let noise = if campaign.knowledge.exact_noise { declared(sensors) } else { learn(&all, sensors) };
        let interval_s = records.iter().map(|(_, r)| r.interval_s()).fold(f64::INFINITY, f64::min);
        if !owned.knowledge.constants.iter().any(|c| c.key == STAMP) {
            owned.knowledge.constants.push(Constant {
                key: STAMP,
                component: "",
                unit: "s",
                lens: |p| Some(&mut p.sensors.pose_delay_s),
                std: 0.5 * interval_s,
            });
        }
        let (gas, wind) = (campaign.plant.environment.gas_constant_j_kg_k, noise[POSE]);
        let runs = records.par_iter().map(|(i, r)| Prepared::new(*i, &owned.runs[*i].name, r, gas, NODE_S, &wind)).collect();
        let engine = Self {
            campaign: owned,
            runs,
            noise,
            hum,
            slack: [0.0; 6],
            near_declared: false,
            strength_priors: 1.0,
            exact_gusts: false,
            spectra: Spectra::default(),
            unseen: 1.0,
            bursts_price: 0.0,
            bursts_std: [0.0; 2],
            held: Vec::new(),
            work: Arc::default(),
        };
        Some(engine.in_noise(noise))
    }

    /// The runs in noise of that size and colour, each with as much of it as its own record has; all with the same where noise is declared.
    fn in_noise(mut self, noise: PerChannel<ChannelNoise>) -> Self {
        self.noise = noise;
        if !self.campaign.knowledge.exact_noise {
            let tunnel = |run: &Prepared| match &self.campaign.runs[run.index].data {
                Data::Tunnel(record) => Some(record),
                Data::Point(_) => None,
            };
            let records: Vec<&Record> = self.runs.iter().filter_map(tunnel).collect();
            let ratios = by_run(&records, &noise);
            self.runs.iter_mut().zip(ratios).for_each(|(run, ratio)| run.noise_ratio = ratio);
        }
        self
    }

    /// Other runs of the campaign, or of one like it, in the noise of these; `None` without a tunnel run among them.
    #[must_use]
    pub fn beside(&self, campaign: &Campaign, runs: &[usize]) -> Option<Self> {
        let own = Campaign { knowledge: self.campaign.knowledge.clone(), ..campaign.clone() };
        Some(Self { slack: self.slack, spectra: self.spectra, ..Self::new(&own, runs)?.in_noise(self.noise) })
    }

    /// The campaign with what its runs leave uncertain: the instant of a pose within its sample interval.
    #[must_use]
    pub fn campaign(&self) -> &Campaign {
        &self.campaign
    }

    /// Names of the runs of a campaign that were taken as one flight, a text for each flight.
    #[must_use]
    pub fn joined(&self, campaign: &Campaign) -> Vec<String> {
        let pairs = self.campaign.runs.iter().zip(&campaign.runs);
        pairs.filter(|(own, given)| own.name != given.name).map(|(own, _)| own.name.clone()).collect()
    }

    /// Whether accelerations are left free.
    pub(crate) fn is_free(&self) -> bool {
        self.slack.iter().any(|s| *s > 0.0)
    }

    /// The same runs in longer nodes, at half the cost.
    pub(crate) fn coarse(&self) -> Self {
        let gas = self.campaign.plant.environment.gas_constant_j_kg_k;
        let longer = |run: &Prepared| match &self.campaign.runs[run.index].data {
            Data::Tunnel(record) => run.clone().in_nodes(record, gas, COARSE_S),
            Data::Point(_) => run.clone(),
        };
        Self { runs: self.runs.iter().map(longer).collect(), ..self.clone() }
    }

    /// Mean tunnel speed of the runs, each as much as any other, m/s.
    pub(crate) fn mean_speed_m_s(&self) -> f64 {
        self.runs.iter().map(|r| r.speed_m_s).sum::<f64>() / self.runs.len().max(1) as f64
    }

    /// Name of the first run.
    #[must_use]
    pub fn first_run(&self) -> String {
        self.runs.first().map_or_else(String::new, |r| r.name.clone())
    }

    /// The same with other noise.
    #[must_use]
    pub(crate) fn with_noise(&self, noise: PerChannel<ChannelNoise>) -> Self {
        Self { noise, ..self.clone() }
    }

    /// Noise by the likelihood of a model that is right: colour and size together where there is colour, and each channel's size by the
    /// fast part of its whitened innovations, which a missing effect does not reach. True when it changed by more than a hundredth.
    pub(crate) fn refine_noise(&mut self, model: &Model) -> bool {
        let before = self.noise;
        if before.iter().any(|n| n.coloured > 0.0) {
            let at = |u: &[f64]| before.map(|n| other_noise(n, u));
            let value = |u: &[f64]| self.with_noise(at(u)).sum(model, &[], &[]).map_or(1e300, |s| -s.log_likelihood);
            let best = windfall_pid::simplex::minimise(value, &[0.5, 0.5], 0.15, 25).at;
            self.noise = at(&best);
        }
        if let Ok(sum) = self.sum(model, &[], &[]) {
            for (c, was) in before.iter().enumerate().take(POSE) {
                let whitened = sum.runs.iter().map(|r| r.innovations.whitened.as_slice());
                if was.coloured == 0.0
                    && let Some(square) = fast_part(whitened, c)
                {
                    self.noise[c].white *= square.clamp(0.25, 4.0);
                }
            }
        }
        before.iter().zip(&self.noise).any(|(a, b)| is_other_noise(a, b))
    }

    /// One pass over all runs.
    pub(crate) fn sum(&self, model: &Model, numbers: &[Number], generic: &[(Site, Basis)]) -> Result<Summed, Departed> {
        let runs = self.passed(model, numbers, generic, Keep::Nothing)?;
        let (g, b, log_likelihood) = totals(&runs, numbers.len());
        let channels = std::array::from_fn(|c| {
            let sum = |k: usize| match c {
                POSE => self.runs.iter().map(|r| r.speed.innovations[k]).sum::<f64>(),
                _ => runs.iter().map(|r| r.channels[c][k]).sum::<f64>(),
            };
            let n = sum(3).max(1.0);
            [sum(0) / n, sum(1) / n, sum(2) / n, n]
        });
        Ok(Summed { g, b, log_likelihood, channels, runs })
    }

    /// One pass over all runs that keeps what the filter did.
    pub(crate) fn traced(&self, model: &Model, numbers: &[Number]) -> Result<Vec<Seen>, Departed> {
        self.passed(model, numbers, &[], Keep::Trace)
    }

    /// The same, with what gusts add at each step.
    pub(crate) fn traced_with_gusts(&self, model: &Model) -> Result<Vec<Seen>, Departed> {
        self.passed(model, &[], &[], Keep::Gusts)
    }

    /// One pass over all runs that keeps the whitened slopes of the innovations, with models beside that differ in random members alone.
    pub(crate) fn with_rows(&self, model: &Model, numbers: &[Number], beside: &[Model]) -> Result<Vec<Seen>, Departed> {
        let others: Vec<Plant> = beside.iter().map(|other| other.plant(&self.campaign)).collect();
        self.passed_beside(model, numbers, &[], &others, Keep::Rows)
    }

    /// Numbers that differ from run to run in a fit, run by run; nothing where it departs. Their errors have what the fit leaves of its own
    /// numbers in them.
    #[must_use]
    pub fn by_run(&self, fit: &Fit) -> Vec<OfRun> {
        let Ok(seen) = self.passed(&fit.model, &fit.numbers, &[], Keep::Nothing) else { return Vec::new() };
        let numbers = fit.model.plant(&self.campaign).scatter.numbers();
        let of_run = |(run, seen): (&Prepared, &Seen)| {
            let one = |((number, _), state): (&(RunNumber, f64), &RunState)| {
                let slopes = DVector::from_column_slice(&state.slopes);
                let variance = state.variance + slopes.dot(&(&fit.covariance * &slopes));
                OfRun { run: run.index, number: *number, value: state.mean, std: variance.max(0.0).sqrt() }
            };
            numbers.iter().zip(&seen.numbers).map(one).collect::<Vec<_>>()
        };
        self.runs.iter().zip(&seen).flat_map(of_run).collect()
    }

    fn passed(&self, model: &Model, numbers: &[Number], generic: &[(Site, Basis)], keep: Keep) -> Result<Vec<Seen>, Departed> {
        self.passed_beside(model, numbers, generic, &[], keep)
    }

    fn passed_beside(
        &self,
        model: &Model,
        numbers: &[Number],
        generic: &[(Site, Basis)],
        beside: &[Plant],
        keep: Keep,
    ) -> Result<Vec<Seen>, Departed> {
        let columns = numbers.len() as u64 + BESIDE_COST * beside.len() as u64;
        self.work.fetch_add(self.instants() as u64 * (NODE_COST + columns), Ordering::Relaxed);
        let columns = model.columns(&self.campaign, numbers, generic);
        let plant = model.plant(&self.campaign);
        let local = |p: &Plant, run: usize| p.for_run(run, &self.campaign.runs[run].inputs);
        let one = |run: &Prepared| {
            let own = local(&plant, run.index);
            let of_run = |c: &SensitivityColumn| match c {
                SensitivityColumn::Plant(p, step) if !p.contacts.is_empty() => {
                    SensitivityColumn::Plant(Box::new(local(p, run.index)), *step)
                }
                other => other.clone(),
            };
            let columns: Vec<SensitivityColumn> = columns.iter().map(of_run).collect();
            let (noise, slack, spectra, unseen) = (&self.noise, self.slack, self.spectra, self.unseen);
            let numbers = number_plants(&own);
            pass(
                run,
                &PassSetting { plant: &own, noise, columns: &columns, numbers: &numbers, beside, slack, spectra, unseen, keep },
            )
        };
        let seen: Vec<Result<Seen, Departed>> = self.runs.par_iter().map(one).collect();
        seen.into_iter().collect()
    }

    /// What a kick would explain at each instant of each run: the run's index and its shocks.
    pub(crate) fn shocks(&self, model: &Model) -> Vec<(usize, Vec<Shock>)> {
        let Ok(seen) = self.traced(model, &[]) else { return Vec::new() };
        self.runs.iter().zip(&seen).map(|(run, seen)| (run.index, shocks(&seen.trace, seen.states))).collect()
    }

    /// Work done so far, in passes over all runs without columns.
    pub(crate) fn passes(&self) -> f64 {
        self.work.load(Ordering::Relaxed) as f64 / (NODE_COST * self.instants() as u64).max(1) as f64
    }

    /// Whether a random member is a gust.
    #[must_use]
    pub fn moves_air(&self, member: &Member) -> bool {
        self.axis_of(member, 0).is_some()
    }

    /// Whether gusts of a model are of a band.
    pub(crate) fn has_band(&self, model: &Model) -> bool {
        let is_band = |d: &Disturbance| matches!((d.entry, d.shape), (Entry::AirVelocity(_), Shape::Band { .. }));
        model.plant(&self.campaign).disturbances(1.0).iter().any(is_band)
    }

    /// Whether a gust's spectrum is one with steep edges.
    #[must_use]
    pub fn has_steep_edges(&self, member: &Member) -> bool {
        self.spectra.steep && self.has_band(&Model { members: vec![member.clone()], ..Model::declared(&self.campaign) })
    }

    /// First axis of the gusts whose size a random member's number is.
    pub(crate) fn axis_of(&self, member: &Member, number: usize) -> Option<usize> {
        let mut plant = self.campaign.plant.clone();
        let mut values = member.values.clone();
        member.strengths().for_each(|i| values[i] = f64::from(u8::from(i == number)));
        (member.effect.apply)(&mut plant, &values);
        let declared = self.campaign.plant.disturbances(1.0);
        let moved = plant.disturbances(1.0).into_iter().filter(|d| declared.iter().all(|o| o.entry != d.entry || o.rms < d.rms));
        moved.filter_map(|d| if let Entry::AirVelocity(axis) = d.entry { Some(axis) } else { None }).min()
    }

    /// The same runs where effects' strengths are what the runs say of them: what is known beforehand of their size chooses among sets, and would draw
    /// the strengths of the one that is chosen towards nothing.
    pub(crate) fn without_priors_of_strengths(&self) -> Self {
        Self { strength_priors: 1.0 / PLAUSIBLE, ..self.clone() }
    }

    /// Starts counting work again: what the search's end is held against has a budget of its own.
    pub(crate) fn count_anew(&mut self) {
        self.work = Arc::default();
    }

    /// Whether a search has done all the work that it may: what no set explains is not worth more.
    pub(crate) fn is_exhausted(&self) -> bool {
        self.passes() > BUDGET
    }

    /// Number of instants at which something may happen.
    pub(crate) fn instants(&self) -> usize {
        self.runs.iter().map(|r| r.nodes.len()).sum()
    }

    /// Normal equations of numbers at a model.
    pub(crate) fn gram(&self, model: &Model, numbers: Vec<Number>) -> Result<(Gram, PerChannel<[f64; 4]>), Departed> {
        let s = self.sum(model, &numbers, &[])?;
        Ok((Gram::new(numbers, s.g, s.b, s.log_likelihood), s.channels))
    }

    /// Numbers that a fit of a model frees: declared parameters, constants, members' strengths, and shapes when asked for. A strength
    /// that may not be negative and stands at zero, driven there, is left out by the step's clamp.
    pub(crate) fn free(&self, model: &Model, shapes: bool) -> Vec<Number> {
        let mut all = model.known(&self.campaign);
        if self.is_free() {
            // Free accelerations leave parameters that are hardly seen free too: each step stays within their own size.
            let begun = &self.campaign.plant.aero.values;
            for n in &mut all {
                let Id::Declared(i) = n.id else { continue };
                n.prior /= VAGUE_PRIOR;
                if self.near_declared {
                    n.value = model.declared[i] - begun[i];
                }
            }
        }
        let mut members = model.of_members(shapes);
        members.iter_mut().filter(|n| model.is_strength(n.id)).for_each(|n| n.prior *= self.strength_priors);
        all.extend(members);
        all.retain(|n| !self.held.contains(&n.id));
        all
    }

    /// The same runs where fits leave a number as it is.
    #[must_use]
    pub fn holding(&self, number: Id) -> Self {
        Self { held: vec![number], ..self.clone() }
    }

    /// The model after a step, shortened until the log posterior is not below `here`; where none is, the last departure of those tried.
    fn stepped(
        &self,
        model: &Model,
        gram: &Gram,
        step: &DVector<f64>,
        here: f64,
        shapes: bool,
    ) -> Result<SteppedModel, Option<Departed>> {
        let mut fraction = within_longest(step, &gram.numbers);
        let mut departed = None;
        for _ in 0..6 {
            let mut next = model.clone();
            gram.numbers.iter().zip(step.iter()).for_each(|(n, s)| next.change(n, fraction * s));
            match self.gram(&next, self.free(&next, shapes)) {
                Ok((g, c)) if is_within(log_posterior(&g), here, 1e-6) => return Ok((next, g, c)),
                Ok(_) => {}
                Err(d) => departed = Some(d),
            }
            fraction *= 0.35;
        }
        Err(departed)
    }

    /// Gauss-Newton with a prior, steps halved until the posterior rises.
    ///
    /// # Errors
    /// [`Departed`] where the model departs at the start already.
    pub fn climb(&self, model: &Model, shapes: bool, most: usize) -> Result<Fit, Departed> {
        let mut model = model.clone();
        let (mut gram, mut chi) = self.gram(&model, self.free(&model, shapes))?;
        let mut stop = StopReason::Iterations;
        let most = if self.is_exhausted() { most.min(FEW) } else { most };
        for _ in 0..most {
            let Some((_, step, covariance)) = gram.laplace() else {
                stop = StopReason::NoDescent;
                break;
            };
            let largest = in_errors(&step, &covariance);
            if largest < SMALL {
                stop = StopReason::Converged;
                break;
            }
            let here = log_posterior(&gram);
            let (next, g, c) = match self.stepped(&model, &gram, &step, here, shapes) {
                Ok(next) => next,
                Err(departed) => {
                    stop = match departed {
                        Some(d) if largest > 10.0 => StopReason::Departs { run: d.run, t_s: d.t_s },
                        _ => StopReason::NoDescent,
                    };
                    break;
                }
            };
            let gained = log_posterior(&g) - here;
            (model, gram, chi) = (next, g, c);
            if gained < 0.02 {
                stop = StopReason::Converged;
                break;
            }
        }
        let (total, _, covariance) = gram.laplace().unwrap_or((f64::NEG_INFINITY, DVector::zeros(0), DMatrix::zeros(0, 0)));
        let mean = chi[..POSE].iter().map(|c| c[2]).sum::<f64>() / POSE as f64;
        Ok(Fit {
            model,
            total,
            covariance,
            log_likelihood: gram.log_likelihood,
            numbers: gram.numbers,
            chi: mean,
            channels: chi,
            stop,
        })
    }
}

/// Whether a number belongs to what every set has.
pub(crate) fn always(id: Id, model: &Model) -> bool {
    match id {
        Id::Declared(_) | Id::Constant(_) => true,
        Id::Member(m, _) => model.members[m].declared,
        _ => false,
    }
}

#[cfg(test)]
mod tests;
