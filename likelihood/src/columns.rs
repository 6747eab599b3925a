//! likelihood: columns, directions in which the model may be changed. In: numbers of a plant, or forces and errors over a variable. Out:
//! what each does to the rates of motion and to what is measured, at one instant.

use windfall_model::{CHANNEL_NAMES, POSE, Plant, Sensors};
use windfall_pid::equations::{STATES, Scalar};

/// What a column is a change of.
#[derive(Clone, Debug)]
pub(crate) enum SensitivityColumn {
    /// A parameter of the aerodynamic structure, by its terms.
    Declared(usize),
    /// The plant with one number a small step away, and that step.
    Plant(Box<Plant>, f64),
    /// A load or an error over a variable.
    Generic(Site, Basis),
}

/// What a generic column changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Site {
    /// A coefficient of body force or moment, by its place among [`LOADS`].
    Load(usize),
    /// What a channel of the pose shows, in its unit.
    Channel(usize),
    /// What the tunnel speed is beyond its record, m/s; its rate, which only a fast one would have, is left out.
    Speed,
}

impl Site {
    /// In words of a report.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Load(place) => LOADS[place],
            Self::Channel(place) => CHANNEL_NAMES[place],
            Self::Speed => CHANNEL_NAMES[POSE],
        }
    }
}

/// A function of what is known along a run; each is of order one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Basis {
    /// cos or sin of whole turns of half the run's duration: 1, 2, … .
    Time(u8),
    /// One in a run, zero in the others.
    Run(usize),
    /// Power of the airspeed's excess over its mean, of a tenth of it.
    Speed(i32),
    /// Power of the tunnel speed's excess over its mean, of a tenth of it.
    TunnelSpeed(i32),
    /// Powers of Y and Z, of 0.3 m.
    Place(i32, i32),
    /// Distance from the tunnel's axis along body y (1) or z (2), of 0.3 m, times a power of the whole distance.
    Away(usize, i32),
    /// Power of the height X, of 0.3 m.
    Height(i32),
    /// Power of the total angle of attack, of 0.3 rad, along the plane of that angle: (power, sine of clock angle or cosine).
    Angle(i32, bool),
    /// Even power of the total angle of attack, of 0.3 rad.
    TotalAngle(i32),
    /// Power of the size of one angle (1 angle of attack, 2 sideslip), of 0.3 rad: what acts to one side.
    OneSided(usize, i32),
    /// Harmonic of the roll angle in the tunnel: cosine or sine.
    Roll(u8, bool),
    /// Sign of a body rate: 0 roll, 1 pitch, 2 yaw; and the same times the angle in its plane, of 0.3 rad.
    Hysteresis(usize, bool),
    /// An angle (1 angle of attack, 2 sideslip), of 0.3 rad, with the sign of the total angle's rate: opening or closing.
    Opening(usize),
    /// Angle of attack times sideslip, of 0.3 rad each.
    BothAngles,
    /// A body rate: 0 roll, 1 pitch, 2 yaw; rad/s.
    Rate(usize),
    /// Its square, with its sign.
    RateSquare(usize),
    /// Power of the time since a run began, of 10 s.
    Elapsed(i32),
    /// The slope over an angle (1 angle of attack, 2 sideslip, of 0.3 rad; 0 none) in proportion to a variable.
    Slope(usize, Along),
    /// The slope over a body rate (0 roll, 1 pitch, 2 yaw; rad/s) in proportion to a variable.
    Damping(usize, Along),
}

/// A variable along a run, of order one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Along {
    /// Time since the run began, of 10 s.
    Time,
    /// The airspeed's excess over its mean, of a tenth of it.
    Speed,
    /// The height X, of 0.3 m.
    Height,
}

impl Along {
    /// All of them.
    pub(crate) const ALL: [Self; 3] = [Self::Time, Self::Speed, Self::Height];
    fn basis(self) -> Basis {
        match self {
            Self::Time => Basis::Elapsed(1),
            Self::Speed => Basis::Speed(1),
            Self::Height => Basis::Height(1),
        }
    }
}

/// What a basis may look at.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct View {
    pub(crate) run: usize,
    pub(crate) t_s: f64,
    pub(crate) duration_s: f64,
    pub(crate) speed_m_s: f64,
    pub(crate) mean_speed_m_s: f64,
    pub(crate) tunnel_speed_m_s: f64,
    pub(crate) height_m: f64,
    /// Y and Z.
    pub(crate) away_m: [f64; 2],
    pub(crate) roll_rad: f64,
    /// Angle of attack and sideslip, rad, and body rates.
    pub(crate) alpha_rad: f64,
    pub(crate) beta_rad: f64,
    pub(crate) rates_rad_s: [f64; 3],
}

