//! scenarios tests: campaigns of bodies without attitude with air over height, drag over Mach number, recorded inputs, specific force and
//! pivots. In: files made here. Out: what was understood, or the fault.

use std::path::{Path, PathBuf};
use windfall_model::planet::Atmosphere;
use windfall_model::{Acts, Campaign, Data, Measured};
use windfall_scenarios::read_campaign;

fn folder(test: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(test);
    std::fs::create_dir_all(&folder).expect("the target folder can be written to");
    folder
}

fn put(folder: &Path, name: &str, text: &str) {
    std::fs::write(folder.join(name), text).expect("the folder was made");
}

/// Rows of a rise with a brake, of a specific force and of an angle.
fn rows(header: &str, row: impl Fn(f64) -> String) -> String {
    let lines: Vec<String> = (0..20).map(|i| row(0.1 * f64::from(i))).collect();
    format!("{header}\n{}\n", lines.join("\n"))
}

const ROCKET: &str = r#"
[campaign]
name = "rocket"
[vehicle]
mass_kg = 10.0
reference_diameter_m = 0.1
[axes]
down = "-Z"
[environment]
gravity_m_s2 = 9.81
atmosphere = "us-1976"
launch_height_m = 1000.0
[sensors]
position_std_m = 1.0
height = "pressure"
[aero.point_mass]
CD = { over = "mach", at = [0.0, 0.8, 1.0], values = [0.4, 0.5, 0.9] }
[[run]]
file = "up.csv"
kind = "coast"
use = "identify"
inputs = { brake = { column = "servo", zero = 30, one = 60 }, rail = 84 }
vehicle = { mass_kg = 12.0 }
environment = { launch_height_m = 0.0 }
aero = { CD = { over = "mach", file = "drag.csv" } }
"#;

fn rocket(test: &str, change: impl Fn(&str) -> String) -> Result<Campaign, String> {
    let folder = folder(test);
    put(
        &folder,
        "up.csv",
        &rows("t_s,Z_m,servo", |t| format!("{t},{},{}", 200.0 * t - 5.0 * t * t, if t < 1.0 { 30 } else { 45 })),
    );
    put(&folder, "drag.csv", "mach,CD\n0.0,0.3\n1.0,0.7\n");
    put(&folder, "campaign.toml", &change(ROCKET));
    read_campaign(&folder.join("campaign.toml")).map_err(|e| e.to_string())
}

#[test]
fn law_a_rocket_is_read_as_it_was_written() {
    let c = rocket("rocket", str::to_owned).expect("well-formed");
    assert_eq!((c.body(), c.measured(), c.declared.as_slice()), (Acts::Altimeter, Measured::Position, &[true][..]));
    assert_eq!((c.plant.aero.structure.parameters[0].as_str(), c.plant.aero.values[0]), ("CD_scale", 1.0));
    let there = Atmosphere::Us1976.at(1000.0).density_kg_m3();
    assert!((c.plant.point.air_density_kg_m3 / there - 1.0).abs() < 1e-12);
    assert_eq!(c.inputs, ["brake", "rail"]);
    let Data::Point(record) = &c.runs[0].data else { panic!("a track") };
    let (place, brake) = &record.recorded_inputs[0];
    assert_eq!((*place, brake[0], brake[19]), (0, 0.0, 0.5));
    let own = c.plant_for(&c.plant, 0);
    assert!((own.vehicle.mass_kg - 12.0).abs() < 1e-12 && own.point.launch_height_m.abs() < 1e-12);
    // Its own launch height and no density: the atmosphere's at that height.
    assert!((own.point.air_density_kg_m3 / Atmosphere::Us1976.at(0.0).density_kg_m3() - 1.0).abs() < 1e-12);
    let table = own.point.drag_over_mach.as_ref().expect("a table");
    assert!((table.value(0.5) - 0.5).abs() < 1e-12 && (table.value(2.0) - 0.7).abs() < 1e-12);
}

#[test]
fn law_a_prior_of_the_drag_is_an_uncertain_constant() {
    let c = rocket("prior", |t| format!("{t}\n[uncertainty.aero.point_mass]\nCD_scale = 0.05\n")).expect("well-formed");
    assert_eq!((c.declared.as_slice(), c.plant.aero.values[0]), (&[false][..], 1.0));
    assert_eq!(c.knowledge.constants[0].name(), "aero.point_mass.CD_scale");
}

#[test]
fn law_faults_say_what_is_missing() {
    for (name, from, to, word) in [
        ("no-air", "atmosphere = \"us-1976\"\nlaunch_height_m = 1000.0\n", "", "air_density_kg_m3"),
        ("no-sound", "atmosphere = \"us-1976\"\nlaunch_height_m = 1000.0\n", "air_density_kg_m3 = 1.2\n", "speed of sound"),
        ("no-column", "column = \"servo\"", "column = \"flap\"", "flap"),
        ("descends", "at = [0.0, 0.8, 1.0]", "at = [0.0, 0.8, 0.8]", "ascend"),
        ("variable", "{ over = \"mach\", at", "{ over = \"height\", at", "mach"),
        ("two-sensors", "position_std_m = 1.0", "position_std_m = 1.0\nangle_std_deg = 1.0", "or the first two"),
        ("same-ends", "zero = 30, one = 60", "zero = 30, one = 30", "must differ"),
        ("negative-mass", "mass_kg = 12.0", "mass_kg = -12.0", "mass_kg"),
        ("pivot", "[sensors]", "[pivot]\narm_m = 0.1\ninertia_kg_m2 = 0.0\nviscous_n_m_s = 0.0\n[sensors]", "pivot"),
    ] {
        let e = rocket(name, |t| t.replace(from, to)).expect_err(name);
        assert!(e.contains(word), "{name}: {e}");
    }
}

