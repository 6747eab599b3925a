//! sim tests: the instruments. In: a known truth. Out: whether the record is what they make of it.

use crate::common::*;
use windfall_model::frames::{EulerXyz, Vec3};
use windfall_model::{Drift, Flight, Integrator, Numerics, Plant, Record, Release, RunScatter, Sensors, TunnelSpeed};
use windfall_sim::{Channel, Seed, fly};

/// Table A.3 of the thesis.
pub(crate) fn sensors() -> Sensors {
    Sensors {
        position_std_m: 7.5e-4,
        roll_std_rad: 0.0623_f64.to_radians(),
        pitch_yaw_std_rad: 0.11_f64.to_radians(),
        wind_std_m_s: 2.57e-3,
        ..Sensors::default()
    }
}

/// A perturbed flight with a tunnel speed that moves.
fn order() -> Flight {
    let release =
        Release { attitude_rad: [0.1, 0.3, -0.2], rates_rad_s: [0.5, 0.4, -0.3], velocity_m_s: [0.1, 0.2, 0.3], ..REST };
    let mut order = flight(4.0, 150.0, 0.0, release);
    order.speed =
        TunnelSpeed::History { interval_s: 0.02, vw_m_s: (0..=250).map(|k| 7.4 + 0.2 * (0.04 * f64::from(k)).sin()).collect() };
    order.numerics = Numerics { method: Integrator::Dop853, relative_tolerance: 1e-11, absolute_tolerance: 1e-13 };
    order
}

fn recorded(plant: &Plant) -> Record {
    fly(plant, &order(), Seed::default()).expect("flies").record
}

/// Differences of one channel, shifted by whole samples.
fn shifted(a: &[f64], b: &[f64], by: usize) -> f64 {
    worst(&a[by..], &b[..b.len() - by])
}

/// Position is the origin's, `p_cm − R r_cm`; q is ½ρV² of the recorded speed; the rest is as flown.
#[test]
fn exact_record_of_the_origin() {
    let mut plant = lander();
    let offset = Vec3::new(0.02, -0.01, 0.03);
    plant.vehicle.p_origin_cm = offset;
    let flown = fly(&plant, &order(), Seed::default()).expect("flies");
    let (truth, record) = (&flown.truth, &flown.record);
    for k in (0..truth.len()).step_by(50) {
        let [rx_rad, ry_rad, rz_rad] = truth.attitude_rad[k];
        let out = EulerXyz { rx_rad, ry_rad, rz_rad }.r_tunnel_body() * offset;
        for axis in 0..3 {
            let expected = truth.p_tunnel_cm[k][axis] - out.to_array()[axis];
            assert!((record.position_m[axis][k] - expected).abs() < 1e-14);
            assert!((record.attitude_rad[axis][k] - truth.attitude_rad[k][axis]).abs() < 1e-14);
        }
        let q = record.qw_pa.as_ref().expect("recorded")[k];
        assert!((q - 0.5 * DENSITY * record.vw_m_s[k].powi(2)).abs() < 1e-12);
    }
    assert!(worst(&record.vw_m_s, &truth.vw_m_s) < 1e-15 && worst(&record.t_s, &truth.t_s) < 1e-15);
    assert!(record.ps_pa.iter().all(|p| (p - PS_PA).abs() < 1e-9) && record.ts_k.len() == truth.len());
}

/// A delay of three samples shifts pose by three samples and leaves V_W alone; half a sample more is the flight in between.
#[test]
fn exact_pose_delay() {
    let clean = recorded(&lander());
    let mut plant = lander();
    plant.sensors.pose_delay_s = 3.0 / 150.0;
    let late = recorded(&plant);
    for c in 0..6 {
        assert!(shifted(late.channels()[c], clean.channels()[c], 3) < 1e-12, "channel {c}");
    }
    assert!(worst(&late.vw_m_s, &clean.vw_m_s) < 1e-15);
    plant.sensors.pose_delay_s = 3.5 / 150.0;
    let between = recorded(&plant);
    let mut fine = order();
    fine.rate_hz = 300.0;
    let fine = fly(&lander(), &fine, Seed::default()).expect("flies").record;
    for c in 0..6 {
        for k in (4..600).step_by(7) {
            // Cubic Hermite: h⁴/384 of a fourth derivative below 1e4.
            assert!((between.channels()[c][k] - fine.channels()[c][2 * k - 7]).abs() < 5e-8, "channel {c} sample {k}");
        }
    }
}

