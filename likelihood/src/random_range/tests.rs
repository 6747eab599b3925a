//! likelihood tests: ranges of random numbers against closed forms, quadrature and the likelihood itself.

use super::*;
use crate::flown::flown;
use crate::random_fit::tests::gusty;

/// What is known to nothing has its plausible range, and numbers that JSON can hold.
#[test]
fn exact_an_unknown_size_has_its_range() {
    let [low, high] = log_normal(0.001, 400.0, [0.0, 2.0]);
    assert!(low < 1e-12 && (high - 2.0).abs() < 1e-12);
    let [low, high] = log_normal(0.1, 0.1, [0.0, 2.0]);
    assert!((low / 0.1 - (-0.1 * NORMAL_95).exp()).abs() < 1e-12 && (high / 0.1 - (0.1 * NORMAL_95).exp()).abs() < 1e-12);
}

/// A model that is as likely as another of the same size leaves the interval, one that is far likelier gives its own, and one far
/// from the other opens it to both.
#[test]
fn exact_average_over_two_models() {
    let range = |value: f64| RandomRange { place: (0, 0), value, std: 0.1 * value, ci95: log_normal(value, 0.1, [0.0, 10.0]) };
    let close = |a: RandomRange, b: RandomRange| a.ci95.iter().zip(&b.ci95).all(|(x, y)| (x / y - 1.0).abs() < 1e-5);
    assert!(close(averaged(range(1.0), range(1.0), 1.0), range(1.0)));
    assert!(close(averaged(range(1.0), range(2.0), 1e12), range(2.0)));
    let both = averaged(range(1.0), range(2.0), 1.0);
    // Five per cent of each lie outside: Φ(-1.645) on its outer side.
    assert!((both.ci95[0].ln() + 0.1645).abs() < 1e-3 && ((both.ci95[1] / 2.0).ln() - 0.1645).abs() < 1e-3, "{both:?}");
    assert!((both.std - (0.5 * (0.01 + 0.04 + 1.0_f64)).sqrt()).abs() < 1e-12);
}

/// A band that is seen whole keeps its interval about the size that blew; of one half of which is not seen the size may be as much
/// larger as twice that half's is.
#[test]
fn exact_size_that_blew() {
    let range = RandomRange { place: (0, 0), value: 0.1, std: 0.005, ci95: log_normal(0.1, 0.05, [0.0, 1.0]) };
    let whole = sized(range, Blown { square: 1.21, unseen: 0.0 });
    assert!((whole.value - 0.11).abs() < 1e-15 && (whole.std - 0.0055).abs() < 1e-15);
    assert!(whole.ci95.iter().zip(range.ci95).all(|(a, b)| (a / b - 1.1).abs() < 1e-12));
    let half = sized(range, Blown { square: 1.0, unseen: 0.5 });
    // √(½ + 4/2) of it.
    assert!((half.std.powi(2) - 0.005_f64.powi(2) - (0.1 * (2.5_f64.sqrt() - 1.0)).powi(2)).abs() < 1e-15);
    assert!((half.ci95[0] - range.ci95[0]).abs() < 1e-15 && half.ci95[1] > 0.1 * 2.5_f64.powf(0.98));
}

/// Points of a Gaussian ridge in logarithms: the shape's interval is that Gaussian's, the size's has the ridge's slope.
#[test]
fn exact_intervals_of_a_gaussian_ridge() {
    let (s, slope) = (0.2, -0.5);
    let point = |k: i32| {
        let shape = 0.05 * f64::from(k);
        RidgePoint { shape, height: -0.5 * (shape / s).powi(2), size: slope * shape, spread: 1e-6 }
    };
    let ridge: Vec<RidgePoint> = (-20..=20).map(point).collect();
    let (shape, size) = ranges(&ridge, [1.0, 1.0]).expect("a ridge");
    for (range, s) in [(shape, s), (size, 0.5 * s)] {
        assert!((range.ci95[0].ln() / (-NORMAL_95 * s) - 1.0).abs() < 0.02, "{range:?}");
        assert!((range.ci95[1].ln() / (NORMAL_95 * s) - 1.0).abs() < 0.02, "{range:?}");
        assert!((range.std / s - 1.0).abs() < 0.1, "{range:?}");
    }
    assert!(ranges(&ridge[..1], [1.0, 1.0]).is_none());
}

