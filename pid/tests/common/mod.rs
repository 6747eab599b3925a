//! pid tests: the shared campaigns, read directly. In: a folder name. Out: a campaign, or nothing when the data are not there.
#![allow(dead_code, reason = "each test file uses its own part")]

use std::io::Write as _;
use std::path::{Path, PathBuf};
use windfall_model::frames::Vec3;
use windfall_model::{
    Aero, ApparentMass, Campaign, Data, Environment, Inertia, MeanFlow, Plant, PointMass, Record, Run, Sensors, Structure,
    Tether, Turbulence, Use, Vehicle, WakeShedding,
};
use windfall_pid::output_error::EstimateOptions;

/// All runs together only.
pub(crate) const COMBINED: EstimateOptions = EstimateOptions {
    handling: Vec::new(),
    priors: Vec::new(),
    angle_biases: false,
    iterations: 30,
    combined_only: true,
    compatibility: false,
    smoother: None,
    starting: false,
};

/// Table 5.5 with C_n's damping equal to C_m's, in the structure's order.
pub(crate) const TABLE_5_5: [f64; 11] =
    [6.662, 3.5129, -2.0035, 0.0125, -5.6816, -2.0655, 2.5278, -3.3025, -205.4289, -3.3025, -205.4289];
/// Noise of Table A.3 in channel order, m, rad, m/s.
pub(crate) const NOISE: [f64; 7] = [
    7.5e-4,
    7.5e-4,
    7.5e-4,
    0.0623 * std::f64::consts::PI / 180.0,
    0.110 * std::f64::consts::PI / 180.0,
    0.110 * std::f64::consts::PI / 180.0,
    2.57e-3,
];

/// The lander of the shared campaigns, with its declared starting values.
pub(crate) fn lander() -> Plant {
    Plant {
        vehicle: Vehicle {
            mass_kg: 0.7873,
            inertia: Inertia { xx: 0.02113, yy: 0.0138, zz: 0.01379, ..Inertia::default() },
            p_origin_cm: Vec3::zero(),
            diameter_m: 0.2125,
            apparent: ApparentMass::default(),
            loose: None,
        },
        aero: Aero::new(Structure::axisymmetric(), vec![6.6, 3.4, -1.5, 0.01, -5.0, -2.0, 2.0, -3.0, -150.0, -3.0, -150.0]),
        tether: Some(Tether::declared(Vec3::new(-0.25, 0.0, 0.0), Vec3::new(-3.0, 0.0, 0.0), 0.001_300_642_6, 0.016_458_42)),
        flow: MeanFlow::default(),
        turbulence: Turbulence::default(),
        shedding: WakeShedding::default(),
        drift: Default::default(),
        scatter: Default::default(),
        contacts: Vec::new(),
        environment: Environment { gravity_m_s2: 9.80665, gas_constant_j_kg_k: 287.052_87 },
        sensors: Sensors {
            position_std_m: NOISE[0],
            roll_std_rad: NOISE[3],
            pitch_yaw_std_rad: NOISE[4],
            wind_std_m_s: NOISE[6],
            ..Sensors::default()
        },
        point: PointMass::default(),
        free_flight: None,
    }
}

pub(crate) fn shared() -> PathBuf {
    std::env::var_os("WINDFALL_SHARED").map_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared"), PathBuf::from)
}

pub(crate) fn read_run(path: &Path) -> Option<Record> {
    let mut reader = csv::Reader::from_path(path).ok()?;
    let headers = reader.headers().ok()?.clone();
    let mut columns = vec![Vec::new(); headers.len()];
    for row in reader.records() {
        for (c, v) in columns.iter_mut().zip(row.ok()?.iter()) {
            c.push(v.parse::<f64>().ok()?);
        }
    }
    let mut take = |name: &str| headers.iter().position(|h| h == name).map(|i| std::mem::take(&mut columns[i]));
    let mut rad = |name: &str| Some(take(name)?.into_iter().map(f64::to_radians).collect::<Vec<_>>());
    let attitude_rad = [unwrap(rad("Rx_deg")?), rad("Ry_deg")?, rad("Rz_deg")?];
    Some(Record {
        t_s: take("t_s")?,
        position_m: [take("X_m")?, take("Y_m")?, take("Z_m")?],
        attitude_rad,
        vw_m_s: take("VW_m_s")?,
        ps_pa: take("ps_Pa")?,
        ts_k: take("Ts_K")?,
        qw_pa: take("qW_Pa"),
        ..Record::default()
    })
}

fn unwrap(mut x: Vec<f64>) -> Vec<f64> {
    for i in 1..x.len() {
        let turns = ((x[i] - x[i - 1]) / std::f64::consts::TAU).round();
        x[i] -= turns * std::f64::consts::TAU;
    }
    x
}

pub(crate) fn campaign_of(name: &str, runs: Vec<(String, String, Use, Record)>) -> Campaign {
    let plant = lander();
    Campaign {
        name: name.to_owned(),
        declared: vec![true; plant.aero.values.len()],
        plant,
        inputs: Vec::new(),
        runs: runs
            .into_iter()
            .map(|(name, kind, used, record)| Run {
                name,
                kind,
                used,
                inputs: Vec::new(),
                data: Data::Tunnel(record),
                notes: Vec::new(),
            })
            .collect(),
        knowledge: windfall_model::Knowledge::default(),
    }
}

/// A shared campaign: its runs as its own file uses them. `None`, in words, when the data are not there.
pub(crate) fn campaign(test: &str, name: &str) -> Option<Campaign> {
    let folder = shared().join("data/campaigns").join(name);
    let files: &[(&str, &str, Use)] = if name == "exact" {
        &[("run", "perturbed", Use::Identify)]
    } else {
        &[
            ("perturbed-1", "perturbed", Use::Identify),
            ("perturbed-2", "perturbed", Use::Identify),
            ("unperturbed-1", "unperturbed", Use::Identify),
            ("perturbed-3", "perturbed", Use::HoldOut),
            ("unperturbed-2", "unperturbed", Use::HoldOut),
        ]
    };
    let runs: Option<Vec<_>> = files
        .iter()
        .map(|(file, kind, used)| {
            let record = read_run(&folder.join(format!("{file}.csv")))?;
            Some(((*file).to_owned(), (*kind).to_owned(), *used, record))
        })
        .collect();
    if runs.is_none() {
        // Past the harness, which keeps to itself what a passing test prints.
        let _ = writeln!(std::io::stderr(), "skipped: {test}: no shared data");
    }
    Some(campaign_of(name, runs?))
}

/// Truth of a parameter of Table 5.5 by name.
pub(crate) fn truth(name: &str) -> f64 {
    TABLE_5_5[Structure::axisymmetric().index(name).expect("a name of the structure")]
}
