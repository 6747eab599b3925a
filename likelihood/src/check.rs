//! likelihood: what would say that a form is wrong. In: a fitted model. Out: what generic alternatives would still gain, beside the effects of
//! the catalogue in one contest, and lines in the innovations' spectra.
//!
//! Generic alternatives are functions of time, run, speed, place, angles and rates in every force and moment coefficient (`of_loads` has which), drifts of
//! every channel of the pose, and what the tunnel speed may be beyond its record. They have priors and cost like effects; one that is in the best set says that no
//! effect of the catalogue accounts for what it does.

use crate::columns::{Along, Basis, LOADS, Site};
use crate::engine::{Engine, Summed};
use crate::hum::{FORCE, HumStream, MOMENT, ROLL, of_instrument};
use crate::model::Model;
use crate::spectrum::periodogram;
use windfall_model::{CHANNEL_NAMES, POSE};

/// A group of generic columns: functions of one variable in one load or channel.
#[derive(Clone, Debug)]
pub(crate) struct Alternative {
    /// What they change.
    pub(crate) site: Site,
    /// The functions.
    pub(crate) bases: Vec<Basis>,
    /// Prior standard deviation of each, in the site's unit.
    pub(crate) prior: f64,
}

/// Something that nothing in the catalogue accounts for.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Lead {
    /// Coefficient or channel.
    pub channel: String,
    /// What it varies with.
    pub variable: String,
    /// Gain of log-likelihood, costs taken off.
    pub gain: f64,
    /// Frequency of a line, Hz.
    pub line_hz: Option<f64>,
    /// A line that no load makes: too fast and too large for the model's inertia. It is the instrument's.
    pub of_instrument: bool,
    /// Amplitudes of the functions, in their order.
    pub amplitudes: Vec<f64>,
    /// What the runs cannot tell from it: in its place the set is within twenty to one as likely. Likeliest first.
    pub rivals: Vec<Lead>,
}

/// Prior sizes of drifts, in standard deviations of a sample's noise.
const DRIFT: f64 = 5.0;
/// Functions of the place across the tunnel.
const PLACE: [Basis; 5] = [Basis::Place(1, 0), Basis::Place(0, 1), Basis::Place(2, 0), Basis::Place(1, 1), Basis::Place(0, 2)];
/// Prior size of what the tunnel speed is beyond its record, over the speed.
const WIND: f64 = 0.01;

/// All alternatives of an engine's runs.
pub(crate) fn alternatives(engine: &Engine) -> Vec<Alternative> {
    let runs: Vec<usize> = engine.runs.iter().map(|r| r.index).collect();
    let mut all = of_loads(&runs);
    all.extend(of_instruments(engine, &runs));
    all
}

/// Functions of every load.
fn of_loads(runs: &[usize]) -> Vec<Alternative> {
    let of = |place: usize| {
        let prior = [FORCE, FORCE, FORCE, ROLL, MOMENT, MOMENT][place];
        let all = over_time_and_place(runs).into_iter().chain(over_motion(place)).chain(in_proportion(place));
        all.map(move |bases| Alternative { site: Site::Load(place), bases, prior })
    };
    (0..LOADS.len()).flat_map(of).collect()
}

/// What any load may vary with.
fn over_time_and_place(runs: &[usize]) -> Vec<Vec<Basis>> {
    let mut all = vec![(1..=6).map(Basis::Time).collect()];
    if runs.len() > 1 {
        all.push(runs[1..].iter().map(|r| Basis::Run(*r)).collect());
    }
    all.push(vec![Basis::Speed(1), Basis::Speed(2)]);
    all.push(vec![Basis::Height(1), Basis::Height(2)]);
    all.push(vec![Basis::Roll(1, false), Basis::Roll(1, true), Basis::Roll(2, false), Basis::Roll(2, true)]);
    all
}

/// Functions of angles, rates and the place across the tunnel that suit a load.
fn over_motion(place: usize) -> Vec<Vec<Basis>> {
    // Normal force and pitch moment in the plane of α, side force and yaw moment in that of β, and across.
    let axis = [0, 2, 1, 0, 1, 2][place];
    let mut all = match axis {
        0 => vec![[2, 4, 6].map(Basis::TotalAngle).to_vec()],
        1 => vec![vec![Basis::Angle(2, false), Basis::Angle(5, false), Basis::Angle(1, true), Basis::Angle(3, true)]],
        _ => vec![vec![Basis::Angle(2, true), Basis::Angle(5, true), Basis::Angle(1, false), Basis::Angle(3, false)]],
    };
    if place == 3 {
        all.push(vec![Basis::BothAngles]);
    }
    if axis > 0 {
        // Even in the angle: no body of revolution pushes to one side, a part on one of its sides does.
        all.push(vec![Basis::OneSided(axis, 1), Basis::OneSided(axis, 2)]);
        // The rate across: a spinning part inside turns pitching into yawing.
        all.push(vec![Basis::Rate(3 - axis)]);
        // One branch while the total angle opens, another while it closes.
        all.push(vec![Basis::Opening(axis)]);
    }
    all.push(vec![Basis::Hysteresis(axis, false), Basis::Hysteresis(axis, true)]);
    match place {
        // Wakes of what stands in the stream; what grows or is lost on the way.
        0 => all.extend([PLACE.to_vec(), vec![Basis::Elapsed(1), Basis::Elapsed(2)]]),
        // Walls.
        1 | 2 => all.push(vec![Basis::Away(place, 0), Basis::Away(place, 2)]),
        3 => {}
        _ => all.push(vec![Basis::RateSquare(place - 3)]),
    }
    all
}

