//! sim: flights side by side on the vector unit. In: orders, each a plant, a flight and a seed. Out: for each what
//! [`crate::fly_truth`] would give, to the error of the fixed step.
//!
//! Flights of equal structure (which terms, which parts, which sampling) share a kernel; the numbers of each are its own. A
//! flight's bits do not depend on which others fly beside it: a lane never sees another, and the grouping follows from each
//! flight alone. The instruction set is chosen at run time; between machines with fused multiplication and those without, and
//! between this and [`crate::fly`], results differ by round-off. Why the equations stand here a second time:
//! docs/decisions/batch.md.

mod inputs;
mod kernel;
mod lane;
mod rk4;
mod terms;
mod track;

use crate::error::SimError;
use crate::fly::{start, within};
use crate::integrate::samples;
use crate::record::record;
use crate::seed::Seed;
use crate::setup::Setup;
use crate::truth::{End, Flown, Truth};
use inputs::{Channels, Inputs};
use kernel::{Constants, HELD, Kernel, PLAIN, Parts};
use lane::Lanes;
use nalgebra::SVector;
use pulp::{Arch, Simd, WithSimd};
use rk4::Grid;
use std::collections::HashMap;
use terms::{Layout, Terms};
use track::{Keep, Series, Track, Tracks};
use windfall_model::{Flight, Plant};

/// One flight of a batch. The plant must already be the one of this run (`Plant::for_run`).
#[derive(Clone, Copy, Debug)]
pub struct Order<'a> {
    /// What flies.
    pub plant: &'a Plant,
    /// How; the integrator's settings in it are not used.
    pub flight: &'a Flight,
    /// Of its random inputs and its instruments.
    pub seed: Seed,
}

