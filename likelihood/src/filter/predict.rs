//! likelihood: the filter from one node to the next. In: state, covariance and sensitivities after a node. Out: the same before the next.

use super::{Filter, Ready, SLACK, Stage, Work, axpy, times};
use crate::columns::View;
use crate::random::ORDER;
use nalgebra::{DMatrix, DVector};
use windfall_model::{Entry, Plant};
use windfall_pid::equations::{ADDED, LOOSE, Local, MOTION, STATES, TunnelAir};

/// A step of motion: rates at its start, states in its middle and at its end.
struct FlownStep {
    first: [f64; MOTION],
    middle: [f64; MOTION],
    end: [f64; MOTION],
}

/// The middle of a step: motion, air, what the air adds, rates and their slopes.
struct At {
    middle: [f64; MOTION],
    air: TunnelAir,
    added: [f64; ADDED],
    base: [f64; MOTION],
    local: Local,
}

impl Filter<'_> {
    /// Time update to the next node.
    #[expect(clippy::too_many_arguments, reason = "the state of one filter, borrowed in parts")]
    pub(super) fn predict(
        &self,
        k: usize,
        z: &mut [f64],
        p: &mut [f64],
        s: &mut Vec<f64>,
        columns: &mut [Ready<'_>],
        view: &View,
        work: &mut Work,
    ) -> Option<()> {
        let (n, nm) = (self.n, self.nm);
        let flown = self.flown(k, z, self.spread(p, k), work)?;
        let (air, added) = self.air(z, k, Stage::Middle, [0.0; 3]);
        let local = self.craft.local(&flown.middle, air, &added, &mut work.terms)?;
        work.values.clone_from(&work.terms);
        let base = self.craft.rates(&flown.middle, air, &added, &mut work.terms)?;
        self.transition(&local, work);
        self.push(&At { middle: flown.middle, air, added, base, local }, columns, view, work)?;
        self.carry(s, columns, &flown.first, work);
        z[..nm].copy_from_slice(&flown.end[..nm]);
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

    /// Motion over a step by the classical Runge-Kutta method.
    fn flown(&self, k: usize, z: &[f64], spread: [f64; 3], work: &mut Work) -> Option<FlownStep> {
        let h = self.step_s;
        let x0 = self.motion(z);
        let from = |k: &[f64; MOTION], t: f64| -> [f64; MOTION] { std::array::from_fn(|i| x0[i] + t * k[i]) };
        let k1 = self.rates_at(&x0, z, k, Stage::Start, spread, &mut work.terms)?;
        let k2 = self.rates_at(&from(&k1, 0.5 * h), z, k, Stage::Middle, spread, &mut work.terms)?;
        let k3 = self.rates_at(&from(&k2, 0.5 * h), z, k, Stage::Middle, spread, &mut work.terms)?;
        let k4 = self.rates_at(&from(&k3, h), z, k, Stage::End, spread, &mut work.terms)?;
        let x1: [f64; MOTION] = std::array::from_fn(|i| x0[i] + h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]));
        let middle: [f64; MOTION] = std::array::from_fn(|i| 0.5 * (x0[i] + x1[i]) + 0.125 * h * (k1[i] - k4[i]));
        Some(FlownStep { first: k1, middle, end: x1 })
    }

    /// Push of the columns on the rates in the middle of a step.
    fn push(&self, at: &At, columns: &mut [Ready<'_>], view: &View, work: &mut Work) -> Option<()> {
        let (nm, nc) = (self.nm, self.nc);
        let At { middle, air, added, base, local } = at;
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
                    let mut x = *middle;
                    if let Some(part) = loose {
                        x[STATES..].copy_from_slice(part);
                    }
                    let moved = craft.rates(&x, *air, added, &mut work.terms)?;
                    if let Some(part) = loose {
                        swing(part, &moved, craft.plant(), self.step_s);
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
        work.phi.fill(0.0);
        work.q.fill(0.0);
        let a = DMatrix::from_fn(nm, nm, |i, j| local.by_state[i][j]);
        let identity = DMatrix::<f64>::identity(nm, nm);
        let a2 = &a * &a;
        let full = &identity + &a * h + &a2 * (h * h / 2.0) + (&a2 * &a) * (h * h * h / 6.0);
        work.gamma = &identity * h + &a * (h * h / 2.0) + &a2 * (h * h * h / 6.0);
        for i in 0..nm {
            (0..nm).for_each(|j| work.phi[i * n + j] = full[(i, j)]);
        }
        self.wind_noise(local, &a, work);
        for (k, a) in SLACK.iter().enumerate() {
            work.q[(6 + k) * n + 6 + k] += (self.slack * a * h).powi(2);
        }
        // Rates of motion by the inputs, and what motion makes of those.
        let input = self.by_inputs(local);
        let once = &a * &input;
        let twice = &a * &once;
        for block in 0..self.random.len() {
            self.driven(block, [&input, &once, &twice], work);
        }
        for (j, (_, r, variance)) in self.coloured.iter().enumerate() {
            let at = n - self.coloured.len() + j;
            work.phi[at * n + at] = *r;
            work.q[at * n + at] = variance * (1.0 - r * r);
        }
    }

    /// Slopes of the rates of motion by the states of the random inputs.
    fn by_inputs(&self, local: &Local) -> DMatrix<f64> {
        let nm = self.nm;
        let mut input = DMatrix::<f64>::zeros(nm, ORDER * self.random.len());
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
        input
    }

    /// White noise that the tunnel speed's record leaves: ∫ (B + A B s)(B + A B s)ᵀ ds.
    fn wind_noise(&self, local: &Local, a: &DMatrix<f64>, work: &mut Work) {
        let (n, nm, h) = (self.n, self.nm, self.step_s);
        let noise = &mut work.q;
        let wind = DVector::from_fn(nm, |i, _| local.by_speed[i][0]);
        let next = a * &wind;
        let density = self.run.speed.density / (1.0 + self.plant.sensors.wind_scale).powi(2);
        for i in 0..nm {
            for k in 0..nm {
                let mixed = wind[i] * next[k] + next[i] * wind[k];
                noise[i * n + k] += density * h * (wind[i] * wind[k] + 0.5 * h * mixed + h * h / 3.0 * next[i] * next[k]);
            }
        }
    }

    /// What a random input does to motion and to itself over a step, by its first, second and third integrals.
    fn driven(&self, block: usize, integrals: [&DMatrix<f64>; 3], work: &mut Work) {
        let (n, nm) = (self.n, self.nm);
        let (phi, noise) = (&mut work.phi, &mut work.q);
        let driven = &self.random[block].driven;
        let from = ORDER * block;
        let by = |i: usize, s: usize| integrals[s / ORDER][(i, from + s % ORDER)];
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
