use super::*;

fn of(names: &[&str], rows: impl Iterator<Item = Vec<f64>>) -> Columns {
    let rows: Vec<Vec<f64>> = rows.collect();
    let data = (0..names.len()).map(|k| rows.iter().map(|r| r[k]).collect()).collect();
    Columns::new(names.iter().map(|n| (*n).to_owned()).collect(), data, (1..=rows.len()).collect())
}

fn guess(c: &Columns) -> Guess {
    Guess::new(Path::new("run.csv"), &Sheet::new(c), c).unwrap_or_else(|e| panic!("{e}"))
}

/// The draft of one file, which is TOML.
fn text(c: &Columns, kind: Option<DraftKind>) -> String {
    let (g, sheet) = (guess(c), Sheet::new(c));
    let (kind, why) = kind.map_or_else(|| g.kind(), |k| (k, String::new()));
    let reading = g.reading(kind, Path::new("run.csv"), &sheet, c).unwrap_or_else(|e| panic!("{e}"));
    let text = draft::draft(kind, &why, &[reading], &[]).campaign;
    text.parse::<toml::Table>().unwrap_or_else(|e| panic!("{e} in {text}"));
    text
}

/// A ball thrown up, in ms and mm with y upward.
#[test]
fn exact_a_throw_is_read() {
    let rows = (0..100).map(|i| {
        let t = f64::from(i) * 0.01;
        vec![10.0 * f64::from(i), 100.0 * t, 1e3 * (4.0 * t - 4.9 * t * t)]
    });
    let c = of(&["time", "x", "y"], rows);
    let g = guess(&c);
    let position = g.position.as_ref().expect("a position");
    assert_eq!((g.clock.found.unit.as_str(), position.found[1].unit.as_str()), ("ms", "mm"));
    assert!((g.clock.rate_hz - 100.0).abs() < 1e-9 && g.attitude.is_none());
    let (axis, a) = g.falls.clone().expect("it falls");
    // A parabola is fitted exactly but for rounding.
    assert!(axis == "-Y" && (a + 9.8).abs() < 1e-9, "{axis} {a}");
    let text = text(&c, None);
    for words in ["down = \"-Y\"", "t_s = { name = \"time\", unit = \"ms\" }", "mass_kg = nan", "GUESS", "Kind: point"] {
        assert!(text.contains(words), "{words} in {text}");
    }
}

const POSE: [&str; 8] = ["t_ms", "x_mm", "y_mm", "z_mm", "qx", "qy", "qz", "qw"];

/// A pose at rest with other columns, at 200 Hz.
fn pose(others: &[(&str, f64)]) -> Columns {
    let names: Vec<&str> = POSE.iter().copied().chain(others.iter().map(|(n, _)| *n)).collect();
    let rows = (0..50).map(|i| {
        let row = vec![f64::from(i) * 5.0, f64::from(i), 2.0, 3.0, 0.0, 0.0, 0.0, 1.0];
        row.into_iter().chain(others.iter().map(|(_, v)| *v)).collect()
    });
    of(&names, rows)
}

#[test]
fn exact_a_quaternion_is_seen() {
    let c = pose(&[("fan", 7.4)]);
    let g = guess(&c);
    let Some(Attitude::Quaternion(q)) = &g.attitude else { panic!("a quaternion") };
    assert!(q.last && q.told && q.names == ["qx", "qy", "qz", "qw"]);
    let position = g.position.as_ref().expect("a position");
    assert!(g.clock.found.unit == "ms" && position.found.iter().all(|p| p.unit == "mm"), "as the names say");
    assert_eq!(g.kind().0, DraftKind::Tunnel);
    assert!(text(&c, None).contains("VW_m_s = { name = \"fan\", unit = \"m/s\" }"));
}

/// A guess agrees with the unit in the column's own name, or the column is left out and named with the reason.
#[test]
fn law_no_guess_contradicts_the_unit_in_a_name() {
    for (name, value, ours) in [
        ("tunnel_speed_mps", 7.3, Some("VW_m_s")),
        ("TunnelSpeed [ft/s]", 24.0, Some("VW_m_s")),
        ("fan_rpm", 900.0, None),
        ("reel_speed_m_s", 7.3, None),
        ("p_radps", 0.3, None),
        ("p_hPa", 1003.0, Some("ps_Pa")),
        ("p_bar", 1.003, Some("ps_Pa")),
        ("p", 0.1, None),
        ("p", 101_300.0, Some("ps_Pa")),
        ("static pressure (kPa)", 101.3, Some("ps_Pa")),
        ("pressure_psi", 0.001, None),
        ("wind_deg", 240.0, None),
        ("temperature", 900.0, None),
        ("temp_degC", 21.0, Some("Ts_K")),
        ("T_s", 294.0, Some("Ts_K")),
    ] {
        let c = pose(&[(name, value)]);
        let g = guess(&c);
        let found = g.air.iter().find(|f| f.name == name).map(|f| f.ours);
        assert_eq!(found, ours, "{name} = {value}: {:?}", g.refused);
        let text = text(&c, Some(DraftKind::Tunnel));
        let left_out = text.split("# Left out").nth(1).is_some_and(|rest| rest.contains(name));
        assert_eq!(left_out, ours.is_none(), "{name} in {text}");
    }
}

