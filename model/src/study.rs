//! model: a study, many draws around one setup. In: checked numbers of a study file. Out: the order that the loop carries out.

use crate::effects::Effect;
use crate::knowledge::Knowledge;
use crate::plant::Plant;
use crate::quantity::PlantNumber;
use crate::scenario::{Flight, TunnelSpeed};
use nalgebra::DMatrix;

/// One number of a setup that a study may vary.
#[derive(Clone, Copy, Debug)]
pub enum Quantity {
    /// A number of the plant.
    Plant(&'static PlantNumber),
    /// A number of a flight.
    Flight(fn(&mut Flight) -> Option<&mut f64>, Angle),
    /// Aerodynamic parameter of that index in the structure.
    Aero(usize),
    /// Parameter (second) of the study's effect (first).
    Effect(usize, usize),
}

/// Whether a number is an angle, given in degrees and held in radians.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Angle {
    /// Degrees outside, radians inside.
    Degrees,
    /// The same number outside and inside.
    No,
}

impl Angle {
    fn inside(self, value: f64) -> f64 {
        if self == Self::Degrees { value.to_radians() } else { value }
    }
}

macro_rules! flight {
    ($f:ident => $e:expr) => {
        flight!($f => $e, Angle::No)
    };
    ($f:ident => $e:expr, $angle:expr) => {
        Quantity::Flight(
            |$f| {
                let x: &mut f64 = $e;
                Some(x)
            },
            $angle,
        )
    };
}
macro_rules! operator {
    ($o:ident => $e:expr) => {
        Quantity::Flight(
            |f| match &mut f.speed {
                TunnelSpeed::Operator($o) => {
                    let x: &mut f64 = $e;
                    Some(x)
                }
                _ => None,
            },
            Angle::No,
        )
    };
}

/// What may vary beside the declared numbers of the plant ([`crate::PLANT_NUMBERS`]), aerodynamic parameters and effects: key of the
/// scenario file, its component if it has several, and where it is held. Unit and range are the key's.
pub const FLIGHT_QUANTITIES: [(&str, &str, Quantity); 24] = [
    ("environment.static_pressure_pa", "", flight!(f => &mut f.ps_pa)),
    ("environment.static_temperature_k", "", flight!(f => &mut f.ts_k)),
    ("flight.duration_s", "", flight!(f => &mut f.duration_s)),
    ("flight.release.position_m", "X", flight!(f => &mut f.release.position_m[0])),
    ("flight.release.position_m", "Y", flight!(f => &mut f.release.position_m[1])),
    ("flight.release.position_m", "Z", flight!(f => &mut f.release.position_m[2])),
    ("flight.release.velocity_m_s", "X", flight!(f => &mut f.release.velocity_m_s[0])),
    ("flight.release.velocity_m_s", "Y", flight!(f => &mut f.release.velocity_m_s[1])),
    ("flight.release.velocity_m_s", "Z", flight!(f => &mut f.release.velocity_m_s[2])),
    ("flight.release.attitude_deg", "Rx", flight!(f => &mut f.release.attitude_rad[0], Angle::Degrees)),
    ("flight.release.attitude_deg", "Ry", flight!(f => &mut f.release.attitude_rad[1], Angle::Degrees)),
    ("flight.release.attitude_deg", "Rz", flight!(f => &mut f.release.attitude_rad[2], Angle::Degrees)),
    ("flight.release.rates_deg_s", "p", flight!(f => &mut f.release.rates_rad_s[0], Angle::Degrees)),
    ("flight.release.rates_deg_s", "q", flight!(f => &mut f.release.rates_rad_s[1], Angle::Degrees)),
    ("flight.release.rates_deg_s", "r", flight!(f => &mut f.release.rates_rad_s[2], Angle::Degrees)),
    (
        "flight.speed.constant.vw_m_s",
        "",
        Quantity::Flight(
            |f| match &mut f.speed {
                TunnelSpeed::Constant(v) => Some(v),
                _ => None,
            },
            Angle::No,
        ),
    ),
    ("flight.speed.operator.trim_m_s", "", operator!(o => o.trim_m_s.as_mut()?)),
    ("flight.speed.operator.height_gain_per_s", "", operator!(o => &mut o.height_gain_per_s)),
    ("flight.speed.operator.rate_gain", "", operator!(o => &mut o.rate_gain)),
    ("flight.speed.operator.integral_gain_per_s2", "", operator!(o => &mut o.integral_gain_per_s2)),
    ("flight.speed.operator.lag_s", "", operator!(o => &mut o.lag_s)),
    ("flight.speed.operator.unsteady_rms_m_s", "", operator!(o => &mut o.unsteady_rms_m_s)),
    ("flight.speed.operator.unsteady_time_s", "", operator!(o => &mut o.unsteady_time_s)),
    ("flight.speed.operator.hold_x_m", "", operator!(o => &mut o.hold_x_m)),
];

