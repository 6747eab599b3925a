//! model: random inputs with a known spectrum. In: rms, scale, band. Out: where each enters the equations and its density.
//!
//! The simulator draws them, the tracer uses their cross-spectra; both read the same few numbers.

use std::f64::consts::{PI, SQRT_2};

/// Gusts of the tunnel, of Dryden's form (MIL-F-8785C 1980; Dryden, NACA TR 342, 1930) or limited to a band. Zero rms in a declared model.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Turbulence {
    /// rms along the stream, m/s.
    pub axial_rms_m_s: f64,
    /// rms across it, each axis, m/s.
    pub lateral_rms_m_s: f64,
    /// Integral scale of the longitudinal component, m.
    pub axial_scale_m: f64,
    /// Scale L of the lateral components in the Dryden form, m.
    pub lateral_scale_m: f64,
    /// Half-power bandwidth over centre of gusts that are limited to a band, whose centre is V/(2πL) on each axis; zero: Dryden's form.
    pub bandwidth: f64,
}

/// Moment from vortices shed by the wake: narrow-band about f = St V/d. Zero rms in a declared model.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WakeShedding {
    /// rms of C_m and of C_n, independent.
    pub moment_rms: f64,
    /// Strouhal number f d/V.
    pub strouhal: f64,
    /// Half-power bandwidth over centre frequency.
    pub bandwidth: f64,
}

/// Slow wander of what the instruments show: a first-order process of the time constant [`DRIFT_TIME_S`]. Over much shorter times it is a random
/// walk of rms √(2/T) per root second. Zero rms in a declared model.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Drift {
    /// rms of the recorded position along X, Y and Z, m.
    pub position_rms_m: [f64; 3],
    /// rms of the recorded angles R_x, R_y and R_z, rad.
    pub attitude_rms_rad: [f64; 3],
    /// rms of the recorded tunnel speed, m/s.
    pub speed_rms_m_s: f64,
}

/// Time constant of an instrument's drift, s: of the order of a run, so that it can be told from an offset and from noise.
pub const DRIFT_TIME_S: f64 = 30.0;

/// A number of the plant that each run may have its own value of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RunNumber {
    /// Mass, as a share of the declared one; inertia is as declared.
    Mass,
    /// Place of the tether's attachment along body axis 0 = x, 1 = y, 2 = z, m.
    Attachment(usize),
    /// Parameter of the aerodynamic structure by its place, as a share of its value.
    Aero(usize),
}

/// Where a random input enters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Entry {
    /// Air velocity along tunnel axis 0 = X, 1 = Y, 2 = Z, m/s.
    AirVelocity(usize),
    /// Coefficient by index 0..6 (C_A, C_Y, C_N, C_l, C_m, C_n).
    Coefficient(usize),
    /// The recorded tunnel speed, m/s.
    RecordedSpeed,
    /// A recorded channel of the pose by its place, m or rad.
    RecordedPose(usize),
    /// A number of the plant that each run has another value of.
    Number(RunNumber),
}

/// Linear shaping filter of second order from white noise: `ẍ = −b ẋ − a x + (c₀ + c₁ s) w`, in the form of its density.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// Dryden longitudinal: S(ω) = σ² (2T/π) / (1 + (Tω)²), T = L/V in s.
    DrydenLongitudinal {
        /// Time scale T, s.
        time_s: f64,
    },
    /// Dryden lateral: S(ω) = σ² (T/π) (1 + 3(Tω)²) / (1 + (Tω)²)², T = L/V in s.
    DrydenLateral {
        /// Time scale T, s.
        time_s: f64,
    },
    /// White noise through a maximally flat band-pass filter of second order (Butterworth 1930):
    /// S(ω) = σ² (2√2/(πb)) (bω)⁴ / ((bω)⁴ + (ω₀² − ω²)⁴), half power b (rad/s) wide about ω₀ (rad/s).
    Band {
        /// Geometric centre, rad/s.
        centre_rad_s: f64,
        /// Half-power bandwidth, rad/s.
        bandwidth_rad_s: f64,
    },
    /// Response of a damped oscillator to white noise, centre ω₀ (rad/s), half-power bandwidth b (rad/s).
    Narrow {
        /// Centre, rad/s.
        centre_rad_s: f64,
        /// Half-power bandwidth, rad/s.
        bandwidth_rad_s: f64,
    },
    /// One number for the whole of a run: all of its density is at ω = 0.
    Constant,
}

