//! sim: aerodynamic terms for lanes. In: the terms of one flight. Out: a layout that flights of equal structure share, the
//! numbers in which they differ, and the six coefficients on all lanes.
//!
//! Every term is a product of slots. `sinᵃ α_T sinᵇ φ cosᶜ φ` is written with v/V, w/V and sin² α_T as far as it goes: a square
//! root and two divisions fewer, and nothing singular at α_T = 0.

use super::lane::Lanes;
use pulp::Simd;
use windfall_model::{Aero, Factor, Variable, VARIABLES};

/// Slots beyond the flow variables: sin² α_T, v/V, w/V.
pub(super) const SIN2: usize = VARIABLES;
pub(super) const V_HAT: usize = VARIABLES + 1;
pub(super) const W_HAT: usize = VARIABLES + 2;
/// First of the slots that a structure adds: clock harmonics and bumps.
const ADDED: usize = VARIABLES + 3;
/// Room for slots, a power of two that lets the compiler drop bounds checks.
pub(super) const ROOM: usize = 32;

/// A slot that a structure adds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Added {
    /// cos(n φ).
    Cos(u8),
    /// sin(n φ).
    Sin(u8),
    /// sech²(slot/width), the width by lane.
    Bump(u8),
}

/// A run of the flat list of slots that is one term of one coefficient.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
struct Op {
    coefficient: u8,
    first: u8,
    end: u8,
}

/// What flights side by side must have in common: which slots each term multiplies.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub(super) struct Layout {
    slots: Vec<u8>,
    /// Terms that need no acceleration come first, `early` of them.
    ops: Vec<Op>,
    early: usize,
    added: Vec<Added>,
    /// Flow variables that some term is made of.
    pub(super) needs: [bool; VARIABLES],
}

/// The terms of one flight.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Terms {
    pub(super) layout: Layout,
    /// Parameter times constant, one a term.
    pub(super) weights: Vec<f64>,
    /// 1/width of each added slot; 1 where it has none.
    pub(super) per_width: Vec<f64>,
}

impl Terms {
    /// Terms of `aero` without those of zero weight; `None` when there are more than the slots or the list hold.
    pub(super) fn new(aero: &Aero) -> Option<Self> {
        let declared = aero.structure.contributions.iter().map(|k| (k.coefficient, aero.values[k.parameter], &k.term));
        let extra = aero.extra.iter().map(|(coefficient, value, term)| (*coefficient, *value, term));
        let mut all: Vec<_> = declared.chain(extra).map(|(c, value, term)| (c, value * term.scale, &term.factors)).collect();
        all.retain(|(_, weight, _)| *weight != 0.0);
        let late = |factors: &[Factor]| factors.iter().any(|f| f.needs_rates());
        all.sort_by_key(|(c, _, factors)| (late(factors), *c as u8));
        let mut terms = Self::default();
        for (coefficient, weight, factors) in all {
            let first = u8::try_from(terms.layout.slots.len()).ok()?;
            terms.push(factors)?;
            let end = u8::try_from(terms.layout.slots.len()).ok()?;
            terms.layout.ops.push(Op { coefficient: coefficient as u8, first, end });
            terms.layout.early += usize::from(!late(factors));
            terms.weights.push(weight);
        }
        Some(terms)
    }