/// A likelihood that is flat down to the end of its range and steep above: the interval reaches that end.
#[test]
fn law_a_flat_side_is_in_the_interval() {
    let point = |k: i32| {
        let shape = 0.05 * f64::from(k);
        RidgePoint { shape, height: if k < 0 { 0.0 } else { -0.5 * (shape / 0.1).powi(2) }, size: -0.5 * shape, spread: 0.01 }
    };
    let ridge: Vec<RidgePoint> = (-40..=12).map(point).collect();
    let (shape, size) = ranges(&ridge, [1.0, 1.0]).expect("a ridge");
    assert!(shape.ci95[0].ln() < -1.8 && shape.ci95[1].ln() < 0.3, "{shape:?}");
    assert!(size.ci95[1].ln() > 0.9, "{size:?}");
}

/// Of gusts half as long as those that were flown damping and stiffness take up a part: the ridge with them is higher than the one
/// on which they stay.
#[test]
fn law_the_ridge_follows_all_other_numbers() {
    let (engine, model) = flown(12.0, "turbulence", &[0.1, 0.1, 0.3, 0.3, 0.0]);
    let fit = engine.settle_random(&engine.climb(&model, false, 12).expect("a fit"), 8);
    let (shape, size) = ((0, 3), (0, 1));
    let of = |(m, i): (usize, usize)| fit.model.members[m].values[i].ln();
    let (at, guess) = (of(shape) - 2.0_f64.ln(), of(size) + 0.5 * 2.0_f64.ln());
    let (point, followed) = engine.across(&fit.model, [shape, size], [at, guess], 1.0).expect("a top");
    let held = |by: f64| {
        let mut model = fit.model.clone();
        (model.members[0].values[3], model.members[0].values[1]) = (at.exp(), (guess + by).exp());
        engine.likelihoods_beside(&model, &[]).expect("a pass").0 - penalty(&engine.free(&model, true))
    };
    let highest = (-40..=40).map(|k| held(0.01 * f64::from(k))).fold(f64::NEG_INFINITY, f64::max);
    assert!(point.height > highest + 0.05, "{} {highest}", point.height);
    assert!(followed.declared.iter().zip(&fit.model.declared).any(|(a, b)| (a - b).abs() > 1e-6 * b.abs()));
}

/// Strengths are estimated within their whole plausible range, ten times as wide as that which sets are weighed with; no other
/// number's prior changes.
#[test]
fn exact_priors_of_an_estimate() {
    let (engine, model) = flown(3.0, "loose-mass", &[0.05, 2.0, 0.05, 0.1, 1.0]);
    let (weighed, estimated) = (engine.free(&model, true), engine.without_priors_of_strengths().free(&model, true));
    assert_eq!(weighed.len(), estimated.len());
    for (a, b) in weighed.iter().zip(&estimated) {
        let by = if a.id == crate::model::Id::Member(0, 0) { model.members[0].parameters[0].high / a.prior } else { 1.0 };
        assert!((b.prior / a.prior - by).abs() < 1e-12 * by, "{:?}", a.id);
    }
}

/// What bursts leave of a size's logarithm adds in squares to what its interval says, within what is plausible.
#[test]
fn exact_range_in_bursts() {
    let (value, s, bursts) = (0.4_f64, 0.2_f64, 0.15_f64);
    let range = RandomRange { place: (1, 2), value, std: 0.09, ci95: log_normal(value, s, [0.0, 9.0]) };
    let found = within(range, [0.01, 9.0], bursts);
    let half = NORMAL_95 * s.hypot(bursts);
    assert!(
        (found.ci95[0] / (value * (-half).exp()) - 1.0).abs() < 1e-12
            && (found.ci95[1] / (value * half.exp()) - 1.0).abs() < 1e-12
    );
    assert!((found.std.powi(2) - 0.09_f64.powi(2) - 0.06_f64.powi(2)).abs() < 1e-15 && found.place == (1, 2));
    let narrow = within(RandomRange { std: 0.9, ..range }, [0.3, 0.55], bursts);
    assert!((narrow.std - 0.25).abs() < 1e-15 && (narrow.ci95[1] - 0.55).abs() < 1e-15);
}

