//! model: what a campaign knows of itself beyond its numbers. In: the declaring file. Out: uncertain constants, declared effects.

use crate::effects::Effect;
use crate::plant::Plant;
use crate::wind_tunnel::StaticPoints;
use std::fmt;

/// A number of the plant that is known with an uncertainty (JCGM 100:2008, 2.3.1). Numbers without one are exact.
#[derive(Clone, Copy)]
pub struct Constant {
    /// Key of the campaign file with its table, e.g. `vehicle.center_of_mass_m`.
    pub key: &'static str,
    /// Component of a key that has several, e.g. `x`; empty otherwise.
    pub component: &'static str,
    /// SI unit of the number and its uncertainty, `rad` of angles, `-` for none.
    pub unit: &'static str,
    /// The number in a plant; none when the plant has no such part.
    pub lens: fn(&mut Plant) -> Option<&mut f64>,
    /// Standard uncertainty (1 σ) of the declared value, in `unit`, above zero.
    pub std: f64,
}

impl Constant {
    /// Key and component as one word, e.g. `vehicle.center_of_mass_m.x`.
    #[must_use]
    pub fn name(&self) -> String {
        if self.component.is_empty() { self.key.to_owned() } else { format!("{}.{}", self.key, self.component) }
    }
    /// The declared value in this plant.
    #[must_use]
    pub fn value(&self, plant: &Plant) -> Option<f64> {
        (self.lens)(&mut plant.clone()).map(|x| *x)
    }
}

/// Two are the same when they are the same number with the same uncertainty.
impl PartialEq for Constant {
    fn eq(&self, other: &Self) -> bool {
        (self.key, self.component, self.std.to_bits()) == (other.key, other.component, other.std.to_bits())
    }
}

/// Without the lens, whose address differs from one run of the program to the next.
impl fmt::Debug for Constant {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Constant({} ± {:?} {})", self.name(), self.std, self.unit)
    }
}

/// What a campaign knows of its constants, parameters, effects and noise.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Knowledge {
    /// Constants that are uncertain, each once.
    pub constants: Vec<Constant>,
    /// Effects that the declared model has, each once, with starting values in the order of its parameters. They are not in
    /// [`crate::Campaign::plant`].
    pub effects: Vec<(&'static Effect, Vec<f64>)>,
    /// Effects that a check of the records has seen, which nobody declared: a search begins with them.
    pub seen: Vec<(&'static Effect, Vec<f64>)>,
    /// Standard uncertainty of the declared starting value of an aerodynamic parameter, by its index in the structure: what was
    /// believed of it before the runs.
    pub priors: Vec<(usize, f64)>,
    /// Whether the declared noise of the instruments is exact; otherwise it is a first belief, and learnt from the record.
    pub exact_noise: bool,
    /// Static coefficients of wind-tunnel tests, for comparison alone.
    pub wind_tunnel: Vec<StaticPoints>,
}
