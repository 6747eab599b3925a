//! scenarios tests: first campaigns of run files. In: records as laboratories write them. Out: drafts that load once what is `nan` is filled
//! in, with every column read or named.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use windfall_model::{Acts, Data, Measured, Use};
use windfall_scenarios::{DraftKind, draft_campaign, read_campaign_with_warnings};

/// Values for what a draft leaves open: those of a small model on a tether, or of a ball.
const FILLED: [(&str, &str); 12] = [
    ("mass_kg", "0.7873"),
    ("inertia_kg_m2", "{ xx = 0.02113, yy = 0.0138, zz = 0.01379, xy = 0.0, xz = 0.0, yz = 0.0 }"),
    ("reference_diameter_m", "0.2125"),
    ("attachment_m", "[-0.25, 0.0, 0.0]"),
    ("ring_m", "[-3.0, 0.0, 0.0]"),
    ("drag_area_m2", "0.0013"),
    ("effective_weight_n", "0.0165"),
    ("reference_area_m2", "0.06"),
    ("arm_m", "0.15"),
    ("VW_m_s", "7.3"),
    ("ps_Pa", "101325.0"),
    ("Ts_K", "293.15"),
];

fn filled(draft: &str) -> String {
    let one = |line: &str| match line.split_once(" = ") {
        Some((key, rest)) if rest.contains("nan") => {
            // On a pivot it is one number.
            let one_number = key == "inertia_kg_m2" && !rest.starts_with('{');
            let value = if one_number { "0.001" } else { value_of(key) };
            format!("{key} = {value}\n")
        }
        _ => format!("{line}\n"),
    };
    draft.lines().map(one).collect()
}

fn value_of(key: &str) -> &'static str {
    FILLED.iter().find(|(k, _)| *k == key).unwrap_or_else(|| panic!("{key} is open")).1
}

/// The draft of files, and what comes of it once it is filled in.
fn loaded(files: &[PathBuf], kind: Option<DraftKind>) -> (String, windfall_model::Campaign, Vec<String>) {
    let draft = draft_campaign(files, kind).unwrap_or_else(|e| panic!("{e}"));
    let dir = files[0].parent().expect("a folder");
    let path = dir.join("campaign.toml");
    std::fs::write(&path, filled(&draft.campaign)).expect("writable");
    if let Some((name, text)) = &draft.structure {
        std::fs::write(dir.join(name), text).expect("writable");
    }
    let (campaign, warnings) = read_campaign_with_warnings(&path).unwrap_or_else(|e| panic!("{e}\n{}", draft.campaign));
    (draft.campaign, campaign, warnings)
}

fn put(dir: &Path, name: &str, text: &str) -> PathBuf {
    let path = dir.join(name);
    std::fs::write(&path, text).expect("writable");
    path
}

/// A model that hangs nose down and swings: 3 s at 100 Hz, in our own columns.
fn swings(phase: f64) -> Vec<[f64; 10]> {
    let row = |i: u32| {
        let t = f64::from(i) / 100.0;
        let s = (6.0 * t + phase).sin();
        [t, 0.02 * s, 0.1 * s, 0.05 * (5.0 * t).cos(), 40.0 * t, 8.0 * s, 6.0 * (5.0 * t).cos(), 7.3 + 0.01 * s, 101_300.0, 294.0]
    };
    (0..300).map(row).collect()
}

fn table(head: &str, separator: &str, rows: &[[f64; 10]], cell: impl Fn(usize, f64) -> String) -> String {
    let mut text = format!("{head}\n");
    for row in rows {
        let cells: Vec<String> = row.iter().enumerate().map(|(k, x)| cell(k, *x)).collect();
        let _ = writeln!(text, "{}", cells.join(separator));
    }
    text
}

fn plain(_: usize, x: f64) -> String {
    x.to_string()
}

