//! pid tests: what an identification must not depend on. In: random motion of a lander whose every number is set. Out: the same estimates
//! and errors in a mirror, in a turned room, at another time, in other units; normal equations of stacked runs that add up.

mod common;

use common::{campaign_of, lander};
use nalgebra::{DMatrix, DVector};
use proptest::prelude::*;
use std::f64::consts::TAU;
use windfall_model::frames::Vec3;
use windfall_model::{Campaign, Data, FroudeScale, Inertia, Plant, Record, Use};
use windfall_pid::regress::{Colour, RegressionFit, RegressionOutcome, RegressionSeries, ols};
use windfall_pid::{DataSet, Method, identify};

/// So many cases of a property, or as many as `PROPTEST_CASES` asks for.
fn cases(few: u32) -> ProptestConfig {
    if std::env::var_os("PROPTEST_CASES").is_some() { ProptestConfig::default() } else { ProptestConfig::with_cases(few) }
}

const SAMPLES: u32 = 400;
const RATE_HZ: f64 = 50.0;

/// Three waves of a channel: size, frequency in Hz, phase.
type Waves = [(f64, f64, f64); 3];

fn waves() -> impl Strategy<Value = [Waves; 7]> {
    let wave = (0.3_f64..1.0, 0.2_f64..1.5, 0.0..TAU);
    let three = (wave.clone(), wave.clone(), wave).prop_map(|(a, b, c)| [a, b, c]);
    prop::collection::vec(three, 7).prop_map(|all| all.try_into().expect("seven"))
}

/// Motion of no body in particular: the equations hold for any, with the residual that is left.
fn record(waves: &[Waves; 7]) -> Record {
    let t_s: Vec<f64> = (0..SAMPLES).map(|i| f64::from(i) / RATE_HZ).collect();
    let channel = |k: usize, size: f64| -> Vec<f64> {
        t_s.iter().map(|t| waves[k].iter().map(|(a, f, phase)| size * a * (TAU * f * t + phase).sin()).sum()).collect()
    };
    Record {
        position_m: [channel(0, 0.1), channel(1, 0.1), channel(2, 0.1)],
        attitude_rad: [channel(3, 0.5), channel(4, 0.1), channel(5, 0.1)],
        vw_m_s: channel(6, 0.1).iter().map(|v| 7.4 + v).collect(),
        ps_pa: vec![101_325.0; t_s.len()],
        ts_k: vec![299.0; t_s.len()],
        t_s,
        ..Record::default()
    }
}

prop_compose! {
    fn crooked()(origin in prop::array::uniform3(-0.004_f64..0.004), hook in prop::array::uniform2(-0.02_f64..0.02), ring in prop::array::uniform2(-0.3_f64..0.3),
        products in prop::array::uniform3(-4e-4_f64..4e-4), angularity in prop::array::uniform2(-0.02_f64..0.02), swirl in -0.1_f64..0.1,
        gradient in prop::array::uniform2(-0.05_f64..0.05), profile in -0.05_f64..0.05) -> Plant {
        let mut plant = lander();
        plant.vehicle.p_origin_cm = Vec3::from_array(origin);
        plant.vehicle.inertia = Inertia { xy: products[0], xz: products[1], yz: products[2], ..plant.vehicle.inertia };
        plant.flow.angularity_rad = angularity;
        plant.flow.swirl_rad_per_m = swirl;
        plant.flow.gradient_per_m = gradient;
        plant.flow.profile_per_m2 = profile;
        let t = plant.tether.as_mut().expect("a tether");
        t.ring_shift_m = ring;
        t.p_origin_hook = Vec3::new(-0.25, hook[0], hook[1]);
        t.line_rate_n_s_m = 0.05;
        plant
    }
}

fn campaign(plant: Plant, record: Record) -> Campaign {
    let mut c = campaign_of("random", vec![("run".to_owned(), "perturbed".to_owned(), Use::Identify, record)]);
    c.plant = plant;
    c
}

fn changed(c: &Campaign, plant: impl Fn(&mut Plant), record: impl Fn(&mut Record)) -> Campaign {
    let mut c = c.clone();
    plant(&mut c.plant);
    for run in &mut c.runs {
        if let Data::Tunnel(r) = &mut run.data {
            record(r);
        }
    }
    c
}

fn found(c: &Campaign, method: Method) -> DataSet {
    identify(c, method).expect("excited").combined().expect("all runs").clone()
}

/// Largest difference of estimates, and of standard errors, in standard errors; of Cl_0 the sign is `roll`.
fn apart(a: &DataSet, b: &DataSet, roll: f64) -> f64 {
    assert_eq!(a.parameters.len(), b.parameters.len());
    let one = |(p, q): (&windfall_pid::Estimate, &windfall_pid::Estimate)| {
        assert_eq!(p.name, q.name);
        let side = if p.name == "Cl_0" { roll } else { 1.0 };
        ((p.estimate - side * q.estimate).abs() / p.std_error).max((p.std_error / q.std_error - 1.0).abs())
    };
    a.parameters.iter().zip(&b.parameters).map(one).max_by(f64::total_cmp).unwrap_or(f64::NAN)
}

/// Rounding of 1e-16 grown by the second derivatives of a spline (1e4 for 0.1 s and 50 Hz) and the condition of the fit (hundreds).
const ROUNDING: f64 = 1e-7;

const METHODS: [Method; 2] = [Method::Thesis, Method::EquationError];

