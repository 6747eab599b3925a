//! likelihood tests: noise learnt again, sums over runs, steps and climbs.

use super::*;
use crate::flown::flown;

/// In the middle it is the noise itself; elsewhere its variance and the odds of its correlation are changed by their factors.
#[test]
fn exact_other_noise() {
    let own = ChannelNoise { white: 0.3, coloured: 0.7, correlation: 0.8 };
    for (u, scale, odds) in [([0.5, 0.5], 1.0, 4.0), ([0.9, 0.75], 0.2_f64.exp(), 4.0 * 0.8_f64.exp())] {
        let n = other_noise(own, &u);
        assert!((n.white - 0.3 * scale).abs() < 1e-14 && (n.coloured - 0.7 * scale).abs() < 1e-14, "{n:?}");
        assert!((n.correlation / (1.0 - n.correlation) - odds).abs() < 1e-12 * odds, "{n:?} {odds}");
    }
    assert!(other_noise(ChannelNoise { coloured: 0.0, ..own }, &[0.5, 0.5]).correlation == 0.0);
    // A hundredth of the size and a two-hundredth of correlation are what differs.
    let [size, colour] = [
        |k: f64| ChannelNoise { white: 4e-6 * k * k, coloured: 0.0, correlation: 0.4 },
        |k: f64| ChannelNoise { white: 4e-6, coloured: 0.0, correlation: 0.4 + k },
    ];
    assert!(!is_other_noise(&size(1.0), &size(1.005)) && is_other_noise(&size(1.0), &size(0.98)));
    assert!(!is_other_noise(&size(1.0), &colour(0.004)) && is_other_noise(&size(1.0), &colour(0.006)));
}

/// Second differences of a slow line are none, those of what changes sign each time four times itself: 16/6 of its square. A gap's are left out.
#[test]
fn exact_fast_part() {
    let rows = |n: u16| -> Vec<[f64; POSE]> {
        (0..n)
            .map(|k| [if k % 2 == 0 { 0.3 } else { -0.3 }, 1.0 + 0.01 * f64::from(k), f64::from(k * k), 0.0, 0.0, 0.0])
            .collect()
    };
    let of = |all: &[Vec<[f64; POSE]>], c: usize| fast_part(all.iter().map(Vec::as_slice), c);
    let mut gap = rows(80);
    (0..POSE).for_each(|c| gap[40][c] = 0.0);
    let all = [rows(70), gap];
    assert!(of(&all, 0).is_some_and(|x| (x - 16.0 * 0.09 / 6.0).abs() < 1e-12) && of(&all, 1).is_some_and(|x| x < 1e-20));
    assert!(of(&all, 2).is_some_and(|x| (x - 4.0 / 6.0).abs() < 1e-12));
    // One number of 103 rows more than enough, of 102 none.
    assert!(of(&[rows(103)], 0).is_some() && of(&[rows(102)], 0).is_none());
}

/// No number goes farther than three deviations of its prior, which takes half the square of its departures off; a step counts in standard errors.
#[test]
fn exact_longest_step() {
    let number =
        |prior: f64| Number { id: Id::Constant(0), value: 0.35, prior, range: [-9.0, 9.0], at_end: [false; 2], step: 1.0 };
    let numbers = [number(0.5), number(7.0)];
    assert!((within_longest(&DVector::from_vec(vec![-4.5, 7.0]), &numbers) - 1.0 / 3.0).abs() < 1e-15);
    assert!((within_longest(&DVector::from_vec(vec![1.4, -7.0]), &numbers) - 1.0).abs() < 1e-15);
    assert!((penalty(&numbers) - 0.5 * (0.49 + 0.0025)).abs() < 1e-15);
    let gram = Gram::new(numbers.to_vec(), DMatrix::identity(2, 2), DVector::zeros(2), 57.0);
    assert!((log_posterior(&gram) - (57.0 - 0.246_25)).abs() < 1e-12);
    let covariance = DMatrix::from_row_slice(2, 2, &[0.25, 0.1, 0.1, 16.0]);
    assert!((in_errors(&DVector::from_vec(vec![-0.3, 1.2]), &covariance) - 0.6).abs() < 1e-15);
}