/// Before release the pose is continued to second order: a delay of a few samples is off by its third power.
#[test]
fn order_three_of_the_pose_before_release() {
    let mut back = order();
    let start = fly(&lander(), &back, Seed::default()).expect("flies").truth;
    // The same flight, released six samples later: its true past is known.
    let at = 6;
    back.release = Release {
        position_m: start.p_tunnel_cm[at],
        velocity_m_s: start.v_tunnel_cm[at],
        attitude_rad: start.attitude_rad[at],
        rates_rad_s: start.w_tunnel_body[at],
    };
    if let TunnelSpeed::History { interval_s, vw_m_s } = &mut back.speed {
        *vw_m_s = (0..=250).map(|k| 7.4 + 0.2 * (2.0 * (f64::from(k) * *interval_s + 0.04)).sin()).collect();
    }
    let error = |samples: usize| {
        let mut plant = lander();
        plant.sensors.pose_delay_s = samples as f64 / 150.0;
        let record = fly(&plant, &back, Seed::default()).expect("flies").record;
        let place = worst(&record.position_m.each_ref().map(|x| x[0]), &start.p_tunnel_cm[at - samples]);
        let turn = worst(&record.attitude_rad.each_ref().map(|x| x[0]), &start.attitude_rad[at - samples]);
        [place, turn]
    };
    let (near, far) = (error(3), error(6));
    for (n, f) in near.iter().zip(far) {
        let order = (f / n).log2();
        assert!((order - 3.0).abs() < 0.5, "{order}: {near:?} {far:?}");
    }
}

/// A clock that runs ahead (negative delay): beyond the last sample the pose is continued to second order as well.
#[test]
fn order_three_of_the_pose_after_the_end() {
    let mut longer = order();
    longer.duration_s += 6.0 / 150.0;
    let future = fly(&lander(), &longer, Seed::default()).expect("flies").record;
    let error = |samples: usize| {
        let mut plant = lander();
        plant.sensors.pose_delay_s = -(samples as f64) / 150.0;
        let record = recorded(&plant);
        let last = record.len() - 1;
        for c in 0..6 {
            let within = last - samples;
            assert!((record.channels()[c][within] - future.channels()[c][last]).abs() < 1e-9, "channel {c}");
        }
        let far = |c: usize| (record.channels()[c][last] - future.channels()[c][last + samples]).abs();
        [far(0).max(far(1)).max(far(2)), far(3).max(far(4)).max(far(5))]
    };
    let (near, far) = (error(3), error(6));
    for (n, f) in near.iter().zip(far) {
        let order = (f / n).log2();
        assert!((order - 3.0).abs() < 0.6, "{order}: {near:?} {far:?}");
    }
}

#[test]
fn exact_wind_scale_and_delay() {
    let clean = recorded(&lander());
    let mut plant = lander();
    plant.sensors.wind_scale = 0.05;
    plant.sensors.wind_delay_s = 0.1;
    let late = recorded(&plant);
    let expected: Vec<f64> = clean.vw_m_s.iter().map(|v| 1.05 * v).collect();
    assert!(shifted(&late.vw_m_s, &expected, 15) < 1e-12);
    assert!(late.vw_m_s[..15].iter().all(|v| (v - expected[0]).abs() < 1e-12), "held before the first sample");
    for c in 0..6 {
        assert!(worst(late.channels()[c], clean.channels()[c]) < 1e-15);
    }
    plant.sensors.wind_delay_s = 0.0;
    assert!(worst(&recorded(&plant).vw_m_s, &expected) < 1e-14);
}

/// Positions are longer and times later by their factors, noise is not; nothing else changes.
#[test]
fn exact_length_scale_and_time_base() {
    let mut plant = lander();
    plant.vehicle.p_origin_cm = Vec3::new(0.02, -0.01, 0.03);
    let clean = recorded(&plant);
    let mut noisy = order();
    noisy.sensor_noise = true;
    plant.sensors.position_std_m = 7.5e-4;
    let with_noise = |plant: &Plant| fly(plant, &noisy, Seed::default()).expect("flies").record;
    let before = with_noise(&plant);
    (plant.sensors.length_scale, plant.sensors.time_base) = (0.02, -0.01);
    let (long, after) = (recorded(&plant), with_noise(&plant));
    for axis in 0..3 {
        let expected: Vec<f64> = clean.position_m[axis].iter().map(|x| 1.02 * x).collect();
        assert!(worst(&long.position_m[axis], &expected) < 1e-15);
        let noise =
            |noisy: &Record, clean: &[f64]| noisy.position_m[axis].iter().zip(clean).map(|(a, b)| a - b).collect::<Vec<_>>();
        assert!(worst(&noise(&after, &expected), &noise(&before, &clean.position_m[axis])) < 1e-15);
    }
    for c in 3..7 {
        assert!(worst(long.channels()[c], clean.channels()[c]) < 1e-15);
    }
    let times: Vec<f64> = clean.t_s.iter().map(|t| 0.99 * t).collect();
    assert!(worst(&long.t_s, &times) < 1e-15);
}

