//! model: the tunnel's flow and what the vehicle feels of it. In: recorded speed, place, motion. Out: air velocity and flow
//! variables (thesis B.37-B.56).

use crate::frames::{Body, Tunnel, Vec3};

/// Mean flow of the test section: all zero in a declared model, which has uniform flow upward at the recorded V_W.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MeanFlow {
    /// Relative excess of speed at one metre from the axis, 1/m²: `V = V_W (1 + k r²)`.
    pub profile_per_m2: f64,
    /// Linear variation of speed across the section, 1/m, along Y and Z: `V = V_W (1 + g·(Y, Z))`.
    pub gradient_per_m: [f64; 2],
    /// Solid-body swirl about tunnel +X, as rotation rate per unit tunnel speed, rad/m.
    pub swirl_rad_per_m: f64,
    /// Constant lateral components over V_W along Y and Z (flow angularity, rad).
    pub angularity_rad: [f64; 2],
    /// Tunnel speed to which swirl and angularity stay in proportion whatever V_W is, m/s: lateral flow that does not follow the fan.
    /// 0: they follow V_W.
    pub steady_at_m_s: f64,
}

/// Velocity of the air seen from the tunnel and its rate of change at a moving point, m/s and m/s², tunnel axes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wind {
    /// Air velocity.
    pub v_tunnel_air: Vec3<Tunnel>,
    /// Its total rate of change following the vehicle.
    pub a_tunnel_air: Vec3<Tunnel>,
}

impl MeanFlow {
    /// Wind at place `p` (m, tunnel) moving with `v` (m/s), for tunnel speed `vw` (m/s, upward positive) and its rate.
    #[must_use]
    #[inline]
    pub fn wind(&self, p: Vec3<Tunnel>, v: Vec3<Tunnel>, vw_m_s: f64, vw_rate_m_s2: f64) -> Wind {
        let (y, z, vy, vz) = (p.y(), p.z(), v.y(), v.z());
        let [gy, gz] = self.gradient_per_m;
        let [ay, az] = self.angularity_rad;
        let k = self.profile_per_m2;
        let shape = 1.0 + k * (y * y + z * z) + gy * y + gz * z;
        let shape_rate = 2.0 * k * (y * vy + z * vz) + gy * vy + gz * vz;
        let s = self.swirl_rad_per_m;
        let (ly, lz) = (ay - s * z, az + s * y);
        let (u, u_rate) = if self.steady_at_m_s == 0.0 { (vw_m_s, vw_rate_m_s2) } else { (self.steady_at_m_s, 0.0) };
        Wind {
            v_tunnel_air: Vec3::new(-vw_m_s * shape, u * ly, u * lz),
            a_tunnel_air: Vec3::new(
                -vw_rate_m_s2 * shape - vw_m_s * shape_rate,
                u_rate * ly - u * s * vz,
                u_rate * lz + u * s * vy,
            ),
        }
    }
}

/// Number of [`Variable`]s.
pub const VARIABLES: usize = 14;

/// Flow variables of which aerodynamic terms are made. Angles in rad, rates nondimensional.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[repr(u8)]
pub enum Variable {
    /// sin α_T, in [0, 1].
    SinAlphaT,
    /// cos α_T, in [−1, 1].
    CosAlphaT,
    /// Sine of the clock angle φ_αT = atan2(v, w); 0 at α_T = 0.
    SinPhi,
    /// Cosine of the clock angle; 1 at α_T = 0.
    CosPhi,
    /// Angle of attack α = atan2(w, u).
    Alpha,
    /// Angle of sideslip β = asin(v/V).
    Beta,
    /// Total angle of attack α_T, in [0, π].
    AlphaT,
    /// p d/(2V).
    RollRate,
    /// q d/(2V).
    PitchRate,
    /// r d/(2V).
    YawRate,
    /// (q + α̇)/2 · d/(2V): the damping regressor of thesis eq. 4.10.
    PitchDamping,
    /// (r − β̇)/2 · d/(2V): the damping regressor of thesis eq. 4.11.
    YawDamping,
    /// Airspeed V_∞, m/s.
    Speed,
    /// |p d/(2V)|.
    RollRateAbs,
}

impl Variable {
    /// All variables, in the order of their index.
    pub const ALL: [Self; VARIABLES] = [
        Self::SinAlphaT,
        Self::CosAlphaT,
        Self::SinPhi,
        Self::CosPhi,
        Self::Alpha,
        Self::Beta,
        Self::AlphaT,
        Self::RollRate,
        Self::PitchRate,
        Self::YawRate,
        Self::PitchDamping,
        Self::YawDamping,
        Self::Speed,
        Self::RollRateAbs,
    ];
    /// Name in structure files and reports.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::SinAlphaT => "sin_alpha_T",
            Self::CosAlphaT => "cos_alpha_T",
            Self::SinPhi => "sin_phi",
            Self::CosPhi => "cos_phi",
            Self::Alpha => "alpha_rad",
            Self::Beta => "beta_rad",
            Self::AlphaT => "alpha_T_rad",
            Self::RollRate => "p_hat",
            Self::PitchRate => "q_hat",
            Self::YawRate => "r_hat",
            Self::PitchDamping => "q_alpha_dot_hat",
            Self::YawDamping => "r_beta_dot_hat",
            Self::Speed => "V_m_s",
            Self::RollRateAbs => "abs_p_hat",
        }
    }
    /// The variable of that name, if there is one.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|v| v.name() == name)
    }
}

