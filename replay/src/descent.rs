//! replay: an identified model in the atmosphere it is meant for. In: planet scenario, identification. Out: statistics of many descents.
//!
//! Coefficients are dimensionless and are flown at full scale as they were identified on the model (Froude scaling); damping terms are
//! made dimensionless by the full-scale body's length and speed. What Reynolds and Mach numbers change is not in it.

mod draw;
mod landing;
mod linear;
mod quantity;
mod result;
mod shares;
mod summary;

pub use landing::LandingScatter;
pub use linear::{SteadyFall, steady_fall};
pub use result::{
    DescentEnds, DescentModel, DescentReason, DescentSummary, DrawnParameter, HeightLine, ParameterShare, TouchDownLine,
};

use crate::ReplayError;
use draw::Bodies;
use rayon::prelude::*;
use summary::FlownDraw;
use windfall_model::planet::{PlanetFlight, PlanetScenario};
use windfall_model::study::{Column, Row};
use windfall_pid::Identification;
use windfall_sim::{Descent, Seed, SimError};

/// Longest step, s.
const STEP_S: f64 = 0.1;
/// Largest phase of the pitch mode in a step, rad: its error is `phase⁵/120`, 2e-5 rad.
const PHASE_RAD: f64 = 0.3;
/// Steps in the time that air takes to pass the shortest gust's length.
const STEPS_PER_GUST: f64 = 8.0;
/// Intervals of height.
const INTERVALS: usize = 40;

/// How to descend.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DescentOrder {
    /// Number of descents.
    pub draws: u64,
    /// Seed of all chance.
    pub seed: u64,
}

/// Many descents: what they say, and each of them.
#[derive(Clone, Debug, PartialEq)]
pub struct Descended {
    /// The content of `descent.json`.
    pub summary: DescentSummary,
    /// Columns of [`Descended::rows`] after the draw's number.
    pub columns: Vec<Column>,
    /// A row a draw.
    pub rows: Vec<Row>,
}

/// Flies a scenario's flight down many times, side by side on the threads of the current pool, each draw with a model drawn from the
/// identification's posterior (without one: the scenario's own coefficients). The result does not depend on the number of threads.
/// `see` is called after each descent.
///
/// # Errors
/// An identification without covariance or of another structure, a flight or a body that cannot begin.
pub fn descend(
    scenario: &PlanetScenario,
    flight: &PlanetFlight,
    found: Option<&Identification>,
    order: DescentOrder,
    see: impl Fn() + Sync,
) -> Result<Descended, ReplayError> {
    let set = found.map(|f| f.combined().ok_or(ReplayError::NoDataSet)).transpose()?;
    let bodies = Bodies::new(scenario, set)?;
    let heights_m = heights(flight);
    let at = |h: &f64| steady_fall(scenario, &bodies.nominal, &flight.start, *h);
    let linear_theory: Vec<SteadyFall> = heights_m.iter().filter_map(at).collect();
    let step_s = step(scenario, &linear_theory);
    let descent = Descent::new(scenario, flight, heights_m.clone(), step_s)?;
    let nominal = match descent.fly(&bodies.nominal, None) {
        Err(wrong @ SimError::Setup { .. }) => return Err(wrong.into()),
        other => other,
    };
    let chance = scenario.dispersions.gusts.is_some() || !scenario.dispersions.start.is_exact();
    let paired = chance && bodies.is_uncertain();
    let one = |draw: u64| {
        let model = if paired { draw / 2 } else { draw };
        let (body, values) = bodies.draw(Seed { campaign: order.seed, run: model });
        let flown = descent.fly(&body, chance.then_some(Seed { campaign: order.seed, run: draw }));
        see();
        FlownDraw { model, values, flown }
    };
    let all: Vec<FlownDraw> = (0..order.draws).into_par_iter().map(one).collect();
    let names: Vec<String> = bodies.drawn.iter().map(|d| d.name.clone()).collect();
    let of = |d: &draw::Drawn| DrawnParameter { name: d.name.clone(), nominal: d.nominal, std: d.std };
    let summary = DescentSummary {
        scenario: scenario.name.clone(),
        flight: flight.name.clone(),
        model: found.zip(set).map(|(f, s)| DescentModel { method: f.method.clone(), data_set: s.name.clone() }),
        draws: order.draws,
        seed: order.seed,
        step_s,
        in_pairs: paired,
        parameters: bodies.drawn.iter().map(of).collect(),
        ends: summary::ends(&all),
        touch_down: summary::touch_down(&all, nominal.as_ref().ok(), &names, [paired, chance]),
        landing: landing::scatter(&summary::places_m(&all)),
        over_height: summary::over_height(&all, nominal.as_ref().ok(), &heights_m),
        linear_theory,
        warnings: warnings(&bodies, nominal.as_ref().err(), chance),
    };
    Ok(Descended { summary, columns: summary::columns(&names), rows: summary::rows(&all) })
}

fn warnings(bodies: &Bodies, nominal: Option<&SimError>, chance: bool) -> Vec<String> {
    let mut all = bodies.warnings.clone();
    if let Some(error) = nominal {
        all.push(format!("the nominal model cannot be flown down: {error}"));
    }
    if !bodies.is_uncertain() {
        all.push(
            "no parameter is uncertain: give an identification (--model), or [uncertainty.vehicle] in the scenario".to_owned(),
        );
    }
    if !chance {
        all.push(
            "every flight of a model is the same: the scenario has neither turbulence in [environment] nor [uncertainty.initial]"
                .to_owned(),
        );
    }
    all
}

/// Heights at which descents are looked at, from the start to the ground, m.
fn heights(flight: &PlanetFlight) -> Vec<f64> {
    let from_m = flight.start.place.height_m;
    (0..=INTERVALS).map(|k| from_m * (INTERVALS - k) as f64 / INTERVALS as f64).collect()
}

/// Step that resolves the pitch mode and the gusts, s.
fn step(scenario: &PlanetScenario, theory: &[SteadyFall]) -> f64 {
    let fastest = theory.iter().filter_map(|t| t.pitch_frequency_hz).fold(0.0, f64::max) * std::f64::consts::TAU;
    let speed = theory.iter().map(|t| t.terminal_speed_m_s).fold(0.0, f64::max);
    let of_gusts = scenario.dispersions.gusts.as_ref().map(|g| g.shortest_scale_m() / (STEPS_PER_GUST * speed));
    let limits = [Some(PHASE_RAD / fastest), of_gusts].into_iter().flatten().filter(|x| x.is_finite());
    limits.fold(STEP_S, f64::min)
}

#[cfg(test)]
mod tests;
