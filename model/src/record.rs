//! model: the run record, what was measured. In: columns in SI and rad. Out: checked series of one length.

use crate::bandwidth::Bandwidth;
use crate::channel::PerChannel;
use crate::plant::Plant;
use crate::point::CoefficientTable;
use crate::quantity::PLANT_NUMBERS;
use std::ops::Range;
use std::sync::Arc;

/// Time over which [`Record::mean_airspeed_m_s`] takes the model's motion, s; chosen: short beside a swing, long beside noise.
const AIRSPEED_S: f64 = 0.25;

/// A tunnel run: pose of the geometric origin and tunnel state, uniformly sampled; gaps already bridged or split.
#[derive(Clone, Debug, Default, PartialEq)]
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
    /// Name of the run whose file long gaps cut into pieces, of which this is one; none where the run is whole.
    pub piece_of: Option<String>,
    /// The recording that this record is a window of, for what looks at a whole signal; none where all of it is here.
    pub recording: Option<Recording>,
    /// What was done to the channels before they were exported, where that took bandwidth; the samples are those that are left. Empty of a
    /// record that is used as it was exported.
    pub bandwidth: Vec<Bandwidth>,
    /// Rows at which V_W was sampled, where its own rate is below that of the rows; it is interpolated or smoothed between them.
    pub wind_rows: Option<WindRows>,
}

/// A recording, and which of its samples a window of it has.
#[derive(Clone, Debug, PartialEq)]
pub struct Recording {
    /// All its samples.
    pub whole: Arc<Record>,
    /// Those of the window.
    pub rows: Range<usize>,
}

