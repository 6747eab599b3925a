//! scenarios: the shared campaigns and measured flights as they are. In: files of `../shared/data`. Out: read, and untouched.

use std::io::Write as _;
use std::path::{Path, PathBuf};
use windfall_model::{Data, Use};
use windfall_scenarios::{FileKind, kind_of, read_campaign, read_campaign_with_warnings};

fn shared(test: &str, below: &str) -> Option<PathBuf> {
    let root = std::env::var_os("WINDFALL_SHARED")
        .map_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared"), PathBuf::from);
    let path = root.join(below);
    if !path.exists() {
        // Past the harness, which keeps to itself what a passing test prints.
        let _ = writeln!(std::io::stderr(), "skipped: {test}: no shared data");
        return None;
    }
    Some(path)
}

fn campaigns_below(folder: &Path) -> Vec<PathBuf> {
    let mut all = Vec::new();
    for entry in std::fs::read_dir(folder).expect("a folder of campaigns").flatten() {
        let path = entry.path();
        if path.is_dir() {
            all.extend(campaigns_below(&path));
        } else if path.extension().is_some_and(|e| e == "toml") && matches!(kind_of(&path), Ok(FileKind::Campaign)) {
            all.push(path);
        }
    }
    all.sort();
    all
}

/// Gaussian noise exceeds six standard deviations once in 5e8 samples; the shared campaigns have 1e6. Real motion, perturbations of 25°
/// included, is smooth over ten neighbours. So nothing at all may be removed, bridged or split.
#[test]
fn law_clean_runs_pass_untouched() {
    let Some(root) = shared("law_clean_runs_pass_untouched", "data/campaigns") else { return };
    for file in campaigns_below(&root) {
        let (campaign, warnings) = read_campaign_with_warnings(&file).unwrap_or_else(|e| panic!("{}: {e}", file.display()));
        // One of them lacks a tenth of its rows, which is said of each channel and is no fault.
        let gaps = |w: &String| file.ends_with("foreign-05/campaign.toml") && w.contains("samples bridged");
        assert!(warnings.iter().all(gaps), "{}: {warnings:?}", file.display());
        assert!(!campaign.runs.is_empty());
    }
}

/// What the measured flights really hold: one launch in which all axes jump at t = 0.1558 s (51 mm in X between steps of 26 mm), one
/// more sample of it, and two last samples in which the ball has met something (1.27 m in a step between steps of 1.75 m).
#[test]
fn frozen_measured_flights_lose_six_values() {
    let Some(root) = shared("frozen_measured_flights_lose_six_values", "data/measured") else { return };
    let mut all: Vec<String> = ["ball-drops", "table-tennis"]
        .iter()
        .flat_map(|set| campaigns_below(&root.join(set)))
        .flat_map(|file| read_campaign_with_warnings(&file).unwrap_or_else(|e| panic!("{}: {e}", file.display())).1)
        .map(|note| note.split(" of ").next().unwrap_or("").to_owned())
        .collect();
    all.sort();
    let expected = [
        "backspin-04: X_m: spike",
        "backspin-04: X_m: spike",
        "backspin-04: Y_m: spike",
        "backspin-04: Z_m: spike",
        "bowling-ball-drop-2: Z_m: spike",
        "topspin-10: Z_m: spike",
    ];
    assert_eq!(all, expected);
}

#[test]
fn pub_open_00_is_read_as_its_files_say() {
    let Some(file) = shared("pub_open_00_is_read_as_its_files_say", "data/campaigns/open-00/campaign.toml") else { return };
    let campaign = read_campaign(&file).expect("the shared campaign is valid");
    let names: Vec<&str> = campaign.runs.iter().map(|r| r.name.as_str()).collect();
    assert_eq!(names, ["perturbed-1", "perturbed-2", "unperturbed-1", "perturbed-3", "unperturbed-2"]);
    assert_eq!(campaign.runs[3].used, Use::HoldOut);
    assert_eq!(campaign.declared, [true; 11]);
    let Data::Tunnel(record) = &campaign.runs[0].data else { panic!("a tunnel run") };
    assert_eq!(record.len(), 2251);
    // First row of the file; degrees to radians once. The products are exact to the last bits of one multiplication.
    assert!((record.position_m[1][0] - 0.060868).abs() < 1e-15);
    assert!((record.attitude_rad[0][0] - 50.70042_f64.to_radians()).abs() < 1e-15);
    assert!((record.vw_m_s[0] - 7.421867).abs() < 1e-15);
    assert!((record.interval_s() - 1.0 / 150.0).abs() < 1e-6, "printed times have six digits");
}

#[test]
fn pub_balls_fall_along_tunnel_x() {
    let Some(file) = shared("pub_balls_fall_along_tunnel_x", "data/measured/ball-drops/golf-ball.toml") else { return };
    let campaign = read_campaign(&file).expect("the shared campaign is valid");
    assert!(campaign.has_tracks());
    assert_eq!(campaign.declared, [false]);
    assert!((campaign.plant.point.air_density_kg_m3 - 1.19).abs() < 1e-15);
    let Data::Point(track) = &campaign.runs[0].data else { panic!("a track") };
    let x = track.position_m[0].as_ref().expect("the vertical axis");
    assert!(x[0] < -49.0 && x[x.len() - 1] > x[0] + 30.0, "down is positive");
    assert_eq!([&track.position_m[1], &track.position_m[2]], [&None, &None]);
}

#[test]
fn pub_launches_carry_their_inputs() {
    let Some(file) = shared("pub_launches_carry_their_inputs", "data/measured/table-tennis/campaign.toml") else { return };
    let campaign = read_campaign(&file).expect("the shared campaign is valid");
    assert_eq!(campaign.inputs, ["wheel_bottom", "wheel_top"]);
    assert_eq!(campaign.runs[0].inputs, [1200.0, 1200.0]);
}
