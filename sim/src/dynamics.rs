//! sim: the equations of motion. In: state, tunnel speed, gusts. Out: its rate. Nothing is allocated here.
//!
//! Newton and Euler in vectors: `v̇ = g + R f/m` in tunnel axes, `I ω̇ = m − ω × I ω` in body axes, `q̇ = ½ q ∘ ω`. Forces
//! come first; with them the acceleration, with it the wind-angle rates, with them the moments. Where forces themselves depend
//! on accelerations (apparent mass, a loose part, α̇ in a force) see [`coupled`]. The parts are always inlined: a call
//! would pass some hundred numbers through memory, which costs a fifth of a flight (measured in benches/dopri5.rs).

use crate::setup::Setup;
use crate::state::{BASE, TIME};
use nalgebra::{SVector, Vector3};
use windfall_model::frames::{Body, Rotation, Tunnel, Vec3};
use windfall_model::{FlowState, Wind, Wrench, dynamic_pressure_pa, wrench_at_cm};

mod coupled;

/// Airspeed squared, m²/s², below which aerodynamic forces are taken as zero: they are below 1e-19 N there, while angles and
/// nondimensional rates are undefined at zero.
const STILL_AIR_M2_S2: f64 = 1e-20;

/// What is known of one instant before the accelerations.
pub(crate) struct Instant {
    pub(crate) t_s: f64,
    pub(crate) p: Vec3<Tunnel>,
    pub(crate) v: Vec3<Tunnel>,
    pub(crate) r_tunnel_body: Rotation<Tunnel, Body>,
    pub(crate) w: Vec3<Body>,
    pub(crate) vw_m_s: f64,
    pub(crate) vw_rate_m_s2: f64,
    /// Acceleration of the air at the vehicle, gusts included, body axes.
    pub(crate) a_air: Vec3<Body>,
    pub(crate) v_air_cm: Vec3<Body>,
    pub(crate) flow: FlowState,
    pub(crate) q_pa: f64,
    /// Coefficients without the terms that need accelerations.
    pub(crate) early: [f64; 6],
    /// Tether and contacts.
    pub(crate) other: Wrench,
    /// Gravity, body axes, m/s².
    pub(crate) g: Vec3<Body>,
}

/// Place, attitude and air of one instant.
pub(crate) struct Sight {
    pub(crate) p: Vec3<Tunnel>,
    pub(crate) v: Vec3<Tunnel>,
    pub(crate) r_tunnel_body: Rotation<Tunnel, Body>,
    pub(crate) r_body_tunnel: Rotation<Body, Tunnel>,
    pub(crate) vw_m_s: f64,
    pub(crate) vw_rate_m_s2: f64,
    /// Acceleration of the air at the vehicle, gusts included, m/s².
    pub(crate) a_tunnel_air: Vec3<Tunnel>,
    /// Velocity of the c.m. seen from the air, gusts included, m/s.
    pub(crate) v_air_cm: Vec3<Body>,
}

