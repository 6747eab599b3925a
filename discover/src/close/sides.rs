//! discover: the plants that a closing found. In: a campaign and its closing. Out: the plant before, and after.

use super::{Closing, ParameterLine, Role};
use windfall_model::{Campaign, Plant, effects};

/// The plants that a closing found.
pub(super) fn sides_of(campaign: &Campaign, closing: &Closing) -> Sides {
    let before = plant(campaign, &closing.before.parameters, &[]);
    let added: Vec<(&str, Vec<f64>)> =
        closing.effects.iter().map(|e| (e.family.as_str(), e.parameters.iter().map(|p| p.estimate).collect())).collect();
    let after = (!added.is_empty()).then(|| plant(campaign, &closing.after.parameters, &added));
    Sides { before, after }
}

/// The plant before, and after when effects were added.
pub(super) struct Sides {
    pub(super) before: Plant,
    pub(super) after: Option<Plant>,
}

impl Sides {
    pub(super) fn each(&self) -> impl Iterator<Item = (Role, &Plant)> {
        std::iter::once((Role::Before, &self.before)).chain(self.after.iter().map(|p| (Role::After, p)))
    }
}

/// The campaign's plant with these declared values and effects.
fn plant(campaign: &Campaign, declared: &[ParameterLine], added: &[(&str, Vec<f64>)]) -> Plant {
    let mut plant = campaign.plant.clone();
    for p in declared {
        if let Some(i) = plant.aero.structure.index(&p.name) {
            plant.aero.values[i] = p.estimate;
        }
    }
    for (family, values) in added {
        if let Some(e) = effects::find(family, campaign.body()) {
            (e.apply)(&mut plant, values);
        }
    }
    plant
}
