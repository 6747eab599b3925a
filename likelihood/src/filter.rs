//! likelihood: the extended Kalman filter of one run. In: a prepared run, a plant, noise, columns. Out: innovations' log-likelihood and
//! the normal equations of all columns, whitened.
//!
//! States: motion (12), loose mass (4, where the plant has one), random inputs (2 to 4 each), coloured noise (2 each). Tunnel speed is an input. Every column's sensitivity runs through the same filter: `s⁻ = Φ s⁺ + Γ`, `D = H s⁻ + ∂h`, `s⁺ = s⁻ − K D`; whitened
//! by the innovations' covariance `G = Σ DᵀD`, `b = Σ Dᵀν` (Durbin and Koopman 2012, §7.3; Klein and Morelli 2006, §6.2). Rates are means
//! over two opposite points of the unresolved gust, so that what is not linear in the flow angles acts as it does on average (Gelb 1974, §6.2).

mod beside;
#[cfg(test)]
mod dense;
mod predict;
mod rows;
mod update;

use crate::columns::{Basis, SensitivityColumn, Shown, Site, View, body_to_tunnel, lag_s, shown};
use crate::noise::{ChannelNoise, MeanNoise};
use crate::random::{Input, ORDER, Spectra, inputs};
use crate::run::Prepared;
use crate::shock::{Blowing, GustNoise, Taken, Trace};
use beside::Beside;
pub(crate) use beside::NodeInnovations;
use nalgebra::{DMatrix, DVector};
use pulp::{Arch, Simd, WithSimd};
use rows::VECTOR;
use windfall_model::{Campaign, Entry, POSE, PerChannel, Plant, RunNumber};
use windfall_pid::equations::{ADDED, Craft, LOOSE, MOTION, STATES, TunnelAir};

/// Spread of the first state about its start: wide, so that the data decide (m, rad, m/s, rad/s).
const START_STD: [f64; STATES] = [0.05, 0.05, 0.05, 0.05, 0.05, 0.05, 0.5, 0.5, 0.5, 1.0, 1.0, 1.0];
/// Time in which a run's first state is found; its innovations say little of the noise, s.
pub(crate) const SETTLED_S: f64 = 0.5;
/// Accelerations of a search's start that no model need explain, m/s² and rad/s²: of the order of those of a model in free flight.
const SLACK: [f64; 6] = [2.0, 2.0, 2.0, 5.0, 10.0, 10.0];
/// Rows of the whitened columns that are multiplied at a time.
const ROWS: usize = 224;

/// What one run says at one model.
#[derive(Clone, Debug)]
pub(crate) struct Seen {
    pub(crate) g: DMatrix<f64>,
    pub(crate) b: DVector<f64>,
    /// Log-likelihood of the innovations.
    pub(crate) log_likelihood: f64,
    /// Per channel, once the first state is found: sum of squares of innovations, of expected ones, of whitened ones, and count.
    pub(crate) channels: [[f64; 4]; POSE],
    /// Its innovations.
    pub(crate) innovations: NodeInnovations,
    /// Those of filters with the random inputs of other plants, in their order.
    pub(crate) beside: Vec<NodeInnovations>,
    /// Where asked for: a row a channel taken, whitened slopes by the columns and the whitened innovation.
    pub(crate) rows: Vec<f64>,
    /// What a basis may look at, a row a node.
    pub(crate) views: Vec<View>,
    /// Numbers that differ from run to run, in their order, given the run.
    pub(crate) numbers: Vec<RunState>,
    /// What the filter did, where asked for.
    pub(crate) trace: Trace,
    /// Number of its states.
    pub(crate) states: usize,
}

/// A number that differs from run to run, after a run: mean, variance, and slopes of the mean by the columns.
#[derive(Clone, Debug)]
pub(crate) struct RunState {
    pub(crate) mean: f64,
    pub(crate) variance: f64,
    pub(crate) slopes: Vec<f64>,
}

