//! sim: aerodynamic terms for lanes. In: the terms of one flight. Out: a layout that flights of equal structure share, the
//! numbers in which they differ, and the six coefficients on all lanes.
//!
//! Every term is a weight times one slot: a flow variable, a clock harmonic, a bump, or a product of two slots, each product
//! computed once however many terms have it. `sinᵃ α_T sinᵇ φ cosᶜ φ` is written with v/V, w/V and sin² α_T as far as it goes: a
//! square root and two divisions fewer, and nothing singular at α_T = 0.

use super::lane::Lanes;
use pulp::Simd;
use windfall_model::{Aero, Factor, VARIABLES, Variable};

/// Slots beyond the flow variables: sin² α_T, v/V, w/V, and 1.
pub(super) const SIN2: usize = VARIABLES;
pub(super) const V_HAT: usize = VARIABLES + 1;
pub(super) const W_HAT: usize = VARIABLES + 2;
pub(super) const ONE: usize = VARIABLES + 3;
/// First of the slots that a structure adds.
const ADDED: usize = VARIABLES + 4;
/// Room for slots, a power of two that lets the compiler drop bounds checks.
pub(super) const ROOM: usize = 64;

/// A function of a slot.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Shape {
    /// cos(n φ).
    Cos(u8),
    /// sin(n φ).
    Sin(u8),
    /// sech²(slot/width), the width by lane.
    Bump(u8),
}

/// What a structure adds in one step, before the acceleration is known or after.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
struct Step {
    /// Slot, function, and place of its width.
    shapes: Vec<(u8, Shape, u8)>,
    /// Slot and the two that it is the product of.
    products: Vec<[u8; 3]>,
    /// Coefficient and slot, one a term.
    terms: Vec<[u8; 2]>,
}

/// What flights side by side must have in common.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub(super) struct Layout {
    early: Step,
    late: Step,
    /// Slots that the structure adds, so far.
    added: usize,
    /// Flow variables that some term is made of.
    pub(super) needs: [bool; VARIABLES],
}

/// The terms of one flight.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct LaneTerms {
    pub(super) layout: Layout,
    /// Parameter times constant, one a term, early terms first.
    pub(super) weights: Vec<f64>,
    /// 1/width of each bump; 1 for a harmonic.
    pub(super) per_width: Vec<f64>,
}

impl LaneTerms {
    /// Terms of `aero` without those of zero weight; `None` when they need more slots than there are.
    pub(super) fn new(aero: &Aero) -> Option<Self> {
        let declared = aero.structure.contributions.iter().map(|k| (k.coefficient, aero.values[k.parameter], &k.term));
        let extra = aero.extra.iter().map(|(coefficient, value, term)| (*coefficient, *value, term));
        let mut terms = Self::default();
        let mut late = Vec::new();
        for (coefficient, value, term) in declared.chain(extra) {
            let weight = value * term.scale;
            if weight == 0.0 {
                continue;
            }
            let slot = terms.monomial(&term.factors)?;
            if terms.layout.is_late(slot) {
                terms.layout.late.terms.push([coefficient as u8, slot]);
                late.push(weight);
            } else {
                terms.layout.early.terms.push([coefficient as u8, slot]);
                terms.weights.push(weight);
            }
        }
        terms.weights.extend(late);
        Some(terms)
    }

    /// The slot that holds the product of the factors.
    fn monomial(&mut self, factors: &[Factor]) -> Option<u8> {
        let mut powers = [0_u8; ADDED];
        let mut slots = Vec::new();
        for factor in factors {
            match *factor {
                Factor::Power(v, n) => powers[v as usize] += n,
                Factor::CosClock(n) => slots.push(self.shape(Shape::Cos(n), Variable::CosPhi, 1.0)?),
                Factor::SinClock(n) => slots.push(self.shape(Shape::Sin(n), Variable::CosPhi, 1.0)?),
                Factor::Bump(v, width) => slots.push(self.shape(Shape::Bump(v as u8), v, 1.0 / width)?),
            }
        }
        let [sin, sin_phi, cos_phi] = [Variable::SinAlphaT, Variable::SinPhi, Variable::CosPhi].map(|v| v as usize);
        for (phi, hat) in [(sin_phi, V_HAT), (cos_phi, W_HAT)] {
            let pairs = powers[sin].min(powers[phi]);
            powers[sin] -= pairs;
            powers[phi] -= pairs;
            powers[hat] += pairs;
        }
        powers[SIN2] = powers[sin] / 2;
        powers[sin] %= 2;
        for (slot, &power) in powers.iter().enumerate() {
            slots.extend((0..power).map(|_| u8::try_from(slot).expect("below the room")));
            if power > 0 && slot < VARIABLES {
                self.layout.needs[slot] = true;
            }
        }
        // What needs the acceleration comes last, so that what it multiplies is ready before.
        slots.sort_by_key(|&slot| (self.layout.is_late(slot), slot));
        let first = slots.first().copied().unwrap_or(ONE as u8);
        slots.iter().skip(1).try_fold(first, |a, &b| self.product(a, b))
    }

