//! pid: the record as it stands against every other reading of it. In: instants. Out: a fault where one other reading closes the
//! balance and the record as it stands does not.

use super::balance::{Balance, GROUPS, PER_S, Point, Ratio, balance};
use super::change::{Act, Change, all};
use super::motion::{DELAYS, MotionSample};
use super::{GrossFault, median};
use windfall_model::{Campaign, Coefficient, Factor, Plant, RunChannel, Variable};

/// What is left of a group of accelerations counts down to this share: below it is undeclared detail.
const FLOOR: f64 = 0.05;
/// Aerodynamics within a factor of three of the declared cost little, in logarithms.
const SPREAD: f64 = 0.7;
/// Most that one parameter may cost, and what one of the wrong sign does.
const DEAREST: f64 = 12.0;
/// Groups that count: roll moves too little to tell.
const COUNTED: [usize; 3] = [0, 1, 3];
/// By how much, in logarithms of likelihood, another reading must be better, and better in what it leaves alone.
const MARGIN: [f64; 2] = [60.0, 50.0];
/// Readings within this of the best say the same: the most usual slip is named.
const ALIKE: f64 = 8.0;
/// The same as a share of their lead.
const ALIKE_SHARE: f64 = 0.05;
/// What another reading must leave of the group that it improves most, over what the record leaves as it stands.
const IMPROVED: f64 = 0.6;
/// Share of that group that another reading may leave at most: one that explains less than three quarters of its variance explains nothing.
pub(super) const CLOSED: f64 = 0.5;
/// Share that is left of that group from which on the record as it stands is in doubt.
const DOUBTFUL: f64 = 0.3;

/// A reading with its balance.
struct Outcome {
    change: Option<Change>,
    /// What is left over what there is, per group.
    share: [f64; 4],
    /// Minus logarithms of likelihood: of what is left, and of aerodynamics.
    cost: [f64; 2],
}

impl Outcome {
    fn total(&self) -> f64 {
        self.cost[0] + self.cost[1]
    }
}

/// Cost of aerodynamics far from the declared, where the runs determine them.
fn aerodynamics(ratio: &[Ratio]) -> f64 {
    let determined = |r: &&Ratio| r.std < 0.3 * r.value.abs().max(0.3);
    let one = |r: &Ratio| if r.value > 0.0 { (0.5 * (r.value.ln() / SPREAD).powi(2)).min(DEAREST) } else { DEAREST };
    ratio.iter().filter(determined).map(one).sum()
}

/// What every reading of a record is held against.
struct Held<'a> {
    campaign: &'a Campaign,
    /// Length of the record that counts.
    seconds: f64,
    /// The record as it stands, where it can be fitted.
    as_recorded: Option<Balance>,
}

impl Held<'_> {
    /// One reading; what it leaves is measured against the accelerations as recorded where it keeps their size. `offset`: with constant moments.
    fn outcome(
        &self,
        act: Act,
        change: Option<Change>,
        plant: &Plant,
        offset: bool,
        instants: &[MotionSample],
    ) -> Option<(Outcome, Balance)> {
        let points: Vec<Point> = instants.iter().map(|i| act.apply(i)).collect();
        let b = balance(&points, plant, &self.campaign.declared, self.seconds, offset)?;
        let signal = self.as_recorded.as_ref().filter(|_| act.keeps_size()).map_or(b.signal, |r| r.signal);
        let share: [f64; 4] = std::array::from_fn(|g| b.left[g] / signal[g].max(1e-12));
        let left: f64 = COUNTED.iter().map(|g| share[*g].max(FLOOR).ln()).sum();
        let cost = [self.seconds * PER_S * left, aerodynamics(&b.ratio)];
        Some((Outcome { change, share, cost }, b))
    }
}

