//! The simulator against a record of a third one: `exact` of the shared campaigns, when its folder is named.

use crate::air::Track;
use crate::algebra::{V, angles, attitude};
use crate::craft::Craft;
use crate::flight::{Flown, Plan, STEEP, apart, fly};
use crate::knobs::Knobs;
use crate::motion::{Drive, World};
use std::io::Write as _;
use std::path::{Path, PathBuf};

/// The folder of that record; where the shared data are not, none, and a line that says it is skipped.
fn shared() -> Option<PathBuf> {
    let here = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared");
    let root = std::env::var_os("WINDFALL_SHARED").map_or_else(here, PathBuf::from);
    let folder = root.join("data/campaigns/exact");
    if folder.is_dir() {
        return Some(folder);
    }
    // Past the harness, which keeps to itself what a passing test prints.
    let _ = writeln!(std::io::stderr(), "skipped: pub_exact_record_is_met: no shared data");
    None
}

fn columns(text: &str) -> Vec<Vec<f64>> {
    text.lines().skip(1).map(|l| l.split(',').map(|n| n.parse().expect("a number")).collect()).collect()
}

/// A 15 s flight from 25° with the numbers of the thesis' Table 5.5, as another simulator flew it to 15 digits: the same tunnel
/// speed gives the same record.
#[test]
fn pub_exact_record_is_met() {
    let Some(folder) = shared() else { return };
    let rows = columns(&std::fs::read_to_string(folder.join("run.csv")).expect("run.csv"));
    let states = columns(&std::fs::read_to_string(folder.join("states.csv")).expect("states.csv"));
    let s = &states[0];
    let start: [V; 4] = [
        [s[1], s[2], s[3]],
        [rows[0][4], rows[0][5], rows[0][6]].map(f64::to_radians),
        [s[4], s[5], s[6]],
        [s[11], s[12], s[13]],
    ];
    let (craft, knobs) = (Craft::sage(), Knobs::default());
    let drive = Drive::Given(Track::new(0.0, 1.0 / 150.0, rows.iter().map(|r| r[9]).collect()));
    let world = World::new(&craft, &knobs, craft.trim(), drive, 1.0);
    let plan = Plan {
        name: "exact".to_owned(),
        kind: "perturbed",
        hold_out: false,
        duration: 15.0,
        rate_hz: 150.0,
        start,
        size: 1.0,
        steep: STEEP,
    };
    let flown: Flown = fly(&world, &plan, 0.0).expect("it flies");
    let worst = rows.iter().enumerate().fold((0.0_f64, 0.0_f64), |worst, (k, row)| {
        let s = flown.sample(k);
        let read = attitude([row[4], row[5], row[6]].map(f64::to_radians));
        let (x, turn) = apart((s.x, &s.r), ([row[1], row[2], row[3]], &read));
        (worst.0.max(x), worst.1.max(turn))
    });
    println!(
        "largest difference from the record: {:.2e} m, {:.2e} rad; end angles {:?}",
        worst.0,
        worst.1,
        angles(&flown.sample(2250).r)
    );
    // Tunnel speed between samples is interpolated, to 1e-7 m/s.
    assert!(worst.0 < 1e-6 && worst.1 < 1e-6, "{worst:?}");
}
