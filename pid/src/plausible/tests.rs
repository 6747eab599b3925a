//! pid tests: motion as the model's own forces make it, for all that judges balances; ranks and digits.

use super::motion::{DELAYS, MotionSample};
use super::*;
use crate::equations::tests::plant;
use crate::euler::euler_rates;
use nalgebra::Vector3;
use windfall_model::frames::{EulerXyz, Vec3};
use windfall_model::{AirState, Knowledge, Motion, Plant, Run, Use};

/// Number `k` of instant `i`, in (−1, 1) and without a pattern: multiples of roots of primes (Kronecker).
pub(super) fn spread(i: usize, k: usize) -> f64 {
    let prime = [2.0_f64, 3.0, 5.0, 7.0, 11.0, 13.0, 17.0, 19.0, 23.0, 29.0, 31.0, 37.0, 41.0, 43.0, 47.0][k];
    2.0 * ((i as f64 + 0.7) * prime.sqrt()).fract() - 1.0
}

/// Instants of motions that have nothing to do with each other, whose accelerations are those that the forces of the model make.
pub(super) fn instants(plant: &Plant, count: usize, span_s: f64) -> Vec<MotionSample> {
    (0..count).map(|i| instant(plant, i, span_s)).collect()
}

fn instant(plant: &Plant, i: usize, span_s: f64) -> MotionSample {
    let of = |first: usize, size: f64| Vector3::from_fn(|k, _| size * spread(i, first + k));
    let (p_cm, v_cm, w) = (of(0, 0.3), of(3, 0.5), of(6, 1.2));
    let euler = [3.0 * spread(i, 9), 0.25 * spread(i, 10), 0.25 * spread(i, 11)];
    let (vw, vw_rate, ps_pa, ts_k) = (7.4 + 0.2 * spread(i, 12), 0.3 * spread(i, 13), 1.01e5 + 2e3 * spread(i, 14), 295.0);
    let r = EulerXyz { rx_rad: euler[0], ry_rad: euler[1], rz_rad: euler[2] }.r_tunnel_body();
    let motion = |a: Vector3<f64>| Motion {
        t_s: i as f64 * span_s,
        p_tunnel_cm: p_cm.into(),
        v_tunnel_cm: v_cm.into(),
        r_tunnel_body: r,
        w_tunnel_body: w.into(),
        a_tunnel_cm: a.into(),
        w_tunnel_body_rate: Vec3::zero(),
    };
    let density_kg_m3 = plant.environment.density_kg_m3(ps_pa, ts_k);
    let air = AirState { vw_m_s: vw, vw_rate_m_s2: vw_rate, density_kg_m3, ..AirState::default() };
    let v = &plant.vehicle;
    // Forces do not depend on accelerations here, moments on those of the c.m. alone.
    let force = plant.wrench(&motion(Vector3::zeros()), &air).f.xyz;
    let a_cm = r.matrix * force / v.mass_kg + Vector3::x() * plant.environment.gravity_m_s2;
    let moment = plant.wrench(&motion(a_cm), &air).m.xyz;
    let inertia = v.inertia.matrix();
    let w_rate = inertia.try_inverse().expect("a body") * (moment - w.cross(&(inertia * w)));
    let arm = v.p_origin_cm.xyz;
    let origin = [
        p_cm - r.matrix * arm,
        v_cm - r.matrix * w.cross(&arm),
        a_cm - r.matrix * (w_rate.cross(&arm) + w.cross(&w.cross(&arm))),
    ];
    let (rates, seconds) = euler_rates(euler, w.into(), w_rate.into());
    let place = |k: usize| origin.map(|x| x[k]);
    let angle = |k: usize| [euler[k], rates[k], seconds[k]];
    let wind = [vw, vw_rate, 0.0];
    MotionSample {
        t_s: i as f64 * span_s,
        span_s,
        motion: [place(0), place(1), place(2), angle(0), angle(1), angle(2), wind],
        later: [wind; DELAYS],
        ps_pa,
        ts_k,
    }
}

/// A campaign of tunnel runs in which all parameters are declared.
pub(super) fn campaign(plant: Plant, runs: Vec<Record>) -> Campaign {
    let run = |(i, record)| Run {
        name: format!("run-{i}"),
        kind: "perturbed".to_owned(),
        used: Use::Identify,
        inputs: Vec::new(),
        data: Data::Tunnel(record),
        notes: Vec::new(),
    };
    Campaign {
        name: "made".to_owned(),
        declared: vec![true; plant.aero.values.len()],
        plant,
        inputs: Vec::new(),
        runs: runs.into_iter().enumerate().map(run).collect(),
        knowledge: Knowledge::default(),
    }
}

/// Samples at an interval, with the pose by sample.
pub(super) fn record(count: usize, interval_s: f64, pose: impl Fn(usize) -> [f64; 6]) -> Record {
    let column = |k: usize| (0..count).map(|i| pose(i)[k]).collect::<Vec<_>>();
    Record {
        t_s: (0..count).map(|i| i as f64 * interval_s).collect(),
        position_m: [column(0), column(1), column(2)],
        attitude_rad: [column(3), column(4), column(5)],
        vw_m_s: vec![7.4; count],
        ps_pa: vec![1.01e5; count],
        ts_k: vec![295.0; count],
        ..Record::default()
    }
}

/// Ranks among 1 to 5, of which one more is no number; of no numbers, zero.
#[test]
fn exact_ranks() {
    for (share, expected) in [(0.0, 1.0), (0.25, 2.0), (0.5, 3.0), (0.6, 3.0), (0.9, 5.0), (1.0, 5.0)] {
        let found = quantile(vec![5.0, f64::NAN, 1.0, 4.0, 2.0, 3.0], share);
        assert!((found - expected).abs() < 1e-15, "{share} {found}");
    }
    assert!(median(&[f64::NAN]).abs() < 1e-15);
}

/// Three digits, of any size, without zeros behind.
#[test]
fn exact_three_digits() {
    let found = [0.001_234_5, -0.25, 1.0, 5.078, 41.26, 1234.7, 0.0].map(short);
    assert_eq!(found, ["0.00123", "-0.25", "1", "5.08", "41.3", "1235", "0"]);
}

/// What has no runs has no fault.
#[test]
fn law_no_fault_without_runs() {
    assert!(plausible(&campaign(plant(), Vec::new())).is_ok());
}
