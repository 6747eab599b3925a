//! model: the run record, what was measured. In: columns in SI and rad. Out: checked series of one length.

/// A tunnel run: pose of the geometric origin and tunnel state, uniformly sampled; gaps already bridged or split.
#[derive(Clone, Debug, PartialEq)]
pub struct Record {
    /// Sample times, s; uniform to 1 %, increasing.
    pub t_s: Vec<f64>,
    /// Position of the geometric origin, m, tunnel X, Y, Z: three series.
    pub position_m: [Vec<f64>; 3],
    /// Euler angles R_x, R_y, R_z, rad, roll unwrapped: three series.
    pub attitude_rad: [Vec<f64>; 3],
    /// Tunnel speed V_W, m/s, upward positive.
    pub vw_m_s: Vec<f64>,
    /// Static pressure, Pa.
    pub ps_pa: Vec<f64>,
    /// Static temperature, K.
    pub ts_k: Vec<f64>,
    /// Tunnel dynamic pressure, Pa, when recorded.
    pub qw_pa: Option<Vec<f64>>,
    /// For each sample, whether any of the seven motion signals was filled in there (a missing row or value bridged, a spike
    /// replaced) and not measured; empty when all were measured.
    pub bridged: Vec<bool>,
}

impl Record {
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
    /// Whether sample `i` was measured in all seven motion signals.
    #[must_use]
    pub fn is_measured(&self, i: usize) -> bool {
        !self.bridged.get(i).copied().unwrap_or(false)
    }
    /// Mean sample interval, s.
    #[must_use]
    pub fn interval_s(&self) -> f64 {
        match self.t_s.len() {
            0 | 1 => 0.0,
            n => (self.t_s[n - 1] - self.t_s[0]) / (n - 1) as f64,
        }
    }
    /// Duration from first to last sample, s.
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        self.interval_s() * self.len().saturating_sub(1) as f64
    }
    /// The seven measured motion signals in channel order: X, Y, Z (m), R_x, R_y, R_z (rad), V_W (m/s).
    #[must_use]
    pub fn channels(&self) -> [&[f64]; 7] {
        let [x, y, z] = &self.position_m;
        let [rx, ry, rz] = &self.attitude_rad;
        [x, y, z, rx, ry, rz, &self.vw_m_s]
    }
}

/// Track of a body without attitude: times (may be uneven) and position; tunnel axes, X down.
#[derive(Clone, Debug, PartialEq)]
pub struct PointRecord {
    /// Sample times, s, increasing.
    pub t_s: Vec<f64>,
    /// Position series along tunnel X, Y, Z, m; an axis that was not measured is absent.
    pub position_m: [Option<Vec<f64>>; 3],
}
