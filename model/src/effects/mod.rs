//! model: the effect catalogue. In: nothing. Out: every physical effect a declared model may lack, one file each.
//!
//! An effect is a family name, its parameters, a paragraph of physics with a source, and what it changes in the plant. From
//! that one file follow simulating it, its signature, tracing, estimating, its bound, and its line in the report; nothing else
//! in the program knows a family by name. Adding an effect is adding a file: [`CATALOGUE`] is made of those that are there.

pub use crate::acts::Acts;
use crate::plant::{Plant, trim_speed};
use crate::scenario::Flight;

// Files and list: `build.rs`.
include!(concat!(env!("OUT_DIR"), "/catalogue.rs"));

/// Longest lag of one recorder's clock behind another's, s: a third of a run of three minutes. Two recorders that are started by hand are seconds
/// apart.
const LONGEST_LAG_S: f64 = 60.0;

/// How a parameter is looked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Role {
    /// Zero means the effect is absent; estimated by linearisation around zero and then iterated.
    Strength,
    /// Meaningless when all strengths are zero; these values are tried, then refined.
    Shape(&'static [f64]),
    /// A time from the run's first sample, s: tried along the whole run.
    Instant,
    /// Index of the run in which the effect acts: every run is tried.
    Run,
    /// Place of a parameter in the aerodynamic structure: every one is tried.
    AeroPlace,
    /// Tunnel speed at which strengths are stated, m/s: another one is another way to write the same effect. Held; a search states what it
    /// finds at the trim speed.
    Reference,
}

/// How much a plant has already of what a strength adds to. The sum of both is never negative.
#[derive(Clone, Copy)]
pub struct Net(pub fn(&Plant) -> f64);

/// Two are the same when they are the same function.
impl PartialEq for Net {
    fn eq(&self, other: &Self) -> bool {
        std::ptr::fn_addr_eq(self.0, other.0)
    }
}

/// Without the address, which differs from one run of the program to the next.
impl std::fmt::Debug for Net {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Net")
    }
}

/// One parameter of an effect.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// Name in files and reports.
    pub name: String,
    /// SI unit, `-` for none.
    pub unit: &'static str,
    /// Smallest plausible value (allowed in scenarios, inclusive); of an amount beside a plant that has none of it.
    pub low: f64,
    /// Largest value that is allowed and looked for.
    pub high: f64,
    /// Largest usual value, by which priors and steps of strengths are measured: `high` of all but those that may be far beyond it.
    pub usual: f64,
    /// Value when the effect is absent (strengths: 0) or a typical one (shapes).
    pub null: f64,
    /// How it is looked for.
    pub role: Role,
    /// Step of a strength for differences: small against what matters, large against rounding.
    pub step: f64,
    /// Of an amount that is never negative in all (drag, friction, apparent mass): what the plant has of it already.
    pub net: Option<Net>,
}

impl Parameter {
    /// How far a value lies outside the plausible range, in units of that range; 0 inside.
    #[must_use]
    pub fn beyond(&self, value: f64) -> f64 {
        (self.low - value).max(value - self.high).max(0.0) / (self.high - self.low)
    }
    /// Smallest value that any plant allows: of an amount all that a plant could have of it.
    #[must_use]
    pub fn lowest(&self) -> f64 {
        if self.net.is_some() { -self.high } else { self.low }
    }
    /// The same parameter beside this plant: an amount may take away what the plant has of it, and no more.
    #[must_use]
    pub fn beside(mut self, plant: &Plant) -> Self {
        if self.role == Role::AeroPlace {
            self.high = plant.aero.values.len().saturating_sub(1) as f64;
        }
        if let Some(Net(of)) = self.net {
            self.low = (-of(plant)).clamp(-self.high, 0.0);
        }
        self
    }
    /// Whether an estimate lies at an end of its range, where that says something: not at null, and not at a number that is tried.
    #[must_use]
    pub fn is_at_end(&self, value: f64) -> bool {
        let searched = self.role == Role::Strength || self.is_graded();
        // Rounding of sums.
        let at = |x: f64| (value - x).abs() <= 1e-9 * (self.high - self.low);
        let is_form = self.parts_forms() && at(0.0);
        searched && !is_form && !at(self.null) && (at(self.low) || at(self.high))
    }
    /// Whether it is a shape that can be changed a little: not a whole number.
    #[must_use]
    pub fn is_graded(&self) -> bool {
        matches!(self.role, Role::Shape(tried) if tried.iter().any(|v| v.fract() != 0.0))
    }
    /// Whether it is a shape of which zero stands for one form and a size for another, as a spectrum's bandwidth.
    #[must_use]
    pub fn parts_forms(&self) -> bool {
        self.is_graded() && matches!(self.role, Role::Shape(tried) if tried.contains(&0.0))
    }
    fn strength(name: &str, unit: &'static str, limit: f64) -> Self {
        Self {
            name: name.to_owned(),
            unit,
            low: -limit,
            high: limit,
            usual: limit,
            null: 0.0,
            role: Role::Strength,
            step: 1e-3 * limit.min(1e3),
            net: None,
        }
    }
    /// A strength that is never negative.
    fn positive(name: &str, unit: &'static str, limit: f64) -> Self {
        Self { low: 0.0, ..Self::strength(name, unit, limit) }
    }
    /// The same, allowed far beyond what is usual.
    fn allowed_to(self, high: f64) -> Self {
        Self { high, ..self }
    }
    /// A change of an amount that is never negative in all: it may take away what the plant has of it.
    fn amount(name: &str, unit: &'static str, limit: f64, of: fn(&Plant) -> f64) -> Self {
        Self { net: Some(Net(of)), ..Self::positive(name, unit, limit) }
    }
    fn shape(name: &str, unit: &'static str, low: f64, high: f64, null: f64, tried: &'static [f64]) -> Self {
        Self { low, high, usual: high, null, role: Role::Shape(tried), step: 0.0, ..Self::strength(name, unit, 0.0) }
    }
    /// Place of a parameter in the aerodynamic structure.
    fn aero_place(name: &str) -> Self {
        Self { low: 0.0, high: 99.0, usual: 99.0, null: 0.0, role: Role::AeroPlace, step: 0.0, ..Self::strength(name, "-", 0.0) }
    }
    /// Tunnel speed at which strengths are stated; null is near the SAGE model's trim in the tunnel.
    fn reference() -> Self {
        Self {
            low: 0.0,
            high: 1e3,
            usual: 1e3,
            null: 7.5,
            role: Role::Reference,
            step: 0.0,
            ..Self::strength("at_m_s", "m/s", 0.0)
        }
    }
    /// Value where a file leaves it out, where it may: null; zero of a speed at which strengths are stated, which stands for the trim speed.
    #[must_use]
    pub fn left_out(&self) -> f64 {
        if self.role == Role::Reference { 0.0 } else { self.null }
    }
    /// Places of an aerodynamic structure's parameters.
    #[must_use]
    pub fn places(&self) -> Vec<f64> {
        std::iter::successors(Some(0.0), |place| Some(place + 1.0)).take_while(|place| *place <= self.high).collect()
    }
    /// A strength per unit of a run input. Settings come in any unit, from fractions to thousands of revolutions, so the step
    /// is tiny; flights are simulated to 1e-11, which bears it.
    fn per_input(name: &str, input: &str, limit: f64) -> Self {
        Self { step: 1e-6, ..Self::strength(&format!("{name}_per_{input}"), "1/input", limit) }
    }
}

