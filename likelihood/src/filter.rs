//! likelihood: the extended Kalman filter of one run. In: a prepared run, a plant, noise, columns. Out: innovations' log-likelihood and
//! the normal equations of all columns, whitened.
//!
//! States: motion (12), loose mass (4, where the plant has one), random inputs (3 each), coloured noise (1 each). Tunnel speed is an input. Every column's sensitivity runs through the same filter: `s⁻ = Φ s⁺ + Γ`, `D = H s⁻ + ∂h`, `s⁺ = s⁻ − K D`; whitened
//! by the innovations' covariance `G = Σ DᵀD`, `b = Σ Dᵀν` (Durbin and Koopman 2012, §7.3; Klein and Morelli 2006, §6.2). Rates are means
//! over two opposite points of the unresolved gust, so that what is not linear in the flow angles acts as it does on average (Gelb 1974, §6.2).

use crate::columns::{Basis, Column, Shown, View, body_to_tunnel, lag_s, shown};
use crate::noise::{CHANNELS, ChannelNoise, POSE};
use crate::random::{Input, ORDER, inputs};
use crate::run::Prepared;
use crate::shock::{Innovation, Taken, Trace};
use nalgebra::{DMatrix, DVector};
use windfall_model::{Entry, Plant};
use windfall_pid::equations::{ADDED, Air, Craft, LOOSE, Local, MOTION, STATES};

/// Spread of the first state about its start: wide, so that the data decide (m, rad, m/s, rad/s).
const START_STD: [f64; STATES] = [0.05, 0.05, 0.05, 0.05, 0.05, 0.05, 0.5, 0.5, 0.5, 1.0, 1.0, 1.0];
/// Time in which a run's first state is found; its innovations say little of the noise, s.
const SETTLED_S: f64 = 0.5;
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
    /// Whitened innovations of the pose, a row a node (zero where nothing was measured).
    pub(crate) whitened: Vec<[f64; POSE]>,
    /// Log-likelihood of each node.
    pub(crate) nodes: Vec<f64>,
    /// What a basis may look at, a row a node.
    pub(crate) views: Vec<View>,
    /// What the filter did, where asked for.
    pub(crate) trace: Trace,
    /// Number of its states.
    pub(crate) states: usize,
}

/// Why a pass ended before its run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Departed {
    pub(crate) run: usize,
    pub(crate) t_s: f64,
}

impl Departed {
    /// In words.
    pub fn words(self) -> String {
        format!("the model departs at {:.2} s of run {}", self.t_s, self.run + 1)
    }
}

/// What a pass is made at.
#[derive(Clone, Copy)]
pub(crate) struct Setting<'a> {
    pub(crate) plant: &'a Plant,
    pub(crate) noise: &'a [ChannelNoise; CHANNELS],
    pub(crate) columns: &'a [Column],
    /// Share of [`SLACK`] that the accelerations are left free by from node to node.
    pub(crate) slack: f64,
    /// Whether to keep what the filter did.
    pub(crate) traced: bool,
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
    Load(usize, Basis),
    Error(usize, Basis),
}

/// Instant of a step at which inputs are taken.
#[derive(Clone, Copy)]
enum Stage {
    /// The states as they are.
    Now,
    /// Values at the start, middle and end of a Runge-Kutta step whose sums are the inputs' integrals.
    Start,
    Middle,
    End,
}

struct Filter<'a> {
    run: &'a Prepared,
    plant: &'a Plant,
    craft: Craft<'a>,
    random: Vec<Input>,
    /// Coloured noise: channel, correlation, variance of node means.
    coloured: Vec<(usize, f64, f64)>,
    white: [f64; POSE],
    slack: f64,
    traced: bool,
    step_s: f64,
    /// Motion states, all states, columns.
    nm: usize,
    n: usize,
    nc: usize,
}

