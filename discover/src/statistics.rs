//! discover: closing against published statistics. In: a declared plant, a run, a few published figures. Out: the effects of the
//! catalogue that could produce them, alone and in pairs, with intervals, and what these figures cannot decide.
//!
//! Simulated moments with common random numbers (McFadden, Econometrica 57, 1989; Pakes and Pollard, Econometrica 57, 1989): the
//! figures of simulated runs are compared with the published ones, differences weighted by their covariance over runs. One
//! published run is one draw from that distribution, so an explanation is rejected by where the run lies in it (Hansen's J with a
//! simulated distribution), not by how far its mean is off.
//!
//! Which effects are looked at follows from screening flights over each effect's plausible range; none is known by name.

mod ensemble;
mod hypothesis;
mod judge;
mod search;
mod table;

pub use search::close_statistics;
pub use table::statistics_table;

use serde::Serialize;
use windfall_model::{Flight, Integrator, Numerics, Plant};
use windfall_pid::PidError;
use windfall_sim::SimError;

/// What a figure is a statistic of. Θ and ω_q,r are thesis eqs 5.1 and 5.2.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum FigureQuantity {
    /// Off-vertical angle Θ, deg.
    #[serde(rename = "theta_deg")]
    Theta,
    /// Pitch and yaw rate ω_q,r, deg/s.
    #[serde(rename = "omega_qr_deg_s")]
    OmegaQr,
    /// Pitch rate q, deg/s.
    #[serde(rename = "q_deg_s")]
    PitchRate,
    /// Yaw rate r, deg/s.
    #[serde(rename = "r_deg_s")]
    YawRate,
}

/// Which statistic over the samples of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum Moment {
    /// Mean.
    #[serde(rename = "mean")]
    Mean,
    /// Median.
    #[serde(rename = "median")]
    Median,
    /// Standard deviation.
    #[serde(rename = "std")]
    Std,
    /// Largest size.
    #[serde(rename = "max")]
    LargestSize,
}

impl FigureQuantity {
    /// Name in files and reports.
    #[must_use]
    pub const fn name(self) -> &'static str {
        ["theta_deg", "omega_qr_deg_s", "q_deg_s", "r_deg_s"][self as usize]
    }
    /// The quantity of that name.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        [Self::Theta, Self::OmegaQr, Self::PitchRate, Self::YawRate].into_iter().find(|q| q.name() == name)
    }
}

impl Moment {
    /// Name in files and reports.
    #[must_use]
    pub const fn name(self) -> &'static str {
        ["mean", "median", "std", "max"][self as usize]
    }
    /// The statistic of that name.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        [Self::Mean, Self::Median, Self::Std, Self::LargestSize].into_iter().find(|m| m.name() == name)
    }
}

/// One published figure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StatisticFigure {
    /// Of what.
    pub quantity: FigureQuantity,
    /// Which statistic.
    pub statistic: Moment,
    /// Test, deg or deg/s.
    pub test: f64,
    /// The source's own simulation, when printed.
    pub simulation: Option<f64>,
    /// Fitted; otherwise only held against the result.
    pub fitted: bool,
}

/// What is closed: made by [`StatisticsSetup::new`], which checks it.
#[derive(Clone, Debug)]
pub struct StatisticsSetup {
    name: String,
    source: String,
    seed: u64,
    plant: Plant,
    /// The run as described.
    flight: Flight,
    /// As it is flown: without walls, with the tolerances of the options.
    flown: Flight,
    figures: Vec<StatisticFigure>,
}

impl StatisticsSetup {
    /// Checks the figures. `plant` is the declared one, `flight` the run, `seed` that of all chance.
    ///
    /// # Errors
    /// A figure that is not a positive number, or none to fit.
    pub fn new(
        (name, source): (&str, &str),
        seed: u64,
        plant: Plant,
        flight: Flight,
        figures: Vec<StatisticFigure>,
    ) -> Result<Self, StatisticsError> {
        for f in &figures {
            if !(f.test.is_finite() && f.test > 0.0) {
                return Err(StatisticsError::Figure {
                    quantity: f.quantity.name(),
                    statistic: f.statistic.name(),
                    value: f.test,
                });
            }
        }
        if !figures.iter().any(|f| f.fitted) {
            return Err(StatisticsError::NothingToFit);
        }
        let flown = Flight { section: None, ..flight.clone() };
        Ok(Self { name: name.to_owned(), source: source.to_owned(), seed, plant, flight, flown, figures })
    }
    fn fitted(&self) -> Vec<usize> {
        (0..self.figures.len()).filter(|&i| self.figures[i].fitted).collect()
    }
    fn test_row(&self) -> Vec<f64> {
        self.figures.iter().map(|f| f.test).collect()
    }
}

