//! model: aerodynamic structure as data. In: flow variables and parameter values. Out: six coefficients at the geometric origin.
//!
//! A coefficient is a sum of parameter × term, a term a product of factors of flow variables, so another vehicle is another
//! table, not other code.

use crate::flow::{FlowState, Variable};
use crate::frames::{Body, Vec3};

/// The six coefficients, at the geometric origin, body axes (thesis eqs B.60-B.61).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[repr(u8)]
pub enum Coefficient {
    /// Axial force, −C_X.
    CA,
    /// Side force.
    CY,
    /// Normal force, −C_Z.
    CN,
    /// Roll moment.
    Cl,
    /// Pitch moment.
    Cm,
    /// Yaw moment.
    Cn,
}

impl Coefficient {
    /// All six, in index order.
    pub const ALL: [Self; 6] = [Self::CA, Self::CY, Self::CN, Self::Cl, Self::Cm, Self::Cn];
    /// Name in files.
    #[must_use]
    pub const fn name(self) -> &'static str {
        ["CA", "CY", "CN", "Cl", "Cm", "Cn"][self as usize]
    }
    /// The coefficient of that name, if there is one.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|c| c.name() == name)
    }
}

/// One factor of a term.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Factor {
    /// `variable^power`, power 1 to 9.
    Power(Variable, u8),
    /// cos(n φ_αT).
    CosClock(u8),
    /// sin(n φ_αT).
    SinClock(u8),
    /// sech²(variable/width): 1 at zero, falling smoothly; width in the variable's unit, positive.
    Bump(Variable, f64),
}

impl Factor {
    /// Value at a flow state.
    #[must_use]
    #[inline]
    pub fn value(self, f: &FlowState) -> f64 {
        match self {
            Self::Power(v, 1) => f.get(v),
            Self::Power(v, 2) => f.get(v) * f.get(v),
            Self::Power(v, 3) => f.get(v) * f.get(v) * f.get(v),
            Self::Power(v, n) => f.get(v).powi(i32::from(n)),
            Self::CosClock(n) => (f64::from(n) * clock_rad(f)).cos(),
            Self::SinClock(n) => (f64::from(n) * clock_rad(f)).sin(),
            Self::Bump(v, width) => (f.get(v) / width).cosh().powi(-2),
        }
    }
}

impl Factor {
    /// The variable it is made of; clock harmonics are made of both sin φ and cos φ and give `SinPhi`.
    #[must_use]
    pub const fn variable(self) -> Variable {
        match self {
            Self::Power(v, _) | Self::Bump(v, _) => v,
            Self::CosClock(_) | Self::SinClock(_) => Variable::SinPhi,
        }
    }
    /// True when it needs the acceleration (α̇ or β̇).
    #[must_use]
    pub const fn needs_rates(self) -> bool {
        matches!(self.variable(), Variable::PitchDamping | Variable::YawDamping)
    }
}

fn clock_rad(f: &FlowState) -> f64 {
    f.get(Variable::SinPhi).atan2(f.get(Variable::CosPhi))
}

/// A product of factors with a constant in front.
#[derive(Clone, Debug, PartialEq)]
pub struct Term {
    /// Constant factor, usually ±1.
    pub scale: f64,
    /// Factors; none means the term is the constant.
    pub factors: Vec<Factor>,
}

impl Term {
    /// Term from its constant and factors.
    #[must_use]
    pub fn new(scale: f64, factors: &[Factor]) -> Self {
        Self { scale, factors: factors.to_vec() }
    }
    /// Value at a flow state.
    #[must_use]
    #[inline]
    pub fn value(&self, f: &FlowState) -> f64 {
        self.factors.iter().fold(self.scale, |product, factor| product * factor.value(f))
    }
}

/// What one parameter adds to one coefficient.
#[derive(Clone, Debug, PartialEq)]
pub struct Contribution {
    /// The coefficient.
    pub coefficient: Coefficient,
    /// Index into [`Structure::parameters`].
    pub parameter: usize,
    /// The regressor.
    pub term: Term,
}

/// Parameter names and where each of them acts.
#[derive(Clone, Debug, PartialEq)]
pub struct Structure {
    /// Name of the model, as in `[aero.<name>]`.
    pub name: String,
    /// Parameter names, in file order.
    pub parameters: Vec<String>,
    /// All contributions.
    pub contributions: Vec<Contribution>,
}

