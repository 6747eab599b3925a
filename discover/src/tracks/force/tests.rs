//! discover tests: specific forces of falls and throws with drag against closed forms and a search through all velocities.

use super::super::tests::{GRAVITY_M_S2, ball, close, times, wiggle};
use super::*;
use windfall_model::{Measured, PointRecord};

/// Specific force `−g v|v|/V²` of a body that was thrown down, or up (`v = −V tan(φ − g t/V)` until it stands, `V tanh` from
/// there).
fn felt(cd: f64, v0: f64, t: f64) -> f64 {
    let area = std::f64::consts::FRAC_PI_4 * 0.12 * 0.12;
    let (g, terminal) = (GRAVITY_M_S2, (2.0 * 0.2 * GRAVITY_M_S2 / (1.3 * area * cd)).sqrt());
    let of_start = if v0 < 0.0 { (v0 / terminal).atan() } else { (v0 / terminal).atanh() };
    let at = of_start + g * t / terminal;
    let v = if at < 0.0 { at.tan() } else { at.tanh() };
    -g * v * v.abs()
}

/// Forces along X and Y with an offset of each and what the state makes none of.
fn track(cd: f64, v0: f64, t_s: &[f64], errors: f64) -> Track {
    let down = t_s.iter().zip(wiggle(t_s, errors, 0.3, false)).map(|(t, e)| felt(cd, v0, *t) + 0.7 + e).collect();
    let record = PointRecord {
        t_s: t_s.to_vec(),
        measured: Measured::SpecificForce,
        position_m: [Some(down), Some(vec![0.3; t_s.len()]), None],
        ..PointRecord::default()
    };
    Track::new(&record, &[], 0, &ball(cd), false).expect("flies")
}

/// Squares over the stated noise of 0.2 of what a velocity leaves about its mean, and of what gravity makes in the time of the run,
/// for the velocity times that time; with that mean.
fn cost(cd: f64, track: &Track, v0: f64) -> (f64, f64) {
    let (n, end) = (track.t_s.len(), track.duration_s());
    let left: Vec<f64> = (0..n).map(|i| track.measured[i] - felt(cd, v0, track.t_s[i])).collect();
    let mean = left.iter().sum::<f64>() / n as f64;
    let squares = left.iter().map(|e| (e - mean).powi(2)).sum::<f64>();
    (squares / 0.04 + (v0 / (GRAVITY_M_S2 * end)).powi(2), mean)
}

/// The best velocity of all within reach: every thousandth of it, then golden sections.
fn best(cd: f64, track: &Track) -> f64 {
    let reach = GRAVITY_M_S2 * track.duration_s();
    let at = |v: f64| cost(cd, track, v).0;
    let all = (-1000..=1000).map(|k| f64::from(k) * reach / 1000.0);
    let near = all.min_by(|a, b| at(*a).total_cmp(&at(*b))).expect("many");
    let (mut low, mut high) = (near - reach / 1000.0, near + reach / 1000.0);
    let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
    for _ in 0..60 {
        let (a, b) = (high - golden * (high - low), low + golden * (high - low));
        if at(a) < at(b) { high = b } else { low = a }
    }
    f64::midpoint(low, high)
}

/// Drag so weak that the prior holds the velocity, drag that shows it, a long fall, and a throw upward. Golden sections find the
/// lowest of a cost to the root of its rounding, 1e-7 of the velocity's uncertainty or so.
#[test]
fn exact_velocity_is_the_best_of_all() {
    for (cd, v0, end_s, errors, by) in
        [(0.05, 3.0, 0.9, 0.02, 1e-5), (2.0, 2.0, 0.9, 0.02, 1e-6), (0.02, 30.0, 12.0, 0.02, 1e-5), (6.0, -6.0, 1.3, 0.02, 1e-6)]
    {
        let track = track(cd, v0, &times(9, 0.0, end_s), errors);
        let (theta, e) = track.launched(&track.own(&ball(cd))).expect("flies");
        let v = best(cd, &track);
        assert_eq!(theta.len(), 4);
        close(theta[0] / end_s, v, by);
        close(theta[1], 0.0, 1e-9);
        let mean = cost(cd, &track, theta[0] / end_s).1;
        close(theta[2], mean, 1e-9);
        close(theta[3], 0.3, 1e-9);
        for i in 0..9 {
            close(e[i], track.measured[i] - felt(cd, theta[0] / end_s, track.t_s[i]) - mean, 1e-9);
            close(e[9 + i], 0.0, 1e-9);
        }
        let reach = GRAVITY_M_S2 * end_s * end_s;
        let (at, _, found) = track.launched_from(&track.own(&ball(cd)), theta.clone(), reach).expect("flies");
        close(found / cost(cd, &track, at[0] / end_s).0, 1.0, 1e-8);
    }
}

/// A constant and a slope of either axis leave nothing in the basis, nor in the start, and are all that the state takes.
#[test]
fn law_bases_forget_a_constant_and_a_slope() {
    let t_s = times(9, 0.0, 1.3);
    let track = track(2.0, 2.0, &t_s, 0.02);
    assert_eq!((track.state_basis.ncols(), track.basis.ncols()), (4, 14));
    for axis in 0..2 {
        let line = DVector::from_fn(18, |i, _| if i / 9 == axis { 0.7 - 1.9 * t_s[i % 9] } else { 0.0 });
        close(track.basis.tr_mul(&line).amax(), 0.0, 1e-12);
    }
}