/// Why a pass ended before its run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Departed {
    pub(crate) run: usize,
    pub(crate) t_s: f64,
    /// The first number whose slope is not finite, where the model itself can be followed.
    pub(crate) column: Option<usize>,
}

impl Departed {
    /// In words, the run by its name.
    pub fn words(self, campaign: &Campaign) -> String {
        let run = campaign.runs.get(self.run).map_or("", |r| r.name.as_str());
        format!("the model departs at {:.2} s of run `{run}`", self.t_s)
    }
}

/// Step of a number that differs from run to run, in its unit.
const NUMBER_STEP: f64 = 1e-4;

/// What a pass is made at.
#[derive(Clone, Copy)]
pub(crate) struct PassSetting<'a> {
    pub(crate) plant: &'a Plant,
    pub(crate) noise: &'a PerChannel<ChannelNoise>,
    pub(crate) columns: &'a [SensitivityColumn],
    /// Of each number that differs from run to run, in their order: the plant with the number [`NUMBER_STEP`] away.
    pub(crate) numbers: &'a [Plant],
    /// Plants that differ in their random inputs alone, of the same kinds: what filters with those see is found beside.
    pub(crate) beside: &'a [Plant],
    /// Shares of [`SLACK`] that the accelerations are left free by from node to node, along and about each axis.
    pub(crate) slack: [f64; 6],
    /// Forms of the gusts' spectra.
    pub(crate) spectra: Spectra,
    /// Mean square of what the filter does not see of the gusts, as a multiple of what their form leaves.
    pub(crate) unseen: f64,
    pub(crate) keep: Keep,
}

#[cfg(test)]
impl<'a> PassSetting<'a> {
    /// A pass that finds the likelihood alone.
    pub(crate) fn plain(plant: &'a Plant, noise: &'a PerChannel<ChannelNoise>) -> Self {
        Self {
            plant,
            noise,
            columns: &[],
            numbers: &[],
            beside: &[],
            slack: [0.0; 6],
            spectra: Spectra::default(),
            unseen: 1.0,
            keep: Keep::Nothing,
        }
    }
}

/// What of a pass is kept beside its sums.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Keep {
    Nothing,
    /// Whitened slopes of the innovations by the columns.
    Rows,
    /// What the filter did.
    Trace,
    /// The same, with what gusts add at each step.
    Gusts,
}

/// A column made ready for a run.
enum Ready<'a> {
    Declared(usize),
    Plant {
        craft: Option<Box<Craft<'a>>>,
        plant: &'a Plant,
        step: f64,
        acts: bool,
        shows: bool,
        /// Other lag or scale of the tunnel speed.
        winds: bool,
        clock: f64,
        loose: Option<[f64; LOOSE]>,
    },
    Generic(Site, Basis),
}

/// Instant of a step at which inputs are taken.
#[derive(Clone, Copy)]
enum Stage {
    /// The states as they are.
    Now,
    /// A quarter of the step, 0 to 4: values whose sums by the Runge-Kutta method in two halves are the inputs' integrals.
    Quarter(u8),
}

struct Filter<'a> {
    run: &'a Prepared,
    plant: &'a Plant,
    craft: Craft<'a>,
    random: Vec<Input>,
    /// Numbers that differ from run to run: the place of each among the states, and a plant with the number a small step away.
    numbers: Vec<(usize, Craft<'a>)>,
    /// Coloured noise of node means, by channel.
    coloured: Vec<(usize, MeanNoise)>,
    white: [f64; POSE],
    slack: [f64; 6],
    unseen: f64,
    keep: Keep,
    step_s: f64,
    /// States of the motion, and all; length of rows that hold all, longer where that makes whole vectors (then zeros).
    nm: usize,
    states: usize,
    n: usize,
    /// Columns, and the length of rows that hold them.
    columns: usize,
    nc: usize,
}