impl Setup<'_> {
    /// Rate of the state. `N` is [`Setup::states`].
    #[inline]
    pub(crate) fn rate<const N: usize>(&self, y: &SVector<f64, N>, dy: &mut SVector<f64, N>) {
        let i = self.instant(y);
        let (a, w_rate, loose) = if self.coupled { coupled::solve(self, &i, self.loose_state(y)) } else { self.direct(&i) };
        let a_tunnel = i.r_tunnel_body * a;
        let q = quaternion_rate([y[6], y[7], y[8], y[9]], i.w.to_array());
        for k in 0..3 {
            dy[k] = y[3 + k];
            dy[3 + k] = a_tunnel.xyz[k];
            dy[10 + k] = w_rate.xyz[k];
        }
        for k in 0..4 {
            dy[6 + k] = q[k];
        }
        dy[TIME] = 1.0;
        if N > BASE {
            self.appended_rate(y, dy, &i, loose);
        }
    }

    fn appended_rate<const N: usize>(&self, y: &SVector<f64, N>, dy: &mut SVector<f64, N>, i: &Instant, loose: [f64; 2]) {
        if self.plant.vehicle.loose.is_some() {
            dy[BASE] = y[BASE + 2];
            dy[BASE + 1] = y[BASE + 3];
            dy[BASE + 2] = loose[0];
            dy[BASE + 3] = loose[1];
        }
        if let (Some(hand), Some(k)) = (&self.hand, self.hand_index) {
            let rates = hand.rates(i.t_s, i.p.x(), i.v.x(), [y[k], y[k + 1]]);
            dy[k] = rates[0];
            dy[k + 1] = rates[1];
        }
    }

    /// Acceleration (body axes) and rate of body rates when no force needs an acceleration.
    #[inline(always)]
    fn direct(&self, i: &Instant) -> (Vec3<Body>, Vec3<Body>, [f64; 2]) {
        let mut c = i.early;
        let aero = self.aerodynamic(&c, i);
        let a = (aero.f + i.other.f) * self.per_mass + i.g;
        let moment = if self.program.needs_rates() && i.q_pa > 0.0 {
            self.late(i, a, &mut c);
            self.aerodynamic(&c, i).m
        } else {
            aero.m
        };
        (a, self.euler(i.w, moment + i.other.m), [0.0; 2])
    }

    /// Adds the coefficients' terms that need the acceleration `a` (inertial, body axes, m/s²).
    #[inline(always)]
    pub(crate) fn late(&self, i: &Instant, a: Vec3<Body>, c: &mut [f64; 6]) {
        let mut flow = i.flow;
        let v_rate = a - i.a_air - i.w.cross(i.v_air_cm);
        flow.set_rates(i.v_air_cm, v_rate, i.w, self.plant.vehicle.diameter_m);
        self.program.late(&flow, c);
    }

    /// Aerodynamic force and moment of coefficients.
    #[inline]
    pub(crate) fn aerodynamic(&self, c: &[f64; 6], i: &Instant) -> Wrench {
        let v = &self.plant.vehicle;
        wrench_at_cm(c, i.q_pa, self.area_m2, v.diameter_m, v.p_origin_cm)
    }

    /// Euler's equation: rate of body rates under a moment.
    #[inline(always)]
    fn euler(&self, w: Vec3<Body>, moment: Vec3<Body>) -> Vec3<Body> {
        let gyroscopic = w.xyz.cross(&(self.inertia * w.xyz));
        (self.inertia_inverse * (moment.xyz - gyroscopic)).into()
    }

    /// Everything that needs no acceleration.
    #[inline(always)]
    pub(crate) fn instant<const N: usize>(&self, y: &SVector<f64, N>) -> Instant {
        let s = self.sight(y);
        let a_air = s.r_body_tunnel * s.a_tunnel_air;
        let w = Vec3::new(y[10], y[11], y[12]);
        let (flow, q_pa, early) = self.early(s.v_air_cm, w, y[TIME]);
        let mut i = Instant {
            t_s: y[TIME],
            p: s.p,
            v: s.v,
            r_tunnel_body: s.r_tunnel_body,
            w,
            vw_m_s: s.vw_m_s,
            vw_rate_m_s2: s.vw_rate_m_s2,
            a_air,
            v_air_cm: s.v_air_cm,
            flow,
            q_pa,
            early,
            other: Wrench::default(),
            g: s.r_body_tunnel * Vec3::new(self.plant.environment.gravity_m_s2, 0.0, 0.0),
        };
        self.pull(&mut i);
        i
    }

    /// Place, attitude and air: what follows from the state without any force.
    #[inline(always)]
    pub(crate) fn sight<const N: usize>(&self, y: &SVector<f64, N>) -> Sight {
        let p = Vec3::new(y[0], y[1], y[2]);
        let v = Vec3::new(y[3], y[4], y[5]);
        let r_tunnel_body = Rotation::from_quaternion([y[6], y[7], y[8], y[9]]);
        let r_body_tunnel = r_tunnel_body.inverse();
        let (vw_m_s, vw_rate_m_s2) = self.tunnel_speed(y);
        let wind = self.plant.flow.wind(p, v, vw_m_s, vw_rate_m_s2);
        let air = self.gusty(wind, y[TIME]);
        let v_air_cm = r_body_tunnel * (v - air.v_tunnel_air);
        Sight { p, v, r_tunnel_body, r_body_tunnel, vw_m_s, vw_rate_m_s2, a_tunnel_air: air.a_tunnel_air, v_air_cm }
    }

    /// Pull of the tether toward the ring, N.
    pub(crate) fn tether_n(&self, s: &Sight, w: Vec3<Body>) -> f64 {
        self.plant.tether.as_ref().map_or(0.0, |tether| {
            let line = tether.line(s.p, s.v, s.r_tunnel_body, w, self.plant.vehicle.p_origin_cm);
            let q_pa = 0.5 * self.density_kg_m3 * s.v_air_cm.dot(s.v_air_cm);
            tether.pull_n(q_pa, line.length_m, line.length_rate_m_s)
        })
    }

    /// Adds tether and contacts.
    #[inline(always)]
    fn pull(&self, i: &mut Instant) {
        let p_origin_cm = self.plant.vehicle.p_origin_cm;
        if let Some(tether) = &self.plant.tether {
            let line = tether.line(i.p, i.v, i.r_tunnel_body, i.w, p_origin_cm);
            i.other += tether.wrench(&line, i.q_pa, p_origin_cm);
        }
        for contact in &self.plant.contacts {
            i.other += contact.wrench(i.t_s);
        }
    }

    /// Flow variables, dynamic pressure and the coefficients that need no acceleration.
    #[inline(always)]
    fn early(&self, v_air_cm: Vec3<Body>, w: Vec3<Body>, t_s: f64) -> (FlowState, f64, [f64; 6]) {
        let mut c = [0.0; 6];
        if v_air_cm.dot(v_air_cm) < STILL_AIR_M2_S2 {
            let along = Vec3::new(1.0, 0.0, 0.0);
            return (FlowState::without_rates(along, w, self.plant.vehicle.diameter_m, self.program.needed()), 0.0, c);
        }
        let flow = FlowState::without_rates(v_air_cm, w, self.plant.vehicle.diameter_m, self.program.needed());
        self.program.early(&flow, &mut c);
        for (index, noise) in &self.coefficient_noise {
            c[*index] += noise.at(t_s).0;
        }
        (flow, dynamic_pressure_pa(self.density_kg_m3, flow.get(windfall_model::Variable::Speed)), c)
    }

    /// Wind with gusts.
    #[inline(always)]
    fn gusty(&self, mut wind: Wind, t_s: f64) -> Wind {
        for (axis, gust) in &self.gusts {
            let (value, rate) = gust.at(t_s);
            wind.v_tunnel_air.xyz[*axis] += value;
            wind.a_tunnel_air.xyz[*axis] += rate;
        }
        wind
    }

    /// Tunnel speed and its rate.
    #[inline(always)]
    fn tunnel_speed<const N: usize>(&self, y: &SVector<f64, N>) -> (f64, f64) {
        match (&self.hand, self.hand_index) {
            (Some(hand), Some(k)) => (y[k], hand.rates(y[TIME], y[0], y[3], [y[k], y[k + 1]])[0]),
            _ => self.history.at(y[TIME]),
        }
    }

    fn loose_state<const N: usize>(&self, y: &SVector<f64, N>) -> [f64; 4] {
        if self.plant.vehicle.loose.is_some() { [y[BASE], y[BASE + 1], y[BASE + 2], y[BASE + 3]] } else { [0.0; 4] }
    }
}

