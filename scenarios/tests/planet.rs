//! scenarios: planet scenarios. In: those of the folder, and one with one thing wrong at a time. Out: read, written, read again; faults.

use std::path::{Path, PathBuf};
use windfall_model::planet::{Atmosphere, Gravity, Winds};
use windfall_scenarios::{
    BUNDLED_PLANETS, FileKind, kind_of, read_bundled, read_bundled_planet, read_planet, read_scenario_file, write_resolved_planet,
};

const GOOD: &str = r#"[scenario]
name = "test"

[vehicle]
mass_kg = 14.6
reference_diameter_m = 0.15
inertia_kg_m2 = { xx = 0.8, yy = 1.1, zz = 1.3, xy = 0.0, xz = 0.0, yz = 0.0 }

[environment]
gravity = "j2"
mu_m3_s2 = 3.986004418e14
equatorial_radius_m = 6378137.0
flattening = 0.0033528106647474805
j2 = 1.08262982e-3
rotation_rad_s = 7.292115e-5
atmosphere = { file = "air.csv" }
wind = { file = "wind.csv" }

[aero.point_mass]
CD = 0.1

[[flight]]
name = "drop"
duration_s = 30.0
rate_hz = 10.0

[flight.initial]
latitude_deg = 10.0
longitude_deg = -20.0
height_m = 9144.0
velocity_ned_m_s = [1.0, 2.0, 3.0]
attitude_ned_deg = [10.0, 20.0, 30.0]
rates_deg_s = [1.0, 2.0, 3.0]
"#;
const AIR: &str = "height_m,pressure_Pa,temperature_K,gas_constant_J_kg_K\n0,101325,288.15,287.05\n11000,22632,216.65,287.05\n";
const WIND: &str = "height_m,north_m_s,east_m_s\n0,0,-6\n12000,3,24\n";

struct Case(tempfile::TempDir);

impl Case {
    fn new(text: &str, air: &str, wind: &str) -> Self {
        let folder = tempfile::tempdir().expect("a temporary folder");
        for (name, text) in [("s.toml", text), ("air.csv", air), ("wind.csv", wind)] {
            std::fs::write(folder.path().join(name), text).expect("writable");
        }
        Self(folder)
    }
    fn path(&self) -> PathBuf {
        self.0.path().join("s.toml")
    }
    /// The message, which must be of one fault or more.
    fn fault(&self) -> String {
        let error = read_planet(&self.path()).expect_err("is wrong");
        assert!(!error.faults().is_empty(), "{error}");
        error.to_string()
    }
}

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("planet")
}

#[test]
fn law_planet_scenarios_of_the_folder_read_back_the_same() {
    let out = tempfile::tempdir().expect("a temporary folder");
    let mut read = 0;
    for entry in std::fs::read_dir(folder()).expect("there") {
        let path = entry.expect("readable").path();
        if !matches!(kind_of(&path), Ok(FileKind::Planet)) {
            continue;
        }
        let file = read_planet(&path).unwrap_or_else(|e| panic!("{e}"));
        let resolved = out.path().join("scenario.toml");
        write_resolved_planet(&resolved, &file).expect("writable");
        let again = read_planet(&resolved).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
        assert_eq!(again.scenario, file.scenario, "{}", path.display());
        read += 1;
    }
    assert!(read >= 7, "{read}");
}

#[test]
fn law_tables_and_kinds_are_read() {
    let case = Case::new(GOOD, AIR, WIND);
    let file = read_planet(&case.path()).unwrap_or_else(|e| panic!("{e}"));
    let planet = &file.scenario.planet;
    assert!(matches!(planet.atmosphere, Some(Atmosphere::Table(_))) && matches!(planet.wind, Winds::Table(_)));
    assert!(matches!(planet.gravity, Gravity::J2 { .. }) && file.scenario.body.point);
    assert_eq!(file.tables(), ["atmosphere.csv", "wind.csv"]);
    let resolved = case.0.path().join("r.toml");
    write_resolved_planet(&resolved, &file).expect("writable");
    let again = read_planet(&resolved).unwrap_or_else(|e| panic!("{e}"));
    // What a point mass does not have is not written.
    assert_eq!(again.scenario.planet, file.scenario.planet);
    assert!(again.scenario.flights[0].start.place == file.scenario.flights[0].start.place);
    // One flight may be a table, and only what planets have makes a planet scenario.
    let single = Case::new(&GOOD.replace("[[flight]]", "[flight]"), AIR, WIND);
    assert_eq!(read_planet(&single.path()).unwrap_or_else(|e| panic!("{e}")).scenario.flights.len(), 1);
    let message = read_scenario_file(&case.path()).expect_err("no tunnel").to_string();
    assert!(message.contains("planet scenario"), "{message}");
}