/// Values of all flow variables at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlowState {
    /// Indexed by [`Variable`].
    pub values: [f64; VARIABLES],
}

impl FlowState {
    /// Flow from ahead, along the body's axis, without rates: variables in proportion to speed are zero.
    #[must_use]
    pub fn ahead() -> Self {
        let mut f = Self { values: [0.0; VARIABLES] };
        f.values[Variable::CosAlphaT as usize] = 1.0;
        f.values[Variable::CosPhi as usize] = 1.0;
        f
    }
    /// Flow variables from the c.m.'s velocity seen from the air (m/s), its rate of change as components in body axes
    /// (m/s², thesis eq. B.40) and the body rates (rad/s). `speed > 0` is the caller's to check; where the flow is exactly
    /// across the body (u = w = 0) the wind-angle rates are undefined and taken as zero.
    #[must_use]
    pub fn new(v_air_cm: Vec3<Body>, v_air_cm_rate: Vec3<Body>, w_tunnel_body: Vec3<Body>, diameter_m: f64) -> Self {
        let mut f = Self::without_rates(v_air_cm, w_tunnel_body, diameter_m, &[true; VARIABLES]);
        f.set_rates(v_air_cm, v_air_cm_rate, w_tunnel_body, diameter_m);
        f
    }
    /// The part of [`FlowState::new`] that needs no acceleration: the two damping variables are left at zero, and so are the
    /// three angles that `needed` (indexed by [`Variable`]) does not ask for, each an arc tangent saved.
    #[must_use]
    #[inline]
    pub fn without_rates(v_air_cm: Vec3<Body>, w_tunnel_body: Vec3<Body>, diameter_m: f64, needed: &[bool; VARIABLES]) -> Self {
        let [u, v, w] = v_air_cm.to_array();
        let [p, q, r] = w_tunnel_body.to_array();
        let cross2 = v * v + w * w;
        let cross = cross2.sqrt();
        let speed = (u * u + cross2).sqrt();
        let per_speed = 1.0 / speed;
        let (sin_phi, cos_phi) = if cross > 0.0 { (v / cross, w / cross) } else { (0.0, 1.0) };
        let hat = 0.5 * diameter_m * per_speed;
        let p_hat = p * hat;
        let angle = |variable: Variable, y: f64, x: f64| if needed[variable as usize] { y.atan2(x) } else { 0.0 };
        let uw2 = u * u + w * w;
        let uw = if needed[Variable::Beta as usize] { uw2.sqrt() } else { 1.0 };
        Self {
            values: [
                cross * per_speed,
                u * per_speed,
                sin_phi,
                cos_phi,
                angle(Variable::Alpha, w, u),
                angle(Variable::Beta, v, uw),
                angle(Variable::AlphaT, cross, u),
                p_hat,
                q * hat,
                r * hat,
                0.0,
                0.0,
                speed,
                p_hat.abs(),
            ],
        }
    }
    /// Puts in the two damping variables, which need the acceleration; arguments as in [`FlowState::new`].
    #[inline]
    pub fn set_rates(&mut self, v_air_cm: Vec3<Body>, v_air_cm_rate: Vec3<Body>, w_tunnel_body: Vec3<Body>, diameter_m: f64) {
        let [u, v, w] = v_air_cm.to_array();
        let [ud, vd, wd] = v_air_cm_rate.to_array();
        let speed = self.values[Variable::Speed as usize];
        let speed2 = speed * speed;
        let uw2 = u * u + w * w;
        let (alpha_dot, beta_dot) = if uw2 > 0.0 {
            let along = u * ud + v * vd + w * wd;
            ((u * wd - ud * w) / uw2, (vd * speed2 - v * along) / (speed2 * uw2.sqrt()))
        } else {
            (0.0, 0.0)
        };
        let half_hat = 0.25 * diameter_m / speed;
        self.values[Variable::PitchDamping as usize] = (w_tunnel_body.y() + alpha_dot) * half_hat;
        self.values[Variable::YawDamping as usize] = (w_tunnel_body.z() - beta_dot) * half_hat;
    }
    /// One variable's value.
    #[must_use]
    #[inline]
    pub fn get(&self, v: Variable) -> f64 {
        self.values[v as usize]
    }
}
