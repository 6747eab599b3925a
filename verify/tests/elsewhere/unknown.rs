//! Gusts that nobody knows: what of a residual stands out of their effect and of noise, by a Kalman filter along the flight.
//!
//! Motion is linearised by differences about the flight, step by step; each component of the gusts is a first-order process of its size and
//! length. Innovations over their standard deviations are what noise and such gusts leave independent and of unit size.

use crate::air::Gusts;
use crate::algebra::{V, angles, product, rodrigues, scale, sub, transpose, turned};
use crate::flight::{Flown, Sample, look, origin};
use crate::instruments::SIGMA;
use crate::motion::World;
use crate::sizes::THIN;
use nalgebra::{DMatrix, DVector};
use std::f64::consts::TAU;

/// Place, turn, velocity, rates; then gusts along three axes.
const MOVED: usize = 12;
const STATES: usize = MOVED + 3;
const SEEN: usize = 6;
/// Steps for differences: m, rad, m/s, rad/s; of gusts, m/s.
const STEP: f64 = 1e-5;
const GUST: f64 = 1e-3;

/// One sample's part of the filter.
struct Node {
    /// To the next sample.
    transition: DMatrix<f64>,
    seen: DMatrix<f64>,
    gain: DMatrix<f64>,
    /// Inverse of the root of the innovations' covariance.
    whiten: DMatrix<f64>,
}

/// The filter of one run.
pub(crate) struct Whitener {
    nodes: Vec<Node>,
}

impl Whitener {
    /// Along a flight in a world, in gusts of that kind.
    pub(crate) fn new(world: &mut World<'_>, flown: &Flown, gusts: &Gusts) -> Self {
        let kept = (-flown.step * world.trim / gusts.length).exp();
        let rms = [gusts.axial, gusts.lateral, gusts.lateral];
        let mut p = DMatrix::zeros(STATES, STATES);
        (0..3).for_each(|i| p[(MOVED + i, MOVED + i)] = rms[i] * rms[i]);
        let mut nodes = Vec::with_capacity(flown.len());
        for k in 0..flown.len() {
            let seen = seen(world, flown.sample(k));
            let s = &seen * &p * seen.transpose() + DMatrix::identity(SEEN, SEEN);
            let root = s.clone().cholesky().expect("noise is in it");
            let gain = &p * seen.transpose() * root.inverse();
            let whiten = root.l().try_inverse().expect("noise is in it");
            let transition = transition(world, flown.sample(k), flown.step, kept);
            // Joseph's form, which stays positive.
            let left = DMatrix::identity(STATES, STATES) - &gain * &seen;
            let after = &left * &p * left.transpose() + &gain * gain.transpose();
            p = &transition * after * transition.transpose();
            p = 0.5 * (&p + p.transpose());
            (0..3).for_each(|i| p[(MOVED + i, MOVED + i)] += rms[i] * rms[i] * (1.0 - kept * kept));
            nodes.push(Node { transition, seen, gain, whiten });
        }
        Self { nodes }
    }

    /// What of a residual, six numbers a sample in standard deviations of noise, is news to who knows the gusts' kind alone.
    pub(crate) fn whitened(&self, residual: &DVector<f64>) -> DVector<f64> {
        let mut out = DVector::zeros(residual.len());
        let mut state = DVector::zeros(STATES);
        for (k, node) in self.nodes.iter().enumerate().take(residual.len() / SEEN) {
            let news = residual.rows(SEEN * k, SEEN) - &node.seen * &state;
            out.rows_mut(SEEN * k, SEEN).copy_from(&(&node.whiten * &news));
            state += &node.gain * news;
            state = &node.transition * state;
        }
        out
    }
}

/// A sample moved by a step of one of its twelve numbers.
fn moved(s: &Sample, which: usize, by: f64) -> Sample {
    let mut to = *s;
    let unit = |j: usize| -> V { std::array::from_fn(|i| if i == j { by } else { 0.0 }) };
    match which / 3 {
        0 => to.x[which % 3] += by,
        1 => to.r = product(&s.r, &turned(scale(unit(which % 3), 0.25))),
        2 => to.v[which % 3] += by,
        _ => to.w[which % 3] += by,
    }
    to
}

/// Difference of two samples in the twelve numbers.
fn between(from: &Sample, to: &Sample) -> [f64; MOVED] {
    let turn = scale(rodrigues(&product(&transpose(&from.r), &to.r)), 4.0);
    let parts = [sub(to.x, from.x), turn, sub(to.v, from.v), sub(to.w, from.w)];
    std::array::from_fn(|i| parts[i / 3][i % 3])
}

fn next(world: &World<'_>, s: &Sample, h: f64) -> Sample {
    let y = world.state(s.x, &s.r, s.v, s.w, [s.speed_w, 0.0, 0.0]);
    look(world, s.t + h, &world.step(s.t, &y, &s.r, h), &s.r)
}

fn transition(world: &mut World<'_>, s: &Sample, h: f64, kept: f64) -> DMatrix<f64> {
    let mut t = DMatrix::zeros(STATES, STATES);
    let here = next(world, s, h);
    for j in 0..MOVED {
        let d = between(&here, &next(world, &moved(s, j, STEP), h));
        (0..MOVED).for_each(|i| t[(i, j)] = d[i] / STEP);
    }
    for axis in 0..3 {
        world.breeze[axis] = GUST;
        let d = between(&here, &next(world, s, h));
        world.breeze[axis] = 0.0;
        (0..MOVED).for_each(|i| t[(i, MOVED + axis)] = d[i] / GUST);
        t[(MOVED + axis, MOVED + axis)] = kept;
    }
    t
}

/// Slopes of what is seen, in standard deviations of the noise of `THIN` samples' mean, by all states.
fn seen(world: &World<'_>, s: &Sample) -> DMatrix<f64> {
    let pose = |s: &Sample| -> [f64; SEEN] {
        let (p, e) = (origin(s.x, &s.r, world.craft.cm), angles(&s.r));
        std::array::from_fn(|c| if c < 3 { p[c] } else { e[c - 3] })
    };
    let here = pose(s);
    let mut h = DMatrix::zeros(SEEN, STATES);
    for j in 0..6 {
        let there = pose(&moved(s, j, STEP));
        for c in 0..SEEN {
            let mut d = there[c] - here[c];
            if c == 3 {
                d -= TAU * (d / TAU).round();
            }
            h[(c, j)] = (THIN as f64).sqrt() * d / STEP / SIGMA[c];
        }
    }
    h
}
