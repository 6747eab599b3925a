//! sim tests: laws over random flights of the lander in an uneven wind. In: plants and releases drawn. Out: mirror, turned room, later
//! start and other units give the same flight; a free body keeps energy and both momenta.

use crate::common::*;
use crate::scaling::coincide;
use proptest::prelude::*;
use windfall_model::frames::{Body, EulerXyz, Rotation, Tunnel, Vec3};
use windfall_model::{Flight, FroudeScale, Inertia, Integrator, Numerics, Plant, Release};

/// Tolerance 1e-12, errors grown by a factor of hundreds in 2 s of an unsteady flight.
const FLOWN: f64 = 1e-9;

fn tight(mut f: Flight) -> Flight {
    f.numerics = Numerics { method: Integrator::Dop853, relative_tolerance: 1e-12, absolute_tolerance: 1e-14 };
    f
}

fn three(size: f64) -> impl Strategy<Value = [f64; 3]> {
    prop::array::uniform3(-size..size)
}

prop_compose! {
    /// A lander whose c.m., products of inertia, hook and ring are anywhere, in a wind of every kind.
    fn crooked()(origin in three(0.004), hook in three(0.02), ring in three(0.3), products in three(4e-4), angularity in prop::array::uniform2(-0.02_f64..0.02),
        swirl in -0.1_f64..0.1, gradient in prop::array::uniform2(-0.05_f64..0.05), profile in -0.05_f64..0.05, roll in -0.02_f64..0.02) -> Plant {
        let mut plant = lander();
        let i = plant.aero.structure.index("Cl_0").expect("a parameter");
        plant.aero.values[i] = roll;
        plant.vehicle.p_origin_cm = Vec3::from_array(origin);
        plant.vehicle.inertia = Inertia { xy: products[0], xz: products[1], yz: products[2], ..plant.vehicle.inertia };
        plant.flow.angularity_rad = angularity;
        plant.flow.swirl_rad_per_m = swirl;
        plant.flow.gradient_per_m = gradient;
        plant.flow.profile_per_m2 = profile;
        let t = plant.tether.as_mut().expect("a tether");
        t.ring_shift_m = [ring[1], ring[2]];
        t.p_origin_hook = Vec3::new(-0.25, hook[1], hook[2]);
        t.line_rate_n_s_m = 0.05;
        t.swivel_n_m = 0.001;
        plant
    }
}

prop_compose! {
    /// Anywhere near the middle, up to 25 deg off the vertical, turning.
    fn release()(position_m in three(0.2), velocity_m_s in three(0.3), rx in -3.0_f64..3.0, ry in -0.3_f64..0.3, rz in -0.3_f64..0.3, rates_rad_s in three(0.5)) -> Release {
        Release { position_m, velocity_m_s, attitude_rad: [rx, ry, rz], rates_rad_s }
    }
}

fn attitude(r: [f64; 3]) -> Rotation<Tunnel, Body> {
    EulerXyz { rx_rad: r[0], ry_rad: r[1], rz_rad: r[2] }.r_tunnel_body()
}