/// Plants with each number that differs from run to run a small step away.
pub(crate) fn number_plants(plant: &Plant) -> Vec<Plant> {
    let moved = |(number, _): (RunNumber, f64)| {
        let mut plant = plant.clone();
        plant.change(number, NUMBER_STEP);
        plant
    };
    plant.scatter.numbers().into_iter().map(moved).collect()
}

/// Runs the filter over a run. `plant` and the columns' plants are those of this run.
pub(crate) fn pass(run: &Prepared, s: &PassSetting<'_>) -> Result<Seen, Departed> {
    let fault = Departed { run: run.index, t_s: 0.0, column: None };
    let columns: Vec<Ready<'_>> = s.columns.iter().map(|c| ready(c, s.plant)).collect::<Option<_>>().ok_or(fault)?;
    let filter = &Filter::new(run, s).ok_or(fault)?;
    let of_other = |plant| Beside::new(filter, inputs(plant, run.speed_m_s, filter.step_s, s.spectra));
    let beside = s.beside.iter().map(of_other).collect::<Option<_>>().ok_or(fault)?;
    Arch::new().dispatch(Widest { filter, columns, beside })
}

/// A pass, compiled for each vector unit.
struct Widest<'f, 'a> {
    filter: &'f Filter<'a>,
    columns: Vec<Ready<'a>>,
    beside: Vec<Beside>,
}

impl WithSimd for Widest<'_, '_> {
    type Output = Result<Seen, Departed>;
    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Self::Output {
        self.filter.run(self.columns, self.beside)
    }
}

fn ready<'a>(column: &'a SensitivityColumn, base: &Plant) -> Option<Ready<'a>> {
    Some(match column {
        SensitivityColumn::Declared(i) => Ready::Declared(*i),
        SensitivityColumn::Plant(plant, step) => {
            let shows = plant.sensors != base.sensors || plant.vehicle.p_origin_cm != base.vehicle.p_origin_cm;
            let own = Plant { sensors: base.sensors, ..(**plant).clone() };
            let acts = own != *base;
            let (new, old) = (&plant.sensors, &base.sensors);
            let winds = lag_s(new).to_bits() != lag_s(old).to_bits() || new.wind_scale.to_bits() != old.wind_scale.to_bits();
            let clock = new.time_base - old.time_base;
            let loose = (plant.vehicle.loose.is_some() && base.vehicle.loose.is_none()).then_some([0.0; LOOSE]);
            let craft = if acts { Some(Box::new(Craft::complete(plant).ok()?)) } else { None };
            Ready::Plant { craft, plant, step: *step, acts, shows, winds, clock, loose }
        }
        SensitivityColumn::Generic(site, basis) => Ready::Generic(*site, *basis),
    })
}

impl<'a> Filter<'a> {
    /// A filter ready for its run; `None` where a declared coefficient has no value.
    fn new(run: &'a Prepared, s: &PassSetting<'a>) -> Option<Self> {
        let craft = Craft::complete(s.plant).ok()?;
        let step_s = run.step_s() / (1.0 + s.plant.sensors.time_base);
        let random = inputs(s.plant, run.speed_m_s, step_s, s.spectra);
        let noise: PerChannel<ChannelNoise> = std::array::from_fn(|c| s.noise[c].times(run.noise_ratio[c]));
        let coloured: Vec<(usize, MeanNoise)> =
            (0..POSE).filter(|&c| noise[c].coloured > 0.0).map(|c| (c, noise[c].of_means(run.block))).collect();
        let nm = if s.plant.vehicle.loose.is_some() { MOTION } else { STATES };
        let states = nm + random.iter().map(|r| r.order).sum::<usize>() + 2 * coloured.len();
        let is_number = |(_, input): &(usize, &Input)| matches!(input.entry, Entry::Number(_));
        let places: Vec<usize> = placed(nm, &random).filter(is_number).map(|(at, _)| at).collect();
        let crafts = s.numbers.iter().map(|plant| Craft::complete(plant).ok()).collect::<Option<Vec<_>>>()?;
        let numbers = places.into_iter().zip(crafts).collect();
        let white = std::array::from_fn(|c| noise[c].white.max(1e-6 * noise[c].coloured));
        Some(Self {
            run,
            plant: s.plant,
            craft,
            random,
            numbers,
            coloured,
            white,
            slack: s.slack,
            unseen: s.unseen,
            keep: s.keep,
            step_s,
            nm,
            states,
            n: states.next_multiple_of(VECTOR),
            columns: s.columns.len(),
            nc: s.columns.len().next_multiple_of(VECTOR),
        })
    }