/// Each replacement makes one thing wrong; the message has the words and, where a key is wrong, its line.
#[test]
fn law_faults_are_named_by_file_line_and_key() {
    for (old, new, words) in [
        ("mu_m3_s2 = 3.986004418e14\n", "", "s.toml:9: [environment] mu_m3_s2: is missing; gravity = \"j2\" needs it"),
        ("flattening = 0.0033528106647474805\n", "", "[environment] flattening: is missing"),
        ("rotation_rad_s = 7.292115e-5\n", "", "[environment] rotation_rad_s: is missing"),
        ("gravity = \"j2\"", "gravity = \"central\"", "s.toml:14: [environment] j2: has no part in gravity = \"central\""),
        ("gravity = \"j2\"", "gravity = \"uniform\"", "[environment] gravity_m_s2: is missing"),
        (
            "gravity = \"j2\"",
            "gravity = \"j3\"",
            "s.toml:10: [environment] gravity = \"j3\": must be one of \"uniform\", \"central\", \"j2\"",
        ),
        ("equatorial_radius_m = 6378137.0", "equatorial_radius_km = 6378.0", "unknown key"),
        ("equatorial_radius_m = 6378137.0", "equatorial_radius_m = nan", "must be a finite number"),
        ("atmosphere = { file = \"air.csv\" }", "atmosphere = \"us-1962\"", "must be one of \"us-1976\", \"venus\", or a table"),
        ("air.csv", "none.csv", "none.csv"),
        ("wind = { file = \"wind.csv\" }", "wind = { north_m_s = 1.0 }", "[environment.wind] east_m_s: is missing"),
        ("wind = { file = \"wind.csv\" }", "wind = { file = \"wind.csv\", east_m_s = 1.0 }", "must be either a file or"),
        (
            "wind = { file = \"wind.csv\" }",
            "turbulence = { axial_rms_m_s = 0.1, axial_scale_m = 5.0, lateral_scale_m = 5.0 }",
            "[environment.turbulence] lateral_rms_m_s: is missing; turbulence without a file needs it",
        ),
        ("wind = { file = \"wind.csv\" }", "turbulence = { file = \"wind.csv\" }", "axial_rms_m_s: column is missing"),
        ("[[flight]]", "[uncertainty.initial]\nrates_deg_s = [1.0, 0.0, 0.0]\n[[flight]]", "is about a rigid body"),
        ("[[flight]]", "[uncertainty.initial]\nrates_deg_s = [-1.0, 0.0, 0.0]\n[[flight]]", "rates_deg_s"),
        ("height_m = 9144.0", "height_m = -1.0", "s.toml:30: [flight 1.initial] height_m = -1: is below the surface"),
        ("latitude_deg = 10.0", "latitude_deg = 90.1", "must be a finite number from -9e1 to 9e1 deg"),
        ("[aero.point_mass]", "[tether]\nring_m = [0.0, 0.0, 0.0]\n\n[aero.point_mass]", "bodies fly free over a planet"),
        ("[aero.point_mass]", "[section]\nradius_m = 1.0\n\n[aero.point_mass]", "unknown key"),
        ("rate_hz = 10.0", "rate_hz = 10.0\nsensor_noise = true", "there are no instruments over a planet"),
        ("reference_diameter_m = 0.15\n", "", "[vehicle] reference_area_m2: is missing"),
        ("[flight.initial]", "[flight.release]", "is missing (state at the first sample)"),
    ] {
        assert!(GOOD.contains(old), "{old}");
        let message = Case::new(&GOOD.replacen(old, new, 1), AIR, WIND).fault();
        assert!(message.contains(words), "{new}: {message}");
    }
    for (air, wind, words) in [
        (AIR.replace("11000", "0"), WIND.to_owned(), "air.csv:3: height_m = 0: must be above 0"),
        (AIR.replace("216.65", "-1"), WIND.to_owned(), "must be above zero"),
        (AIR.replace("pressure_Pa", "pressure"), WIND.to_owned(), "pressure_Pa: column is missing"),
        (AIR.to_owned(), WIND.replace("24", ""), "wind.csv:3: east_m_s"),
        (AIR.to_owned(), "height_m,north_m_s,east_m_s\n0,0,0\n".to_owned(), "must be two or more"),
    ] {
        let message = Case::new(GOOD, &air, &wind).fault();
        assert!(message.contains(words), "{message}");
    }
    // A rigid body needs what a point mass does not.
    let rigid = GOOD.replace("[aero.point_mass]\nCD = 0.1", "[aero.axisymmetric]");
    let message = Case::new(&rigid.replace("attitude_ned_deg = [10.0, 20.0, 30.0]\n", ""), AIR, WIND).fault();
    assert!(message.contains("[flight 1.initial] attitude_ned_deg: is missing; a rigid body needs it"), "{message}");
}

/// By name a bundled planet scenario is the file of the folder, its wind's table included; where tunnel scenarios are read the name is refused.
#[test]
fn law_bundled_planets_are_those_of_the_folder() {
    for name in BUNDLED_PLANETS {
        let bundled = read_bundled_planet(name).expect("well-formed").expect("bundled");
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("planet/{name}.toml"));
        let file = read_planet(&path).expect("well-formed");
        assert_eq!((bundled.scenario, bundled.input_hash), (file.scenario, file.input_hash), "{name}");
        assert!(read_bundled(name).is_err_and(|e| e.to_string().contains("planet scenario")), "{name}");
    }
    assert!(read_bundled_planet("venus").is_ok_and(|none| none.is_none()));
    assert!(read_bundled("venus").is_err_and(|e| e.to_string().contains("venus-descent")));
}