proptest! {
    #![proptest_config(cases(16))]

    /// In the plane Y = 0: as axial vectors, roll, yaw and their causes change sign, as polar vectors Y does.
    #[test]
    fn law_mirrored_wind_mirrors_the_flight(plant in crooked(), release in release(), vw_m_s in 7.0_f64..7.8) {
        let y = |v: [f64; 3]| [v[0], -v[1], v[2]];
        let turn = |v: [f64; 3]| [-v[0], v[1], -v[2]];
        let mut other = plant.clone();
        let i = plant.aero.structure.index("Cl_0").expect("a parameter");
        other.aero.values[i] = -plant.aero.values[i];
        let v = &mut other.vehicle;
        v.p_origin_cm = Vec3::from_array(y(v.p_origin_cm.to_array()));
        (v.inertia.xy, v.inertia.yz) = (-v.inertia.xy, -v.inertia.yz);
        other.flow.angularity_rad[0] *= -1.0;
        other.flow.swirl_rad_per_m *= -1.0;
        other.flow.gradient_per_m[0] *= -1.0;
        let t = other.tether.as_mut().expect("a tether");
        t.ring_shift_m[0] *= -1.0;
        t.p_origin_hook = Vec3::from_array(y(t.p_origin_hook.to_array()));
        let mirrored = Release {
            position_m: y(release.position_m),
            velocity_m_s: y(release.velocity_m_s),
            attitude_rad: turn(release.attitude_rad),
            rates_rad_s: turn(release.rates_rad_s),
        };
        let (a, b) = (flown(&plant, &tight(flight(2.0, 20.0, vw_m_s, release))), flown(&other, &tight(flight(2.0, 20.0, vw_m_s, mirrored))));
        for k in 0..a.len() {
            prop_assert!(worst(&b.p_tunnel_cm[k], &y(a.p_tunnel_cm[k])) < FLOWN, "sample {}", k);
            prop_assert!(worst(&b.w_tunnel_body[k], &turn(a.w_tunnel_body[k])) < FLOWN, "sample {}", k);
            prop_assert!(worst(&b.attitude_rad[k], &turn(a.attitude_rad[k])) < FLOWN, "sample {}", k);
        }
    }

    /// Flight and wind turned together about the tunnel's axis.
    #[test]
    fn law_a_turned_room_turns_the_flight(plant in crooked(), release in release(), by in -3.0_f64..3.0, vw_m_s in 7.0_f64..7.8) {
        let about = attitude([by, 0.0, 0.0]).matrix;
        let turn = |v: [f64; 3]| { let w = about * nalgebra::Vector3::from(v); [w.x, w.y, w.z] };
        let across = |v: [f64; 2]| { let w = turn([0.0, v[0], v[1]]); [w[1], w[2]] };
        let mut other = plant.clone();
        other.flow.angularity_rad = across(plant.flow.angularity_rad);
        other.flow.gradient_per_m = across(plant.flow.gradient_per_m);
        let t = other.tether.as_mut().expect("a tether");
        t.ring_shift_m = across(t.ring_shift_m);
        let turned = Release {
            position_m: turn(release.position_m),
            velocity_m_s: turn(release.velocity_m_s),
            attitude_rad: [release.attitude_rad[0] + by, release.attitude_rad[1], release.attitude_rad[2]],
            rates_rad_s: release.rates_rad_s,
        };
        let (a, b) = (flown(&plant, &tight(flight(2.0, 20.0, vw_m_s, release))), flown(&other, &tight(flight(2.0, 20.0, vw_m_s, turned))));
        for k in 0..a.len() {
            prop_assert!(worst(&b.p_tunnel_cm[k], &turn(a.p_tunnel_cm[k])) < FLOWN, "sample {}", k);
            prop_assert!(worst(&b.v_tunnel_cm[k], &turn(a.v_tunnel_cm[k])) < FLOWN, "sample {}", k);
            prop_assert!(worst(&b.w_tunnel_body[k], &a.w_tunnel_body[k]) < FLOWN, "sample {}", k);
            prop_assert!((b.tether_n[k] - a.tether_n[k]).abs() < FLOWN, "sample {}", k);
        }
    }

    /// A flight that begins where another is goes on as that one does: nothing depends on the time of release.
    #[test]
    fn law_a_flight_released_later_goes_on(plant in crooked(), release in release(), at in 1_usize..40, vw_m_s in 7.0_f64..7.8) {
        let whole = flown(&plant, &tight(flight(2.0, 20.0, vw_m_s, release)));
        let later = Release {
            position_m: whole.p_tunnel_cm[at],
            velocity_m_s: whole.v_tunnel_cm[at],
            attitude_rad: whole.attitude_rad[at],
            rates_rad_s: whole.w_tunnel_body[at],
        };
        let rest = flown(&plant, &tight(flight(2.0 - 0.05 * at as f64, 20.0, vw_m_s, later)));
        prop_assert_eq!(rest.len() + at, whole.len());
        for k in 0..rest.len() {
            prop_assert!(worst(&rest.p_tunnel_cm[k], &whole.p_tunnel_cm[k + at]) < FLOWN, "sample {}", k);
            prop_assert!(worst(&rest.w_tunnel_body[k], &whole.w_tunnel_body[k + at]) < FLOWN, "sample {}", k);
            prop_assert!(angle_between(rest.quaternion[k], whole.quaternion[k + at]) < 1e-7, "sample {}", k);
        }
    }

    /// Other units of length, mass and time: three ratios that are free.
    #[test]
    fn law_units_scale_every_state_as_they_say(plant in crooked(), release in release(), length in 0.1_f64..10.0, density in 0.05_f64..20.0, gravity in 0.1_f64..10.0) {
        let mut order = tight(flight(2.0, 20.0, 7.43, release));
        order.numerics.relative_tolerance = 1e-13;
        coincide(&plant, &order, FroudeScale { length, density, gravity });
    }

    /// Without air, tether and gravity: energy of rotation, angular momentum, and a straight path of constant velocity.
    #[test]
    fn law_a_free_body_keeps_energy_and_momenta(axes in prop::array::uniform3(0.5_f64..1.0), turn in three(3.0), spin in three(4.0), velocity in three(1.0)) {
        // Principal moments of three masses on the axes obey the triangle inequality; turned, they have products.
        let principal = nalgebra::Vector3::new(axes[1] + axes[2], axes[0] + axes[2], axes[0] + axes[1]) * 0.01;
        let r = attitude(turn).matrix;
        let m = r * nalgebra::Matrix3::from_diagonal(&principal) * r.transpose();
        let inertia = Inertia { xx: m[(0, 0)], yy: m[(1, 1)], zz: m[(2, 2)], xy: -m[(0, 1)], xz: -m[(0, 2)], yz: -m[(1, 2)] };
        let release = Release { velocity_m_s: velocity, rates_rad_s: spin, ..REST };
        let truth = flown(&torque_free(inertia), &tight(flight(3.0, 10.0, 0.0, release)));
        let at = |k: usize| {
            let w = Vec3::<Body>::from_array(truth.w_tunnel_body[k]);
            let h: Vec3<Body> = Vec3::from(inertia.matrix() * w.xyz);
            (0.5 * w.dot(h), Rotation::<Tunnel, Body>::from_quaternion(truth.quaternion[k]) * h)
        };
        let (e0, h0) = at(0);
        for k in 0..truth.len() {
            let (e, h) = at(k);
            prop_assert!((e - e0).abs() <= 1e-11 * (e0 + 1e-6) && (h - h0).norm() <= 1e-11 * (h0.norm() + 1e-6), "sample {}", k);
            let straight = velocity.map(|v| v * truth.t_s[k]);
            prop_assert!(worst(&truth.v_tunnel_cm[k], &velocity) < 1e-13 && worst(&truth.p_tunnel_cm[k], &straight) < 1e-12, "sample {}", k);
        }
    }
}
