//! verify: what a change of measured pose does to the residual of a run. In: a run and a plant. Out: a map per frequency.

use super::super::evidence::Cov;
use super::loads::{Unit, load_coefficients, motion, still};
use super::prepare::Prepared;
use super::spectrum::Spectrum;
use nalgebra::{Complex, Matrix6, SMatrix, SVector};
use windfall_model::frames::{Body, Rotation, Vec3};
use windfall_model::{AirState, Motion, Plant, Wrench};
use windfall_pid::states::State;

/// Map from a small change of measured pose (position along and rotation about body axes) to the residual, averaged along a
/// run: by the pose itself, its rate and its second derivative.
pub(super) struct LoopMap {
    orders: [Matrix6<f64>; 3],
}

/// States of a run that the map is averaged over.
const LOOP_STATES: usize = 40;

impl LoopMap {
    pub(super) fn new(run: &Prepared, plant: &Plant, declared: &Plant) -> Option<Self> {
        let own = plant.for_run(run.index, &run.inputs);
        let unit = Unit::new(&own, declared);
        let mut orders = [Matrix6::<f64>::zeros(); 3];
        let stride = (run.states.len() / LOOP_STATES).max(1);
        let some: Vec<(&State, &f64)> = run.states.iter().zip(&run.q_declared_pa).step_by(stride).collect();
        let scale = (1.0 + declared.sensors.wind_scale) / (1.0 + own.sensors.wind_scale);
        for (s, q) in &some {
            let air = AirState { vw_m_s: s.vw * scale, vw_rate_m_s2: s.vw_rate * scale, ..still(s) };
            let balance = |order: usize, column: usize, h: f64| {
                let e = balance(&moved_by(&motion(s), own.vehicle.p_origin_cm, order, column, h), &air, &own, **q);
                SVector::<f64, 6>::from(unit.convert(e, 1.0))
            };
            for (order, m) in orders.iter_mut().enumerate() {
                for column in 0..6 {
                    let h = 1e-3;
                    let d = (balance(order, column, h) - balance(order, column, -h)) / (2.0 * h * some.len() as f64);
                    m.column_mut(column).zip_apply(&d, |a, b| *a += b);
                }
            }
        }
        orders.iter().all(|m| m.iter().all(|x| x.is_finite())).then_some(Self { orders })
    }
    pub(super) fn at(&self, omega: f64) -> Spectrum {
        let real = self.orders[0] - self.orders[2] * (omega * omega);
        real.zip_map(&(self.orders[1] * omega), Complex::new)
    }
}

/// A motion whose origin's pose (order 0), its rate (1) or second derivative (2) is changed by `h` along (columns 0-2) or about
/// (3-5) a body axis.
fn moved_by(m: &Motion, r_cm: Vec3<Body>, order: usize, column: usize, h: f64) -> Motion {
    let mut axis = [0.0; 3];
    axis[column % 3] = h;
    let (axis, r) = (Vec3::<Body>::from_array(axis), m.r_tunnel_body);
    // A rotation moves the c.m. about the origin.
    let shift = if column < 3 { r * axis } else { r * axis.cross(r_cm) };
    let mut n = *m;
    match order {
        0 => {
            n.p_tunnel_cm += shift;
            if column >= 3 {
                let q = axis.to_array().map(|x| 0.5 * x);
                n.r_tunnel_body = r * Rotation::from_quaternion([1.0, q[0], q[1], q[2]]);
            }
        }
        1 => {
            n.v_tunnel_cm += shift;
            if column >= 3 {
                n.w_tunnel_body += axis;
            }
        }
        _ => {
            n.a_tunnel_cm += shift;
            if column >= 3 {
                n.w_tunnel_body_rate += axis;
            }
        }
    }
    n
}

/// Load that a motion needs beyond what a plant gives, as coefficients at the declared dynamic pressure.
fn balance(m: &Motion, air: &AirState, plant: &Plant, q_pa: f64) -> [f64; 6] {
    let v = &plant.vehicle;
    let i = v.inertia.matrix();
    let (w, wd) = (m.w_tunnel_body.xyz, m.w_tunnel_body_rate.xyz);
    let g = Vec3::new(plant.environment.gravity_m_s2, 0.0, 0.0);
    let given = plant.wrench(m, air);
    let f = m.r_tunnel_body.inverse() * (m.a_tunnel_cm - g) * v.mass_kg - given.f;
    let moment = Vec3::from(i * wd + w.cross(&(i * w))) - given.m;
    load_coefficients(&Wrench { f, m: moment }, q_pa, plant).into()
}

/// Complex covariance of a bin from its real form.
pub(super) fn circular(m: &Cov) -> Spectrum {
    SMatrix::from_fn(|i, k| Complex::new(m[(i, k)] + m[(6 + i, 6 + k)], m[(6 + i, k)] - m[(i, 6 + k)]))
}
