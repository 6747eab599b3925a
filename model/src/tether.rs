//! model: the safety tether (thesis B.6, eqs B.27-B.36). In: place, attitude, dynamic pressure. Out: force and moment on the model.

use crate::aero::Wrench;
use crate::frames::{Body, Rotation, Tunnel, Vec3};

/// Tether as a pull toward the centering ring, of magnitude q_∞ (C_D S)_tr − W_tr, and what effects add to it.
///
/// ```
/// use windfall_model::frames::{EulerXyz, Vec3};
/// use windfall_model::Tether;
///
/// // Hook 0.2 m above the model, ring 3 m above it, 0.1 m² of drag area and 1 N of weight: at 30 Pa the line pulls 2 N straight up.
/// let tether = Tether::declared(Vec3::new(-0.2, 0.0, 0.0), Vec3::new(-3.0, 0.0, 0.0), 0.1, 1.0);
/// let upright = EulerXyz::default().r_tunnel_body();
/// let line = tether.line(Vec3::zero(), Vec3::zero(), upright, Vec3::zero(), Vec3::zero());
/// assert!((line.length_m - 2.8).abs() < 1e-15);
/// let wrench = tether.wrench(&line, 30.0, Vec3::zero());
/// assert!((wrench.f.x() + 2.0).abs() < 1e-15 && wrench.m.norm() == 0.0);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Tether {
    /// Attachment point from the geometric origin, m, body axes (thesis r_t,o).
    pub p_origin_hook: Vec3<Body>,
    /// Centering ring from the tunnel origin, m, tunnel axes.
    pub p_tunnel_ring: Vec3<Tunnel>,
    /// Drag area (C_D S)_tr, m².
    pub drag_area_m2: f64,
    /// Effective weight W_tr, N.
    pub weight_n: f64,
    /// Pull per rate of lengthening of the line between hook and ring, N s/m (0: declared). Positive opposes motion away. A line cannot
    /// push: where its shortening would make it, it goes slack.
    pub line_rate_n_s_m: f64,
    /// Relative change of the pull per metre of line between hook and ring beyond its length at the tunnel origin, 1/m.
    pub length_per_m: f64,
    /// Lateral displacement of the ring from where it is declared, m along tunnel Y and Z.
    pub ring_shift_m: [f64; 2],
    /// Largest torque with which the swivel resists roll, N m (0: declared). Coulomb friction opposes the roll rate p about body
    /// x with `swivel_n_m · tanh(p/swivel_rate_rad_s)`: its jump at rest is smooth.
    pub swivel_n_m: f64,
    /// Roll rate over which that torque grows, rad/s, above zero.
    pub swivel_rate_rad_s: f64,
}

/// Roll rate over which the swivel's torque grows, rad/s, unless the plant says otherwise: 3 deg/s, slow against the rates of a
/// swinging model.
pub(crate) const SWIVEL_RATE_RAD_S: f64 = 0.05;

/// Where the line is and how fast it lengthens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// Unit vector from hook to ring, body axes.
    pub direction: Vec3<Body>,
    /// Length from hook to ring, m.
    pub length_m: f64,
    /// Rate of that length, m/s.
    pub length_rate_m_s: f64,
    /// Roll rate p of the body under the swivel, rad/s.
    pub roll_rate_rad_s: f64,
}

impl Tether {
    /// Declared tether: the four numbers of thesis Table B.1 and Figure B.1.
    #[must_use]
    pub fn declared(p_origin_hook: Vec3<Body>, p_tunnel_ring: Vec3<Tunnel>, drag_area_m2: f64, weight_n: f64) -> Self {
        Self {
            p_origin_hook,
            p_tunnel_ring,
            drag_area_m2,
            weight_n,
            line_rate_n_s_m: 0.0,
            length_per_m: 0.0,
            ring_shift_m: [0.0; 2],
            swivel_n_m: 0.0,
            swivel_rate_rad_s: SWIVEL_RATE_RAD_S,
        }
    }
    /// Ring position with its shift, tunnel axes, m.
    #[must_use]
    #[inline]
    pub fn ring(&self) -> Vec3<Tunnel> {
        self.p_tunnel_ring + Vec3::new(0.0, self.ring_shift_m[0], self.ring_shift_m[1])
    }
    /// Pull toward the ring, N (eq. B.32); negative when the line's weight exceeds its drag.
    #[must_use]
    #[inline]
    pub fn pull_n(&self, q_pa: f64, length_m: f64, length_rate_m_s: f64) -> f64 {
        let steady = q_pa * self.drag_area_m2 - self.weight_n;
        let nominal_m = self.p_tunnel_ring.norm() - self.p_origin_hook.norm();
        let pull = steady * (1.0 + self.length_per_m * (length_m - nominal_m));
        (pull + self.line_rate_n_s_m * length_rate_m_s).max(pull.min(0.0))
    }
    /// Geometry of the line (eqs B.33-B.36) for the c.m. at `p`, moving with `v`, attitude `r`, body rates `w`.
    #[must_use]
    #[inline]
    pub fn line(
        &self,
        p_tunnel_cm: Vec3<Tunnel>,
        v_tunnel_cm: Vec3<Tunnel>,
        r_tunnel_body: Rotation<Tunnel, Body>,
        w_tunnel_body: Vec3<Body>,
        p_origin_cm: Vec3<Body>,
    ) -> Line {
        let p_cm_hook = self.p_origin_hook - p_origin_cm;
        let to_ring = r_tunnel_body.inverse() * (self.ring() - p_tunnel_cm) - p_cm_hook;
        let length_m = to_ring.norm();
        let direction = to_ring * (1.0 / length_m);
        let v_hook = r_tunnel_body.inverse() * v_tunnel_cm + w_tunnel_body.cross(p_cm_hook);
        Line { direction, length_m, length_rate_m_s: -direction.dot(v_hook), roll_rate_rad_s: w_tunnel_body.x() }
    }
    /// Torque of the swivel about body x, N m, at roll rate p in rad/s.
    #[must_use]
    #[inline]
    pub fn swivel_torque_n_m(&self, p_rad_s: f64) -> f64 {
        if self.swivel_n_m == 0.0 { 0.0 } else { -self.swivel_n_m * (p_rad_s / self.swivel_rate_rad_s).tanh() }
    }
    /// Force along the line, its moment about the c.m., `r_t × F` (eq. B.30 with the sign of B.31), and the swivel's torque.
    #[must_use]
    #[inline]
    pub fn wrench(&self, line: &Line, q_pa: f64, p_origin_cm: Vec3<Body>) -> Wrench {
        let f = line.direction * self.pull_n(q_pa, line.length_m, line.length_rate_m_s);
        let swivel = Vec3::new(self.swivel_torque_n_m(line.roll_rate_rad_s), 0.0, 0.0);
        Wrench { f, m: (self.p_origin_hook - p_origin_cm).cross(f) + swivel }
    }
}