    #[inline(always)]
    fn run(&self, mut columns: Vec<Ready<'a>>, mut beside: Vec<Beside>) -> Result<Seen, Departed> {
        let (n, nc) = (self.n, self.columns);
        let (mut z, mut p) = (self.start(), self.start_covariance(&self.random));
        let mut s = vec![0.0; n * self.nc];
        let mut seen = Seen {
            g: DMatrix::zeros(nc + 1, nc + 1),
            b: DVector::zeros(nc),
            log_likelihood: 0.0,
            channels: [[0.0; 4]; POSE],
            innovations: NodeInnovations::with_capacity(self.run.nodes.len()),
            beside: Vec::new(),
            rows: Vec::new(),
            views: Vec::with_capacity(self.run.nodes.len()),
            numbers: Vec::new(),
            trace: Trace::default(),
            states: n,
        };
        let mut rows: Vec<f64> = Vec::with_capacity(ROWS * (nc + 1));
        let mut work = Work::new(self);
        for k in 0..self.run.nodes.len() {
            let departed = Departed { run: self.run.index, t_s: self.run.nodes[k].t_s, column: None };
            let rate = self.rates(&z, k, Stage::Now, [0.0; 3], &mut work.terms).ok_or(departed)?;
            let view = self.view(&z, k);
            if matches!(self.keep, Keep::Trace | Keep::Gusts) {
                let blowing = if self.keep == Keep::Gusts { self.blowing(k, &z, &p) } else { Vec::new() };
                seen.trace.nodes.push(Taken { t_s: self.run.nodes[k].t_s, blowing, ..Taken::default() });
            }
            self.update(k, &mut z, &mut p, &mut s, &rate, &columns, &view, &mut seen, &mut rows, &mut beside, &mut work);
            seen.views.push(view);
            if rows.len() >= ROWS * (nc + 1) {
                self.gather(&mut rows, &mut seen);
            }
            if k + 1 == self.run.nodes.len() {
                break;
            }
            self.predict(k, &mut z, &mut p, &mut s, &mut columns, &view, &mut beside, &mut work).ok_or(departed)?;
            if !z.iter().all(|v| v.is_finite()) {
                return Err(departed);
            }
            if let Some(node) = seen.trace.nodes.last_mut() {
                node.phi.clone_from(&work.phi);
                node.gusts.append(&mut work.gusts);
            }
        }
        self.gather(&mut rows, &mut seen);
        let state = |(at, _): &(usize, Craft<'_>)| RunState {
            mean: z[*at],
            variance: p[at * n + at],
            slopes: s[at * self.nc..at * self.nc + nc].to_vec(),
        };
        seen.numbers = self.numbers.iter().map(state).collect();
        seen.beside = beside.into_iter().map(|other| other.seen).collect();
        seen.b = DVector::from_fn(nc, |i, _| seen.g[(i, nc)]);
        seen.g = seen.g.view((0, 0), (nc, nc)).into_owned();
        let column = (0..nc).find(|i| !seen.g[(*i, *i)].is_finite());
        let finite = seen.log_likelihood.is_finite() && column.is_none();
        if finite { Ok(seen) } else { Err(Departed { run: self.run.index, t_s: self.run.duration_s(), column }) }
    }

    /// Adds gathered rows to the normal equations, and forgets them or keeps them as was asked for.
    fn gather(&self, rows: &mut Vec<f64>, seen: &mut Seen) {
        multiply(rows, &mut seen.g);
        if self.keep == Keep::Rows {
            seen.rows.append(rows);
        }
        rows.clear();
    }