/// One physical effect.
pub struct Effect {
    /// Family name of the contract.
    pub family: &'static str,
    /// Bodies it can act on.
    pub acts: Acts,
    /// One paragraph: what happens.
    pub physics: &'static str,
    /// Where that is from.
    pub source: &'static str,
    /// Its parameters, given the names of the campaign's run inputs.
    pub parameters: fn(inputs: &[String]) -> Vec<Parameter>,
    /// Puts it into a plant: values in the order of `parameters`. Adds to what is there.
    pub apply: fn(&mut Plant, &[f64]),
    /// Additional run that would separate this effect from one that looks the same, in words.
    pub separate_by: &'static str,
}

impl Effect {
    /// The first of its amounts that a plant with it has less than none of, with how much in all.
    #[must_use]
    pub fn overdrawn(&self, inputs: &[String], plant: &Plant) -> Option<(Parameter, f64)> {
        let in_all = |p: Parameter| p.net.map(|Net(of)| of(plant)).map(|x| (p, x));
        // Rounding of what takes all of it away.
        (self.parameters)(inputs).into_iter().filter_map(in_all).find(|(p, x)| *x < -1e-12 * p.high)
    }
}

/// Two are the same when family and bodies are.
impl PartialEq for Effect {
    fn eq(&self, other: &Self) -> bool {
        (self.family, self.acts) == (other.family, other.acts)
    }
}

impl std::fmt::Debug for Effect {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Effect({})", self.family)
    }
}

/// Puts effects into a plant. Where a speed at which strengths are stated is zero it becomes the trim speed, in air of this density (kg/m³), of
/// the plant with all other effects.
pub fn act<'a>(plant: &mut Plant, effects: impl Iterator<Item = (&'static Effect, &'a mut [f64])>, density_kg_m3: f64) {
    let mut at_trim = Vec::new();
    for (effect, values) in effects {
        match (effect.parameters)(&[]).iter().position(|p| p.role == Role::Reference) {
            Some(i) if values[i] == 0.0 => at_trim.push((effect, values, i)),
            _ => (effect.apply)(plant, values),
        }
    }
    let trim_m_s = if at_trim.is_empty() { 0.0 } else { trim_speed(plant, density_kg_m3) };
    for (effect, values, i) in at_trim {
        values[i] = trim_m_s;
        (effect.apply)(plant, values);
    }
}

/// The same in the air of the first of these flights, where there is any.
pub fn act_in_flights<'a>(
    plant: &mut Plant,
    effects: impl Iterator<Item = (&'static Effect, &'a mut [f64])>,
    flights: &[Flight],
) {
    let density = |f: &Flight| plant.environment.density_kg_m3(f.ps_pa, f.ts_k);
    let density_kg_m3 = flights.first().map_or(f64::NAN, density);
    act(plant, effects, density_kg_m3);
}

/// The effect of that family for that kind of body.
#[must_use]
pub fn find(family: &str, acts: Acts) -> Option<&'static Effect> {
    CATALOGUE.into_iter().find(|e| e.family == family && e.acts.on(acts))
}
