//! model: a rigid body in free flight through air at rest. In: mass, buoyancy, parts and thrusts that a run sets, rate damping. Out: its
//! accelerations.
//!
//! Equations of motion about the geometric origin, body axes, with m the mass, l = Σ m r its first and J its second moment there:
//! `m (v̇ + ω × v) + ω̇ × l + ω × (ω × l) = F` and `l × (v̇ + ω × v) + J ω̇ + ω × J ω = M` (Fossen, Handbook of Marine Craft
//! Hydrodynamics and Motion Control, 2011, §3.3). Left out: parts that move during a run, the air's own turning, walls.

use crate::aero_program::AeroProgram;
use crate::flow::FlowState;
use crate::frames::{Body, Rotation, Tunnel, Vec3};
use crate::plant::Plant;
use nalgebra::{Matrix3, Matrix6, Vector6};

/// Pose of the geometric origin and its rates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FreeState {
    /// Position, m, tunnel axes (X down).
    pub p_tunnel_origin: Vec3<Tunnel>,
    /// Attitude as a quaternion `[w, x, y, z]`, tunnel from body.
    pub attitude: [f64; 4],
    /// Velocity seen from the room, m/s, body axes.
    pub v_tunnel_origin: Vec3<Body>,
    /// Body rates, rad/s.
    pub w_tunnel_body: Vec3<Body>,
}

/// A body in one run, ready to be flown: what does not depend on its state is worked out once.
#[derive(Clone, Debug)]
pub struct FreeBody {
    program: AeroProgram,
    half_rho_area: f64,
    length_m: f64,
    wind_axes: bool,
    mass_kg: f64,
    first_kg_m: Vec3<Body>,
    second_kg_m2: Matrix3<f64>,
    inverse: Matrix6<f64>,
    apparent_kg: [f64; 3],
    /// Weight less buoyancy, N, and the first moment of that difference, N m: both along the vertical.
    net_n: f64,
    net_n_m: Vec3<Body>,
    thrust: [Vec3<Body>; 2],
    damping_n_m_s: [f64; 3],
    v_tunnel_air: Vec3<Tunnel>,
    push: Vec3<Tunnel>,
    turn: Vec3<Body>,
}

/// Speed below which the air does nothing, m/s: angles of the flow are not defined at rest.
const STILL_M_S: f64 = 1e-9;

/// `[a×]`, so that `[a×] b = a × b`.
fn cross_matrix(a: Vec3<Body>) -> Matrix3<f64> {
    a.xyz.cross_matrix()
}

/// Second moment of a point mass about the origin: `m (r² 1 − r rᵀ)`.
fn of_point(mass_kg: f64, r: Vec3<Body>) -> Matrix3<f64> {
    (Matrix3::identity() * r.dot(r) - r.xyz * r.xyz.transpose()) * mass_kg
}

impl FreeBody {
    /// The body as it is in a run whose inputs are in `plant.point.inputs`; `None` for a plant that is no rigid body in free flight, and
    /// for one whose mass matrix is singular or not a number.
    #[must_use]
    pub fn new(plant: &Plant) -> Option<Self> {
        let free = plant.free_flight.as_ref()?;
        let (v, inputs, g) = (&plant.vehicle, &plant.point.inputs, plant.environment.gravity_m_s2);
        let mut mass_kg = v.mass_kg;
        let mut first_kg_m = v.p_origin_cm * v.mass_kg;
        let mut second_kg_m2 = v.inertia.matrix() + of_point(v.mass_kg, v.p_origin_cm);
        for part in &free.parts {
            let r = free.part_place(part.place_m, inputs);
            mass_kg += part.mass_kg;
            first_kg_m += r * part.mass_kg;
            second_kg_m2 += of_point(part.mass_kg, r);
        }
        let mut all = Matrix6::zeros();
        let apparent = Matrix3::from_diagonal(&free.apparent_kg.into());
        all.fixed_view_mut::<3, 3>(0, 0).copy_from(&(Matrix3::identity() * mass_kg + apparent));
        all.fixed_view_mut::<3, 3>(0, 3).copy_from(&-cross_matrix(first_kg_m));
        all.fixed_view_mut::<3, 3>(3, 0).copy_from(&cross_matrix(first_kg_m));
        all.fixed_view_mut::<3, 3>(3, 3).copy_from(&second_kg_m2);
        let inverse = all.try_inverse().filter(|m| m.iter().all(|x| x.is_finite()))?;
        Some(Self {
            program: AeroProgram::new(&plant.aero),
            half_rho_area: 0.5 * plant.point.air_density_kg_m3 * free.area_m2,
            length_m: v.diameter_m,
            wind_axes: free.wind_axes,
            mass_kg,
            first_kg_m,
            second_kg_m2,
            inverse,
            apparent_kg: free.apparent_kg,
            net_n: (mass_kg - free.buoyancy_kg) * g,
            net_n_m: (first_kg_m - free.p_origin_buoyancy * free.buoyancy_kg) * g,
            thrust: free.thrust(inputs),
            damping_n_m_s: std::array::from_fn(|i| free.rate_damping_n_m_s[i] * (1.0 + free.damping_excess[i])),
            v_tunnel_air: free.v_tunnel_air,
            push: free.push,
            turn: free.turn,
        })
    }

