//! likelihood: a model at a point. In: a campaign, values of declared parameters, constants and effects. Out: its plant, and every number
//! that may be changed as a column with a prior.

use crate::columns::{Basis, SensitivityColumn, Site};
use std::collections::BTreeMap;
use windfall_model::{Acts, CATALOGUE, Campaign, Effect, Parameter, Plant, Role, trim_speed};

/// An effect that is part of a model.
#[derive(Clone, Debug)]
pub struct Member {
    /// The effect.
    pub effect: &'static Effect,
    /// Its parameters.
    pub parameters: Vec<Parameter>,
    /// Their values.
    pub values: Vec<f64>,
    /// Whether its strengths are sizes of random inputs.
    pub random: bool,
    /// Whether the campaign declares it: it is in every set.
    pub declared: bool,
}

/// Prior standard deviation of a declared parameter over its size: knows nothing of it.
pub(crate) const VAGUE_PRIOR: f64 = 30.0;

/// Values of everything that a fit may change.
#[derive(Clone, Debug)]
pub struct Model {
    /// Parameters of the aerodynamic structure.
    pub declared: Vec<f64>,
    /// Uncertain constants, as departures from their declared values.
    pub constants: Vec<f64>,
    /// Effects.
    pub members: Vec<Member>,
}

/// One number that a fit may change.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Id {
    /// Parameter of the structure.
    Declared(usize),
    /// Uncertain constant.
    Constant(usize),
    /// Parameter of a member.
    Member(usize, usize),
    /// Strength (third) of a form (second) of an effect of the catalogue (first).
    Strength(usize, usize, usize),
    /// Generic alternative, by its place in a list.
    Generic(usize),
}

/// A number with its column's step and its prior: normal about `null` with standard deviation `prior`.
#[derive(Clone, Copy, Debug)]
pub struct Number {
    /// Which.
    pub id: Id,
    /// Its present value, less null.
    pub value: f64,
    /// Prior standard deviation.
    pub prior: f64,
    /// Allowed range.
    pub range: [f64; 2],
    /// Whether it stands at the range's low and high end.
    pub at_end: [bool; 2],
    /// Step for differences.
    pub step: f64,
}

impl Number {
    /// Whether a change takes it out of its range, at an end of which it stands.
    pub(crate) fn leaves(&self, by: f64) -> bool {
        self.at_end[0] && by < 0.0 || self.at_end[1] && by > 0.0
    }
}

/// A prior standard deviation of an effect's strength, as a share of the plausible range's end.
pub(crate) const PLAUSIBLE: f64 = 0.1;

/// Parameters of an effect whose values somebody has stated: where a strength is beyond what is usual, its own size is usual.
fn stated(mut parameters: Vec<Parameter>, values: &[f64]) -> Vec<Parameter> {
    for (p, v) in parameters.iter_mut().zip(values) {
        if v.abs() > p.usual {
            p.usual = v.abs() / PLAUSIBLE;
        }
    }
    parameters
}

impl Member {
    /// Null instance of an effect; strengths that are stated at a tunnel speed are at the runs' mean.
    #[must_use]
    pub fn null(effect: &'static Effect, campaign: &Campaign) -> Self {
        let parameters: Vec<Parameter> =
            (effect.parameters)(&campaign.inputs).into_iter().map(|p| p.beside(&campaign.plant)).collect();
        let value = |p: &Parameter| {
            let mean = if p.role == Role::Reference { campaign.tunnel_means() } else { None };
            mean.map_or(p.null, |[speed_m_s, _]| speed_m_s.clamp(p.low, p.high))
        };
        let values: Vec<f64> = parameters.iter().map(value).collect();
        let random = parameters.iter().enumerate().any(|(i, p)| {
            let mut v = values.clone();
            v[i] = 1.0;
            let mut plant = campaign.plant.clone();
            (effect.apply)(&mut plant, &v);
            p.role == Role::Strength && plant.disturbances(1.0) != campaign.plant.disturbances(1.0)
        });
        Self { effect, parameters, values, random, declared: false }
    }
    /// An effect with values that somebody has stated.
    fn stated(effect: &'static Effect, values: &[f64], campaign: &Campaign) -> Self {
        let null = Self::null(effect, campaign);
        Self { parameters: stated(null.parameters, values), values: values.to_vec(), ..null }
    }
    /// True when it acts in one run only.
    #[must_use]
    pub fn is_local(&self) -> bool {
        self.parameters.iter().any(|p| p.role == Role::Run)
    }
    /// Indices of strengths.
    pub fn strengths(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.values.len()).filter(|&i| self.parameters[i].role == Role::Strength)
    }
    /// Values of shapes that are tried: all combinations, but equal places of equal lists.
    #[must_use]
    pub fn forms(&self) -> Vec<Vec<f64>> {
        let mut forms = vec![self.values.clone()];
        let mut seen: Vec<(&[f64], usize)> = Vec::new();
        for (i, p) in self.parameters.iter().enumerate() {
            if p.role == Role::AeroPlace {
                forms = with_each(&forms, i, &p.places());
                continue;
            }
            let Role::Shape(tried) = p.role else { continue };
            if self.random
                && let Some((_, twin)) = seen.iter().find(|(list, _)| *list == tried)
            {
                let twin = *twin;
                forms.iter_mut().for_each(|f| f[i] = f[twin]);
                continue;
            }
            seen.push((tried, i));
            forms = with_each(&forms, i, tried);
        }
        forms
    }
    /// Its values in every other form that no small change leads to: a switch thrown, another whole number.
    pub(crate) fn other_forms(&self) -> Vec<Vec<f64>> {
        let mut forms = vec![self.values.clone()];
        for (i, p) in self.parameters.iter().enumerate() {
            if let Role::Shape(tried) = p.role
                && !p.is_graded()
            {
                forms = with_each(&forms, i, tried);
            }
        }
        forms.retain(|f| *f != self.values);
        forms
    }
}