/// `T` beside `t` is the temperature, in either order; alone it is the time; `T_degC` is never the time.
#[test]
fn exact_a_capital_t_is_the_temperature_beside_a_time() {
    let rows = |at: usize| {
        (0..50).map(move |i| {
            let mut row = vec![1.0, 2.0, 3.0, 0.0, 0.0, 0.0, 1.0];
            row.insert(0, 0.005 * f64::from(i));
            row.insert(at, 21.0);
            row
        })
    };
    for (names, at) in [
        (["t", "T", "x", "y", "z", "qx", "qy", "qz", "qw"], 1),
        (["T", "t", "x", "y", "z", "qx", "qy", "qz", "qw"], 0),
        (["T_degC", "time", "x", "y", "z", "qx", "qy", "qz", "qw"], 0),
    ] {
        let c = of(&names, rows(at));
        let g = guess(&c);
        let other = names[at];
        assert_eq!(g.clock.found.name, names[1 - at], "{names:?}");
        let found = g.air.iter().find(|f| f.ours == "Ts_K").expect("a temperature");
        assert_eq!((found.name.as_str(), found.unit.as_str()), (other, "degC"), "{names:?}");
    }
    let c = of(&["T", "x", "y"], (0..50).map(|i| vec![0.01 * f64::from(i), 1.0, 2.0]));
    let alone = guess(&c);
    assert!(alone.clock.found.name == "T" && alone.air.is_empty());
}

/// Roll, pitch and yaw turn in the order yaw, pitch, roll; angles said to be in rad that pass half a turn are in degrees.
#[test]
fn exact_roll_pitch_yaw_is_read_backward() {
    let rows =
        |scale: f64| (0..60).map(move |i| vec![0.01 * f64::from(i), 1.0, 2.0, 3.0, scale * f64::from(i), 4.0 * scale, scale]);
    for (names, scale, unit) in [
        (["t", "x", "y", "z", "roll", "pitch", "yaw"], 3.0, "deg"),
        (["t", "x", "y", "z", "kite_0_roll", "kite_0_pitch", "kite_0_yaw"], 0.02, "rad"),
        (["t", "x", "y", "z", "roll_rad", "pitch_rad", "yaw_rad"], 3.0, "deg"),
    ] {
        let c = of(&names, rows(scale));
        let g = guess(&c);
        let Some(Attitude::Euler(e)) = &g.attitude else { panic!("three angles in {names:?}") };
        assert_eq!((e.sequence, e.unit), ("zyx", unit), "{names:?}: {}", e.why);
        assert_eq!(e.names.each_ref().map(String::as_str), [names[6], names[5], names[4]]);
    }
    // Rates are no angles.
    let names = ["t", "x", "y", "z", "roll_rate", "pitch_rate", "yaw_rate"];
    assert!(guess(&of(&names, rows(0.1))).attitude.is_none());
}

/// The kind follows from the columns; what is asked for stands in its place, or is refused with what lacks.
#[test]
fn law_the_kind_follows_from_the_columns() {
    let line = |names: &[&str]| {
        let n = names.len();
        of(names, (0..60).map(|i| (0..n).map(|k| if k == 0 { 0.01 * f64::from(i) } else { 0.1 }).collect()))
    };
    for (names, kind) in [
        (&["t_s", "angle_deg", "rate_deg_s"][..], DraftKind::Pivot),
        (&["t_s", "accel_z_m_s2"][..], DraftKind::Point),
        (&["t_s", "Z_m"][..], DraftKind::Point),
        (&["t_s", "x", "y", "z", "roll", "pitch", "yaw"][..], DraftKind::FreeFlight),
    ] {
        let c = line(names);
        assert_eq!(guess(&c).kind().0, kind, "{names:?}");
        text(&c, None);
    }
    let c = line(&["t_s", "x", "y", "z"]);
    let refused = guess(&c).reading(DraftKind::Tunnel, Path::new("run.csv"), &Sheet::new(&c), &c).err().map(|e| e.to_string());
    assert!(refused.as_ref().is_some_and(|e| e.contains("attitude") && e.contains("tunnel")), "{refused:?}");
}

/// Rows that are zero or frozen are counted, and the window is what is left.
#[test]
fn exact_rows_that_do_not_move_are_counted() {
    let rows = (0..100).map(|i| {
        let at = f64::from(i.clamp(19, 70) - 19);
        vec![0.01 * f64::from(i), at, at, 2.0 * at]
    });
    let c = of(&["t", "x", "y", "z"], rows);
    let g = guess(&c);
    let reading = g.reading(DraftKind::Point, Path::new("run.csv"), &Sheet::new(&c), &c).unwrap_or_else(|e| panic!("{e}"));
    let still = reading.still.expect("rows that do not move");
    // Rows 0 to 19 are zero; 71 to 99 repeat row 70.
    assert_eq!((still.zero, still.frozen), (20, 29));
    assert!((still.window_s[0] - 0.2).abs() < 1e-12 && (still.window_s[1] - 0.7).abs() < 1e-12, "{still:?}");
}

/// A glider with z up as its own axis and y left, thrown along the room's x: down is -y as said, nose x, body z down.
#[test]
fn exact_axes_of_a_flight_are_by_its_way() {
    let g = flying((1, -1.0), "said", [0.98, 0.0, 0.1], [0.05, 0.0, -0.9]);
    assert_eq!(g.tunnel[0], "-y");
    assert_eq!(g.body, ["x", "-y", "-z"].map(str::to_owned), "{}", g.why);
    let tumbling = flying((2, -1.0), "said", [0.3, 0.2, 0.1], [0.0, 0.1, 0.2]);
    assert_eq!(tumbling.body, ["x", "y", "z"].map(str::to_owned));
}
