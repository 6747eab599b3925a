//! model: a campaign, one vehicle with its declared model and its runs. In: checked data. Out: what identifier and loop work on.

use crate::acts::Acts;
use crate::effects::Effect;
use crate::knowledge::Knowledge;
use crate::plant::Plant;
use crate::record::{Measured, PointRecord, Record};
use crate::run_use::Use;
use crate::scenario::Flight;

/// One run's data.
#[derive(Clone, Debug, PartialEq)]
pub enum Data {
    /// A tunnel run with attitude.
    Tunnel(Record),
    /// A track: a flight of a point mass, a swing, or a flight of a rigid body through air at rest.
    Point(PointRecord),
}

/// One run of a campaign.
#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    /// Short name, the file's stem.
    pub name: String,
    /// Kind as declared: `perturbed`, `unperturbed`, `drop`, `launch`, or the user's word.
    pub kind: String,
    /// What it is for.
    pub used: Use,
    /// Known settings of this run, in the order of [`Campaign::inputs`].
    pub inputs: Vec<f64>,
    /// What was measured.
    pub data: Data,
    /// What reading the file bridged, removed or split, in words.
    pub notes: Vec<String>,
}

impl Run {
    /// The run that a flight's record makes: of a flight with a window that part of it.
    #[must_use]
    pub fn of_flight(flight: &Flight, record: Record) -> Self {
        Self {
            name: flight.name.clone(),
            kind: flight.kind.clone(),
            used: flight.used,
            inputs: Vec::new(),
            data: Data::Tunnel(flight.used_part(record)),
            notes: Vec::new(),
        }
    }
}

/// A campaign: declared plant, which parameters it declares, runs.
#[derive(Clone, Debug, PartialEq)]
pub struct Campaign {
    /// Name from the file.
    pub name: String,
    /// The declared model with its starting values; undeclared parameters are zero.
    pub plant: Plant,
    /// For each parameter of the structure, whether the declared model has it.
    pub declared: Vec<bool>,
    /// Names of run inputs, sorted.
    pub inputs: Vec<String>,
    /// All runs, in file order.
    pub runs: Vec<Run>,
    /// Uncertain constants, declared effects.
    pub knowledge: Knowledge,
}

impl Campaign {
    /// What flights make: a declared model without what was added to fly it, for each of its parameters whether it is declared, and
    /// their records.
    #[must_use]
    pub fn of_flights(name: &str, plant: &Plant, declared: &[bool], knowledge: &Knowledge, runs: Vec<Run>) -> Self {
        Self {
            name: name.to_owned(),
            plant: plant.clone(),
            declared: declared.to_vec(),
            inputs: Vec::new(),
            runs,
            knowledge: knowledge.clone(),
        }
    }
    /// Means over the tunnel runs that are identified on: tunnel speed, where the air rests the model's own ([`crate::Record::mean_airspeed_m_s`]),
    /// m/s, and density, kg/m³; none where there is no such run.
    #[must_use]
    pub fn tunnel_means(&self) -> Option<[f64; 2]> {
        let (mut sums, mut samples) = ([0.0; 2], 0.0);
        for run in self.runs.iter().filter(|r| r.used == Use::Identify) {
            let Data::Tunnel(r) = &run.data else { continue };
            sums[0] += r.mean_airspeed_m_s() * r.len() as f64;
            for (ps_pa, ts_k) in r.ps_pa.iter().zip(&r.ts_k) {
                sums[1] += self.plant.environment.density_kg_m3(*ps_pa, *ts_k);
                samples += 1.0;
            }
        }
        (samples > 0.0).then(|| sums.map(|s| s / samples))
    }
    /// True when its runs are tracks: of a body without attitude, or of a rigid one in free flight through air at rest.
    #[must_use]
    pub fn has_tracks(&self) -> bool {
        matches!(self.runs.first().map(|r| &r.data), Some(Data::Point(_)))
    }
    /// Kind of its body, for the catalogue of effects.
    #[must_use]
    pub fn body(&self) -> Acts {
        match (self.has_tracks(), &self.plant.free_flight) {
            (true, Some(_)) => Acts::FreeFlight,
            (true, None) => self.plant.point.body(),
            (false, _) => Acts::Lander,
        }
    }
    /// What its tracks measured.
    #[must_use]
    pub fn measured(&self) -> Measured {
        match self.runs.first().map(|r| &r.data) {
            Some(Data::Point(record)) => record.measured,
            _ => Measured::Position,
        }
    }
    /// The declared model as it is flown: its numbers, with the declared effects at their starting values.
    #[must_use]
    pub fn declared_plant(&self) -> Plant {
        let mut plant = self.plant.clone();
        for (effect, values) in &self.knowledge.effects {
            (effect.apply)(&mut plant, values);
        }
        plant
    }
    /// The same campaign with its declared effects in its plant and none beside it, so that none acts twice: for all that takes a
    /// declared model as numbers of a plant.
    #[must_use]
    pub fn with_effects_in_plant(&self) -> Self {
        let mut own = Self { plant: self.declared_plant(), ..self.clone() };
        own.knowledge.effects.clear();
        own
    }
    /// Declared effects that are random inputs, gusts or shedding: no load of a plant, but a drive that a method carries or leaves out.
    #[must_use]
    pub fn random_effects(&self) -> Vec<&'static Effect> {
        let drives = |(effect, values): &&(&'static Effect, Vec<f64>)| {
            let mut plant = self.plant.clone();
            (effect.apply)(&mut plant, values);
            // Which there are does not depend on the speed.
            plant.disturbances(1.0) != self.plant.disturbances(1.0)
        };
        self.knowledge.effects.iter().filter(drives).map(|(effect, _)| *effect).collect()
    }
    /// The plant as it acts in run `i`.
    #[must_use]
    pub fn plant_for(&self, plant: &Plant, i: usize) -> Plant {
        let run = &self.runs[i];
        match &run.data {
            Data::Tunnel(_) => plant.for_run(i, &run.inputs),
            Data::Point(record) => record.plant(plant, i, &run.inputs),
        }
    }
}
