//! replay: Appendix C as a check. In: a known plant and a flight. Out: how far the identifier's states, coefficients and parameters
//! are from what was flown.

use crate::ReplayError;
use serde::{Deserialize, Serialize};
use windfall_model::frames::{Rotation, Vec3};
use windfall_model::{AirState, Campaign, Flight, FlowState, Knowledge, Motion, Plant, Record, Run};
use windfall_pid::coefficients::coefficients;
use windfall_pid::output_error::EstimateOptions;
use windfall_pid::smooth::smooth;
use windfall_pid::states::{State, states};
use windfall_pid::{Identification, Method, identify_by};
use windfall_sim::{Flown, Seed, Smooth, Truth, fly};

/// Thesis Table C.1: coefficient, parameter, estimate, percent error as printed.
pub const TABLE_C_1: [(&str, &str, f64, f64); 13] = [
    ("CA", "CA_T0", 6.6622, 0.00),
    ("CN", "CN_sin", 3.4740, 1.11),
    ("CN", "CN_sin3", -2.1405, 6.84),
    ("Cl", "Cl_0", 0.0118, 5.60),
    ("Cl", "Cl_p", -5.3758, 5.38),
    ("Cm", "Cm_sin", -2.0706, 0.25),
    ("Cm", "Cm_sin3", 2.5067, 0.83),
    ("Cm", "Cm_1", -3.3947, 2.79),
    ("Cm", "Cm_2", -200.7541, 2.28),
    ("Cn", "Cm_sin", -2.0688, 0.16),
    ("Cn", "Cm_sin3", 2.4105, 4.64),
    ("Cn", "Cn_1", -3.3710, 2.07),
    ("Cn", "Cn_2", -202.3803, 1.48),
];

/// One parameter, planted and found.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Recovered {
    /// Coefficient from whose data it is.
    pub coefficient: String,
    /// Parameter name.
    pub name: String,
    /// What was flown.
    pub truth: f64,
    /// What was found.
    pub estimate: f64,
    /// Relative error, percent of the truth; of one where the truth is zero.
    pub percent_error: f64,
    /// The thesis' own error on its own run (Table C.1), percent.
    pub thesis_percent_error: Option<f64>,
}

/// Largest error of one quantity over a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Reconstructed {
    /// The quantity.
    pub quantity: String,
    /// Its unit.
    pub unit: String,
    /// Largest error over the run.
    pub largest_error: f64,
    /// Largest size of the truth over the run.
    pub largest: f64,
}

/// Result of a recovery.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Recovery {
    /// Method.
    pub method: String,
    /// Parameters, in the order of Table C.1.
    pub parameters: Vec<Recovered>,
    /// States (Figure C.2).
    pub states: Vec<Reconstructed>,
    /// Coefficients at the geometric origin (Figure C.3).
    pub coefficients: Vec<Reconstructed>,
}

/// Flies a plant, gives the identifier the record alone (its declared parameters at zero), and compares with the truth.
///
/// # Errors
/// A flight or an identification that fails.
pub fn recover(plant: &Plant, flight: &Flight, seed: Seed, method: Method) -> Result<Recovery, ReplayError> {
    recover_by(plant, flight, seed, method, &EstimateOptions::default())
}

/// [`recover`], with options of the method.
///
/// # Errors
/// As [`recover`].
pub fn recover_by(
    plant: &Plant,
    flight: &Flight,
    seed: Seed,
    method: Method,
    options: &EstimateOptions,
) -> Result<Recovery, ReplayError> {
    let flown = fly(plant, flight, seed)?;
    let campaign = campaign_of(plant, &[(flight, flown.record.clone())]);
    let found = identify_by(&campaign, method, options)?;
    let smoother = options.smoother.clone().unwrap_or_else(|| method.smoother());
    let seen = states(&smooth(&flown.record, &smoother)?, plant)?;
    Ok(Recovery {
        method: found.method.clone(),
        parameters: parameters_of(plant, &found),
        states: compare_states(&seen, &flown.truth),
        coefficients: compare_coefficients(&seen, plant, flight, &flown),
    })
}

/// A campaign of flown records whose declared plant has the structure of the flown one, and zeros for values.
#[must_use]
pub fn campaign_of(plant: &Plant, flights: &[(&Flight, Record)]) -> Campaign {
    let mut declared = plant.clone();
    declared.aero.values.fill(0.0);
    let runs = flights.iter().map(|(flight, record)| Run::of_flight(flight, record.clone())).collect();
    let all = vec![true; declared.aero.values.len()];
    Campaign::of_flights("own flights", &declared, &all, &Knowledge::default(), runs)
}