/// Flies and records all orders by the classical Runge-Kutta method, `steps_per_sample` (at least 1) equal steps from sample
/// to sample; one core. Results are in the order of the orders.
///
/// # Errors
/// Each flight has its own: those of [`crate::fly`]; [`SimError::NotInBatch`] for a loose mass or a force that depends on α̇ or
/// β̇, which need the coupled solver; a step that could jump over an input.
#[must_use]
pub fn fly_batch(orders: &[Order<'_>], steps_per_sample: u32) -> Vec<Result<Flown, SimError>> {
    collected(orders, steps_per_sample, Keep::Truth, |order, series, end| {
        let truth = std::mem::take(&mut series.truth);
        let record = record(order.plant, order.flight, &truth, order.seed);
        let steps = (truth.len() - 1) as u64 * u64::from(steps_per_sample);
        Flown { truth, record, end, steps }
    })
}

/// As [`fly_batch`], without instruments.
///
/// # Errors
/// As [`fly_batch`].
#[must_use]
pub fn fly_truth_batch(orders: &[Order<'_>], steps_per_sample: u32) -> Vec<Result<(Truth, End), SimError>> {
    collected(orders, steps_per_sample, Keep::Truth, |_, series, end| (std::mem::take(&mut series.truth), end))
}

/// As [`fly_truth_batch`], but each flight is shown to `see` with its index and then forgotten, its memory used again: nothing
/// grows with the number of orders. `see` is called once for each order, those of equal structure after one another.
pub fn for_each_truth(
    orders: &[Order<'_>],
    steps_per_sample: u32,
    mut see: impl FnMut(usize, Result<(&Truth, End), SimError>),
) {
    flown(orders, steps_per_sample, Keep::Truth, |k, flown| see(k, flown.map(|(series, end)| (&series.truth, end))));
}

/// States at the sample times of a flight: c.m. position (m) and velocity (m/s) in tunnel axes, quaternion body to tunnel
/// (scalar first, its length as integrated), body rates (rad/s).
pub type States = [[f64; 13]];

/// As [`for_each_truth`], states alone.
pub fn for_each_states(
    orders: &[Order<'_>],
    steps_per_sample: u32,
    mut see: impl FnMut(usize, Result<(&States, End), SimError>),
) {
    flown(orders, steps_per_sample, Keep::States, |k, flown| see(k, flown.map(|(series, end)| (&series.states[..], end))));
}

/// What flights side by side have in common.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
struct Kin {
    layout: Layout,
    parts: Parts,
    held: bool,
    samples: usize,
    rate_bits: u64,
}

/// A flight made ready.
struct Ready<'a> {
    setup: Setup<'a>,
    terms: Terms,
    index: usize,
}

/// What `make` makes of each flight, in the order of the orders.
fn collected<T>(
    orders: &[Order<'_>],
    steps_per_sample: u32,
    keep: Keep,
    make: impl Fn(&Order<'_>, &mut Series, End) -> T,
) -> Vec<Result<T, SimError>> {
    let mut results: Vec<Option<Result<T, SimError>>> = orders.iter().map(|_| None).collect();
    flown(orders, steps_per_sample, keep, |k, flown| {
        results[k] = Some(flown.map(|(series, end)| make(&orders[k], series, end)));
    });
    results.into_iter().map(|r| r.expect("every order is flown or refused")).collect()
}

/// Orders made ready at a time: bounds the memory that their inputs take. Flights of equal structure find each other within it.
const WINDOW: usize = 128;

fn flown(
    orders: &[Order<'_>],
    steps_per_sample: u32,
    keep: Keep,
    mut see: impl FnMut(usize, Result<(&mut Series, End), SimError>),
) {
    let mut spare = Vec::new();
    for (k, window) in orders.chunks(WINDOW).enumerate() {
        flown_window(window, steps_per_sample, keep, &mut spare, |index, flown| see(k * WINDOW + index, flown));
    }
}

fn flown_window(
    orders: &[Order<'_>],
    steps_per_sample: u32,
    keep: Keep,
    spare: &mut Vec<Series>,
    mut see: impl FnMut(usize, Result<(&mut Series, End), SimError>),
) {
    for (kin, group) in groups(orders, steps_per_sample, |index, error| see(index, Err(error))) {
        let rate_hz = f64::from_bits(kin.rate_bits);
        let grid = Grid { samples: kin.samples, rate_hz, steps_per_sample: steps_per_sample as usize };
        let mut rest = &group[..];
        while !rest.is_empty() {
            let tracks = Arch::new().dispatch(Side { kin: &kin, ready: rest, orders, grid, keep, spare });
            let used = tracks.len();
            for (ready, mut track) in rest.iter().zip(tracks) {
                let end = track.end.take().expect("a flown track has ended");
                see(ready.index, end.map(|end| (&mut track.series, end)));
                spare.push(track.series);
            }
            rest = &rest[used..];
        }
    }
}

/// Orders by kinship, in the order of their first member.
fn groups<'a>(
    orders: &'a [Order<'a>],
    steps_per_sample: u32,
    mut refuse: impl FnMut(usize, SimError),
) -> Vec<(Kin, Vec<Ready<'a>>)> {
    let mut groups: Vec<(Kin, Vec<Ready<'a>>)> = Vec::new();
    let mut places: HashMap<Kin, usize> = HashMap::new();
    for (index, order) in orders.iter().enumerate() {
        match ready(order, index, steps_per_sample) {
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

fn ready<'a>(order: &Order<'a>, index: usize, steps_per_sample: u32) -> Result<(Kin, Ready<'a>), SimError> {
    let setup = Setup::without_history(order.plant, order.flight, order.seed)?;
    within(order.flight)?;
    if steps_per_sample == 0 {
        return Err(SimError::Setup { what: "steps_per_sample", value: 0.0, allowed: "at least 1" });
    }
    let step_s = 1.0 / (order.flight.rate_hz * f64::from(steps_per_sample));
    if step_s > setup.step_max_s {
        let allowed = "short enough not to jump over gusts, contacts or the operator's hand; try more steps_per_sample";
        return Err(SimError::Setup { what: "step of the batch, s", value: step_s, allowed });
    }
    let terms = Terms::new(&order.plant.aero).ok_or(SimError::NotInBatch { what: "an aerodynamic structure of this many different terms" })?;
    if terms.layout.force_needs_rates() {
        return Err(SimError::NotInBatch { what: "a force that depends on the rate of a wind angle" });
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
    };
    Ok((kin, Ready { setup, terms, index }))
}

fn parts(setup: &Setup<'_>) -> Parts {
    let plant = setup.plant;
    Parts {
        tether: plant.tether.is_some(),
        line_rate: plant.tether.as_ref().is_some_and(|t| t.line_rate_n_s_m != 0.0),
        flow: plant.flow != windfall_model::MeanFlow::default(),
        apparent: setup.apparent,
        offset: plant.vehicle.p_origin_cm != windfall_model::frames::Vec3::zero(),
        products: [plant.vehicle.inertia.xy, plant.vehicle.inertia.xz, plant.vehicle.inertia.yz] != [0.0; 3],
        channels: Channels {
            gusts: !setup.gusts.is_empty(),
            noise: !setup.coefficient_noise.is_empty(),
            contacts: !plant.contacts.is_empty(),
        },
    }
}

/// As many flights of a group as there are lanes.
struct Side<'a, 'g> {
    kin: &'g Kin,
    ready: &'g [Ready<'a>],
    orders: &'a [Order<'a>],
    grid: Grid,
    keep: Keep,
    spare: &'g mut Vec<Series>,
}

impl<'a> WithSimd for Side<'a, '_> {
    type Output = Vec<Track<'a>>;
    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let used = self.ready.len().min(S::F64_LANES);
        let fresh = |r: &Ready<'a>| Track::new(&self.orders[r.index], self.keep, self.spare.pop().unwrap_or_default());
        let mut tracks: Vec<Track<'a>> = self.ready[..used].iter().map(fresh).collect();
        // Lanes to spare fly the last flight again; nobody looks.
        let ready: Vec<&Ready<'a>> = (0..S::F64_LANES).map(|k| &self.ready[k.min(used - 1)]).collect();
        let (kin, orders, grid) = (self.kin, self.orders, self.grid);
        let mut sink = Tracks::new(simd, &mut tracks, self.keep);
        if kin.held {
            fly::<S, HELD, 16>(simd, kin, orders, grid, &ready, &mut sink);
        } else {
            fly::<S, PLAIN, 14>(simd, kin, orders, grid, &ready, &mut sink);
        }
        tracks
    }
}

/// `N` states on lanes, `M` in a single flight, which carries time as one more.
#[inline(always)]
fn fly<S: Simd, const N: usize, const M: usize>(
    simd: S,
    kin: &Kin,
    orders: &[Order<'_>],
    grid: Grid,
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
    rk4::fly(simd, &kernel, &mut inputs, grid, y, sink);
}