    /// First state.
    fn start(&self) -> Vec<f64> {
        let mut z = vec![0.0; self.n];
        let q = self.run.start;
        let r = body_to_tunnel([q[3][0], q[4][0], q[5][0]]);
        let arm = self.plant.vehicle.p_origin_cm.to_array();
        let ((sy, cy), (sz, cz)) = (q[4][0].sin_cos(), q[5][0].sin_cos());
        let (rx, ry, rz) = (q[3][1], q[4][1], q[5][1]);
        let w = [rx * cy * cz + ry * sz, ry * cz - rx * cy * sz, rz + rx * sy];
        let turned = [w[1] * arm[2] - w[2] * arm[1], w[2] * arm[0] - w[0] * arm[2], w[0] * arm[1] - w[1] * arm[0]];
        for i in 0..3 {
            let along = |v: [f64; 3]| r[i][0] * v[0] + r[i][1] * v[1] + r[i][2] * v[2];
            z[i] = q[i][0] + along(arm);
            z[3 + i] = q[3 + i][0];
            z[6 + i] = q[i][1] + along(turned);
            z[9 + i] = w[i];
        }
        z
    }

    /// Covariance of the first state with these random inputs.
    fn start_covariance(&self, random: &[Input]) -> Vec<f64> {
        let n = self.n;
        let mut p = vec![0.0; n * n];
        (0..STATES).for_each(|i| p[i * n + i] = START_STD[i] * START_STD[i]);
        if self.nm == MOTION {
            // A loose part hangs anywhere within a centimetre, and moves by as much in its own time.
            let f = self.plant.vehicle.loose.as_ref().map_or(1.0, |l| std::f64::consts::TAU * l.frequency_hz);
            (0..2).for_each(|i| p[(STATES + i) * n + STATES + i] = 1e-4);
            (2..4).for_each(|i| p[(STATES + i) * n + STATES + i] = 1e-4 * f * f);
        }
        for (at, input) in self.placed(random) {
            let now = self.intensity(input, 0);
            for i in 0..input.order {
                (0..input.order).for_each(|k| p[(at + i) * n + at + k] = now * input.stationary[i][k]);
            }
        }
        for (at, _, noise) in self.colours() {
            let [mean, both, last] = noise.stationary;
            (p[at * n + at], p[(at + 1) * n + at + 1]) = (mean, last);
            (p[at * n + at + 1], p[(at + 1) * n + at]) = (both, both);
        }
        p
    }

    /// Coloured noise with the place of its mean, which the last sample follows, and its channel.
    fn colours(&self) -> impl Iterator<Item = (usize, usize, &MeanNoise)> {
        let from = self.states - 2 * self.coloured.len();
        self.coloured.iter().enumerate().map(move |(j, (channel, noise))| (from + 2 * j, *channel, noise))
    }

    /// Variance of a random input at a node over its mean.
    fn intensity(&self, input: &Input, k: usize) -> f64 {
        match input.entry {
            Entry::AirVelocity(axis) => self.run.intensity.at(axis, self.run.nodes[k].t_s),
            _ => 1.0,
        }
    }

    /// Random inputs with the places of their first states.
    fn inputs(&self) -> impl Iterator<Item = (usize, &Input)> {
        self.placed(&self.random)
    }

