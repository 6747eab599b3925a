//! discover tests: what the search minimises against flights looked at by hand; steps of its bookkeeping.

use super::*;
use crate::statistics::tests::setup;
use windfall_model::effects::find;

fn effect(family: &str) -> &'static Effect {
    find(family, Acts::Lander).expect("an effect of the catalogue")
}

pub(super) const OPTIONS: StatisticsOptions = StatisticsOptions {
    screen_points: 1,
    screen_runs: 2,
    pair_points: 3,
    pairs: 1,
    leads: 1,
    coarse_runs: 3,
    steps_per_parameter: 7,
    fine_runs: 4,
    kept: [1, 1],
    final_runs: 6,
    relative_tolerance: 1e-4,
};

/// A search over runs of two seconds.
pub(super) fn with_search<T>(test: impl FnOnce(&Search<'_>) -> T) -> T {
    let [setup, coarse] = &flown(&setup(), &OPTIONS);
    let used = setup.fitted();
    test(&Search { test: judge::logs(&setup.test_row(), &used), setup, coarse, options: &OPTIONS, used, flights: Cell::new(0) })
}

/// Strong gusts, and an asymmetry with one strength.
pub(super) fn gusts() -> Found {
    let mut h = Hypothesis::none(2.0).with(effect("turbulence")).with(effect("asymmetry"));
    for i in [5, 6, 7] {
        h = h.without(i);
    }
    Found { h, x: vec![0.4, 0.72, 0.5, 0.3, 0.81, 0.0, 0.0, 0.0], misfit: f64::INFINITY }
}

/// The search flies as the judgement, with tolerances ten times as wide and at most 50 samples in a second.
#[test]
fn exact_coarse_flights() {
    let [fine, coarse] = flown(&setup(), &OPTIONS);
    let tolerances = |s: &StatisticsSetup| [s.flown.numerics.relative_tolerance, s.flown.numerics.absolute_tolerance];
    let close = |a: [f64; 2], b: [f64; 2]| a.iter().zip(b).all(|(a, b)| (a / b - 1.0).abs() < 1e-14);
    assert!(close(tolerances(&fine), [1e-4, 1e-6]) && close(tolerances(&coarse), [1e-3, 1e-5]));
    assert!((fine.flown.rate_hz - 100.0).abs() < 1e-12 && (coarse.flown.rate_hz - 50.0).abs() < 1e-12);
}

/// Logarithms of means over runs, and the misfit of two figures by their variances and correlation written out; every value that is
/// minimised is made of these.
#[test]
fn exact_values_that_are_minimised() {
    with_search(|s| {
        let f = gusts();
        let look = |runs: u64| {
            let (rows, _) = fly_runs(s.coarse, &f.h.plant(&s.setup.plant, &f.x), 0..runs).expect("flies");
            let mean = |of: &dyn Fn(&Vec<f64>) -> f64| rows.iter().map(of).sum::<f64>() / rows.len() as f64;
            let centre = [0, 1].map(|i| mean(&|r| r[i].ln()));
            let product = |i: usize, k: usize| {
                let sum: f64 = rows.iter().map(|r| (r[i].ln() - centre[i]) * (r[k].ln() - centre[k])).sum();
                sum / (rows.len() as f64 - 1.0) + if i == k { 0.05 * 0.05 } else { 0.0 }
            };
            let [xx, xy, yy] = [product(0, 0), product(0, 1), product(1, 1)];
            let [x, y] = [2.9_f64.ln() - centre[0], 14.0_f64.ln() - centre[1]];
            let determinant = xx * yy - xy * xy;
            let misfit = (yy * x * x - 2.0 * xy * x * y + xx * y * y) / determinant + determinant.ln();
            let off = [2.9, 14.0].iter().enumerate().map(|(i, test): (usize, &f64)| (mean(&|r| r[i]) / test).ln());
            (misfit, off.collect::<Vec<_>>())
        };
        let close = |found: f64, expected: f64, what: &str| {
            assert!((found - expected).abs() < 1e-9 * expected.abs().max(1.0), "{what}: {found} {expected}");
        };
        let (misfit, off) = look(3);
        let seen = s.look(&f.h, &f.x, 3).expect("flies");
        close(seen.misfit, misfit, "misfit");
        (0..2).for_each(|i| close(seen.mean[i] - s.test[i], off[i], "mean"));
        // Scales on the logarithm from 0.05 m to 10 m, typical at 0.6 m.
        let typical = 12.0_f64.ln() / 200.0_f64.ln();
        let distance = (0.5 - typical).powi(2) + (0.3 - typical).powi(2);
        close(s.coarse_value(&f.h, &f.x), misfit + 4.0 * distance, "coarse");
        let (misfit, off) = look(4);
        close(s.fine_value(&f.h, &f.x), misfit + (off[0] * off[0] + off[1] * off[1]) / (0.15 * 0.15), "fine");
        close(s.score(&f), misfit + 10.0, "five parameters");
    });
}

/// Along its derivative a figure reaches, a twentieth of the range nearer to the middle, what it is there: of places near either end
/// and of one between, one of three strengths held.
#[test]
fn exact_derivative() {
    with_search(|s| {
        let h = Hypothesis::none(2.0).with(effect("asymmetry")).without(1);
        let f = Found { h, x: vec![0.97, 0.0, 0.03, 0.6], misfit: 0.0 };
        let at = s.mean(&f.h, &f.x).expect("flies");
        let found = s.derivative(&f, &at).expect("flies");
        assert_eq!(found.shape(), (2, 3));
        for (column, (i, inward)) in [(0, -0.05), (2, 0.05), (3, -0.05)].into_iter().enumerate() {
            let mut x = f.x.clone();
            x[i] += inward;
            let expected = s.mean(&f.h, &x).expect("flies");
            let reached = &at + found.column(column) * inward;
            assert!((&expected - &at).amax() > 1e-9 && (reached - expected).amax() < 1e-13, "{i}");
        }
    });
}

/// The least value of a bowl whose middle lies at places of the searched numbers only, by as many evaluations as options allow for each
/// of them and two more.
#[test]
fn exact_steps_downhill() {
    with_search(|s| {
        let f = gusts();
        let calls = Cell::new(0);
        let middle = [0.3, 0.7, 0.55, 0.2, 0.9];
        let found = s.downhill(&f, 0.1, |_, x| {
            calls.set(calls.get() + 1);
            assert_eq!(x[5..], [0.0; 3], "held");
            x.iter().zip(middle).map(|(x, m)| (x - m).powi(2)).sum()
        });
        // A round of a simplex of five may look six times more.
        assert!((49..56).contains(&calls.get()), "{}", calls.get());
        let off: f64 = found.x.iter().zip(middle).map(|(x, m)| (x - m).powi(2)).sum();
        assert!((found.misfit - off).abs() < 1e-15 && off < 0.04, "{:?}", found.x);
    });
}

/// Two figures, of spreads 0.2 and 0.5.
#[test]
fn exact_screening() {
    let at = |x: [f64; 2]| DVector::from_column_slice(&x);
    let rows: Rows = [[0.2, 0.5], [-0.2, 0.5], [0.2, -0.5], [-0.2, -0.5]]
        .map(|[a, b]: [f64; 2]| vec![(0.75_f64.sqrt() * a).exp(), (0.75_f64.sqrt() * b).exp()])
        .to_vec();
    let spread = Spread::with_floor(&rows, &[0, 1], 0.0).expect("a covariance");
    assert!((change(&at([1.0, 2.0]), &at([0.7, 2.4]), &spread) - 1.5).abs() < 1e-12);
    assert!((change(&at([1.0, 2.0]), &at([1.1, 0.9]), &spread) - 2.2).abs() < 1e-12);
    // Root mean squares of 0.6 and 0.15.
    assert!((closed(0.36, 0.0225) - 0.75).abs() < 1e-14);
}

/// A first effect's strength falls by a fifth over the points beside a second one, each in the middle of its share, to the bottom at
/// most; beside another lead it falls by a quarter of that, and the second effect stays as it was, with its sign.
#[test]
fn exact_places_beside_another() {
    assert!((weaker(0.7, 3, 8) - (0.7 - 0.2 * 3.5 / 8.0)).abs() < 1e-15 && weaker(0.1, 7, 8) == 0.0);

    let first = Hypothesis::none(2.0).with(effect("turbulence"));
    let mut h = first.with(effect("asymmetry"));
    let mut x = vec![0.11, 0.12, 0.13, 0.14, 0.6, 0.7, 0.8, 0.9];
    h.cover(4, 0, &mut x.clone());
    h = h.without(5).holding(7, 0.37);
    let pair = Found { h, x: x.clone(), misfit: 1.0 };
    let lead = Found { h: Hypothesis::none(2.0).with(effect("axial-speed")), x: vec![0.63], misfit: 2.0 };
    let found = pair.beside(&lead);
    assert_eq!(found.h.families(), ["axial-speed", "asymmetry"]);
    x.splice(..4, [0.58]);
    assert!(found.x.len() == 5 && found.x.iter().zip(&x).all(|(a, b)| (a - b).abs() < 1e-15), "{:?}", found.x);
    for i in 0..4 {
        assert_eq!(found.h.held(1 + i), pair.h.held(4 + i));
        assert!((found.h.value(1 + i, 0.5) - pair.h.value(4 + i, 0.5)).abs() < 1e-15);
    }
    let low = Found { x: vec![0.03], ..lead };
    assert!(pair.beside(&low).x[0] == 0.0);
}