/// Of a mean square 1.3 times the expected, of which 0.4 are not seen, those may be four times as much: the size goes with the root
/// of the sum.
#[test]
fn exact_size_with_a_part_unseen() {
    let range = RandomRange { place: (0, 0), value: 0.1, std: 0.005, ci95: log_normal(0.1, 0.05, [0.0, 1.0]) };
    let found = sized(range, Blown { square: 1.3, unseen: 0.4 });
    let [own, larger] = [1.3, 0.9 + 4.0 * 0.4].map(|square: f64| 0.1 * square.sqrt());
    assert!((found.value - own).abs() < 1e-15);
    assert!((found.std.powi(2) - 1.3 * 0.005_f64.powi(2) - (larger - own).powi(2)).abs() < 1e-15);
    assert!(
        ((found.ci95[1] / own).ln().powi(2) - NORMAL_95.powi(2) * (0.05_f64.powi(2) + (larger / own).ln().powi(2))).abs() < 1e-12
    );
}

/// The intervals of a ridge with few and unequal steps: the fall's root is straight, so that the density is that of the normal
/// logarithm, whose mean square departure from an estimate is `e^{2m + 2s²} - 2e e^{m + s²/2} + e²` (Johnson, Kotz and Balakrishnan
/// 1994, ch. 14).
#[test]
fn exact_intervals_of_few_points() {
    let (m, s, estimates) = (0.7_f64, 0.3_f64, [1.5, 0.6]);
    let (slope, at) = (-0.8, -0.2);
    let point = |shape: f64| RidgePoint {
        shape,
        height: 5.0 - 0.5 * ((shape - m) / s).powi(2),
        size: at + slope * (shape - m),
        spread: 1e-9,
    };
    let ridge = [-0.9, -0.3, -0.05, 0.3, 0.7, 0.8, 1.5, 1.7, 2.4].map(point);
    let (shape, size) = ranges(&ridge, estimates).expect("a ridge");
    for (range, m, s, e) in [(shape, m, s, estimates[0]), (size, at, 0.8 * s, estimates[1])] {
        let square = (2.0 * (m + s * s)).exp() - 2.0 * e * (m + 0.5 * s * s).exp() + e * e;
        assert!((range.std / square.sqrt() - 1.0).abs() < 5e-3, "{range:?} {square}");
        for (end, z) in range.ci95.into_iter().zip([-NORMAL_95, NORMAL_95]) {
            // Within half a piece of the longest step.
            assert!(((end.ln() - m) / s - z).abs() < 0.07, "{range:?}");
        }
    }
}

/// A shape hangs on the strength that it is correlated with more, not on the one that it moves by more.
#[test]
fn exact_partner_of_a_shape() {
    let (_, model) = gusty(&[0.3, 0.25, 0.3, 0.4, 0.0], (0.0, 1.0));
    let places = random_numbers(&model);
    let mut covariance = DMatrix::from_diagonal(&nalgebra::DVector::from_vec(vec![0.04, 4.0, 0.3, 0.5]));
    for (j, w, x) in [(0, 2, -0.05), (1, 2, 0.2), (0, 3, 0.02), (1, 3, -0.3)] {
        (covariance[(j, w)], covariance[(w, j)]) = (x, x);
    }
    // Correlations with the first length -0.46 and 0.18, with the second 0.14 and -0.21.
    assert_eq!([2, 3].map(|w| partner(&model, &places, &covariance, w)), [Some(0), Some(1)]);
}

/// Log posterior by a pass of its own with another size of the gusts along the stream, by its logarithm: every number's square in
/// standard deviations of its prior, halved, off the log-likelihood.
fn posterior(engine: &Engine, model: &Model, size: f64) -> f64 {
    let mut model = model.clone();
    model.members[0].values[0] = size.exp();
    let squares: f64 = engine.free(&model, true).iter().map(|n| n.value * n.value / (n.prior * n.prior)).sum();
    engine.sum(&model, &[], &[]).expect("a pass").log_likelihood - squares / 2.0
}

/// Places of the length and the size of gusts along the stream.
const ALONG: [(usize, usize); 2] = [(0, 2), (0, 0)];

