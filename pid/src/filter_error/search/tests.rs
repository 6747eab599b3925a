//! pid tests: the parts of filter error's search.

use super::*;
use crate::filter_error::filter::tests::NOISE;
use crate::filter_error::likelihood::tests::unknowns as four;
use crate::output_error::flown::{Shown, erring, flown_in};
use windfall_model::{Plant, Record};

fn noise() -> PerChannel<f64> {
    NOISE.map(|n| 0.1 * n)
}

/// A flight of 27 samples in gusts of 0.15 m/s and so, as instruments of some noise show it.
fn gusty(plant: &Plant) -> Record {
    let gust = |t: f64| {
        let mut added = [0.0; crate::equations::ADDED];
        for (axis, (size, w, phase)) in [(0.2, 23.0, 0.4), (0.25, 31.0, 1.9), (0.2, 19.0, 3.0)].into_iter().enumerate() {
            added[axis] = size * (w * t + phase).sin();
            added[3 + axis] = size * w * (w * t + phase).cos();
        }
        added
    };
    let mut record = flown_in(plant, 0, gust).record(plant, &Shown::default());
    let Record { position_m, attitude_rad, vw_m_s, .. } = &mut record;
    let series = position_m.iter_mut().chain(attitude_rad).chain(std::iter::once(vw_m_s));
    for ((c, series), std) in series.enumerate().zip(noise()) {
        for (i, x) in series.iter_mut().enumerate() {
            *x += std * std::f64::consts::SQRT_2 * ((7 * i * i + 3 * c) as f64 + 0.3).sin();
        }
    }
    record
}

fn on_gusty<T>(look: impl FnOnce(&mut Search<'_, '_>, SearchPoint) -> T) -> T {
    let plant = erring();
    let record = gusty(&plant);
    let run = PreparedRun::new("gusty", &record, &plant).expect("it can be integrated");
    let mut search = Search { filters: vec![Filter::new(&run, noise())], work: Transition::default(), iterations: 50 };
    look(&mut search, SearchPoint::new(four(&plant), START_SIZE_M_S))
}

/// By brute force over all sizes of a range that are a power of three from the start: upwards, downwards, up to the range's ends,
/// and of one gust alone.
#[test]
fn exact_start_is_the_likeliest_size() {
    on_gusty(|search, start| {
        let with = |size: f64, which: &[usize]| {
            let mut point = start.clone();
            which.iter().for_each(|&k| point.random[k] = size.ln());
            point
        };
        for (from, which, range) in [
            (0.003, vec![0, 1], 8e-4..2.0),
            (6.5, vec![0, 1], 8e-4..20.0),
            (0.0089, vec![0, 1], 8e-4..0.1),
            (6.48, vec![0, 1], 0.5..20.0),
            (0.24, vec![0, 1], 8e-4..2.0),
            (0.005, vec![1], 8e-4..2.0),
        ] {
            let sizes = (-10..=10).map(|n| from * 3.0_f64.powi(n)).filter(|s| range.contains(s));
            let value = |size: f64| log_likelihood2(&search.filters, &with(size, &which), &mut Transition::default());
            let likeliest = sizes.max_by(|a, b| value(*a).partial_cmp(&value(*b)).expect("flies")).expect("some");
            let mut point = with(from, &which);
            search.likeliest(&mut point, &which, range);
            for k in 0..4 {
                let expected = if which.contains(&k) { likeliest.ln() } else { start.random[k] };
                assert!((point.random[k] - expected).abs() < 1e-12, "{from} {k}: {} {likeliest}", point.random[k].exp());
            }
        }
    });
}

/// A climb ends where no combination of unknowns has a tenth of a standard error to go, wherever it began: any two ends are two
/// tenths apart at most. Damping falls by ten a step, so it is as quick as scoring: six steps do from half the size (of which a
/// step takes up to a logarithm of 0.7), and from the peak with two parameters some standard errors off it.
#[test]
fn law_a_climb_ends_at_the_peak() {
    on_gusty(|search, start| {
        let from = |size: f64| SearchPoint::new(start.unknowns.clone(), size);
        let first = search.climb(from(0.08), 6).expect("climbs");
        let (free, random) = (start.unknowns.free(), DVector::from_column_slice(&first.point.random));
        let std: Vec<f64> = first.covariance.diagonal().iter().map(|v| v.sqrt()).collect();
        let mut away = DVector::zeros(free + RANDOM);
        (away[1], away[3]) = (3.0 * std[1], -2.0 * std[3]);
        for (point, most) in [(from(0.01), 20), (from(0.3), 20), (first.point.moved(&away), 6)] {
            let found = search.climb(point, most).expect("climbs");
            let here = local(&search.filters, &found.point, &mut search.work).expect("flies");
            let inverse = here.information.clone().try_inverse().expect("definite");
            assert!((here.score.transpose() * &inverse * &here.score)[0] < 0.01, "{}", here.score);
            for (i, (a, b)) in found.point.unknowns.values().iter().zip(first.point.unknowns.values()).enumerate() {
                assert!((a - b).abs() < 0.2 * std[i], "{i}: {a} {b} {}", std[i]);
            }
            (0..2).for_each(|k| assert!((found.point.random[k] - random[k]).abs() < 0.2 * std[free + k], "{k}: {random}"));
        }
    });
}

