//! scenarios: a first campaign file for a run file. In: the run's columns. Out: commented TOML in which every guess is marked as one and
//! what no record tells is left as `nan`, which the reader refuses with what is allowed.

mod axes;

use crate::columns::Columns;
use crate::error::ReadError;
use crate::formats::{read_columns, stem};
use axes::{AxesGuess, mean_of_angles, mean_of_quaternions, upright};
use std::fmt::Write as _;
use std::path::Path;

/// A commented campaign for one run file.
///
/// # Errors
/// A file that is no run file, or without a column that could be a time and one that could be a position.
pub fn campaign_of_run(path: &Path) -> Result<String, ReadError> {
    let columns = read_columns(path)?;
    let name = stem(path).unwrap_or_else(|| "run".to_owned());
    let guess = Guess::new(&columns).ok_or_else(|| {
        let what = format!("has no columns that could be time and position; it has {}", crate::columns::some_of(columns.names()));
        let remedy = "name them t and x, y, z (or t_s and X_m, Y_m, Z_m) in the file's header";
        ReadError::Faults(vec![crate::columns::fault(path, columns.header, "columns", "", &what, remedy)])
    })?;
    let file = path.canonicalize().unwrap_or_else(|_| path.to_owned());
    Ok(guess.text(&name, &file.display().to_string()))
}

/// A column with its unit in words of `[columns]`, and why.
struct Found {
    ours: &'static str,
    name: String,
    unit: String,
    why: String,
}

/// How the body is turned.
enum Attitude {
    /// Four columns; the real part last or first.
    Quaternion([String; 4], bool),
    /// R_x, R_y, R_z, with their unit.
    Euler([String; 3], &'static str),
}

struct Guess {
    time: Found,
    position: Vec<Found>,
    attitude: Option<Attitude>,
    others: Vec<Found>,
    rate_hz: f64,
    /// Axis with sign along which the record falls, and how clearly: mean acceleration, m/s².
    down: Option<(String, f64)>,
    /// Which way up a model with attitude is.
    axes: Option<AxesGuess>,
}

/// Words of a name: letters and digits in lower case, units after `_` or in brackets apart.
fn bare(name: &str) -> (String, Option<String>) {
    let lower = name.trim().to_ascii_lowercase();
    let cut = |c: char| "_([ ".contains(c);
    let head = lower.split(cut).next().unwrap_or_default().to_owned();
    let tail = lower[head.len()..].trim_matches(|c: char| "_()[] ".contains(c)).to_owned();
    (head, Some(tail).filter(|t| !t.is_empty()))
}

fn column<'a>(c: &'a Columns, names: &[&str]) -> Option<(&'a String, &'a Vec<f64>, Option<String>)> {
    let whole = |n: &str| names.contains(&n.trim().to_ascii_lowercase().as_str());
    c.all().find(|(n, _)| whole(n) || names.contains(&bare(n).0.as_str())).map(|(n, v)| (n, v, written(c, n)))
}

/// Unit that the file itself says, in its row of units or in the name.
fn written(c: &Columns, name: &str) -> Option<String> {
    let place = c.names().iter().position(|n| n == name)?;
    let row = c.units.get(place).filter(|u| !u.is_empty()).cloned();
    const KNOWN: [(&str, &str); 29] = [
        ("s", "s"),
        ("ms", "ms"),
        ("us", "us"),
        ("ns", "ns"),
        ("m", "m"),
        ("mm", "mm"),
        ("cm", "cm"),
        ("in", "in"),
        ("ft", "ft"),
        ("deg", "deg"),
        ("rad", "rad"),
        ("pa", "Pa"),
        ("kpa", "kPa"),
        ("k", "K"),
        ("degc", "degC"),
        ("c", "degC"),
        ("degf", "degF"),
        ("hpa", "hPa"),
        ("mbar", "mbar"),
        ("bar", "bar"),
        ("psi", "psi"),
        ("psf", "psf"),
        ("m_s", "m/s"),
        ("m/s", "m/s"),
        ("ft_s", "ft/s"),
        ("ft/s", "ft/s"),
        ("fps", "ft/s"),
        ("km_h", "km/h"),
        ("kmh", "km/h"),
    ];
    row.or_else(|| bare(name).1.and_then(|t| KNOWN.iter().find(|(k, _)| *k == t).map(|(_, u)| (*u).to_owned())))
}