    /// The same of other inputs.
    fn placed<'i>(&self, random: &'i [Input]) -> impl Iterator<Item = (usize, &'i Input)> {
        placed(self.nm, random)
    }

    /// Inputs at an instant of a step: tunnel speed with its rate, then what the air adds.
    fn air(&self, z: &[f64], k: usize, stage: Stage, spread: [f64; 3]) -> (TunnelAir, [f64; ADDED]) {
        let (fraction, place) = match stage {
            Stage::Now => (0.0, None),
            Stage::Quarter(place) => (0.25 * f64::from(place), Some(usize::from(place))),
        };
        let node = &self.run.nodes[k];
        let t_s = node.t_s + fraction * self.run.step_s();
        let [speed, rate] = self.speed(self.plant, t_s);
        let air = TunnelAir { t_s, density_kg_m3: node.density_kg_m3, vw_m_s: speed, vw_rate_m_s2: rate };
        let mut added = [0.0; ADDED];
        for (at, input) in self.inputs() {
            let q = states(z, at, input.order);
            let q = place.map_or(q, |s: usize| times(&input.stages[s], q));
            match input.entry {
                Entry::AirVelocity(axis) => {
                    added[axis] += q[0] + spread[axis];
                    added[3 + axis] += (0..ORDER).map(|i| input.rate[i] * q[i]).sum::<f64>();
                }
                Entry::Coefficient(c) => added[6 + c] += q[0],
                Entry::RecordedSpeed => added[0] += q[0],
                Entry::RecordedPose(_) | Entry::Number(_) => {}
            }
        }
        (air, added)
    }

    /// Tunnel speed and its rate where the record's clock shows `t_s`, by a plant's instruments.
    fn speed(&self, plant: &Plant, t_s: f64) -> [f64; 2] {
        let s = &plant.sensors;
        let [speed, rate] = self.run.speed.at(t_s + lag_s(s));
        [speed / (1.0 + s.wind_scale), rate * (1.0 + s.time_base) / (1.0 + s.wind_scale)]
    }

    /// What is known of the gusts at a node.
    fn blowing(&self, k: usize, z: &[f64], p: &[f64]) -> Vec<Blowing> {
        let one = |(place, input): (usize, &Input)| {
            let Entry::AirVelocity(axis) = input.entry else { return None };
            let covariance = p[place * self.n..(place + 1) * self.n].to_vec();
            let expected = self.intensity(input, k) * input.stationary[0][0];
            Some(Blowing { axis, place, value: z[place], covariance, expected })
        };
        self.inputs().filter_map(one).collect()
    }

    fn motion(&self, z: &[f64]) -> [f64; MOTION] {
        let mut x = [0.0; MOTION];
        x[..self.nm].copy_from_slice(&z[..self.nm]);
        x
    }

    fn rates(&self, z: &[f64], k: usize, stage: Stage, spread: [f64; 3], terms: &mut Vec<f64>) -> Option<[f64; MOTION]> {
        self.rates_at(&self.motion(z), z, k, stage, spread, terms)
    }

    /// Rates at a motion, inputs from `z`; the mean over both sides of the unresolved gust.
    fn rates_at(
        &self,
        x: &[f64; MOTION],
        z: &[f64],
        k: usize,
        stage: Stage,
        spread: [f64; 3],
        terms: &mut Vec<f64>,
    ) -> Option<[f64; MOTION]> {
        let (air, added) = self.air(z, k, stage, spread);
        let one = self.craft.rates(x, air, &added, terms)?;
        if spread.iter().all(|s| *s == 0.0) {
            return Some(one);
        }
        let (air, added) = self.air(z, k, stage, spread.map(|s| -s));
        let other = self.craft.rates(x, air, &added, terms)?;
        Some(std::array::from_fn(|i| 0.5 * (one[i] + other[i])))
    }

    fn view(&self, z: &[f64], k: usize) -> View {
        let (air, added) = self.air(z, k, Stage::Now, [0.0; 3]);
        let t = body_to_tunnel([z[3], z[4], z[5]]);
        let v = [z[6] + air.vw_m_s - added[0], z[7] - added[1], z[8] - added[2]];
        let u: [f64; 3] = std::array::from_fn(|i| t[0][i] * v[0] + t[1][i] * v[1] + t[2][i] * v[2]);
        View {
            run: self.run.index,
            t_s: self.run.nodes[k].t_s,
            duration_s: self.run.duration_s(),
            speed_m_s: (u[0] * u[0] + u[1] * u[1] + u[2] * u[2]).sqrt(),
            mean_speed_m_s: self.run.speed_m_s,
            tunnel_speed_m_s: air.vw_m_s,
            height_m: z[0],
            away_m: [z[1], z[2]],
            roll_rad: z[3],
            alpha_rad: u[2].atan2(u[0]),
            beta_rad: u[1].atan2(u[0]),
            rates_rad_s: [z[9], z[10], z[11]],
        }
    }

    fn shown(&self, plant: &Plant, z: &[f64], rate: &[f64; MOTION], k: usize) -> Shown {
        let samples = &self.run.nodes[k].pose;
        let arm = plant.vehicle.p_origin_cm.to_array();
        shown(&plant.sensors, arm, &std::array::from_fn(|i| z[i]), rate, [samples.tau_s, samples.tau2_s2])
    }
}