impl Basis {
    pub(crate) fn value(self, v: &View) -> f64 {
        use std::f64::consts::PI;
        match self {
            Self::Time(k) => {
                let turn = PI * f64::from(k.div_ceil(2)) * v.t_s / v.duration_s.max(1e-9);
                if k % 2 == 1 { turn.cos() } else { turn.sin() }
            }
            Self::Run(i) => f64::from(u8::from(i == v.run)),
            Self::Speed(n) => ((v.speed_m_s / v.mean_speed_m_s - 1.0) / 0.1).powi(n),
            Self::TunnelSpeed(n) => ((v.tunnel_speed_m_s / v.mean_speed_m_s - 1.0) / 0.1).powi(n),
            Self::Height(n) => (v.height_m / 0.3).powi(n),
            Self::Place(n, m) => (v.away_m[0] / 0.3).powi(n) * (v.away_m[1] / 0.3).powi(m),
            Self::Away(axis, n) => {
                let ([y, z], (sin, cos)) = (v.away_m.map(|a| a / 0.3), v.roll_rad.sin_cos());
                y.hypot(z).powi(n) * if axis == 1 { y * cos + z * sin } else { z * cos - y * sin }
            }
            Self::Angle(n, across) => {
                let total = v.alpha_rad.hypot(v.beta_rad).max(1e-9);
                (total / 0.3).powi(n) * if across { v.beta_rad / total } else { v.alpha_rad / total }
            }
            Self::Roll(n, sine) => {
                let turn = f64::from(n) * v.roll_rad;
                if sine { turn.sin() } else { turn.cos() }
            }
            Self::TotalAngle(n) => (v.alpha_rad.hypot(v.beta_rad) / 0.3).powi(n),
            Self::OneSided(plane, n) => ([v.alpha_rad, v.beta_rad][plane - 1].abs() / 0.3).powi(n),
            Self::Hysteresis(axis, by_angle) => {
                let sign = (v.rates_rad_s[axis] / 0.1).tanh();
                let angle = if axis == 2 { v.beta_rad } else { v.alpha_rad };
                if by_angle { sign * angle.abs() / 0.3 } else { sign }
            }
            Self::Opening(plane) => {
                let total = v.alpha_rad.hypot(v.beta_rad).max(1e-9);
                // α̇ = q - p β and β̇ = p α - r: rolling does not open the total angle.
                let opens = (v.alpha_rad * v.rates_rad_s[1] - v.beta_rad * v.rates_rad_s[2]) / total;
                (opens / 0.1).tanh() * [v.alpha_rad, v.beta_rad][plane - 1] / 0.3
            }
            Self::BothAngles => v.alpha_rad * v.beta_rad / 0.09,
            Self::Rate(axis) => v.rates_rad_s[axis],
            Self::RateSquare(axis) => v.rates_rad_s[axis] * v.rates_rad_s[axis].abs(),
            Self::Elapsed(n) => (v.t_s / 10.0).powi(n),
            Self::Slope(plane, along) => along.basis().value(v) * [1.0, v.alpha_rad / 0.3, v.beta_rad / 0.3][plane],
            Self::Damping(axis, along) => along.basis().value(v) * v.rates_rad_s[axis],
        }
    }

    /// In words of a report.
    pub(crate) fn words(self) -> String {
        match self {
            Self::Time(_) => "time".to_owned(),
            Self::Run(_) => "run".to_owned(),
            Self::Speed(_) => "airspeed".to_owned(),
            Self::TunnelSpeed(_) => "tunnel speed".to_owned(),
            Self::Place(..) | Self::Away(..) => "place across the tunnel (Y, Z)".to_owned(),
            Self::Height(_) => "height X".to_owned(),
            Self::Angle(..) | Self::TotalAngle(_) => "angle of attack".to_owned(),
            Self::OneSided(..) => "size of the angle of attack (to one side)".to_owned(),
            Self::Roll(..) => "roll angle".to_owned(),
            Self::Rate(_) => "body rates across".to_owned(),
            Self::RateSquare(_) => "body rate (its square)".to_owned(),
            Self::Opening(_) => "sign of the angle's rate (hysteresis)".to_owned(),
            Self::BothAngles => "angle of attack and sideslip together".to_owned(),
            Self::Hysteresis(..) => "sign of the body rates (hysteresis)".to_owned(),
            Self::Elapsed(_) => "time (a drift)".to_owned(),
            Self::Slope(_, along) | Self::Damping(_, along) => along.basis().words(),
        }
    }
}

