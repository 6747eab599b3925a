//! sim tests: the lander in the tunnel. In: closed forms and figures that follow from the tables. Out: whether ours meets them.

use crate::common::*;
use std::f64::consts::{PI, TAU};
use windfall_model::frames::Vec3;
use windfall_model::{
    ApparentMass, Coefficient, Contact, Flight, Inertia, Integrator, LooseMass, Numerics, Plant, Release, TunnelSpeed,
};
use windfall_sim::{Seed, fly, trim_speed};

fn tight(mut f: Flight) -> Flight {
    f.numerics = Numerics { method: Integrator::Dop853, relative_tolerance: 1e-12, absolute_tolerance: 1e-14 };
    f
}

fn values(plant: &mut Plant, names: &[(&str, f64)]) {
    for (name, value) in names {
        let i = plant.aero.structure.index(name).expect("a parameter");
        plant.aero.values[i] = *value;
    }
}

/// Errata: 7.43 m/s at 1.1802 kg/m³, three printed digits; and q = 32.5 Pa.
#[test]
fn pub_trim_speed() {
    let v = trim_speed(&lander(), 1.1802);
    assert!((v - 7.43).abs() < 0.005, "{v}");
    assert!((0.5 * 1.1802 * v * v - 32.5).abs() < 0.1);
}

/// `q = (m g + W_tr)/(C_A S + (C_D S)_tr)` by hand, and with C_A rising in proportion to speed: `V³ C S ρ/(2·7.5) = m g`.
#[test]
fn exact_trim_speed_with_coefficient_of_speed() {
    let mut plant = lander();
    let s = PI / 4.0 * 0.2125 * 0.2125;
    let q = (0.7873 * 9.80665 + 0.016_458_42) / (6.6620 * s + 0.001_300_642_6);
    assert!((trim_speed(&plant, DENSITY) - (2.0 * q / DENSITY).sqrt()).abs() < 1e-13);
    // A tether whose pull is 2.5 times as large.
    let tether = plant.tether.as_mut().expect("a tether");
    (tether.weight_n, tether.drag_area_m2) = (2.5 * tether.weight_n, 2.5 * tether.drag_area_m2);
    let q = (0.7873 * 9.80665 + 2.5 * 0.016_458_42) / (6.6620 * s + 2.5 * 0.001_300_642_6);
    assert!((trim_speed(&plant, DENSITY) - (2.0 * q / DENSITY).sqrt()).abs() < 1e-13);
    plant.tether = None;
    values(&mut plant, &[("CA_T0", 0.0)]);
    plant.aero.add(Coefficient::CA, 6.0, 1.0 / 7.5, &[windfall_model::Factor::Power(windfall_model::Variable::Speed, 1)]);
    let v = (2.0 * 7.5 * 0.7873 * 9.80665 / (6.0 * s * DENSITY)).cbrt();
    assert!((trim_speed(&plant, DENSITY) - v).abs() < 1e-12);
}

/// At trim speed, upright, the model stays where it is: only roll moves. Bound: the tolerance times 10 s.
#[test]
fn exact_trimmed_flight_stays() {
    let plant = lander();
    let truth = flown(&plant, &tight(flight(10.0, 10.0, trim_speed(&plant, DENSITY), REST)));
    for k in 0..truth.len() {
        assert!(worst(&truth.p_tunnel_cm[k], &[0.0; 3]) < 1e-11 && truth.alpha_t_rad[k] < 1e-11);
        assert!((truth.tether_n[k] - 0.026).abs() < 0.0005, "errata: 0.026 N");
    }
}

/// Roll at trim: `p = p_s (1 − e^{−t/τ})`, `p_s = −(C_l0/C_lp)(2V/d)` = 8.8 deg/s (errata), `τ = I_xx 2V/(q S d² |C_lp|)`.
#[test]
fn exact_roll_to_its_steady_rate() {
    let plant = lander();
    let v = trim_speed(&plant, DENSITY);
    let truth = flown(&plant, &tight(flight(60.0, 10.0, v, REST)));
    let (d, s) = (0.2125, plant.vehicle.area_m2());
    let steady = 0.0125 / 5.6816 * 2.0 * v / d;
    let tau = 0.02113 * 2.0 * v / (0.5 * DENSITY * v * v * s * d * d * 5.6816);
    assert!((steady.to_degrees() - 8.8).abs() < 0.05);
    for k in 0..truth.len() {
        let p = steady * (1.0 - (-truth.t_s[k] / tau).exp());
        let turned = steady * (truth.t_s[k] - tau * (1.0 - (-truth.t_s[k] / tau).exp()));
        assert!((truth.w_tunnel_body[k][0] - p).abs() < 1e-10 && (truth.attitude_rad[k][0] - turned).abs() < 1e-9);
    }
}

