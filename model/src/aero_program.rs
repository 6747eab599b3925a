//! model: the aerodynamic terms laid out for speed. In: a structure with values. Out: the same coefficients, in two steps.
//!
//! A simulator needs the force before it knows the acceleration and the acceleration before it knows α̇, so terms that need
//! rates come in a second step. Terms of zero weight are left out and unused angles are not computed. Nothing is allocated
//! after [`AeroProgram::new`].

use crate::aero::{Aero, Factor, Term};
use crate::flow::{FlowState, VARIABLES, Variable};

/// One term: what it adds to, how much, and which of the flat list's factors it multiplies.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Op {
    coefficient: usize,
    weight: f64,
    first: usize,
    end: usize,
}

/// The terms of an [`Aero`] as flat lists.
#[derive(Clone, Debug, PartialEq)]
pub struct AeroProgram {
    factors: Vec<Factor>,
    early: Vec<Op>,
    late: Vec<Op>,
    needed: [bool; VARIABLES],
}

impl AeroProgram {
    /// Lays out the terms of `aero`.
    #[must_use]
    pub fn new(aero: &Aero) -> Self {
        let mut program = Self { factors: Vec::new(), early: Vec::new(), late: Vec::new(), needed: [false; VARIABLES] };
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
        let first = self.factors.len();
        self.factors.extend(&term.factors);
        for factor in &term.factors {
            self.needed[factor.variable() as usize] = true;
        }
        let op = Op { coefficient, weight, first, end: self.factors.len() };
        let steps = if term.factors.iter().any(|f| f.needs_rates()) { &mut self.late } else { &mut self.early };
        steps.push(op);
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
    #[inline]
    pub fn early(&self, f: &FlowState, c: &mut [f64; 6]) {
        self.add(&self.early, f, c);
    }
    /// Adds the terms that need the damping variables.
    #[inline]
    pub fn late(&self, f: &FlowState, c: &mut [f64; 6]) {
        self.add(&self.late, f, c);
    }
    #[inline]
    fn add(&self, steps: &[Op], f: &FlowState, c: &mut [f64; 6]) {
        for op in steps {
            let factors = &self.factors[op.first..op.end];
            c[op.coefficient] += factors.iter().fold(op.weight, |product, factor| product * factor.value(f));
        }
    }
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
        aero.add(C::CN, 2.5, -1.0, &[Factor::Power(V::AlphaT, 4), Factor::CosClock(3)]);
        aero.add(C::Cm, 7.5, 1.0, &[Factor::Bump(V::Beta, 0.2), Factor::Power(V::PitchDamping, 1), Factor::SinClock(2)]);
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
