//! pid: instrument effects undone. In: smoothed signals and a plant's sensors. Out: signals as the motion truly was.

use crate::euler::{euler_rates, rates, t_bef};
use crate::smooth::{Signal, Smoothed};
use windfall_model::{CHANNELS, PerChannel, RunChannel, Sensors};

/// Value, first and second derivative of every channel at one sample.
pub(crate) type Sample = PerChannel<[f64; 3]>;

/// Sample i with the clock, delays, scales and misalignment taken out: rates are those by true time.
pub(crate) fn sample(s: &Smoothed, sensors: &Sensors, i: usize) -> Sample {
    // Recorded seconds per true one.
    let ticks = 1.0 + sensors.time_base;
    let mut x: Sample = [[0.0; 3]; CHANNELS];
    for c in RunChannel::ALL {
        let delay = if c == RunChannel::Wind { sensors.wind_delay_s } else { sensors.pose_delay_s };
        x[c.at()] = later(&s.channels[c.at()], s.interval_s, i, delay * ticks);
    }
    if sensors.time_base != 0.0 {
        x = x.map(|[value, rate, second]| [value, rate * ticks, second * ticks * ticks]);
    }
    if sensors.length_scale != 0.0 {
        let longer = 1.0 + sensors.length_scale;
        for axis in &mut x[..3] {
            *axis = axis.map(|v| v / longer);
        }
    }
    if sensors.wind_scale != 0.0 {
        let scale = 1.0 + sensors.wind_scale;
        let wind = &mut x[RunChannel::Wind.at()];
        *wind = wind.map(|v| v / scale);
    }
    if sensors.misalignment_rad.iter().any(|a| *a != 0.0) {
        turn(&mut x, sensors.misalignment_rad);
    }
    x
}

/// Longest time beyond a signal's ends, s, over which it is extrapolated: that of a dropout that is bridged. Then it stays.
const BEYOND_S: f64 = 0.1;

/// The signal `delay` seconds after sample i: quintic Hermite between samples, Taylor a little beyond the ends.
#[inline]
fn later(s: &Signal, dt: f64, i: usize, delay: f64) -> [f64; 3] {
    let node = |i: usize| [s.value[i], s.rate[i], s.second[i]];
    if delay == 0.0 {
        return node(i);
    }
    let last = s.value.len() - 1;
    let x = i as f64 + delay / dt;
    if x <= 0.0 {
        return taylor(node(0), (x * dt).max(-BEYOND_S));
    }
    if x >= last as f64 {
        return taylor(node(last), ((x - last as f64) * dt).min(BEYOND_S));
    }
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "x is in (0, last)")]
    let left = x as usize;
    hermite(node(left), node(left + 1), dt, x - left as f64)
}

fn taylor(n: [f64; 3], t: f64) -> [f64; 3] {
    [n[0] + t * (n[1] + 0.5 * t * n[2]), n[1] + t * n[2], n[2]]
}

/// Quintic through value, rate and second derivative at both ends of an interval h, at the fraction x of it.
fn hermite(a: [f64; 3], b: [f64; 3], h: f64, x: f64) -> [f64; 3] {
    let t = x * h;
    let from_left = taylor(a, t);
    let end = taylor(a, h);
    let (d0, d1, d2) = ((b[0] - end[0]) / h.powi(3), (b[1] - end[1]) / h.powi(2), (b[2] - end[2]) / h);
    // Remainder c3 t³ + c4 t⁴ + c5 t⁵ meets the right end's value, rate and second derivative.
    let c3 = 10.0 * d0 - 4.0 * d1 + 0.5 * d2;
    let c4 = (-15.0 * d0 + 7.0 * d1 - d2) / h;
    let c5 = (6.0 * d0 - 3.0 * d1 + 0.5 * d2) / (h * h);
    [
        from_left[0] + t.powi(3) * (c3 + t * (c4 + t * c5)),
        from_left[1] + t.powi(2) * (3.0 * c3 + t * (4.0 * c4 + t * 5.0 * c5)),
        from_left[2] + t * (6.0 * c3 + t * (12.0 * c4 + t * 20.0 * c5)),
    ]
}