/// Sums over a run are those of its innovations one by one; a channel's white noise that was taken for too large or too small, or coloured noise of too
/// large a size, is found again; free accelerations leave parameters within their own size.
#[test]
fn recover_noise_and_sums() {
    let (engine, model) = flown(3.0, "center-of-mass", &[0.0, 1e-3, 0.0]);
    let sum = engine.sum(&model, &[], &[]).expect("a pass");
    for c in 0..POSE {
        let count = sum.runs[0].channels[c][3];
        let of = |k: usize| sum.runs[0].channels[c][k] / count;
        assert!(count > 50.0 && (0..3).all(|k| (sum.channels[c][k] / of(k) - 1.0).abs() < 1e-12));
        // Of the right model: within five deviations of a mean square.
        assert!((sum.channels[c][2] - 1.0).abs() < 5.0 * (2.0 / count).sqrt(), "{c} {:?}", sum.channels[c]);
        assert!((sum.channels[c][0] / sum.channels[c][1] - 1.0).abs() < 6.0 * (2.0 / count).sqrt(), "{c} {:?}", sum.channels[c]);
    }
    let truth = engine.noise.map(|n| n.std());
    let far = |e: &Engine| (0..POSE).map(|c| (e.noise[c].std() / truth[c]).ln().abs()).max_by(f64::total_cmp).unwrap_or(f64::NAN);
    for scale in [2.5, 0.5] {
        let mut other = engine.clone();
        other.noise[..POSE].iter_mut().for_each(|n| n.white *= scale);
        let before = far(&other);
        assert!(other.refine_noise(&model) && far(&other) < 0.6 * before, "{before} {}", far(&other));
    }
    let mut coloured = engine.clone();
    coloured.noise[..POSE]
        .iter_mut()
        .for_each(|n| *n = ChannelNoise { white: 1.2 * n.white, coloured: 1.2 * n.white, correlation: 0.3 });
    let likelihood = |e: &Engine| e.sum(&model, &[], &[]).expect("a pass").log_likelihood;
    let before = [likelihood(&coloured), far(&coloured)];
    assert!(coloured.refine_noise(&model));
    assert!(likelihood(&coloured) > before[0] + 5.0 && far(&coloured) < before[1], "{before:?} {}", likelihood(&coloured));
    let mut moved = model.clone();
    moved.declared.iter_mut().for_each(|v| *v = 1.5 * *v + 0.25);
    for near_declared in [false, true] {
        let free = Engine { slack: [1.0; 6], near_declared, ..engine.clone() };
        for n in free.free(&moved, false) {
            let Id::Declared(i) = n.id else { continue };
            let begun = engine.campaign.plant.aero.values[i];
            let size = moved.declared[i].abs().max(begun.abs()).max(1.0);
            assert!((n.prior / size - 1.0).abs() < 1e-12, "{n:?}");
            let off = if near_declared { 0.5 * begun + 0.25 } else { 0.0 };
            assert!((n.value - off).abs() < 1e-12 * size, "{n:?} {off}");
        }
    }
}

/// A step six times too long is shortened twice, to 0.35² of it: the shortest but one raises no posterior. From near the top one step ends a climb, and
/// from far off it comes back to the top.
#[test]
fn law_steps_and_climbs() {
    let (engine, model) = flown(2.0, "center-of-mass", &[0.0, 1e-3, 0.0]);
    let top = engine.climb(&model, false, 12).expect("a fit");
    let (gram, _) = engine.gram(&top.model, engine.free(&top.model, false)).expect("a pass");
    let (_, _, covariance) = gram.laplace().expect("definite");
    let i = gram.numbers.iter().position(|n| matches!(n.id, Id::Member(_, 1))).expect("the strength");
    // All numbers as they go with one that is so many deviations off.
    let off = |by: f64| {
        let mut model = top.model.clone();
        let share = by / covariance[(i, i)].sqrt();
        gram.numbers.iter().enumerate().for_each(|(k, n)| model.change(n, share * covariance[(k, i)]));
        model
    };
    let start = off(2.0);
    let (here, _) = engine.gram(&start, engine.free(&start, false)).expect("a pass");
    let (_, step, _) = here.laplace().expect("definite");
    let (next, ..) =
        engine.stepped(&start, &here, &(6.0 * &step), log_posterior(&here), false).unwrap_or_else(|_| panic!("no step"));
    let Id::Member(m, p) = gram.numbers[i].id else { panic!("a member's") };
    let share = (next.members[m].values[p] - start.members[m].values[p]) / step[i];
    assert!((share - 6.0 * 0.35 * 0.35).abs() < 1e-9, "{share}");
    let ended = engine.climb(&off(0.12), false, 1).expect("a fit");
    assert!(ended.stop == StopReason::Converged, "{:?}", ended.stop);
    let back = engine.climb(&off(8.0), false, 12).expect("a fit");
    let values = [&back, &top].map(|f| f.model.members[m].values[p]);
    assert!(
        (values[0] - values[1]).abs() < 0.1 * covariance[(i, i)].sqrt() && (back.total - top.total).abs() < 0.05,
        "{values:?}"
    );
}

/// While accelerations are free a roll of a turn in two seconds says hardly anything of its damping: fits that go on from one another walk off with it, and
/// stay within its own size of where it is declared when told to.
#[test]
fn law_what_free_accelerations_hide_stays() {
    let (engine, _) = flown(4.0, "axial-speed", &[-0.5, 7.43]);
    let declared = Model::declared(&engine.campaign);
    let roll = engine.campaign.plant.aero.structure.parameters.iter().position(|p| p == "Cl_p").expect("roll damping");
    let begun = declared.declared[roll];
    let [walks, stays] = [false, true].map(|near_declared| {
        let (mut free, mut model) = (Engine { near_declared, ..engine.coarse() }, declared.clone());
        let mut farthest: f64 = 0.0;
        for slack in [1.0, 1.0, 1.0, 0.3, 0.3, 0.3] {
            free.slack = [slack; 6];
            model = free.climb(&model, false, 4).expect("a fit").model;
            farthest = farthest.max((model.declared[roll] - begun).abs() / begun.abs());
        }
        farthest
    });
    assert!(stays < 0.5 && walks > 1.5, "{stays} {walks}");
}