/// The column of time: `T` is one only where no other is, and a unit of temperature says that it is none.
fn time_of(c: &Columns) -> Option<(&String, &Vec<f64>, Option<String>)> {
    let all = c.all().map(|(n, v)| (n, v, written(c, n)));
    let named = all.filter(|(n, _, unit)| {
        let word = ["t", "t_s", "time", "timestamp", "seconds"];
        let known = word.contains(&n.trim().to_ascii_lowercase().as_str()) || word.contains(&bare(n).0.as_str());
        known && !unit.as_deref().is_some_and(|u| ["K", "degC"].contains(&u))
    });
    let mut named: Vec<_> = named.collect();
    named.sort_by_key(|(n, ..)| n.trim().starts_with('T') && bare(n).0 == "t");
    named.into_iter().next()
}

fn span(v: &[f64]) -> f64 {
    let (low, high) =
        v.iter().filter(|x| x.is_finite()).fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(*x), b.max(*x)));
    high - low
}

fn median(mut v: Vec<f64>) -> f64 {
    v.retain(|x| x.is_finite());
    v.sort_by(f64::total_cmp);
    v.get(v.len() / 2).copied().unwrap_or(f64::NAN)
}

impl Guess {
    fn new(c: &Columns) -> Option<Self> {
        let (name, t, said) = time_of(c)?;
        let step = median(t.windows(2).map(|w| w[1] - w[0]).collect());
        // Records have between 5 and 5000 samples a second.
        let by_size = [("s", 1.0), ("ms", 1e3), ("us", 1e6), ("ns", 1e9)].into_iter().find(|(_, k)| step / k <= 0.2);
        let size = by_size.map_or("s", |(u, _)| u).to_owned();
        let per_s = |u: &str| [("ms", 1e3), ("us", 1e6), ("ns", 1e9)].iter().find(|(k, _)| *k == u).map_or(1.0, |(_, k)| *k);
        let time = found("t_s", name, said, size, &format!("the median step is {step}"));
        let rate_hz = per_s(&time.unit) / step;
        let mut position = Vec::new();
        for (ours, names) in
            [("X_m", ["x", "x_m", "px", "tx"]), ("Y_m", ["y", "y_m", "py", "ty"]), ("Z_m", ["z", "z_m", "pz", "tz"])]
        {
            if let Some((name, v, said)) = column(c, &names) {
                let wide = span(v);
                let size = if wide > 20.0 { "mm" } else { "m" };
                position.push(found(ours, name, said, size.to_owned(), &format!("it spans {wide:.4}")));
            }
        }
        if position.is_empty() {
            return None;
        }
        let down = falls(c, &time, &position, per_s(&time.unit));
        let attitude = attitude(c);
        let axes = attitude.as_ref().and_then(|a| axes_of(c, a));
        Some(Self { attitude, axes, others: tunnel(c, &time.name), time, position, rate_hz, down })
    }

    fn text(&self, name: &str, file: &str) -> String {
        let mut out = format!(
            "# A first campaign, made from {file}.\n# GUESS: read from the record, to be confirmed. FILL IN: no record tells it; nan is refused.\n\n\
             [campaign]\nname = \"{name}\"\nnote = \"made by windfall init\"\n\n"
        );
        match self.attitude {
            Some(_) => self.rigid(&mut out),
            None => self.point(&mut out),
        }
        self.columns(&mut out);
        let kind = if self.attitude.is_some() { "perturbed" } else { "launch" };
        let _ = write!(
            out,
            "\n# Give every run its [[run]]; hold one out (use = \"hold-out\"): it alone says how well the model predicts.\n[[run]]\n\
             file = {file:?}\nkind = \"{kind}\"\nuse = \"identify\"   # {:.4} samples a second (GUESS: median step)\n",
            self.rate_hz
        );
        out
    }

