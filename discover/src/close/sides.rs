//! discover: the plants that a closing found, made once where it ends. In: the fits of both sides. Out: the plant before, and after. Errors on
//! held-out runs, charts, tracks, replay and wind-tunnel comparison are all of these.

use super::Role;
use windfall_model::Plant;

/// The plant before, and after when effects were added: declared values as fitted, uncertain constants, declared effects, those that were
/// found, and gusts that stand beside them.
#[derive(Clone, Debug, PartialEq)]
pub struct Sides {
    /// With the declared model.
    pub before: Plant,
    /// With the effects added.
    pub after: Option<Plant>,
}

impl Sides {
    pub(super) fn each(&self) -> impl Iterator<Item = (Role, &Plant)> {
        std::iter::once((Role::Before, &self.before)).chain(self.after.iter().map(|p| (Role::After, p)))
    }
    /// The plant that a closing ends with.
    pub(super) fn last(&self) -> &Plant {
        self.after.as_ref().unwrap_or(&self.before)
    }
}
