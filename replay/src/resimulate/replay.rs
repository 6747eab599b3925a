//! replay: a recorded run made ready to be flown again. In: a record and the plant as it acts in that run. Out: flights from
//! any release with the recorded tunnel speed, and what the instruments would have said of them.

use crate::ReplayError;
use windfall_model::frames::{EulerXyz, Rotation};
use windfall_model::{Flight, Numerics, Plant, Record, Release, Sensors, TunnelSpeed};
use windfall_pid::smooth::{Smoothed, Smoother, smooth};
use windfall_pid::states::{State, states};
use windfall_sim::{Flown, Seed, SimError, fly};

/// A run that can be flown again.
///
/// Tunnel speed: the recorded V_W, smoothed with the other channels (knots by cross-validation), its delay and scale and the error of
/// the clock undone as the plant's sensors have them. Raw samples will not do: their noise has a derivative that would act through α̇ and apparent
/// mass. Static pressure and temperature are the means of the record.
#[derive(Clone, Debug)]
pub struct Replay {
    plant: Plant,
    still: Plant,
    flight: Flight,
    first: Release,
    smoother: Smoother,
    states: Vec<State>,
}

impl Replay {
    /// Smooths the record. The plant must already be the one of this run ([`Plant::for_run`]).
    ///
    /// # Errors
    /// A record that cannot be smoothed or has no flow variables.
    pub fn new(record: &Record, plant: &Plant) -> Result<Self, ReplayError> {
        let smoothed = smooth(record, &Smoother::Auto)?;
        let states = states(&smoothed, plant)?;
        let first = release(&states[0]);
        let mut plant = plant.clone();
        plant.sensors = measured_noise(&smoothed, &plant.sensors);
        let still = Plant {
            turbulence: windfall_model::Turbulence::default(),
            shedding: Default::default(),
            drift: Default::default(),
            scatter: Default::default(),
            ..plant.clone()
        };
        let flight = order(record, &states, first, 1.0 + plant.sensors.time_base);
        // The knots that cross-validation found, so that a simulated run goes through the same smoothing.
        let smoother = Smoother::Spline { knot_s: 0.5 / smoothed.bandwidth_hz[0] };
        Ok(Self { plant, still, flight, first, smoother, states })
    }
    /// The same run with another plant's aerodynamics.
    pub(crate) fn with(&self, plant: &Plant) -> Self {
        let mut other = self.clone();
        other.plant.aero.clone_from(&plant.aero);
        other.still.aero.clone_from(&plant.aero);
        other
    }
    /// The plant's instruments, as noisy as the record.
    pub(crate) fn sensors(&self) -> Sensors {
        self.plant.sensors
    }
    /// The flight from a release, with noisy instruments, as a study flies it.
    #[must_use]
    pub fn order(&self, release: Release) -> Flight {
        Flight { release, sensor_noise: true, ..self.flight.clone() }
    }
    /// State at the first sample, from the smoothed record.
    #[must_use]
    pub fn first(&self) -> Release {
        self.first
    }
    /// Smoothed states of the run.
    #[must_use]
    pub fn states(&self) -> &[State] {
        &self.states
    }
    /// The smoothing that the run had, for others to have the same.
    #[must_use]
    pub fn smoother(&self) -> &Smoother {
        &self.smoother
    }
    /// The flight from a release, noise-free instruments and no chance: gusts and shedding, whose histories are not recorded,
    /// are left out, so that this is the mean of what the plant predicts to first order.
    ///
    /// # Errors
    /// A flight that cannot be flown or fails.
    pub fn fly(&self, release: Release) -> Result<Flown, SimError> {
        fly(&self.still, &Flight { release, ..self.flight.clone() }, Seed::default())
    }
    /// The beginning of [`Replay::fly`], of so many samples.
    pub(crate) fn fly_beginning(&self, release: Release, samples: usize) -> Result<Flown, SimError> {
        let duration_s = (samples - 1) as f64 / self.flight.rate_hz;
        fly(&self.still, &Flight { release, duration_s, ..self.flight.clone() }, Seed::default())
    }
    /// [`Replay::fly`], and when the flight fails the part of it before that.
    ///
    /// # Errors
    /// A flight that cannot even start.
    pub fn fly_as_far_as_it_goes(&self, release: Release) -> Result<Flown, SimError> {
        self.as_far_as_it_goes(&self.still, Flight { release, ..self.flight.clone() }, Seed::default())
    }
    /// One draw of what the plant predicts: with its random inputs, and with instruments as noisy as those of the record.
    ///
    /// # Errors
    /// As [`Replay::fly_as_far_as_it_goes`].
    pub fn draw(&self, release: Release, seed: Seed) -> Result<Flown, SimError> {
        self.as_far_as_it_goes(&self.plant, Flight { release, sensor_noise: true, ..self.flight.clone() }, seed)
    }