    fn point(&self, out: &mut String) {
        let down = self.down.as_ref().map_or(("-Z".to_owned(), "GUESS: the record does not tell".to_owned()), |(axis, a)| {
            (axis.clone(), format!("GUESS: along it the record accelerates by {a:.2} m/s2 on average"))
        });
        let _ = write!(
            out,
            "# A body without attitude (GUESS: the file has no angles and no quaternion).\n[vehicle]\nmass_kg = nan                 # FILL \
             IN\nreference_diameter_m = nan    # FILL IN\n\n[axes]\ndown = \"{}\"   # {}\n\n[environment]\ngravity_m_s2 = 9.80665\n\
             air_density_kg_m3 = 1.2       # GUESS: a room at 20 degC\n\n[sensors]\nposition_std_m = 0.001        # GUESS: noise is learnt from \
             the record\n\n[aero.point_mass]\nCD = 0.47                     # GUESS: a sphere\n",
            down.0, down.1
        );
    }

    fn rigid(&self, out: &mut String) {
        *out += "# A body with attitude in a vertical wind tunnel (GUESS: the file has its angles). Body x out of the nose.\n[vehicle]\nmass_kg = \
                 nan                                                              # FILL IN\ninertia_kg_m2 = { xx = nan, yy = nan, zz = nan, \
                 xy = 0.0, xz = 0.0, yz = 0.0 }   # FILL IN; about the centre of mass\ncenter_of_mass_m = [0.0, 0.0, 0.0]   # GUESS: at the \
                 tracked origin\nreference_diameter_m = nan          # FILL IN\n\n# Leave the table out in free flight.\n[tether]\n\
                 attachment_m = [nan, nan, nan]      # FILL IN; body axes, from the tracked origin\nring_m = [nan, nan, nan]            # FILL \
                 IN; tunnel axes, X down\ndrag_area_m2 = nan                  # FILL IN\neffective_weight_n = nan            # FILL IN\n\n\
                 [environment]\ngravity_m_s2 = 9.80665\ngas_constant_j_kg_k = 287.05287     # GUESS: dry air\n\n[sensors]              \
                 # GUESS: thesis Table A.3; noise is learnt from the record\nposition_std_m = 7.5e-4\nroll_std_deg = 0.0623\n\
                 pitch_yaw_std_deg = 0.110\nwind_std_m_s = 2.57e-3\n\n[aero.axisymmetric]    # GUESS: the thesis' structure and starting \
                 points\nCA_T0 = 6.6\nCN_sin = 3.4\nCN_sin3 = -1.5\nCl_0 = 0.01\nCl_p = -5.0\nCm_sin = -2.0\nCm_sin3 = 2.0\nCm_1 = \
                 -3.0\nCm_2 = -150.0\nCn_1 = -3.0\nCn_2 = -150.0\n";
    }

    fn columns(&self, out: &mut String) {
        let all = std::iter::once(&self.time).chain(&self.position).chain(&self.others);
        let differ: Vec<&Found> = all.filter(|f| f.name != f.ours).collect();
        let point = self.attitude.is_none();
        if !differ.is_empty() || matches!(self.attitude, Some(Attitude::Quaternion(..))) {
            *out += "\n[columns]\n";
        }
        for f in differ {
            let _ = writeln!(out, "{} = {{ name = {:?}, unit = {:?} }}   # {}", f.ours, f.name, f.unit, f.why);
        }
        if point {
            return;
        }
        for (ours, value) in [("VW_m_s", "nan"), ("ps_Pa", "101325.0"), ("Ts_K", "293.15")] {
            if !self.others.iter().any(|f| f.ours == ours) {
                let _ = writeln!(out, "{ours} = {value}   # FILL IN: no such column was seen; a column's name or one number");
            }
        }
        let own = ["x", "y", "z"].map(str::to_owned);
        let (tunnel, body, why) = self.axes.as_ref().map_or_else(
            || (&own, &own, "GUESS: as the file has them; its attitudes do not tell which way is down".to_owned()),
            |g| (&g.tunnel, &g.body, g.why.clone()),
        );
        let _ = writeln!(
            out,
            "\n[columns.axes]   # which of the file's axes are tunnel X (down), Y, Z, and body x (nose), y, z\n# {why}.\ntunnel = {tunnel:?}\n\
             body = {body:?}"
        );
        match &self.attitude {
            Some(Attitude::Quaternion(q, last)) => {
                let scalar = if *last { "last" } else { "first" };
                let _ = writeln!(
                    out,
                    "\n[columns.attitude]\nquaternion = {q:?}\nscalar = \"{scalar}\"   # GUESS: by the names\nrotates = \"body-to-world\"   \
                     # GUESS; or world-to-body"
                );
            }
            Some(Attitude::Euler(e, unit)) if e[0] != "Rx_deg" => {
                let _ = writeln!(
                    out,
                    "\n[columns.attitude]\neuler = {e:?}\nsequence = \"xyz\"   # GUESS\nunit = \"{unit}\"   # GUESS: by size or name\n\
                     rotates = \"body-to-world\"   # GUESS; or world-to-body"
                );
            }
            _ => {}
        }
    }
}