/// Every `every`-th row from `first` on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WindRows {
    /// The first row, below `every`.
    pub first: usize,
    /// Rows from one sample to the next, 2 or more.
    pub every: usize,
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
    /// Mean speed of the air past the model, m/s, as the simulator has it: the tunnel's and, where the air rests, that of the model's own motion, between
    /// samples a quarter of a second apart (of which a millimetre of noise makes 6 mm/s).
    #[must_use]
    pub fn mean_airspeed_m_s(&self) -> f64 {
        let n = self.len();
        let tunnel = self.vw_m_s.iter().sum::<f64>() / n.max(1) as f64;
        if tunnel > 0.0 || n < 2 {
            return tunnel;
        }
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a few samples")]
        let apart = ((AIRSPEED_S / self.interval_s()).round() as usize).clamp(1, n - 1);
        let between_s = apart as f64 * self.interval_s();
        let speed = |i: usize| {
            let along = |axis: usize| (self.position_m[axis][i + apart] - self.position_m[axis][i]) / between_s;
            along(0).hypot(along(1).hypot(along(2)))
        };
        (0..n - apart).map(speed).sum::<f64>() / (n - apart) as f64
    }
    /// Share of the variance of an instrument's white noise that smoothing and thinning leave to a sample of a channel: the rate that is kept over
    /// the rate that was sampled. One where nothing was smoothed: the samples of a slower clock are as they were.
    #[must_use]
    pub fn noise_share(&self, channel: usize) -> f64 {
        let own = || self.bandwidth.iter().filter(|b| b.channels.channels().contains(&channel));
        let sampled_hz = |b: &Bandwidth| own().find_map(|o| o.original_hz).unwrap_or(b.thinned_from_hz);
        own().filter(|b| b.original_hz.is_none()).map(|b| b.thinned_to_hz / sampled_hz(b)).fold(1.0, f64::min)
    }
    /// The seven measured motion signals in the order of [`crate::RunChannel`]: X, Y, Z (m), R_x, R_y, R_z (rad), V_W (m/s).
    #[must_use]
    pub fn channels(&self) -> PerChannel<&[f64]> {
        let [x, y, z] = &self.position_m;
        let [rx, ry, rz] = &self.attitude_rad;
        [x, y, z, rx, ry, rz, &self.vw_m_s]
    }
    /// The same, to be changed; the record is then no window of its recording any more.
    #[must_use]
    pub fn channels_mut(&mut self) -> PerChannel<&mut Vec<f64>> {
        let Self { position_m: [x, y, z], attitude_rad: [rx, ry, rz], vw_m_s, recording, .. } = self;
        // It has other samples from now on.
        *recording = None;
        [x, y, z, rx, ry, rz, vw_m_s]
    }
    /// What was recorded beside the motion signals: static pressure (Pa), static temperature (K) and, where recorded, tunnel dynamic
    /// pressure (Pa).
    #[must_use]
    pub fn slow_mut(&mut self) -> [Option<&mut Vec<f64>>; 3] {
        // Every field is named, so that a new one is asked for here.
        let Self {
            t_s: _,
            position_m: _,
            attitude_rad: _,
            vw_m_s: _,
            bridged: _,
            piece_of: _,
            recording: _,
            bandwidth: _,
            wind_rows: _,
            ps_pa,
            ts_k,
            qw_pa,
        } = self;
        [Some(ps_pa), Some(ts_k), qw_pa.as_mut()]
    }
    /// The same, to be read.
    #[must_use]
    pub fn slow(&self) -> [Option<&[f64]>; 3] {
        let Self {
            t_s: _,
            position_m: _,
            attitude_rad: _,
            vw_m_s: _,
            bridged: _,
            piece_of: _,
            recording: _,
            bandwidth: _,
            wind_rows: _,
            ps_pa,
            ts_k,
            qw_pa,
        } = self;
        [Some(ps_pa), Some(ts_k), qw_pa.as_deref()]
    }
    /// The samples of `rows`, in their own time.
    ///
    /// # Panics
    /// When `rows` reach beyond the samples.
    #[must_use]
    pub fn rows(&self, rows: &Range<usize>) -> Self {
        let mut part = self.clone();
        let cut = |series: &mut Vec<f64>| *series = series[rows.clone()].to_vec();
        cut(&mut part.t_s);
        part.channels_mut().into_iter().for_each(cut);
        part.slow_mut().into_iter().flatten().for_each(cut);
        if !part.bridged.is_empty() {
            part.bridged = part.bridged[rows.clone()].to_vec();
        }
        part.wind_rows = self.wind_rows.map(|w| WindRows { first: (w.first + w.every - rows.start % w.every) % w.every, ..w });
        part
    }
    /// The samples of `rows` as a window: what looks at a whole signal still sees all of it.
    ///
    /// ```
    /// use windfall_model::Record;
    /// let whole = Record { t_s: vec![0.0, 0.1, 0.2, 0.3], ..Record::default() };
    /// # let series = vec![0.0; 4];
    /// # let whole = Record {
    /// #     position_m: std::array::from_fn(|_| series.clone()), attitude_rad: std::array::from_fn(|_| series.clone()),
    /// #     vw_m_s: series.clone(), ps_pa: series.clone(), ts_k: series.clone(), ..whole };
    /// let window = whole.window(1..3);
    /// assert_eq!((window.t_s.clone(), window.recording.expect("a window").whole.len()), (vec![0.1, 0.2], 4));
    /// ```
    ///
    /// # Panics
    /// When `rows` reach beyond the samples.
    #[must_use]
    pub fn window(&self, rows: Range<usize>) -> Self {
        let part = self.rows(&rows);
        let recording = match &self.recording {
            Some(r) => Recording { whole: r.whole.clone(), rows: r.rows.start + rows.start..r.rows.start + rows.end },
            None => Recording { whole: Arc::new(self.clone()), rows },
        };
        Self { recording: Some(recording), ..part }
    }
}

/// What a track is a series of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Measured {
    /// Position along tunnel axes, m.
    #[default]
    Position,
    /// Specific force along tunnel axes, m/s²: acceleration less gravity, as an accelerometer on a body that keeps its attitude has it.
    SpecificForce,
    /// Angle of a body on a pivot from hanging down, rad.
    Angle,
    /// Position along tunnel axes, m, and attitude of a rigid body.
    Pose,
    /// Position along tunnel axes, m, and specific force along those of them that an accelerometer has, m/s², at the same times.
    PositionAndForce,
}

