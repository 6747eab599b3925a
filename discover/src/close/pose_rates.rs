//! discover: rates, speed and incidence of a body whose pose was recorded, for the page. In: poses at times. Out: series per channel.

use super::slope::slope;
use windfall_model::frames::{Body, Rotation, Tunnel, Vec3};

/// Half of the span over which a turn is taken, s, and fewest samples on either side.
const HALF_S: f64 = 0.05;
const FEWEST: usize = 2;

/// Channels after those of the pose.
pub(super) const RATES: [(&str, &str); 6] =
    [("p", "deg/s"), ("q", "deg/s"), ("r", "deg/s"), ("speed", "m/s"), ("α", "deg"), ("β", "deg")];

/// Body rates from the turn between neighbouring poses, and the velocity of the tracked point through air at rest along the body's axes:
/// α = atan2(w, u), β = asin(v/V). Measured and simulated poses go through the same.
pub(super) fn rates(t_s: &[f64], position_m: &[[f64; 3]], attitude: &[Rotation<Tunnel, Body>]) -> [Vec<f64>; 6] {
    let n = t_s.len().min(position_m.len()).min(attitude.len());
    let of = |k: usize| slope(&t_s[..n], &position_m[..n].iter().map(|p| p[k]).collect::<Vec<f64>>());
    let velocity = [of(0), of(1), of(2)];
    let mut all: [Vec<f64>; 6] = Default::default();
    for i in 0..n {
        let w = turn(&t_s[..n], attitude, i);
        let v = attitude[i].inverse() * Vec3::<Tunnel>::from_array([0, 1, 2].map(|k| velocity[k][i]));
        let speed = v.norm();
        let angles = [v.z().atan2(v.x()), (v.y() / speed.max(1e-12)).clamp(-1.0, 1.0).asin()];
        let degrees = f64::to_degrees;
        let values = [degrees(w[0]), degrees(w[1]), degrees(w[2]), speed, degrees(angles[0]), degrees(angles[1])];
        all.iter_mut().zip(values).for_each(|(s, x)| s.push(x));
    }
    all
}

/// Rotation vector, body axes, from the pose before to the pose after an instant, over the time between.
fn turn(t_s: &[f64], attitude: &[Rotation<Tunnel, Body>], i: usize) -> [f64; 3] {
    let n = t_s.len();
    let mut from = i.saturating_sub(FEWEST);
    let mut to = (i + FEWEST).min(n - 1);
    while from > 0 && t_s[i] - t_s[from - 1] <= HALF_S {
        from -= 1;
    }
    while to + 1 < n && t_s[to + 1] - t_s[i] <= HALF_S {
        to += 1;
    }
    let span = t_s[to] - t_s[from];
    if span <= 0.0 {
        return [f64::NAN; 3];
    }
    let m = (attitude[from].inverse() * attitude[to]).matrix;
    let skew = [0.5 * (m[(2, 1)] - m[(1, 2)]), 0.5 * (m[(0, 2)] - m[(2, 0)]), 0.5 * (m[(1, 0)] - m[(0, 1)])];
    let sine = skew.iter().map(|x| x * x).sum::<f64>().sqrt();
    let angle = sine.atan2(0.5 * (m.trace() - 1.0));
    let factor = if sine > 1e-9 { angle / sine } else { 1.0 };
    skew.map(|x| x * factor / span)
}

#[cfg(test)]
mod tests {
    use super::*;
    use windfall_model::frames::EulerXyz;

    /// A body that turns about its x axis by 40 deg/s and flies along a line that its x axis meets at 10°: rates, speed and incidence are
    /// those at every instant.
    #[test]
    fn exact_rates_and_incidence() {
        let t: Vec<f64> = (0..50).map(|i| 0.02 * f64::from(i)).collect();
        let roll = |t: &f64| EulerXyz { rx_rad: (40.0 * t).to_radians(), ry_rad: 0.0, rz_rad: 0.0 }.r_tunnel_body();
        let attitude: Vec<_> = t.iter().map(roll).collect();
        let (s, c) = 10.0_f64.to_radians().sin_cos();
        let position: Vec<[f64; 3]> = t.iter().map(|t| [3.0 * c * t, 0.0, 3.0 * s * t]).collect();
        let all = rates(&t, &position, &attitude);
        let [p, q, r, speed, alpha, beta] = &all;
        assert!(p.iter().all(|p| (p - 40.0).abs() < 1e-6) && q.iter().chain(r).all(|w| w.abs() < 1e-6));
        assert!(speed.iter().all(|v| (v - 3.0).abs() < 1e-9));
        for (a, b) in alpha.iter().zip(beta) {
            let total = (a.to_radians().cos() * b.to_radians().cos()).acos().to_degrees();
            assert!((total - 10.0).abs() < 1e-6, "{total}");
        }
        assert!((all[4][0] - 10.0).abs() < 1e-9 && all[5][0].abs() < 1e-9, "from below at first");
    }

    /// A turn about one slanting axis of the body by an angle that grows with the cube of time: over the times that are no further
    /// than a twentieth of a second, two on either side at least, of samples that are dense at first and sparse then.
    #[test]
    fn exact_turn_about_a_slanting_axis() {
        let axis = [2.0 / 7.0, -3.0 / 7.0, 6.0 / 7.0];
        let angle = |t: f64| 0.4 * t + 1.1 * t * t * t;
        let t: Vec<f64> = (0..40).map(|i| if i < 25 { 0.012 * f64::from(i) } else { 0.288 + 0.08 * f64::from(i - 24) }).collect();
        let turned = |t: &f64| {
            Rotation::<Tunnel, Body>::from_matrix(
                nalgebra::Rotation3::from_scaled_axis(nalgebra::Vector3::from(axis) * angle(*t)).into_inner(),
            )
        };
        let attitude: Vec<_> = t.iter().map(turned).collect();
        let all = rates(&t, &vec![[0.0; 3]; t.len()], &attitude);
        for i in 0..t.len() {
            let near = |j: &usize| (t[*j] - t[i]).abs() < 0.05 || j.abs_diff(i) <= 2;
            let window: Vec<f64> = (0..t.len()).filter(near).map(|j| t[j]).collect();
            let (from, to) = (window[0], window[window.len() - 1]);
            let rate = ((angle(to) - angle(from)) / (to - from)).to_degrees();
            // Rounding of a rotation matrix over a tenth of a second.
            assert!(
                (0..3).all(|k| (all[k][i] - rate * axis[k]).abs() < 1e-10),
                "{i}: {:?} {rate}",
                [all[0][i], all[1][i], all[2][i]]
            );
        }
    }
}
