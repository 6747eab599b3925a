//! sim bench: a 15 s lander flight at 150 Hz, rtol 1e-9, recorded V_W, beside the same model on boost::odeint's dopri5.
//! In: nothing (a V_W history like an operator's is made here). Out: times, their ratio, and the achieved error of both.
//!
//! One thread each. What is not alike: boost's dopri5 tests the largest component of the error against `atol + rtol (|y| + h|ẏ|)`,
//! ours its mean square against `atol + rtol |y|`; the peer has the lander's formulas compiled in, ours reads them as data.

#![expect(clippy::print_stdout, reason = "a bench reports on the terminal")]

use criterion::{Criterion, criterion_group, criterion_main};
use std::hint::black_box;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;
use windfall_model::frames::{EulerXyz, Vec3};
use windfall_model::{
    Aero, Environment, Flight, Inertia, MeanFlow, Method, Numerics, Plant, PointMass, Release, Sensors, Structure, Tether,
    TunnelSpeed, Turbulence, Vehicle, WakeShedding,
};
use windfall_sim::{Seed, Truth, fly, fly_truth};

/// Flights per timing; the best of them counts, which other work on the machine disturbs least.
const REPETITIONS: usize = 400;
const INTERVAL_S: f64 = 1.0 / 150.0;

fn plant() -> Plant {
    let values = [6.6620, 3.5129, -2.0035, 0.0125, -5.6816, -2.0655, 2.5278, -3.3025, -205.4289, -3.3025, -205.4289];
    Plant {
        vehicle: Vehicle {
            mass_kg: 0.7873,
            inertia: Inertia { xx: 0.02113, yy: 0.0138, zz: 0.01379, ..Inertia::default() },
            p_origin_cm: Vec3::zero(),
            diameter_m: 0.2125,
            apparent: windfall_model::ApparentMass::default(),
            loose: None,
        },
        aero: Aero::new(Structure::axisymmetric(), values.to_vec()),
        tether: Some(Tether::declared(Vec3::new(-0.25, 0.0, 0.0), Vec3::new(-3.0, 0.0, 0.0), 0.001_300_642_6, 0.016_458_42)),
        flow: MeanFlow::default(),
        turbulence: Turbulence::default(),
        shedding: WakeShedding::default(),
        contacts: vec![],
        environment: Environment { gravity_m_s2: 9.80665, gas_constant_j_kg_k: 287.05287 },
        sensors: Sensors::default(),
        point: PointMass::default(),
    }
}

/// A perturbed release; the tunnel speed wanders as an operator's does (0.1 to 1 Hz, some 0.1 m/s).
fn flight(method: Method, relative_tolerance: f64) -> Flight {
    let speed = |t: f64| 7.43 + 0.12 * (0.9 * t).sin() + 0.05 * (2.3 * t + 1.0).sin() + 0.02 * (6.1 * t).cos();
    Flight {
        name: "bench".into(),
        kind: "perturbed".into(),
        hold_out: false,
        duration_s: 15.0,
        rate_hz: 150.0,
        release: Release {
            position_m: [0.0; 3],
            velocity_m_s: [0.0; 3],
            attitude_rad: [0.0, 0.314, 0.305],
            rates_rad_s: [0.2, 0.4, 0.0],
        },
        speed: TunnelSpeed::History {
            interval_s: INTERVAL_S,
            vw_m_s: (0..=2250).map(|k| speed(f64::from(k) * INTERVAL_S)).collect(),
        },
        ps_pa: 101_325.0,
        ts_k: 299.083_649,
        section: None,
        numerics: Numerics { method, relative_tolerance, absolute_tolerance: 0.01 * relative_tolerance },
        sensor_noise: false,
    }
}

fn states(truth: &Truth) -> Vec<[f64; 13]> {
    (0..truth.len())
        .map(|k| {
            let (p, v, q, w) = (truth.p_tunnel_cm[k], truth.v_tunnel_cm[k], truth.quaternion[k], truth.w_tunnel_body[k]);
            [p[0], p[1], p[2], v[0], v[1], v[2], q[0], q[1], q[2], q[3], w[0], w[1], w[2]]
        })
        .collect()
}

fn distance(a: &[[f64; 13]], b: &[[f64; 13]]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().flatten().zip(b.iter().flatten()).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max)
}

/// Best time of a flight, µs.
fn best_us(plant: &Plant, flight: &Flight) -> f64 {
    (0..REPETITIONS)
        .map(|_| {
            let start = Instant::now();
            black_box(fly_truth(black_box(plant), black_box(flight), Seed::default()).expect("flies"));
            start.elapsed().as_secs_f64() * 1e6
        })
        .fold(f64::INFINITY, f64::min)
}

