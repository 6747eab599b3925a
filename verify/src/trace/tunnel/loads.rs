//! verify: loads of tunnel runs as coefficients. In: plants and states. Out: residuals of every plant in one unit, motion and
//! still air of a state, a load at the origin.

use nalgebra::{Matrix3, SVector, Vector3};
use windfall_model::frames::{EulerXyz, Vec3};
use windfall_model::{AirState, Motion, Plant, Wrench};
use windfall_pid::states::State;

/// Residuals of every plant in one unit: that of the acceleration they miss, as a load on the declared vehicle at the declared
/// dynamic pressure. Without it a plant could shrink its residual by claiming less inertia or more pressure.
pub(super) struct Unit {
    force: Vector3<f64>,
    moment: Matrix3<f64>,
}

impl Unit {
    pub(super) fn new(plant: &Plant, declared: &Plant) -> Self {
        let mass = |p: &Plant| {
            let (m, a) = (p.vehicle.mass_kg, &p.vehicle.apparent);
            Vector3::new(m + a.axial_kg, m + a.radial_kg, m + a.radial_kg)
        };
        let inertia = |p: &Plant| {
            let i = p.vehicle.apparent.transverse_kg_m2;
            p.vehicle.inertia.matrix() + Matrix3::from_diagonal(&Vector3::new(0.0, i, i))
        };
        let back = inertia(plant).try_inverse().unwrap_or_else(Matrix3::zeros);
        Self { force: mass(declared).component_div(&mass(plant)), moment: inertia(declared) * back }
    }
    pub(super) fn convert(&self, e: [f64; 6], q_ratio: f64) -> [f64; 6] {
        let f = self.force.component_mul(&Vector3::new(e[0], e[1], e[2])) * q_ratio;
        let m = self.moment * Vector3::new(e[3], e[4], e[5]) * q_ratio;
        [f.x, f.y, f.z, m.x, m.y, m.z]
    }
}

/// The part of a plant that its rows depend on.
pub(super) fn without_aero(plant: &Plant) -> Plant {
    let mut bare = plant.clone();
    bare.aero.values.clear();
    bare.aero.extra.clear();
    bare.contacts.clear();
    bare.turbulence = windfall_model::Turbulence::default();
    bare.shedding = windfall_model::WakeShedding::default();
    bare
}

/// A state as the motion that forces are made of.
pub(super) fn motion(s: &State) -> Motion {
    let [rx_rad, ry_rad, rz_rad] = s.euler_rad;
    let r = EulerXyz { rx_rad, ry_rad, rz_rad }.r_tunnel_body();
    let (u, w) = (Vec3::from_array(s.uvw), Vec3::from_array(s.pqr));
    Motion {
        t_s: s.t_s,
        p_tunnel_cm: Vec3::from_array(s.p_tunnel_cm),
        v_tunnel_cm: r * u,
        r_tunnel_body: r,
        w_tunnel_body: w,
        a_tunnel_cm: r * (Vec3::from_array(s.uvw_rate) + w.cross(u)),
        w_tunnel_body_rate: Vec3::from_array(s.pqr_rate),
    }
}

/// The air of a state, without gusts.
pub(super) fn still(s: &State) -> AirState {
    AirState { vw_m_s: s.vw, vw_rate_m_s2: s.vw_rate, density_kg_m3: s.density, ..AirState::default() }
}

/// A force and moment at the c.m. as six coefficients at the origin.
pub(super) fn load_coefficients(w: &Wrench, q_pa: f64, plant: &Plant) -> SVector<f64, 6> {
    let qs = q_pa * plant.vehicle.area_m2();
    let m = w.m - w.f.cross(plant.vehicle.p_origin_cm);
    let (f, qsd) = (w.f, qs * plant.vehicle.diameter_m);
    SVector::<f64, 6>::new(-f.x() / qs, f.y() / qs, -f.z() / qs, m.x() / qsd, m.y() / qsd, m.z() / qsd)
}