    fn as_far_as_it_goes(&self, plant: &Plant, mut flight: Flight, seed: Seed) -> Result<Flown, SimError> {
        loop {
            match fly(plant, &flight, seed) {
                Err(
                    SimError::NotFinite { t_s, .. }
                    | SimError::StepTooSmall { t_s }
                    | SimError::TooManySteps { t_s, .. }
                    | SimError::Runaway { t_s, .. },
                ) if t_s.min(flight.duration_s) > 2.0 / flight.rate_hz => {
                    let samples = (0.9 * t_s.min(flight.duration_s) * flight.rate_hz).floor();
                    flight.duration_s = samples / flight.rate_hz;
                }
                other => return other,
            }
        }
    }
}

fn release(s: &State) -> Release {
    Release { position_m: s.p_tunnel_cm, velocity_m_s: s.v_tunnel_cm, attitude_rad: s.euler_rad, rates_rad_s: s.pqr }
}

/// `ticks`: recorded seconds per true one.
fn order(record: &Record, states: &[State], release: Release, ticks: f64) -> Flight {
    let mean = |x: &[f64]| x.iter().sum::<f64>() / x.len() as f64;
    let interval_s = record.interval_s() / ticks;
    Flight {
        name: String::new(),
        kind: String::new(),
        used: windfall_model::Use::Identify,
        duration_s: interval_s * (record.len() - 1) as f64,
        rate_hz: 1.0 / interval_s,
        release,
        speed: TunnelSpeed::History { interval_s, vw_m_s: states.iter().map(|s| s.vw).collect() },
        ps_pa: mean(&record.ps_pa),
        ts_k: mean(&record.ts_k),
        section: None,
        numerics: Numerics::default(),
        sensor_noise: false,
        pushes: Vec::new(),
        window_s: None,
    }
}

/// The plant's sensors with the noise that smoothing found in this record, so that a draw is as noisy as the measurement.
fn measured_noise(s: &Smoothed, sensors: &Sensors) -> Sensors {
    let [x, y, z, rx, ry, rz, vw] = s.noise_std;
    Sensors {
        position_std_m: ((x * x + y * y + z * z) / 3.0).sqrt(),
        roll_std_rad: rx,
        pitch_yaw_std_rad: (0.5 * (ry * ry + rz * rz)).sqrt(),
        wind_std_m_s: vw,
        ..*sensors
    }
}

/// An attitude turned by small angles about body x, y, z; the roll stays near what it was.
pub(crate) fn turned(attitude_rad: [f64; 3], by_rad: [f64; 3]) -> [f64; 3] {
    let r = |[rx_rad, ry_rad, rz_rad]: [f64; 3]| EulerXyz { rx_rad, ry_rad, rz_rad }.r_tunnel_body();
    let turn: Rotation<windfall_model::frames::Body, windfall_model::frames::Body> = Rotation::from_matrix(r(by_rad).matrix);
    let e = EulerXyz::from_rotation(r(attitude_rad) * turn);
    let near = |angle: f64, to: f64| angle + std::f64::consts::TAU * ((to - angle) / std::f64::consts::TAU).round();
    [near(e.rx_rad, attitude_rad[0]), e.ry_rad, near(e.rz_rad, attitude_rad[2])]
}

#[cfg(test)]
mod tests;