/// A run that lacks another's input says so; of a hundred and one inputs that no run shares the number is said, not each that each lacks.
#[test]
fn law_inputs_have_a_limit() {
    let runs = |count: usize| -> String {
        let one = |i: usize| format!("[[run]]\nfile = \"up.csv\"\nwindow_s = [0.0, {}.0]\ninputs = {{ a{i} = 1 }}\n", i + 2);
        (0..count).map(one).collect()
    };
    let e = rocket("lacking", |t| t.to_owned() + &runs(2)).expect_err("a0 alone");
    assert!(e.contains("a1, brake, rail: lacks inputs that other runs have"), "{e}");
    let e = rocket("too-many", |t| t.to_owned() + &runs(99)).expect_err("101 inputs");
    assert!(e.contains("[[run]] inputs = 101: at most 100 are read from one file") && !e.contains("lacks"), "{e}");
}

#[test]
fn law_specific_force_and_angle_are_read_in_our_units() {
    let folder = folder("sensors");
    put(&folder, "fall.csv", &rows("t_s,acc", |t| format!("{t},{}", 0.01 * t)));
    put(&folder, "swing.csv", &rows("t_s,angle_deg", |t| format!("{t},{}", 90.0 * (6.0 * t).cos())));
    let head = "[campaign]\nname = \"b\"\n[vehicle]\nmass_kg = 0.2\nreference_diameter_m = 0.1\n[environment]\ngravity_m_s2 = 9.81\n\
                air_density_kg_m3 = 1.2\n[aero.point_mass]\nCD = 0.0\ndeclared = []\n";
    let fall = "[axes]\ndown = \"-Z\"\n[sensors]\nspecific_force_std_m_s2 = 0.02\n[columns]\nfZ_m_s2 = { name = \"acc\", unit = \"g\" }\n\
                [[run]]\nfile = \"fall.csv\"\nkind = \"drop\"\nuse = \"identify\"\n";
    put(&folder, "fall.toml", &format!("{head}{fall}"));
    let c = read_campaign(&folder.join("fall.toml")).expect("well-formed");
    let Data::Point(record) = &c.runs[0].data else { panic!("a track") };
    // Down is tunnel X: the file's upward force is negative there.
    let last = record.series()[0].as_ref().expect("measured")[19];
    assert!((last + 0.019 * 9.80665).abs() < 1e-12 && record.measured == Measured::SpecificForce, "{last}");
    let swing = "[pivot]\narm_m = 0.1\ninertia_kg_m2 = 0.0\nviscous_n_m_s = 1e-4\n[sensors]\nangle_std_deg = 0.01\n\
                 [[run]]\nfile = \"swing.csv\"\nkind = \"swing\"\nuse = \"identify\"\nrecording = \"A\"\n";
    put(&folder, "swing.toml", &format!("{head}{swing}"));
    let c = read_campaign(&folder.join("swing.toml")).expect("well-formed");
    let Data::Point(record) = &c.runs[0].data else { panic!("a track") };
    assert!((record.series()[0].as_ref().expect("measured")[0] - std::f64::consts::FRAC_PI_2).abs() < 1e-12);
    assert_eq!((c.body(), record.recording.as_deref()), (Acts::Pivot, Some("A")));
}

/// An accelerometer beside an altimeter: its component along a direction that is not one of its axes, upward positive.
#[test]
fn law_height_and_specific_force_are_read_together() {
    let sensors = "position_std_m = 1.0\nspecific_force_std_m_s2 = 0.2";
    let columns =
        "[columns]\nfZ_m_s2 = { names = [\"servo\", \"Z_m\", \"t_s\"], along = [0.0, 3.0, 4.0], unit = \"g\" }\n[[run]]";
    // A column that [columns] reads is no input any more.
    let constant = |t: &str| t.replace("{ column = \"servo\", zero = 30, one = 60 }", "0.5");
    let both = |t: &str| constant(t).replace("position_std_m = 1.0", sensors).replacen("[[run]]", columns, 1);
    // The same columns stand for other things here, so that the table must say so.
    let c = rocket("both", |t| both(t).replace("[columns]", "[columns]\nt_s = \"t_s\"\nZ_m = \"Z_m\"")).expect("well-formed");
    assert_eq!((c.body(), c.measured()), (Acts::Altimeter, Measured::PositionAndForce));
    let Data::Point(record) = &c.runs[0].data else { panic!("a track") };
    let (t, z) = (1.9, 200.0 * 1.9 - 5.0 * 1.9 * 1.9);
    let force = record.specific_force_m_s2[0].as_ref().expect("measured")[19];
    assert!((force + 9.80665 * (0.6 * z + 0.8 * t)).abs() < 1e-9, "{force}");
    assert_eq!(record.channel(3).map(<[f64]>::len), Some(20));
    for (name, from, to, word) in [
        ("no-force", "fZ_m_s2 = {", "fY_m_s2 = {", "fZ_m_s2"),
        ("no-direction", "along = [0.0, 3.0, 4.0]", "along = [0.0, 0.0, 0.0]", "not zero"),
        ("no-names", "names = [\"servo\", \"Z_m\", \"t_s\"], ", "", "names"),
        ("no-place", "[columns]", "[columns]\nfX_m_s2 = \"servo\"", "stands without X_m"),
    ] {
        let e = rocket(name, |t| both(t).replace("[columns]", "[columns]\nt_s = \"t_s\"\nZ_m = \"Z_m\"").replace(from, to));
        assert!(e.as_ref().is_err_and(|e| e.contains(word)), "{name}: {e:?}");
    }
}
