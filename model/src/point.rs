//! model: bodies without attitude (balls, rockets), free or on a pivot. In: numbers of a declared model. Out: plain data; their acceleration is
//! the plant's.

use crate::acts::Acts;
use crate::frames::{Tunnel, Vec3};
use crate::planet::Atmosphere;

/// A coefficient over one variable: linear between its points, held beyond their ends.
///
/// ```
/// use windfall_model::CoefficientTable;
///
/// let drag = CoefficientTable::new(vec![0.0, 0.8, 1.2], vec![0.4, 0.5, 0.9]).expect("ascends");
/// assert!((drag.value(0.4) - 0.45).abs() < 1e-15);
/// assert_eq!(drag.value(3.0), 0.9);
/// assert!(CoefficientTable::new(vec![1.0, 0.0], vec![0.4, 0.5]).is_none());
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct CoefficientTable {
    at: Vec<f64>,
    values: Vec<f64>,
}

impl CoefficientTable {
    /// A table; `None` unless there are two points or more, as many values, abscissas that ascend, and all finite.
    #[must_use]
    pub fn new(at: Vec<f64>, values: Vec<f64>) -> Option<Self> {
        let finite = at.iter().chain(&values).all(|x| x.is_finite());
        (at.len() >= 2 && at.len() == values.len() && finite && at.windows(2).all(|w| w[0] < w[1])).then_some(Self { at, values })
    }
    /// Its least and its largest coefficient.
    #[must_use]
    pub fn ends(&self) -> [f64; 2] {
        self.values.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| [low.min(*v), high.max(*v)])
    }
    /// The coefficient there.
    #[must_use]
    pub fn value(&self, x: f64) -> f64 {
        let i = self.at.partition_point(|a| *a <= x).clamp(1, self.at.len() - 1);
        let share = ((x - self.at[i - 1]) / (self.at[i] - self.at[i - 1])).clamp(0.0, 1.0);
        self.values[i - 1] + share * (self.values[i] - self.values[i - 1])
    }
}

/// A pivot with a level axis that holds the body, so that one angle says where it is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pivot {
    /// Distance of the mass centre from the axis, m.
    pub arm_m: f64,
    /// Moment of inertia about the mass centre, along the axis, kg m².
    pub inertia_kg_m2: f64,
    /// Torque against the rate of turning, N m s (per rad/s).
    pub viscous_n_m_s: f64,
    /// Torque of dry friction, N m: against the rate, whatever its size.
    pub dry_n_m: f64,
}

/// Ratio of specific heats of a gas of two-atom molecules (air).
const HEAT_RATIO: f64 = 1.4;

/// The air around a body at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointAir {
    /// Density, kg/m³.
    pub density_kg_m3: f64,
    /// Speed of sound, m/s; infinite where the campaign declares no atmosphere, so that the Mach number is zero.
    pub sound_m_s: f64,
}

/// What acts on a point mass beyond gravity and drag; all zero in a declared model. Axes: tunnel (X down).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PointMass {
    /// Lift coefficient per unit of each run input, in the order of the campaign's input names. The lift is
    /// `q S C_L (h × v)/|v|` with h the horizontal unit vector across the launch, so that positive lifts.
    pub lift_per_input: Vec<f64>,
    /// Increment of the drag coefficient per unit of each run input, in the same order.
    pub drag_per_input: Vec<f64>,
    /// Lift coefficient that does not depend on inputs.
    pub lift_constant: f64,
    /// Sideways coefficient per unit of each run input (a spin axis that leans), positive along `X × v`: to tunnel +Z for a
    /// flight along +Y.
    pub side_per_input: Vec<f64>,
    /// Sideways coefficient that does not depend on inputs.
    pub side_constant: f64,
    /// Constant acceleration, m/s², tunnel axes.
    pub acceleration: Vec3<Tunnel>,
    /// Air mass that the body drags along, as a fraction of the displaced air (0.5 for a sphere in potential flow).
    pub apparent_fraction: f64,
    /// Buoyancy as a fraction of the displaced air's weight (1: Archimedes).
    pub buoyancy_fraction: f64,
    /// This run's settings.
    pub inputs: Vec<f64>,
    /// Density of the still air, kg/m³, as the campaign gives it; with an atmosphere that at the launch.
    pub air_density_kg_m3: f64,
    /// How the air thins and cools over height; none: the same density everywhere.
    pub atmosphere: Option<Atmosphere>,
    /// Height of the launch (position X of zero) in that atmosphere, m.
    pub launch_height_m: f64,
    /// Drag coefficient over Mach number, which the structure's parameter is a factor of; none: the parameter is the coefficient.
    pub drag_over_mach: Option<CoefficientTable>,
    /// What holds the body; none: it flies.
    pub pivot: Option<Pivot>,
    /// Square of the horizontal over the vertical speed at the first sample of a run, where no horizontal place is measured; zero: vertical.
    pub slope_squared: f64,
    /// Whether its height is that of a pressure altimeter.
    pub altimeter: bool,
    /// Error of the altimeter's static pressure over the dynamic pressure.
    pub pressure_coefficient: f64,
    /// The same per unit of each run input.
    pub pressure_per_input: Vec<f64>,
}

impl PointMass {
    /// Kind of the body that it is, for the catalogue.
    #[must_use]
    pub fn body(&self) -> Acts {
        match (self.pivot.is_some(), self.altimeter) {
            (true, _) => Acts::Pivot,
            (false, true) => Acts::Altimeter,
            (false, false) => Acts::PointMass,
        }
    }
    /// Sum of a coefficient and what follows this run's settings.
    pub(crate) fn following(&self, constant: f64, per_input: &[f64]) -> f64 {
        constant + per_input.iter().zip(&self.inputs).map(|(k, u)| k * u).sum::<f64>()
    }
    /// The air at a height over the launch, m.
    #[must_use]
    pub fn air(&self, height_m: f64) -> PointAir {
        let Some(atmosphere) = &self.atmosphere else {
            return PointAir { density_kg_m3: self.air_density_kg_m3, sound_m_s: f64::INFINITY };
        };
        let (there, launch) = (atmosphere.at(self.launch_height_m + height_m), atmosphere.at(self.launch_height_m));
        PointAir {
            density_kg_m3: self.air_density_kg_m3 * there.density_kg_m3() / launch.density_kg_m3(),
            sound_m_s: (HEAT_RATIO * there.gas_constant_j_kg_k * there.temperature_k).sqrt(),
        }
    }
}
