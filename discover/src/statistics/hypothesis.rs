//! discover: effects with their parameters on [0, 1]. In: catalogue entries. Out: a plant for every point of the unit cube.

use windfall_model::effects::{Effect, Parameter, Role};
use windfall_model::{Freedom, Plant, Transform, Unknown, UnknownId, Unknowns};

/// Decades below its plausible limit over which a strength is searched; at the bottom it does nothing that could be measured.
const DECADES: f64 = 4.0;

/// Effects that act together: their parameters are the vector of unknowns, each with its catalogue entry.
#[derive(Clone, Debug)]
pub(super) struct Hypothesis {
    unknowns: Unknowns,
    /// Catalogue entries of the numbers, in their order.
    parameters: Vec<Parameter>,
    duration_s: f64,
}

/// Means over runs tell neither the run in which something acts nor the form of a spectrum; both are null. A speed at which strengths are
/// stated tells nothing.
fn is_searched(p: &Parameter) -> bool {
    !matches!(p.role, Role::Run | Role::AeroPlace | Role::Reference) && !p.parts_forms()
}

/// Values where everything is: one number in [0, 1] for each searched parameter.
pub(super) type Place = Vec<f64>;

impl Hypothesis {
    pub(super) fn none(duration_s: f64) -> Self {
        Self { unknowns: Unknowns::default(), parameters: Vec::new(), duration_s }
    }
    pub(super) fn with(&self, effect: &'static Effect) -> Self {
        let mut next = self.clone();
        let place = next.unknowns.act(effect);
        for (i, p) in (effect.parameters)(&[]).into_iter().enumerate().filter(|(_, p)| is_searched(p)) {
            let transform = match p.role {
                Role::Strength => Transform::Decades { end: p.high, decades: DECADES },
                Role::Instant => Transform::Share { low: 0.0, high: self.duration_s },
                _ if p.low > 0.0 => Transform::LogShare { low: p.low, high: p.high },
                _ => Transform::Share { low: p.low, high: p.high },
            };
            let freedom = Freedom::Free(next.unknowns.free());
            let id = UnknownId::Effect(place, i);
            next.unknowns.all.push(Unknown { transform, ..Unknown::linear(id, &p.name, 0.5, freedom) });
            next.parameters.push(p);
        }
        next
    }
    /// Effects, in the order in which they were added.
    pub(super) fn effects(&self) -> &[&'static Effect] {
        self.unknowns.effects()
    }
    pub(super) fn families(&self) -> Vec<&'static str> {
        self.effects().iter().map(|e| e.family).collect()
    }
    /// Effect and catalogue entry of parameter `i`.
    pub(super) fn entry(&self, i: usize) -> (&'static Effect, &Parameter) {
        (self.effects()[self.place_of(i)], &self.parameters[i])
    }
    /// Place of the effect of parameter `i`.
    fn place_of(&self, i: usize) -> usize {
        if let UnknownId::Effect(place, _) = self.unknowns.all[i].id { place } else { 0 }
    }
    /// Number of parameters, held ones included.
    pub(super) fn dimension(&self) -> usize {
        self.parameters.len()
    }
    /// Value of parameter `i` where it is not searched after all: a strength that is off, a shape that does nothing.
    pub(super) fn held(&self, i: usize) -> Option<f64> {
        if let Freedom::Held(value) = self.unknowns.all[i].freedom { Some(value) } else { None }
    }
    /// Parameters that are searched.
    pub(super) fn searched(&self) -> Vec<usize> {
        (0..self.dimension()).filter(|&i| self.held(i).is_none()).collect()
    }
    /// Strengths that are searched.
    pub(super) fn strengths(&self) -> Vec<usize> {
        self.searched().into_iter().filter(|&i| self.is_strength(i)).collect()
    }
    /// Whether parameter `i` is a strength.
    pub(super) fn is_strength(&self, i: usize) -> bool {
        self.parameters[i].role == Role::Strength
    }
    /// Place of the typical value of a shape.
    pub(super) fn typical(&self, i: usize) -> f64 {
        self.place(i, self.parameters[i].null)
    }
    /// Number of parameters of the last effect.
    pub(super) fn of_last(&self) -> usize {
        (0..self.dimension()).filter(|&i| self.place_of(i) + 1 == self.effects().len()).count()
    }
    /// Takes sign and hold of parameter `i` from parameter `j` of another hypothesis.
    pub(super) fn copy(&mut self, i: usize, from: &Self, j: usize) {
        self.unknowns.all[i].transform = from.unknowns.all[j].transform;
        if let Some(value) = from.held(j) {
            self.unknowns.hold_at(i, value);
        }
    }
    /// With parameter `i` held at its null value: a strength off, a shape typical.
    pub(super) fn without(&self, i: usize) -> Self {
        self.holding(i, self.parameters[i].null)
    }
    /// With parameter `i` held at a value.
    pub(super) fn holding(&self, i: usize, value: f64) -> Self {
        let mut next = self.clone();
        next.unknowns.hold_at(i, value);
        next
    }
    /// Values of shape `i` that the catalogue tries.
    pub(super) fn tried(&self, i: usize) -> &'static [f64] {
        if let Role::Shape(tried) = self.parameters[i].role { tried } else { &[] }
    }
    /// Value of parameter `i` at `x` in [0, 1].
    pub(super) fn value(&self, i: usize, x: f64) -> f64 {
        self.held(i).unwrap_or_else(|| self.unknowns.all[i].transform.value(x))
    }
    /// Place of a value of parameter `i`, without its sign.
    pub(super) fn place(&self, i: usize, value: f64) -> f64 {
        self.unknowns.all[i].transform.at(value)
    }
    /// Sum of squares of the shapes' distances from their typical values.
    pub(super) fn shape_distance(&self, x: &[f64]) -> f64 {
        let shape = |i: &usize| matches!(self.parameters[*i].role, Role::Shape(_));
        self.searched().into_iter().filter(shape).map(|i| (x[i] - self.typical(i)).powi(2)).sum()
    }
    /// `base` with the effects at place `x`.
    pub(super) fn plant(&self, base: &Plant, x: &[f64]) -> Plant {
        let mut there = self.unknowns.clone();
        there.all.iter_mut().zip(x).for_each(|(u, x)| u.at = *x);
        there.plant(base).for_run(0, &[])
    }
    /// Point `k` of an even cover of the parameters from number `from` on, with signs for strengths that have both: the additive
    /// sequence of the generalised golden ratio (Roberts 2018). Gives the searched parameters before `from` no new place.
    pub(super) fn cover(&mut self, from: usize, k: usize, at: &mut Place) {
        let d = self.dimension() - from;
        let ratio = golden(2 * d);
        let spread = |j: usize| (0.5 + (k as f64 + 1.0) * ratio.powi(-(j as i32 + 1))).fract();
        for j in 0..d {
            at[from + j] = match self.parameters[from + j].role {
                // Shapes that the catalogue tries, in turn.
                Role::Shape(tried) if !tried.is_empty() => {
                    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 ≤ spread < 1")]
                    let turn = (spread(2 * j) * tried.len() as f64) as usize;
                    self.place(from + j, tried[turn])
                }
                _ => spread(2 * j),
            };
            let p = &self.parameters[from + j];
            if p.role == Role::Strength {
                let sign = if p.low < 0.0 && spread(2 * j + 1) < 0.5 { -1.0 } else { 1.0 };
                self.unknowns.all[from + j].transform = Transform::Decades { end: sign * p.high, decades: DECADES };
            }
        }
    }
}

/// Root above one of `x^(d+1) = x + 1`.
fn golden(d: usize) -> f64 {
    let power = 1.0 / (d as f64 + 1.0);
    (0..64).fold(1.5_f64, |x, _| (1.0 + x).powf(power))
}

#[cfg(test)]
mod tests;