/// Estimates of the combined data set beside the truth and Table C.1.
#[must_use]
pub fn parameters_of(plant: &Plant, found: &Identification) -> Vec<Recovered> {
    let estimates = found.of_all_runs().map_or(&[][..], |d| &d.parameters);
    estimates
        .iter()
        .filter_map(|p| {
            let truth = plant.aero.value(&p.name)?;
            let scale = if truth == 0.0 { 1.0 } else { truth.abs() };
            let printed = TABLE_C_1.iter().find(|(c, n, ..)| *c == p.coefficient && *n == p.name);
            Some(Recovered {
                coefficient: p.coefficient.clone(),
                name: p.name.clone(),
                truth,
                estimate: p.estimate,
                percent_error: 100.0 * (p.estimate - truth) / scale,
                thesis_percent_error: printed.map(|l| l.3),
            })
        })
        .collect()
}

/// Collects largest errors by quantity.
struct Worst {
    all: Vec<Reconstructed>,
}

impl Worst {
    fn new(quantities: &[(&str, &str)]) -> Self {
        let one = |(q, u): &(&str, &str)| Reconstructed {
            quantity: (*q).to_owned(),
            unit: (*u).to_owned(),
            largest_error: 0.0,
            largest: 0.0,
        };
        Self { all: quantities.iter().map(one).collect() }
    }
    fn see(&mut self, k: usize, found: f64, truth: f64) {
        let r = &mut self.all[k];
        r.largest_error = r.largest_error.max((found - truth).abs());
        r.largest = r.largest.max(truth.abs());
    }
}

fn compare_states(seen: &[State], truth: &Truth) -> Vec<Reconstructed> {
    let mut w = Worst::new(&[
        ("c.m. position", "m"),
        ("c.m. velocity", "m/s"),
        ("p", "rad/s"),
        ("q", "rad/s"),
        ("r", "rad/s"),
        ("airspeed", "m/s"),
        ("alpha_T", "rad"),
    ]);
    for (i, s) in seen.iter().enumerate().take(truth.len()) {
        for k in 0..3 {
            w.see(0, s.p_tunnel_cm[k], truth.p_tunnel_cm[i][k]);
            w.see(1, s.v_tunnel_cm[k], truth.v_tunnel_cm[i][k]);
            w.see(2 + k, s.pqr[k], truth.w_tunnel_body[i][k]);
        }
        w.see(5, s.speed, truth.airspeed_m_s[i]);
        w.see(6, s.alpha_t, truth.alpha_t_rad[i]);
    }
    w.all
}

fn compare_coefficients(seen: &[State], plant: &Plant, flight: &Flight, flown: &Flown) -> Vec<Reconstructed> {
    let mut w = Worst::new(&[("CA", "1"), ("CY", "1"), ("CN", "1"), ("Cl", "1"), ("Cm", "1"), ("Cn", "1")]);
    let rows = coefficients(seen, plant);
    for (row, flow) in rows.iter().zip(true_flow(plant, flight, &flown.truth)) {
        let truth = plant.aero.coefficients(&flow);
        for (k, (found, truth)) in row.exp_origin.iter().zip(truth).enumerate() {
            w.see(k, *found, truth);
        }
    }
    w.all
}

/// True flow variables, from the simulator's velocities and rates; their derivatives by the seven nearest samples.
fn true_flow(plant: &Plant, flight: &Flight, truth: &Truth) -> Vec<FlowState> {
    let dt = 1.0 / flight.rate_hz;
    let rate = |series: &[[f64; 3]]| -> [Smooth; 3] {
        std::array::from_fn(|k| Smooth::new(dt, &series.iter().map(|v| v[k]).collect::<Vec<_>>()))
    };
    let (a, w_rate, vw) = (rate(&truth.v_tunnel_cm), rate(&truth.w_tunnel_body), Smooth::new(dt, &truth.vw_m_s));
    let density_kg_m3 = plant.environment.density_kg_m3(flight.ps_pa, flight.ts_k);
    (0..truth.len())
        .map(|i| {
            let t_s = truth.t_s[i];
            let motion = Motion {
                t_s,
                p_tunnel_cm: Vec3::from_array(truth.p_tunnel_cm[i]),
                v_tunnel_cm: Vec3::from_array(truth.v_tunnel_cm[i]),
                r_tunnel_body: Rotation::from_quaternion(truth.quaternion[i]),
                w_tunnel_body: Vec3::from_array(truth.w_tunnel_body[i]),
                a_tunnel_cm: Vec3::new(a[0].at(t_s).1, a[1].at(t_s).1, a[2].at(t_s).1),
                w_tunnel_body_rate: Vec3::new(w_rate[0].at(t_s).1, w_rate[1].at(t_s).1, w_rate[2].at(t_s).1),
            };
            let air = AirState { vw_m_s: truth.vw_m_s[i], vw_rate_m_s2: vw.at(t_s).1, density_kg_m3, ..AirState::default() };
            plant.flow_state(&motion, &air).0
        })
        .collect()
}
