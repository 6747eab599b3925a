//! likelihood: the filter from one node to the next. In: state, covariance and sensitivities after a node. Out: the same before the next.

use super::beside::Beside;
use super::rows::{VECTOR, add_rows};
use super::{Filter, Keep, NUMBER_STEP, Ready, SLACK, Stage, Work, states, times};
use crate::columns::{Site, View};
use crate::random::{Input, REACH};
use crate::shock::GustNoise;
use windfall_model::{Entry, Plant};
use windfall_pid::equations::{ADDED, LOOSE, Local, MOTION, STATES, TunnelAir};

/// A step of motion: rates at its start, states in its middle and at its end.
struct FlownStep {
    first: [f64; MOTION],
    middle: [f64; MOTION],
    end: [f64; MOTION],
}

/// The middle of a step: motion, air, what the air adds, rates with their slopes.
struct At {
    middle: [f64; MOTION],
    air: TunnelAir,
    added: [f64; ADDED],
    local: Local,
}

/// Slopes of the rates of motion by what the air adds.
type Pushed = [[f64; ADDED]; MOTION];

impl Filter<'_> {
    /// Time update to the next node.
    #[expect(clippy::too_many_arguments, reason = "the state of one filter, borrowed in parts")]
    #[inline(always)]
    pub(super) fn predict(
        &self,
        k: usize,
        z: &mut [f64],
        p: &mut [f64],
        s: &mut Vec<f64>,
        columns: &mut [Ready<'_>],
        view: &View,
        beside: &mut [Beside],
        work: &mut Work,
    ) -> Option<()> {
        let nm = self.nm;
        let flown = self.flown(k, z, self.spread(p, k), work)?;
        let (air, added) = self.air(z, k, Stage::Quarter(2), [0.0; 3]);
        let local = self.craft.local(&flown.middle, air, &added, &mut work.terms)?;
        work.values.clone_from(&work.terms);
        self.by_numbers(&flown.middle, air, &added, &local, work)?;
        self.transition(k, &local, !beside.is_empty(), work);
        self.step_beside(k, z, beside, &local, work);
        self.push(&At { middle: flown.middle, air, added, local }, columns, view, work)?;
        self.carry(s, columns, &flown.first, work);
        z[..nm].copy_from_slice(&flown.end[..nm]);
        for (at, _) in &self.numbers {
            let number = z[*at];
            (0..nm).for_each(|i| z[i] += work.phi[i * self.n + at] * number);
        }
        for (at, input) in self.inputs() {
            let q = times(&input.whole, states(z, at, input.order));
            z[at..at + input.order].copy_from_slice(&q[..input.order]);
        }
        for (at, _, noise) in self.colours() {
            let last = z[at + 1];
            z[at..at + 2].copy_from_slice(&noise.by_last.map(|by| by * last));
        }
        let Work { phi, q, half, turned, .. } = work;
        self.spread_on(p, phi, q, [half, turned]);
        Some(())
    }

    /// Slopes of the rates of motion by each number that differs from run to run, in the middle of a step.
    fn by_numbers(
        &self,
        middle: &[f64; MOTION],
        air: TunnelAir,
        added: &[f64; ADDED],
        local: &Local,
        work: &mut Work,
    ) -> Option<()> {
        work.by_number.clear();
        for (_, craft) in &self.numbers {
            let moved = craft.rates(middle, air, added, &mut work.terms)?;
            work.by_number.push(std::array::from_fn(|i| (moved[i] - local.rate[i]) / NUMBER_STEP));
        }
        Some(())
    }

    /// Motion over a step by the classical Runge-Kutta method, in two halves: a moment by the clock angle turns within a node where the model
    /// points into the wind.
    fn flown(&self, k: usize, z: &[f64], spread: [f64; 3], work: &mut Work) -> Option<FlownStep> {
        let start = self.motion(z);
        let (first, middle) = self.half_flown(k, z, &start, 0, spread, work)?;
        let (_, end) = self.half_flown(k, z, &middle, 2, spread, work)?;
        Some(FlownStep { first, middle, end })
    }

    /// Rates at the start of the half that begins at that quarter, and the motion at its end.
    fn half_flown(
        &self,
        k: usize,
        z: &[f64],
        x: &[f64; MOTION],
        quarter: u8,
        spread: [f64; 3],
        work: &mut Work,
    ) -> Option<([f64; MOTION], [f64; MOTION])> {
        let h = 0.5 * self.step_s;
        let from = |k: &[f64; MOTION], t: f64| -> [f64; MOTION] { std::array::from_fn(|i| x[i] + t * k[i]) };
        let mut rates = |x: &[f64; MOTION], on: u8| self.rates_at(x, z, k, Stage::Quarter(quarter + on), spread, &mut work.terms);
        let k1 = rates(x, 0)?;
        let k2 = rates(&from(&k1, 0.5 * h), 1)?;
        let k3 = rates(&from(&k2, 0.5 * h), 1)?;
        let k4 = rates(&from(&k3, h), 2)?;
        Some((k1, std::array::from_fn(|i| x[i] + h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]))))
    }

    /// Push of the columns on the rates in the middle of a step.
    #[inline(always)]
    fn push(&self, at: &At, columns: &mut [Ready<'_>], view: &View, work: &mut Work) -> Option<()> {
        let (nm, nc) = (self.nm, self.nc);
        let At { middle, air, added, local } = at;
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
                    (0..nm).for_each(|i| push[i * nc + j] = (moved[i] - local.rate[i]) / *step);
                }
                Ready::Plant { plant, step, winds: true, .. } => {
                    let moved = self.speed(plant, air.t_s);
                    let by = [(moved[0] - air.vw_m_s) / *step, (moved[1] - air.vw_rate_m_s2) / *step];
                    (0..nm).for_each(|i| push[i * nc + j] = local.by_speed[i][0] * by[0] + local.by_speed[i][1] * by[1]);
                }
                Ready::Generic(Site::Load(load), basis) => {
                    let size = qs * basis.value(view) * if *load < 3 { 1.0 } else { vehicle.diameter_m };
                    (0..6).for_each(|i| push[(6 + i) * nc + j] = wrench[i][*load] * size);
                }
                Ready::Generic(Site::Speed, basis) => {
                    let size = basis.value(view);
                    (0..nm).for_each(|i| push[i * nc + j] = local.by_speed[i][0] * size);
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
        for (at, input) in self.inputs() {
            if let Entry::AirVelocity(axis) = input.entry {
                spread[axis] = sign[axis] * (self.unseen * p[at * self.n + at].max(0.0)).sqrt();
            }
        }
        spread
    }

    /// Transition of all states over a step and, on and below the diagonal, the noise that it adds. Motion by the Taylor series of its
    /// matrix exponential; inputs, and their integrals that move it, exactly.
    #[inline(always)]
    pub(super) fn transition(&self, k: usize, local: &Local, keep_undriven: bool, work: &mut Work) {
        let (n, h) = (self.n, self.step_s);
        work.phi.fill(0.0);
        work.q.fill(0.0);
        self.of_motion(local, work);
        for ((at, _), by) in self.numbers.iter().zip(&work.by_number) {
            for i in 0..self.nm {
                let gamma = &work.gamma[i * self.nm..(i + 1) * self.nm];
                work.phi[i * n + at] = gamma.iter().zip(by).map(|(g, b)| g * b).sum();
            }
            work.phi[at * n + at] = 1.0;
        }
        if !self.random.is_empty() {
            self.of_inputs(local, work);
        }
        self.wind_noise(local, work);
        for (k, a) in SLACK.iter().enumerate() {
            work.q[(6 + k) * n + 6 + k] += (self.slack[k] * a * h).powi(2);
        }
        for (at, _, noise) in self.colours() {
            let [mean, both, last] = noise.added;
            (work.phi[at * n + at + 1], work.phi[(at + 1) * n + at + 1]) = (noise.by_last[0], noise.by_last[1]);
            (work.q[at * n + at], work.q[(at + 1) * n + at + 1]) = (mean, last);
            work.q[(at + 1) * n + at] = both;
        }
        if keep_undriven {
            work.undriven[0].copy_from_slice(&work.phi);
            work.undriven[1].copy_from_slice(&work.q);
        }
        work.gusts.clear();
        let Work { phi, q, pushed, gusts, .. } = work;
        for (at, input) in self.inputs() {
            let before = if self.keep == Keep::Gusts { q.clone() } else { Vec::new() };
            self.driven((at, self.intensity(input, k)), input, [&local.by_added, &pushed[0], &pushed[1]], phi, q);
            if let (Keep::Gusts, Entry::AirVelocity(axis)) = (self.keep, input.entry) {
                gusts.push(self.gust_noise(at, input, axis, &before, q));
            }
        }
    }

    /// `Φ = I + h A + h²/2 A² + h³/6 A³` of the motion, and its integral `Γ = h I + h²/2 A + h³/6 A²`.
    #[inline(always)]
    fn of_motion(&self, local: &Local, work: &mut Work) {
        let (n, nm, h) = (self.n, self.nm, self.step_s);
        let [once, twice, thrice] = &mut work.powers;
        for i in 0..nm {
            once[i * nm..(i + 1) * nm].copy_from_slice(&local.by_state[i][..nm]);
        }
        product(nm, once, once, twice);
        product(nm, once, twice, thrice);
        let (second, third) = (h * h / 2.0, h * h * h / 6.0);
        for i in 0..nm {
            for j in 0..nm {
                let [a, b, c] = [once[i * nm + j], twice[i * nm + j], thrice[i * nm + j]];
                let one = f64::from(u8::from(i == j));
                work.phi[i * n + j] = one + h * a + second * b + third * c;
                work.gamma[i * nm + j] = h * one + second * a + third * b;
            }
        }
    }

    /// `A B` and `A² B` of the motion and what the air may add.
    #[inline(always)]
    fn of_inputs(&self, local: &Local, work: &mut Work) {
        let nm = self.nm;
        let Work { powers: [once, ..], pushed: [first, second], .. } = work;
        for (i, a) in once.chunks_exact(nm).enumerate() {
            first[i] = [0.0; ADDED];
            add_rows(a, local.by_added.as_flattened(), ADDED, &mut first[i]);
        }
        for (row, a) in second.iter_mut().zip(once.chunks_exact(nm)) {
            *row = [0.0; ADDED];
            add_rows(a, first.as_flattened(), ADDED, row);
        }
    }

    /// `A v` of the motion.
    #[inline(always)]
    fn by_motion(&self, v: &[f64; MOTION], work: &Work) -> [f64; MOTION] {
        let nm = self.nm;
        let row = |i: usize| work.powers[0][i * nm..(i + 1) * nm].iter().zip(v).map(|(a, x)| a * x).sum();
        std::array::from_fn(|i| if i < nm { row(i) } else { 0.0 })
    }

    /// White noise that the tunnel speed's record leaves: ∫ (B + A B s)(B + A B s)ᵀ ds.
    #[inline(always)]
    fn wind_noise(&self, local: &Local, work: &mut Work) {
        let (n, nm, h) = (self.n, self.nm, self.step_s);
        let wind = local.by_speed.map(|slopes| slopes[0]);
        let next = self.by_motion(&wind, work);
        let density = self.run.speed.density / (1.0 + self.plant.sensors.wind_scale).powi(2);
        for i in 0..nm {
            for k in 0..=i {
                let mixed = wind[i] * next[k] + next[i] * wind[k];
                work.q[i * n + k] += density * h * (wind[i] * wind[k] + 0.5 * h * mixed + h * h / 3.0 * next[i] * next[k]);
            }
        }
    }

    /// What a random input, its first state at `at` and its variance `now` times its mean, does to motion and to itself over a step: adds to
    /// a transition and to the noise that it adds. `slopes`: of the rates of motion by what the air adds, and what motion makes of them, once
    /// and twice.
    #[inline(always)]
    pub(super) fn driven(&self, (at, now): (usize, f64), input: &Input, slopes: [&Pushed; 3], phi: &mut [f64], q: &mut [f64]) {
        let (n, nm) = (self.n, self.nm);
        // Rates of motion by the input and by its rate, and what motion makes of those.
        let (own, rate) = match input.entry {
            Entry::AirVelocity(axis) => (Some(axis), Some(3 + axis)),
            Entry::RecordedSpeed => (Some(0), None),
            Entry::Coefficient(c) => (Some(6 + c), None),
            Entry::RecordedPose(_) => (None, None),
            // Moves by the transition that is there, and has no noise.
            Entry::Number(_) => return,
        };
        let mut moved = [[0.0; MOTION]; REACH];
        for (k, slopes) in slopes.into_iter().enumerate() {
            for i in 0..nm {
                moved[2 * k][i] = own.map_or(0.0, |own| slopes[i][own]);
                moved[2 * k + 1][i] = rate.map_or(0.0, |rate| slopes[i][rate]);
            }
        }
        let own = moved[0];
        let broad = now * (input.broad * self.step_s).powi(2);
        for c in 0..input.order {
            let by = weighted(&moved, &input.reach.map(|r| r[c]));
            let crossed = weighted(&moved, &input.crossed.map(|r| now * r[c]));
            for i in 0..nm {
                phi[i * n + at + c] = by[i];
                q[(at + c) * n + i] = crossed[i];
            }
        }
        let spread = input.reach_added.map(|r| weighted(&moved, &r));
        for i in 0..nm {
            let mut sum = weighted(&moved, &spread.map(|s| now * s[i]));
            sum.iter_mut().zip(&own).for_each(|(sum, x)| *sum += broad * own[i] * x);
            q[i * n..=i * n + i].iter_mut().zip(&sum).for_each(|(q, s)| *q += s);
        }
        for i in 0..input.order {
            for k in 0..input.order {
                phi[(at + i) * n + at + k] = input.whole[i][k];
                q[(at + i) * n + at + k] = now * input.added[i][k];
            }
        }
    }

    /// What a gust along an axis, its first state at `at`, has added to the noise of a step, which was `before`.
    fn gust_noise(&self, at: usize, input: &Input, axis: usize, before: &[f64], q: &[f64]) -> GustNoise {
        let states: Vec<usize> = (0..self.nm).chain(at..at + input.order).collect();
        let mut added = Vec::new();
        for (i, row) in states.iter().enumerate() {
            added.extend(states[..=i].iter().map(|k| q[row * self.n + k] - before[row * self.n + k]));
        }
        GustNoise { axis, states, added }
    }

    /// `S⁻ = Φ S⁺ + Γ`.
    #[inline(always)]
    fn carry(&self, s: &mut Vec<f64>, columns: &[Ready<'_>], rate: &[f64; MOTION], work: &mut Work) {
        let (nm, nc) = (self.nm, self.nc);
        if nc == 0 {
            return;
        }
        self.moved(s, work);
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
        for i in 0..self.states {
            let row = &mut next[i * nc..(i + 1) * nc];
            add_rows(&work.phi[i * n..i * n + self.states], s, nc, row);
            if i < nm {
                add_rows(&work.gamma[i * nm + 6..(i + 1) * nm], &work.push[6 * nc..], nc, row);
            }
        }
    }

    /// `P⁻ = Φ P⁺ Φᵀ + Q`; two matrices to work in.
    #[inline(always)]
    pub(super) fn spread_on(&self, p: &mut [f64], phi: &[f64], q: &[f64], [half, turned]: [&mut Vec<f64>; 2]) {
        let (n, states) = (self.n, self.states);
        let phi = |i: usize| &phi[i * n..i * n + states];
        half.fill(0.0);
        for i in 0..states {
            add_rows(phi(i), p, n, &mut half[i * n..(i + 1) * n]);
        }
        // Φ P, turned, is P Φᵀ; Φ times that.
        for i in 0..states {
            (0..states).for_each(|j| turned[j * n + i] = half[i * n + j]);
        }
        // On and below the diagonal; the rest is the same.
        for i in 0..states {
            let row = &mut half[i * n..(i + 1) * n];
            row.copy_from_slice(&q[i * n..(i + 1) * n]);
            add_rows(phi(i), turned, n, &mut row[..(i + 1).next_multiple_of(VECTOR)]);
            for (j, value) in row[..=i].iter().enumerate() {
                p[i * n + j] = *value;
                p[j * n + i] = *value;
            }
        }
    }
}

/// Sum of motions by their weights.
#[inline(always)]
fn weighted(all: &[[f64; MOTION]; REACH], weights: &[f64; REACH]) -> [f64; MOTION] {
    let mut sum = [0.0; MOTION];
    for (one, w) in all.iter().zip(weights) {
        sum.iter_mut().zip(one).for_each(|(sum, x)| *sum += x * w);
    }
    sum
}

/// `out = a b` of square matrices by rows, of whole vectors.
#[inline(always)]
fn product(n: usize, a: &[f64], b: &[f64], out: &mut [f64]) {
    out.fill(0.0);
    for (row, a) in out.chunks_exact_mut(n).zip(a.chunks_exact(n)) {
        add_rows(a, b, n, row);
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

#[cfg(test)]
mod tests;
