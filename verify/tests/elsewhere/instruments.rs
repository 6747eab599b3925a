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
    /// Half-power frequency of the low-pass filter that a record went through, Hz; zero for none.
    pub(crate) corner_hz: f64,
    /// Rate at which a record was taken again by straight lines, Hz; zero for none.
    pub(crate) resampled_hz: f64,
    /// Random walk of each instrument, in declared standard deviations per root second.
    pub(crate) wander: [f64; 7],
}

impl Default for Noise {
    fn default() -> Self {
        Self {
            gain: [1.0; 7],
            ar: 0.0,
            heavy: false,
            drop: 0.0,
            gaps: 0,
            quantum: 0.0,
            hum: [0.0; 2],
            outliers: 0.0,
            corner_hz: 0.0,
            resampled_hz: 0.0,
            wander: [0.0; 7],
        }
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
    if noise.corner_hz > 0.0 {
        (1..8).for_each(|channel| low_pass(&mut rows, channel, noise.corner_hz * flown.step));
    }
    if noise.resampled_hz > 0.0 {
        rows = resampled(&rows, noise.resampled_hz);
    }
    thin(rows, noise, c)
}

/// A Butterworth filter of second order forward and backward over a channel; its half-power frequency is given over the sample rate.
fn low_pass(rows: &mut [Row], channel: usize, corner: f64) {
    let w = (std::f64::consts::PI * corner).tan();
    let (root, norm) = (std::f64::consts::SQRT_2 * w, 1.0 / (1.0 + std::f64::consts::SQRT_2 * w + w * w));
    let (b, a) = ([w * w * norm, 2.0 * w * w * norm, w * w * norm], [2.0 * (w * w - 1.0) * norm, (1.0 - root + w * w) * norm]);
    for _ in 0..2 {
        let first = rows[0][channel];
        let (mut x, mut y) = ([first; 2], [first; 2]);
        for row in rows.iter_mut() {
            let now = row[channel];
            let out = b[0] * now + b[1] * x[0] + b[2] * x[1] - a[0] * y[0] - a[1] * y[1];
            (x, y) = ([now, x[0]], [out, y[0]]);
            row[channel] = out;
        }
        rows.reverse();
    }
}

/// Rows at another rate, by straight lines between neighbours.
fn resampled(rows: &[Row], rate_hz: f64) -> Vec<Row> {
    let (first, last) = (rows[0][0], rows[rows.len() - 1][0]);
    let step = (last - first) / (rows.len() - 1) as f64;
    let mut all = Vec::new();
    let mut t = first;
    while t <= last {
        let place = (t - first) / step;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "within the rows")]
        let i = (place as usize).min(rows.len() - 2);
        let by = place - i as f64;
        let mut row: Row = std::array::from_fn(|k| rows[i][k] + by * (rows[i + 1][k] - rows[i][k]));
        row[0] = t;
        all.push(row);
        t += 1.0 / rate_hz;
    }
    all
}

/// Without noise.
pub(crate) fn clean(flown: &Flown, craft: &Craft, knobs: &Knobs, trim: f64) -> Vec<Row> {
    let k = |which: K| knobs.get(which);
    let seen_axes = attitude([k(K::MisX), k(K::MisY), k(K::MisZ)]);
    let (n, mut roll) = (flown.len(), 0.0);
    let half = flown.sample(n / 2).t;
    let mut held = flown.sample(0).speed_w;
    let one = |j: usize| {
        let t = flown.sample(j).t;
        let (x, r, _) = flown.before(j, k(K::PoseDelay));
        let (_, _, speed) = flown.before(j, k(K::Vdelay));
        let mut p = origin(x, &r, craft.cm);
        let mut e = angles(&product(&r, &seen_axes));
        e[0] += TAU * ((roll - e[0]) / TAU).round();
        roll = e[0];
        p[1] += k(K::Parallax) * p[0] * p[1];
        p[1] += k(K::RollBias) * (3.0 * e[0]).sin();
        e[2] += k(K::YawDrift) * t + if t > half { k(K::YawStep) } else { 0.0 };
        if (speed - held).abs() >= k(K::DeadBand) {
            held = speed - k(K::DeadBand) * (speed - held).signum();
        }
        let speed = held;
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
    let wander = sigma * noise.wander[channel];
    let (mut astray, mut before) = (0.0, rows[0][0]);
    for row in rows {
        if wander > 0.0 {
            astray += wander * (row[0] - before).max(0.0).sqrt() * c.normal();
            before = row[0];
        }
        let hum = noise.hum[0] * (TAU * noise.hum[1] * row[0] + phase).sin();
        let far = if c.happens(noise.outliers) { c.sign() * c.factor(6.0, 60.0) } else { 0.0 };
        let value = &mut row[channel + 1];
        *value += size * e + sigma * (hum + far) + astray;
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