    fn product(&mut self, a: u8, b: u8) -> Option<u8> {
        let layout = &mut self.layout;
        let late = layout.is_late(a) || layout.is_late(b);
        let slot = layout.fresh();
        let products = if late { &mut layout.late.products } else { &mut layout.early.products };
        if let Some(known) = products.iter().find(|p| p[1..] == [a, b]) {
            return Some(known[0]);
        }
        products.push([slot?, a, b]);
        layout.added += 1;
        slot
    }

    fn shape(&mut self, shape: Shape, needs: Variable, per_width: f64) -> Option<u8> {
        let layout = &mut self.layout;
        layout.needs[needs as usize] = true;
        let late = matches!(shape, Shape::Bump(v) if is_damping(v));
        let slot = layout.fresh();
        let shapes = if late { &mut layout.late.shapes } else { &mut layout.early.shapes };
        let same = |&&(_, s, w): &&(u8, Shape, u8)| s == shape && self.per_width[usize::from(w)].to_bits() == per_width.to_bits();
        if let Some(known) = shapes.iter().find(same) {
            return Some(known.0);
        }
        shapes.push((slot?, shape, u8::try_from(self.per_width.len()).ok()?));
        self.per_width.push(per_width);
        layout.added += 1;
        slot
    }
}

fn is_damping(slot: u8) -> bool {
    usize::from(slot) == Variable::PitchDamping as usize || usize::from(slot) == Variable::YawDamping as usize
}

impl Layout {
    /// The next slot to be added, if there is room.
    fn fresh(&self) -> Option<u8> {
        u8::try_from(ADDED + self.added).ok().filter(|&slot| usize::from(slot) < ROOM)
    }
    fn is_late(&self, slot: u8) -> bool {
        let late = &self.late;
        is_damping(slot) || late.shapes.iter().any(|s| s.0 == slot) || late.products.iter().any(|p| p[0] == slot)
    }
    /// True when some term needs α̇ or β̇.
    pub(super) fn needs_rates(&self) -> bool {
        !self.late.terms.is_empty()
    }
    /// True when a force, not only a moment, depends on α̇ or β̇.
    pub(super) fn force_needs_rates(&self) -> bool {
        self.late.terms.iter().any(|t| t[0] < 3)
    }
    /// Adds to the six coefficients the terms that need no acceleration (`late` false) or the others, filling their slots.
    #[inline(always)]
    pub(super) fn add<S: Simd>(
        &self,
        late: bool,
        weights: &[Lanes<S>],
        per_width: &[Lanes<S>],
        slots: &mut [Lanes<S>; ROOM],
        c: &mut [Lanes<S>; 8],
    ) {
        let early = self.early.terms.len();
        let (step, weights) = if late { (&self.late, &weights[early..]) } else { (&self.early, &weights[..early]) };
        for &(slot, shape, width) in &step.shapes {
            let value = match shape {
                Shape::Bump(v) => (slots[usize::from(v) % ROOM] * per_width[usize::from(width)]).sech2(),
                Shape::Cos(n) => harmonic(slots, n).0,
                Shape::Sin(n) => harmonic(slots, n).1,
            };
            slots[usize::from(slot) % ROOM] = value;
        }
        for &[slot, a, b] in &step.products {
            slots[usize::from(slot) % ROOM] = slots[usize::from(a) % ROOM] * slots[usize::from(b) % ROOM];
        }
        for (&[coefficient, slot], weight) in step.terms.iter().zip(weights) {
            let sum = &mut c[usize::from(coefficient) % 8];
            *sum = weight.mul_add(slots[usize::from(slot) % ROOM], *sum);
        }
    }
}

/// cos nφ and sin nφ by the recurrence of the complex power.
#[inline(always)]
fn harmonic<S: Simd>(slots: &[Lanes<S>; ROOM], n: u8) -> (Lanes<S>, Lanes<S>) {
    let (c1, s1) = (slots[Variable::CosPhi as usize], slots[Variable::SinPhi as usize]);
    let (mut c, mut s) = (c1.scale(0.0).plus(1.0), s1.scale(0.0));
    for _ in 0..n {
        (c, s) = (s.neg_mul_add(s1, c * c1), c.mul_add(s1, s * c1));
    }
    (c, s)
}