/// What a load is mostly made of, its angle and its rate, in proportion to a variable.
fn in_proportion(place: usize) -> Vec<Vec<Basis>> {
    let of = |along| match place {
        0 => None,
        1 | 2 => Some(vec![Basis::Slope(3 - place, along)]),
        3 => Some(vec![Basis::Damping(0, along)]),
        _ => Some(vec![Basis::Slope(place - 3, along), Basis::Damping(place - 3, along)]),
    };
    Along::ALL.into_iter().filter_map(of).collect()
}

/// Drifts of every channel of the pose, and what the tunnel speed is beyond its record.
fn of_instruments(engine: &Engine, runs: &[usize]) -> Vec<Alternative> {
    let mut all = Vec::new();
    for place in 0..POSE {
        let prior = DRIFT * engine.noise[place].std();
        let mut add = |bases: Vec<Basis>| all.push(Alternative { site: Site::Channel(place), bases, prior });
        add(vec![Basis::Elapsed(1), Basis::Time(1), Basis::Time(2)]);
        add([1, 2, 3].into_iter().flat_map(|n| [Basis::Roll(n, false), Basis::Roll(n, true)]).collect());
        add(vec![Basis::Height(1), Basis::Height(2)]);
        if runs.len() > 1 {
            add(runs.iter().map(|r| Basis::Run(*r)).collect());
        }
    }
    let mut add = |bases: Vec<Basis>| all.push(Alternative { site: Site::Speed, bases, prior: WIND * engine.mean_speed_m_s() });
    add(vec![Basis::Elapsed(1), Basis::Elapsed(2)]);
    // A probe that reads otherwise at other speeds.
    add([0, 1, 2].map(Basis::TunnelSpeed).to_vec());
    add(vec![Basis::Height(1), Basis::Height(2)]);
    if runs.len() > 1 {
        add(runs[1..].iter().map(|r| Basis::Run(*r)).collect());
    }
    all
}

impl Alternative {
    pub(crate) fn lead(&self, gain: f64, amplitudes: Vec<f64>) -> Lead {
        let variable = self.bases.first().map_or_else(String::new, |b| b.words());
        Lead { channel: self.site.name().to_owned(), variable, gain, amplitudes, ..Lead::default() }
    }
}

/// Whitened innovations of each channel of the pose beyond five standard deviations, of which normal noise has two in ten million.
pub(crate) fn outliers(sum: &Summed) -> [usize; POSE] {
    std::array::from_fn(|c| sum.runs.iter().flat_map(|r| &r.innovations.whitened).filter(|w| w[c].abs() > 5.0).count())
}

/// Lines in the spectra of the whitened innovations beyond what noise has, strongest first: power of a line in nats, the number of
/// frequencies looked at taken off.
pub(crate) fn lines(engine: &Engine, model: &Model, sum: &Summed) -> Vec<Lead> {
    let plant = model.plant(&engine.campaign);
    let mut all = Vec::new();
    let looked: f64 = sum.runs.iter().map(|r| (r.innovations.whitened.len() / 2 * POSE) as f64).sum();
    for (run, seen) in engine.runs.iter().zip(&sum.runs) {
        let skip = 20.min(seen.innovations.whitened.len());
        let n = seen.innovations.whitened.len() - skip;
        let density_kg_m3 = run.nodes.first().map_or(1.2, |n| n.density_kg_m3);
        let stream = HumStream { density_kg_m3, speed_m_s: run.speed_m_s, swing_hz: 0.0 };
        if n < 64 {
            continue;
        }
        for c in 0..POSE {
            let Some(found) = periodogram(seen.innovations.whitened[skip..].iter().map(|w| w[c])) else { continue };
            let over = |(k, p): (usize, &f64)| (k, p / found.window);
            let peak = found.power.iter().enumerate().skip(2).map(over).max_by(|a, b| a.1.total_cmp(&b.1));
            if let Some((k, p)) = peak {
                let gain = p - looked.max(1.0).ln();
                if gain > 0.0 {
                    let hz = k as f64 / (n as f64 * run.step_s());
                    // Hann's window has a mean of one half.
                    let amplitude = 4.0 * (p * found.window).sqrt() / n as f64 * sum.channels[c][1].sqrt();
                    all.push(Lead {
                        channel: CHANNEL_NAMES[c].to_owned(),
                        variable: format!("a line in the spectrum of {}", run.name),
                        gain,
                        line_hz: Some(hz),
                        of_instrument: of_instrument(&plant, stream, c, hz, amplitude),
                        ..Lead::default()
                    });
                }
            }
        }
    }
    all.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    all
}

#[cfg(test)]
mod tests;
