//! sim: motion of a body without attitude, free or on a pivot. In: launch and times. Out: states at those times.

use crate::error::SimError;
use nalgebra::Vector6;
use ode_solvers::dop_shared::{IntegrationError, OutputType};
use ode_solvers::{Dop853, System};
use windfall_model::Plant;
use windfall_model::frames::Vec3;

/// Tolerances: a metre-sized flight to 1e-10 of its size, finer than any camera by six orders.
const RELATIVE: f64 = 1e-11;
const ABSOLUTE: f64 = 1e-13;

/// Where a body without attitude is and how it moves: along tunnel axes, or about a pivot with the angle in the first place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointState {
    /// Position, m; of a body on a pivot the angle from hanging down, rad.
    pub position: [f64; 3],
    /// Its rate, per s.
    pub velocity: [f64; 3],
    /// The rate of that, per s².
    pub acceleration: [f64; 3],
}

struct Point<'a> {
    plant: &'a Plant,
}

impl Point<'_> {
    fn acceleration(&self, y: &Vector6<f64>) -> [f64; 3] {
        if self.plant.point.pivot.is_some() {
            return [self.plant.pivot_acceleration_rad_s2(y[0], y[3]), 0.0, 0.0];
        }
        let air = self.plant.point.air(-y[0]);
        self.plant.point_acceleration_in(Vec3::new(y[3], y[4], y[5]), air).to_array()
    }
}

impl System<f64, Vector6<f64>> for Point<'_> {
    fn system(&self, _t: f64, y: &Vector6<f64>, dy: &mut Vector6<f64>) {
        let [ax, ay, az] = self.acceleration(y);
        *dy = Vector6::new(y[3], y[4], y[5], ax, ay, az);
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
    let mut own = plant.clone();
    own.point.air_density_kg_m3 = density_kg_m3;
    let states = fly_point_states(&own, times_s, &[], position_m, velocity_m_s)?;
    Ok(states.into_iter().map(|s| s.position).collect())
}

/// States of a body without attitude at `times_s` (s, increasing, uneven allowed), from a position (m) and velocity (m/s) at the first of
/// them, or from an angle (rad) and rate (rad/s) in their first places for a body on a pivot. `recorded`: run inputs that change, by
/// their place among the inputs, a value for each time; between two times their mean acts.
///
/// # Errors
/// Times that do not increase, numbers that are not finite, an integrator that gave up.
pub fn fly_point_states(
    plant: &Plant,
    times_s: &[f64],
    recorded: &[(usize, Vec<f64>)],
    position: [f64; 3],
    velocity: [f64; 3],
) -> Result<Vec<PointState>, SimError> {
    let mut own = plant.clone();
    let ([x, y, z], [vx, vy, vz]) = (position, velocity);
    let mut state = Vector6::new(x, y, z, vx, vy, vz);
    let mut before = times_s.first().copied().unwrap_or(0.0);
    let mut out = Vec::with_capacity(times_s.len());
    for (i, &t_s) in times_s.iter().enumerate() {
        let step_s = t_s - before;
        if !(step_s >= 0.0 && step_s.is_finite()) {
            return Err(SimError::Setup { what: "step to the next sample time, s", value: step_s, allowed: "zero or more" });
        }
        if step_s > 0.0 {
            set_inputs(&mut own, recorded, |u| 0.5 * (u[i - 1] + u[i]));
            let a = Point { plant: &own }.acceleration(&state);
            if !a.iter().all(|x| x.is_finite()) {
                return Err(SimError::NotFinite { what: "acceleration of the point mass", t_s: before });
            }
            let rate_per_s = norm(a) / norm([state[3], state[4], state[5]]);
            state = advance(Point { plant: &own }, state, step_s).map_err(|e| explain(&e, before, rate_per_s))?;
        }
        if !state.sum().is_finite() {
            return Err(SimError::NotFinite { what: "state of the point mass", t_s });
        }
        before = t_s;
        set_inputs(&mut own, recorded, |u| u[i]);
        out.push(PointState {
            position: [state[0], state[1], state[2]],
            velocity: [state[3], state[4], state[5]],
            acceleration: Point { plant: &own }.acceleration(&state),
        });
    }
    Ok(out)
}

fn set_inputs(plant: &mut Plant, recorded: &[(usize, Vec<f64>)], value: impl Fn(&[f64]) -> f64) {
    for (place, series) in recorded {
        if let Some(u) = plant.point.inputs.get_mut(*place) {
            *u = value(series);
        }
    }
}

fn norm(v: [f64; 3]) -> f64 {
    v[0].hypot(v[1]).hypot(v[2])
}

