//! sim: flights side by side on the vector unit. In: orders, each a plant, a flight and a seed. Out: for each what
//! [`crate::fly_truth`] would give, to the error of the method.
//!
//! Flights of equal structure (which terms, which parts, which sampling) share a kernel; the numbers of each are its own. A
//! flight's bits do not depend on which others fly beside it: a lane never sees another, and the grouping follows from each
//! flight alone. The instruction set is chosen at run time and decides on no bit; between this and [`crate::fly`] results differ by
//! round-off. Why the equations stand here a second time:
//! docs/decisions/batch.md.

mod adaptive;
mod dop853;
mod dopri5;
mod inputs;
mod kernel;
mod lane;
mod rk4;
mod terms;
#[cfg(test)]
mod tests;
mod track;

use crate::error::SimError;
use crate::fly::{start, within};
use crate::integrate::samples;
use crate::record::recorded;
use crate::seed::Seed;
use crate::setup::Setup;
use crate::truth::{End, Flown, Truth};
use adaptive::Wish;
use dop853::Dop853;
use dopri5::Dopri5;
use inputs::{Channels, Inputs};
use kernel::{Constants, HELD, Kernel, PLAIN, Parts};
use lane::Lanes;
use nalgebra::SVector;
use pulp::{Arch, Simd, WithSimd};
use rk4::StepGrid;
use std::collections::HashMap;
use terms::{LaneTerms, Layout};
use track::{KeepSamples, LaneTrack, SampleSeries, Tracks};
use windfall_model::{Flight, Integrator, Plant, Record};

/// One flight of a batch. The plant must already be the one of this run (`Plant::for_run`).
#[derive(Clone, Copy, Debug)]
pub struct Order<'a> {
    /// What flies.
    pub plant: &'a Plant,
    /// How; the integrator's settings are used by [`Stepping::Adaptive`] alone.
    pub flight: &'a Flight,
    /// Of its random inputs and its instruments.
    pub seed: Seed,
}

/// How time is stepped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stepping {
    /// The classical Runge-Kutta method of fourth order, this many equal steps (at least 1) from sample to sample. Its error is
    /// the user's to judge, by halving the step.
    Rk4 {
        /// Steps from one sample to the next.
        steps_per_sample: u32,
    },
    /// The method and the tolerances of each flight, with dense output; every lane has its own step, set as in the single flight.
    Adaptive,
}