/// By the mean attitude, read as the first campaign reads it.
fn axes_of(c: &Columns, attitude: &Attitude) -> Option<AxesGuess> {
    let series = |names: &[String]| names.iter().map(|n| c.get(n)).collect::<Option<Vec<_>>>();
    match attitude {
        Attitude::Quaternion(names, last) => {
            let q = series(names)?;
            let real = if *last { 3 } else { 0 };
            let row = |i: usize| {
                let vector: Vec<f64> = (0..4).filter(|k| *k != real).map(|k| q[k][i]).collect();
                [vector[0], vector[1], vector[2], q[real][i]]
            };
            upright(mean_of_quaternions((0..q[0].len()).map(row)))
        }
        Attitude::Euler(names, unit) => {
            let a = series(names)?;
            let rad = if *unit == "rad" { 1.0 } else { 1.0_f64.to_radians() };
            upright(mean_of_angles((0..a[0].len()).map(|i| [0, 1, 2].map(|k| rad * a[k][i]))))
        }
    }
}

fn found(ours: &'static str, name: &str, said: Option<String>, size: String, why: &str) -> Found {
    let why = if said.is_some() { "unit as the file says".to_owned() } else { format!("GUESS: {why}") };
    Found { ours, name: name.to_owned(), unit: said.unwrap_or(size), why }
}

fn attitude(c: &Columns) -> Option<Attitude> {
    let all = |names: [&str; 4]| -> Option<[String; 4]> {
        let found: Option<Vec<String>> = names.iter().map(|n| Some(column(c, &[n])?.0.clone())).collect();
        found?.try_into().ok()
    };
    if let Some(q) = all(["qx", "qy", "qz", "qw"]).or_else(|| all(["q1", "q2", "q3", "q0"])) {
        return Some(Attitude::Quaternion(q, true));
    }
    [["rx", "ry", "rz"], ["roll", "pitch", "yaw"]].into_iter().find_map(|names| {
        let found: Option<Vec<_>> = names.iter().map(|n| column(c, &[n])).collect();
        let found = found?;
        let most = found.iter().map(|f| span(f.1)).fold(0.0, f64::max);
        let unit =
            found[0].2.as_deref().map_or(if most > 7.0 { "deg" } else { "rad" }, |u| if u == "rad" { "rad" } else { "deg" });
        let names: Vec<String> = found.iter().map(|f| f.0.clone()).collect();
        Some(Attitude::Euler(names.try_into().ok()?, unit))
    })
}

/// Tunnel speed, static pressure, static temperature.
fn tunnel(c: &Columns, time: &str) -> Vec<Found> {
    let one = |ours, names: &[&str], by_size: fn(f64) -> &'static str| {
        let (name, v, said) = column(c, names)?;
        let level = median(v.clone());
        Some(found(ours, name, said, by_size(level).to_owned(), &format!("its median is {level:.4}")))
    };
    let speed = one("VW_m_s", &["vw", "vw_m_s", "fan", "speed", "airspeed", "wind"], |_| "m/s");
    let pressure = one("ps_Pa", &["ps", "ps_pa", "p", "pressure", "pstatic"], |x| match x {
        x if x < 2.0 => "bar",
        x if x < 20.0 => "psi",
        x if x < 200.0 => "kPa",
        x if x < 2000.0 => "hPa",
        _ => "Pa",
    });
    let by_level: fn(f64) -> &'static str = |x| if x < 100.0 { "degC" } else { "K" };
    let letter = || {
        let (name, v) = c.all().find(|(n, _)| n.trim().starts_with('T') && bare(n).0 == "t" && *n != time)?;
        let level = median(v.clone());
        Some(found("Ts_K", name, written(c, name), by_level(level).to_owned(), &format!("its median is {level:.4}")))
    };
    let temperature = one("Ts_K", &["ts", "ts_k", "temp", "temperature"], by_level).or_else(letter);
    [speed, pressure, temperature].into_iter().flatten().collect()
}

