//! A campaign to be: who flies, what acts, what is declared, and how it is recorded.

use crate::air::{Gusts, narrow};
use crate::chance::Chance;
use crate::craft::Craft;
use crate::flight::{Flown, Plan, STEEP, fly, released};
use crate::hand::Hand;
use crate::instruments::{Noise, Row, record};
use crate::knobs::{Knob as K, Knobs};
use crate::motion::{Drive, World};
use serde_json::{Map, Value};

/// Everything about a campaign but its flights.
#[derive(Clone, Debug)]
pub(crate) struct Spec {
    pub(crate) group: String,
    pub(crate) what: String,
    /// Right answer: families, `none` or `unexplained`.
    pub(crate) families: Vec<String>,
    pub(crate) rivals: Vec<String>,
    pub(crate) craft: Craft,
    pub(crate) declared: Craft,
    /// What is declared, without errors of constants whose uncertainty is stated.
    pub(crate) reference: Craft,
    /// True when the craft is not the thesis': its numbers go into the answer.
    pub(crate) other: bool,
    pub(crate) knobs: Knobs,
    pub(crate) gusts: Option<Gusts>,
    pub(crate) noise: Noise,
    /// Runs of another craft, by their place.
    pub(crate) own_craft: Vec<(usize, Craft)>,
    /// Noise of each run over that of the others; one beyond its end.
    pub(crate) run_noise: Vec<f64>,
    /// Length scale of craft, tether and test section over the thesis'.
    pub(crate) size: f64,
    /// Least and largest angle of release, degrees.
    pub(crate) release_deg: [f64; 2],
    /// True when the campaign states uncertainties of its constants.
    pub(crate) uncertain: bool,
    pub(crate) tags: Map<String, Value>,
    pub(crate) seed: u64,
}

/// One flown run.
pub(crate) struct Run {
    pub(crate) plan: Plan,
    pub(crate) flown: Flown,
    pub(crate) rows: Vec<Row>,
}

impl Spec {
    /// Nothing undeclared on this craft.
    pub(crate) fn plain(group: &str, what: &str, craft: Craft, other: bool, seed: u64) -> Self {
        Self {
            group: group.to_owned(),
            what: what.to_owned(),
            families: Vec::new(),
            rivals: Vec::new(),
            declared: craft.clone(),
            reference: craft.clone(),
            craft,
            other,
            knobs: Knobs::default(),
            gusts: None,
            noise: Noise::default(),
            own_craft: Vec::new(),
            run_noise: Vec::new(),
            size: 1.0,
            release_deg: [14.0, 25.0],
            uncertain: false,
            tags: Map::new(),
            seed,
        }
    }

    pub(crate) fn tag(&mut self, key: &str, value: impl Into<Value>) {
        self.tags.insert(key.to_owned(), value.into());
    }

    /// Runs: two to four released at an angle (`release_deg`) and one to three left to themselves; two of them are held out.
    pub(crate) fn plans(&self) -> Vec<Plan> {
        let mut c = Chance::new(self.seed, 10);
        let slow = self.size.sqrt();
        let rate_hz = if self.other { [100.0, 110.0, 120.0, 125.0, 130.0, 140.0, 150.0][c.below(7)] } else { 150.0 };
        let tilted = if self.other { 3 + c.below(2) } else { 3 };
        let free = if self.other { 2 + c.below(2) } else { 2 };
        let mut plans = Vec::new();
        for k in 0..tilted + free {
            let perturbed = k < tilted;
            let number = if perturbed { k + 1 } else { k + 1 - tilted };
            let seconds = |a: f64, b: f64, c: &mut Chance| (slow * c.uniform(a, b) * 10.0).round() / 10.0;
            let kind = if perturbed { "perturbed" } else { "unperturbed" };
            plans.push(Plan {
                name: format!("{kind}-{number}"),
                kind,
                hold_out: k + 1 == tilted || k + 1 == tilted + free,
                duration: if perturbed { seconds(12.0, 16.0, &mut c) } else { seconds(18.0, 27.0, &mut c) },
                rate_hz,
                start: [[0.0; 3]; 4],
                size: self.size,
                steep: if self.release_deg[1] > 30.0 { 1.2 } else { STEEP },
            });
        }
        plans.sort_by_key(|p| p.hold_out);
        plans
    }

    /// The world of run `k`; its random air is drawn from the campaign's seed.
    pub(crate) fn world(&self, k: usize, duration: f64) -> World<'_> {
        let craft = self.craft_of(k);
        let trim = craft.trim();
        let mut c = Chance::new(self.seed, 100 + k as u64);
        let hand = Hand::new(trim, &mut c).sized(self.size);
        let mut world = World::new(craft, &self.knobs, trim, Drive::Hand(hand), k as f64 + 1.0);
        world.phase = c.phase();
        world.own_cm0 = self.knobs.get(K::Scatter) * c.normal();
        world.gusts = self.gusts.map(|g| g.draw(trim, duration, &mut c));
        if self.knobs.get(K::Shed) > 0.0 {
            let hz = self.knobs.get(K::Strouhal) * trim / self.craft.diameter;
            let mut one = || narrow(self.knobs.get(K::Shed), hz, self.knobs.get(K::ShedBand), duration, &mut c);
            world.shedding = Some([one(), one()]);
        }
        world
    }

    /// Who flies in run `k`.
    fn craft_of(&self, k: usize) -> &Craft {
        self.own_craft.iter().find(|(run, _)| *run == k).map_or(&self.craft, |(_, craft)| craft)
    }

    /// Seconds that are flown before the record begins, for instruments that look back.
    pub(crate) fn lead(&self) -> f64 {
        let late = self.knobs.get(K::Vdelay).max(self.knobs.get(K::PoseDelay));
        if late > 0.0 { late + 0.02 } else { 0.0 }
    }

    /// Flies all runs; `None` when one leaves the section however it is released.
    pub(crate) fn fly(&self) -> Option<Vec<Run>> {
        let one = |(k, mut plan): (usize, Plan)| {
            let world = self.world(k, plan.duration);
            let mut c = Chance::new(self.seed, 200 + k as u64);
            let flown = (0..8).find_map(|_| {
                let perturbed = plan.kind == "perturbed";
                let tilt = if perturbed { c.uniform(self.release_deg[0], self.release_deg[1]) } else { c.uniform(0.8, 2.5) };
                plan.start = released(&mut c, tilt.to_radians(), if perturbed { 0.15 } else { 0.02 }, self.size);
                fly(&world, &plan, self.lead())
            })?;
            let mut c = Chance::new(self.seed, 300 + k as u64);
            let times = self.run_noise.get(k).copied().unwrap_or(1.0);
            let noise = Noise { gain: self.noise.gain.map(|g| g * times), ..self.noise.clone() };
            let rows = record(&flown, self.craft_of(k), &self.knobs, world.trim, &noise, &mut c);
            Some(Run { plan, flown, rows })
        };
        self.plans().into_iter().enumerate().map(one).collect()
    }
}