/// Lower triangle L of a matrix L·Lᵀ.
pub type Root = DMatrix<f64>;

/// How a number is drawn. Values in the unit of the quantity's name.
#[derive(Clone, Debug, PartialEq)]
pub enum Distribution {
    /// Normal, cut at `low` and `high` (infinite: not cut).
    Normal {
        /// Mean of the uncut distribution.
        mean: f64,
        /// Standard deviation of the uncut distribution, above zero.
        std: f64,
        /// Nothing below.
        low: f64,
        /// Nothing above.
        high: f64,
    },
    /// Uniform between two numbers.
    Uniform {
        /// Smallest.
        low: f64,
        /// Largest.
        high: f64,
    },
    /// `median · exp(sigma · z)`, z standard normal.
    LogNormal {
        /// Median; its sign is that of every draw.
        median: f64,
        /// Standard deviation of the logarithm, above zero.
        sigma: f64,
    },
    /// One of these, each as likely.
    Choice {
        /// Values, at least one.
        values: Vec<f64>,
    },
}

/// One thing that varies.
#[derive(Clone, Debug)]
pub struct Vary {
    /// Name as in the study file, e.g. `aero.Cm_2`; with a list of flights its first is added.
    pub name: String,
    /// What it is.
    pub quantity: Quantity,
    /// Indices of the flights concerned; empty: all.
    pub flights: Vec<usize>,
    /// How it is drawn.
    pub distribution: Distribution,
    /// Allowed values of the quantity, inclusive; a draw outside is a failed draw.
    pub range: [f64; 2],
    /// True when the declared model knows each draw's value, as of a mass that was weighed; false when it stays nominal.
    pub known: bool,
}

/// Recorded tunnel speeds of which each draw takes one.
#[derive(Clone, Debug, PartialEq)]
pub struct Histories {
    /// Indices of the flights concerned; empty: all.
    pub flights: Vec<usize>,
    /// The histories, each as likely.
    pub speeds: Vec<TunnelSpeed>,
}

/// An effect in the truth.
#[derive(Clone, Copy, Debug)]
pub struct StudyEffect {
    /// Of the catalogue.
    pub effect: &'static Effect,
    /// Index of its values in [`StudyOrder::effect_values`].
    pub index: usize,
}

/// What is done to each draw after it is flown.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Steps {
    /// Methods to identify with, by name.
    pub identify: Vec<String>,
    /// Whether each identified model is flown against the draw's runs (hold-out ones where there are any).
    pub resimulate: bool,
    /// Whether the loop is closed.
    pub close: bool,
}

/// What is kept of each draw beside its number, its failure and what was varied.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Keep {
    /// Duration and Table 5.6's statistics of each flight's truth.
    pub flights: bool,
    /// Estimate, error, standard error and whether the interval covers the truth.
    pub estimates: bool,
    /// Ends of the 95 % intervals.
    pub intervals: bool,
    /// Errors of the re-simulation.
    pub resimulation: bool,
    /// Verdict, effects and their numbers.
    pub closing: bool,
}

/// When a study may end before all draws: the asked-for quantity is known well enough.
#[derive(Clone, Debug, PartialEq)]
pub struct StopRule {
    /// Column of the results: of a number the mean is asked for, of a flag the rate.
    pub column: String,
    /// Half width of the 95 % interval that is enough, in the column's unit.
    pub half_width: f64,
    /// Fewest draws.
    pub least_draws: u64,
}