/// One random input, independent of the others.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disturbance {
    /// Where it enters.
    pub entry: Entry,
    /// Standard deviation, in the entry's unit.
    pub rms: f64,
    /// Spectrum.
    pub shape: Shape,
}

impl Disturbance {
    /// One-sided density per rad/s at ω ≥ 0: its integral over ω from 0 to ∞ is rms².
    #[must_use]
    pub fn density(&self, omega_rad_s: f64) -> f64 {
        let w2 = omega_rad_s * omega_rad_s;
        let unit = match self.shape {
            Shape::DrydenLongitudinal { time_s: t } => (2.0 * t / PI) / (1.0 + t * t * w2),
            Shape::DrydenLateral { time_s: t } => (t / PI) * (1.0 + 3.0 * t * t * w2) / (1.0 + t * t * w2).powi(2),
            Shape::Band { centre_rad_s: c, bandwidth_rad_s: b } => {
                let pass = (b * b * w2).powi(2);
                2.0 * SQRT_2 / (PI * b) * pass / (pass + (c * c - w2).powi(4))
            }
            Shape::Narrow { centre_rad_s: c, bandwidth_rad_s: b } => {
                let c2 = c * c;
                (2.0 / PI) * b * c2 / ((c2 - w2).powi(2) + b * b * w2)
            }
            Shape::Constant => 0.0,
        };
        self.rms * self.rms * unit
    }
    /// State form for simulation.
    #[must_use]
    pub fn filter(&self) -> StateForm {
        let (a, b, c) = match self.shape {
            Shape::DrydenLongitudinal { time_s: t } => {
                ([[-1.0 / t, 0.0], [0.0, -1.0 / t]], [self.rms * (2.0 / t).sqrt(), 0.0], [1.0, 0.0])
            }
            Shape::DrydenLateral { time_s: t } => (
                [[0.0, 1.0], [-1.0 / (t * t), -2.0 / t]],
                [0.0, 1.0],
                [self.rms / (t * t) * t.sqrt(), self.rms * (3.0 * t).sqrt() / t],
            ),
            Shape::Narrow { centre_rad_s: w0, bandwidth_rad_s: bw } => {
                ([[0.0, 1.0], [-w0 * w0, -bw]], [0.0, self.rms * w0 * (2.0 * bw).sqrt()], [1.0, 0.0])
            }
            Shape::Constant => ([[0.0; 2]; 2], [0.0; 2], [1.0, 0.0]),
            Shape::Band { centre_rad_s: w, bandwidth_rad_s: b } => {
                // The output, its rate, its second integral and its first, time in units of 1/ω₀.
                let (wide, damped) = (b / w, SQRT_2 * b);
                return StateForm::Four(ShapingFilter {
                    a: [
                        [0.0, w, 0.0, 0.0],
                        [-w * (2.0 + wide * wide), -damped, -w, -damped],
                        [0.0, 0.0, 0.0, w],
                        [w, 0.0, 0.0, 0.0],
                    ],
                    b: [0.0, self.rms * (2.0 * SQRT_2 * b).sqrt() * wide, 0.0, 0.0],
                    c: [1.0, 0.0, 0.0, 0.0],
                });
            }
        };
        StateForm::Two(ShapingFilter { a, b, c })
    }
}

/// Matrices of `ẋ = A x + B w`, `y = C x`, with `w` white of two-sided density 1 (covariance δ(t)) and the state started from its stationary
/// covariance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShapingFilter<const N: usize> {
    /// State matrix.
    pub a: [[f64; N]; N],
    /// Input column.
    pub b: [f64; N],
    /// Output row.
    pub c: [f64; N],
}