/// Where the whole search ends no unknown can move by a standard error, all else held, without the runs being less likely.
#[test]
fn law_a_search_ends_at_the_peak() {
    on_gusty(|search, start| {
        let found = search.find(Begin::From(start.unknowns)).expect("climbs");
        assert_eq!(found.point.sought, Sought { scales: true, turning: false });
        for i in (0..found.local.score.len()).filter(|i| !found.point.held(*i)) {
            for side in [-1.0, 1.0] {
                let mut step = DVector::zeros(found.local.score.len());
                step[i] = side / found.local.information[(i, i)].sqrt();
                let there = local(&search.filters, &found.point.moved(&step), &mut search.work).expect("flies");
                let fall = found.local.log_likelihood2 - there.log_likelihood2;
                // One, where the likelihood is a parabola.
                assert!(fall > 0.3 && fall < 3.0, "{i} {side}: {fall}");
            }
        }
    });
}

/// A scale more than two from the logarithm of 0.6 m has run away, and one less than that has not, on both sides.
#[test]
fn law_a_scale_runs_away_on_both_sides() {
    on_gusty(|search, start| {
        for k in [2, 3] {
            for (off, away) in [(-2.2, true), (-1.8, false), (1.8, false), (2.2, true)] {
                let mut point = start.clone();
                point.random[k] = 0.6_f64.ln() + off;
                let stop = search.climb(point, 20).err();
                assert_eq!(stop == Some(StopReason::ScaleAway), away, "{k} {off}: {stop:?}");
            }
        }
    });
}

/// A gust whose logarithm is known to half or worse is taken for none where without it the likelihood, twice its logarithm, falls
/// by less than 9.2, and kept where it falls by more; one that is told better, and turning that is not sought, are not looked at.
#[test]
fn exact_gusts_taken_for_none() {
    on_gusty(|search, start| {
        let free = start.unknowns.free();
        // Lateral gusts alone are vague, and turning that is held.
        let std = [0.3, 0.51, 0.9, 0.9, 5.0, 0.3];
        let covariance = DMatrix::from_fn(free + RANDOM, free + RANDOM, |i, j| match i.checked_sub(free) {
            Some(k) if i == j => f64::powi(std[k], 2),
            _ if i == j => 0.04,
            _ => 0.001,
        });
        let there = log_likelihood2(&search.filters, &start.without(1), &mut search.work).expect("flies");
        let mut point = start.clone();
        assert!(search.give_up_negligible(&mut point, &covariance, there + 9.1));
        let noted = point.negligible[1].expect("given up");
        assert!((noted - START_SIZE_M_S).abs() < 1e-15 && point.kept == [false; 4], "{:?}", point.kept);
        assert_eq!(point.negligible.map(|n| n.is_some()), [false, true, false, false]);
        let mut point = start.clone();
        assert!(!search.give_up_negligible(&mut point, &covariance, there + 9.3));
        assert_eq!((point.kept, point.negligible), ([false, true, false, false], [None; 4]));
        // What is kept is not tried again.
        assert!(!search.give_up_negligible(&mut point, &covariance, there - 100.0) && point.negligible == [None; 4]);
    });
}

/// A step may lose a tenth of twice the log-likelihood, and move a logarithm of the drive by 0.7 up and 1.6 down.
#[test]
fn exact_steps_that_are_taken() {
    on_gusty(|search, start| {
        let free = start.unknowns.free();
        let mut step = DVector::zeros(free + RANDOM);
        (step[0], step[free]) = (0.05, 0.69);
        let there = local(&search.filters, &start.moved(&step), &mut search.work).expect("flies").log_likelihood2;
        for (by, taken) in [(0.09, true), (0.11, false)] {
            assert_eq!(search.attempt(&start, &step, there + by).is_some(), taken, "{by}");
        }
        for (by, taken) in [(0.69, true), (0.71, false), (-1.59, true), (-1.61, false)] {
            step[free + 1] = by;
            assert_eq!(search.attempt(&start, &step, f64::MIN).is_some(), taken, "{by}");
        }
    });
}

/// The step of `(I + λ D) step (1 + 0.1 λ) = score`, D the diagonal of the random drive's information: by its product, to rounding.
#[test]
fn exact_damped_step() {
    let (free, damping) = (2, 3.7);
    let count = free + RANDOM;
    let information = DMatrix::from_fn(count, count, |i, j| if i == j { 3.0 + i as f64 } else { 0.4 * ((i * j) as f64).cos() });
    let now = LocalLikelihood {
        log_likelihood2: 0.0,
        score: DVector::from_fn(count, |i, _| (1.0 + i as f64).sin()),
        information,
        whitened: Vec::new(),
        left: [0.0; 7],
        samples: 0.0,
    };
    let step = damped(&now, free, damping).expect("definite");
    let mut m = now.information.clone();
    (2..8).for_each(|k| m[(k, k)] += 3.7 * now.information[(k, k)]);
    assert!((m * step * 1.37 - &now.score).amax() < 1e-13);
}
