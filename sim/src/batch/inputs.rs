//! sim: what depends on time alone, tabulated for lanes. In: setups. Out: rows of numbers at the instants of a step.
//!
//! A row holds channels, a channel one number a lane: V_W and V̇_W (or the operator's unsteadiness), then gusts and their rates,
//! random increments of the coefficients, and contacts, each only when a group has it. The values are those of the same
//! functions that a single flight calls.

use crate::setup::Setup;
use crate::smooth::Stream;
use windfall_model::{Flight, TunnelSpeed};

/// A flight's inputs in time: its setup and its tunnel speed, which is read along the way.
pub(super) struct Inputs<'a> {
    setup: &'a Setup<'a>,
    flight: &'a Flight,
    speed: Stream<'a>,
}

impl<'a> Inputs<'a> {
    pub(super) fn new(setup: &'a Setup<'a>, flight: &'a Flight) -> Self {
        let speed = match &flight.speed {
            TunnelSpeed::History { interval_s, vw_m_s } => Stream::new(*interval_s, vw_m_s),
            TunnelSpeed::Constant(vw_m_s) => Stream::new(1.0, std::slice::from_ref(vw_m_s)),
            TunnelSpeed::Operator(_) => Stream::new(1.0, &[]),
        };
        Self { setup, flight, speed }
    }
    /// True when both have the same given tunnel speed, as the draws of a study often do.
    pub(super) fn same_speed(&self, other: &Self) -> bool {
        self.setup.hand.is_none() && other.setup.hand.is_none() && self.flight.speed == other.flight.speed
    }
}

/// Which channels a group has beyond the first two.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct Channels {
    pub(super) gusts: bool,
    pub(super) noise: bool,
    pub(super) contacts: bool,
}

impl Channels {
    /// First of the six gust channels: velocity and rate, tunnel axes.
    #[inline(always)]
    pub(super) fn gusts(self) -> Option<usize> {
        if self.gusts { Some(2) } else { None }
    }
    /// First of the six coefficients' channels.
    #[inline(always)]
    pub(super) fn noise(self) -> Option<usize> {
        if self.noise { Some(2 + 6 * self.gusts as usize) } else { None }
    }
    /// First of the six contact channels: force and moment, body axes.
    #[inline(always)]
    pub(super) fn contacts(self) -> Option<usize> {
        if self.contacts { Some(2 + 6 * (self.gusts as usize + self.noise as usize)) } else { None }
    }
    /// Number of channels.
    #[inline(always)]
    pub(super) fn count(self) -> usize {
        2 + 6 * (self.gusts as usize + self.noise as usize + self.contacts as usize)
    }

    /// Writes tunnel speed and rate, or the operator's unsteadiness, at `t_s` into one lane of a row.
    #[inline]
    pub(super) fn fill_speed(inputs: &mut Inputs<'_>, t_s: f64, lane: usize, lanes: usize, row: &mut [f64]) {
        let (value, rate) = match &inputs.setup.hand {
            None => inputs.speed.at(t_s),
            Some(hand) => (hand.unsteady.as_ref().map_or(0.0, |s| s.at(t_s).0), 0.0),
        };
        row[lane] = value;
        row[lanes + lane] = rate;
    }
    /// Writes the other channels at `t_s` into one lane of a row.
    #[inline]
    pub(super) fn fill_rest(self, inputs: &Inputs<'_>, t_s: f64, lane: usize, lanes: usize, row: &mut [f64]) {
        let setup = inputs.setup;
        let mut put = |k: usize, x: f64| row[k * lanes + lane] = x;
        if let Some(first) = self.gusts() {
            (first..first + 6).for_each(|k| put(k, 0.0));
            for (axis, gust) in &setup.gusts {
                let (value, rate) = gust.at(t_s);
                put(first + axis, value);
                put(first + 3 + axis, rate);
            }
        }
        if let Some(first) = self.noise() {
            (first..first + 6).for_each(|k| put(k, 0.0));
            for (index, noise) in &setup.coefficient_noise {
                put(first + index, noise.at(t_s).0);
            }
        }
        if let Some(first) = self.contacts() {
            let mut total = windfall_model::Wrench::default();
            for contact in &setup.plant.contacts {
                total += contact.wrench(t_s);
            }
            for k in 0..3 {
                put(first + k, total.f.xyz[k]);
                put(first + 3 + k, total.m.xyz[k]);
            }
        }
    }
}