/// Where draws start from.
#[derive(Clone, Debug)]
pub struct StudyOrder {
    /// Name.
    pub name: String,
    /// Seed of all chance.
    pub seed: u64,
    /// Number of draws.
    pub draws: u64,
    /// Draws in each part of the results.
    pub part_draws: u64,
    /// True plant without effects.
    pub plant: Plant,
    /// What the made campaigns declare: plant.
    pub declared_plant: Plant,
    /// What the made campaigns declare: which parameters.
    pub declared: Vec<bool>,
    /// What the made campaigns declare: uncertainties.
    pub knowledge: Knowledge,
    /// Effects in the truth, in the order that they are applied.
    pub effects: Vec<StudyEffect>,
    /// Their values.
    pub effect_values: Vec<Vec<f64>>,
    /// Flights of each draw, sensor noise as each says.
    pub flights: Vec<Flight>,
    /// What varies.
    pub vary: Vec<Vary>,
    /// Lower triangle L with L·Lᵀ the correlation of the normals behind `vary`; empty when they are independent.
    pub correlation_root: Root,
    /// Tunnel-speed histories.
    pub histories: Option<Histories>,
    /// What is done.
    pub steps: Steps,
    /// What is kept.
    pub keep: Keep,
    /// When it may end.
    pub stop: Option<StopRule>,
}

impl StudyOrder {
    /// Lower triangle L of the correlation matrix with these entries off its diagonal; none when no such matrix exists (it is not
    /// positive definite).
    #[must_use]
    pub fn root_of_correlation(size: usize, entries: &[(usize, usize, f64)]) -> Option<Root> {
        let mut matrix = DMatrix::identity(size, size);
        for &(i, j, r) in entries {
            matrix[(i, j)] = r;
            matrix[(j, i)] = r;
        }
        matrix.cholesky().map(|c| c.l())
    }
}

/// What one draw flies: the plant without effects, effects' values and flights.
#[derive(Clone, Debug)]
pub struct DrawnSetup {
    /// Plant without effects.
    pub plant: Plant,
    /// Values of effects, as [`StudyOrder::effect_values`].
    pub effect_values: Vec<Vec<f64>>,
    /// Flights.
    pub flights: Vec<Flight>,
}

impl DrawnSetup {
    /// Puts a value in its place; false when the setup has no such number (no tether, another kind of tunnel speed).
    pub fn set(&mut self, quantity: Quantity, flights: &[usize], value: f64) -> bool {
        let place = |at: Option<&mut f64>, value: f64| at.map(|x| *x = value).is_some();
        match quantity {
            Quantity::Plant(n) => place((n.lens)(&mut self.plant), n.inside(value)),
            Quantity::Aero(i) => place(self.plant.aero.values.get_mut(i), value),
            Quantity::Effect(i, j) => place(self.effect_values.get_mut(i).and_then(|v| v.get_mut(j)), value),
            Quantity::Flight(at, angle) => {
                let chosen = |i: &usize| flights.is_empty() || flights.contains(i);
                let mut all = true;
                for (_, flight) in self.flights.iter_mut().enumerate().filter(|(i, _)| chosen(i)) {
                    all &= place(at(flight), angle.inside(value));
                }
                all
            }
        }
    }
}

/// What a column of results holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CellKind {
    /// A number, or nothing.
    Number,
    /// True, false or nothing.
    Flag,
    /// Words.
    Word,
}

/// A column of results.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Column {
    /// Name.
    pub name: String,
    /// What it holds.
    pub kind: CellKind,
}

/// One entry of a row.
#[derive(Clone, Debug, PartialEq)]
pub enum Cell {
    /// A number, or nothing.
    Number(Option<f64>),
    /// True, false or nothing.
    Flag(Option<bool>),
    /// Words, or none.
    Word(String),
}

impl Cell {
    /// Number of a cell: a flag counts 0 or 1; none of words or of nothing.
    #[must_use]
    pub fn number(&self) -> Option<f64> {
        match self {
            Self::Number(x) => *x,
            Self::Flag(x) => x.map(|b| f64::from(u8::from(b))),
            Self::Word(_) => None,
        }
    }
    /// Nothing, of a kind.
    #[must_use]
    pub fn empty(kind: CellKind) -> Self {
        match kind {
            CellKind::Number => Self::Number(None),
            CellKind::Flag => Self::Flag(None),
            CellKind::Word => Self::Word(String::new()),
        }
    }
}

/// Result of one draw: one cell per column.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Number of the draw.
    pub draw: u64,
    /// Cells.
    pub cells: Vec<Cell>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_correlation_root() {
        let l = StudyOrder::root_of_correlation(2, &[(0, 1, 0.6)]).expect("positive definite");
        // L = [[1, 0], [r, sqrt(1 - r²)]]; 0.6 and 0.8 are exact to rounding
        assert!((l[(1, 0)] - 0.6).abs() < 1e-15 && (l[(1, 1)] - 0.8).abs() < 1e-15);
        assert!(StudyOrder::root_of_correlation(3, &[(0, 1, 0.9), (1, 2, 0.9), (0, 2, -0.9)]).is_none());
    }
}