/// Each of the forms with each of those values at a place.
fn with_each(forms: &[Vec<f64>], place: usize, tried: &[f64]) -> Vec<Vec<f64>> {
    let with = |form: &Vec<f64>, v: f64| {
        let mut next = form.clone();
        next[place] = v;
        next
    };
    forms.iter().flat_map(|f| tried.iter().map(|v| with(f, *v)).collect::<Vec<_>>()).collect()
}

/// The effects of the catalogue that a lander may have.
pub(crate) fn catalogue() -> impl Iterator<Item = (usize, &'static Effect)> {
    CATALOGUE.iter().copied().enumerate().filter(|(_, e)| e.acts.on(Acts::Lander))
}

impl Model {
    /// The declared model.
    #[must_use]
    pub fn declared(campaign: &Campaign) -> Self {
        let members = campaign
            .knowledge
            .effects
            .iter()
            .map(|(effect, values)| Member { declared: true, ..Member::stated(effect, values, campaign) })
            .collect();
        Self { declared: campaign.plant.aero.values.clone(), constants: vec![0.0; campaign.knowledge.constants.len()], members }
    }

    /// The declared model with the effects that a check of the records has seen: where a search begins.
    #[must_use]
    pub(crate) fn seen(campaign: &Campaign) -> Self {
        let mut model = Self::declared(campaign);
        let known = |e: &Effect| campaign.knowledge.effects.iter().any(|(other, _)| *other == e);
        let seen = campaign.knowledge.seen.iter().filter(|(e, _)| !known(e));
        model.members.extend(seen.map(|(effect, values)| Member::stated(effect, values, campaign)));
        model
    }

    /// The plant that these values make.
    #[must_use]
    pub fn plant(&self, campaign: &Campaign) -> Plant {
        let mut plant = campaign.plant.clone();
        plant.aero.values.clone_from(&self.declared);
        for (c, offset) in campaign.knowledge.constants.iter().zip(&self.constants) {
            if let Some(x) = (c.lens)(&mut plant) {
                *x += offset;
            }
        }
        for m in &self.members {
            (m.effect.apply)(&mut plant, &m.values);
        }
        plant
    }

    /// The same effects with strengths stated at the trim speed of the model, where a tunnel speed is theirs to be stated at and the campaign does
    /// not declare it.
    #[must_use]
    pub(crate) fn at_trim(mut self, campaign: &Campaign) -> Self {
        let Some([_, density_kg_m3]) = campaign.tunnel_means() else { return self };
        let trim = trim_speed(&self.plant(campaign), density_kg_m3);
        for m in self.members.iter_mut().filter(|m| !m.declared) {
            for (p, v) in m.parameters.iter().zip(&mut m.values).filter(|(p, _)| p.role == Role::Reference && trim.is_finite()) {
                *v = trim.clamp(p.low, p.high);
            }
        }
        self
    }

    /// The same without random inputs that are not declared.
    pub(crate) fn calm(mut self) -> Self {
        self.members.retain(|m| !m.random || m.declared);
        self
    }

