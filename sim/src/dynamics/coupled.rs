//! sim: accelerations when forces depend on them. In: an instant. Out: accelerations that satisfy Newton and Euler exactly.
//!
//! The residual `(m (a − g) − f, I ω̇ + ω × I ω − m)` is affine in the six accelerations for apparent mass, a loose part and
//! terms linear in α̇: its value at zero and at six unit vectors gives the exact linear system. How it depends on them hardly changes along
//! a flight, so steps with the matrix of the flight's first instant come first (chord iteration: Kelley, Iterative Methods for Linear and
//! Nonlinear Equations, 1995, §5.4); where those do not converge quickly, or a term is not linear in α̇, further rounds have matrices of
//! their own. Always in the same order.

use super::{Instant, momentum_rate, specific_force};
use crate::setup::Setup;
use nalgebra::{Matrix6, Vector6};
use windfall_model::frames::{Body, Vec3};
use windfall_model::{AirState, Motion, Wrench};

/// Rounds at most with matrices of their own: one suffices for affine forces, one more checks.
const ROUNDS: usize = 8;
/// Steps at most with the first instant's matrix, and what each must leave of the residual to be worth the next.
const CHORDS: usize = 6;
const FALLS: f64 = 0.05;
/// Residual over its scale at which accelerations are as good as round-off lets them be.
const ROUND_OFF: f64 = 1e-14;

/// Acceleration of the c.m. (body axes), rate of body rates, acceleration of the loose part.
pub(crate) fn solve(setup: &Setup<'_>, i: &Instant, loose: [f64; 4]) -> (Vec3<Body>, Vec3<Body>, [f64; 2]) {
    let mut x = Vector6::zeros();
    let mut residual = residual(setup, i, loose, &x);
    let scale = residual.amax().max(setup.plant.vehicle.mass_kg * setup.plant.environment.gravity_m_s2.abs());
    let first =
        setup.coupling.get_or_init(|| jacobian(setup, i, loose, &x, &residual).try_inverse().unwrap_or_else(Matrix6::zeros));
    for _ in 0..CHORDS {
        if residual.amax() <= ROUND_OFF * scale {
            break;
        }
        let next = x - first * residual;
        let left = self::residual(setup, i, loose, &next);
        // Also where there is no such matrix, or a number is none.
        if left.amax() > FALLS * residual.amax() || left.iter().any(|v| v.is_nan()) {
            break;
        }
        (x, residual) = (next, left);
    }
    for _ in 0..ROUNDS {
        if residual.amax() <= ROUND_OFF * scale {
            break;
        }
        let Some(step) = jacobian(setup, i, loose, &x, &residual).lu().solve(&residual) else { break };
        x -= step;
        residual = self::residual(setup, i, loose, &x);
    }
    let (a, w_rate) = split(&x);
    let part = match &setup.plant.vehicle.loose {
        Some(part) => {
            let mount = specific_force(i, a, w_rate, Vec3::new(part.x_cm_m, 0.0, 0.0));
            part.acceleration(loose, mount, part.carried(loose, i.w, w_rate))
        }
        None => [0.0; 2],
    };
    (a, w_rate, part)
}

/// How the residual depends on the accelerations, by unit steps from `x`, where it is `at`.
fn jacobian(setup: &Setup<'_>, i: &Instant, loose: [f64; 4], x: &Vector6<f64>, at: &Vector6<f64>) -> Matrix6<f64> {
    let mut jacobian = Matrix6::zeros();
    for k in 0..6 {
        let mut shifted = *x;
        shifted[k] += 1.0;
        jacobian.set_column(k, &(residual(setup, i, loose, &shifted) - at));
    }
    jacobian
}

fn split(x: &Vector6<f64>) -> (Vec3<Body>, Vec3<Body>) {
    (Vec3::new(x[0], x[1], x[2]), Vec3::new(x[3], x[4], x[5]))
}

fn residual(setup: &Setup<'_>, i: &Instant, loose: [f64; 4], x: &Vector6<f64>) -> Vector6<f64> {
    let (a, w_rate) = split(x);
    let total = wrench(setup, i, loose, a, w_rate);
    let f = (a - i.g) * setup.plant.vehicle.mass_kg - total.f;
    let m = momentum_rate(setup, i.w, w_rate) - total.m.xyz;
    Vector6::new(f.x(), f.y(), f.z(), m.x, m.y, m.z)
}

/// All forces but gravity and their moment, at assumed accelerations.
fn wrench(setup: &Setup<'_>, i: &Instant, loose: [f64; 4], a: Vec3<Body>, w_rate: Vec3<Body>) -> Wrench {
    let mut total = i.other;
    if i.q_pa > 0.0 {
        let mut c = i.early;
        setup.late(i, a, &mut c);
        total += setup.aerodynamic(&c, i);
    }
    if setup.apparent {
        let (motion, air) = motion(setup, i, a, w_rate);
        total += setup.plant.apparent_wrench(&motion, &air);
    }
    if let Some(part) = &setup.plant.vehicle.loose {
        let mount = specific_force(i, a, w_rate, Vec3::new(part.x_cm_m, 0.0, 0.0));
        let carried = part.carried(loose, i.w, w_rate);
        total += part.wrench(loose, part.acceleration(loose, mount, carried), mount, carried);
    }
    total
}

/// The instant in the words of the model room; gusts, which apparent mass does not see, are left out.
fn motion(setup: &Setup<'_>, i: &Instant, a: Vec3<Body>, w_rate: Vec3<Body>) -> (Motion, AirState) {
    let motion = Motion {
        t_s: i.t_s,
        p_tunnel_cm: i.p,
        v_tunnel_cm: i.v,
        r_tunnel_body: i.r_tunnel_body,
        w_tunnel_body: i.w,
        a_tunnel_cm: i.r_tunnel_body * a,
        w_tunnel_body_rate: w_rate,
    };
    let air =
        AirState { vw_m_s: i.vw_m_s, vw_rate_m_s2: i.vw_rate_m_s2, density_kg_m3: setup.density_kg_m3, ..AirState::default() };
    (motion, air)
}
