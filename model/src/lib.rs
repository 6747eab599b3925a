//! What simulator and identifier of Windfall must agree on: frames, vehicle, aerodynamic terms, tether, flow, sensors, the
//! effect catalogue and the run record. No files, time stepping, chance or printing here.
//!
//! Units are SI throughout, angles in radians; a name says when it is otherwise.

mod acts;
mod aero;
mod aero_program;
mod air;
mod bandwidth;
mod campaign;
mod channel;
mod disturbance;
pub mod effects;
mod flow;
pub mod frames;
mod free_body;
mod free_flight;
mod froude;
mod knowledge;
pub mod planet;
mod plant;
mod point;
mod quantity;
mod record;
mod run_use;
mod scenario;
mod sensors;
pub mod study;
mod tether;
mod unknowns;
mod vehicle;
mod wind_tunnel;

pub use aero::{Aero, Coefficient, Contribution, Factor, Structure, Term, Wrench, wrench_at_cm};
pub use aero_program::AeroProgram;
pub use air::{Environment, air_viscosity_pa_s, dynamic_pressure_pa};
pub use bandwidth::{Bandwidth, ChannelGroup, ExportCause};
pub use campaign::{Campaign, Data, Run};
pub use channel::{CHANNEL_NAMES, CHANNELS, POSE, PerChannel, RunChannel};
pub use disturbance::{
    DRIFT_TIME_S, Disturbance, Drift, Entry, RunNumber, RunScatter, Shape, ShapingFilter, StateForm, Turbulence, WakeShedding,
};
pub use effects::{Acts, CATALOGUE, Effect, Net, Parameter, Role};
pub use flow::{FlowState, MeanFlow, VARIABLES, Variable, Wind};
pub use free_body::{FreeBody, FreeState};
pub use free_flight::{FreeFlight, MovedPart, Setting, Thrust};
pub use froude::FroudeScale;
pub use knowledge::{Constant, Knowledge};
pub use plant::{AirState, Contact, Motion, Plant, trim_speed};
pub use point::{CoefficientTable, Pivot, PointAir, PointMass};
pub use quantity::{Dimension, Given, PLANT_NUMBERS, PlantNumber};
pub use record::{Measured, PointRecord, Record, Recording, WindRows};
pub use run_use::Use;
pub use scenario::{Flight, Integrator, Numerics, Operator, Release, Scenario, TestSection, TunnelSpeed};
pub use sensors::Sensors;
pub use tether::{Line, Tether};
pub use unknowns::{Freedom, Transform, Unknown, UnknownId, Unknowns};
pub use vehicle::{ApparentMass, Inertia, LooseMass, Vehicle};
pub use wind_tunnel::{StaticPoint, StaticPoints};
