//! sim: the instruments. In: truth. Out: the record, as motion capture and tunnel write it.
//!
//! Order of operations at a sample of time t:
//! 1. pose: true c.m. position and attitude at t − pose delay; between samples by cubic Hermite interpolation of position and
//!    quaternion with their true rates, before the first (after the last) sample by a Taylor step of second order from it;
//! 2. position of the geometric origin `p_cm − R r_cm`, with the true attitude of that instant;
//! 3. attitude `R · Rx·Ry·Rz(misalignment)` as angles, roll unwrapped;
//! 4. that position times 1 + length scale; times of all samples times 1 + time base;
//! 5. tunnel speed at t − wind delay (held before the first sample), times 1 + wind scale;
//! 6. drift of the seven channels, each from its own stream;
//! 7. noise on the seven channels, each from its own stream, when the flight asks for it;
//! 8. dynamic pressure ½ρV_W² of the recorded tunnel speed; static pressure and temperature as they are.

use crate::noise::realise;
use crate::seed::{Channel, Seed};
use crate::smooth::{Smooth, hermite};
use crate::truth::{Truth, angles};
use windfall_model::frames::{Body, EulerXyz, Rotation, Tunnel, Vec3};
use windfall_model::{Entry, Flight, POSE, Plant, Record, dynamic_pressure_pa};

/// What the instruments of `plant` make of a true flight.
#[must_use]
pub fn record(plant: &Plant, flight: &Flight, truth: &Truth, seed: Seed) -> Record {
    recorded(plant, flight, truth, seed, false)
}

/// As [`record`]. Where nothing delays or turns the attitude and `by_truth` says so, its angles are the truth's, which differ by rounding.
pub(crate) fn recorded(plant: &Plant, flight: &Flight, truth: &Truth, seed: Seed, by_truth: bool) -> Record {
    let n = truth.len();
    let s = &plant.sensors;
    let [rx_rad, ry_rad, rz_rad] = s.misalignment_rad;
    let misalignment: Rotation<Body, Body> = Rotation::from_matrix(EulerXyz { rx_rad, ry_rad, rz_rad }.r_tunnel_body().matrix);
    let mut position_m: [Vec<f64>; 3] = std::array::from_fn(|_| Vec::with_capacity(n));
    let mut attitude_rad: [Vec<f64>; 3] = std::array::from_fn(|_| Vec::with_capacity(n));
    let by_truth = by_truth && s.pose_delay_s == 0.0 && s.misalignment_rad.iter().all(|a| *a == 0.0);
    let mut roll = 0.0;
    for k in 0..n {
        let (p_cm, r_tunnel_body) = pose(truth, k, s.pose_delay_s, flight.rate_hz);
        let p_origin = p_cm - r_tunnel_body * plant.vehicle.p_origin_cm;
        let e = if by_truth { truth.attitude_rad[k] } else { angles(r_tunnel_body * misalignment, roll) };
        roll = e[0];
        for axis in 0..3 {
            position_m[axis].push(p_origin.xyz[axis] * (1.0 + s.length_scale));
            attitude_rad[axis].push(e[axis]);
        }
    }
    let mut vw_m_s = wind(truth, s.wind_delay_s, s.wind_scale, flight.rate_hz);
    for d in plant.drift.disturbances() {
        let (series, place) = match d.entry {
            Entry::RecordedPose(place @ 0..3) => (&mut position_m[place], place),
            Entry::RecordedPose(place) => (&mut attitude_rad[place - 3], place),
            _ => (&mut vw_m_s, POSE),
        };
        let channel = Channel::Drift(u8::try_from(place).expect("channels are below 7"));
        let wander = realise(&d, 1.0 / flight.rate_hz, n, seed.normals(channel));
        series.iter_mut().zip(wander).for_each(|(value, by)| *value += by);
    }
    if flight.sensor_noise {
        let [x, y, z] = &mut position_m;
        let [rx, ry, rz] = &mut attitude_rad;
        let (p, a) = (s.position_std_m, s.pitch_yaw_std_rad);
        let channels = [(x, p), (y, p), (z, p), (rx, s.roll_std_rad), (ry, a), (rz, a), (&mut vw_m_s, s.wind_std_m_s)];
        for (c, (series, std)) in (0_u8..).zip(channels) {
            for (value, noise) in series.iter_mut().zip(seed.normals(Channel::Sensor(c))) {
                *value += std * noise;
            }
        }
    }
    let density = plant.environment.density_kg_m3(flight.ps_pa, flight.ts_k);
    Record {
        t_s: truth.t_s.iter().map(|t| t * (1.0 + s.time_base)).collect(),
        position_m,
        attitude_rad,
        qw_pa: Some(vw_m_s.iter().map(|v| dynamic_pressure_pa(density, *v)).collect()),
        vw_m_s,
        ps_pa: vec![flight.ps_pa; n],
        ts_k: vec![flight.ts_k; n],
        ..Record::default()
    }
}