    /// Mass with all parts, kg.
    #[must_use]
    pub fn mass_kg(&self) -> f64 {
        self.mass_kg
    }

    /// Force (N) and moment about the geometric origin (N m) of weight, buoyancy, thrust, air and pushes, body axes; without what the
    /// air's apparent mass does.
    #[must_use]
    pub fn wrench(&self, s: &FreeState) -> [Vec3<Body>; 2] {
        let r_body_tunnel = Rotation::<Tunnel, Body>::from_quaternion(s.attitude).inverse();
        let down = r_body_tunnel * Vec3::new(1.0, 0.0, 0.0);
        let u = s.v_tunnel_origin - r_body_tunnel * self.v_tunnel_air;
        let [air_f, air_m] = self.of_air(u, s.w_tunnel_body);
        let f = down * self.net_n + self.thrust[0] + air_f + (r_body_tunnel * self.push) * self.mass_kg;
        let turn: Vec3<Body> = (self.second_kg_m2 * self.turn.xyz).into();
        [f, self.net_n_m.cross(down) + self.thrust[1] + air_m + turn]
    }

    /// Force and moment of the air at a velocity through it, with the rate damping.
    fn of_air(&self, u: Vec3<Body>, w: Vec3<Body>) -> [Vec3<Body>; 2] {
        let speed = u.norm();
        let rates = w.to_array();
        let mut moment = Vec3::from_array(std::array::from_fn(|i| self.damping_n_m_s[i] * rates[i]));
        if speed < STILL_M_S {
            return [Vec3::zero(), moment];
        }
        let flow = FlowState::without_rates(u, w, self.length_m, self.program.needed());
        let mut c = [0.0; 6];
        self.program.early(&flow, &mut c);
        let q_area = self.half_rho_area * speed * speed;
        let force = Vec3::new(-c[0], c[1], -c[2]) * q_area;
        moment += Vec3::new(c[3], c[4], c[5]) * (q_area * self.length_m);
        if !self.wind_axes {
            return [force, moment];
        }
        let level = u.x().hypot(u.z());
        let (sin_beta, cos_beta) = (u.y() / speed, level / speed);
        let (sin_alpha, cos_alpha) = if level > 0.0 { (u.z() / level, u.x() / level) } else { (0.0, 1.0) };
        #[rustfmt::skip]
        let r_body_wind = Matrix3::new(
            cos_alpha * cos_beta, -cos_alpha * sin_beta, -sin_alpha,
            sin_beta,              cos_beta,              0.0,
            sin_alpha * cos_beta, -sin_alpha * sin_beta,  cos_alpha,
        );
        [(r_body_wind * force.xyz).into(), (r_body_wind * moment.xyz).into()]
    }

    /// Rates of the body components of velocity (m/s²) and of the body rates (rad/s²).
    #[must_use]
    pub fn accelerations(&self, s: &FreeState) -> [Vec3<Body>; 2] {
        let (v, w, l) = (s.v_tunnel_origin, s.w_tunnel_body, self.first_kg_m);
        let [mut f, mut m] = self.wrench(s);
        let inertia: Vec3<Body> = (self.second_kg_m2 * w.xyz).into();
        f = f - w.cross(v) * self.mass_kg - w.cross(w.cross(l));
        m = m - l.cross(w.cross(v)) - w.cross(inertia);
        if self.apparent_kg.iter().any(|m| m.abs() > 0.0) {
            let r_body_tunnel = Rotation::<Tunnel, Body>::from_quaternion(s.attitude).inverse();
            let air = r_body_tunnel * self.v_tunnel_air;
            let times = |x: Vec3<Body>| {
                let x = x.to_array();
                Vec3::<Body>::from_array(std::array::from_fn(|i| self.apparent_kg[i] * x[i]))
            };
            let impulse = times(v - air);
            f = f - times(w.cross(air)) - w.cross(impulse);
            m = m - (v - air).cross(impulse);
        }
        let out = self.inverse * Vector6::new(f.x(), f.y(), f.z(), m.x(), m.y(), m.z());
        [Vec3::new(out[0], out[1], out[2]), Vec3::new(out[3], out[4], out[5])]
    }
}