/// Runs the filter over a run. `plant` and the columns' plants are those of this run.
pub(crate) fn pass(run: &Prepared, s: &Setting<'_>) -> Result<Seen, Departed> {
    let fault = Departed { run: run.index, t_s: 0.0 };
    let craft = Craft::complete(s.plant).map_err(|_| fault)?;
    let columns: Vec<Ready<'_>> = s.columns.iter().map(|c| ready(c, s.plant)).collect::<Option<_>>().ok_or(fault)?;
    let step_s = run.step_s() / (1.0 + s.plant.sensors.time_base);
    let random = inputs(s.plant, run.speed_m_s, step_s);
    let coloured: Vec<(usize, f64, f64)> = (0..POSE)
        .filter(|&c| s.noise[c].coloured > 0.0)
        .map(|c| {
            let (variance, correlation) = s.noise[c].of_means(run.block);
            (c, correlation, variance)
        })
        .collect();
    let nm = if s.plant.vehicle.loose.is_some() { MOTION } else { STATES };
    let n = nm + ORDER * random.len() + coloured.len();
    let white = std::array::from_fn(|c| s.noise[c].white.max(1e-6 * s.noise[c].coloured));
    let filter = Filter {
        run,
        plant: s.plant,
        craft,
        random,
        coloured,
        white,
        slack: s.slack,
        traced: s.traced,
        step_s,
        nm,
        n,
        nc: columns.len(),
    };
    filter.run(columns)
}

fn ready<'a>(column: &'a Column, base: &Plant) -> Option<Ready<'a>> {
    Some(match column {
        Column::Declared(i) => Ready::Declared(*i),
        Column::Plant(plant, step) => {
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
        Column::Load(k, basis) => Ready::Load(*k, *basis),
        Column::Error(k, basis) => Ready::Error(*k, *basis),
    })
}

impl<'a> Filter<'a> {
    fn run(&self, mut columns: Vec<Ready<'a>>) -> Result<Seen, Departed> {
        let (n, nc) = (self.n, self.nc);
        let (mut z, mut p) = self.start();
        let mut s = vec![0.0; n * nc];
        let mut seen = Seen {
            g: DMatrix::zeros(nc + 1, nc + 1),
            b: DVector::zeros(nc),
            log_likelihood: 0.0,
            channels: [[0.0; 4]; POSE],
            whitened: Vec::with_capacity(self.run.nodes.len()),
            nodes: Vec::with_capacity(self.run.nodes.len()),
            views: Vec::with_capacity(self.run.nodes.len()),
            trace: Trace::default(),
            states: n,
        };
        let mut rows: Vec<f64> = Vec::with_capacity(ROWS * (nc + 1));
        let mut work = Work::new(self);
        for k in 0..self.run.nodes.len() {
            let departed = Departed { run: self.run.index, t_s: self.run.nodes[k].t_s };
            let rate = self.rates(&z, k, Stage::Now, [0.0; 3], &mut work.terms).ok_or(departed)?;
            let view = self.view(&z, k);
            if self.traced {
                seen.trace.nodes.push(Taken { t_s: self.run.nodes[k].t_s, ..Taken::default() });
            }
            self.update(k, &mut z, &mut p, &mut s, &rate, &columns, &view, &mut seen, &mut rows, &mut work);
            seen.views.push(view);
            if rows.len() >= ROWS * (nc + 1) {
                multiply(&mut rows, &mut seen.g);
            }
            if k + 1 == self.run.nodes.len() {
                break;
            }
            self.predict(k, &mut z, &mut p, &mut s, &mut columns, &view, &mut work).ok_or(departed)?;
            if !z.iter().all(|v| v.is_finite()) {
                return Err(departed);
            }
            if let Some(node) = seen.trace.nodes.last_mut() {
                node.phi.clone_from(&work.phi);
            }
        }
        multiply(&mut rows, &mut seen.g);
        seen.b = DVector::from_fn(nc, |i, _| seen.g[(i, nc)]);
        seen.g = seen.g.view((0, 0), (nc, nc)).into_owned();
        let finite = seen.log_likelihood.is_finite() && seen.g.iter().all(|v| v.is_finite());
        if finite { Ok(seen) } else { Err(Departed { run: self.run.index, t_s: self.run.duration_s() }) }
    }

