//! sim tests: flights of the lander and readers of shared data. In: nothing. Out: plants, flights, tables.

pub(crate) use crate::sage::lander;
use proptest::prelude::ProptestConfig;
use std::io::Write as _;
use std::path::PathBuf;
use windfall_model::{Flight, Inertia, Numerics, Plant, Release, TunnelSpeed};
use windfall_sim::{End, Seed, Truth, fly_truth};

/// Static pressure, Pa, and temperature, K, of the exact campaign: 1.1802 kg/m³.
pub(crate) const PS_PA: f64 = 101_325.0;
pub(crate) const TS_K: f64 = 299.083_649_392_031_6;
pub(crate) const DENSITY: f64 = PS_PA / (287.052_87 * TS_K);

/// The lander without air, tether and gravity.
pub(crate) fn torque_free(inertia: Inertia) -> Plant {
    let mut plant = lander();
    plant.vehicle.inertia = inertia;
    plant.tether = None;
    plant.aero.values.fill(0.0);
    plant.environment.gravity_m_s2 = 0.0;
    plant
}

/// A flight at constant tunnel speed.
pub(crate) fn flight(duration_s: f64, rate_hz: f64, vw_m_s: f64, release: Release) -> Flight {
    Flight {
        name: "test".into(),
        kind: "perturbed".into(),
        used: windfall_model::Use::Identify,
        duration_s,
        rate_hz,
        release,
        speed: TunnelSpeed::Constant(vw_m_s),
        ps_pa: PS_PA,
        ts_k: TS_K,
        section: None,
        numerics: Numerics::default(),
        sensor_noise: false,
        pushes: Vec::new(),
        window_s: None,
    }
}

/// At the tunnel's origin, at rest, upright.
pub(crate) const REST: Release =
    Release { position_m: [0.0; 3], velocity_m_s: [0.0; 3], attitude_rad: [0.0; 3], rates_rad_s: [0.0; 3] };

pub(crate) fn flown(plant: &Plant, flight: &Flight) -> Truth {
    let (truth, end) = fly_truth(plant, flight, Seed::default()).expect("flies");
    assert_eq!(end, End::Completed);
    truth
}

/// So many cases of a property, or as many as `PROPTEST_CASES` asks for.
pub(crate) fn cases(few: u32) -> ProptestConfig {
    if std::env::var_os("PROPTEST_CASES").is_some() { ProptestConfig::default() } else { ProptestConfig::with_cases(few) }
}

/// Folder of shared data, if there is one; otherwise says that the named test is skipped.
pub(crate) fn shared(test: &str) -> Option<PathBuf> {
    let root = std::env::var_os("WINDFALL_SHARED")
        .map_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../shared"), PathBuf::from);
    if root.is_dir() {
        return Some(root);
    }
    // Past the harness, which keeps to itself what a passing test prints.
    let _ = writeln!(std::io::stderr(), "skipped: {test}: no shared data");
    None
}

/// A numeric table: header and rows.
pub(crate) struct Table {
    header: Vec<String>,
    pub(crate) rows: Vec<Vec<f64>>,
}

impl Table {
    pub(crate) fn read(path: &std::path::Path) -> Self {
        Self::parse(&std::fs::read_to_string(path).expect("readable table"))
    }
    pub(crate) fn parse(text: &str) -> Self {
        let mut lines = text.lines().filter(|l| !l.starts_with('#'));
        let header = lines.next().expect("header").split(',').map(str::to_owned).collect();
        let rows = lines.map(|l| l.split(',').map(|x| x.parse().expect("number")).collect()).collect();
        Self { header, rows }
    }
    pub(crate) fn index(&self, name: &str) -> usize {
        self.header.iter().position(|h| h == name).expect("column")
    }
    pub(crate) fn column(&self, name: &str) -> Vec<f64> {
        let i = self.index(name);
        self.rows.iter().map(|r| r[i]).collect()
    }
    pub(crate) fn row<const N: usize>(&self, k: usize, names: [&str; N]) -> [f64; N] {
        names.map(|n| self.rows[k][self.index(n)])
    }
}

/// Largest difference of components.
pub(crate) fn worst(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(x, y)| (x - y).abs()).max_by(f64::total_cmp).unwrap_or(f64::NAN)
}

/// Angle between two attitudes given as quaternions, rad.
pub(crate) fn angle_between(a: [f64; 4], b: [f64; 4]) -> f64 {
    use windfall_model::frames::{Body, Rotation, Tunnel};
    let turn = |q| Rotation::<Tunnel, Body>::from_quaternion(q);
    turn(a).angle_to(turn(b))
}