/// A fault, where one reading is far better than the record as it stands.
/// `turned`: readings of other axes, with their own motion; asked for where the record as it stands is in doubt.
pub(super) fn fault(
    campaign: &Campaign,
    instants: &[MotionSample],
    turned: impl FnOnce() -> Vec<(Change, Vec<MotionSample>)>,
) -> Option<GrossFault> {
    if instants.is_empty() {
        return None;
    }
    let recorded: f64 = instants.iter().map(|i| i.span_s).sum();
    // A clock in other units says nothing of how long the runs are.
    let seconds = recorded.clamp(5.0, 100.0);
    let declared = &campaign.plant;
    let mut held = Held { campaign, seconds, as_recorded: None };
    let now = held.outcome(Act::Late(0), None, declared, false, instants).map(|(now, b)| {
        held.as_recorded = Some(b);
        now
    });
    if now.as_ref().is_some_and(|now| !is_doubtful(now)) {
        return None;
    }
    let read = |c: Change, own: &[MotionSample]| Some(held.outcome(c.act, Some(c), declared, false, own)?.0);
    let readings = all().into_iter().filter_map(|c| read(c, instants));
    let turned = turned().into_iter().filter_map(|(c, own)| read(c, &own));
    let list: Vec<Outcome> = readings.chain(turned).collect();
    let best = best(now.as_ref(), &list)?;
    let change = best.change.as_ref()?;
    let evidence = match &now {
        Some(now) => {
            let evidence = against(now, best)?;
            let plants = effects(campaign, instants).into_iter().map(|p| (p, false)).chain([(declared.clone(), true)]);
            let mut sound = plants.flat_map(|(p, offset)| (0..=DELAYS).map(move |k| (p.clone(), offset, k)));
            let explained = |(plant, offset, k): (Plant, bool, usize)| {
                let o = held.outcome(Act::Late(k), None, &plant, offset, instants);
                o.is_some_and(|o| against(&o.0, best).is_none())
            };
            if sound.any(explained) {
                return None;
            }
            evidence
        }
        None if COUNTED.iter().all(|g| best.share[*g] < 0.8) => {
            format!("then {}, as it stands the model flies on its back or beyond the horizontal", closes(best))
        }
        None => return None,
    };
    Some(GrossFault {
        place: "all runs together".to_owned(),
        cause: change.cause.clone(),
        change: format!("with {} the record makes sense", change.words),
        evidence,
    })
}

/// The first of the readings that are as good as the best.
fn best<'a>(now: Option<&Outcome>, list: &'a [Outcome]) -> Option<&'a Outcome> {
    let least = list.iter().map(Outcome::total).fold(f64::INFINITY, f64::min);
    let lead = now.map_or(0.0, |n| n.total() - least).max(0.0);
    list.iter().find(|o| o.total() < least + ALIKE.max(ALIKE_SHARE * lead))
}

/// The declared plant with undeclared effects that bend the vertical balance as a wrong clock or axis does, each at the largest size
/// that is seen: drag that varies with speed, a line that pulls by its rate. With them and a late anemometer (V_W some tenths of a
/// second old) a sound record closes.
fn effects(campaign: &Campaign, instants: &[MotionSample]) -> Vec<Plant> {
    let speed = median(&instants.iter().map(|i| i.motion[RunChannel::Wind.at()][0]).collect::<Vec<_>>());
    let aero = &campaign.plant.aero;
    let drag =
        aero.structure.contributions.iter().find(|c| c.coefficient == Coefficient::CA).map_or(0.0, |c| aero.values[c.parameter]);
    let mut all = Vec::new();
    for by_speed in [0.0, -0.5, 0.5, -1.0, 1.0] {
        for by_rate in [0.0, 0.5, 1.0] {
            let mut plant = campaign.plant.clone();
            if speed > 0.0 {
                plant.aero.add(Coefficient::CA, by_speed * drag, 1.0 / speed, &[Factor::Power(Variable::Speed, 1)]);
                plant.aero.add(Coefficient::CA, by_speed * drag, -1.0, &[]);
            }
            if let Some(t) = plant.tether.as_mut() {
                t.line_rate_n_s_m = by_rate;
            }
            all.push(plant);
        }
    }
    all
}

/// Whether a record as it stands leaves so much of some group that another reading may be better.
fn is_doubtful(now: &Outcome) -> bool {
    COUNTED.iter().any(|g| now.share[*g] > DOUBTFUL)
}

/// What speaks for a reading, where it is far enough ahead.
fn against(now: &Outcome, other: &Outcome) -> Option<String> {
    let ahead = [now.total() - other.total(), now.cost[0] - other.cost[0]];
    let gain = |g: &usize| other.share[*g] / now.share[*g].max(1e-12);
    let most = COUNTED.into_iter().min_by(|a, b| gain(a).total_cmp(&gain(b)))?;
    let none_worse = COUNTED.iter().all(|g| other.share[*g] < 1.15 * now.share[*g] + 0.03);
    let sure = none_worse
        && other.share[most] < CLOSED
        && ahead[0] > MARGIN[0]
        && ahead[1] > MARGIN[1]
        && gain(&most) < IMPROVED
        && now.share[most] > DOUBTFUL;
    sure.then(|| {
        format!(
            "then the equations of motion leave {:.0} % of the {} accelerations unexplained, as it stands {:.0} %",
            100.0 * other.share[most],
            GROUPS[most],
            100.0 * now.share[most]
        )
    })
}

fn closes(o: &Outcome) -> String {
    let each: Vec<String> = COUNTED.iter().map(|g| format!("{:.0} % of the {}", 100.0 * o.share[*g], GROUPS[*g])).collect();
    format!("the equations of motion leave {} accelerations unexplained", each.join(", "))
}

#[cfg(test)]
mod tests;
