//! What the instruments write: the truth, late, turned, scaled or drifting, and noise of many kinds.

use crate::algebra::{angles, attitude, product};
use crate::chance::Chance;
use crate::craft::Craft;
use crate::flight::{Flown, origin};
use crate::knobs::{Knob as K, Knobs};
use std::f64::consts::TAU;

/// The thesis' standard deviations (Table A.3): X, Y, Z in m, R_x, R_y, R_z in rad, V_W in m/s.
pub(crate) const SIGMA: [f64; 7] = {
    let degree = std::f64::consts::PI / 180.0;
    [7.5e-4, 7.5e-4, 7.5e-4, 0.0623 * degree, 0.110 * degree, 0.110 * degree, 2.57e-3]
};

/// How noise differs from what is declared.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Noise {
    /// Times the declared standard deviations.
    pub(crate) gain: [f64; 7],
    /// Correlation from one sample to the next.
    pub(crate) ar: f64,
    /// Student's t of three degrees of freedom.
    pub(crate) heavy: bool,
    /// Part of the rows that is missing.
    pub(crate) drop: f64,
    /// Number of gaps a run, 0.03-0.3 s each.
    pub(crate) gaps: usize,
    /// Step of the output in standard deviations.
    pub(crate) quantum: f64,
    /// Size of a line in standard deviations, and its frequency in Hz.
    pub(crate) hum: [f64; 2],
    /// Part of the values that is far off.
    pub(crate) outliers: f64,
}

impl Default for Noise {
    fn default() -> Self {
        Self { gain: [1.0; 7], ar: 0.0, heavy: false, drop: 0.0, gaps: 0, quantum: 0.0, hum: [0.0; 2], outliers: 0.0 }
    }
}

/// One row of a run file: time, position (m), Euler angles (deg), tunnel speed.
pub(crate) type Row = [f64; 8];

/// The record of a run.
pub(crate) fn record(flown: &Flown, craft: &Craft, knobs: &Knobs, trim: f64, noise: &Noise, c: &mut Chance) -> Vec<Row> {
    let mut rows = clean(flown, craft, knobs, trim);
    for channel in 0..7 {
        spoil(&mut rows, channel, noise, c);
    }
    thin(rows, noise, c)
}

/// Without noise.
pub(crate) fn clean(flown: &Flown, craft: &Craft, knobs: &Knobs, trim: f64) -> Vec<Row> {
    let k = |which: K| knobs.get(which);
    let seen_axes = attitude([k(K::MisX), k(K::MisY), k(K::MisZ)]);
    let (n, mut roll) = (flown.len(), 0.0);
    let half = flown.sample(n / 2).t;
    let one = |j: usize| {
        let t = flown.sample(j).t;
        let (x, r, _) = flown.before(j, k(K::PoseDelay));
        let (_, _, speed) = flown.before(j, k(K::Vdelay));
        let mut p = origin(x, &r, craft.cm);
        let mut e = angles(&product(&r, &seen_axes));
        e[0] += TAU * ((roll - e[0]) / TAU).round();
        roll = e[0];
        p[1] += k(K::RollBias) * (3.0 * e[0]).sin();
        e[2] += k(K::YawDrift) * t + if t > half { k(K::YawStep) } else { 0.0 };
        let drift = 1.0 + k(K::ProbeHeat) * (1.0 - (-t / 12.0).exp());
        let speed = speed * (1.0 + k(K::Vscale)) * drift + k(K::ProbeBend) * (speed - trim).powi(2);
        let [x, y, z] = p.map(|v| v * (1.0 + k(K::LengthScale)));
        let [a, b, d] = e.map(f64::to_degrees);
        [t * (1.0 + k(K::TimeScale)), x, y, z, a, b, d, speed]
    };
    (0..n).map(one).collect()
}

fn unit(channel: usize) -> f64 {
    if (3..6).contains(&channel) { 180.0 / std::f64::consts::PI } else { 1.0 }
}

fn spoil(rows: &mut [Row], channel: usize, noise: &Noise, c: &mut Chance) {
    let sigma = SIGMA[channel] * unit(channel);
    let size = sigma * noise.gain[channel];
    let draw = |c: &mut Chance| if noise.heavy { c.heavy() } else { c.normal() };
    let fresh = (1.0 - noise.ar * noise.ar).sqrt();
    let mut e = draw(c);
    let phase = c.phase();
    for row in rows {
        let hum = noise.hum[0] * (TAU * noise.hum[1] * row[0] + phase).sin();
        let far = if c.happens(noise.outliers) { c.sign() * c.factor(6.0, 60.0) } else { 0.0 };
        let value = &mut row[channel + 1];
        *value += size * e + sigma * (hum + far);
        if noise.quantum > 0.0 {
            let step = noise.quantum * sigma;
            *value = (*value / step).round() * step;
        }
        e = noise.ar * e + fresh * draw(c);
    }
}

fn thin(mut rows: Vec<Row>, noise: &Noise, c: &mut Chance) -> Vec<Row> {
    let (first, last) = (rows[0][0], rows[rows.len() - 1][0]);
    for _ in 0..noise.gaps {
        let at = c.uniform(first + 1.0, last - 1.3);
        let until = at + c.uniform(0.03, 0.3);
        rows.retain(|r| r[0] < at || r[0] > until);
    }
    rows.retain(|r| (r[0] - first).abs() < 1e-9 || (r[0] - last).abs() < 1e-9 || !c.happens(noise.drop));
    rows
}
