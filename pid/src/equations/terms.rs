//! pid: aerodynamic terms as numbers with derivatives. In: flow variables and parameters. Out: six coefficients.

use super::Scalar;
use windfall_model::{Aero, Factor, VARIABLES, Variable};

/// One product: what it adds to and by which parameter.
#[derive(Clone, Debug)]
struct Product {
    coefficient: usize,
    /// Index of the parameter, none for what effects added.
    parameter: Option<usize>,
    scale: f64,
    factors: Vec<Factor>,
    /// Its place in the list of term values.
    index: usize,
}

/// All terms of an aerodynamic model, those that need accelerations apart.
#[derive(Clone, Debug)]
pub(crate) struct Terms {
    early: Vec<Product>,
    late: Vec<Product>,
    /// Which flow variables they are made of.
    pub(crate) needed: [bool; VARIABLES],
    /// Coefficient and parameter of each term, in the order of the term values.
    pub(crate) acts: Vec<(usize, Option<usize>)>,
    /// Whether a force, too, depends on accelerations.
    pub(crate) late_forces: bool,
}

impl Terms {
    pub(crate) fn new(aero: &Aero) -> Self {
        let declared = aero.structure.contributions.iter().map(|k| (k.coefficient, Some(k.parameter), 1.0, &k.term));
        let extra = aero.extra.iter().map(|(c, value, term)| (*c, None, *value, term));
        let mut terms =
            Self { early: Vec::new(), late: Vec::new(), needed: [false; VARIABLES], acts: Vec::new(), late_forces: false };
        for (index, (coefficient, parameter, value, term)) in declared.chain(extra).enumerate() {
            for factor in &term.factors {
                terms.needed[factor.variable() as usize] = true;
            }
            let product = Product {
                coefficient: coefficient as usize,
                parameter,
                scale: value * term.scale,
                factors: term.factors.clone(),
                index,
            };
            terms.acts.push((product.coefficient, parameter));
            if term.factors.iter().any(|f| f.needs_rates()) {
                terms.late_forces |= product.coefficient < 3;
                terms.late.push(product);
            } else {
                terms.early.push(product);
            }
        }
        terms
    }
    pub(crate) fn needs_rates(&self) -> bool {
        !self.late.is_empty()
    }
    #[inline(always)]
    pub(crate) fn add_early<S: Scalar>(&self, f: &[S; VARIABLES], parameters: &[f64], c: &mut [S; 6], values: &mut [f64]) {
        add(&self.early, f, parameters, c, values);
    }
    #[inline(always)]
    pub(crate) fn add_late<S: Scalar>(&self, f: &[S; VARIABLES], parameters: &[f64], c: &mut [S; 6], values: &mut [f64]) {
        add(&self.late, f, parameters, c, values);
    }
}

#[inline(always)]
fn add<S: Scalar>(products: &[Product], f: &[S; VARIABLES], parameters: &[f64], c: &mut [S; 6], values: &mut [f64]) {
    for product in products {
        let mut term: Option<S> = None;
        for factor in &product.factors {
            let value = factor_value(*factor, f);
            term = Some(term.map_or(value, |t| t * value));
        }
        let term = term.unwrap_or(S::real(1.0));
        values[product.index] = product.scale * term.value();
        let weight = product.scale * product.parameter.map_or(1.0, |p| parameters[p]);
        c[product.coefficient] = c[product.coefficient] + term * weight;
    }
}

#[inline(always)]
fn factor_value<S: Scalar>(factor: Factor, f: &[S; VARIABLES]) -> S {
    let clock = || f[Variable::SinPhi as usize].atan2(f[Variable::CosPhi as usize]);
    match factor {
        Factor::Power(v, n) => f[v as usize].powi(n),
        Factor::Bump(v, width) => f[v as usize].bump(width),
        Factor::CosClock(n) => (clock() * f64::from(n)).sin_cos().1,
        Factor::SinClock(n) => (clock() * f64::from(n)).sin_cos().0,
    }
}
