//! pid tests: common factors of aerodynamics by hand, and gravity against motion that the model's forces make.

use super::super::tests::{campaign, instants};
use super::*;
use crate::equations::tests::plant;

const MASS: &Suspect = &SUSPECTS[0];
const DIAMETER: &Suspect = &SUSPECTS[2];

/// One parameter with a standard error of 0.02.
fn one(makes: Makes, leading: bool, log: f64) -> Determined {
    Determined { makes, leading, log, std: 0.02 }
}

/// Forces at a factor and moments and damping at one, with one leading and one other force beside them.
fn forces(factor: f64, apart: f64, higher: f64) -> Vec<Determined> {
    use Makes::{Damping, Force, Moment};
    vec![
        one(Force, true, factor),
        one(Force, true, factor),
        one(Force, true, factor + apart),
        one(Force, false, factor + higher),
        one(Moment, true, 0.0),
        one(Damping, true, 0.0),
    ]
}

fn assert_common(found: Option<(f64, f64)>, expected: Option<(f64, f64)>) {
    assert_eq!(found.is_some(), expected.is_some(), "{found:?} {expected:?}");
    for (a, b) in found.into_iter().zip(expected) {
        assert!((a.0 - b.0).abs() < 1e-14 && (a.1 - b.1).abs() < 1e-14, "{a:?} {b:?}");
    }
}

/// A mass off by e^0.4, within what aerodynamics may be: leading forces may be apart by 0.13·2·0.4 + 0.02 = 0.124, others by 0.35 +
/// 0.02. One by e^1.3, beyond: by 0.8·0.6·1.3 + 0.02 = 0.644 and 1.2·0.6·1.3 + 0.02 = 0.956. Below e^0.34 it is none.
#[test]
fn exact_spread_about_a_mass() {
    for (factor, apart, higher, expected) in [
        (0.4, 0.12, -0.36, true),
        (0.4, 0.128, -0.36, false),
        (0.4, 0.12, -0.38, false),
        (1.3, 0.63, -0.94, true),
        (1.3, 0.66, -0.94, false),
        (1.3, 0.63, -0.97, false),
        (-0.35, 0.0, 0.0, true),
        (-0.33, 0.0, 0.0, false),
    ] {
        let misfit = f64::abs(apart) + f64::abs(higher);
        assert_common(common(MASS, &forces(factor, apart, higher), false), expected.then_some((factor, misfit)));
    }
    // Moments that the centre of mass brings forces into count where it is off the origin and the factor is beyond doubt.
    let mut moved = forces(1.3, 0.0, 0.0);
    moved[4].log = 2.0;
    assert_common(common(MASS, &moved, false), None);
    assert_common(common(MASS, &moved, true), Some((1.3, 2.0)));
}

/// A diameter off by e^0.35 moves forces, moments and damping by the powers −2, −3 and −4 of it: beyond, with a spread of
/// 0.8·0.6·4·0.35 + 0.02 = 0.692.
#[test]
fn exact_powers_of_a_diameter() {
    use Makes::{Damping, Force, Moment};
    for (apart, expected) in [(0.68, true), (0.7, false)] {
        let all = [one(Force, true, -0.7), one(Moment, true, -1.05), one(Damping, true, -1.4), one(Damping, true, -1.4 - apart)];
        assert_common(common(DIAMETER, &all, false), expected.then_some((0.35, apart)));
    }
}

/// Parameters in the structure's order as the runs give them over the declared.
fn found(values: [f64; 11], std: f64) -> Balance {
    let ratio = (0..11).map(|parameter| Ratio { parameter, value: values[parameter], std }).collect();
    Balance { left: [0.0; 4], signal: [1.0; 4], ratio }
}

