//! pid: where the safety line goes. In: the declared tether and the runs. Out: a fault when it cannot be there.
//!
//! The line streams with the air, which goes up (−X): what holds it is above the model, and it leaves the body on that side. Its pull is
//! a few thousandths of the weight, so the motion does not show this.

use super::{GrossFault, quantile, short};
use windfall_model::{Campaign, Record};

/// How far on the wrong side of the body's middle the attachment may be, over the reference diameter.
const BESIDE: f64 = 0.25;

/// A ring below the model, or an attachment on the side away from it.
pub(super) fn fault(campaign: &Campaign, runs: &[(&str, &Record)]) -> Option<GrossFault> {
    let tether = campaign.plant.tether.as_ref()?;
    let (ring, hook) = (tether.p_tunnel_ring.x(), tether.p_origin_hook.x());
    let places: Vec<f64> = runs.iter().flat_map(|(_, r)| r.position_m[0].iter().copied()).collect();
    let lowest = quantile(places.clone(), 0.99);
    let highest = quantile(places, 0.01);
    let pull = pull_n(campaign, runs);
    let place = "[tether]".to_owned();
    // Positions in other units show in the motion; only a ring that is beyond them whatever their unit is wrong here.
    if ring > 0.0 && pull > 0.0 && ring > lowest && lowest - highest < 20.0 {
        return Some(GrossFault {
            place,
            cause: "the ring is below the model".to_owned(),
            evidence: format!(
                "the line streams upward with a pull of {} N, and ring_m has X = +{} m, under all of the runs (X down)",
                short(pull),
                short(ring)
            ),
            change: format!("with ring_m X = -{} the line hangs as it must", short(ring)),
        });
    }
    let d = campaign.plant.vehicle.diameter_m;
    let above = ring < highest;
    if above && hook > BESIDE * d {
        return Some(GrossFault {
            place,
            cause: "the attachment is on the wrong side of the body".to_owned(),
            evidence: format!(
                "the ring is above, and attachment_m has x = +{} m, {} reference diameters below the geometric origin: the line would \
                 pass through the body",
                short(hook),
                short(hook / d)
            ),
            change: format!(
                "with attachment_m x = -{} the line leaves the body on the ring's side (body x points down)",
                short(hook)
            ),
        });
    }
    None
}

/// A model that is above its ring for more than half of the time: a line that streams upward does not reach there. Asked where the motion names
/// no axis or unit that would put the model there.
pub(super) fn above(campaign: &Campaign, runs: &[(&str, &Record)]) -> Option<GrossFault> {
    let tether = campaign.plant.tether.as_ref()?;
    let ring = tether.p_tunnel_ring.x();
    let middle = quantile(runs.iter().flat_map(|(_, r)| r.position_m[0].iter().copied()).collect(), 0.5);
    (middle < ring && pull_n(campaign, runs) > 0.0).then(|| GrossFault {
        place: "[tether]".to_owned(),
        cause: "the model is above its ring".to_owned(),
        evidence: format!(
            "the median of X is {} m and ring_m has X = {} m: the model is {} m above the ring (X down)",
            short(middle),
            short(ring),
            short(ring - middle)
        ),
        change: "check the unit and the origin of X, and ring_m: both are from the same origin, in m".to_owned(),
    })
}

/// Upward pull of the line at the median dynamic pressure, N.
fn pull_n(campaign: &Campaign, runs: &[(&str, &Record)]) -> f64 {
    let of = |r: &Record| {
        let density = campaign.plant.environment.density_kg_m3(super::median(&r.ps_pa), super::median(&r.ts_k));
        0.5 * density * super::median(&r.vw_m_s).powi(2)
    };
    let q = quantile(runs.iter().map(|(_, r)| of(r)).collect(), 0.5);
    campaign.plant.tether.as_ref().map_or(0.0, |t| q * t.drag_area_m2 - t.weight_n)
}

#[cfg(test)]
mod tests;
