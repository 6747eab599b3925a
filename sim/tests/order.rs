//! sim tests: the order of each integrator, measured on a flight of the lander. In: tolerances and steps. Out: slopes of error over work;
//! with `WINDFALL_WRITE_REFERENCE` the points of the work-precision diagram.

#![expect(clippy::print_stdout, reason = "a test prints what it measured")]

#[path = "it/sage.rs"]
mod sage;

use std::fmt::Write as _;
use std::path::Path;
use windfall_model::{Flight, Integrator, Numerics, Release, TunnelSpeed, Use};
use windfall_sim::{Order, Seed, Stepping, Truth, fly, fly_truth_batch};

/// Smooth in time: constant tunnel speed, far from where the flow is along the axis.
fn flight(method: Integrator, tolerance: f64) -> Flight {
    Flight {
        name: "order".into(),
        kind: "perturbed".into(),
        used: Use::Identify,
        duration_s: 3.0,
        rate_hz: 10.0,
        release: Release {
            position_m: [0.1, 0.2, -0.1],
            velocity_m_s: [0.1, -0.2, 0.3],
            attitude_rad: [0.4, 0.314, 0.305],
            rates_rad_s: [0.2, 0.4, -0.3],
        },
        speed: TunnelSpeed::Constant(7.43),
        ps_pa: 101_325.0,
        ts_k: 299.0,
        section: None,
        numerics: Numerics { method, relative_tolerance: tolerance, absolute_tolerance: tolerance },
        sensor_noise: false,
        pushes: Vec::new(),
        window_s: None,
    }
}

/// Largest difference of place (m), velocity (m/s), attitude (quaternion) and body rates (rad/s).
fn apart(a: &Truth, b: &Truth) -> f64 {
    let states = |t: &Truth| -> Vec<f64> {
        let vectors = [&t.p_tunnel_cm, &t.v_tunnel_cm, &t.w_tunnel_body];
        vectors.into_iter().flatten().flatten().chain(t.quaternion.iter().flatten()).copied().collect()
    };
    states(a).iter().zip(states(b)).map(|(x, y)| (x - y).abs()).max_by(f64::total_cmp).unwrap_or(f64::NAN)
}

/// A method, and for each of its settings the right-hand sides of its accepted steps and the error.
type Line = (&'static str, Vec<(f64, f64)>);

fn lines() -> [Line; 3] {
    let plant = sage::lander();
    let exact = fly(&plant, &flight(Integrator::Dop853, 1e-14), Seed::default()).expect("flies").truth;
    let adaptive = |method, stages: f64, tolerances: &[f64]| -> Vec<(f64, f64)> {
        let one = |tolerance: &f64| {
            let flown = fly(&plant, &flight(method, *tolerance), Seed::default()).expect("flies");
            (stages * flown.steps as f64, apart(&flown.truth, &exact))
        };
        tolerances.iter().map(one).collect()
    };
    let fixed = |steps_per_sample: u32| {
        let order = flight(Integrator::Dop853, 1e-9);
        let orders = [Order { plant: &plant, flight: &order, seed: Seed::default() }];
        let (truth, _) = fly_truth_batch(&orders, Stepping::Rk4 { steps_per_sample }).remove(0).expect("flies");
        (4.0 * f64::from(steps_per_sample) * 30.0, apart(&truth, &exact))
    };
    [
        ("rk4", [2, 4, 8, 16, 32, 64, 128].map(fixed).to_vec()),
        // First stage same as last; the eighth-order method's dense output takes three more.
        ("dopri5", adaptive(Integrator::Dopri5, 6.0, &[1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12])),
        ("dop853", adaptive(Integrator::Dop853, 15.0, &[1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12])),
    ]
}

/// Slope of the logarithms by least squares, over errors that neither the first coarse steps nor the reference's rounding spoils.
fn slope(points: &[(f64, f64)]) -> f64 {
    let good: Vec<(f64, f64)> = points.iter().filter(|(_, e)| (2e-11..1e-3).contains(e)).map(|(n, e)| (n.ln(), e.ln())).collect();
    assert!(good.len() >= 4, "{points:?}");
    let mean = |f: fn(&(f64, f64)) -> f64| good.iter().map(f).sum::<f64>() / good.len() as f64;
    let (x, y) = (mean(|p| p.0), mean(|p| p.1));
    -good.iter().map(|p| (p.0 - x) * (p.1 - y)).sum::<f64>() / good.iter().map(|p| (p.0 - x).powi(2)).sum::<f64>()
}

#[test]
fn order_of_every_integrator() {
    let lines = lines();
    if std::env::var_os("WINDFALL_WRITE_REFERENCE").is_some() {
        let mut text = "scheme,work,error\n".to_owned();
        for (name, points) in &lines {
            points.iter().for_each(|(n, e)| writeln!(text, "{name},{n},{e:.3e}").expect("a string takes all"));
        }
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/studies/order-integrators.csv");
        std::fs::write(path, text).expect("the documentation can be written");
    }
    // Equal steps give the order itself; steps by tolerance vary along the flight, and samples are of dense output.
    for ((name, points), (order, within)) in lines.iter().zip([(4.0, 0.15), (5.0, 0.6), (8.0, 0.6)]) {
        let found = slope(points);
        println!("{name}: {found:.2}");
        assert!((found - order).abs() < within, "{name}: {found} for {order} from {points:?}");
    }
}