/// The axis along which positions accelerate most, by a parabola through the record's thirds.
fn falls(c: &Columns, time: &Found, position: &[Found], per_s: f64) -> Option<(String, f64)> {
    let t = c.get(&time.name)?;
    let one = |f: &Found| {
        let (v, n) = (c.get(&f.name)?, t.len());
        let at = |i: usize| (t[i] / per_s, v[i]);
        let ((t0, x0), (t1, x1), (t2, x2)) = (at(0), at(n / 2), at(n.checked_sub(1)?));
        let a = 2.0 * ((x2 - x1) / (t2 - t1) - (x1 - x0) / (t1 - t0)) / (t2 - t0);
        let metres =
            [("mm", 1e-3), ("cm", 1e-2), ("in", 0.0254), ("ft", 0.3048)].iter().find(|(u, _)| *u == f.unit).map_or(1.0, |u| u.1);
        Some((f.ours.chars().next()?, a * metres)).filter(|(_, a)| a.is_finite())
    };
    let (axis, a) = position.iter().filter_map(one).max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))?;
    let sign = if a < 0.0 { "-" } else { "" };
    // A body that flies free falls by a good part of g.
    (a.abs() > 2.0).then(|| (format!("{sign}{axis}"), a))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(names: &[&str], rows: impl Iterator<Item = Vec<f64>>) -> Columns {
        let rows: Vec<Vec<f64>> = rows.collect();
        let data = (0..names.len()).map(|k| rows.iter().map(|r| r[k]).collect()).collect();
        Columns::new(names.iter().map(|n| (*n).to_owned()).collect(), data, Vec::new())
    }

    /// A ball thrown up, in ms and mm with y upward.
    #[test]
    fn exact_a_throw_is_read() {
        let rows = (0..100).map(|i| {
            let t = f64::from(i) * 0.01;
            vec![10.0 * f64::from(i), 100.0 * t, 1e3 * (4.0 * t - 4.9 * t * t)]
        });
        let g = Guess::new(&of(&["time", "x", "y"], rows)).expect("time and position");
        assert_eq!((g.time.unit.as_str(), g.position[1].unit.as_str()), ("ms", "mm"));
        assert!((g.rate_hz - 100.0).abs() < 1e-9 && g.attitude.is_none());
        let (axis, a) = g.down.clone().expect("it falls");
        assert!(axis == "-Y" && (a + 9.8).abs() < 0.1, "{axis} {a}");
        let text = g.text("throw", "throw.csv");
        for words in ["down = \"-Y\"", "t_s = { name = \"time\", unit = \"ms\" }", "mass_kg = nan", "GUESS"] {
            assert!(text.contains(words), "{words} in {text}");
        }
        text.parse::<toml::Table>().expect("TOML");
    }

    #[test]
    fn exact_a_quaternion_is_seen() {
        let names = ["t_ms", "x_mm", "y_mm", "z_mm", "qx", "qy", "qz", "qw", "fan"];
        let g = Guess::new(&of(&names, (0..50).map(|i| vec![f64::from(i) * 5.0, 1.0, 2.0, 3.0, 0.0, 0.0, 0.0, 1.0, 7.4])))
            .expect("a run");
        assert!(matches!(g.attitude, Some(Attitude::Quaternion(_, true))));
        assert!(g.time.unit == "ms" && g.position.iter().all(|p| p.unit == "mm"), "as the names say");
        assert_eq!(bare("fan_ft_s"), ("fan".to_owned(), Some("ft_s".to_owned())));
        g.text("run", "run.csv").parse::<toml::Table>().expect("TOML");
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
            let g = Guess::new(&of(&names, rows(at))).expect("a run");
            let other = names[at];
            assert_eq!(g.time.name, names[1 - at], "{names:?}");
            let found = g.others.iter().find(|f| f.ours == "Ts_K").expect("a temperature");
            assert_eq!((found.name.as_str(), found.unit.as_str()), (other, "degC"), "{names:?}");
        }
        let alone = Guess::new(&of(&["T", "x", "y"], (0..50).map(|i| vec![0.01 * f64::from(i), 1.0, 2.0]))).expect("a run");
        assert!(alone.time.name == "T" && alone.others.is_empty());
    }
}