/// `q̇ = ½ q ∘ (0, ω)` for a quaternion body to tunnel and rates in body axes.
#[inline]
pub(crate) fn quaternion_rate(q: [f64; 4], w: [f64; 3]) -> [f64; 4] {
    let ([s, x, y, z], [p, q, r]) = (q, w);
    [-0.5 * (x * p + y * q + z * r), 0.5 * (s * p + y * r - z * q), 0.5 * (s * q + z * p - x * r), 0.5 * (s * r + x * q - y * p)]
}

/// Specific force `a_P − g` of a point fixed at `r` in the body, body axes.
#[inline]
pub(crate) fn specific_force(i: &Instant, a: Vec3<Body>, w_rate: Vec3<Body>, r: Vec3<Body>) -> Vec3<Body> {
    a - i.g + w_rate.cross(r) + i.w.cross(i.w.cross(r))
}

/// Angular momentum equation's residual-free form for [`coupled`]: `I ω̇ + ω × I ω`.
#[inline]
pub(crate) fn momentum_rate(setup: &Setup<'_>, w: Vec3<Body>, w_rate: Vec3<Body>) -> Vector3<f64> {
    setup.inertia * w_rate.xyz + w.xyz.cross(&(setup.inertia * w.xyz))
}

#[cfg(test)]
mod tests;
