//! replay tests: a run made ready, against closed forms.

use super::super::tests::flown;
use super::*;

/// What a beginning has, and that the smoothing of a replay is the one that cross-validation found.
#[test]
fn exact_beginning_and_smoothing() {
    let (plant, record) = flown(0.8, true);
    let replay = Replay::new(&record, &plant).expect("smooth");
    assert_eq!(replay.fly_beginning(replay.first(), 23).expect("flies").record.len(), 23);
    let found = smooth(&record, &Smoother::Auto).expect("smooth");
    let again = smooth(&record, replay.smoother()).expect("smooth");
    assert!(
        (again.bandwidth_hz[0] / found.bandwidth_hz[0] - 1.0).abs() < 1e-9,
        "{:?} {:?}",
        again.bandwidth_hz,
        found.bandwidth_hz
    );
    // One instrument has one noise: the root mean square over its channels, √((2.25 + 4 + 16)/3) and √((0.36 + 1.21)/2).
    let made = Smoothed { noise_std: [1.5, 2.0, 4.0, 0.3, 0.6, 1.1, 0.05], ..found };
    let s = measured_noise(&made, &plant.sensors);
    assert!(
        (s.position_std_m - (22.25_f64 / 3.0).sqrt()).abs() < 1e-15 && (s.pitch_yaw_std_rad - 0.785_f64.sqrt()).abs() < 1e-15
    );
    assert!((s.roll_std_rad - 0.3).abs() < 1e-15 && (s.wind_std_m_s - 0.05).abs() < 1e-15);
}

/// An attitude that is not turned keeps its angles, whole turns included.
#[test]
fn law_turns_are_kept() {
    let attitude = [7.0, 0.3, -9.0];
    let same = turned(attitude, [0.0; 3]);
    assert!((0..3).all(|k| (same[k] - attitude[k]).abs() < 1e-13), "{same:?}");
}

/// A clock that shows 1.03 s a second samples more often than its times say, and the run is as much shorter.
#[test]
fn exact_flight_by_a_fast_clock() {
    let (mut plant, record) = flown(0.3, false);
    plant.sensors.time_base = 0.03;
    let replay = Replay::new(&record, &plant).expect("smooth");
    assert_eq!(record.len(), 46);
    let flight = replay.order(replay.first());
    assert!((flight.rate_hz / (150.0 * 1.03) - 1.0).abs() < 1e-12 && (flight.duration_s * 1.03 / 0.3 - 1.0).abs() < 1e-12);
}
