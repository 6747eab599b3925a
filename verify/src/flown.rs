//! verify: flights that checks are made on. In: a plant, a scenario's flight. Out: the same without walls, roll, chance; what happens.

use crate::VerifyError;
use windfall_model::{Flight, Integrator, Numerics, Plant, Release, TunnelSpeed};
use windfall_sim::{Seed, Truth, fly_truth};

/// At the tunnel's origin, at rest, upright.
pub(super) const REST: Release =
    Release { position_m: [0.0; 3], velocity_m_s: [0.0; 3], attitude_rad: [0.0; 3], rates_rad_s: [0.0; 3] };

/// Integration tight enough that round-off is what is left.
const TIGHT: Numerics = Numerics { method: Integrator::Dop853, relative_tolerance: 1e-13, absolute_tolerance: 1e-15 };

/// A scenario's flight, changed to constant tunnel speed, tight tolerances and no walls.
pub(super) fn flight(like: &Flight, duration_s: f64, vw_m_s: f64, release: Release) -> Flight {
    let speed = TunnelSpeed::Constant(vw_m_s);
    Flight { duration_s, release, speed, section: None, numerics: TIGHT, sensor_noise: false, ..like.clone() }
}

/// What happens, with nothing left to chance.
pub(super) fn truth(plant: &Plant, flight: &Flight) -> Result<Truth, VerifyError> {
    Ok(fly_truth(plant, flight, Seed::default())?.0)
}

pub(super) fn density(plant: &Plant, flight: &Flight) -> f64 {
    plant.environment.density_kg_m3(flight.ps_pa, flight.ts_k)
}

/// The lander without roll, so that pitch stays pitch.
pub(super) fn without_roll(plant: &Plant) -> Plant {
    let mut p = plant.clone();
    if let Some(i) = p.aero.structure.index("Cl_0") {
        p.aero.values[i] = 0.0;
    }
    p
}

pub(super) fn largest(errors: impl Iterator<Item = f64>) -> f64 {
    errors.map(f64::abs).fold(0.0, |a, b| if b.is_nan() { f64::NAN } else { a.max(b) })
}
