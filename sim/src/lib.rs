//! sim: equations of motion, integrators, operator, chance and instruments. In: a `Plant` and a `Flight` of the model room and
//! a seed. Out: [`Truth`] (what happened) and a `Record` (what the instruments said), apart. No files, no estimating.
//!
//! State: c.m. position and velocity in tunnel axes, attitude as a quaternion, body rates; integrated by `ode_solvers` with
//! time carried as one more state, since its eighth-order method is wrong for right-hand sides that depend on time.

mod batch;
mod descent;
mod dynamics;
mod error;
mod fly;
mod free_flight;
mod integrate;
mod noise;
mod operator;
mod planet;
mod point;
mod record;
mod seed;
mod setup;
mod smooth;
mod state;
mod truth;

pub use batch::{Order, States, Stepping, fly_batch, fly_truth_batch, for_each_flown, for_each_states, for_each_truth};
pub use descent::{Descent, DescentFlown, DescentState, LAST_M, TouchDown};
pub use error::SimError;
pub use fly::{fly, fly_truth};
pub use free_flight::{FreeFlown, fly_free, record_free};
pub use noise::realise;
pub use planet::{PlanetEnd, PlanetFlown, PlanetTruth, fly_planet};
pub use point::{PointState, fly_point, fly_point_states};
pub use record::record;
pub use seed::{Channel, Seed};
pub use smooth::Smooth;
pub use truth::{End, Flown, Truth};
pub use windfall_model::trim_speed;