/// A shaping filter by its number of states; of two, the second is unused for a first-order form.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum StateForm {
    /// Dryden's forms and a narrow band.
    Two(ShapingFilter<2>),
    /// A band-pass filter of second order.
    Four(ShapingFilter<4>),
}

impl Turbulence {
    /// The three gust components at mean airspeed `speed`; empty when there is no turbulence.
    #[must_use]
    pub fn disturbances(&self, speed_m_s: f64) -> Vec<Disturbance> {
        let shape = |scale_m: f64, dryden: fn(f64) -> Shape| {
            let centre_rad_s = speed_m_s / scale_m;
            if self.bandwidth > 0.0 {
                Shape::Band { centre_rad_s, bandwidth_rad_s: self.bandwidth * centre_rad_s }
            } else {
                dryden(scale_m / speed_m_s)
            }
        };
        let along = shape(self.axial_scale_m, |time_s| Shape::DrydenLongitudinal { time_s });
        let across = shape(self.lateral_scale_m, |time_s| Shape::DrydenLateral { time_s });
        [(0, self.axial_rms_m_s, along), (1, self.lateral_rms_m_s, across), (2, self.lateral_rms_m_s, across)]
            .into_iter()
            .filter(|(_, rms, _)| *rms > 0.0)
            .map(|(axis, rms, shape)| Disturbance { entry: Entry::AirVelocity(axis), rms, shape })
            .collect()
    }
}

impl WakeShedding {
    /// The two moments at mean airspeed `speed` for diameter `d`; empty when there is no shedding.
    #[must_use]
    pub fn disturbances(&self, speed_m_s: f64, diameter_m: f64) -> Vec<Disturbance> {
        let centre_rad_s = 2.0 * PI * self.strouhal * speed_m_s / diameter_m;
        let one = |index| Disturbance {
            entry: Entry::Coefficient(index),
            rms: self.moment_rms,
            shape: Shape::Narrow { centre_rad_s, bandwidth_rad_s: self.bandwidth * centre_rad_s },
        };
        [one(4), one(5)].into_iter().filter(|d| d.rms > 0.0).collect()
    }
}

impl Drift {
    /// Drift of the six channels of the pose and of the tunnel speed; empty where no instrument drifts.
    #[must_use]
    pub fn disturbances(&self) -> Vec<Disturbance> {
        let pose = self.position_rms_m.into_iter().chain(self.attitude_rms_rad).enumerate();
        pose.map(|(place, rms)| (Entry::RecordedPose(place), rms))
            .chain([(Entry::RecordedSpeed, self.speed_rms_m_s)])
            .filter(|(_, rms)| *rms > 0.0)
            .map(|(entry, rms)| Disturbance { entry, rms, shape: Shape::DrydenLongitudinal { time_s: DRIFT_TIME_S } })
            .collect()
    }
}

/// Standard deviations from run to run. Zero in a declared model.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RunScatter {
    /// Of the mass, as a share of it.
    pub mass: f64,
    /// Of the tether's attachment across the body, along each of y and z, m.
    pub attachment_m: f64,
    /// Of one aerodynamic parameter, as a share of it.
    pub aero: f64,
    /// Place of that parameter in the structure, from 0.
    pub aero_place: f64,
}

impl RunScatter {
    /// The numbers that differ, each with its standard deviation; empty where all runs are alike.
    #[must_use]
    pub fn numbers(&self) -> Vec<(RunNumber, f64)> {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a place in a short list")]
        let place = self.aero_place.round().max(0.0) as usize;
        let all = [
            (RunNumber::Mass, self.mass),
            (RunNumber::Attachment(1), self.attachment_m),
            (RunNumber::Attachment(2), self.attachment_m),
            (RunNumber::Aero(place), self.aero),
        ];
        all.into_iter().filter(|(_, std)| *std > 0.0).collect()
    }

    /// The same as random inputs, in their order.
    #[must_use]
    pub fn disturbances(&self) -> Vec<Disturbance> {
        let input = |(number, rms)| Disturbance { entry: Entry::Number(number), rms, shape: Shape::Constant };
        self.numbers().into_iter().map(input).collect()
    }
}