/// Errata: pitch mode 0.96 Hz. Small release, held in place by a heavy mass so that only rotation moves; two printed digits.
#[test]
fn pub_pitch_mode_frequency() {
    let plant = lander();
    let v = trim_speed(&plant, DENSITY);
    let release = Release { attitude_rad: [0.0, 0.01, 0.0], ..REST };
    let truth = flown(&plant, &tight(flight(20.0, 200.0, v, release)));
    let q: Vec<f64> = truth.w_tunnel_body.iter().map(|w| w[1]).collect();
    let crossings: Vec<f64> = (1..q.len())
        .filter(|&k| q[k - 1] > 0.0 && q[k] <= 0.0)
        .map(|k| truth.t_s[k - 1] + (truth.t_s[k] - truth.t_s[k - 1]) * q[k - 1] / (q[k - 1] - q[k]))
        .collect();
    let periods = (crossings.len() - 1) as f64;
    let hz = periods / (crossings[crossings.len() - 1] - crossings[0]);
    assert!((hz - 0.96).abs() < 0.02, "{hz} Hz");
}

/// Errata: in steady glide the axis is `(C_Nα/C_A) α_T` = 0.53 α_T off the vertical. A small asymmetry holds the angle.
#[test]
fn pub_off_vertical_in_steady_glide() {
    let mut plant = lander();
    plant.tether = None;
    values(&mut plant, &[("Cl_0", 0.0), ("Cm_2", 0.0), ("Cn_2", 0.0), ("Cm_1", -60.0), ("Cn_1", -60.0)]);
    plant.aero.add(Coefficient::Cm, 0.05, 1.0, &[]);
    let v = trim_speed(&plant, DENSITY);
    let truth = flown(&plant, &flight(200.0, 10.0, v, REST));
    let last = truth.len() - 1;
    let off = truth.attitude_rad[last][1].abs().hypot(truth.attitude_rad[last][2]);
    let ratio = off / truth.alpha_t_rad[last];
    assert!(truth.alpha_t_rad[last] > 0.01);
    assert!((ratio - 3.5129 / 6.6620).abs() < 0.003 && (ratio - 0.53).abs() < 0.005, "{ratio}");
}

/// Fall from rest in still air along the axis: `V = V_t tanh(g t/V_t)`, `X = (V_t²/g) ln cosh(g t/V_t)`.
#[test]
fn exact_drop_in_still_air() {
    let mut plant = lander();
    plant.tether = None;
    values(&mut plant, &[("Cl_0", 0.0)]);
    let (vt, g) = (trim_speed(&plant, DENSITY), 9.80665);
    let truth = flown(&plant, &tight(flight(3.0, 50.0, 0.0, REST)));
    for k in 0..truth.len() {
        let x = g * truth.t_s[k] / vt;
        assert!((truth.v_tunnel_cm[k][0] - vt * x.tanh()).abs() < 1e-10);
        assert!((truth.p_tunnel_cm[k][0] - vt * vt / g * x.cosh().ln()).abs() < 1e-10);
        assert!((truth.airspeed_m_s[k] - truth.v_tunnel_cm[k][0]).abs() < 1e-10);
    }
}

/// Roll against the swivel alone, `I p' = −T tanh(p/p₀)`: `sinh(p/p₀)` decays as `exp(−T t/(I p₀))`, straight down first, then as
/// a slow roll does.
#[test]
fn exact_swivel_stops_a_roll() {
    let inertia = Inertia { xx: 0.02113, yy: 0.0138, zz: 0.0138, ..Inertia::default() };
    let mut plant = torque_free(inertia);
    let mut tether = lander().tether.expect("a tether");
    (tether.drag_area_m2, tether.weight_n, tether.swivel_n_m) = (0.0, 0.0, 0.004);
    let slow = tether.swivel_rate_rad_s;
    plant.tether = Some(tether);
    for start in [0.3, -0.3] {
        let release = Release { rates_rad_s: [start, 0.0, 0.0], ..REST };
        let truth = flown(&plant, &tight(flight(3.0, 20.0, 7.43, release)));
        for k in 0..truth.len() {
            let s = (start / slow).sinh() * (-0.004 * truth.t_s[k] / (0.02113 * slow)).exp();
            let [p, q, r] = truth.w_tunnel_body[k];
            assert!((p - slow * s.asinh()).abs() < 1e-11, "{p} at {} s", truth.t_s[k]);
            assert!(q.abs() + r.abs() < 1e-15);
        }
        assert!(truth.w_tunnel_body[truth.len() - 1][0].abs() < 0.01 * start.abs());
    }
}

