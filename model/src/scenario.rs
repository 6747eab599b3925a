//! model: what to fly. In: checked numbers of a scenario file. Out: the order that the simulator carries out.

use crate::plant::{Contact, Plant};
use crate::record::Record;
use crate::run_use::Use;

/// How the tunnel speed comes about.
#[derive(Clone, Debug, PartialEq)]
pub enum TunnelSpeed {
    /// A given history, uniform in time from t = 0; interpolated smoothly and held beyond its ends.
    History {
        /// Sample interval, s.
        interval_s: f64,
        /// Speeds, m/s.
        vw_m_s: Vec<f64>,
    },
    /// An operator who throttles to hold the model's height.
    Operator(Operator),
    /// Constant speed, m/s; 0 for a drop in still air.
    Constant(f64),
}

/// Operator and fan: a lagged proportional-integral-derivative hand on the model's height, unsteady by itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Operator {
    /// Speed around which the hand works, m/s; `None`: the plant's trim speed.
    pub trim_m_s: Option<f64>,
    /// Height gain, (m/s)/m: speed rises when the model sinks (X grows).
    pub height_gain_per_s: f64,
    /// Gain on the rate of sinking, (m/s)/(m/s).
    pub rate_gain: f64,
    /// Integral gain, (m/s)/(m s).
    pub integral_gain_per_s2: f64,
    /// First-order lag of hand and fan, s.
    pub lag_s: f64,
    /// rms of the unsteady hand, m/s, before the lag.
    pub unsteady_rms_m_s: f64,
    /// Correlation time of the unsteady hand, s.
    pub unsteady_time_s: f64,
    /// Height that is held, tunnel X of the c.m., m.
    pub hold_x_m: f64,
}

/// State at the first sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Release {
    /// c.m. position, tunnel axes, m.
    pub position_m: [f64; 3],
    /// c.m. velocity, tunnel axes, m/s.
    pub velocity_m_s: [f64; 3],
    /// R_x, R_y, R_z, rad.
    pub attitude_rad: [f64; 3],
    /// p, q, r, rad/s.
    pub rates_rad_s: [f64; 3],
}

/// Integrator.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Integrator {
    /// Dormand-Prince 5(4) with dense output.
    Dopri5,
    /// Dormand-Prince 8(5,3) with dense output.
    Dop853,
}

/// Numerical settings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Numerics {
    /// Integrator.
    pub method: Integrator,
    /// Relative tolerance.
    pub relative_tolerance: f64,
    /// Absolute tolerance, SI.
    pub absolute_tolerance: f64,
}

impl Default for Numerics {
    fn default() -> Self {
        Self { method: Integrator::Dop853, relative_tolerance: 1e-9, absolute_tolerance: 1e-11 }
    }
}

/// Walls and nets: the run ends when the c.m. leaves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TestSection {
    /// Largest horizontal distance from the axis, m (10 ft less the model's reach).
    pub radius_m: f64,
    /// Tunnel X of the upper net, m (negative).
    pub top_x_m: f64,
    /// Tunnel X of the lower net, m.
    pub bottom_x_m: f64,
}

impl Default for TestSection {
    /// NASA Langley 20-ft Vertical Spin Tunnel, 25 ft high and 20 ft wide (thesis Table 2.1), model at mid-height.
    fn default() -> Self {
        Self { radius_m: 3.048, top_x_m: -3.81, bottom_x_m: 3.81 }
    }
}

/// One flight to simulate.
#[derive(Clone, Debug, PartialEq)]
pub struct Flight {
    /// Name of the run it makes.
    pub name: String,
    /// Kind, as in campaign files.
    pub kind: String,
    /// Use in the campaign that a scenario of several flights makes.
    pub used: Use,
    /// Duration, s.
    pub duration_s: f64,
    /// Sample rate, Hz.
    pub rate_hz: f64,
    /// State at the first sample.
    pub release: Release,
    /// Tunnel speed.
    pub speed: TunnelSpeed,
    /// Static pressure, Pa.
    pub ps_pa: f64,
    /// Static temperature, K.
    pub ts_k: f64,
    /// Where the run must stay.
    pub section: Option<TestSection>,
    /// Integrator settings.
    pub numerics: Numerics,
    /// Whether sensor noise is added to the record.
    pub sensor_noise: bool,
    /// Pushes of a pole; the number of the run in each is not looked at.
    pub pushes: Vec<Contact>,
    /// The part of the record that a campaign made of the flight uses, s from the first sample, first and last included; none: all.
    pub window_s: Option<[f64; 2]>,
}

impl Flight {
    /// The part of this flight's record that its campaign uses: a window, which still knows its recording, where the flight has one that
    /// leaves two samples.
    #[must_use]
    pub fn used_part(&self, record: Record) -> Record {
        let Some([from, to]) = self.window_s else { return record };
        let near = 1e-6 * record.interval_s();
        let first = record.t_s.partition_point(|t| *t < from - near);
        let end = record.t_s.partition_point(|t| *t <= to + near);
        if end < first + 2 { record } else { record.window(first..end) }
    }
}

/// A scenario: a true plant, what a campaign made of it declares, and flights.
#[derive(Clone, Debug, PartialEq)]
pub struct Scenario {
    /// Name.
    pub name: String,
    /// What is flown, effects included.
    pub plant: Plant,
    /// Families of the effects in the plant, for the resolved file.
    pub effects: Vec<String>,
    /// Flights, in order.
    pub flights: Vec<Flight>,
    /// Seed of all chance.
    pub seed: u64,
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flight(window_s: Option<[f64; 2]>) -> Flight {
        Flight {
            name: "run".to_owned(),
            kind: "perturbed".to_owned(),
            used: Use::Identify,
            duration_s: 1.0,
            rate_hz: 10.0,
            release: Release { position_m: [0.0; 3], velocity_m_s: [0.0; 3], attitude_rad: [0.0; 3], rates_rad_s: [0.0; 3] },
            speed: TunnelSpeed::Constant(7.0),
            ps_pa: 1e5,
            ts_k: 300.0,
            section: None,
            numerics: Numerics::default(),
            sensor_noise: false,
            pushes: Vec::new(),
            window_s,
        }
    }

    /// First and last sample of a window are in it, also where tenths are no binary numbers; the recording is still known.
    #[test]
    fn exact_window_of_a_record() {
        let series = || (0..=10).map(|i| 0.1 * f64::from(i)).collect::<Vec<f64>>();
        let three = || std::array::from_fn(|_| series());
        let whole = Record {
            t_s: series(),
            position_m: three(),
            attitude_rad: three(),
            vw_m_s: series(),
            ps_pa: series(),
            ts_k: series(),
            ..Record::default()
        };
        assert_eq!(flight(None).used_part(whole.clone()), whole);
        let part = flight(Some([0.3, 0.7])).used_part(whole.clone());
        assert_eq!(part.t_s, whole.t_s[3..=7]);
        assert_eq!(part.recording.map(|r| (r.rows, r.whole.len())), Some((3..8, 11)));
        // A flight that ended early has all of it.
        assert_eq!(flight(Some([2.0, 3.0])).used_part(whole.clone()), whole);
    }
}
