//! discover tests: what each launch lacks, in closed form and on flights with more lift than modelled.

use super::*;
use crate::close::tests::{body, campaign};
use windfall_model::PointRecord;
use windfall_sim::fly_point;

/// A track that is t² a unit of the coefficient, measured with 0.4 more than modelled: 0.4 is found, with σ/√Σt⁴; an axis that was
/// not measured counts for nothing.
#[test]
fn exact_what_a_launch_has_beyond_the_coefficient() {
    let t: Vec<f64> = (0..50).map(|i| 0.02 * f64::from(i)).collect();
    let of = |more: f64| {
        let axis: Vec<f64> = t.iter().map(|t| (0.4 - more) * t * t).collect();
        let residual_m = [Some(axis), None, None, None, None, None];
        let (t_s, position_m, velocity_m_s) = (t.clone(), [0.0; 3], [1.0, 0.0, 0.0]);
        TrackResidual { run: 0, measured: Measured::Position, t_s, residual_m, position_m, velocity_m_s }
    };
    let (found, std) = extra(&of(0.0), &of(STEP), 0.001).expect("a slope");
    let sum: f64 = t.iter().map(|t| t.powi(4)).sum();
    assert!((found - 0.4).abs() < 1e-9 && (std - 0.001 / sum.sqrt()).abs() < 1e-12, "{found} {std}");
    assert!(extra(&of(0.0), &of(0.0), 0.001).is_none(), "nothing follows the coefficient");
}

/// A residual of 3 mm + 0.2 m/s t + 0.7 m/s² t²/2 is a push of 0.7 m/s². Of n even samples over T its standard deviation tends to
/// σ √720/(T² √n); at 200 samples it is within 2 %.
#[test]
fn exact_push_of_a_parabola() {
    let t: Vec<f64> = (0..200).map(|i| 0.004 * f64::from(i)).collect();
    let e: Vec<f64> = t.iter().map(|t| 0.003 + 0.2 * t + 0.35 * t * t).collect();
    let (found, std) = push(&t, &e, 0.002).expect("three numbers of 200");
    assert!((found - 0.7).abs() < 1e-9, "{found}");
    let limit = 0.002 * 720.0_f64.sqrt() / (0.8_f64.powi(2) * 200.0_f64.sqrt());
    assert!((std / limit - 1.0).abs() < 0.02, "{std} {limit}");
    assert!(push(&t[..1], &e[..1], 0.002).is_none());
}

/// Launches at 5.9 m/s with spins of 5, 12 and 9 rev/s and 0.03 more lift than the model's line 0.1 + 0.02 n: each is found at its
/// spin ratio 2πn r/V. Flights are linear in the coefficient to a hundredth of the excess; error bars are 1.96 standard deviations.
#[test]
fn recover_lift_of_every_launch() {
    let mut plant = body();
    plant.point.air_density_kg_m3 = 1.2;
    (plant.point.lift_constant, plant.point.lift_per_input) = (0.1, vec![0.02]);
    let mut truth = plant.clone();
    truth.point.lift_constant += 0.03;
    let spins = [5.0, 12.0, 9.0];
    let t_s: Vec<f64> = (0..40).map(|i| 0.01 * f64::from(i)).collect();
    let launch = |n: f64| {
        let flown = fly_point(&truth.for_run(0, &[n]), 1.2, &t_s, [0.0; 3], [-2.0, 5.4, 1.2]).expect("flies");
        let position_m = std::array::from_fn(|a| Some(flown.iter().map(|r| r[a]).collect()));
        (vec![n], PointRecord { t_s: t_s.clone(), position_m, ..PointRecord::default() })
    };
    let c = campaign(plant, &["spin_rev_s"], spins.map(launch).to_vec());
    let evidence = TrackEvidence::new(&c, &[0, 1, 2], &c.plant).expect("three tracks");
    let figure = lift(&c, &c.plant, &evidence, 0.002).expect("a plant with lift");
    let (line, measured) = (&figure.series[0], &figure.series[1]);
    let speed = (4.0_f64 + 5.4 * 5.4 + 1.2 * 1.2).sqrt();
    let [low, high] = measured.band.as_ref().expect("bars");
    let (mut more, own) = (c.plant.clone(), evidence.series(&c.plant));
    more.point.lift_constant += 0.01;
    let moved = evidence.series(&more);
    for (k, (n, run)) in [(5.0, 0), (9.0, 2), (12.0, 1)].into_iter().enumerate() {
        let ratio = std::f64::consts::TAU * n * 0.05 / speed;
        // The estimated speed is off by what the lift makes of it.
        assert!((measured.x[k] / ratio - 1.0).abs() < 1e-2, "{} {ratio}", measured.x[k]);
        let fitted = 0.1 + 0.02 * n;
        assert!((line.y[k] - fitted).abs() < 1e-6 && (measured.y[k] - fitted - 0.03).abs() < 3e-4, "{figure:?}");
        // By the slopes of the residual.
        let pairs = own[run].residual_m.iter().zip(&moved[run].residual_m).filter_map(|(a, b)| Some((a.as_ref()?, b.as_ref()?)));
        let square: f64 = pairs.flat_map(|(a, b)| a.iter().zip(b).map(|(a, b)| ((a - b) / 0.01).powi(2))).sum();
        let bar = NORMAL_95 * 0.002 / square.sqrt();
        assert!((measured.y[k] - low[k] - bar).abs() < 1e-4 * bar.max(0.1), "{low:?} {bar}");
        assert!((high[k] - measured.y[k] - bar).abs() < 1e-4 * bar.max(0.1), "{high:?} {bar}");
    }
}

/// Of two settings the difference is one more; pushes over a setting stand in its order, with bars of 1.96 standard deviations.
#[test]
fn exact_difference_of_settings_and_bars() {
    let runs = [[3.0, 1.2], [5.0, 2.1], [4.0, 2.6]].map(|u| (u.to_vec(), PointRecord::default())).to_vec();
    let all = settings(&campaign(body(), &["a", "b"], runs));
    assert_eq!(all[0].0, "a less b");
    assert!(all[0].1.iter().zip([1.8, 2.9, 1.4]).all(|(a, b)| (a - b).abs() < 1e-12), "{all:?}");
    let t: Vec<f64> = (0..9).map(|i| 0.1 * f64::from(i)).collect();
    let of = |run: usize, push: f64| TrackResidual {
        run,
        measured: Measured::Position,
        t_s: t.clone(),
        residual_m: [None, Some(t.iter().map(|t| 0.5 * push * t * t).collect()), None, None, None, None],
        position_m: [0.0; 3],
        velocity_m_s: [0.0; 3],
    };
    let found = series(Role::Before, &[of(0, 0.7), of(1, -0.4), of(2, 0.2)], 1, &all[0].1, 0.002);
    // By orthogonal polynomials: ½ a₂ (0.1 s)² is what k² − 20/3 is times, whose squares sum to 308 over −4 … 4.
    let bar = NORMAL_95 * 0.002 * 200.0 / 308.0_f64.sqrt();
    let [low, high] = found.band.as_ref().expect("bars");
    for (k, (x, push)) in [(1.4, 0.2), (1.8, 0.7), (2.9, -0.4)].into_iter().enumerate() {
        assert!((found.x[k] - x).abs() < 1e-12 && (found.y[k] - push).abs() < 1e-9, "{found:?}");
        assert!((low[k] - push + bar).abs() < 1e-5 && (high[k] - push - bar).abs() < 1e-5, "{low:?} {high:?} {bar}");
    }
}
