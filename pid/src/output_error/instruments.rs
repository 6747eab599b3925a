//! pid: constant errors of the instruments as unknowns beside the parameters. In: a state of the model and the errors. Out: what the
//! instruments show then, with its slopes.
//!
//! The same errors, in the same sense, as `model::Sensors` has; two more that a record can be examined for: angles that are older
//! than positions, and a reported origin that is not where it is declared in the body (Klein and Morelli 2006, ch. 10; Jategaonkar
//! 2015, ch. 10). A late pose is a tunnel speed that is early: no record of both tells one from the other.

use crate::equations::{STATES, Scalar, each, matrix};
use windfall_model::PerChannel;

/// Number of errors.
pub(crate) const ERRORS: usize = 9;
/// Name, unit, and the size up to which one is looked for: the catalogue's ranges, a body's size.
pub(crate) const KINDS: [(&str, &str, f64); ERRORS] = [
    ("wind_scale", "-", 0.3),
    ("wind_delay_s", "s", 2.0),
    ("angle_delay_s", "s", 0.3),
    ("misalignment_x_rad", "rad", 0.2),
    ("misalignment_y_rad", "rad", 0.2),
    ("misalignment_z_rad", "rad", 0.2),
    ("lever_x_m", "m", 0.2),
    ("lever_y_m", "m", 0.2),
    ("lever_z_m", "m", 0.2),
];
const WIND_SCALE: usize = 0;
const WIND_DELAY: usize = 1;
const ANGLE_DELAY: usize = 2;
const MISALIGNMENT: usize = 3;
const LEVER: usize = 6;

/// Errors and how they enter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Errors {
    pub(crate) values: [f64; ERRORS],
    pub(crate) columns: [Option<usize>; ERRORS],
}

impl Errors {
    /// Samples by which a channel's record lags the trajectory; what is left of the delay is under half a sample.
    pub(crate) fn shift(&self, channel: usize, interval_s: f64) -> isize {
        let delay = match channel {
            0..3 => return 0,
            3..6 => self.values[ANGLE_DELAY],
            _ => self.values[WIND_DELAY],
        };
        #[expect(clippy::cast_possible_truncation, reason = "a delay of some samples")]
        let samples = (delay / interval_s).round() as isize;
        samples
    }
}

/// What is known at one sample beside the variables of differentiation.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Known {
    /// Position of the c.m., m.
    pub(crate) p_cm: [f64; 3],
    /// Rate of the body rates, rad/s².
    pub(crate) w_rate: [f64; 3],
    pub(crate) p_origin_cm: [f64; 3],
    /// The plant's own error of the wind, which the unknown one is added to.
    pub(crate) wind_scale: f64,
    /// Whole samples that are taken out of the delays of angles and of wind, s.
    pub(crate) taken_s: [f64; 2],
}

/// Variables of differentiation: Euler angles, body rates, tunnel speed with two derivatives, errors.
pub(crate) const VARIABLES: usize = 9 + ERRORS;
/// Node or state that each of the first nine is.
pub(crate) const STATE_OF: [usize; 6] = [3, 4, 5, 9, 10, 11];

/// What the instruments show.
pub(crate) fn observe<S: Scalar>(v: &[S; VARIABLES], known: &Known) -> PerChannel<S> {
    let (euler, w) = ([v[0], v[1], v[2]], [v[3], v[4], v[5]]);
    let e = &v[9..];
    // Attitude a delay ago: back along the Euler rates of half the delay ago, an error of third order in under half a sample.
    let late = e[ANGLE_DELAY] + -known.taken_s[0];
    let half = late * -0.5;
    let now = euler_rate(euler, w);
    let between = euler_rate(each!(|k| euler[k] + half * now[k]), each!(|k| w[k] + half * known.w_rate[k]));
    let then: [S; 3] = each!(|k| euler[k] - late * between[k]);
    let turned = product(&body(then), &body([e[MISALIGNMENT], e[MISALIGNMENT + 1], e[MISALIGNMENT + 2]]));
    let near = |angle: S, to: S| {
        let turns = ((to.value() - angle.value()) / std::f64::consts::TAU).round();
        angle + turns * std::f64::consts::TAU
    };
    let across = (turned[0][0] * turned[0][0] + turned[0][1] * turned[0][1]).sqrt();
    let angles = [
        near((-turned[1][2]).atan2(turned[2][2]), then[0]),
        turned[0][2].atan2(across),
        near((-turned[0][1]).atan2(turned[0][0]), then[2]),
    ];
    let t = body(euler);
    let arm: [S; 3] = each!(|k| e[LEVER + k] + -known.p_origin_cm[k]);
    let p = each!(|i| t[i][0] * arm[0] + t[i][1] * arm[1] + t[i][2] * arm[2] + known.p_cm[i]);
    let old = -(e[WIND_DELAY] + -known.taken_s[1]);
    let speed = (v[6] + old * (v[7] + old * v[8] * 0.5)) * (e[WIND_SCALE] + (1.0 + known.wind_scale));
    [p[0], p[1], p[2], angles[0], angles[1], angles[2], speed]
}