/// Across a ridge: the size is where the log posterior of passes of their own is highest, its height is that over how much too
/// steep it is, the spread by the curvature; the number beside has moved, by less than its prior takes off.
#[test]
fn law_across_a_ridge() {
    let (engine, mut model) = gusty(&[0.3, 0.25, 0.3, 0.4, 0.0], (0.2, 0.05));
    model.constants[0] = -0.15;
    let steep = 1.7;
    let (point, followed) = engine.across(&model, ALONG, [0.2_f64.ln(), 0.37_f64.ln()], steep).expect("a top");
    let of = |size: f64| posterior(&engine, &followed, size);
    let best = (-15..=15).map(|k| point.size + 0.004 * f64::from(k)).max_by(|a, b| of(*a).total_cmp(&of(*b))).expect("a size");
    assert!((point.shape - 0.2_f64.ln()).abs() < 1e-15 && (point.size - best).abs() < 0.009, "{point:?} {best}");
    assert!((point.height - of(best) / steep).abs() < 0.01, "{point:?} {}", of(best) / steep);
    let bend = (2.0 * of(best) - of(best + 0.1) - of(best - 0.1)) / 0.01;
    assert!((point.spread / (steep / bend).sqrt() - 1.0).abs() < 0.1, "{point:?} {bend}");
    let gained = posterior(&engine, &followed, 0.37_f64.ln()) - posterior(&engine, &model, 0.37_f64.ln());
    assert!(followed.constants[0] < -0.16 && gained < 2.0 * 0.5 * 9.0, "{:?} {gained}", followed.constants);
}

/// A parameter so far off that a step of it leads past its top and down: it stays, though its prior takes off more than that.
#[test]
fn law_no_number_follows_downhill() {
    let (mut engine, mut model) = gusty(&[0.3, 0.25, 0.3, 0.4, 0.0], (0.0, 1.0));
    engine.campaign.knowledge.constants[0].lens = |p| p.aero.values.get_mut(4);
    let size = 0.3_f64.ln();
    let gain = |constant: f64| {
        let mut model = model.clone();
        model.constants[0] = constant;
        let (gram, _) = engine.gram(&model, engine.free(&model, true)).expect("a pass");
        let here = posterior(&engine, &model, size);
        model.constants[0] += gram.laplace().expect("positive definite").1[0];
        posterior(&engine, &model, size) - here
    };
    // Far off a step falls by thousands, near the top it gains: between them one falls by little.
    let (mut near, mut far) = (-5.0, -28.0);
    assert!(gain(near) > 0.0 && gain(far) < 0.0, "{} {}", gain(near), gain(far));
    for _ in 0..14 {
        let middle = 0.5 * (near + far);
        if gain(middle) > 0.0 { near = middle } else { far = middle }
    }
    assert!(gain(far) < -1e-3 && gain(far) > -0.5 * far * far, "{far} {}", gain(far));
    model.constants[0] = far;
    let kept = engine.across(&model, ALONG, [0.3_f64.ln(), size], 1.0).is_none_or(|(_, m)| (m.constants[0] - far).abs() < 1e-12);
    assert!(kept);
}

/// Along a ridge from 0.12 m: steps grow by half each to both ends of the range, and at each the size is the likeliest, by a
/// parabola through passes of their own, where short gusts of the same variance times length stand for each other.
#[test]
fn law_a_walk_over_lengths() {
    let (mut engine, mut model) = gusty(&[0.4, 0.25, 0.12, 0.4, 0.0], (0.0, 1.0));
    engine.held = vec![crate::model::Id::Constant(0)];
    (model.members[0].parameters[2].low, model.members[0].parameters[2].high) = (0.05, 0.3);
    let start = 0.12_f64.ln();
    let places = [0.05_f64.ln(), start - 0.75, start - 0.3, start, start + 0.3, start + 0.75, 0.3_f64.ln()];
    let ridge = engine.ridge(&model, ALONG, 0.3, -0.5, 1.0);
    assert_eq!(ridge.len(), places.len(), "{ridge:?}");
    for (p, shape) in ridge.iter().zip(places) {
        assert!((p.shape - shape).abs() < 1e-12, "{p:?} {shape}");
        model.members[0].values[2] = shape.exp();
        let [below, here, above] = [-0.05, 0.0, 0.05].map(|by| posterior(&engine, &model, p.size + by));
        let off = 0.025 * (above - below) / (2.0 * here - above - below);
        assert!(off.abs() < 0.04, "{p:?} {off}");
    }
}

