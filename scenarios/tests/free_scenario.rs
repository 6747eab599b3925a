//! scenarios tests: scenarios of rigid bodies in free flight. In: the bundled one, one as written by hand. Out: read, written, read again the same; faults.

use std::path::Path;
use windfall_model::{Data, Measured, Setting};
use windfall_scenarios::{
    BUNDLED_FREE, FileKind, FreeFile, RunLine, kind_of, read_bundled_free, read_campaign, read_free, write_columns_csv,
    write_free_campaign, write_resolved_free,
};

const BLIMP: &str = r#"seed = 4
[scenario]
name = "blimp"
[vehicle]
mass_kg = 0.1
center_of_mass_m = [0.0, 0.0, 0.01]
reference_diameter_m = 1.0
inertia_kg_m2 = { xx = 0.02, yy = 0.015, zz = 0.01, xy = 0.0, xz = 0.0, yz = 0.0 }
[free_flight]
reference_area_m2 = 0.25
coefficient_axes = "body"
coefficients = "held"
buoyancy_kg = 0.09
center_of_buoyancy_m = [0.0, 0.0, 0.0]
rate_damping_n_m_s = [-0.05, -0.03, -0.01]
[[part]]
mass_kg = 0.05
place_m = ["slide_m", 0.0, 0.2]
[[thrust]]
size_n = "thrust_n"
direction = [2.0, 0.0, 0.0]
place_m = [0.0, 0.1, 0.2]
[environment]
gravity_m_s2 = 9.8
air_density_kg_m3 = 1.2
[sensors]
position_std_m = 0.002
roll_std_deg = 0.2
pitch_yaw_std_deg = 0.3
[uncertainty.free_flight]
buoyancy_kg = 0.001
[aero.hull]
structure = "hull.toml"
CD = 0.3
[effects.buoyancy]
fraction = -0.02
[[flight]]
name = "one"
kind = "glide"
use = "identify"
duration_s = 2.0
rate_hz = 50.0
sensor_noise = true
inputs = { thrust_n = 0.02, slide_m = 0.07 }
release = { position_m = [0.0, 1.0, 2.0], velocity_body_m_s = [0.5, 0.0, 0.1], attitude_level_deg = [1.0, -2.0, 170.0], rates_deg_s = [0.0, 3.0, 0.0] }
[[flight]]
name = "two"
kind = "glide"
use = "hold-out"
duration_s = 2.0
rate_hz = 50.0
sensor_noise = false
inputs = { slide_m = 0.05, thrust_n = 0.0 }
release = { position_m = [0.0, 0.0, 0.0], velocity_body_m_s = [0.6, 0.0, 0.0], attitude_level_deg = [0.0, 0.0, 0.0], rates_deg_s = [0.0, 0.0, 0.0] }
"#;
const HULL: &str = "parameters = [\"CD\"]\n[[term]]\ncoefficient = \"CA\"\nparameter = \"CD\"\nscale = 1.0\nfactors = []\n";

fn written(folder: &Path, text: &str) -> Result<FreeFile, String> {
    std::fs::write(folder.join("hull.toml"), HULL).expect("writable");
    let path = folder.join("blimp.toml");
    std::fs::write(&path, text).expect("writable");
    assert_eq!(kind_of(&path).expect("TOML"), FileKind::FreeFlight);
    read_free(&path).map_err(|e| e.to_string())
}

/// Resolved, a scenario is the same; its campaign declares the plant without the effects, with the settings of each run, and reads
/// records in its own columns.
#[test]
fn law_scenarios_and_their_campaigns_read_back_the_same() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut all = vec![written(folder.path(), BLIMP).expect("well-formed")];
    all.extend(BUNDLED_FREE.map(|name| read_bundled_free(name).expect("well-formed").expect("bundled")));
    for file in all {
        let own = folder.path().join(&file.name);
        std::fs::create_dir(&own).expect("writable");
        write_resolved_free(&own.join("scenario.toml"), &file).expect("writable");
        let again = read_free(&own.join("scenario.toml")).unwrap_or_else(|e| panic!("{}: {e}", file.name));
        let same = FreeFile { input: again.input.clone(), input_hash: again.input_hash.clone(), ..file.clone() };
        // By their text: what a campaign does not say is not a number.
        assert_eq!(format!("{again:?}"), format!("{same:?}"));
        assert_ne!(file.plant, file.declared_plant);
        let lines: Vec<RunLine> = file
            .flights
            .iter()
            .map(|f| RunLine { file: format!("{}.csv", f.name), kind: f.kind.clone(), used: f.used, window_s: None })
            .collect();
        let (t, zero, one): (Vec<f64>, _, _) = ((0..20).map(|i| 0.02 * f64::from(i)).collect(), vec![0.0; 20], vec![1.0; 20]);
        for line in &lines {
            let columns: [(&str, &[f64]); 8] = [
                ("t_s", &t),
                ("X_m", &zero),
                ("Y_m", &t),
                ("Z_m", &zero),
                ("q_w", &one),
                ("q_x", &zero),
                ("q_y", &zero),
                ("q_z", &zero),
            ];
            write_columns_csv(&own.join(&line.file), &columns).expect("writable");
        }
        write_free_campaign(&own.join("campaign.toml"), &file, &lines).expect("writable");
        let campaign = read_campaign(&own.join("campaign.toml")).unwrap_or_else(|e| panic!("{}: {e}", file.name));
        assert_eq!(format!("{:?}", campaign.plant), format!("{:?}", file.declared_plant));
        assert_eq!(campaign.inputs, file.inputs);
        for (run, f) in campaign.runs.iter().zip(&file.flights) {
            let Data::Point(track) = &run.data else { panic!("a track") };
            assert_eq!((run.used, &run.inputs, track.measured), (f.used, &f.inputs, Measured::Pose));
        }
    }
}

/// Settings go by their names, sorted, whatever their order in a flight.
#[test]
fn exact_settings_of_a_flight() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = written(folder.path(), BLIMP).expect("well-formed");
    assert_eq!(file.inputs, ["slide_m", "thrust_n"]);
    assert_eq!((&file.flights[0].inputs[..], &file.flights[1].inputs[..]), (&[0.07, 0.02][..], &[0.05, 0.0][..]));
    let free = file.plant.free_flight.expect("free");
    assert_eq!((free.parts[0].place_m[0], free.thrusts[0].size_n), (Setting::Input(0), Setting::Input(1)));
    assert!((free.buoyancy_kg - 0.98 * 0.09).abs() < 1e-15);
}

/// What is wrong is named by key.
#[test]
fn law_faults_are_named() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for (from, to, word) in [
        ("thrust_n = 0.0 }", "push_n = 0.0 }", "inputs"),
        ("slide_m = 0.05", "slide_m = nan", "inputs"),
        ("fraction = -0.02", "fraction = -2.0", "fraction"),
        ("rate_hz = 50.0\nsensor_noise = false", "rate_hz = 1e9\nsensor_noise = false", "rate_hz"),
        ("name = \"two\"", "name = \"one\"", "appears twice"),
        ("[effects.buoyancy]\nfraction", "[effects.loose-mass]\nmass_kg", "loose-mass"),
        ("seed = 4", "seed = 4\ntether = 1", "tether"),
        ("[environment]", "[pivot]\narm_m = 1.0\n[environment]", "pivot"),
        ("[environment]", "[axes]\ndown = \"-Z\"\n[environment]", "axes"),
    ] {
        let told = written(folder.path(), &BLIMP.replace(from, to)).expect_err(to);
        assert!(told.contains(word), "{to}: {told}");
    }
}