/// A pulse gives its impulses exactly, `Δv = J/m`, `Δω = I⁻¹ A`, however long the steps could be. Time enters only through the
/// state that carries it: without that the eighth-order method gives nonsense. The pulse is an effect of the plant, or a push of the flight.
#[test]
fn exact_contact_pulse() {
    let still = torque_free(Inertia { xx: 0.02, yy: 0.02, zz: 0.02, ..Inertia::default() });
    let pulse = Contact {
        run: 0,
        start_s: 5.003,
        duration_s: 0.02,
        impulse: Vec3::new(0.1, -0.2, 0.3),
        angular_impulse: Vec3::new(0.001, 0.0, 0.0),
    };
    for (method, by_flight) in [(Integrator::Dop853, false), (Integrator::Dopri5, false), (Integrator::Dop853, true)] {
        let mut order = flight(10.0, 10.0, 0.0, REST);
        order.numerics.method = method;
        let mut plant = still.clone();
        if by_flight {
            order.pushes.push(Contact { run: 7, ..pulse })
        } else {
            plant.contacts.push(pulse)
        }
        let truth = flown(&plant, &order);
        let last = truth.len() - 1;
        assert!(worst(&truth.v_tunnel_cm[50], &[0.0; 3]) < 1e-12);
        // Turning by 0.05 rad/s · 0.01 s in the pulse changes the push's direction by 2.5e-4 of 0.25 m/s about x.
        let expected = [0.1 / 0.7873, -0.2 / 0.7873, 0.3 / 0.7873];
        assert!(worst(&truth.v_tunnel_cm[last], &expected) < 2e-4);
        assert!((truth.v_tunnel_cm[last][0] - expected[0]).abs() < 1e-8);
        assert!((truth.w_tunnel_body[last][0] - 0.05).abs() < 1e-9);
    }
}

/// A loose part in free space: body and part oscillate at `ω/√(1 − m/M − m x²/I)`, and their momentum stays.
#[test]
fn exact_loose_part_frequency() {
    let mut plant = torque_free(Inertia { xx: 0.02, yy: 0.014, zz: 0.014, ..Inertia::default() });
    let (m, x, hz) = (0.1, 0.1, 2.0);
    plant.vehicle.loose = Some(LooseMass { mass_kg: m, frequency_hz: hz, damping_ratio: 0.0, x_cm_m: x, in_full: 1.0 });
    plant.contacts = vec![Contact {
        run: 0,
        start_s: 0.0,
        duration_s: 0.05,
        impulse: Vec3::new(0.0, 1e-4, 0.0),
        angular_impulse: Vec3::zero(),
    }];
    let truth = flown(&plant, &tight(flight(10.0, 400.0, 0.0, REST)));
    let w = TAU * hz / (1.0 - m / 0.7873 - m * x * x / 0.014_f64).sqrt();
    // After the push the body's speed is `v₀ + b sin(w t + φ)`; a second difference removes what is constant.
    let v: Vec<f64> = truth.v_tunnel_cm.iter().skip(40).map(|v| v[1]).collect();
    let h = 1.0 / 400.0;
    let (d0, d1): (Vec<f64>, Vec<f64>) =
        (1..v.len() - 2).map(|k| (v[k + 1] - 2.0 * v[k] + v[k - 1], v[k + 2] - 2.0 * v[k + 1] + v[k])).unzip();
    // d(t+h) + d(t−h) = 2 cos(w h) d(t).
    let (mut top, mut bottom) = (0.0, 0.0);
    for k in 1..d0.len() {
        top += (d1[k] + d0[k - 1]) * d0[k];
        bottom += 2.0 * d0[k] * d0[k];
    }
    let found = (top / bottom).acos() / h;
    assert!((found - w).abs() < 1e-4 * w, "{found} against {w}");
}

/// Apparent mass from rest in still air: `a = g m/(m + m_x)`; and a stream that speeds up drags the body along.
#[test]
fn exact_apparent_mass_of_a_falling_body() {
    let mut plant = torque_free(lander().vehicle.inertia);
    plant.environment.gravity_m_s2 = 9.80665;
    plant.vehicle.apparent = ApparentMass { axial_kg: 0.2, ..ApparentMass::default() };
    let truth = flown(&plant, &tight(flight(1.0, 10.0, 0.0, REST)));
    assert!((truth.v_tunnel_cm[10][0] - 9.80665 * 0.7873 / 0.9873).abs() < 1e-10);
    plant.environment.gravity_m_s2 = 0.0;
    let mut order = tight(flight(1.0, 10.0, 0.0, REST));
    order.speed = TunnelSpeed::History { interval_s: 0.1, vw_m_s: (0..30).map(|k| 5.0 + 0.3 * f64::from(k)).collect() };
    let truth = flown(&plant, &order);
    // V̇_W = 3 m/s² upward: a_X = −3 m_x/(m + m_x).
    assert!((truth.v_tunnel_cm[10][0] + 3.0 * 0.2 / 0.9873).abs() < 1e-9, "{}", truth.v_tunnel_cm[10][0]);
}