/// Why statistics could not be closed.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StatisticsError {
    /// A flight of the declared model failed.
    #[error("a simulated run failed: {0}")]
    Simulate(#[from] SimError),
    /// A record could not be processed.
    #[error("a simulated record could not be processed: {0}")]
    Process(#[from] PidError),
    /// A published figure makes no sense.
    #[error("figure {statistic} of {quantity} is {value}; it must be a finite number above zero; check the file")]
    Figure {
        /// Of what.
        quantity: &'static str,
        /// Which.
        statistic: &'static str,
        /// Value.
        value: f64,
    },
    /// No figure has `use = "fit"`.
    #[error("no figure is fitted; give at least one use = \"fit\"")]
    NothingToFit,
    /// Too few runs for a covariance of the figures.
    #[error("{what} = {runs} is too few for the covariance of {figures} figures; allowed: {needed} or more")]
    TooFewRuns {
        /// Option.
        what: &'static str,
        /// Its value.
        runs: u64,
        /// Number of figures.
        figures: usize,
        /// Least.
        needed: u64,
    },
}

/// How much is flown. Results are the same for any number of threads.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct StatisticsOptions {
    /// Points over each effect's plausible range that are screened.
    pub screen_points: usize,
    /// Runs at each.
    pub screen_runs: u64,
    /// Points over the range of a second effect, tried beside the first.
    pub pair_points: usize,
    /// Pairs, at most, that are searched: those that come nearest at these points.
    pub pairs: usize,
    /// Effects, at most, that are searched alone: those that close most of the gap.
    pub leads: usize,
    /// Runs at each step of the coarse search.
    pub coarse_runs: u64,
    /// Steps of each search for each parameter.
    pub steps_per_parameter: usize,
    /// Runs at each step of the fine search.
    pub fine_runs: u64,
    /// Explanations that are judged: so many effects alone, which lead the pairs, and so many pairs.
    pub kept: [usize; 2],
    /// Fresh runs by which an explanation is judged.
    pub final_runs: u64,
    /// Relative tolerance of the integrator; the absolute one is a hundredth.
    pub relative_tolerance: f64,
}

impl Default for StatisticsOptions {
    fn default() -> Self {
        Self {
            screen_points: 16,
            screen_runs: 2,
            pair_points: 32,
            pairs: 12,
            leads: 5,
            coarse_runs: 6,
            steps_per_parameter: 8,
            fine_runs: 24,
            kept: [2, 4],
            final_runs: 200,
            relative_tolerance: 1e-4,
        }
    }
}

/// What screening said about one effect.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Screened {
    /// Family.
    pub family: &'static str,
    /// Largest change of a fitted figure over the plausible range, in standard deviations over runs of the declared model's.
    pub largest_change: f64,
    /// Share of the gap between declared model and test (rms of log ratios) that the best point closes.
    pub gap_closed: f64,
    /// Changes the figures: takes part in pairs.
    pub moves: bool,
    /// Closes part of the gap alone: searched alone and leads pairs.
    pub leads: bool,
}

/// One figure of a distribution over runs, beside the test.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FigureOver {
    /// Of what.
    pub quantity: FigureQuantity,
    /// Which statistic.
    pub statistic: Moment,
    /// Fitted; otherwise only held against it.
    pub fitted: bool,
    /// Test.
    pub test: f64,
    /// Mean over runs.
    pub mean: f64,
    /// Standard deviation over runs.
    pub std: f64,
    /// 5 % and 95 % quantile over runs.
    pub central90: [f64; 2],
    /// Smallest over runs, then every quantile in steps of 5 %, then the largest.
    pub quantiles: [f64; 21],
    /// Mean over test, less one.
    pub relative: f64,
    /// The test lies inside the central 90 %.
    pub inside: bool,
}

