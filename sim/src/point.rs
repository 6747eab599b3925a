//! sim: flight of a body without attitude. In: launch and times. Out: positions at those times.

use crate::error::SimError;
use nalgebra::Vector6;
use ode_solvers::dop_shared::{IntegrationError, OutputType};
use ode_solvers::{Dop853, System};
use windfall_model::Plant;
use windfall_model::frames::Vec3;

/// Tolerances: a metre-sized flight to 1e-10 of its size, finer than any camera by six orders.
const RELATIVE: f64 = 1e-11;
const ABSOLUTE: f64 = 1e-13;

struct Point<'a> {
    plant: &'a Plant,
    density_kg_m3: f64,
}

impl System<f64, Vector6<f64>> for Point<'_> {
    fn system(&self, _t: f64, y: &Vector6<f64>, dy: &mut Vector6<f64>) {
        let v = Vec3::new(y[3], y[4], y[5]);
        let a = self.plant.point_acceleration(v, self.density_kg_m3);
        *dy = Vector6::new(y[3], y[4], y[5], a.x(), a.y(), a.z());
    }
}

/// Positions (m, tunnel axes) of a point mass at `times_s` (s, increasing, uneven allowed), launched at the first of them
/// from `position_m` with `velocity_m_s` in still air of the given density.
///
/// # Errors
/// Times that do not increase, numbers that are not finite, an integrator that gave up.
pub fn fly_point(
    plant: &Plant,
    density_kg_m3: f64,
    times_s: &[f64],
    position_m: [f64; 3],
    velocity_m_s: [f64; 3],
) -> Result<Vec<[f64; 3]>, SimError> {
    let ([x, y, z], [vx, vy, vz]) = (position_m, velocity_m_s);
    let mut state = Vector6::new(x, y, z, vx, vy, vz);
    let mut before = times_s.first().copied().unwrap_or(0.0);
    let mut out = Vec::with_capacity(times_s.len());
    for &t_s in times_s {
        let step_s = t_s - before;
        if !(step_s >= 0.0 && step_s.is_finite()) {
            return Err(SimError::Setup { what: "step to the next sample time, s", value: step_s, allowed: "zero or more" });
        }
        if step_s > 0.0 {
            let v = Vec3::new(state[3], state[4], state[5]);
            let a = plant.point_acceleration(v, density_kg_m3);
            if !a.is_finite() {
                return Err(SimError::NotFinite { what: "acceleration of the point mass", t_s: before });
            }
            let rate_per_s = a.norm() / v.norm();
            state = advance(Point { plant, density_kg_m3 }, state, step_s).map_err(|e| explain(&e, before, rate_per_s))?;
        }
        if !state.sum().is_finite() {
            return Err(SimError::NotFinite { what: "state of the point mass", t_s });
        }
        before = t_s;
        out.push([state[0], state[1], state[2]]);
    }
    Ok(out)
}

/// One sample interval; the right-hand side depends neither on time nor on place, so each starts afresh at t = 0.
fn advance(point: Point<'_>, state: Vector6<f64>, step_s: f64) -> Result<Vector6<f64>, IntegrationError> {
    let mut solver = Dop853::new(point, 0.0, step_s, step_s, state, RELATIVE, ABSOLUTE);
    solver.set_output(OutputType::Sparse);
    solver.integrate()?;
    Ok(solver.y_out().last().copied().unwrap_or(state))
}

/// `rate_per_s`: how fast the velocity changes by itself where the step began.
fn explain(e: &IntegrationError, t_s: f64, rate_per_s: f64) -> SimError {
    match e {
        IntegrationError::MaxNumStepReached { n_step, .. } => {
            SimError::TooManySteps { steps: *n_step, t_s, what: "velocity", rate_per_s }
        }
        _ => SimError::StepTooSmall { t_s },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use windfall_model::{
        Aero, Environment, Inertia, MeanFlow, PointMass, Sensors, Structure, Turbulence, Vehicle, WakeShedding,
    };

    fn ball(cd: f64) -> Plant {
        Plant {
            vehicle: Vehicle {
                mass_kg: 0.1,
                inertia: Inertia::default(),
                p_origin_cm: Vec3::zero(),
                diameter_m: 0.1,
                apparent: Default::default(),
                loose: None,
            },
            aero: Aero::new(Structure::point_mass(), vec![cd]),
            tether: None,
            flow: MeanFlow::default(),
            turbulence: Turbulence::default(),
            shedding: WakeShedding::default(),
            contacts: Vec::new(),
            environment: Environment { gravity_m_s2: 9.8, gas_constant_j_kg_k: 287.0 },
            sensors: Sensors::default(),
            point: PointMass::default(),
        }
    }

    /// Parabola, and fall with quadratic drag: `x = (V²/g) ln cosh(g t/V)`; at uneven times that do not start at zero.
    /// Bound: the integrator's tolerance of 1e-11 over a few intervals.
    #[test]
    fn exact_parabola_and_fall_with_quadratic_drag() {
        let times = [0.7, 0.75, 1.3, 1.31, 2.2];
        let thrown = fly_point(&ball(0.0), 1.2, &times, [1.0, 2.0, 3.0], [-3.0, 4.0, 0.5]).expect("flies");
        let falls = fly_point(&ball(0.5), 1.2, &times, [0.0; 3], [0.0; 3]).expect("flies");
        let terminal = (2.0 * 0.1 * 9.8 / (1.2 * 0.5 * std::f64::consts::FRAC_PI_4 * 0.01)).sqrt();
        for ((p, x), time) in thrown.iter().zip(&falls).zip(times) {
            let t = time - 0.7;
            let expected = [1.0 - 3.0 * t + 4.9 * t * t, 2.0 + 4.0 * t, 3.0 + 0.5 * t];
            let deep = terminal * terminal / 9.8 * (9.8 * t / terminal).cosh().ln();
            for (a, b) in p.iter().chain(x).zip(expected.iter().chain(&[deep, 0.0, 0.0])) {
                assert!((a - b).abs() < 1e-9, "{a} {b} at {t}");
            }
        }
    }
}
