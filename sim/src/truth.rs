//! sim: what really happened. In: integrated states. Out: series at the sample times, and how the flight ended.

use windfall_model::Record;
use windfall_model::frames::{Body, EulerXyz, Rotation, Tunnel};

/// True states at the sample times. Only verification may see it beside an estimate.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Truth {
    /// Sample times from release, s, uniform.
    pub t_s: Vec<f64>,
    /// c.m. position, m, tunnel axes.
    pub p_tunnel_cm: Vec<[f64; 3]>,
    /// c.m. velocity, m/s, tunnel axes.
    pub v_tunnel_cm: Vec<[f64; 3]>,
    /// Attitude, body to tunnel, scalar first, unit length, continuous.
    pub quaternion: Vec<[f64; 4]>,
    /// Body rates p, q, r, rad/s.
    pub w_tunnel_body: Vec<[f64; 3]>,
    /// R_x, R_y, R_z, rad, roll unwrapped.
    pub attitude_rad: Vec<[f64; 3]>,
    /// Tunnel speed, m/s, upward positive, without gusts.
    pub vw_m_s: Vec<f64>,
    /// Total angle of attack, rad, gusts included.
    pub alpha_t_rad: Vec<f64>,
    /// Airspeed, m/s, gusts included.
    pub airspeed_m_s: Vec<f64>,
    /// Pull of the tether toward the ring, N; zero without tether.
    pub tether_n: Vec<f64>,
}

impl Truth {
    /// Number of samples.
    #[must_use]
    pub fn len(&self) -> usize {
        self.t_s.len()
    }
    /// True when there are no samples.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.t_s.is_empty()
    }
    /// Empty series with room for `n` samples.
    pub(crate) fn with_capacity(n: usize) -> Self {
        let mut truth = Self::default();
        truth.reserve(n);
        truth
    }
    /// Room for `n` more samples.
    pub(crate) fn reserve(&mut self, n: usize) {
        let Self { t_s, p_tunnel_cm, v_tunnel_cm, quaternion, w_tunnel_body, attitude_rad, .. } = self;
        for numbers in [t_s, &mut self.vw_m_s, &mut self.alpha_t_rad, &mut self.airspeed_m_s, &mut self.tether_n] {
            numbers.reserve_exact(n);
        }
        for vectors in [p_tunnel_cm, v_tunnel_cm, w_tunnel_body, attitude_rad] {
            vectors.reserve_exact(n);
        }
        quaternion.reserve_exact(n);
    }
    /// Forgets all samples and keeps the memory.
    pub(crate) fn clear(&mut self) {
        let Self { t_s, p_tunnel_cm, v_tunnel_cm, quaternion, w_tunnel_body, attitude_rad, .. } = self;
        for numbers in [t_s, &mut self.vw_m_s, &mut self.alpha_t_rad, &mut self.airspeed_m_s, &mut self.tether_n] {
            numbers.clear();
        }
        for vectors in [p_tunnel_cm, v_tunnel_cm, w_tunnel_body, attitude_rad] {
            vectors.clear();
        }
        quaternion.clear();
    }
}

/// How a flight ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum End {
    /// It lasted as long as ordered.
    Completed,
    /// The c.m. reached the wall.
    Wall {
        /// When, s from release.
        t_s: f64,
    },
    /// The c.m. reached the upper net.
    UpperNet {
        /// When, s from release.
        t_s: f64,
    },
    /// The c.m. reached the lower net.
    LowerNet {
        /// When, s from release.
        t_s: f64,
    },
}

/// A flight: truth, record and end.
#[derive(Clone, Debug, PartialEq)]
pub struct Flown {
    /// What happened.
    pub truth: Truth,
    /// What the instruments said.
    pub record: Record,
    /// How it ended.
    pub end: End,
    /// Accepted steps of the integrator.
    pub steps: u64,
}

/// Euler angles with the roll nearest to the one before.
pub(crate) fn angles(r_tunnel_body: Rotation<Tunnel, Body>, roll_before_rad: f64) -> [f64; 3] {
    let e = EulerXyz::from_rotation(r_tunnel_body);
    let turns = ((roll_before_rad - e.rx_rad) / std::f64::consts::TAU).round();
    [e.rx_rad + turns * std::f64::consts::TAU, e.ry_rad, e.rz_rad]
}