proptest! {
    // Each case identifies four times.
    #![proptest_config(cases(12))]

    #[test]
    fn law_a_mirror_changes_the_sign_of_roll_alone(plant in crooked(), waves in waves()) {
        let c = campaign(plant, record(&waves));
        let mirrored = changed(&c, |p| {
            let y = |v: [f64; 3]| [v[0], -v[1], v[2]];
            let v = &mut p.vehicle;
            v.p_origin_cm = Vec3::from_array(y(v.p_origin_cm.to_array()));
            (v.inertia.xy, v.inertia.yz) = (-v.inertia.xy, -v.inertia.yz);
            p.flow.angularity_rad[0] *= -1.0;
            p.flow.swirl_rad_per_m *= -1.0;
            p.flow.gradient_per_m[0] *= -1.0;
            let t = p.tether.as_mut().expect("a tether");
            t.ring_shift_m[0] *= -1.0;
            t.p_origin_hook = Vec3::from_array(y(t.p_origin_hook.to_array()));
        }, |r| {
            let [rx, _, rz] = &mut r.attitude_rad;
            r.position_m[1].iter_mut().chain(rx).chain(rz).for_each(|v| *v = -*v);
        });
        for method in METHODS {
            let far = apart(&found(&c, method), &found(&mirrored, method), -1.0);
            prop_assert!(far < ROUNDING, "{:?}: {}", method, far);
        }
    }

    #[test]
    fn law_a_turned_room_changes_nothing(plant in crooked(), waves in waves(), by in -3.0_f64..3.0) {
        let (sin, cos) = by.sin_cos();
        let across = |v: [f64; 2]| [cos * v[0] - sin * v[1], sin * v[0] + cos * v[1]];
        let c = campaign(plant, record(&waves));
        let turned = changed(&c, |p| {
            p.flow.angularity_rad = across(p.flow.angularity_rad);
            p.flow.gradient_per_m = across(p.flow.gradient_per_m);
            let t = p.tether.as_mut().expect("a tether");
            t.ring_shift_m = across(t.ring_shift_m);
        }, |r| {
            let [_, y, z] = &mut r.position_m;
            y.iter_mut().zip(z).for_each(|(y, z)| [*y, *z] = across([*y, *z]));
            r.attitude_rad[0].iter_mut().for_each(|a| *a += by);
        });
        for method in METHODS {
            let far = apart(&found(&c, method), &found(&turned, method), 1.0);
            prop_assert!(far < ROUNDING, "{:?}: {}", method, far);
        }
    }

    #[test]
    fn law_another_time_changes_nothing(plant in crooked(), waves in waves(), later_s in -1e3_f64..1e3) {
        let c = campaign(plant, record(&waves));
        let later = changed(&c, |_| {}, |r| r.t_s.iter_mut().for_each(|t| *t += later_s));
        for method in METHODS {
            let far = apart(&found(&c, method), &found(&later, method), 1.0);
            // Times of 1e3 s are rounded to 1e-13 s: 1e-14 of the interval's derivatives more.
            prop_assert!(far < 2.0 * ROUNDING, "{:?}: {}", method, far);
        }
    }

    /// Lengths, masses and times in other units: coefficients are pure numbers. The thesis' cutoffs are in hertz and fixed, so that its
    /// smoothing knows the unit of time; equation error chooses its own.
    #[test]
    fn law_other_units_change_nothing(plant in crooked(), waves in waves(), length in 0.1_f64..10.0, density in 0.05_f64..20.0, gravity in 0.1_f64..10.0) {
        let scale = FroudeScale { length, density, gravity };
        let c = campaign(plant, record(&waves));
        let scaled = changed(&c, |p| *p = scale.plant(p), |r| {
            let times = |x: &mut Vec<f64>, k: f64| x.iter_mut().for_each(|v| *v *= k);
            times(&mut r.t_s, scale.time());
            r.position_m.iter_mut().for_each(|x| times(x, length));
            times(&mut r.vw_m_s, scale.speed());
            times(&mut r.ps_pa, density);
        });
        let far = apart(&found(&c, Method::EquationError), &found(&scaled, Method::EquationError), 1.0);
        prop_assert!(far < ROUNDING, "{}", far);
    }

    /// Runs stacked are their normal equations added: `X'X` and `X'y` of two series are sums.
    #[test]
    fn law_normal_equations_of_stacked_runs_add_up(a in prop::collection::vec(prop::array::uniform4(-1.0_f64..1.0), 12..40), b in prop::collection::vec(prop::array::uniform4(-1.0_f64..1.0), 12..40)) {
        let series = |rows: &[[f64; 4]]| RegressionSeries {
            regressors: (0..3).map(|k| rows.iter().map(|r| r[k]).collect()).collect(),
            response: rows.iter().map(|r| r[3]).collect(),
            weight: (0..rows.len()).map(|i| 1.0 / (1.0 + 0.1 * i as f64)).collect(),
            residuals: Colour::White,
        };
        let fit = |s: &[RegressionSeries]| -> RegressionFit {
            match ols(s).expect("enough rows") {
                RegressionOutcome::Fit(fit) => *fit,
                other => panic!("independent columns, yet {other:?}"),
            }
        };
        let normal = |f: &RegressionFit| -> (DMatrix<f64>, DVector<f64>) {
            let n = (&f.covariance_white / f.s2).try_inverse().expect("of full rank");
            let right = &n * DVector::from_column_slice(&f.estimate);
            (n, right)
        };
        let (one, two, both) = (fit(&[series(&a)]), fit(&[series(&b)]), fit(&[series(&a), series(&b)]));
        let ((n1, r1), (n2, r2), (n, r)) = (normal(&one), normal(&two), normal(&both));
        // Condition of a dozen random rows of three columns: below a thousand, squared.
        prop_assert!((&n1 + &n2 - &n).norm() < 1e-8 * n.norm() && (r1 + r2 - &r).norm() < 1e-8 * (1.0 + r.norm()));
        prop_assert_eq!(one.rows + two.rows, both.rows);
    }
}
