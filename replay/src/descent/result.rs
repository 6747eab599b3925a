//! replay: what many descents say. Out: the content of `descent.json`.

use super::landing::LandingScatter;
use super::linear::SteadyFall;
use serde::{Deserialize, Serialize};

/// Many descents of an identified model.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DescentSummary {
    /// Scenario.
    pub scenario: String,
    /// Its flight.
    pub flight: String,
    /// Method and data set of the identification; none where the scenario's own coefficients were flown.
    pub model: Option<DescentModel>,
    /// Descents flown, the nominal one apart.
    pub draws: u64,
    /// Seed.
    pub seed: u64,
    /// Step of integration and of the gusts, s.
    pub step_s: f64,
    /// Whether each drawn model was flown twice, through other gusts and from another start, which parts the two sources of scatter.
    pub in_pairs: bool,
    /// What was drawn.
    pub parameters: Vec<DrawnParameter>,
    /// How the descents ended.
    pub ends: DescentEnds,
    /// Quantities at touch-down.
    pub touch_down: Vec<TouchDownLine>,
    /// Where the descents came down; none of fewer than three.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub landing: Option<LandingScatter>,
    /// Quantities over height.
    pub over_height: Vec<HeightLine>,
    /// Linear theory of the nominal model over height; empty in a vacuum.
    pub linear_theory: Vec<SteadyFall>,
    /// What a user should know.
    pub warnings: Vec<String>,
}

/// Where the coefficients are from.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DescentModel {
    /// Method of the identification.
    pub method: String,
    /// Its data set.
    pub data_set: String,
}

/// A number that was drawn.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DrawnParameter {
    /// Parameter of the aerodynamics, or key of the vehicle.
    pub name: String,
    /// Estimated or declared value.
    pub nominal: f64,
    /// Standard error or declared standard uncertainty.
    pub std: f64,
}

/// How descents ended. A descent that tumbles and lands counts in both.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct DescentEnds {
    /// Reached the ground.
    pub landed: u64,
    /// Total angle of attack above 90° somewhere.
    pub tumbled: u64,
    /// Still aloft when the flight's duration ended.
    pub aloft: u64,
    /// Could not be flown.
    pub failed: u64,
    /// Why, most frequent first.
    pub reasons: Vec<DescentReason>,
}

/// Why descents failed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DescentReason {
    /// Message of the first of them.
    pub reason: String,
    /// How many.
    pub count: u64,
}

/// A quantity at touch-down over the descents that landed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TouchDownLine {
    /// Quantity with its unit.
    pub quantity: String,
    /// Of the nominal model in even air from the exact start; none where it did not land.
    pub nominal: Option<f64>,
    /// Mean.
    pub mean: f64,
    /// Standard deviation.
    pub std: f64,
    /// Quantiles 0.025, 0.5, 0.975 (Hyndman and Fan 1996, type 7).
    pub low: f64,
    /// Median.
    pub median: f64,
    /// Upper end.
    pub high: f64,
    /// Standard deviation that the uncertain parameters make, gusts and start averaged.
    pub std_of_parameters: f64,
    /// Standard deviation that gusts and start make.
    pub std_of_flight: f64,
    /// Share of the variance that is the parameters' (Homma and Saltelli 1996), with its 95 % interval.
    pub share_of_parameters: f64,
    /// That interval.
    pub share_ci95: [f64; 2],
    /// Share of the variance that is linear in the parameters, R² of the regression.
    pub share_linear: f64,
    /// Parameters, the one it hangs on most first.
    pub parameters: Vec<ParameterShare>,
}

/// How much a quantity hangs on a parameter.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ParameterShare {
    /// Parameter.
    pub name: String,
    /// Share of the quantity's variance that would go if the parameter were known exactly, and with it what it says of those that are
    /// correlated with it: first-order index Var(E[Y|θ])/Var(Y) of a linear relation (Saltelli and others 2008, §1.2.4, 4.5), less
    /// its expectation without any relation; zero where chance makes as large a one for some parameter of one quantity in twenty.
    pub share: f64,
    /// Sign of the relation, −1 or 1.
    pub sign: i8,
    /// Change of the quantity by one standard deviation of the parameter, the others held, over the quantity's standard deviation:
    /// standardised regression coefficient (Saltelli and others 2008, §1.2.5).
    pub standardised: f64,
    /// Standard deviation of the quantity that would be left if the parameter were known exactly.
    pub std_if_known: f64,
}

/// A quantity over height.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct HeightLine {
    /// Quantity with its unit.
    pub quantity: String,
    /// Heights, m, highest first.
    pub height_m: Vec<f64>,
    /// Descents that came there.
    pub draws: Vec<u64>,
    /// Of the nominal model.
    pub nominal: Vec<Option<f64>>,
    /// Means.
    pub mean: Vec<f64>,
    /// Standard deviations.
    pub std: Vec<f64>,
    /// Quantile 0.025.
    pub low: Vec<f64>,
    /// Median.
    pub median: Vec<f64>,
    /// Quantile 0.975.
    pub high: Vec<f64>,
}
