//! model: the aerodynamic terms laid out for speed. In: a structure with values. Out: the same coefficients, in two steps.
//!
//! A simulator needs the force before it knows the acceleration and the acceleration before it knows α̇, so terms that need
//! rates come in a second step. Terms of zero weight are left out and unused angles are not computed. Nothing is allocated
//! after [`AeroProgram::new`].

use crate::aero::{Aero, Factor, Term};
use crate::flow::{FlowState, VARIABLES, Variable};

/// Factors of a product that needs no branch: powers written out as repeated variables, the rest filled up with ones.
const WIDTH: usize = 4;
/// Index of the one behind the flow variables.
const ONE: usize = VARIABLES;
/// Room for the flow variables, the one, and a power of two that lets the compiler drop bounds checks.
const ROOM: usize = 16;

/// A term that is a product of at most [`WIDTH`] variables.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Product {
    coefficient: u8,
    variables: [u8; WIDTH],
    weight: f64,
}

/// Any other term: what it adds to, how much, and which of the flat list's factors it multiplies.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Op {
    coefficient: usize,
    weight: f64,
    first: usize,
    end: usize,
}

/// The terms of one step.
#[derive(Clone, Debug, Default, PartialEq)]
struct Step {
    products: Vec<Product>,
    others: Vec<Op>,
}

/// The terms of an [`Aero`] as flat lists.
#[derive(Clone, Debug, PartialEq)]
pub struct AeroProgram {
    factors: Vec<Factor>,
    early: Step,
    late: Step,
    needed: [bool; VARIABLES],
}

impl AeroProgram {
    /// Lays out the terms of `aero`.
    #[must_use]
    pub fn new(aero: &Aero) -> Self {
        let mut program = Self { factors: Vec::new(), early: Step::default(), late: Step::default(), needed: [false; VARIABLES] };
        for k in &aero.structure.contributions {
            program.push(k.coefficient as usize, aero.values[k.parameter], &k.term);
        }
        for (coefficient, value, term) in &aero.extra {
            program.push(*coefficient as usize, *value, term);
        }
        program
    }
    fn push(&mut self, coefficient: usize, value: f64, term: &Term) {
        let weight = value * term.scale;
        if weight == 0.0 {
            return;
        }
        for factor in &term.factors {
            self.needed[factor.variable() as usize] = true;
        }
        let step = if term.factors.iter().any(|f| f.needs_rates()) { &mut self.late } else { &mut self.early };
        if let Some(variables) = product(&term.factors) {
            #[expect(clippy::cast_possible_truncation, reason = "one of six coefficients")]
            step.products.push(Product { coefficient: coefficient as u8, variables, weight });
        } else {
            let first = self.factors.len();
            self.factors.extend(&term.factors);
            step.others.push(Op { coefficient, weight, first, end: self.factors.len() });
        }
    }
    /// Which flow variables the terms are made of, indexed by [`Variable`].
    #[must_use]
    pub fn needed(&self) -> &[bool; VARIABLES] {
        &self.needed
    }
    /// True when some term needs α̇ or β̇.
    #[must_use]
    pub fn needs_rates(&self) -> bool {
        self.needed[Variable::PitchDamping as usize] || self.needed[Variable::YawDamping as usize]
    }
    /// Adds the terms that need no acceleration to the six coefficients.
    #[inline(always)]
    pub fn early(&self, f: &FlowState, c: &mut [f64; 6]) {
        self.add(&self.early, f, c);
    }
    /// Adds the terms that need the damping variables.
    #[inline(always)]
    pub fn late(&self, f: &FlowState, c: &mut [f64; 6]) {
        self.add(&self.late, f, c);
    }
    #[inline(always)]
    fn add(&self, step: &Step, f: &FlowState, c: &mut [f64; 6]) {
        let mut values = [1.0; ROOM];
        values[..VARIABLES].copy_from_slice(&f.values);
        let mut sums = [0.0; 8];
        for p in &step.products {
            let [i, j, k, l] = p.variables.map(|v| values[usize::from(v) % ROOM]);
            sums[usize::from(p.coefficient) % 8] += (p.weight * i) * j * (k * l);
        }
        for op in &step.others {
            let factors = &self.factors[op.first..op.end];
            sums[op.coefficient % 8] += factors.iter().fold(op.weight, |product, factor| product * factor.value(f));
        }
        for (ci, sum) in c.iter_mut().zip(sums) {
            *ci += sum;
        }
    }
}

/// The factors as a product of variables, when they are powers of few enough.
fn product(factors: &[Factor]) -> Option<[u8; WIDTH]> {
    #[expect(clippy::cast_possible_truncation, reason = "at most the number of variables")]
    let mut out = [ONE as u8; WIDTH];
    let mut used = 0;
    for factor in factors {
        let Factor::Power(v, n) = *factor else { return None };
        for _ in 0..n {
            *out.get_mut(used)? = v as u8;
            used += 1;
        }
    }
    Some(out)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::aero::{Coefficient as C, Structure};
    use crate::flow::Variable as V;
    use crate::frames::Vec3;

    #[test]
    fn exact_both_steps_together_are_the_coefficients() {
        let values = vec![6.6, 3.5, -2.0, 0.0125, -5.7, -2.1, 2.5, -3.3, -205.0, -3.1, -190.0];
        let mut aero = Aero::new(Structure::axisymmetric(), values);
        aero.add(C::CN, 2.5, -0.5, &[Factor::Power(V::AlphaT, 4), Factor::CosClock(3)]);
        aero.add(C::Cm, 7.5, 1.0, &[Factor::Bump(V::Beta, 0.2), Factor::Power(V::PitchDamping, 1), Factor::SinClock(2)]);
        aero.add(C::CA, 0.7, 2.0, &[Factor::Power(V::SinAlphaT, 5)]);
        let program = AeroProgram::new(&aero);
        let (v, vd, w) = (Vec3::new(7.0, -1.2, 2.1), Vec3::new(-0.4, 3.1, -2.2), Vec3::new(0.3, -1.4, 0.9));
        let whole = FlowState::new(v, vd, w, 0.2125);
        let mut f = FlowState::without_rates(v, w, 0.2125, program.needed());
        let mut c = [0.0; 6];
        program.early(&f, &mut c);
        f.set_rates(v, vd, w, 0.2125);
        program.late(&f, &mut c);
        for (a, b) in c.iter().zip(aero.coefficients(&whole)) {
            // Round-off of at most nine terms of size below 10.
            assert!((a - b).abs() < 1e-13, "{a} {b}");
        }
    }
}
