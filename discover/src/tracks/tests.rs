//! discover tests: bodies, records and series that the tests of tracks share.

use nalgebra::{DMatrix, DVector};
use windfall_model::frames::Vec3;
use windfall_model::{
    Aero, Campaign, Data, Environment, FreeFlight, Inertia, Knowledge, MeanFlow, Measured, Plant, PointMass, PointRecord, Run,
    Sensors, Structure, Turbulence, Use, Vehicle, WakeShedding,
};

pub(super) const GRAVITY_M_S2: f64 = 9.7;

/// A ball with this drag coefficient.
pub(crate) fn ball(cd: f64) -> Plant {
    Plant {
        vehicle: Vehicle {
            mass_kg: 0.2,
            inertia: Inertia { xx: 0.02, yy: 0.03, zz: 0.04, ..Inertia::default() },
            p_origin_cm: Vec3::zero(),
            diameter_m: 0.12,
            apparent: Default::default(),
            loose: None,
        },
        aero: Aero::new(Structure::point_mass(), vec![cd]),
        tether: None,
        flow: MeanFlow::default(),
        turbulence: Turbulence::default(),
        shedding: WakeShedding::default(),
        drift: Default::default(),
        scatter: Default::default(),
        contacts: Vec::new(),
        environment: Environment { gravity_m_s2: GRAVITY_M_S2, gas_constant_j_kg_k: 287.0 },
        sensors: Sensors {
            position_std_m: 0.5,
            specific_force_std_m_s2: 0.2,
            roll_std_rad: 0.03,
            pitch_yaw_std_rad: 0.07,
            ..Sensors::default()
        },
        point: PointMass { air_density_kg_m3: 1.3, ..PointMass::default() },
        free_flight: None,
    }
}

/// The same as a rigid body in a vacuum.
pub(super) fn brick() -> Plant {
    let mut plant = ball(0.0);
    plant.point.air_density_kg_m3 = 0.0;
    plant.free_flight = Some(FreeFlight { area_m2: 0.01, ..FreeFlight::default() });
    plant
}

/// Depth, speed and acceleration of a ball with drag at a time after it was thrown down:
/// `v = V tanh(g t/V + φ)`, `x = V²/g ln(cosh(g t/V + φ)/cosh φ)` with `V² = 2 m g/(ρ S C_D)`.
pub(super) fn fall(cd: f64, v0: f64, t: f64) -> [f64; 3] {
    let (g, area) = (GRAVITY_M_S2, std::f64::consts::FRAC_PI_4 * 0.12 * 0.12);
    let terminal = (2.0 * 0.2 * g / (1.3 * area * cd)).sqrt();
    let (at_start, at) = ((v0 / terminal).atanh(), g * t / terminal + (v0 / terminal).atanh());
    let depth = terminal * terminal / g * (at.cosh() / at_start.cosh()).ln();
    [depth, terminal * at.tanh(), g / at.cosh().powi(2)]
}

/// Uneven times.
pub(super) fn times(n: usize, first_s: f64, last_s: f64) -> Vec<f64> {
    let at = |i: usize| i as f64 / (n - 1) as f64;
    (0..n).map(|i| first_s + (last_s - first_s) * (at(i) + 0.13 * at(i) * (1.0 - at(i)))).collect()
}

/// A crooked series without a constant and, where asked for, without a slope in time.
pub(super) fn wiggle(t_s: &[f64], size: f64, phase: f64, slope_too: bool) -> Vec<f64> {
    let n = t_s.len();
    let x = DVector::from_fn(n, |i, _| size * (phase + 2.3 * i as f64 + 0.4 * (i * i) as f64).sin());
    let lines = DMatrix::from_fn(n, 1 + usize::from(slope_too), |i, k| if k == 0 { 1.0 } else { t_s[i] - t_s[0] });
    let c = (lines.transpose() * &lines).try_inverse().expect("two times or more") * lines.transpose() * &x;
    (x - lines * c).as_slice().to_vec()
}

/// Parabolas in a vacuum along some axes from these places and velocities.
pub(super) fn thrown(t_s: &[f64], axes: &[usize], place_m: [f64; 3], v_m_s: [f64; 3]) -> PointRecord {
    let at = |axis: usize, t: f64| {
        let t = t - t_s[0];
        place_m[axis] + v_m_s[axis] * t + if axis == 0 { 0.5 * GRAVITY_M_S2 * t * t } else { 0.0 }
    };
    let series = |axis: usize| axes.contains(&axis).then(|| t_s.iter().map(|t| at(axis, *t)).collect());
    PointRecord { t_s: t_s.to_vec(), position_m: std::array::from_fn(series), ..PointRecord::default() }
}

/// Parabolas of a body that does not turn, seen with its attitude.
pub(super) fn unturned(t_s: &[f64]) -> PointRecord {
    PointRecord {
        measured: Measured::Pose,
        attitude: vec![[1.0, 0.0, 0.0, 0.0]; t_s.len()],
        ..thrown(t_s, &[0, 1, 2], [1.0; 3], [2.0, 3.0, -1.0])
    }
}

/// Runs to identify on, with their inputs.
pub(crate) fn campaign(plant: Plant, inputs: &[&str], runs: Vec<(Vec<f64>, PointRecord)>) -> Campaign {
    let run = |(k, (inputs, record)): (usize, (Vec<f64>, PointRecord))| Run {
        name: format!("run-{k}"),
        kind: "drop".to_owned(),
        used: Use::Identify,
        inputs,
        data: Data::Point(record),
        notes: Vec::new(),
    };
    Campaign {
        name: "throws".to_owned(),
        plant,
        declared: vec![true],
        inputs: inputs.iter().map(|s| (*s).to_owned()).collect(),
        runs: runs.into_iter().enumerate().map(run).collect(),
        knowledge: Knowledge::default(),
    }
}

pub(super) fn close(a: f64, b: f64, by: f64) {
    assert!((a - b).abs() <= by, "{a} {b}: {:.1e} apart, {by:.1e} allowed", (a - b).abs());
}