/// Recorded attitude is true attitude times Rx·Ry·Rz of the misalignment; the tracked origin stays where it is.
#[test]
fn exact_misalignment() {
    let mut plant = lander();
    plant.vehicle.p_origin_cm = Vec3::new(0.0, 0.01, 0.02);
    let clean = recorded(&plant);
    plant.sensors.misalignment_rad = [0.03, -0.05, 0.02];
    let turned = recorded(&plant);
    let rotation = |r: &Record, k: usize| {
        let [rx_rad, ry_rad, rz_rad] = r.attitude_rad.each_ref().map(|a| a[k]);
        EulerXyz { rx_rad, ry_rad, rz_rad }.r_tunnel_body().matrix
    };
    let by = EulerXyz { rx_rad: 0.03, ry_rad: -0.05, rz_rad: 0.02 }.r_tunnel_body().matrix;
    for k in (0..600).step_by(40) {
        assert!((rotation(&turned, k) - rotation(&clean, k) * by).amax() < 1e-13);
    }
    for c in 0..3 {
        assert!(worst(turned.channels()[c], clean.channels()[c]) < 1e-15);
    }
}

/// Roll goes on past half a turn.
#[test]
fn law_roll_is_unwrapped() {
    let order = flight(20.0, 50.0, 7.43, Release { rates_rad_s: [3.0, 0.0, 0.0], ..REST });
    let flown = fly(&lander(), &order, Seed::default()).expect("flies");
    for roll in [&flown.record.attitude_rad[0], &flown.truth.attitude_rad.iter().map(|a| a[0]).collect()] {
        assert!(roll.windows(2).all(|w| (w[1] - w[0]).abs() < 0.1));
        assert!(roll[roll.len() - 1] > 6.0);
    }
}

/// Drift adds a process of 30 s to the channels that drift, and leaves the flight alone: its steps from sample to sample have the variance
/// σ² 2 h/T of a random walk (600 steps: 3 % a sigma of their size; bound 15 %).
#[test]
fn law_drift_is_in_the_record_alone() {
    let mut plant = lander();
    let clean = recorded(&plant);
    let step = |rms: f64| rms * (2.0 / 150.0 / windfall_model::DRIFT_TIME_S).sqrt();
    let wander = |record: &Record, c: usize| -> Vec<f64> {
        record.channels()[c].iter().zip(clean.channels()[c]).map(|(a, b)| a - b).collect()
    };
    for (drift, drifting, rms) in [
        (Drift { position_rms_m: [0.02; 3], ..Drift::default() }, 0..3, 0.02),
        (Drift { attitude_rms_rad: [0.03; 3], ..Drift::default() }, 3..6, 0.03),
        (Drift { speed_rms_m_s: 0.04, ..Drift::default() }, 6..7, 0.04),
    ] {
        plant.drift = drift;
        let record = recorded(&plant);
        for c in 0..7 {
            let wander = wander(&record, c);
            if drifting.contains(&c) {
                let square = wander.windows(2).map(|w| (w[1] - w[0]).powi(2)).sum::<f64>() / (wander.len() - 1) as f64;
                assert!((square.sqrt() / step(rms) - 1.0).abs() < 0.15, "{c}: {} {}", square.sqrt(), step(rms));
            } else {
                assert!(wander.iter().all(|x| *x == 0.0), "{c}");
            }
        }
    }
    plant.drift = Drift { position_rms_m: [0.02; 3], ..Drift::default() };
    let both = recorded(&plant);
    assert!(wander(&both, 0).iter().zip(wander(&both, 1)).any(|(a, b)| (a - b).abs() > 1e-4));
}

/// A run of a plant whose mass differs from run to run is one of the plant with the mass that was drawn, and another run has another.
#[test]
fn exact_runs_of_another_mass() {
    let mut plant = lander();
    plant.scatter = RunScatter { mass: 0.04, ..RunScatter::default() };
    let one = |run: u64| {
        let seed = Seed { campaign: 3, run };
        let flown = fly(&plant, &order(), seed).expect("flies").record;
        let drawn = 0.04 * seed.normals(Channel::Number(0)).next().expect("without end");
        let mut own = lander();
        own.vehicle.mass_kg *= 1.0 + drawn;
        assert!(flown == fly(&own, &order(), seed).expect("flies").record);
        drawn
    };
    let (first, second) = (one(0), one(1));
    assert!((first - second).abs() > 1e-6, "{first} {second}");
}