/// One sample interval; the right-hand side does not depend on time, so each starts afresh at t = 0.
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
    use windfall_model::planet::Atmosphere;
    use windfall_model::{
        Aero, CoefficientTable, Environment, Inertia, MeanFlow, Pivot, PointMass, Sensors, Structure, Turbulence, Vehicle,
        WakeShedding,
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
            drift: Default::default(),
            scatter: Default::default(),
            contacts: Vec::new(),
            environment: Environment { gravity_m_s2: 9.8, gas_constant_j_kg_k: 287.0 },
            sensors: Sensors::default(),
            point: PointMass::default(),
            free_flight: None,
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

    fn swing(viscous_n_m_s: f64, dry_n_m: f64) -> Plant {
        let mut arm = ball(0.0);
        arm.point.pivot = Some(Pivot { arm_m: 0.2, inertia_kg_m2: 5e-4, viscous_n_m_s, dry_n_m });
        arm
    }

    /// Small swings: `θ₀ cos ω t` with a viscous decrement `k/2J` (to first order in it), and dry friction that takes `2T/(m g a)` off the
    /// amplitude in every half period. Bounds: the sine's cubic term, `θ₀²/16` of the frequency, over the time; the rate at which
    /// friction gives way over the largest rate.
    #[test]
    fn exact_small_swings_with_viscous_and_dry_friction() {
        let (m, g, a): (f64, f64, f64) = (0.1, 9.8, 0.2);
        let inertia = 5e-4 + m * a * a;
        let rate = (m * g * a / inertia).sqrt();
        let half_s = std::f64::consts::PI / rate;
        let times: Vec<f64> = (0..=8).map(|i| 0.5 * half_s * f64::from(i)).collect();
        let at = |plant: &Plant| -> Vec<f64> {
            let flown = fly_point_states(plant, &times, &[], [1e-3, 0.0, 0.0], [0.0; 3]).expect("swings");
            flown.iter().map(|s| s.position[0]).collect()
        };
        let free = at(&swing(0.0, 0.0));
        for (i, x) in free.iter().enumerate() {
            assert!((x - 1e-3 * (0.5 * std::f64::consts::PI * i as f64).cos()).abs() < 1e-9, "{i}: {x}");
        }
        let k = 1e-4;
        let damped = at(&swing(k, 0.0));
        assert!((damped[8] / 1e-3 - (-k * 4.0 * half_s / (2.0 * inertia)).exp()).abs() < 1e-4, "{damped:?}");
        let torque = 1e-6;
        let dry = at(&swing(0.0, torque));
        let lost = 2.0 * torque / (m * g * a);
        // The rate is below the one at which friction gives way for 2/π · 1e-3 / 7e-3 of every half swing.
        assert!(((1e-3 - dry[8]) / (4.0 * lost) - 1.0).abs() < 0.2, "{dry:?} {lost}");
    }

    /// A pendulum of a hundredth of a millimetre swings a thousand radians a second: an interval of a quarter of an hour is given up, with
    /// how fast the rate changed by itself where it began, `(g/a) sin θ/θ̇`.
    #[test]
    fn law_a_pendulum_too_fast_to_follow_is_given_up() {
        let mut fast = ball(0.0);
        fast.point.pivot = Some(Pivot { arm_m: 1e-5, inertia_kg_m2: 0.0, viscous_n_m_s: 0.0, dry_n_m: 0.0 });
        let e = fly_point_states(&fast, &[0.0, 900.0], &[], [0.3, 0.0, 0.0], [4.0, 0.0, 0.0]).expect_err("too fast");
        let per_s = 9.8 / 1e-5 * 0.3_f64.sin() / 4.0;
        let SimError::TooManySteps { what: "velocity", t_s, rate_per_s, .. } = e else { panic!("{e:?}") };
        assert!(t_s.abs() < 1e-12 && (rate_per_s / per_s - 1.0).abs() < 1e-9, "{t_s} {rate_per_s} {per_s}");
    }

    /// In air that thins, with drag over Mach number: the acceleration that is reported is that of the state, and a body that rises fast
    /// slows less high up. An input that is recorded acts between two times by its mean.
    #[test]
    fn law_recorded_inputs_and_thin_air_act() {
        let mut rocket = ball(1.0);
        rocket.point.air_density_kg_m3 = 1.2;
        rocket.point.drag_over_mach = CoefficientTable::new(vec![0.0, 1.0], vec![0.4, 0.8]);
        rocket.point.atmosphere = Some(Atmosphere::Us1976);
        rocket.point.launch_height_m = 100.0;
        rocket.point.drag_per_input = vec![0.5];
        rocket.point.inputs = vec![0.0];
        let times = [0.0, 0.1, 0.2];
        let up = [-170.0, 0.0, 0.0];
        let brake = |u: Vec<f64>| fly_point_states(&rocket, &times, &[(0, u)], [0.0; 3], up).expect("flies");
        let (shut, open) = (brake(vec![0.0; 3]), brake(vec![0.0, 1.0, 1.0]));
        // 0.4 + 0.4 M of the table at M = 170/340.
        let cd = 0.4 + 0.4 * 170.0 / rocket.point.air(0.0).sound_m_s;
        let drag = 0.5 * 1.2 * cd * std::f64::consts::FRAC_PI_4 * 0.01 * 170.0 * 170.0 / 0.1;
        assert!((shut[0].acceleration[0] - (9.8 + drag)).abs() < 1e-9, "{:?}", shut[0]);
        assert!(open[2].velocity[0] > shut[2].velocity[0] + 1.0);
        // Tunnel X points down: three kilometres above the launch.
        let high =
            fly_point_states(&rocket, &[0.0], &[(0, vec![0.0])], [-3000.0, 0.0, 0.0], up).expect("flies")[0].acceleration[0];
        let air = rocket.point.air(3000.0);
        let drag =
            0.5 * air.density_kg_m3 * (0.4 + 0.4 * 170.0 / air.sound_m_s) * std::f64::consts::FRAC_PI_4 * 0.01 * 170.0 * 170.0
                / 0.1;
        assert!((high - 9.8 - drag).abs() < 1e-9 && air.density_kg_m3 < 0.9, "{high} {air:?}");
        let thin = rocket.point.air(5000.0);
        assert!((thin.density_kg_m3 / 1.2 - 0.5995).abs() < 0.003 && thin.sound_m_s < 322.0, "{thin:?}");
    }
}
