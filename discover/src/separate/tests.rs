//! discover tests: the order of runs and bounds by hand, and the run that is flown.

use super::*;

/// Twice the logarithm of odds of twenty, 5.99, is enough: runs that bring it come first, the shortest first, of equal length the surer;
/// others by log odds for their time.
#[test]
fn exact_order_of_runs() {
    let runs = [
        ([7.0, 9.0], 100.0),
        ([6.5, 6.2], 40.0),
        ([50.0, 5.98], 20.0),
        ([3.0, 2.5], 30.0),
        ([1.0, 0.9], 15.0),
        ([6.3, 8.0], 40.0),
        ([6.0, 6.1], 90.0),
    ];
    let mut all: Vec<(usize, [f64; 2])> = runs.iter().map(|r| r.0).enumerate().collect();
    rank(&mut all, |i| runs[i].1);
    assert_eq!(all.iter().map(|(i, _)| *i).collect::<Vec<_>>(), [5, 1, 6, 0, 2, 3, 4]);
}

/// Wide is beyond a fiftieth of the plausible size; the widest for its size leads.
#[test]
fn exact_order_of_bounds() {
    let plausible = [10.0, 0.5, 3.0, 0.2, 7.0];
    let std = [0.3, 0.02, 0.059, 0.0041, 0.9];
    let found = widest((0..5).zip(std).collect(), |i: &usize| plausible[*i]);
    // Shares: 0.03, 0.04, below 0.02, 0.0205, 0.13.
    assert_eq!(found.iter().map(|(i, _)| *i).collect::<Vec<_>>(), [4, 1, 0, 3]);
    assert!((worth(0.5, 0.2, 40.0) - (25.0 - 4.0) / 40.0).abs() < 1e-14);
}

/// The run that is flown: released at the angle in pitch and yaw, rolling, beside the axis, without speed; the tunnel's speed is a sine of
/// eight seconds about its mean, given every twentieth of a second until after the end.
#[test]
fn exact_flight_of_a_run() {
    let scenario = windfall_scenarios::read_bundled("sage-combined").expect("bundled").scenario;
    let mut like = scenario.flights[0].clone();
    (like.release.position_m, like.release.attitude_rad[0]) = ([0.3, 0.15, -0.2], 0.7);
    let campaign = Campaign::of_flights("one", &scenario.plant, &[], &windfall_model::Knowledge::default(), Vec::new());
    let range =
        Range { campaign: &campaign, used: &[], plant: scenario.plant.clone(), like, mean_speed_m_s: 7.4, between_s: 55.0 };
    let run = range.run(12.0, 60.0, 0.4, 0.08, 6.01);
    assert!((run.tunnel_time_s - 61.01).abs() < 1e-14);
    let flight = range.flight(run);
    let (at, angle) = (flight.release, 12.0 * std::f64::consts::PI / 180.0);
    let found = [at.attitude_rad, at.position_m, at.rates_rad_s, at.velocity_m_s];
    let expected = [[0.7, angle, angle], [0.3, 0.55, -0.2], [5.0 * angle, 0.0, 0.0], [0.0; 3]];
    assert!(found.iter().flatten().zip(expected.iter().flatten()).all(|(a, b)| (a - b).abs() < 1e-14), "{found:?}");
    let TunnelSpeed::History { interval_s, vw_m_s } = flight.speed else { panic!("a history") };
    let end_s = interval_s * (vw_m_s.len() - 1) as f64;
    assert!((interval_s - 0.05).abs() < 1e-15 && (6.01..6.2).contains(&end_s), "{end_s}");
    for (k, speed) in vw_m_s.iter().enumerate() {
        let eighth = (0.25 * std::f64::consts::PI * 0.05 * k as f64).sin();
        assert!((speed - (7.4 + 0.592 * eighth)).abs() < 1e-13, "{k}: {speed}");
    }
}
