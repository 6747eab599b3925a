//! sim benches: the lander that they fly, and its peer in C++. In: duration, rate, tolerance. Out: plants, flights, the peer's
//! best time, steps and states.

use std::path::{Path, PathBuf};
use std::process::Command;
use windfall_model::frames::EulerXyz;
use windfall_model::{Flight, Integrator, Numerics, Plant, Release, TunnelSpeed};
use windfall_sim::Truth;

/// The tests' lander.
#[path = "../../tests/it/sage.rs"]
mod sage;
pub(crate) use sage::lander as plant;

/// A perturbed release; the tunnel speed wanders as an operator's does (0.1 to 1 Hz, some 0.1 m/s).
pub(crate) fn flight(duration_s: f64, rate_hz: f64, method: Integrator, relative_tolerance: f64) -> Flight {
    let speed = |t: f64| 7.43 + 0.12 * (0.9 * t).sin() + 0.05 * (2.3 * t + 1.0).sin() + 0.02 * (6.1 * t).cos();
    Flight {
        name: "bench".into(),
        kind: "perturbed".into(),
        used: windfall_model::Use::Identify,
        duration_s,
        rate_hz,
        release: Release {
            position_m: [0.0; 3],
            velocity_m_s: [0.0; 3],
            attitude_rad: [0.0, 0.314, 0.305],
            rates_rad_s: [0.2, 0.4, 0.0],
        },
        speed: TunnelSpeed::History {
            interval_s: 1.0 / rate_hz,
            vw_m_s: (0..=(duration_s * rate_hz).round() as u32).map(|k| speed(f64::from(k) / rate_hz)).collect(),
        },
        ps_pa: 101_325.0,
        ts_k: 299.083_649,
        section: None,
        numerics: Numerics { method, relative_tolerance, absolute_tolerance: 0.01 * relative_tolerance },
        sensor_noise: false,
        pushes: Vec::new(),
        window_s: None,
    }
}

pub(crate) fn states(truth: &Truth) -> Vec<[f64; 13]> {
    (0..truth.len())
        .map(|k| {
            let (p, v, q, w) = (truth.p_tunnel_cm[k], truth.v_tunnel_cm[k], truth.quaternion[k], truth.w_tunnel_body[k]);
            [p[0], p[1], p[2], v[0], v[1], v[2], q[0], q[1], q[2], q[3], w[0], w[1], w[2]]
        })
        .collect()
}

pub(crate) fn distance(a: &[[f64; 13]], b: &[[f64; 13]]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().flatten().zip(b.iter().flatten()).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max)
}

/// The peer's input file.
fn peer_input(plant: &Plant, flight: &Flight) -> String {
    let (v, n) = (&plant.vehicle, &flight.numerics);
    let t = plant.tether.as_ref().expect("the bench's lander has a tether");
    let mut all = vec![n.relative_tolerance, n.absolute_tolerance, 1.0 / flight.rate_hz, v.mass_kg];
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

/// Processor time of this thread so far, s: what other work on the machine takes is not in it.
pub(crate) fn processor_s() -> f64 {
    let now = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
    now.tv_sec as f64 + 1e-9 * now.tv_nsec as f64
}

/// What the peer did.
pub(crate) struct PeerRun {
    /// Best processor time of a flight, s.
    pub(crate) best_s: f64,
    pub(crate) steps: u64,
    pub(crate) states: Vec<[f64; 13]>,
}

/// The peer, compiled into a folder of its own that goes with it.
pub(crate) struct Peer {
    folder: PathBuf,
}

impl Drop for Peer {
    fn drop(&mut self) {
        drop(std::fs::remove_dir_all(&self.folder));
    }
}

impl Peer {
    /// Compiles the peer with `-O3` and these flags; the reason in words when that is not possible.
    pub(crate) fn new(flags: &[&str]) -> Result<Self, String> {
        let folder = std::env::temp_dir().join(format!("windfall-peer-{}-{}", std::process::id(), flags.len()));
        std::fs::create_dir_all(&folder).map_err(|e| e.to_string())?;
        let peer = Self { folder };
        let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/peer/peer.cpp");
        let run = Command::new("g++")
            .args(["-std=c++17", "-O3"])
            .args(flags)
            .arg("-o")
            .arg(peer.folder.join("peer"))
            .arg(source)
            .output();
        match run {
            Err(e) => Err(format!("no g++ here ({e})")),
            Ok(o) if !o.status.success() => {
                let text = String::from_utf8_lossy(&o.stderr);
                Err(format!("g++ could not build it (are boost's headers here?): {}", text.lines().next().unwrap_or("")))
            }
            Ok(_) => Ok(peer),
        }
    }

    /// Flies `repetitions` times by `method` (dopri5, rk4, rk4-seen).
    pub(crate) fn fly(&self, plant: &Plant, flight: &Flight, repetitions: usize, method: &str) -> Result<PeerRun, String> {
        let (input, output) = (self.folder.join("input"), self.folder.join("states"));
        std::fs::write(&input, peer_input(plant, flight)).map_err(|e| e.to_string())?;
        let mut command = Command::new(self.folder.join("peer"));
        let run =
            command.arg(&input).arg(repetitions.to_string()).arg(&output).arg(method).output().map_err(|e| e.to_string())?;
        let text = String::from_utf8_lossy(&run.stdout).into_owned();
        let numbers: Vec<f64> = text.split_whitespace().filter_map(|x| x.parse().ok()).collect();
        let [best_ns, _, steps] = numbers[..] else { return Err(format!("it printed {text:?}")) };
        let states = std::fs::read_to_string(&output).map_err(|e| e.to_string())?;
        let rows = states.lines().map(|l| {
            let row: Vec<f64> = l.split_whitespace().filter_map(|x| x.parse().ok()).collect();
            row.try_into().map_err(|_| "a row of its states is not 13 numbers".to_owned())
        });
        let states = rows.collect::<Result<Vec<[f64; 13]>, String>>()?;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a count of steps")]
        Ok(PeerRun { best_s: best_ns * 1e-9, steps: steps as u64, states })
    }
}