impl Measured {
    /// Names of its channels: those of [`PointRecord::series`] in their order, then the attitude's about the body's x, y and z.
    #[must_use]
    pub fn names(self) -> &'static [&'static str] {
        match self {
            Self::Position => &["X", "Y", "Z"],
            Self::SpecificForce => &["fX", "fY", "fZ"],
            Self::Angle => &["angle", "", ""],
            Self::Pose => &["X", "Y", "Z", "about x", "about y", "about z"],
            Self::PositionAndForce => &["X", "Y", "Z", "fX", "fY", "fZ"],
        }
    }
    /// SI unit of a channel.
    #[must_use]
    pub fn unit(self, channel: usize) -> &'static str {
        match self {
            Self::Pose if channel > 2 => "rad",
            Self::PositionAndForce if channel > 2 => "m/s2",
            Self::Position | Self::Pose | Self::PositionAndForce => "m",
            Self::SpecificForce => "m/s2",
            Self::Angle => "rad",
        }
    }
    /// Whether a channel is a specific force.
    #[must_use]
    pub fn is_force(self, channel: usize) -> bool {
        self == Self::SpecificForce || self == Self::PositionAndForce && channel > 2
    }
}

/// Track of a body without attitude, or of a rigid one in free flight: times (may be uneven) and what was measured; tunnel axes, X down.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PointRecord {
    /// Sample times, s, increasing.
    pub t_s: Vec<f64>,
    /// Position series along tunnel X, Y, Z, m; an axis that was not measured is absent. Of other measurements see `measured`.
    pub position_m: [Option<Vec<f64>>; 3],
    /// Specific force along tunnel X, Y, Z beside the position, m/s², at the same times; absent along an axis that has none.
    pub specific_force_m_s2: [Option<Vec<f64>>; 3],
    /// Attitude of a rigid body at every time as a unit quaternion `[w, x, y, z]`, tunnel from body; empty of other bodies.
    pub attitude: Vec<[f64; 4]>,
    /// What the series are; of an angle the first alone is there.
    pub measured: Measured,
    /// Run inputs that were recorded row by row, by their place in [`crate::Campaign::inputs`]; the others are constant.
    pub recorded_inputs: Vec<(usize, Vec<f64>)>,
    /// What this run's body and air have otherwise than the campaign's: index in [`crate::PLANT_NUMBERS`], and the difference.
    pub own_departures: Vec<(usize, f64)>,
    /// This run's drag coefficient over Mach number, where it is not the campaign's.
    pub drag_over_mach: Option<CoefficientTable>,
    /// Recording that this run is a window of. Windows of one recording are one witness.
    pub recording: Option<String>,
}

impl PointRecord {
    /// The series by their axes; the unit is that of [`Measured::unit`].
    #[must_use]
    pub fn series(&self) -> &[Option<Vec<f64>>; 3] {
        &self.position_m
    }
    /// The series of a channel of [`Measured::names`]; none of a rigid body's attitude.
    #[must_use]
    pub fn channel(&self, channel: usize) -> Option<&[f64]> {
        self.position_m.iter().chain(&self.specific_force_m_s2).nth(channel)?.as_deref()
    }
    /// A plant with what this run has of its own: settings, numbers of body and air, drag.
    #[must_use]
    pub fn plant(&self, plant: &Plant, run: usize, inputs: &[f64]) -> Plant {
        let mut own = plant.for_run(run, inputs);
        for (i, departure) in &self.own_departures {
            if let Some(x) = (PLANT_NUMBERS[*i].lens)(&mut own) {
                *x += departure;
            }
        }
        if let Some(table) = &self.drag_over_mach {
            own.point.drag_over_mach = Some(table.clone());
        }
        own
    }
}
