//! model: numbers that differ from run to run. In: their standard deviations. Out: which numbers, and how each is changed.

use crate::disturbance::{Disturbance, Entry, Shape};
use crate::plant::Plant;

/// A number of the plant that each run may have its own value of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RunNumber {
    /// Mass, as a share of the declared one; inertia is as declared.
    Mass,
    /// Place of the tether's attachment along body axis 0 = x, 1 = y, 2 = z, m.
    Attachment(usize),
    /// Parameter of the aerodynamic structure by its place, as a share of its value.
    Aero(usize),
}

impl RunNumber {
    /// Changes the number by that much, in its unit.
    pub fn change(self, plant: &mut Plant, by: f64) {
        match self {
            Self::Mass => plant.vehicle.mass_kg *= 1.0 + by,
            Self::Attachment(axis) => {
                if let Some(tether) = &mut plant.tether {
                    tether.p_origin_hook.xyz[axis] += by;
                }
            }
            Self::Aero(place) => {
                if let Some(value) = plant.aero.values.get_mut(place) {
                    *value *= 1.0 + by;
                }
            }
        }
    }
}

/// Standard deviations from run to run. Zero in a declared model.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RunScatter {
    /// Of the mass, as a share of it.
    pub mass: f64,
    /// Of the tether's attachment across the body, along each of y and z, m.
    pub attachment_m: f64,
    /// Of one aerodynamic parameter, as a share of it.
    pub aero: f64,
    /// Place of that parameter in the structure, from 0.
    pub aero_place: f64,
}

impl RunScatter {
    /// The numbers that differ, each with its standard deviation; empty where all runs are alike.
    #[must_use]
    pub fn disturbances(&self) -> Vec<Disturbance> {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a place in a short list")]
        let place = self.aero_place.round().max(0.0) as usize;
        [
            (RunNumber::Mass, self.mass),
            (RunNumber::Attachment(1), self.attachment_m),
            (RunNumber::Attachment(2), self.attachment_m),
            (RunNumber::Aero(place), self.aero),
        ]
        .into_iter()
        .filter(|(_, std)| *std > 0.0)
        .map(|(number, rms)| Disturbance { entry: Entry::Number(number), rms, shape: Shape::Constant })
        .collect()
    }
}
