//! replay: bodies drawn for descents. In: a scenario, an identification. Out: a body per draw, its uncertain numbers.

use crate::ReplayError;
use crate::joint_errors::JointErrors;
use nalgebra::DMatrix;
use windfall_model::planet::{PlanetBody, PlanetScenario, UncertainNumber};
use windfall_pid::{DataSet, PROCESS_NOISE, PidError, TURBULENCE};
use windfall_sim::{Channel, Seed};

/// What an identification says of the gusts and random moments of its tunnel: nothing of the air elsewhere.
const OF_THE_TUNNEL: [&str; 2] = [TURBULENCE, PROCESS_NOISE];

/// A number that is drawn.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Drawn {
    pub(super) name: String,
    pub(super) nominal: f64,
    pub(super) std: f64,
}

/// Bodies: the nominal one, and how others are drawn about it.
pub(super) struct Bodies {
    pub(super) nominal: PlanetBody,
    /// Uncertain aerodynamic parameters, by their place in the structure, and vehicle numbers after them.
    aero: Vec<usize>,
    vehicle: Vec<UncertainNumber>,
    pub(super) drawn: Vec<Drawn>,
    /// Of all parameters of the structure.
    errors: JointErrors,
    /// Of the identification: kept as declared by the scenario, and as held.
    pub(super) warnings: Vec<String>,
}

impl Bodies {
    pub(super) fn new(scenario: &PlanetScenario, set: Option<&DataSet>) -> Result<Self, ReplayError> {
        let mut nominal = scenario.body.clone();
        let structure = nominal.aero.structure.clone();
        let n = structure.parameters.len();
        let mut warnings = Vec::new();
        let covariance = match set {
            None => DMatrix::zeros(n, n),
            Some(set) => {
                let foreign = |p: &&windfall_pid::Estimate| {
                    !OF_THE_TUNNEL.contains(&p.coefficient.as_str()) && structure.index(&p.name).is_none()
                };
                if let Some(p) = set.parameters.iter().find(foreign) {
                    let allowed = structure.parameters.join(", ");
                    return Err(PidError::OtherStructure { name: p.name.clone(), allowed }.into());
                }
                nominal.aero.values = set.values(&structure, &nominal.aero.values);
                warnings = not_identified(set, &structure.parameters);
                set.covariance_of(&structure).ok_or(ReplayError::NoCovariance)?
            }
        };
        let std = |i: usize| covariance[(i, i)].max(0.0).sqrt();
        let aero: Vec<usize> = (0..n).filter(|i| std(*i) > 0.0).collect();
        let vehicle = scenario.dispersions.vehicle.numbers();
        let of_aero =
            aero.iter().map(|&i| Drawn { name: structure.parameters[i].clone(), nominal: nominal.aero.values[i], std: std(i) });
        let mut drawn: Vec<Drawn> = of_aero.collect();
        for v in &vehicle {
            let nominal = *(v.lens)(&mut nominal.vehicle.clone());
            drawn.push(Drawn { name: v.name.to_owned(), nominal, std: v.std });
        }
        Ok(Self { nominal, aero, vehicle, drawn, errors: JointErrors::new(covariance), warnings })
    }

    /// True when draws differ.
    pub(super) fn is_uncertain(&self) -> bool {
        !self.drawn.is_empty()
    }

    /// The body of a draw, and its numbers in the order of [`Bodies::drawn`].
    pub(super) fn draw(&self, seed: Seed) -> (PlanetBody, Vec<f64>) {
        let mut body = self.nominal.clone();
        self.errors.scatter(&mut body.aero.values, seed.normals(Channel::Varied(0)));
        let mut normals = seed.normals(Channel::Varied(1));
        for v in &self.vehicle {
            *(v.lens)(&mut body.vehicle) += v.std * normals.next().unwrap_or(0.0);
        }
        let mut values: Vec<f64> = self.aero.iter().map(|&i| body.aero.values[i]).collect();
        values.extend(self.vehicle.iter().map(|v| *(v.lens)(&mut body.vehicle)));
        (body, values)
    }
}

/// What an identification does not say, in words.
fn not_identified(set: &DataSet, parameters: &[String]) -> Vec<String> {
    let is_held = |name: &str| set.held.iter().any(|h| h.name == name);
    let absent: Vec<&str> = parameters.iter().filter(|p| set.value(p).is_none() && !is_held(p)).map(String::as_str).collect();
    let mut warnings = Vec::new();
    if !absent.is_empty() {
        warnings.push(format!("{}: not in the identification, flown with the scenario's value, as if exact", absent.join(", ")));
    }
    let held: Vec<&str> = set.held.iter().filter(|h| parameters.contains(&h.name)).map(|h| h.name.as_str()).collect();
    if !held.is_empty() {
        warnings.push(format!("{}: held in the identification, flown as if exact", held.join(", ")));
    }
    if !set.effects.is_empty() {
        let families: Vec<&str> = set.effects.iter().map(|e| e.family.as_str()).collect();
        warnings.push(format!(
            "{}: effects of the model that was identified, with the sizes of its tunnel and instruments: not flown down, the structure's \
             parameters alone are",
            families.join(", ")
        ));
    }
    if set.parameters.iter().any(|p| OF_THE_TUNNEL.contains(&p.coefficient.as_str())) {
        warnings.push(
            "gusts and random moments found in the tunnel are the tunnel's; the scenario says which the planet has".to_owned(),
        );
    }
    warnings
}