/// C_A, C_N and its cubic part are forces; C_l at rest is an asymmetry; C_m and its cubic part are moments; the rest is damping. Of
/// three times the declared ±0.3 is 10 %, ±0.4 is 13 %, too much.
#[test]
fn exact_determined_parameters() {
    use Makes::{Damping, Force, Moment};
    let all = determined(&found([3.0; 11], 0.3), &plant());
    let kinds: Vec<(Makes, bool)> = all.iter().map(|d| (d.makes, d.leading)).collect();
    let expected = [
        (Force, true),
        (Force, true),
        (Force, false),
        (Damping, true),
        (Moment, true),
        (Moment, false),
        (Damping, true),
        (Damping, false),
        (Damping, true),
        (Damping, false),
    ];
    assert_eq!(kinds, expected);
    assert!(all.iter().all(|d| (d.log - 3.0_f64.ln()).abs() < 1e-15 && (d.std - 0.1).abs() < 1e-15));
    assert!(determined(&found([3.0; 11], 0.4), &plant()).is_empty());
    assert!(determined(&found([-3.0; 11], 0.3), &plant()).is_empty());
}

/// Grams for kilograms: forces a thousand times the declared, named to 14 %, or to a factor of e^0.8 as here where it is beyond
/// doubt. Inertia of 1.8 times what it is: no unit; where it is as measured, the declared values times 1.8 (C_l,p, C_m, C_m,1,
/// C_n,1 of Table 5.5) are to begin with.
#[test]
fn exact_words_of_a_constant() {
    let campaign = campaign(plant(), Vec::new());
    let mut grams = [1.0; 11];
    grams[..3].copy_from_slice(&[1100.0, 1000.0, 900.0]);
    let f = suspect(&campaign, &found(grams, 1e-3)).expect("a factor");
    assert_eq!((f.place.as_str(), f.cause.as_str()), ("[vehicle] mass_kg", "mass is in grams"));
    assert_eq!(f.change, "with [vehicle] mass_kg divided by 1000 the record makes sense");
    assert!(
        f.evidence
            .starts_with("the runs give 1100 times the declared force coefficients, 1 times the static moments and 1 times")
    );
    let mut heavy = [1.8; 11];
    heavy[..3].copy_from_slice(&[1.0; 3]);
    let f = suspect(&campaign, &found(heavy, 0.01)).expect("a factor");
    assert_eq!(f.cause, "the inertia is about 1.8 times what it must be");
    assert_eq!(
        f.change,
        "with [vehicle] inertia_kg_m2 about 0.556 times what it is the record makes sense; if it is as measured, begin with CA_T0 = 6.66, \
         CN_sin = 3.51, Cl_p = -10.2, Cm_sin = -3.72, Cm_1 = -5.94, Cn_1 = -5.58"
    );
    assert!(suspect(&campaign, &found([1.2; 11], 0.01)).is_none());
}

/// Motion in standard gravity with 1.25 times the declared drag: the weight says so, whatever the file has for gravity, in feet or
/// upward. Gravity of another place on the ground is no fault.
#[test]
fn recover_standard_gravity() {
    let mut declared = plant();
    let instants = instants(&declared, 40, 0.2);
    declared.aero.values[0] /= 1.25;
    let of = |g: f64| {
        let mut plant = declared.clone();
        plant.environment.gravity_m_s2 = g;
        gravity(&campaign(plant, Vec::new()), &instants)
    };
    for (g, cause) in [(32.174, "gravity is in another unit"), (-9.806_65, "gravity has the wrong sign")] {
        let f = of(g).expect("weight and drag do not agree");
        assert_eq!(f.cause, cause);
        assert!(f.evidence.starts_with("the drag that carries the weight is then 1.25 of the declared one"), "{}", f.evidence);
    }
    assert!(of(9.78).is_none() && of(9.806_65).is_none() && of(9.6).is_none());
}

/// 22.5 and −12 are no kelvin; 288 is, and so is 61.
#[test]
fn exact_celsius() {
    let of = |ts_k: f64| {
        let mut instants = instants(&plant(), 3, 0.2);
        instants.iter_mut().for_each(|i| i.ts_k = ts_k);
        celsius(&instants)
    };
    assert!(of(22.5).expect("degrees Celsius").evidence.starts_with("its median is 22.5"));
    assert!(of(-12.0).is_some() && of(288.0).is_none() && of(61.0).is_none() && celsius(&[]).is_none());
}
