//! discover tests: values, priors and steps of a model by hand.

use super::super::tests::{GRAVITY_M_S2, ball, close};
use super::*;
use windfall_model::CATALOGUE;

#[test]
fn exact_plant_priors_and_steps() {
    let constant = Constant { key: "g", component: "", unit: "m/s2", lens: |p| Some(&mut p.environment.gravity_m_s2), std: 0.03 };
    let shaped = |e: &&Effect| (e.parameters)(&[]).iter().any(|p| matches!(p.role, Role::Shape(_)));
    let mut effect = EffectInstance::null(CATALOGUE.into_iter().find(shaped).expect("some effect has a shape"), &[]);
    let shape = effect.shapes().next().expect("a shape");
    let mut h = TrackModel {
        declared: vec![0.37, 0.004],
        priors: vec![(1, 0.25, 0.07)],
        constants: vec![(constant, 0.011)],
        effects: Vec::new(),
        generic: Vec::new(),
        scatter: None,
    };
    close(h.plant(&ball(0.1)).environment.gravity_m_s2, GRAVITY_M_S2 + 0.011, 1e-14);
    close(h.plant(&ball(0.1)).aero.values[0], 0.37, 0.0);
    let (departure, std) = h.prior(Free::Declared(1)).expect("a prior");
    close(departure, 0.004 - 0.25, 1e-15);
    close(std, 0.07, 0.0);
    assert!(h.prior(Free::Declared(0)).is_none());
    close(h.log_prior(), -0.5 * ((0.011_f64 / 0.03).powi(2) + (0.246_f64 / 0.07).powi(2)), 1e-13);
    effect.values[shape] = -0.3;
    h.effects.push(effect);
    let steps =
        [(Free::Declared(0), 0.37e-3), (Free::Declared(1), 1e-5), (Free::Constant(0), 3e-3), (Free::Effect(0, shape), 6e-3)];
    steps.into_iter().for_each(|(f, step)| close(h.step(f), step, 1e-17));
}