/// True attitude from the reported one: `T_true = T_reported · Mᵀ`, so body rates and their derivatives turn by M.
fn turn(x: &mut Sample, misalignment_rad: [f64; 3]) {
    let m = t_bef(misalignment_rad);
    let euler = [x[3][0], x[4][0], x[5][0]];
    let rate = [x[3][1], x[4][1], x[5][1]];
    let second = [x[3][2], x[4][2], x[5][2]];
    let (pqr, pqr_rate) = rates(euler, rate, second);
    let t = t_bef(euler);
    let mut turned = [[0.0; 3]; 3];
    for (row, from) in turned.iter_mut().zip(&t) {
        for (value, k) in row.iter_mut().zip(&m) {
            *value = from[0] * k[0] + from[1] * k[1] + from[2] * k[2];
        }
    }
    let by_m = |v: [f64; 3]| m.map(|k| k[0] * v[0] + k[1] * v[1] + k[2] * v[2]);
    let near = |angle: f64, to: f64| angle + std::f64::consts::TAU * ((to - angle) / std::f64::consts::TAU).round();
    let true_euler = [
        near((-turned[1][2]).atan2(turned[2][2]), euler[0]),
        turned[0][2].clamp(-1.0, 1.0).asin(),
        near((-turned[0][1]).atan2(turned[0][0]), euler[2]),
    ];
    let (true_rate, true_second) = euler_rates(true_euler, by_m(pqr), by_m(pqr_rate));
    for k in 0..3 {
        x[3 + k] = [true_euler[k], true_rate[k], true_second[k]];
    }
}

#[cfg(test)]
mod tests {
    use super::{Sample, hermite, later, taylor, turn};
    use crate::smooth::Signal;

    /// A quintic with its derivatives.
    fn quintic(t: f64) -> [f64; 3] {
        const C: [f64; 6] = [0.4, -1.3, 2.1, 0.8, -1.7, 0.6];
        let p = |k: i32, d: i32| if k < d { 0.0 } else { t.powi(k - d) };
        let sum = |f: &dyn Fn(i32) -> f64| (0..6).map(|k| C[k as usize] * f(k)).sum::<f64>();
        [sum(&|k| p(k, 0)), sum(&|k| f64::from(k) * p(k, 1)), sum(&|k| f64::from(k * (k - 1)) * p(k, 2))]
    }

    fn assert_close(found: [f64; 3], truth: [f64; 3]) {
        for (a, b) in found.into_iter().zip(truth) {
            // Rounding of numbers of order 10 through divisions by h³ = 0.027 and h² = 0.09.
            assert!((a - b).abs() < 1e-11, "{found:?} {truth:?}");
        }
    }

    #[test]
    fn exact_hermite_reproduces_a_quintic() {
        let h = 0.3;
        for x in [0.0, 0.2, 0.5, 0.9, 1.0] {
            assert_close(hermite(quintic(0.5), quintic(0.5 + h), h, x), quintic(0.5 + x * h));
        }
    }

    #[test]
    fn exact_delay_looks_later_between_samples_and_extrapolates_beyond_both_ends() {
        let t = |i: usize| 0.5 + 0.3 * i as f64;
        let at = |k: usize| (0..4).map(|i| quintic(t(i))[k]).collect();
        let s = Signal { value: at(0), rate: at(1), second: at(2) };
        assert_close(later(&s, 0.3, 1, 0.4), quintic(t(1) + 0.4));
        assert_close(later(&s, 0.3, 2, -0.37), quintic(t(2) - 0.37));
        assert_close(later(&s, 0.3, 2, 0.37), taylor(quintic(t(3)), 0.07));
        assert_close(later(&s, 0.3, 1, -0.38), taylor(quintic(t(0)), -0.08));
        // Seconds beyond the end a parabola would be anywhere.
        assert_close(later(&s, 0.3, 2, 9.3), taylor(quintic(t(3)), 0.1));
    }

    #[test]
    fn law_turning_keeps_the_turn_count_of_roll_and_yaw() {
        let euler = [13.1, 0.2, -0.3];
        let mut x: Sample = [[0.0; 3]; 7];
        for k in 0..3 {
            x[3 + k][0] = euler[k];
        }
        turn(&mut x, [1e-3, 0.0, 0.0]);
        // A small turn moves the angles by about as much: no jump by 2π.
        for k in 0..3 {
            assert!((x[3 + k][0] - euler[k]).abs() < 2e-3, "{} {}", x[3 + k][0], euler[k]);
        }
    }
}
