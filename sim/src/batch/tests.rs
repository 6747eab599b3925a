//! sim tests: the same flight on several vector units. In: the tests' lander. Out: equal bits.

use super::*;
use pulp::Scalar;
use windfall_model::{Numerics, Operator, Release, TunnelSpeed, Turbulence, Use};

/// The tests' lander.
#[path = "../../tests/it/sage.rs"]
mod sage;

fn flight(speed: TunnelSpeed, method: Integrator) -> Flight {
    Flight {
        name: "test".into(),
        kind: "perturbed".into(),
        used: Use::Identify,
        duration_s: 1.0,
        rate_hz: 100.0,
        release: Release {
            position_m: [0.1, 0.2, -0.1],
            velocity_m_s: [0.1, -0.2, 0.3],
            attitude_rad: [0.4, 0.314, 0.305],
            rates_rad_s: [0.2, 0.4, -0.3],
        },
        speed,
        ps_pa: 101_325.0,
        ts_k: 299.0,
        section: None,
        numerics: Numerics { method, ..Numerics::default() },
        sensor_noise: false,
        pushes: Vec::new(),
        window_s: None,
    }
}

/// Eight lanes, four and one: truth and number of steps, by every stepping, with an operator and without.
#[test]
fn exact_bits_on_every_unit() {
    let gusts = Turbulence { axial_rms_m_s: 0.1, lateral_rms_m_s: 0.1, axial_scale_m: 0.5, lateral_scale_m: 0.3, bandwidth: 0.0 };
    let plant = Plant { turbulence: gusts, ..sage::lander() };
    let operator = TunnelSpeed::Operator(Operator {
        trim_m_s: None,
        height_gain_per_s: 0.3,
        rate_gain: 0.4,
        integral_gain_per_s2: 0.05,
        lag_s: 0.3,
        unsteady_rms_m_s: 0.1,
        unsteady_time_s: 0.5,
        hold_x_m: 0.1,
    });
    for speed in [TunnelSpeed::Constant(7.4), operator] {
        for (method, stepping) in [
            (Integrator::Dop853, Stepping::Adaptive),
            (Integrator::Dopri5, Stepping::Adaptive),
            (Integrator::Dopri5, Stepping::Rk4 { steps_per_sample: 2 }),
        ] {
            let flight = flight(speed.clone(), method);
            let orders = [Order { plant: &plant, flight: &flight, seed: Seed::default() }];
            let (kin, group) = groups(&orders, stepping, |_, error| panic!("{error}")).remove(0);
            let mut spares = [Vec::new(), Vec::new(), Vec::new()];
            let [narrow, wide, four_lanes] = spares.each_mut().map(|spare| Side {
                kin: &kin,
                ready: &group,
                orders: &orders,
                keep: KeepSamples::Truth,
                spare,
            });
            let flown = |mut tracks: Vec<LaneTrack<'_>>| {
                let track = tracks.remove(0);
                (track.series.truth, track.steps)
            };
            let one = flown(narrow.with_simd(Scalar::new()));
            assert_eq!(one.0.len(), 101);
            assert!(one == flown(Arch::new().dispatch(wide)), "{stepping:?}, {method:?}, {speed:?}: the widest unit");
            #[cfg(target_arch = "x86_64")]
            if let Some(four) = pulp::x86::V3::try_new() {
                assert!(one == flown(Simd::vectorize(four, four_lanes)), "{stepping:?}, {method:?}, {speed:?}: four lanes");
            }
        }
    }
}