    fn start(&self) -> (Vec<f64>, Vec<f64>) {
        let n = self.n;
        let (mut z, mut p) = (vec![0.0; n], vec![0.0; n * n]);
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
        (0..STATES).for_each(|i| p[i * n + i] = START_STD[i] * START_STD[i]);
        if self.nm == MOTION {
            // A loose part hangs anywhere within a centimetre, and moves by as much in its own time.
            let f = self.plant.vehicle.loose.as_ref().map_or(1.0, |l| std::f64::consts::TAU * l.frequency_hz);
            (0..2).for_each(|i| p[(STATES + i) * n + STATES + i] = 1e-4);
            (2..4).for_each(|i| p[(STATES + i) * n + STATES + i] = 1e-4 * f * f);
        }
        for (j, input) in self.random.iter().enumerate() {
            let at = self.nm + ORDER * j;
            for i in 0..ORDER {
                (0..ORDER).for_each(|k| p[(at + i) * n + at + k] = input.stationary[i][k]);
            }
        }
        for (j, (_, _, variance)) in self.coloured.iter().enumerate() {
            let at = n - self.coloured.len() + j;
            p[at * n + at] = *variance;
        }
        (z, p)
    }

    /// Inputs at an instant of a step: tunnel speed with its rate, then what the air adds.
    fn air(&self, z: &[f64], k: usize, stage: Stage, spread: [f64; 3]) -> (Air, [f64; ADDED]) {
        let at = self.nm;
        let (fraction, place) = match stage {
            Stage::Now => (0.0, None),
            Stage::Start => (0.0, Some(0)),
            Stage::Middle => (0.5, Some(1)),
            Stage::End => (1.0, Some(2)),
        };
        let node = &self.run.nodes[k];
        let t_s = node.t_s + fraction * self.run.step_s();
        let [speed, rate] = self.speed(self.plant, t_s);
        let air = Air { t_s, density_kg_m3: node.density_kg_m3, vw_m_s: speed, vw_rate_m_s2: rate };
        let mut added = [0.0; ADDED];
        for (j, input) in self.random.iter().enumerate() {
            let q: [f64; ORDER] = std::array::from_fn(|i| z[at + ORDER * j + i]);
            let q = place.map_or(q, |s: usize| times(&input.driven.stages[s], q));
            match input.entry {
                Entry::AirVelocity(axis) => {
                    added[axis] += q[0] + spread[axis];
                    added[3 + axis] += (0..ORDER).map(|i| input.rate[i] * q[i]).sum::<f64>();
                }
                Entry::Coefficient(c) => added[6 + c] += q[0],
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
            height_m: z[0],
            roll_rad: z[3],
            alpha_rad: u[2].atan2(u[0]),
            beta_rad: u[1].atan2(u[0]),
            rates_rad_s: [z[9], z[10], z[11]],
        }
    }

    fn shown(&self, plant: &Plant, z: &[f64], rate: &[f64; MOTION], k: usize) -> Shown {
        let samples = &self.run.nodes[k].pose;
        shown(plant, z, rate, [samples.tau_s, samples.tau2_s2])
    }

    /// Measurement update at a node, channel by channel (their white noise is independent).
    #[expect(clippy::too_many_arguments, reason = "the state of one filter, borrowed in parts")]
    fn update(
        &self,
        k: usize,
        z: &mut [f64],
        p: &mut [f64],
        s: &mut [f64],
        rate: &[f64; MOTION],
        columns: &[Ready<'_>],
        view: &View,
        seen: &mut Seen,
        rows: &mut Vec<f64>,
        work: &mut Work,
    ) {
        let (n, nc, node) = (self.n, self.nc, &self.run.nodes[k]);
        let predicted = self.shown(self.plant, z, rate, k);
        // Slopes by the states that a channel shows, by differences.
        const STEP: f64 = 1e-6;
        let h = &mut work.h;
        h.fill(0.0);
        for i in 0..STATES {
            let kept = z[i];
            z[i] = kept + STEP;
            let moved = self.shown(self.plant, z, rate, k);
            z[i] = kept;
            (0..POSE).for_each(|c| h[c * n + i] = (moved[c] - predicted[c]) / STEP);
        }
        for (j, (channel, ..)) in self.coloured.iter().enumerate() {
            h[channel * n + n - self.coloured.len() + j] = 1.0;
        }
        // What columns do to the channels at once.
        let direct = &mut work.direct;
        direct.fill(0.0);
        for (j, column) in columns.iter().enumerate() {
            match column {
                Ready::Plant { plant, step, shows: true, .. } => {
                    let moved = self.shown(plant, z, rate, k);
                    (0..POSE).for_each(|c| direct[c * nc + j] = (moved[c] - predicted[c]) / step);
                }
                Ready::Error(channel, basis) => direct[channel * nc + j] = basis.value(view),
                _ => {}
            }
        }
        let mut whitened = [0.0; POSE];
        let so_far = seen.log_likelihood;
        let before = z.to_vec();
        for c in 0..if node.pose.count > 0.0 { POSE } else { 0 } {
            let noise = self.white[c] / node.pose.count;
            let hc = &work.h[c * n..(c + 1) * n];
            let ph = &mut work.ph;
            ph.fill(0.0);
            let mut noise_state = 0.0;
            let mut carried = 0.0;
            let d = &mut work.d;
            d.copy_from_slice(&work.direct[c * nc..(c + 1) * nc]);
            for i in (0..n).filter(|&i| hc[i] != 0.0) {
                axpy(hc[i], &p[i * n..(i + 1) * n], ph);
                axpy(hc[i], &s[i * nc..(i + 1) * nc], d);
                carried += hc[i] * (z[i] - before[i]);
                if i >= n - self.coloured.len() {
                    noise_state += hc[i] * before[i];
                }
            }
            let variance = hc.iter().zip(ph.iter()).map(|(a, b)| a * b).sum::<f64>() + noise;
            let innovation = node.y[c] - predicted[c] - noise_state - carried;
            let root = variance.sqrt();
            let w = innovation / root;
            seen.log_likelihood -= 0.5 * w * w + root.ln();
            if node.t_s > SETTLED_S {
                let sums = &mut seen.channels[c];
                *sums = [sums[0] + innovation * innovation, sums[1] + variance, sums[2] + w * w, sums[3] + 1.0];
            }
            whitened[c] = w;
            rows.extend(d.iter().map(|x| x / root));
            rows.push(w);
            if let Some(node) = seen.trace.nodes.last_mut() {
                node.channels.push(Innovation { slope: hc.to_vec(), covariance: ph.clone(), value: innovation, variance });
            }
            pulp::Arch::new().dispatch(|| {
                for i in 0..n {
                    let gain = ph[i] / variance;
                    if gain == 0.0 {
                        continue;
                    }
                    z[i] += gain * innovation;
                    axpy(-gain, d, &mut s[i * nc..(i + 1) * nc]);
                    axpy(-gain, ph, &mut p[i * n..(i + 1) * n]);
                }
            });
        }
        seen.whitened.push(whitened);
        seen.nodes.push(seen.log_likelihood - so_far);
    }

    /// Time update to the next node.
    #[expect(clippy::too_many_arguments, reason = "the state of one filter, borrowed in parts")]
    fn predict(
        &self,
        k: usize,
        z: &mut [f64],
        p: &mut [f64],
        s: &mut Vec<f64>,
        columns: &mut [Ready<'_>],
        view: &View,
        work: &mut Work,
    ) -> Option<()> {
        let (n, nm, nc, h) = (self.n, self.nm, self.nc, self.step_s);
        let spread = self.spread(p, k);
        // Motion: one step of the classical Runge-Kutta method.
        let x0 = self.motion(z);
        let from = |k: &[f64; MOTION], t: f64| -> [f64; MOTION] { std::array::from_fn(|i| x0[i] + t * k[i]) };
        let k1 = self.rates_at(&x0, z, k, Stage::Start, spread, &mut work.terms)?;
        let k2 = self.rates_at(&from(&k1, 0.5 * h), z, k, Stage::Middle, spread, &mut work.terms)?;
        let k3 = self.rates_at(&from(&k2, 0.5 * h), z, k, Stage::Middle, spread, &mut work.terms)?;
        let k4 = self.rates_at(&from(&k3, h), z, k, Stage::End, spread, &mut work.terms)?;
        let x1: [f64; MOTION] = std::array::from_fn(|i| x0[i] + h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]));
        let middle: [f64; MOTION] = std::array::from_fn(|i| 0.5 * (x0[i] + x1[i]) + 0.125 * h * (k1[i] - k4[i]));
        let (air, added) = self.air(z, k, Stage::Middle, [0.0; 3]);
        let local = self.craft.local(&middle, air, &added, &mut work.terms)?;
        work.values.clone_from(&work.terms);
        let base = self.craft.rates(&middle, air, &added, &mut work.terms)?;
        self.transition(&local, work);
        // Columns: their push on the rates in the middle of the step.
        let push = &mut work.push;
        push.fill(0.0);
        let wrench = self.craft.by_wrench(&std::array::from_fn(|i| middle[i]));
        let vehicle = &self.plant.vehicle;
        let qs = 0.5 * air.density_kg_m3 * view.speed_m_s * view.speed_m_s * vehicle.area_m2();
        for (j, column) in columns.iter_mut().enumerate() {
            match column {
                Ready::Declared(parameter) => {
                    for ((coefficient, _), value) in
                        self.craft.acts().iter().zip(&work.values).filter(|((_, p), _)| *p == Some(*parameter))
                    {
                        (6..nm).for_each(|i| push[i * nc + j] += local.by_added[i][6 + coefficient] * value);
                    }
                }
                Ready::Plant { craft: Some(craft), acts: true, step, loose, .. } => {
                    let mut x = middle;
                    if let Some(part) = loose {
                        x[STATES..].copy_from_slice(part);
                    }
                    let moved = craft.rates(&x, air, &added, &mut work.terms)?;
                    if let Some(part) = loose {
                        swing(part, &moved, craft.plant(), h);
                    }
                    (0..nm).for_each(|i| push[i * nc + j] = (moved[i] - base[i]) / *step);
                }
                Ready::Plant { plant, step, winds: true, .. } => {
                    let moved = self.speed(plant, air.t_s);
                    let by = [(moved[0] - air.vw_m_s) / *step, (moved[1] - air.vw_rate_m_s2) / *step];
                    (0..nm).for_each(|i| push[i * nc + j] = local.by_speed[i][0] * by[0] + local.by_speed[i][1] * by[1]);
                }
                Ready::Load(load, basis) => {
                    let size = qs * basis.value(view) * if *load < 3 { 1.0 } else { vehicle.diameter_m };
                    (0..6).for_each(|i| push[(6 + i) * nc + j] = wrench[i][*load] * size);
                }
                _ => {}
            }
        }
        self.carry(s, columns, &k1, work);
        z[..nm].copy_from_slice(&x1[..nm]);
        for (j, input) in self.random.iter().enumerate() {
            let at = nm + ORDER * j;
            let q = times(&input.driven.whole, std::array::from_fn(|i| z[at + i]));
            z[at..at + ORDER].copy_from_slice(&q);
        }
        for (j, (_, r, _)) in self.coloured.iter().enumerate() {
            z[n - self.coloured.len() + j] *= r;
        }
        self.spread_out(p, work);
        Some(())
    }

    /// Standard deviations of the part of each gust that is not known, with signs that change from node to node so that axes do not mix.
    fn spread(&self, p: &[f64], k: usize) -> [f64; 3] {
        let mut spread = [0.0; 3];
        let pattern = k % 4;
        let sign = [1.0, if pattern < 2 { 1.0 } else { -1.0 }, if pattern.is_multiple_of(2) { 1.0 } else { -1.0 }];
        for (j, input) in self.random.iter().enumerate() {
            if let Entry::AirVelocity(axis) = input.entry {
                let at = self.nm + ORDER * j;
                spread[axis] = sign[axis] * p[at * self.n + at].max(0.0).sqrt();
            }
        }
        spread
    }

    /// Transition of all states over a step and the noise that it adds. Motion by the Taylor series of its matrix exponential; inputs, and
    /// their integrals that move it, exactly.
    fn transition(&self, local: &Local, work: &mut Work) {
        let (n, nm, h) = (self.n, self.nm, self.step_s);
        let blocks = self.random.len();
        let phi = &mut work.phi;
        phi.fill(0.0);
        let a = DMatrix::from_fn(nm, nm, |i, j| local.by_state[i][j]);
        let identity = DMatrix::<f64>::identity(nm, nm);
        let a2 = &a * &a;
        let full = &identity + &a * h + &a2 * (h * h / 2.0) + (&a2 * &a) * (h * h * h / 6.0);
        work.gamma = &identity * h + &a * (h * h / 2.0) + &a2 * (h * h * h / 6.0);
        // Rates of motion by the inputs, and what motion makes of those.
        let mut input = DMatrix::<f64>::zeros(nm, ORDER * blocks);
        for i in 0..nm {
            for (j, r) in self.random.iter().enumerate() {
                for q in 0..ORDER {
                    let own = if q == 0 { 1.0 } else { 0.0 };
                    input[(i, ORDER * j + q)] = match r.entry {
                        Entry::AirVelocity(axis) => local.by_added[i][axis] * own + local.by_added[i][3 + axis] * r.rate[q],
                        Entry::Coefficient(c) => local.by_added[i][6 + c] * own,
                    };
                }
            }
        }
        let once = &a * &input;
        let twice = &a * &once;
        let noise = &mut work.q;
        noise.fill(0.0);
        for i in 0..nm {
            (0..nm).for_each(|j| phi[i * n + j] = full[(i, j)]);
        }
        // White noise that the tunnel speed's record leaves: ∫ (B + A B s)(B + A B s)ᵀ ds.
        let wind = DVector::from_fn(nm, |i, _| local.by_speed[i][0]);
        let next = &a * &wind;
        let density = self.run.speed.density / (1.0 + self.plant.sensors.wind_scale).powi(2);
        for i in 0..nm {
            for k in 0..nm {
                let mixed = wind[i] * next[k] + next[i] * wind[k];
                noise[i * n + k] += density * h * (wind[i] * wind[k] + 0.5 * h * mixed + h * h / 3.0 * next[i] * next[k]);
            }
        }
        for (k, a) in SLACK.iter().enumerate() {
            noise[(6 + k) * n + 6 + k] += (self.slack * a * h).powi(2);
        }
        for block in 0..blocks {
            let driven = &self.random[block].driven;
            let from = ORDER * block;
            // Motion by the first, second and third integrals of the block's states.
            let by = |i: usize, s: usize| {
                let m = [&input, &once, &twice][s / ORDER];
                m[(i, from + s % ORDER)]
            };
            let mut spread = [[0.0; 4 * ORDER]; MOTION];
            for i in 0..nm {
                let row: [f64; 3 * ORDER] = std::array::from_fn(|s| by(i, s));
                for c in 0..ORDER {
                    phi[i * n + nm + from + c] = (0..3 * ORDER).map(|s| row[s] * driven.sums[s / ORDER][s % ORDER][c]).sum();
                }
                for (c, x) in spread[i].iter_mut().enumerate() {
                    *x = (0..3 * ORDER).map(|s| row[s] * driven.added[(ORDER + s, c)]).sum();
                }
                for c in 0..ORDER {
                    noise[i * n + nm + from + c] = spread[i][c];
                    noise[(nm + from + c) * n + i] = spread[i][c];
                }
            }
            for i in 0..nm {
                let row: [f64; 3 * ORDER] = std::array::from_fn(|s| by(i, s));
                for (k, of) in spread.iter().enumerate().take(nm) {
                    noise[k * n + i] += row.iter().zip(&of[ORDER..]).map(|(r, x)| r * x).sum::<f64>();
                }
            }
            for i in 0..ORDER {
                for k in 0..ORDER {
                    phi[(nm + from + i) * n + nm + from + k] = driven.whole[i][k];
                    noise[(nm + from + i) * n + nm + from + k] = driven.added[(i, k)];
                }
            }
        }
        for (j, (_, r, variance)) in self.coloured.iter().enumerate() {
            let at = n - self.coloured.len() + j;
            phi[at * n + at] = *r;
            noise[at * n + at] = variance * (1.0 - r * r);
        }
    }

    /// `S⁻ = Φ S⁺ + Γ`.
    fn carry(&self, s: &mut Vec<f64>, columns: &[Ready<'_>], rate: &[f64; MOTION], work: &mut Work) {
        let (nm, nc) = (self.nm, self.nc);
        if nc == 0 {
            return;
        }
        pulp::Arch::new().dispatch(|| self.moved(s, work));
        let next = &mut work.s;
        // A clock that runs otherwise: all states go further or less far in a step.
        for (j, column) in columns.iter().enumerate() {
            if let Ready::Plant { clock, step, .. } = column
                && *clock != 0.0
            {
                let f = -self.step_s / (1.0 + self.plant.sensors.time_base) * clock / step;
                (0..nm).for_each(|i| next[i * nc + j] += f * rate[i]);
            }
        }
        std::mem::swap(s, next);
    }

    #[inline(always)]
    fn moved(&self, s: &[f64], work: &mut Work) {
        let (n, nm, nc) = (self.n, self.nm, self.nc);
        let next = &mut work.s;
        next.fill(0.0);
        for i in 0..n {
            let row = &mut next[i * nc..(i + 1) * nc];
            for k in 0..n {
                let f = work.phi[i * n + k];
                if f != 0.0 {
                    axpy(f, &s[k * nc..(k + 1) * nc], row);
                }
            }
            if i < nm {
                for k in 6..nm {
                    let f = work.gamma[(i, k)];
                    if f != 0.0 {
                        axpy(f, &work.push[k * nc..(k + 1) * nc], row);
                    }
                }
            }
        }
    }

    /// `P⁻ = Φ P⁺ Φᵀ + Q`.
    fn spread_out(&self, p: &mut [f64], work: &mut Work) {
        pulp::Arch::new().dispatch(|| self.spread_on(p, work));
    }

    #[inline(always)]
    fn spread_on(&self, p: &mut [f64], work: &mut Work) {
        let n = self.n;
        let half = &mut work.half;
        half.fill(0.0);
        for i in 0..n {
            for k in 0..n {
                let f = work.phi[i * n + k];
                if f != 0.0 {
                    axpy(f, &p[k * n..(k + 1) * n], &mut half[i * n..(i + 1) * n]);
                }
            }
        }
        // Φ P, turned, is P Φᵀ; Φ times that.
        let turned = &mut work.turned;
        for i in 0..n {
            (0..n).for_each(|j| turned[j * n + i] = half[i * n + j]);
        }
        half.copy_from_slice(&work.q);
        for i in 0..n {
            for k in 0..n {
                let f = work.phi[i * n + k];
                if f != 0.0 {
                    axpy(f, &turned[k * n..(k + 1) * n], &mut half[i * n..(i + 1) * n]);
                }
            }
        }
        for i in 0..n {
            for j in 0..=i {
                let value = 0.5 * (half[i * n + j] + half[j * n + i]);
                p[i * n + j] = value;
                p[j * n + i] = value;
            }
        }
    }
}

/// Displacement and rate of a loose part a step later, its mount's specific force held: exact for that oscillator.
fn swing(part: &mut [f64; LOOSE], moved: &[f64; MOTION], plant: &Plant, h: f64) {
    let Some(l) = &plant.vehicle.loose else { return };
    let w = std::f64::consts::TAU * l.frequency_hz;
    let a = nalgebra::Matrix2::new(0.0, 1.0, -w * w, -2.0 * l.damping_ratio * w);
    let e = (a * h).exp();
    for axis in 0..2 {
        let (x, v, acceleration) = (part[axis], part[2 + axis], moved[STATES + 2 + axis]);
        let force = acceleration + w * w * x + 2.0 * l.damping_ratio * w * v;
        let rest = force / (w * w);
        (part[axis], part[2 + axis]) = (rest + e[(0, 0)] * (x - rest) + e[(0, 1)] * v, e[(1, 0)] * (x - rest) + e[(1, 1)] * v);
    }
}

fn times(m: &crate::random::Block, q: [f64; ORDER]) -> [f64; ORDER] {
    std::array::from_fn(|i| (0..ORDER).map(|k| m[i][k] * q[k]).sum())
}

#[inline(always)]
fn axpy(a: f64, x: &[f64], y: &mut [f64]) {
    y.iter_mut().zip(x).for_each(|(y, x)| *y += a * x);
}

/// `G += M Mᵀ` of the rows gathered, which are then forgotten.
fn multiply(rows: &mut Vec<f64>, g: &mut DMatrix<f64>) {
    let width = g.nrows();
    let m = nalgebra::DMatrixView::from_slice(rows, width, rows.len() / width);
    g.gemm(1.0, &m, &m.transpose(), 1.0);
    rows.clear();
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
    half: Vec<f64>,
    turned: Vec<f64>,
    s: Vec<f64>,
    gamma: DMatrix<f64>,
    terms: Vec<f64>,
    values: Vec<f64>,
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
            half: vec![0.0; n * n],
            turned: vec![0.0; n * n],
            s: vec![0.0; n * nc],
            gamma: DMatrix::zeros(0, 0),
            terms: Vec::new(),
            values: Vec::new(),
        }
    }
}
