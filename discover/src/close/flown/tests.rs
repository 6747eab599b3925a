//! discover tests: units of what runs flown again are apart, and ends of their distributions.

use super::*;

#[test]
fn exact_degrees_and_millimetres_apart() {
    let one = TrajectoryError { attitude_rms_deg: 0.3, position_rms_m: 0.0042, rate_rms_deg_s: 7.0 };
    let [angle, distance] = apart(&[one]);
    assert!((angle[0] - 0.3).abs() < 1e-15 && (distance[0] - 4.2).abs() < 1e-12);
}

/// Up to a fifth more than the largest that was measured: 5 deg and 20 deg/s, in either of two runs, whatever flights reach. The
/// area is the share inside: of three flown angles one is beyond 6 deg.
#[test]
fn exact_ends_of_a_distribution() {
    let runs: [Vec<SwingSeries>; 2] = [
        vec![(Role::Measured, [vec![5.0, 1.0], vec![8.0]]), (Role::Before, [vec![9.0, 3.0], vec![2.0]])],
        vec![(Role::Measured, [vec![4.0], vec![20.0]]), (Role::Before, [vec![2.0], vec![1.0]])],
    ];
    let all = distributions("calm", &[&runs[0], &runs[1]]);
    for (figure, end) in all.iter().zip([6.0, 24.0]) {
        assert!(figure.series.iter().all(|s| s.x[0] == 0.0 && (s.x[79] - end).abs() < 1e-4), "{:?}", figure.series);
    }
    let area = all[0].series[1].y.iter().sum::<f64>() * 0.5 * 0.15;
    assert!((area - 2.0 / 3.0).abs() < 1e-4, "{area}");
}