impl Structure {
    /// The axisymmetric lander of thesis §4.1.2, force and static moment split by clock angle (eqs 4.1-4.11).
    #[must_use]
    pub fn axisymmetric() -> Self {
        use Coefficient as C;
        use Factor::Power as P;
        use Variable as V;
        let names = ["CA_T0", "CN_sin", "CN_sin3", "Cl_0", "Cl_p", "Cm_sin", "Cm_sin3", "Cm_1", "Cm_2", "Cn_1", "Cn_2"];
        let (s1, s3) = (P(V::SinAlphaT, 1), P(V::SinAlphaT, 3));
        let (sin_phi, cos_phi) = (P(V::SinPhi, 1), P(V::CosPhi, 1));
        let rows: [(C, usize, f64, &[Factor]); 15] = [
            (C::CA, 0, 1.0, &[P(V::CosAlphaT, 1)]),
            (C::CY, 1, -1.0, &[s1, sin_phi]),
            (C::CN, 1, 1.0, &[s1, cos_phi]),
            (C::CY, 2, -1.0, &[s3, sin_phi]),
            (C::CN, 2, 1.0, &[s3, cos_phi]),
            (C::Cl, 3, 1.0, &[]),
            (C::Cl, 4, 1.0, &[P(V::RollRate, 1)]),
            (C::Cm, 5, 1.0, &[s1, cos_phi]),
            (C::Cm, 6, 1.0, &[s3, cos_phi]),
            (C::Cm, 7, 1.0, &[P(V::PitchDamping, 1)]),
            (C::Cm, 8, 1.0, &[P(V::Alpha, 2), P(V::PitchDamping, 1)]),
            (C::Cn, 5, -1.0, &[s1, sin_phi]),
            (C::Cn, 6, -1.0, &[s3, sin_phi]),
            (C::Cn, 9, 1.0, &[P(V::YawDamping, 1)]),
            (C::Cn, 10, 1.0, &[P(V::Beta, 2), P(V::YawDamping, 1)]),
        ];
        Self {
            name: "axisymmetric".to_owned(),
            parameters: names.map(str::to_owned).to_vec(),
            contributions: rows
                .iter()
                .map(|&(coefficient, parameter, scale, factors)| Contribution {
                    coefficient,
                    parameter,
                    term: Term::new(scale, factors),
                })
                .collect(),
        }
    }
    /// Drag of a body without attitude: C_D along the velocity.
    #[must_use]
    pub fn point_mass() -> Self {
        Self {
            name: "point_mass".to_owned(),
            parameters: vec!["CD".to_owned()],
            contributions: vec![Contribution { coefficient: Coefficient::CA, parameter: 0, term: Term::new(1.0, &[]) }],
        }
    }
    /// Index of a parameter by name.
    #[must_use]
    pub fn index(&self, name: &str) -> Option<usize> {
        self.parameters.iter().position(|p| p == name)
    }
}

/// A structure with values, and terms that effects add to it.
#[derive(Clone, Debug, PartialEq)]
pub struct Aero {
    /// What the parameters mean.
    pub structure: Structure,
    /// Their values, in the structure's order.
    pub values: Vec<f64>,
    /// Added by effects: coefficient, value, term.
    pub extra: Vec<(Coefficient, f64, Term)>,
}

impl Aero {
    /// A structure with these values and nothing added.
    #[must_use]
    pub fn new(structure: Structure, values: Vec<f64>) -> Self {
        Self { structure, values, extra: Vec::new() }
    }
    /// Value of a parameter by name.
    #[must_use]
    pub fn value(&self, name: &str) -> Option<f64> {
        self.structure.index(name).map(|i| self.values[i])
    }
    /// Adds `value × term` to a coefficient: how effects act.
    pub fn add(&mut self, coefficient: Coefficient, value: f64, scale: f64, factors: &[Factor]) {
        self.extra.push((coefficient, value, Term::new(scale, factors)));
    }
    /// The six coefficients at the geometric origin, indexed by [`Coefficient`].
    #[must_use]
    pub fn coefficients(&self, f: &FlowState) -> [f64; 6] {
        let mut c = [0.0; 6];
        for k in &self.structure.contributions {
            c[k.coefficient as usize] += self.values[k.parameter] * k.term.value(f);
        }
        for (coefficient, value, term) in &self.extra {
            c[*coefficient as usize] += value * term.value(f);
        }
        c
    }
}

/// Force and moment at the c.m., N and N m, body axes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wrench {
    /// Force.
    pub f: Vec3<Body>,
    /// Moment about the c.m.
    pub m: Vec3<Body>,
}

impl std::ops::AddAssign for Wrench {
    #[inline]
    fn add_assign(&mut self, o: Self) {
        self.f += o.f;
        self.m += o.m;
    }
}

/// Aerodynamic force and moment at the c.m. from coefficients at the origin (thesis eqs B.60-B.66):
/// `F = q S (−C_A, C_Y, −C_N)`, `M = q S d (C_l, C_m, C_n) + F × r_cm`.
#[must_use]
#[inline]
pub fn wrench_at_cm(c: &[f64; 6], q_pa: f64, area_m2: f64, diameter_m: f64, p_origin_cm: Vec3<Body>) -> Wrench {
    let [ca, cy, cn, cl, cm, cnn] = *c;
    let qs = q_pa * area_m2;
    let f = Vec3::new(-qs * ca, qs * cy, -qs * cn);
    let qsd = qs * diameter_m;
    Wrench { f, m: Vec3::new(qsd * cl, qsd * cm, qsd * cnn) + f.cross(p_origin_cm) }
}