/// The same record in the spellings of ten laboratories: each draft loads, and its record is that of our own columns, to the rounding of
/// the factors of units.
#[test]
fn law_spellings_of_one_record_are_one_record() {
    let rows = swings(0.0);
    let dir = tempfile::tempdir().expect("a temporary folder");
    let scaled = |factors: [f64; 10]| move |k: usize, x: f64| (x * factors[k]).to_string();
    let mm = [1e3, 1e3, 1e3, 1e3, 1.0, 1.0, 1.0, 1.0 / 0.3048, 1e-2, 1.0];
    let comma = |k: usize, x: f64| (x * mm[k]).to_string().replace('.', ",");
    let rad = [1.0, 1.0, 1.0, 1.0, 1.0_f64.to_radians(), 1.0_f64.to_radians(), 1.0_f64.to_radians(), 1.0, 1e-5, 1.0];
    let ours = "t_s,X_m,Y_m,Z_m,Rx_deg,Ry_deg,Rz_deg,VW_m_s,ps_Pa,Ts_K";
    let celsius = |k: usize, x: f64| if k == 9 { x - 273.15 } else { x };
    let all = [
        table(ours, ",", &rows, plain),
        format!("\u{feff}{}", table(ours, ",", &rows, plain)),
        table("time_ms;x_mm;y_mm;z_mm;Rx_deg;Ry_deg;Rz_deg;fan_ft_s;p_hPa;T_K", ";", &rows, comma),
        table(
            "Time (ms),X [mm],Y [mm],Z [mm],Rot X (deg),Rot Y (deg),Rot Z (deg),TunnelSpeed [ft/s],Static Pressure (hPa),Temperature (K)",
            ",",
            &rows,
            scaled(mm),
        ),
        table("t,posX,posY,posZ,rx_rad,ry_rad,rz_rad,tunnel_speed_mps,pressure_bar,temp_k", ",", &rows, scaled(rad)),
        table("t\tx\ty\tz\trx\try\trz\tvw\tps\tts\ns\tm\tm\tm\trad\trad\trad\tm/s\tbar\tK", "\t", &rows, scaled(rad)),
        table("timestamp,px,py,pz,rot_x,rot_y,rot_z,airspeed,p,T", ",", &rows, |k, x| celsius(k, x).to_string()),
    ];
    let mut first: Option<Data> = None;
    for (i, text) in all.iter().enumerate() {
        let file = put(dir.path(), &format!("run-{i}.csv"), text);
        let (draft, campaign, _) = loaded(&[file], None);
        assert_eq!(campaign.body(), Acts::Lander, "{draft}");
        let data = &campaign.runs[0].data;
        let Data::Tunnel(record) = data else { panic!("a tunnel run") };
        let Some(Data::Tunnel(ours)) = first.as_ref() else {
            first = Some(data.clone());
            continue;
        };
        for (a, b) in record.channels().iter().zip(ours.channels()).chain([(&&record.ps_pa[..], &ours.ps_pa[..])]) {
            let off = a.iter().zip(b).fold(0.0_f64, |m, (a, b)| m.max((a - b).abs() / (1.0 + b.abs())));
            assert!(off < 1e-12, "{i}: {off} in {draft}");
        }
    }
}

/// Columns that nothing reads are named in the draft, all of them; none is taken for what its unit says that it is not.
#[test]
fn law_every_column_that_is_left_out_is_named() {
    let dir = tempfile::tempdir().expect("a temporary folder");
    let mut text = String::from("t_s,X_m,Y_m,Z_m,Rx_deg,Ry_deg,Rz_deg,tunnel_speed_mps,p_radps,q_radps,battery_v,operator,,\n");
    for r in swings(0.0) {
        let pose: Vec<String> = r[..7].iter().map(ToString::to_string).collect();
        let _ = writeln!(text, "{},7.3,0.2,0.1,11.9,anna,,", pose.join(","));
    }
    let (draft, campaign, warnings) = loaded(&[put(dir.path(), "run.csv", &text)], None);
    let rest = draft.split("# Left out").nth(1).expect("a list");
    for name in ["p_radps", "q_radps", "battery_v", "operator"] {
        assert!(rest.contains(name), "{name} in {draft}");
    }
    assert!(draft.contains("VW_m_s = { name = \"tunnel_speed_mps\", unit = \"m/s\" }") && draft.contains("ps_Pa = 101325.0"));
    assert_eq!(campaign.runs.len(), 1);
    let said = warnings.iter().filter(|w| w.contains("operator")).count();
    assert_eq!(said, 1, "{warnings:?}");
}