/// Random inputs with the places of their first states, the first at `from`.
fn placed(from: usize, random: &[Input]) -> impl Iterator<Item = (usize, &Input)> {
    random.iter().scan(from, |next, input| {
        let at = *next;
        *next += input.order;
        Some((at, input))
    })
}

/// States of a random input, zero beyond its order.
fn states(z: &[f64], at: usize, order: usize) -> [f64; ORDER] {
    let mut q = [0.0; ORDER];
    q[..order].copy_from_slice(&z[at..at + order]);
    q
}

fn times(m: &crate::random::Block, q: [f64; ORDER]) -> [f64; ORDER] {
    std::array::from_fn(|i| (0..ORDER).map(|k| m[i][k] * q[k]).sum())
}

/// `G += M Mᵀ` of the rows gathered.
fn multiply(rows: &[f64], g: &mut DMatrix<f64>) {
    let width = g.nrows();
    let m = nalgebra::DMatrixView::from_slice(rows, width, rows.len() / width);
    g.gemm(1.0, &m, &m.transpose(), 1.0);
}

/// Memory of a pass.
struct Work {
    h: Vec<f64>,
    ph: Vec<f64>,
    d: Vec<f64>,
    direct: Vec<f64>,
    push: Vec<f64>,
    phi: Vec<f64>,
    q: Vec<f64>,
    /// Both without what the random inputs bring, where other inputs run beside.
    undriven: [Vec<f64>; 2],
    half: Vec<f64>,
    turned: Vec<f64>,
    s: Vec<f64>,
    gamma: Vec<f64>,
    /// Slopes of the rates of motion by each number that differs from run to run.
    by_number: Vec<[f64; MOTION]>,
    /// Slopes of the rates of motion by motion, and their second and third powers.
    powers: [Vec<f64>; 3],
    /// What motion makes of slopes by what the air adds, once and twice.
    pushed: [[[f64; ADDED]; MOTION]; 2],
    terms: Vec<f64>,
    values: Vec<f64>,
    gusts: Vec<GustNoise>,
}

impl Work {
    fn new(f: &Filter<'_>) -> Self {
        let (n, nc) = (f.n, f.nc);
        Self {
            h: vec![0.0; POSE * n],
            ph: vec![0.0; n],
            d: vec![0.0; nc],
            direct: vec![0.0; POSE * nc],
            push: vec![0.0; MOTION * nc],
            phi: vec![0.0; n * n],
            q: vec![0.0; n * n],
            undriven: std::array::from_fn(|_| vec![0.0; n * n]),
            half: vec![0.0; n * n],
            turned: vec![0.0; n * n],
            s: vec![0.0; n * nc],
            gamma: vec![0.0; f.nm * f.nm],
            by_number: Vec::new(),
            powers: std::array::from_fn(|_| vec![0.0; f.nm * f.nm]),
            pushed: [[[0.0; ADDED]; MOTION]; 2],
            terms: Vec::new(),
            values: Vec::new(),
            gusts: Vec::new(),
        }
    }
}

#[cfg(test)]
mod tests;
