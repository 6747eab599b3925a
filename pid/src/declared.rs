//! pid: effects that a campaign declares. In: a campaign, what a method finds with them in its plant. Out: the same with the effects as its
//! model has them, and words on the random ones that the method leaves out.

use crate::PidError;
use crate::identification::{FoundEffect, FoundNumber, Identification};
use crate::plant::TURBULENCE;
use windfall_model::{Campaign, Effect};

/// A method on a campaign whose declared effects are in its plant, at their declared values. `gusts`: it estimates those itself.
pub(crate) fn with_effects(
    campaign: &Campaign,
    gusts: bool,
    identify: impl FnOnce(&Campaign) -> Result<Identification, PidError>,
) -> Result<Identification, PidError> {
    if campaign.knowledge.effects.is_empty() {
        return identify(campaign);
    }
    let mut found = identify(&campaign.with_effects_in_plant())?;
    let all = campaign.knowledge.effects.iter().filter(|(e, _)| !(gusts && e.family == TURBULENCE));
    let held: Vec<FoundEffect> = all.map(|(effect, values)| held(campaign, effect, values)).collect();
    found.data_sets.iter_mut().for_each(|set| set.effects.clone_from(&held));
    found.warnings.extend(left_out(campaign, gusts, &format!("method {}", found.method)));
    Ok(found)
}

/// An effect as it is declared.
fn held(campaign: &Campaign, effect: &Effect, values: &[f64]) -> FoundEffect {
    let number = |(p, value): (windfall_model::Parameter, &f64)| FoundNumber {
        name: p.name,
        estimate: *value,
        std_error: None,
        unit: p.unit.to_owned(),
    };
    let parameters = (effect.parameters)(&campaign.inputs).into_iter().zip(values).map(number).collect();
    FoundEffect { family: effect.family.to_owned(), parameters }
}

/// What is to be said of declared effects that are random inputs, which `who` does not carry; `gusts`: it estimates those itself.
pub(crate) fn left_out(campaign: &Campaign, gusts: bool, who: &str) -> Vec<String> {
    let words = |effect: &Effect| {
        if gusts && effect.family == TURBULENCE {
            return format!(
                "declared effect {TURBULENCE}: {who} estimates the gusts itself, and its declared values are not used"
            );
        }
        format!(
            "declared effect {}: a random input, which {who} does not carry, so that its intervals leave out what it does; windfall \
             identify without --method carries it, and so does windfall close",
            effect.family
        )
    };
    campaign.random_effects().into_iter().map(words).collect()
}