/// The peer's input file.
fn peer_input(plant: &Plant, flight: &Flight) -> String {
    let (v, n) = (&plant.vehicle, &flight.numerics);
    let t = plant.tether.as_ref().expect("the bench's lander has a tether");
    let mut all = vec![n.relative_tolerance, n.absolute_tolerance, INTERVAL_S, v.mass_kg];
    all.extend([v.inertia.xx, v.inertia.yy, v.inertia.zz, v.diameter_m]);
    all.extend([t.p_origin_hook.x(), t.p_tunnel_ring.x(), t.drag_area_m2, t.weight_n, plant.environment.gravity_m_s2]);
    all.push(plant.environment.density_kg_m3(flight.ps_pa, flight.ts_k));
    all.extend(&plant.aero.values);
    let [rx_rad, ry_rad, rz_rad] = flight.release.attitude_rad;
    all.extend(flight.release.position_m.into_iter().chain(flight.release.velocity_m_s));
    all.extend(EulerXyz { rx_rad, ry_rad, rz_rad }.r_tunnel_body().to_quaternion());
    all.extend(flight.release.rates_rad_s);
    if let TunnelSpeed::History { vw_m_s, .. } = &flight.speed {
        all.push(vw_m_s.len() as f64);
        all.extend(vw_m_s);
    }
    all.iter().map(|x| format!("{x:e}\n")).collect()
}

/// Compiles the peer; the reason in words when that is not possible.
fn build_peer(folder: &Path) -> Result<PathBuf, String> {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/peer/peer.cpp");
    let program = folder.join("windfall-peer");
    let run = Command::new("g++").args(["-std=c++17", "-O3", "-o"]).arg(&program).arg(source).output();
    match run {
        Err(e) => Err(format!("no g++ here ({e})")),
        Ok(o) if !o.status.success() => {
            let text = String::from_utf8_lossy(&o.stderr);
            Err(format!("g++ could not build it (are boost's headers here?): {}", text.lines().next().unwrap_or("")))
        }
        Ok(_) => Ok(program),
    }
}

/// Best time (µs), steps and states of the peer.
fn peer(plant: &Plant, flight: &Flight) -> Result<(f64, u64, Vec<[f64; 13]>), String> {
    let folder = std::env::temp_dir().join(format!("windfall-peer-{}", std::process::id()));
    std::fs::create_dir_all(&folder).map_err(|e| e.to_string())?;
    let program = build_peer(&folder)?;
    let (input, output) = (folder.join("input"), folder.join("states"));
    std::fs::write(&input, peer_input(plant, flight)).map_err(|e| e.to_string())?;
    let run = Command::new(program).arg(&input).arg(REPETITIONS.to_string()).arg(&output).output().map_err(|e| e.to_string())?;
    let text = String::from_utf8_lossy(&run.stdout).into_owned();
    let numbers: Vec<f64> = text.split_whitespace().filter_map(|x| x.parse().ok()).collect();
    let [best_ns, _, steps] = numbers[..] else { return Err(format!("it printed {text:?}")) };
    let states = std::fs::read_to_string(&output).map_err(|e| e.to_string())?;
    let rows = states.lines().map(|l| {
        let row: Vec<f64> = l.split_whitespace().filter_map(|x| x.parse().ok()).collect();
        row.try_into().map_err(|_| "a row of its states is not 13 numbers".to_owned())
    });
    let rows = rows.collect::<Result<Vec<[f64; 13]>, String>>();
    std::fs::remove_dir_all(&folder).map_err(|e| e.to_string())?;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a count of steps")]
    Ok((best_ns * 1e-3, steps as u64, rows?))
}

fn compare() {
    let plant = plant();
    let reference = states(&fly_truth(&plant, &flight(Method::Dop853, 1e-13), Seed::default()).expect("flies").0);
    let orders = [Method::Dop853, Method::Dopri5].map(|m| flight(m, 1e-9));
    println!("15 s lander flight, 150 Hz, rtol 1e-9, atol 1e-11, recorded V_W; best of {REPETITIONS} flights");
    let times = orders.each_ref().map(|order| {
        let flown = fly(&plant, order, Seed::default()).expect("flies");
        let (us, far) = (best_us(&plant, order), distance(&states(&flown.truth), &reference));
        println!("ours  {:?}: {us:8.1} us, {:5} steps, largest error {far:.1e}", order.numerics.method, flown.steps);
        us
    });
    match peer(&plant, &orders[1]) {
        Ok((us, steps, rows)) => {
            println!("peer  boost dopri5: {us:8.1} us, {steps:5} steps, largest error {:.1e}", distance(&rows, &reference));
            println!("ratio ours/peer: {:.2} (Dop853, the default), {:.2} (Dopri5); target 1.0", times[0] / us, times[1] / us);
        }
        Err(why) => println!("peer  skipped: {why}"),
    }
}

fn flights(c: &mut Criterion) {
    compare();
    let plant = plant();
    for method in [Method::Dop853, Method::Dopri5] {
        let order = flight(method, 1e-9);
        c.bench_function(&format!("fly_truth 15 s, 150 Hz, rtol 1e-9, {method:?}"), |b| {
            b.iter(|| fly_truth(black_box(&plant), black_box(&order), Seed::default()).expect("flies"));
        });
    }
}

criterion_group!(benches, flights);
criterion_main!(benches);