/// Several files: the last is held out, one with other names has a table of its own, two of one name are refused.
#[test]
fn law_several_files_are_runs_of_one_campaign() {
    let dir = tempfile::tempdir().expect("a temporary folder");
    let head = "t,x,y,z,rx,ry,rz,vw,ps,ts";
    let degrees = |phase: f64| swings(phase);
    let other = "time_ms,X [mm],Y [mm],Z [mm],rx,ry,rz,vw,ps,ts";
    let mm = |k: usize, x: f64| (x * if k < 4 { 1e3 } else { 1.0 }).to_string();
    let files = [
        put(dir.path(), "push-1.csv", &table(head, ",", &degrees(0.0), plain)),
        put(dir.path(), "push-2.csv", &table(head, ",", &degrees(1.0), plain)),
        put(dir.path(), "calm-3.csv", &table(other, ",", &degrees(2.0), mm)),
    ];
    let (draft, campaign, _) = loaded(&files, None);
    let used: Vec<Use> = campaign.runs.iter().map(|r| r.used).collect();
    assert_eq!(used, [Use::Identify, Use::Identify, Use::HoldOut], "{draft}");
    let kinds: Vec<&str> = campaign.runs.iter().map(|r| r.kind.as_str()).collect();
    assert_eq!(kinds, ["push", "push", "calm"]);
    assert_eq!(draft.matches("[run.columns]").count(), 1, "{draft}");
    let truth = put(dir.path(), "truth.csv", "t_s,p_rad_s\n0,1\n0.1,2\n");
    let with = draft_campaign(&[files.to_vec(), vec![truth.clone()]].concat(), None).expect("a draft").campaign;
    assert!(with.contains("# Left out: ") && with.contains("truth.csv") && !with.contains("name = \"truth\""), "{with}");
    assert!(draft_campaign(&[truth], None).is_err());
    std::fs::create_dir(dir.path().join("more")).expect("writable");
    let twin = put(&dir.path().join("more"), "push-1.csv", &table(head, ",", &degrees(0.5), plain));
    let refused = draft_campaign(&[files[0].clone(), twin], None).err().map(|e| e.to_string());
    assert!(refused.as_ref().is_some_and(|e| e.contains("push-1") && e.contains("two of the files")), "{refused:?}");
}

/// A throw, an accelerometer, a pendulum and a glider: drafts of the other kinds load.
#[test]
fn law_other_kinds_load() {
    let dir = tempfile::tempdir().expect("a temporary folder");
    let lines = |head: &str, row: &dyn Fn(f64) -> Vec<f64>| {
        let mut text = format!("{head}\n");
        for i in 0..200 {
            let cells: Vec<String> = row(f64::from(i) / 200.0).iter().map(ToString::to_string).collect();
            let _ = writeln!(text, "{}", cells.join(","));
        }
        text
    };
    let throw = lines("t_s,north_m,east_m,height_m", &|t| vec![t, 3.0 * t, t, 2.0 + 4.0 * t - 4.9 * t * t]);
    let phone = lines("t_s,accel_z_m_s2", &|t| vec![t, -0.3 * t]);
    let swing = lines("t_s,angle_deg,rate_deg_s", &|t| vec![t, 20.0 * (6.0 * t).cos(), -120.0 * (6.0 * t).sin()]);
    let glider = lines("t,x_mm,y_mm,z_mm,qx,qy,qz,qw", &|t| {
        vec![t, 5e3 * t, 1500.0 - 4900.0 * t * t, 10.0 * t, 0.0, (0.1 * t).sin(), 0.0, (0.1 * t).cos()]
    });
    for (name, text, body, measured, words) in [
        ("throw.csv", &throw, Acts::PointMass, Measured::Position, "down = \"-Z\""),
        ("phone.csv", &phone, Acts::PointMass, Measured::SpecificForce, "fZ_m_s2 = { name = \"accel_z_m_s2\""),
        ("swing.csv", &swing, Acts::Pivot, Measured::Angle, "arm_m = nan"),
        ("glider.csv", &glider, Acts::FreeFlight, Measured::Pose, "tunnel = [\"-y\""),
    ] {
        let (draft, campaign, _) = loaded(&[put(dir.path(), name, text)], None);
        assert_eq!((campaign.body(), campaign.measured()), (body, measured), "{draft}");
        assert!(draft.contains(words), "{words} in {draft}");
    }
}

/// What no record tells stands in the file, where the axes are.
#[test]
fn law_the_draft_says_what_no_record_tells() {
    let dir = tempfile::tempdir().expect("a temporary folder");
    let file = put(dir.path(), "run.csv", &table("t,x,y,z,rx,ry,rz,vw,ps,ts", ",", &swings(0.0), plain));
    let draft = draft_campaign(&[file], None).expect("a draft").campaign;
    for words in ["NOT TOLD", "roll", "mirrored", "inertia_kg_m2, center_of_mass_m", "roll's zero"] {
        assert!(draft.contains(words), "{words} in {draft}");
    }
    assert!(draft.lines().all(|l| !l.starts_with('#') || l.chars().count() <= 150), "{draft}");
}
