//! verify: effects with their parameters on [0, 1]. In: catalogue entries. Out: a plant for every point of the unit cube.

use windfall_model::Plant;
use windfall_model::effects::{Effect, Parameter, Role};

/// Decades below its plausible limit over which a strength is searched; at the bottom it does nothing that could be measured.
const DECADES: f64 = 4.0;

/// Effects that act together.
#[derive(Clone, Debug)]
pub(super) struct Hypothesis {
    pub(super) effects: Vec<&'static Effect>,
    /// Parameters that are searched, with the place of their effect.
    pub(super) free: Vec<(usize, Parameter)>,
    /// Sign of each searched parameter, for strengths that have both.
    pub(super) signs: Vec<f64>,
    /// Value of each parameter that is not searched after all: a strength that is off, a shape that does nothing.
    pub(super) held: Vec<Option<f64>>,
    duration_s: f64,
}

/// Means over runs tell neither the run in which something acts nor the form of a spectrum; both are zero.
fn is_searched(p: &Parameter) -> bool {
    p.role != Role::Run && !p.parts_forms()
}

/// Values where everything is: one number in [0, 1] for each searched parameter.
pub(super) type Place = Vec<f64>;

impl Hypothesis {
    pub(super) fn none(duration_s: f64) -> Self {
        Self { effects: Vec::new(), free: Vec::new(), signs: Vec::new(), held: Vec::new(), duration_s }
    }
    pub(super) fn with(&self, effect: &'static Effect) -> Self {
        let mut next = self.clone();
        let place = next.effects.len();
        next.effects.push(effect);
        for p in (effect.parameters)(&[]).into_iter().filter(is_searched) {
            next.free.push((place, p));
            next.signs.push(1.0);
            next.held.push(None);
        }
        next
    }
    pub(super) fn families(&self) -> Vec<&'static str> {
        self.effects.iter().map(|e| e.family).collect()
    }
    /// Number of parameters, held ones included.
    pub(super) fn dimension(&self) -> usize {
        self.free.len()
    }
    /// Parameters that are searched.
    pub(super) fn searched(&self) -> Vec<usize> {
        (0..self.free.len()).filter(|&i| self.held[i].is_none()).collect()
    }
    /// Strengths that are searched.
    pub(super) fn strengths(&self) -> Vec<usize> {
        self.searched().into_iter().filter(|&i| self.is_strength(i)).collect()
    }
    /// Whether parameter `i` is a strength.
    pub(super) fn is_strength(&self, i: usize) -> bool {
        self.free[i].1.role == Role::Strength
    }
    /// Place of the typical value of a shape.
    pub(super) fn typical(&self, i: usize) -> f64 {
        self.place(i, self.free[i].1.null)
    }
    /// Number of parameters of the last effect.
    pub(super) fn of_last(&self) -> usize {
        self.free.iter().filter(|(k, _)| *k + 1 == self.effects.len()).count()
    }
    /// Takes sign and hold of parameter `i` from parameter `j` of another hypothesis.
    pub(super) fn copy(&mut self, i: usize, from: &Self, j: usize) {
        self.signs[i] = from.signs[j];
        self.held[i] = from.held[j];
    }
    /// With parameter `i` held at its null value: a strength off, a shape typical.
    pub(super) fn without(&self, i: usize) -> Self {
        self.holding(i, self.free[i].1.null)
    }
    /// With parameter `i` held at a value.
    pub(super) fn holding(&self, i: usize, value: f64) -> Self {
        let mut next = self.clone();
        next.held[i] = Some(value);
        next
    }
    /// Values of shape `i` that the catalogue tries.
    pub(super) fn tried(&self, i: usize) -> &'static [f64] {
        if let Role::Shape(tried) = self.free[i].1.role { tried } else { &[] }
    }
    /// Value of searched parameter `i` at `x` in [0, 1].
    pub(super) fn value(&self, i: usize, x: f64) -> f64 {
        if let Some(value) = self.held[i] {
            return value;
        }
        let p = &self.free[i].1;
        let x = x.clamp(0.0, 1.0);
        match p.role {
            Role::Strength => self.signs[i] * p.high * 10.0_f64.powf(-DECADES * (1.0 - x)),
            Role::Instant => x * self.duration_s,
            _ if p.low > 0.0 => p.low * (p.high / p.low).powf(x),
            _ => p.low + x * (p.high - p.low),
        }
    }
    /// Place of a value of parameter `i`, without its sign.
    pub(super) fn place(&self, i: usize, value: f64) -> f64 {
        let p = &self.free[i].1;
        let x = match p.role {
            Role::Strength => 1.0 + (value.abs() / p.high).max(1e-300).log10() / DECADES,
            Role::Instant => value / self.duration_s,
            _ if p.low > 0.0 => (value / p.low).ln() / (p.high / p.low).ln(),
            _ => (value - p.low) / (p.high - p.low),
        };
        x.clamp(0.0, 1.0)
    }
    /// Sum of squares of the shapes' distances from their typical values.
    pub(super) fn astray(&self, x: &[f64]) -> f64 {
        let shape = |i: &usize| matches!(self.free[*i].1.role, Role::Shape(_));
        self.searched().into_iter().filter(shape).map(|i| (x[i] - self.typical(i)).powi(2)).sum()
    }
    /// `base` with the effects at place `x`.
    pub(super) fn plant(&self, base: &Plant, x: &[f64]) -> Plant {
        let mut plant = base.clone();
        for (k, effect) in self.effects.iter().enumerate() {
            let mut own = (0..self.free.len()).filter(|&i| self.free[i].0 == k);
            let mut values = Vec::new();
            for p in (effect.parameters)(&[]) {
                let searched = if is_searched(&p) { own.next() } else { None };
                values.push(searched.map_or(0.0, |i| self.value(i, x[i])));
            }
            (effect.apply)(&mut plant, &values);
        }
        plant.for_run(0, &[])
    }
    /// Point `k` of an even cover of the parameters from number `from` on, with signs for strengths that have both: the additive
    /// sequence of the generalised golden ratio (Roberts 2018). Gives the searched parameters before `from` no new place.
    pub(super) fn cover(&mut self, from: usize, k: usize, at: &mut Place) {
        let d = self.free.len() - from;
        let ratio = golden(2 * d);
        let spread = |j: usize| (0.5 + (k as f64 + 1.0) * ratio.powi(-(j as i32 + 1))).fract();
        for j in 0..d {
            at[from + j] = match self.free[from + j].1.role {
                // Shapes that the catalogue tries, in turn.
                Role::Shape(tried) if !tried.is_empty() => {
                    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 ≤ spread < 1")]
                    let turn = (spread(2 * j) * tried.len() as f64) as usize;
                    self.place(from + j, tried[turn.min(tried.len() - 1)])
                }
                _ => spread(2 * j),
            };
            let both = self.free[from + j].1.low < 0.0 && self.free[from + j].1.role == Role::Strength;
            self.signs[from + j] = if both && spread(2 * j + 1) < 0.5 { -1.0 } else { 1.0 };
        }
    }
}

/// Root above one of `x^(d+1) = x + 1`.
fn golden(d: usize) -> f64 {
    let power = 1.0 / (d as f64 + 1.0);
    (0..64).fold(1.5_f64, |x, _| (1.0 + x).powf(power))
}