/// Numbers that are no wide shapes are as well known as their logarithms' covariance says; a wide shape is known by its ridge,
/// walked in steps of its standard error, with the size following by the regression (from the precision of both), as much less
/// steep as its variance is larger than the model's.
#[test]
fn law_ranges_of_all_numbers() {
    let (mut engine, mut model) = gusty(&[0.3, 0.25, 0.9, 0.1, 0.0], (0.0, 1.0));
    engine.held = vec![crate::model::Id::Constant(0)];
    model.members[0].parameters[3].role = Role::Reference;
    let p = &mut model.members[0].parameters[2];
    (p.low, p.high) = (0.5, 1.6);
    let (covariance, own) = engine.random_covariance(&model).expect("a pass");
    let (wide, grown) = (covariance[(2, 2)], covariance[(2, 2)] / own[(2, 2)]);
    assert!((0.03..0.9).contains(&wide) && grown > 1.2, "{wide} {grown}");
    let found = engine.ranges_in(&model);
    let mut narrow = model.clone();
    narrow.members[0].parameters[2].role = Role::Reference;
    for (j, range) in engine.ranges_in(&narrow).into_iter().enumerate() {
        let (value, s) = (model.members[0].values[j], covariance[(j, j)].sqrt());
        let end = (value * (NORMAL_95 * s).exp()).min(model.members[0].parameters[j].high);
        assert!((range.std / (value * s) - 1.0).abs() < 1e-9 && (range.ci95[1] / end - 1.0).abs() < 1e-9, "{range:?} {s}");
    }
    let size = partner(&model, &random_numbers(&model), &covariance, 2).expect("a strength");
    let both = covariance.select_rows(&[2, size]).select_columns(&[2, size]).try_inverse().expect("positive definite");
    let slope = -both[(0, 1)] / both[(1, 1)];
    let steep = f64::max(1.0, covariance[(2, 2)] / own[(2, 2)]);
    let ridge = engine.ridge(&model, [(0, 2), (0, size)], covariance[(2, 2)].sqrt(), slope, steep);
    let (shape, strength) = ranges(&ridge, [2, size].map(|j| model.members[0].values[j])).expect("a ridge");
    for (found, expected) in [(found[2], shape), (found[size], strength)] {
        let close = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-6;
        assert!(
            close(found.std, expected.std) && (0..2).all(|k| close(found.ci95[k], expected.ci95[k])),
            "{found:?} {expected:?}"
        );
    }
}

/// Averaged over forms of the spectrum, one that is beyond doubt has it all: the own form's ranges where the fit is far likelier
/// than von Kármán's can be, that form's, as departures from the fit's values, where far less likely.
#[test]
fn law_ranges_of_the_likelier_form() {
    let (mut engine, mut model) = gusty(&[0.3, 0.25, 0.3, 0.4, 0.0], (0.0, 1.0));
    engine.held = vec![crate::model::Id::Constant(0)];
    model.members[0].parameters[2].role = Role::Reference;
    model.members[0].parameters[3].role = Role::Reference;
    let fit = engine.climb(&model, false, 0).expect("a fit");
    let own = engine.ranges_in(&model);
    let mut other = engine.clone();
    other.spectra.von_karman = true;
    let there = other.settle_random(&other.climb(&model, false, 0).expect("a fit"), 4);
    let theirs = other.ranges_in(&there.model);
    for (j, range) in engine.over_forms(&Fit { total: 1e4, ..fit.clone() }).into_iter().enumerate() {
        assert!((range.std / own[j].std - 1.0).abs() < 1e-9, "{range:?}");
    }
    for (j, range) in engine.over_forms(&Fit { total: -1e4, ..fit }).into_iter().enumerate() {
        let square = theirs[j].std.powi(2) + (theirs[j].value - own[j].value).powi(2);
        assert!((range.std / square.sqrt() - 1.0).abs() < 1e-9 && range.value.to_bits() == own[j].value.to_bits(), "{range:?}");
    }
}