fn body<S: Scalar>([rx, ry, rz]: [S; 3]) -> [[S; 3]; 3] {
    let ((sx, cx), (sy, cy), (sz, cz)) = (rx.sin_cos(), ry.sin_cos(), rz.sin_cos());
    matrix(sx, cx, sy, cy, sz, cz)
}

fn product<S: Scalar>(a: &[[S; 3]; 3], b: &[[S; 3]; 3]) -> [[S; 3]; 3] {
    each!(|i| each!(|j| a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j]))
}

/// Eq. 3.20 solved for the Euler rates.
fn euler_rate<S: Scalar>([_, ry, rz]: [S; 3], [p, q, r]: [S; 3]) -> [S; 3] {
    let ((sy, cy), (sz, cz)) = (ry.sin_cos(), rz.sin_cos());
    let rx_rate = (p * cz - q * sz) * cy.recip();
    [rx_rate, p * sz + q * cz, r - sy * rx_rate]
}

/// Variables at a state with tunnel speed and its derivatives.
pub(crate) fn variables(x: &[f64; STATES], speed: [f64; 3], errors: &Errors) -> [f64; VARIABLES] {
    let mut v = [0.0; VARIABLES];
    STATE_OF.iter().enumerate().for_each(|(k, state)| v[k] = x[*state]);
    v[6..9].copy_from_slice(&speed);
    v[9..].copy_from_slice(&errors.values);
    v
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::equations::Dual;
    use windfall_model::CHANNELS;

    const KNOWN: Known = Known {
        p_cm: [0.3, -0.2, 0.1],
        w_rate: [1.0, -8.0, 6.0],
        p_origin_cm: [0.01, 0.0, -0.002],
        wind_scale: 0.01,
        taken_s: [0.02, -0.0133],
    };

    fn at(errors: [f64; ERRORS]) -> [f64; VARIABLES] {
        let mut v = [0.0; VARIABLES];
        v[..9].copy_from_slice(&[13.0, 0.2, -0.3, 0.8, -1.5, 1.1, 7.4, 0.3, -0.5]);
        v[9..].copy_from_slice(&errors);
        v
    }

    /// Nothing wrong: pose and speed as they are.
    #[test]
    fn exact_without_errors() {
        let seen = observe(&at([0.0; ERRORS]), &Known { taken_s: [0.0; 2], p_origin_cm: [0.0; 3], ..KNOWN });
        for (a, b) in seen.into_iter().zip([0.3, -0.2, 0.1, 13.0, 0.2, -0.3, 7.4 * 1.01]) {
            assert!((a - b).abs() < 1e-14, "{a} {b}");
        }
    }

    /// Slopes are those of the values; third derivatives of order 1e3 times h²/6 and rounding 1e-14/h.
    #[test]
    fn exact_slopes_are_those_of_differences() {
        let v = at([0.02, -0.011, 0.0215, 0.01, -0.02, 0.03, 0.01, -0.005, 0.002]);
        let seen = observe(&std::array::from_fn(|k| Dual::<VARIABLES>::variable(v[k], k)), &KNOWN);
        for k in 0..VARIABLES {
            let h = 1e-5;
            let moved = |by: f64| {
                let mut v = v;
                v[k] += by;
                observe(&v, &KNOWN)
            };
            let (up, down) = (moved(h), moved(-h));
            for c in 0..CHANNELS {
                let slope = (up[c] - down[c]) / (2.0 * h);
                assert!((seen[c].slopes[k] - slope).abs() < 1e-7, "{k} {c}: {} {slope}", seen[c].slopes[k]);
            }
        }
    }

    /// A delay is the motion's own past: against forty small steps back along the same rates.
    #[test]
    fn exact_delay_goes_back_along_the_motion() {
        let (late, n) = (0.0033, 40);
        let v = at([0.0; ERRORS]);
        let (mut e, mut w) = ([v[0], v[1], v[2]], [v[3], v[4], v[5]]);
        for _ in 0..n {
            let h = late / f64::from(n);
            let now = euler_rate(e, w);
            let half = euler_rate(each!(|k| e[k] - 0.5 * h * now[k]), each!(|k| w[k] - 0.5 * h * KNOWN.w_rate[k]));
            e = each!(|k| e[k] - h * half[k]);
            w = each!(|k| w[k] - h * KNOWN.w_rate[k]);
        }
        let mut errors = [0.0; ERRORS];
        errors[ANGLE_DELAY] = late;
        let seen = observe(&at(errors), &Known { taken_s: [0.0; 2], ..KNOWN });
        for k in 0..3 {
            // Third order: rates change by 10/s² and more by each other, times late³/24.
            assert!((seen[3 + k] - e[k]).abs() < 1e-6, "{} {}", seen[3 + k], e[k]);
        }
    }
}