/// Flies and records all orders on one core. Results are in the order of the orders.
///
/// # Errors
/// Each flight has its own: those of [`crate::fly`]; [`SimError::NotInBatch`] for a loose mass or a force that depends on α̇ or
/// β̇, which need the coupled solver; a step that could jump over an input.
#[must_use]
pub fn fly_batch(orders: &[Order<'_>], stepping: Stepping) -> Vec<Result<Flown, SimError>> {
    collected(orders, stepping, KeepSamples::Truth, |order, series, steps, end| {
        let truth = std::mem::take(&mut series.truth);
        let record = recorded(order.plant, order.flight, &truth, order.seed, true);
        Flown { truth, record, end, steps }
    })
}

/// As [`fly_batch`], without instruments.
///
/// # Errors
/// As [`fly_batch`].
#[must_use]
pub fn fly_truth_batch(orders: &[Order<'_>], stepping: Stepping) -> Vec<Result<(Truth, End), SimError>> {
    collected(orders, stepping, KeepSamples::Truth, |_, series, _, end| (std::mem::take(&mut series.truth), end))
}

/// As [`fly_truth_batch`], but each flight is shown to `see` with its index and then forgotten, its memory used again: nothing
/// grows with the number of orders. `see` is called once for each order, those of equal structure after one another.
pub fn for_each_truth(orders: &[Order<'_>], stepping: Stepping, mut see: impl FnMut(usize, Result<(&Truth, End), SimError>)) {
    flown(orders, stepping, KeepSamples::Truth, |k, flown| see(k, flown.map(|(series, _, end)| (&series.truth, end))));
}

/// As [`for_each_truth`], with what the instruments make of it.
pub fn for_each_flown(
    orders: &[Order<'_>],
    stepping: Stepping,
    mut see: impl FnMut(usize, Result<(&Truth, Record, End), SimError>),
) {
    for_each_truth(orders, stepping, |k, flown| {
        let Order { plant, flight, seed } = orders[k];
        see(k, flown.map(|(truth, end)| (truth, recorded(plant, flight, truth, seed, true), end)));
    });
}

/// States at the sample times of a flight: c.m. position (m) and velocity (m/s) in tunnel axes, quaternion body to tunnel
/// (scalar first, its length as integrated), body rates (rad/s).
pub type States = [[f64; 13]];

/// As [`for_each_truth`], states alone.
pub fn for_each_states(orders: &[Order<'_>], stepping: Stepping, mut see: impl FnMut(usize, Result<(&States, End), SimError>)) {
    flown(orders, stepping, KeepSamples::States, |k, flown| see(k, flown.map(|(series, _, end)| (&series.states[..], end))));
}

/// What flights side by side have in common.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
struct Kin {
    layout: Layout,
    parts: Parts,
    held: bool,
    samples: usize,
    rate_bits: u64,
    pace: Pace,
}

/// Stepping of a group.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Pace {
    Rk4 { steps_per_sample: usize },
    Adaptive(Integrator),
}

/// A flight made ready.
struct Ready<'a> {
    setup: Setup<'a>,
    terms: LaneTerms,
    index: usize,
}

/// What `make` makes of each flight, in the order of the orders.
fn collected<T>(
    orders: &[Order<'_>],
    stepping: Stepping,
    keep: KeepSamples,
    make: impl Fn(&Order<'_>, &mut SampleSeries, u64, End) -> T,
) -> Vec<Result<T, SimError>> {
    let mut results: Vec<Option<Result<T, SimError>>> = orders.iter().map(|_| None).collect();
    flown(orders, stepping, keep, |k, flown| {
        results[k] = Some(flown.map(|(series, steps, end)| make(&orders[k], series, steps, end)));
    });
    results.into_iter().map(|r| r.expect("every order is flown or refused")).collect()
}

/// Orders made ready at a time: bounds the memory that their inputs take. Flights of equal structure find each other within it.
const WINDOW: usize = 128;

fn flown(
    orders: &[Order<'_>],
    stepping: Stepping,
    keep: KeepSamples,
    mut see: impl FnMut(usize, Result<(&mut SampleSeries, u64, End), SimError>),
) {
    let mut spare = Vec::new();
    for (k, window) in orders.chunks(WINDOW).enumerate() {
        flown_window(window, stepping, keep, &mut spare, |index, flown| see(k * WINDOW + index, flown));
    }
}

fn flown_window(
    orders: &[Order<'_>],
    stepping: Stepping,
    keep: KeepSamples,
    spare: &mut Vec<SampleSeries>,
    mut see: impl FnMut(usize, Result<(&mut SampleSeries, u64, End), SimError>),
) {
    for (kin, group) in groups(orders, stepping, |index, error| see(index, Err(error))) {
        let mut rest = &group[..];
        while !rest.is_empty() {
            let tracks = abreast(Side { kin: &kin, ready: rest, orders, keep, spare });
            let used = tracks.len();
            for (ready, mut track) in rest.iter().zip(tracks) {
                let end = track.end.take().expect("a flown track has ended");
                see(ready.index, end.map(|end| (&mut track.series, track.steps, end)));
                spare.push(track.series);
            }
            rest = &rest[used..];
        }
    }
}

/// Orders by kinship, in the order of their first member.
fn groups<'a>(
    orders: &'a [Order<'a>],
    stepping: Stepping,
    mut refuse: impl FnMut(usize, SimError),
) -> Vec<(Kin, Vec<Ready<'a>>)> {
    let mut groups: Vec<(Kin, Vec<Ready<'a>>)> = Vec::new();
    let mut places: HashMap<Kin, usize> = HashMap::new();
    for (index, order) in orders.iter().enumerate() {
        match ready(order, index, stepping) {
            Err(error) => refuse(index, error),
            Ok((kin, ready)) => {
                let place = *places.entry(kin.clone()).or_insert(groups.len());
                if place == groups.len() {
                    groups.push((kin, Vec::new()));
                }
                groups[place].1.push(ready);
            }
        }
    }
    groups
}

fn ready<'a>(order: &Order<'a>, index: usize, stepping: Stepping) -> Result<(Kin, Ready<'a>), SimError> {
    let setup = Setup::without_history(order.plant, order.flight, order.seed)?;
    within(order.flight)?;
    if let Stepping::Rk4 { steps_per_sample } = stepping {
        check_step(order.flight, steps_per_sample, setup.step_max_s)?;
    }
    let terms = LaneTerms::new(&setup.plant.aero)
        .ok_or(SimError::NotInBatch { what: "an aerodynamic structure of this many different terms" })?;
    if terms.layout.force_needs_rates() {
        return Err(SimError::NotInBatch { what: "a force that depends on the rate of a wind angle" });
    }
    if order.plant.flow.steady_at_m_s != 0.0 {
        return Err(SimError::NotInBatch { what: "lateral flow that does not follow the tunnel speed" });
    }
    if order.plant.vehicle.apparent.in_gusts != 0.0 {
        return Err(SimError::NotInBatch { what: "apparent mass that follows gusts" });
    }
    if order.plant.vehicle.apparent.unturned != 0.0 {
        return Err(SimError::NotInBatch { what: "apparent inertia in body axes alone" });
    }
    if order.plant.vehicle.loose.is_some() {
        return Err(SimError::NotInBatch { what: "a loose mass" });
    }
    let kin = Kin {
        layout: terms.layout.clone(),
        parts: parts(&setup),
        held: setup.hand.is_some(),
        samples: samples(order.flight),
        rate_bits: order.flight.rate_hz.to_bits(),
        pace: match stepping {
            Stepping::Rk4 { steps_per_sample } => Pace::Rk4 { steps_per_sample: steps_per_sample as usize },
            Stepping::Adaptive => Pace::Adaptive(order.flight.numerics.method),
        },
    };
    Ok((kin, Ready { setup, terms, index }))
}

fn check_step(flight: &Flight, steps_per_sample: u32, step_max_s: f64) -> Result<(), SimError> {
    if steps_per_sample == 0 {
        return Err(SimError::Setup { what: "steps_per_sample", value: 0.0, allowed: "at least 1" });
    }
    let step_s = 1.0 / (flight.rate_hz * f64::from(steps_per_sample));
    if step_s > step_max_s {
        let allowed = "short enough not to jump over gusts, contacts or the operator's hand; try more steps_per_sample";
        return Err(SimError::Setup { what: "step of the batch, s", value: step_s, allowed });
    }
    Ok(())
}

fn parts(setup: &Setup<'_>) -> Parts {
    let plant = &setup.plant;
    let i = plant.vehicle.inertia;
    Parts {
        tether: plant.tether.is_some(),
        swivel: plant.tether.as_ref().is_some_and(|t| t.swivel_n_m != 0.0),
        line_rate: plant.tether.as_ref().is_some_and(|t| t.line_rate_n_s_m != 0.0),
        flow: plant.flow != windfall_model::MeanFlow::default(),
        apparent: setup.apparent,
        offset: plant.vehicle.p_origin_cm != windfall_model::frames::Vec3::zero(),
        products: [i.xy, i.xz, i.yz].iter().any(|&product| product != 0.0),
        channels: Channels {
            gusts: !setup.gusts.is_empty(),
            noise: !setup.coefficient_noise.is_empty(),
            contacts: !plant.contacts.is_empty(),
        },
    }
}

fn wish(flight: &Flight, setup: &Setup<'_>) -> Wish {
    let n = flight.numerics;
    Wish { relative_tolerance: n.relative_tolerance, absolute_tolerance: n.absolute_tolerance, step_max_s: setup.step_max_s }
}

/// As many flights of a group as there are lanes.
struct Side<'a, 'g> {
    kin: &'g Kin,
    ready: &'g [Ready<'a>],
    orders: &'a [Order<'a>],
    keep: KeepSamples,
    spare: &'g mut Vec<SampleSeries>,
}

impl<'a> WithSimd for Side<'a, '_> {
    type Output = Vec<LaneTrack<'a>>;
    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let used = self.ready.len().min(S::F64_LANES);
        let fresh = |r: &Ready<'a>| LaneTrack::new(&self.orders[r.index], self.keep, self.spare.pop().unwrap_or_default());
        let mut tracks: Vec<LaneTrack<'a>> = self.ready[..used].iter().map(fresh).collect();
        // Lanes to spare fly the last flight again; nobody looks.
        let ready: Vec<&Ready<'a>> = (0..S::F64_LANES).map(|k| &self.ready[k.min(used - 1)]).collect();
        let (kin, orders) = (self.kin, self.orders);
        let mut sink = Tracks::new(simd, &mut tracks, self.keep);
        if kin.held {
            fly::<S, HELD, 16>(simd, kin, orders, &ready, &mut sink);
        } else {
            fly::<S, PLAIN, 14>(simd, kin, orders, &ready, &mut sink);
        }
        tracks
    }
}

/// Flies them on the vector unit. Not generic, so that the kernels are compiled in this crate alone.
#[inline(never)]
fn abreast<'a>(side: Side<'a, '_>) -> Vec<LaneTrack<'a>> {
    Arch::new().dispatch(side)
}

/// `N` states on lanes, `M` in a single flight, which carries time as one more.
#[inline(always)]
fn fly<S: Simd, const N: usize, const M: usize>(
    simd: S,
    kin: &Kin,
    orders: &[Order<'_>],
    ready: &[&Ready<'_>],
    sink: &mut Tracks<'_, '_, S>,
) {
    let setups: Vec<&Setup<'_>> = ready.iter().map(|r| &r.setup).collect();
    let starts: Vec<SVector<f64, M>> = ready.iter().map(|r| start(&r.setup, orders[r.index].flight)).collect();
    let gather = |of: &dyn Fn(usize) -> f64| Lanes::load(simd, &(0..S::F64_LANES).map(of).collect::<Vec<_>>());
    let mut y = [Lanes::zero(simd); N];
    for (k, lanes) in y.iter_mut().enumerate() {
        let from = if k < PLAIN { k } else { k + 1 };
        *lanes = gather(&|lane| starts[lane][from]);
    }
    let weights: Vec<_> = (0..ready[0].terms.weights.len()).map(|k| gather(&|lane| ready[lane].terms.weights[k])).collect();
    let widths: Vec<_> = (0..ready[0].terms.per_width.len()).map(|k| gather(&|lane| ready[lane].terms.per_width[k])).collect();
    let kernel = Kernel {
        parts: kin.parts,
        layout: &kin.layout,
        weights: &weights,
        per_width: &widths,
        c: Constants::gather(simd, &setups),
    };
    let mut inputs: Vec<Inputs<'_>> = ready.iter().map(|r| Inputs::new(&r.setup, orders[r.index].flight)).collect();
    let rate_hz = f64::from_bits(kin.rate_bits);
    let method = match kin.pace {
        Pace::Rk4 { steps_per_sample } => {
            return rk4::fly(simd, &kernel, &mut inputs, StepGrid { rate_hz, steps_per_sample }, y, sink);
        }
        Pace::Adaptive(method) => method,
    };
    let wishes: Vec<Wish> = ready.iter().map(|r| wish(orders[r.index].flight, &r.setup)).collect();
    let grid = (kin.samples, rate_hz);
    match method {
        Integrator::Dop853 => adaptive::fly::<S, N, Dop853<S, N>>(simd, &kernel, &mut inputs, &wishes, grid, y, sink),
        Integrator::Dopri5 => adaptive::fly::<S, N, Dopri5<S, N>>(simd, &kernel, &mut inputs, &wishes, grid, y, sink),
    }
}