/// Names of the body loads.
pub(crate) const LOADS: [&str; 6] = ["CA", "CY", "CN", "Cl", "Cm", "Cn"];

/// What a channel shows at one node.
pub(crate) type Shown = [f64; POSE];

/// Time by which the tunnel speed's record lags the pose's, s. Only this can be told: a motion seen late, under inputs seen as late, is
/// the same motion.
pub(crate) fn lag_s(s: &Sensors) -> f64 {
    s.wind_delay_s - s.pose_delay_s
}

/// What the pose's instruments make of a state: c.m. position, Euler angles, velocity, rates and their derivatives; each channel's mean over
/// the node's samples, which lie about the node by `samples` (mean time and mean square, s and s²). `arm` leads from the tracked origin to the
/// c.m., body axes, m.
#[inline(always)]
pub(crate) fn shown<S: Scalar>(s: &Sensors, arm: [f64; 3], x: &[S; STATES], rate: &[f64], samples: [f64; 2]) -> [S; POSE] {
    let (first, second) = (samples[0], 0.5 * samples[1]);
    let (e, w) = ([x[3], x[4], x[5]], [x[9], x[10], x[11]]);
    let e1 = euler_rate(e, w);
    // Second derivative of the angles along the motion, by a difference: it only curves a block of samples.
    const STEP_S: f64 = 1e-4;
    let (mut then, mut turning) = (e, w);
    for k in 0..3 {
        then[k] = e[k] + e1[k] * STEP_S;
        turning[k] = w[k] + STEP_S * rate[9 + k];
    }
    let ahead = euler_rate(then, turning);
    let mut angles = e;
    for k in 0..3 {
        angles[k] = e[k] + e1[k] * first + (ahead[k] - e1[k]) * (second / STEP_S);
    }
    let t = turned(angles);
    let mut place = e;
    for k in 0..3 {
        let cm = x[k] + x[6 + k] * first + second * rate[6 + k];
        place[k] = (cm - (t[k][0] * arm[0] + t[k][1] * arm[1] + t[k][2] * arm[2])) * (1.0 + s.length_scale);
    }
    if s.misalignment_rad.iter().any(|a| *a != 0.0) {
        let m = body_to_tunnel(s.misalignment_rad);
        let r = |i: usize, j: usize| t[i][0] * m[0][j] + t[i][1] * m[1][j] + t[i][2] * m[2][j];
        let near = |angle: S, to: S| {
            let turns = ((to.value() - angle.value()) / std::f64::consts::TAU).round();
            angle + std::f64::consts::TAU * turns
        };
        let sine = r(0, 2);
        let cosine = (r(0, 0) * r(0, 0) + r(0, 1) * r(0, 1)).sqrt();
        angles = [near((-r(1, 2)).atan2(r(2, 2)), angles[0]), sine.atan2(cosine), near((-r(0, 1)).atan2(r(0, 0)), angles[2])];
    }
    [place[0], place[1], place[2], angles[0], angles[1], angles[2]]
}

/// Rates of the Euler angles by body rates.
#[inline(always)]
fn euler_rate<S: Scalar>(e: [S; 3], w: [S; 3]) -> [S; 3] {
    let ((sy, cy), (sz, cz)) = (e[1].sin_cos(), e[2].sin_cos());
    let rx = (w[0] * cz - w[1] * sz) * cy.recip();
    [rx, w[0] * sz + w[1] * cz, w[2] - sy * rx]
}

/// Body-to-tunnel matrix of Euler angles (thesis eq. B.14).
pub(crate) fn body_to_tunnel(angles: [f64; 3]) -> [[f64; 3]; 3] {
    turned(angles)
}

#[inline(always)]
fn turned<S: Scalar>([rx, ry, rz]: [S; 3]) -> [[S; 3]; 3] {
    let ((sx, cx), (sy, cy), (sz, cz)) = (rx.sin_cos(), ry.sin_cos(), rz.sin_cos());
    [
        [cz * cy, -(sz * cy), sy],
        [cz * sy * sx + sz * cx, cz * cx - sz * sy * sx, -(cy * sx)],
        [sz * sx - cz * sy * cx, sz * sy * cx + cz * sx, cy * cx],
    ]
}

#[cfg(test)]
mod tests;
