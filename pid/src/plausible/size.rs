//! pid: mass, inertia and diameter of one body. In: declared constants. Out: a fault where no body has them.
//!
//! Asked last: where the record tells which constant is off and by how much, that is said instead.

use super::{GrossFault, short};
use windfall_model::{Campaign, Inertia};

/// A radius of gyration that no body of this diameter has.
pub(super) fn fault(campaign: &Campaign) -> Option<GrossFault> {
    let v = &campaign.plant.vehicle;
    let [low, high] = Inertia::GYRATION_OVER_DIAMETER;
    let moments = [("xx", v.inertia.xx), ("yy", v.inertia.yy), ("zz", v.inertia.zz)];
    let ratio = |moment: f64| (moment / v.mass_kg).sqrt() / v.diameter_m;
    let (name, moment) = moments.into_iter().find(|(_, i)| ratio(*i).is_finite() && !(low..=high).contains(&ratio(*i)))?;
    Some(GrossFault {
        place: "[vehicle] inertia_kg_m2".to_owned(),
        cause: "mass, inertia and diameter are not of one body".to_owned(),
        evidence: format!(
            "{name} = {moment} kg m2 with {} kg is a radius of gyration of {} diameters, and a body has {low} to {high}",
            short(v.mass_kg),
            short(ratio(moment))
        ),
        change: "give inertia in kg m2 (1e-4 x kg cm2), mass in kg, reference_diameter_m in m".to_owned(),
    })
}

#[cfg(test)]
mod tests;