    fn push(&mut self, factors: &[Factor]) -> Option<()> {
        let mut powers = [0_u8; ADDED];
        for factor in factors {
            match *factor {
                Factor::Power(v, n) => powers[v as usize] += n,
                Factor::CosClock(n) => self.push_added(Added::Cos(n), Variable::CosPhi, 1.0)?,
                Factor::SinClock(n) => self.push_added(Added::Sin(n), Variable::CosPhi, 1.0)?,
                Factor::Bump(v, width) => self.push_added(Added::Bump(v as u8), v, 1.0 / width)?,
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
            for _ in 0..power {
                self.layout.slots.push(u8::try_from(slot).ok()?);
            }
            if power > 0 && slot < VARIABLES {
                self.layout.needs[slot] = true;
            }
        }
        Some(())
    }

    fn push_added(&mut self, added: Added, needs: Variable, per_width: f64) -> Option<()> {
        self.layout.needs[needs as usize] = true;
        let same = |(a, w): (&Added, &f64)| *a == added && w.to_bits() == per_width.to_bits();
        let place = self.layout.added.iter().zip(&self.per_width).position(same).unwrap_or(self.layout.added.len());
        if place == self.layout.added.len() {
            self.layout.added.push(added);
            self.per_width.push(per_width);
        }
        if ADDED + place >= ROOM {
            return None;
        }
        self.layout.slots.push(u8::try_from(ADDED + place).ok()?);
        Some(())
    }
}

impl Layout {
    /// True when some term needs α̇ or β̇.
    pub(super) fn needs_rates(&self) -> bool {
        self.needs[Variable::PitchDamping as usize] || self.needs[Variable::YawDamping as usize]
    }
    /// True when a force, not only a moment, depends on α̇ or β̇.
    pub(super) fn force_needs_rates(&self) -> bool {
        self.ops[self.early..].iter().any(|op| op.coefficient < 3)
    }
    /// Fills the added slots; with `late` those made of damping variables, without the others.
    #[inline(always)]
    pub(super) fn fill<S: Simd>(&self, late: bool, per_width: &[Lanes<S>], slots: &mut [Lanes<S>; ROOM]) {
        for (k, added) in self.added.iter().enumerate() {
            let damping = matches!(added, Added::Bump(v) if usize::from(*v) == Variable::PitchDamping as usize || usize::from(*v) == Variable::YawDamping as usize);
            if damping != late {
                continue;
            }
            slots[(ADDED + k) % ROOM] = match *added {
                Added::Bump(v) => sech2(slots[usize::from(v) % ROOM] * per_width[k]),
                Added::Cos(n) => harmonic(slots, n).0,
                Added::Sin(n) => harmonic(slots, n).1,
            };
        }
    }
    /// Adds the terms that need no acceleration (`late` false) or the others to the six coefficients.
    #[inline(always)]
    pub(super) fn add<S: Simd>(&self, late: bool, weights: &[Lanes<S>], slots: &[Lanes<S>; ROOM], c: &mut [Lanes<S>; 6]) {
        let (from, to) = if late { (self.early, self.ops.len()) } else { (0, self.early) };
        let mut k = from;
        while k < to {
            let coefficient = self.ops[k].coefficient;
            let mut sum = c[usize::from(coefficient) % 6];
            while k < to && self.ops[k].coefficient == coefficient {
                let run = &self.slots[usize::from(self.ops[k].first)..usize::from(self.ops[k].end)];
                let weight = weights[k];
                sum = match *run {
                    [] => sum + weight,
                    [a] => weight.mul_add(slot(slots, a), sum),
                    [a, b] => (weight * slot(slots, a)).mul_add(slot(slots, b), sum),
                    [a, ref rest @ ..] => {
                        let mut product = slot(slots, a);
                        for &b in rest {
                            product = product * slot(slots, b);
                        }
                        weight.mul_add(product, sum)
                    }
                };
                k += 1;
            }
            c[usize::from(coefficient) % 6] = sum;
        }
    }
}

#[inline(always)]
fn slot<S: Simd>(slots: &[Lanes<S>; ROOM], k: u8) -> Lanes<S> {
    slots[usize::from(k) % ROOM]
}

/// sech² x = 4e/(1 + e)² with e = exp(−2|x|).
#[inline(always)]
fn sech2<S: Simd>(x: Lanes<S>) -> Lanes<S> {
    let e = x.abs().scale(-2.0).exp_of_negative();
    let per = (e.plus(1.0)).recip();
    (e * per).scale(4.0) * per
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
