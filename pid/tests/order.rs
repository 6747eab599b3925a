//! pid tests: the order of each smoother in its values and derivatives. In: a sine without noise. Out: slopes of error over the smoother's
//! interval; with `WINDFALL_WRITE_REFERENCE` the points of the diagram.

#![expect(clippy::print_stdout, reason = "a test prints what it measured")]

use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::path::Path;
use windfall_model::Record;
use windfall_pid::smooth::{Smoother, smooth};

/// One turn a second: windows of up to 0.2 s are short beside it.
fn wave(t: f64) -> [f64; 3] {
    let (sin, cos) = (TAU * t + 0.3).sin_cos();
    [sin, TAU * cos, -TAU * TAU * sin]
}

/// Largest errors of value, rate and second derivative over 4 s, ends included.
fn errors(smoother: &Smoother, rate_hz: f64) -> [f64; 3] {
    let n = (4.0 * rate_hz).round();
    let t_s: Vec<f64> = (0..).map(f64::from).take_while(|i| *i <= n).map(|i| i / rate_hz).collect();
    let x: Vec<f64> = t_s.iter().map(|t| wave(*t)[0]).collect();
    let three = || [x.clone(), x.clone(), x.clone()];
    let record = Record {
        position_m: three(),
        attitude_rad: three(),
        vw_m_s: x.clone(),
        ps_pa: vec![101_325.0; x.len()],
        ts_k: vec![290.0; x.len()],
        t_s: t_s.clone(),
        ..Record::default()
    };
    let smoothed = smooth(&record, smoother).expect("a good record");
    let c = &smoothed.channels[0];
    let far = |found: &[f64], k: usize| {
        found.iter().zip(&t_s).map(|(f, t)| (f - wave(*t)[k]).abs()).max_by(f64::total_cmp).unwrap_or(f64::NAN)
    };
    [far(&c.value, 0), far(&c.rate, 1), far(&c.second, 2)]
}

/// A scheme, its intervals in seconds, and the errors at each.
type Line = (&'static str, Vec<(f64, [f64; 3])>);

fn lines() -> [Line; 3] {
    // Ten samples an interval, whatever the interval: else the ends change with it.
    let local = |h: f64| (h, errors(&Smoother::Local { half_width_s: [h; 7], degree: 4 }, 10.0 / h));
    let spline = |h: f64| (h, errors(&Smoother::Spline { knot_s: h }, 10.0 / h));
    let series = |rate_hz: f64| (1.0 / rate_hz, errors(&Smoother::Thesis { cutoffs_hz: [f64::INFINITY; 7] }, rate_hz));
    [
        ("spline", [0.025, 0.05, 0.1].map(spline).to_vec()),
        ("local polynomial of degree 4", [0.025, 0.05, 0.1].map(local).to_vec()),
        ("Fourier series of the thesis", [50.0, 100.0, 200.0, 400.0].map(series).to_vec()),
    ]
}

/// Slope of the logarithms by least squares.
fn slope(points: &[(f64, f64)]) -> f64 {
    let logs: Vec<(f64, f64)> = points.iter().map(|(h, e)| (h.ln(), e.ln())).collect();
    let mean = |f: fn(&(f64, f64)) -> f64| logs.iter().map(f).sum::<f64>() / logs.len() as f64;
    let (x, y) = (mean(|p| p.0), mean(|p| p.1));
    logs.iter().map(|p| (p.0 - x) * (p.1 - y)).sum::<f64>() / logs.iter().map(|p| (p.0 - x).powi(2)).sum::<f64>()
}

#[test]
fn order_of_every_smoother_and_its_derivatives() {
    let lines = lines();
    if std::env::var_os("WINDFALL_WRITE_REFERENCE").is_some() {
        let mut text = "scheme,interval_s,value,rate,second\n".to_owned();
        for (name, points) in &lines {
            points
                .iter()
                .for_each(|(h, [v, r, s])| writeln!(text, "{name},{h},{v:.3e},{r:.3e},{s:.3e}").expect("a string takes all"));
        }
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/studies/order-smoothers.csv");
        std::fs::write(path, text).expect("the documentation can be written");
    }
    // A spline of degree seven; a polynomial of degree four that stands to one side at the ends; a series that is exact in the samples, and
    // whose odd reflection has no curvature at the ends, so that its second derivative does not converge there.
    let expected = [[Some(8.0), Some(7.0), Some(6.0)], [Some(5.0), Some(4.0), Some(3.0)], [None, Some(1.0), Some(0.0)]];
    for (((name, points), orders), within) in lines.iter().zip(expected).zip([0.8, 0.15, 0.05]) {
        for (k, order) in orders.into_iter().enumerate() {
            let line: Vec<(f64, f64)> = points.iter().map(|(h, e)| (*h, e[k])).collect();
            let Some(order) = order else {
                assert!(line.iter().all(|(_, e)| *e < 1e-13), "{name}: {line:?}");
                continue;
            };
            let found = slope(&line);
            println!("{name}, derivative {k}: {found:.2}");
            assert!((found - order).abs() < within, "{name}, derivative {k}: {found} for {order} from {line:?}");
        }
    }
}