/// A parameter of an explanation.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Estimated {
    /// Family of its effect.
    pub family: &'static str,
    /// Name.
    pub name: String,
    /// Unit.
    pub unit: &'static str,
    /// Estimate.
    pub estimate: f64,
    /// Interval of 95 %, inside the plausible range.
    pub ci95: [f64; 2],
    /// False when the interval reaches over more than half of the plausible range (in the scale of search).
    pub decided: bool,
}

/// Effects that may produce the figures, as well as they can.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Explanation {
    /// Families.
    pub families: Vec<&'static str>,
    /// Parameters.
    pub parameters: Vec<Estimated>,
    /// Figures over the final runs.
    pub figures: Vec<FigureOver>,
    /// Hansen's J of the published run: squared distance in spreads over runs that the parameters cannot absorb.
    pub j: f64,
    /// Figures left to judge by.
    pub degrees: usize,
    /// Share of simulated runs that lie at least as far out.
    pub p_value: f64,
    /// Not rejected at level 5 %.
    pub possible: bool,
    /// Every fitted test value is inside the central 90 % and every mean over runs within 15 % of it.
    pub closes: bool,
    /// Minus twice the normal log likelihood of the published run, plus two for each direction of parameters that it decides
    /// (Akaike 1974; Wood, Nature 466, 2010): smaller is better.
    pub score: f64,
    /// Share of runs that would have left the test section before their end.
    pub left_section: f64,
}

/// How well one run of these figures tells explanations apart.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FigureSeparation {
    /// If this is true,
    pub truth: Vec<&'static str>,
    /// this is rejected at level 5 %
    pub other: Vec<&'static str>,
    /// in this share of runs.
    pub power: f64,
}

/// One simulated run over time, from its record as the figures are.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SimulatedHistory {
    /// Families that are added; none of the declared model.
    pub families: Vec<&'static str>,
    /// Number of the run; the same in every history, so that chance is the same.
    pub run: u64,
    /// Time, s; at most 600 samples.
    pub t_s: Vec<f64>,
    /// Off-vertical angle Θ, deg.
    pub theta_deg: Vec<f64>,
    /// Pitch and yaw rate ω_q,r, deg/s.
    pub omega_qr_deg_s: Vec<f64>,
}

/// The result.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StatisticsClosing {
    /// `effect` when an explanation closes, `unexplained` when none does, `consistent` when the declared model is possible.
    pub verdict: &'static str,
    /// Name of the file.
    pub name: String,
    /// Where the figures are printed.
    pub source: String,
    /// Options that were used.
    pub options: StatisticsOptions,
    /// Seed.
    pub seed: u64,
    /// Numbers of the runs of the search and of the judgement.
    pub search_runs: [u64; 2],
    /// First and one past the last.
    pub final_runs: [u64; 2],
    /// The source's own simulation, in the order of the figures.
    pub source_simulation: Vec<Option<f64>>,
    /// The declared model.
    pub before: Vec<FigureOver>,
    /// Probability of the test under the declared model.
    pub before_p_value: f64,
    /// Every effect's screening.
    pub screened: Vec<Screened>,
    /// Explanations: those that close first, then those that remain possible, then the rest, each by score.
    pub explanations: Vec<Explanation>,
    /// What one run tells apart, among those that close or are possible.
    pub separations: Vec<FigureSeparation>,
    /// Largest relative difference that instruments and smoothing make to each figure's mean in the best explanation.
    pub processing: Vec<f64>,
    /// One run of the declared model and the same of the best explanation.
    pub histories: Vec<SimulatedHistory>,
    /// Simulated runs flown.
    pub flights: u64,
    /// What the figures decide and what they do not, in words.
    pub conclusions: Vec<String>,
}

fn numerics(relative: f64) -> Numerics {
    // Gusts are rough: fifth order follows them with fewer evaluations than eighth.
    Numerics { method: Integrator::Dopri5, relative_tolerance: relative, absolute_tolerance: 0.01 * relative }
}

#[cfg(test)]
mod tests;
