//! replay: how near a simulated run is to the measured one. In: series of both. Out: rms errors, and Table 5.6's statistics.

use serde::{Deserialize, Serialize};
use windfall_model::Record;
use windfall_model::frames::{Body, EulerXyz, Rotation, Tunnel};

/// rms differences of simulation and measurement over a run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TrajectoryError {
    /// Angle of the rotation between measured and simulated attitude, deg; sensor noise of Table A.3 alone gives 0.17.
    pub attitude_rms_deg: f64,
    /// Distance of the geometric origins, m; sensor noise alone gives 0.0013.
    pub position_rms_m: f64,
    /// Length of the difference of body rates, both smoothed alike, deg/s.
    pub rate_rms_deg_s: f64,
}

/// One line of the thesis' Table 5.6.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Statistic {
    /// `theta_deg` (off-vertical angle Θ, eq. 5.1) or `omega_qr_deg_s` (pitch and yaw rate ω_q,r, eq. 5.2).
    pub quantity: String,
    /// `mean`, `median` or `std`.
    pub statistic: String,
    /// From the measurement.
    pub test: f64,
    /// From the simulation: the mean over seeds.
    pub simulation: f64,
    /// Standard deviation over seeds; absent with one seed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub simulation_std: Option<f64>,
    /// 95 % interval over draws of parameters, gusts and sensor noise; absent without draws.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub draws_ci95: Option<[f64; 2]>,
}

/// Θ and ω_q,r at the samples, in degrees.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Swing {
    /// Off-vertical angle Θ, deg.
    pub theta_deg: Vec<f64>,
    /// Pitch and yaw rate ω_q,r, deg/s.
    pub omega_qr_deg_s: Vec<f64>,
}

impl Swing {
    /// Appends another run's samples.
    pub(crate) fn append(&mut self, other: &Self) {
        self.theta_deg.extend_from_slice(&other.theta_deg);
        self.omega_qr_deg_s.extend_from_slice(&other.omega_qr_deg_s);
    }
}

/// The six numbers of Table 5.6.
pub(crate) fn table(s: &Swing) -> [f64; 6] {
    let [a, b, c] = mean_median_std(&s.theta_deg);
    let [d, e, f] = mean_median_std(&s.omega_qr_deg_s);
    [a, b, c, d, e, f]
}

/// Layout of Table 5.6.
pub(crate) const LINES: [(&str, &str); 6] = [
    ("theta_deg", "mean"),
    ("theta_deg", "median"),
    ("theta_deg", "std"),
    ("omega_qr_deg_s", "mean"),
    ("omega_qr_deg_s", "median"),
    ("omega_qr_deg_s", "std"),
];

/// Table 5.6 of a test and of one simulation per seed.
pub(crate) fn table_5_6(test: &Swing, simulations: &[Swing]) -> Vec<Statistic> {
    let (test, seeds): ([f64; 6], Vec<[f64; 6]>) = (table(test), simulations.iter().map(table).collect());
    LINES
        .iter()
        .enumerate()
        .map(|(k, (quantity, statistic))| {
            let over_seeds: Vec<f64> = seeds.iter().map(|s| s[k]).collect();
            let [simulation, _, std] = mean_median_std(&over_seeds);
            Statistic {
                quantity: (*quantity).to_owned(),
                statistic: (*statistic).to_owned(),
                test: test[k],
                simulation,
                simulation_std: (over_seeds.len() > 1).then_some(std),
                draws_ci95: None,
            }
        })
        .collect()
}

/// Mean, median and standard deviation (n − 1 in its denominator); zeros of nothing.
#[must_use]
pub fn mean_median_std(x: &[f64]) -> [f64; 3] {
    if x.is_empty() {
        return [0.0; 3];
    }
    let n = x.len() as f64;
    let mean = x.iter().sum::<f64>() / n;
    let variance = x.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0).max(1.0);
    let mut parted = x.to_vec();
    let (below, upper, _) = parted.select_nth_unstable_by(x.len() / 2, f64::total_cmp);
    let lower = if x.len() % 2 == 1 { *upper } else { below.iter().copied().max_by(f64::total_cmp).unwrap_or(*upper) };
    [mean, 0.5 * (lower + *upper), variance.sqrt()]
}

/// Sums of squared differences, so that runs can be joined.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Squares {
    samples: f64,
    attitude_rad2: f64,
    position_m2: f64,
    rate2: f64,
}