    /// Families of the effects that are neither declared nor random, ascending.
    pub(crate) fn found(&self) -> Vec<&'static str> {
        let mut all: Vec<&str> = self.members.iter().filter(|m| !m.random && !m.declared).map(|m| m.effect.family).collect();
        all.sort_unstable();
        all
    }

    /// Whether a number is the strength of a member.
    pub(crate) fn is_strength(&self, id: Id) -> bool {
        matches!(id, Id::Member(m, i) if self.members[m].parameters[i].role == Role::Strength)
    }

    /// Changes a number by `by`, within its range.
    pub fn change(&mut self, n: &Number, by: f64) {
        self.moved(n, by);
    }

    /// The same; by how much it was changed.
    pub(crate) fn moved(&mut self, n: &Number, by: f64) -> f64 {
        let value = match n.id {
            Id::Declared(i) => &mut self.declared[i],
            Id::Constant(i) => &mut self.constants[i],
            Id::Member(m, i) => &mut self.members[m].values[i],
            Id::Strength(..) | Id::Generic(_) => return 0.0,
        };
        let before = *value;
        *value = (before + by).clamp(n.range[0], n.range[1]);
        *value - before
    }

    /// Declared parameters and uncertain constants.
    #[must_use]
    pub fn known(&self, campaign: &Campaign) -> Vec<Number> {
        let mut all: Vec<Number> = (0..self.declared.len())
            .filter(|&i| campaign.declared[i])
            .map(|i| {
                let v = self.declared[i];
                Number {
                    id: Id::Declared(i),
                    value: 0.0,
                    prior: VAGUE_PRIOR * v.abs().max(campaign.plant.aero.values[i].abs()).max(1.0),
                    range: [f64::NEG_INFINITY, f64::INFINITY],
                    at_end: [false; 2],
                    step: 1e-4 * v.abs().max(0.1),
                }
            })
            .collect();
        all.extend(campaign.knowledge.constants.iter().enumerate().map(|(i, c)| Number {
            id: Id::Constant(i),
            value: self.constants[i],
            prior: c.std,
            range: [-50.0 * c.std, 50.0 * c.std],
            at_end: [false; 2],
            step: 0.1 * c.std,
        }));
        all
    }

    /// Strengths of the members that enter the mean, and their shapes when asked for.
    #[must_use]
    pub fn of_members(&self, shapes: bool) -> Vec<Number> {
        let mut all = Vec::new();
        for (k, m) in self.members.iter().enumerate().filter(|(_, m)| !m.random) {
            for (i, p) in m.parameters.iter().enumerate() {
                let (prior, step) = match p.role {
                    Role::Strength => (PLAUSIBLE * p.usual, strength_step(p)),
                    Role::Shape(_) if shapes && p.is_graded() => (0.5 * m.values[i].abs(), 1e-3 * m.values[i].abs().max(1e-6)),
                    Role::Instant if shapes => (0.2, 1e-3),
                    _ => continue,
                };
                let value = if p.role == Role::Strength { m.values[i] } else { 0.0 };
                let at_end = [m.values[i] <= p.low, m.values[i] >= p.high];
                all.push(Number { id: Id::Member(k, i), value, prior, range: [p.low, p.high], at_end, step });
            }
        }
        all
    }

    /// Columns of numbers, in their order.
    #[must_use]
    pub(crate) fn columns(&self, campaign: &Campaign, numbers: &[Number], generic: &[(Site, Basis)]) -> Vec<SensitivityColumn> {
        let base = self.plant(campaign);
        let mut forms: BTreeMap<usize, (Member, Vec<Vec<f64>>)> = BTreeMap::new();
        numbers
            .iter()
            .map(|n| {
                let plant = match n.id {
                    Id::Declared(i) => return SensitivityColumn::Declared(i),
                    Id::Generic(i) => {
                        let (site, basis) = generic[i];
                        return SensitivityColumn::Generic(site, basis);
                    }
                    Id::Strength(family, form, parameter) => {
                        let (member, forms) = forms.entry(family).or_insert_with(|| {
                            let m = Member::null(CATALOGUE[family], campaign);
                            let f = m.forms();
                            (m, f)
                        });
                        let mut values = forms[form].clone();
                        values[parameter] = n.step;
                        let mut plant = base.clone();
                        (member.effect.apply)(&mut plant, &values);
                        plant
                    }
                    _ => {
                        let mut moved = self.clone();
                        let mut wide = *n;
                        wide.range = [f64::NEG_INFINITY, f64::INFINITY];
                        moved.change(&wide, n.step);
                        moved.plant(campaign)
                    }
                };
                SensitivityColumn::Plant(Box::new(plant), n.step)
            })
            .collect()
    }
}

/// Step of a strength for differences.
pub(crate) fn strength_step(p: &Parameter) -> f64 {
    1e-4 * p.usual.min(1e3)
}

/// Strengths of every form of every effect that enters the mean and is not local; forms of the same family as a member are left out
/// but for those with shapes, of which the member is one more.
#[must_use]
pub(crate) fn candidates(campaign: &Campaign, model: &Model) -> Vec<Number> {
    let mut all = Vec::new();
    for (index, effect) in catalogue() {
        let null = Member::null(effect, campaign);
        let taken = model.members.iter().any(|m| m.effect.family == effect.family);
        let forms = null.forms();
        if null.random || null.is_local() || (taken && (forms.len() == 1 || model.plant(campaign).vehicle.loose.is_some())) {
            continue;
        }
        for form in 0..forms.len() {
            for i in null.strengths() {
                let p = &null.parameters[i];
                all.push(Number {
                    id: Id::Strength(index, form, i),
                    value: 0.0,
                    prior: PLAUSIBLE * p.usual,
                    range: [p.low, p.high],
                    at_end: [false; 2],
                    step: strength_step(p),
                });
            }
        }
    }
    all
}

#[cfg(test)]
mod tests;
