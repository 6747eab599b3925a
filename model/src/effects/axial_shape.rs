//! model: effect `axial-shape`.

use super::{Acts, Effect, Parameter};
use crate::aero::{Coefficient as C, Factor::Power as P};
use crate::flow::Variable as V;

pub(super) static EFFECT: Effect = Effect {
    family: "axial-shape",
    acts: Acts::Lander,
    physics: "The axial force departs from C_A0 cos α_T as the drag plate meets the flow at an angle: even terms in sin α_T.",
    source: "Thesis eq. 4.1 and Figure 5.4 (static data differ below 5°); Allen and Perkins, NACA R1048, 1951",
    separate_by: "perturbed runs to larger angles",
    parameters: |_| vec![Parameter::strength("CA_sin2", "-", 20.0), Parameter::strength("CA_sin4", "-", 60.0)],
    apply: |plant, v| {
        plant.aero.add(C::CA, v[0], 1.0, &[P(V::SinAlphaT, 2)]);
        plant.aero.add(C::CA, v[1], 1.0, &[P(V::SinAlphaT, 4)]);
    },
};