impl Squares {
    /// Of a measured and a simulated record with their body rates, as far as the shorter goes.
    pub(crate) fn new(measured: &Record, pqr: &[[f64; 3]], simulated: &Record, simulated_pqr: &[[f64; 3]]) -> Self {
        let n = measured.len().min(simulated.len()).min(pqr.len()).min(simulated_pqr.len());
        let mut s = Self { samples: n as f64, ..Self::default() };
        let square = |a: [f64; 3], b: [f64; 3]| a.iter().zip(b).map(|(x, y)| (x - y) * (x - y)).sum::<f64>();
        for i in 0..n {
            s.attitude_rad2 += attitude(measured, i).angle_to(attitude(simulated, i)).powi(2);
            s.position_m2 += square(place(measured, i), place(simulated, i));
            s.rate2 += square(pqr[i], simulated_pqr[i]);
        }
        s
    }
    pub(crate) fn add(&mut self, o: &Self) {
        self.samples += o.samples;
        self.attitude_rad2 += o.attitude_rad2;
        self.position_m2 += o.position_m2;
        self.rate2 += o.rate2;
    }
    pub(crate) fn error(&self) -> TrajectoryError {
        let rms = |sum: f64| (sum / self.samples.max(1.0)).sqrt();
        TrajectoryError {
            attitude_rms_deg: rms(self.attitude_rad2).to_degrees(),
            position_rms_m: rms(self.position_m2),
            rate_rms_deg_s: rms(self.rate2).to_degrees(),
        }
    }
}

/// Errors at each sample, as far as the shorter record goes; rates are left out (zero).
#[must_use]
pub fn instant_errors(measured: &Record, simulated: &Record) -> Vec<TrajectoryError> {
    (0..measured.len().min(simulated.len()))
        .map(|i| {
            let (a, b) = (place(measured, i), place(simulated, i));
            TrajectoryError {
                attitude_rms_deg: attitude(measured, i).angle_to(attitude(simulated, i)).to_degrees(),
                position_rms_m: a.iter().zip(b).map(|(x, y)| (x - y) * (x - y)).sum::<f64>().sqrt(),
                rate_rms_deg_s: 0.0,
            }
        })
        .collect()
}

fn place(r: &Record, i: usize) -> [f64; 3] {
    std::array::from_fn(|k| r.position_m[k][i])
}

fn attitude(r: &Record, i: usize) -> Rotation<Tunnel, Body> {
    let [rx, ry, rz] = &r.attitude_rad;
    EulerXyz { rx_rad: rx[i], ry_rad: ry[i], rz_rad: rz[i] }.r_tunnel_body()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_statistics_of_a_few_numbers() {
        // By hand: mean 3, median 2.5, variance (4 + 1 + 0 + 9)/3.
        let [mean, median, std] = mean_median_std(&[1.0, 2.0, 3.0, 6.0]);
        assert!((mean - 3.0).abs() < 1e-15 && (median - 2.5).abs() < 1e-15 && (std - (14.0_f64 / 3.0).sqrt()).abs() < 1e-15);
        assert!((mean_median_std(&[5.0, 1.0, 2.0])[1] - 2.0).abs() < 1e-15);
    }

    #[test]
    fn exact_errors_of_a_turned_and_shifted_record() {
        let record = |y: f64, rz: f64| Record {
            t_s: vec![0.0, 0.1],
            position_m: [vec![0.0; 2], vec![y; 2], vec![0.0; 2]],
            attitude_rad: [vec![0.3; 2], vec![0.2; 2], vec![rz; 2]],
            vw_m_s: vec![7.0; 2],
            ps_pa: vec![1e5; 2],
            ts_k: vec![300.0; 2],
            ..Record::default()
        };
        // At any R_x and R_y a change of R_z alone turns by that angle.
        let part = Squares::new(&record(0.0, 0.1), &[[0.0; 3]; 2], &record(0.03, 0.15), &[[0.0, 0.3, 0.4]; 2]);
        let e = part.error();
        assert!((e.position_rms_m - 0.03).abs() < 1e-15);
        assert!((e.attitude_rms_deg - 0.05_f64.to_degrees()).abs() < 1e-12);
        assert!((e.rate_rms_deg_s - 0.5_f64.to_degrees()).abs() < 1e-12);
        // Two equal parts say what one says.
        let mut twice = part;
        twice.add(&part);
        let t = twice.error();
        let pairs = [
            (t.position_rms_m, e.position_rms_m),
            (t.attitude_rms_deg, e.attitude_rms_deg),
            (t.rate_rms_deg_s, e.rate_rms_deg_s),
        ];
        assert!(pairs.iter().all(|(both, one)| (both / one - 1.0).abs() < 1e-14), "{pairs:?}");
    }

    /// Places (1, 2, −3) and (4, −2, 9) are √(9 + 16 + 144) = 13 apart; the shorter record has one sample.
    #[test]
    fn exact_errors_at_an_instant() {
        let record = |p: [f64; 3], rx: f64, samples: usize| Record {
            position_m: p.map(|x| vec![x; samples]),
            attitude_rad: [vec![rx; samples], vec![0.2; samples], vec![-0.4; samples]],
            t_s: vec![0.0; samples],
            ..Record::default()
        };
        let e = instant_errors(&record([1.0, 2.0, -3.0], 0.1, 2), &record([4.0, -2.0, 9.0], 0.1, 1));
        assert!(e.len() == 1 && (e[0].position_rms_m - 13.0).abs() < 1e-14 && e[0].attitude_rms_deg < 1e-5, "{e:?}");
    }
}