/// The operator holds the height: with the lag small, `Ẍ = −(2g/V)(K_h X + K_r Ẋ)`-like; the model returns to where it is held and the
/// speed to trim, and without gains the fan stays at trim.
#[test]
fn law_operator_holds_height() {
    let plant = lander();
    let trim = trim_speed(&plant, DENSITY);
    let hand = windfall_model::Operator {
        trim_m_s: None,
        height_gain_per_s: 0.6,
        rate_gain: 0.5,
        integral_gain_per_s2: 0.05,
        lag_s: 0.3,
        unsteady_rms_m_s: 0.0,
        unsteady_time_s: 1.0,
        hold_x_m: 0.5,
    };
    let mut order = flight(80.0, 10.0, 0.0, REST);
    order.speed = TunnelSpeed::Operator(hand);
    let truth = flown(&plant, &order);
    let last = truth.len() - 1;
    assert!((truth.p_tunnel_cm[last][0] - 0.5).abs() < 2e-3, "{:?}", truth.p_tunnel_cm[last]);
    assert!((truth.vw_m_s[last] - trim).abs() < 0.01 && (truth.vw_m_s[0] - trim).abs() < 1e-12);
    // Above the height that is held the fan slows down first.
    assert!(truth.vw_m_s[3] < trim);
    order.speed = TunnelSpeed::Operator(windfall_model::Operator {
        height_gain_per_s: 0.0,
        rate_gain: 0.0,
        integral_gain_per_s2: 0.0,
        ..hand
    });
    assert!(flown(&plant, &order).vw_m_s.iter().all(|v| (v - trim).abs() < 1e-12));
}

/// Samples of a default flight are as good as its steps: against the same flight at 1e-13, within a hundred times the tolerance
/// (the growth of errors over 15 s of a stable oscillation), whatever the sample rate; the last sample like the others.
#[test]
fn law_dense_samples_are_as_good_as_the_steps() {
    let plant = lander();
    let release = Release { attitude_rad: [0.0, 0.3, 0.2], rates_rad_s: [0.2, 0.4, 0.0], ..REST };
    for method in [Integrator::Dop853, Integrator::Dopri5] {
        for rate_hz in [3.0, 10.0, 150.0] {
            let mut order = flight(15.0, rate_hz, 7.43, release);
            order.numerics = Numerics { method, ..Numerics::default() };
            let reference = flown(
                &plant,
                &Flight {
                    numerics: Numerics { relative_tolerance: 1e-13, absolute_tolerance: 1e-15, method: Integrator::Dop853 },
                    ..order.clone()
                },
            );
            let truth = flown(&plant, &order);
            let far: Vec<f64> = (0..truth.len())
                .map(|k| {
                    worst(&truth.w_tunnel_body[k], &reference.w_tunnel_body[k])
                        .max(worst(&truth.p_tunnel_cm[k], &reference.p_tunnel_cm[k]))
                })
                .collect();
            assert!(far.iter().all(|f| *f < 1e-7), "{method:?} {rate_hz} Hz: {:e}", far.iter().fold(0.0, |a: f64, b| a.max(*b)));
        }
    }
}

/// Equal input and seed, equal bits.
#[test]
fn law_same_seed_same_bits() {
    let mut plant = lander();
    plant.turbulence = windfall_model::Turbulence {
        axial_rms_m_s: 0.1,
        lateral_rms_m_s: 0.1,
        axial_scale_m: 0.6,
        lateral_scale_m: 0.6,
        bandwidth: 0.0,
    };
    plant.sensors = crate::instruments::sensors();
    let mut order = flight(3.0, 150.0, 7.43, REST);
    order.sensor_noise = true;
    let one = || fly(&plant, &order, Seed { campaign: 7, run: 3 }).expect("flies");
    let here = one();
    let there: Vec<_> = std::thread::scope(|s| (0..4).map(|_| s.spawn(one)).map(|h| h.join().expect("ends")).collect());
    assert!(there.iter().all(|f| *f == here));
}