type Pose = (Vec3<Tunnel>, Rotation<Tunnel, Body>);

/// True pose a delay before sample `k`.
fn pose(truth: &Truth, k: usize, delay_s: f64, rate_hz: f64) -> Pose {
    if delay_s == 0.0 {
        return (Vec3::from_array(truth.p_tunnel_cm[k]), Rotation::from_quaternion(truth.quaternion[k]));
    }
    let last = truth.len() - 1;
    let x = k as f64 - delay_s * rate_hz;
    if x < 0.0 || last == 0 {
        return taylor(truth, 0, x / rate_hz, rate_hz);
    }
    if x > last as f64 {
        return taylor(truth, last, (x - last as f64) / rate_hz, rate_hz);
    }
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 ≤ x ≤ last sample")]
    let i = (x as usize).min(last - 1);
    between(truth, i, x - i as f64, 1.0 / rate_hz)
}

fn between(truth: &Truth, i: usize, x: f64, dt: f64) -> Pose {
    let (p, v, q) = (&truth.p_tunnel_cm, &truth.v_tunnel_cm, &truth.quaternion);
    let rates = [i, i + 1].map(|j| turning(q[j], truth.w_tunnel_body[j]));
    let place = std::array::from_fn(|c| hermite(x, dt, [p[i][c], p[i + 1][c]], [v[i][c], v[i + 1][c]]));
    let attitude = std::array::from_fn(|c| hermite(x, dt, [q[i][c], q[i + 1][c]], [rates[0][c], rates[1][c]]));
    (Vec3::from_array(place), Rotation::from_quaternion(attitude))
}

/// Pose `t_s` after sample `i`, to second order: accelerations by differences of the rates over three samples.
fn taylor(truth: &Truth, i: usize, t_s: f64, rate_hz: f64) -> Pose {
    let inward = |series: &[[f64; 3]], c: usize| {
        let n = series.len();
        if n < 3 {
            return 0.0;
        }
        let (a, b, sign) = if i == 0 { (1, 2, 1.0) } else { (n - 2, n - 3, -1.0) };
        sign * 0.5 * rate_hz * (4.0 * series[a][c] - 3.0 * series[i][c] - series[b][c])
    };
    let (p, v, w) = (truth.p_tunnel_cm[i], truth.v_tunnel_cm[i], truth.w_tunnel_body[i]);
    let place = std::array::from_fn(|c| p[c] + t_s * (v[c] + 0.5 * t_s * inward(&truth.v_tunnel_cm, c)));
    let turned: [f64; 3] = std::array::from_fn(|c| t_s * (w[c] + 0.5 * t_s * inward(&truth.w_tunnel_body, c)));
    let from: Rotation<Tunnel, Body> = Rotation::from_quaternion(truth.quaternion[i]);
    let turn: Rotation<Body, Body> = Rotation::from_quaternion(rotation_vector(turned));
    (Vec3::from_array(place), from * turn)
}

fn rotation_vector(v: [f64; 3]) -> [f64; 4] {
    let angle = Vec3::<Body>::from_array(v).norm();
    let s = if angle > 1e-8 { (0.5 * angle).sin() / angle } else { 0.5 };
    [(0.5 * angle).cos(), s * v[0], s * v[1], s * v[2]]
}

/// Rate of a quaternion at body rates.
fn turning(q: [f64; 4], w: [f64; 3]) -> [f64; 4] {
    crate::dynamics::quaternion_rate(q, w)
}

fn wind(truth: &Truth, delay_s: f64, scale: f64, rate_hz: f64) -> Vec<f64> {
    let gain = 1.0 + scale;
    if delay_s == 0.0 {
        return truth.vw_m_s.iter().map(|v| v * gain).collect();
    }
    let smooth = Smooth::new(1.0 / rate_hz, &truth.vw_m_s);
    truth.t_s.iter().map(|t| gain * smooth.at(t - delay_s).0).collect()
}
