//! Campaigns of this simulator that were written with `dump` and closed with `windfall many close`: tables of what came of them, with the
//! probabilities that were stated beside how often they were true.

use crate::score::{Score, score};
use serde_json::Value;
use std::io::Write as _;
use std::path::Path;

/// Bins of stated probability.
const BINS: usize = 10;

/// A closed campaign.
struct Closed {
    group: String,
    score: Score,
    /// Estimate less truth over the stated error, of aerodynamic numbers and of strengths.
    aero: Vec<f64>,
    strengths: Vec<f64>,
    /// Probability of each set of families that was stated, and whether it is the true one.
    stated: Vec<(f64, bool)>,
}

/// Key of the truth that a strength estimates, and what it is to be multiplied by; signs are conventions.
fn strength(family: &str, name: &str, answer: &Value) -> Option<f64> {
    let truth = |key: &str| answer["truth"][key].as_f64();
    let speed = answer["trim_speed_m_s"].as_f64()?;
    let key = match (family, name) {
        ("apparent-mass", "axial_kg") => "ma_x",
        ("apparent-mass", "radial_kg") => "ma_r",
        ("apparent-mass", "transverse_kg_m2") => "Ia_r",
        ("asymmetry", "Cm_0") => "Cm0",
        ("asymmetry", "Cn_0") => "Cn0",
        ("axial-shape", "CA_sin2") => "CA2",
        ("center-of-mass", "y_m") => "ycm",
        ("center-of-mass", "z_m") => "zcm",
        ("damping-shape", "bump") => "bump",
        ("inertia", "xy_kg_m2") => "Ixy",
        ("inertia", "xz_kg_m2") => "Ixz",
        ("loose-mass", "mass_kg") => "slosh_m",
        ("magnus", "Cn_p_alpha") => "mag",
        ("pose-misalignment", "y_rad") => "mis_y",
        ("pose-misalignment", "z_rad") => "mis_z",
        ("rate-force", "CN_q") => "CNq",
        ("roll-damping-shape", "Cl_p_abs_p") => "Clpp",
        ("tether-line-rate", "n_s_per_m") => "teth_c",
        ("wind-delay", "delay_s") => "Vdelay",
        ("flow-profile", "bowl_per_m2") => return Some(truth("prof")? / 3.05_f64.powi(2)),
        ("swirl", "rad_per_m") => return Some(truth("swirl")? / speed),
        ("cross-flow", "y_rad") => return Some(truth("vy")? / speed),
        ("cross-flow", "z_rad") => return Some(truth("vz")? / speed),
        ("turbulence", "axial_rms_m_s") => return answer["flow"]["axial"].as_f64(),
        ("turbulence", "lateral_rms_m_s") => return answer["flow"]["lateral"].as_f64(),
        _ => return None,
    };
    truth(key)
}

/// Error over what was stated.
fn standardised(p: &Value, truth: f64, signed: bool) -> Option<f64> {
    let (estimate, std) = (p["estimate"].as_f64()?, p["std_error"].as_f64().filter(|s| *s > 0.0)?);
    Some(if signed { estimate - truth } else { estimate.abs() - truth.abs() } / std)
}

fn list(v: &Value) -> impl Iterator<Item = &Value> {
    v.as_array().into_iter().flatten()
}

fn read(answer: &Value, folder: &Path) -> Closed {
    let name = answer["name"].as_str().unwrap_or_default();
    let text = std::fs::read_to_string(folder.join("results").join(name).join("close.json"));
    let closing: Option<Value> = text.ok().and_then(|t| serde_json::from_str(&t).ok());
    let score = score(answer, closing.as_ref(), 0.0);
    let c = closing.unwrap_or_default();
    let of_aero = |p: &Value| standardised(p, answer["aero"][p["name"].as_str()?].as_f64()?, true);
    let aero = list(&c["after"]["parameters"]).filter_map(of_aero).collect();
    let of_effect = |e: &Value| {
        let family = e["family"].as_str().unwrap_or_default();
        let acts = score.want.iter().any(|w| w == family);
        let one = |p: &Value| {
            let truth = strength(family, p["name"].as_str()?, answer).filter(|t| acts && *t != 0.0)?;
            standardised(p, truth, false)
        };
        list(&e["parameters"]).filter_map(one).collect::<Vec<_>>()
    };
    let strengths = list(&c["effects"]).flat_map(of_effect).collect();
    let mut truth: Vec<&str> = score.want.iter().map(String::as_str).filter(|w| *w != "none").collect();
    truth.sort_unstable();
    let said = |s: &Value| {
        let mut families: Vec<&str> = list(&s["families"]).filter_map(Value::as_str).collect();
        families.sort_unstable();
        Some((s["probability"].as_f64()?, families == truth))
    };
    let stated = list(&c["sets"]).filter_map(said).collect();
    Closed { group: answer["group"].as_str().unwrap_or_default().to_owned(), score, aero, strengths, stated }
}

/// Share of `hits` of `n` in percent with its standard error.
fn share(hits: usize, n: usize) -> String {
    let p = hits as f64 / n.max(1) as f64;
    format!("{:.1} ± {:.1} % of {n}", 100.0 * p, 100.0 * (p * (1.0 - p) / n.max(1) as f64).sqrt())
}

fn covered(z: &[f64]) -> (usize, usize) {
    (z.iter().filter(|z| z.abs() <= 1.96).count(), z.len())
}

fn rows(all: &[Closed]) -> String {
    let mut groups: Vec<&str> = all.iter().map(|c| c.group.as_str()).collect();
    groups.sort_unstable();
    groups.dedup();
    groups.push("all");
    let mut text = String::from(
        "| group | n | end | right | exact | with a name too many | aerodynamics in 95 % | median z² / 0.455 | strengths in 95 % |\n|---|---|---|---|---|---|---|---|---|\n",
    );
    for group in groups {
        let of: Vec<&Closed> = all.iter().filter(|c| group == "all" || c.group == group).collect();
        let count = |f: &dyn Fn(&Score) -> bool| of.iter().filter(|c| f(&c.score)).count();
        // What was not named is in the aerodynamics: only where the set is right are they a fair question.
        let fair = || of.iter().filter(|c| c.score.exact && c.score.want != ["unexplained"]);
        let aero: Vec<f64> = fair().flat_map(|c| c.aero.iter().copied()).collect();
        let strengths: Vec<f64> = fair().flat_map(|c| c.strengths.iter().copied()).collect();
        let mut squares: Vec<f64> = aero.iter().map(|z| z * z).collect();
        squares.sort_by(f64::total_cmp);
        let middle = squares.get(squares.len() / 2).map_or(0.0, |m| m / 0.455);
        let ((a, of_a), (s, of_s)) = (covered(&aero), covered(&strengths));
        let (n, right) = (of.len(), count(&|s| s.right));
        text += &format!(
            "| {group} | {n} | {} | {} | {} | {} | {} | {middle:.2} | {} |\n",
            count(&|s| s.finished),
            share(right, n),
            count(&|s| s.exact),
            count(&|s| s.extra > 0),
            share(a, of_a),
            share(s, of_s),
        );
    }
    text
}

/// Statements about sets of families in bins of their probability: the mean stated, and the share that is true.
fn calibration(all: &[Closed]) -> String {
    let mut text = String::from("| stated | n | mean | true |\n|---|---|---|---|\n");
    let told = |c: &&Closed| c.group != "E" && c.score.finished;
    let stated: Vec<(f64, bool)> = all.iter().filter(told).flat_map(|c| c.stated.iter().copied()).collect();
    for bin in 0..BINS {
        let of: Vec<&(f64, bool)> = stated.iter().filter(|(p, _)| ((p * BINS as f64) as usize).min(BINS - 1) == bin).collect();
        let mean = of.iter().map(|s| s.0).sum::<f64>() / of.len().max(1) as f64;
        let held = of.iter().filter(|s| s.1).count();
        text += &format!(
            "| {:.1} to {:.1} | {} | {:.1} % | {} |\n",
            bin as f64 / BINS as f64,
            (bin + 1) as f64 / BINS as f64,
            of.len(),
            100.0 * mean,
            share(held, of.len())
        );
    }
    text
}

/// `ELSEWHERE_OUT=campaigns ELSEWHERE_CLOSED=closed`: what `dump` wrote, and where `windfall many close` put its results.
#[test]
#[ignore = "tabulates campaigns that were closed before, where ELSEWHERE_OUT and ELSEWHERE_CLOSED say"]
fn table_of_closed() {
    let place = |name: &str| std::env::var_os(name).map(std::path::PathBuf::from);
    let (Some(root), Some(closed)) = (place("ELSEWHERE_OUT"), place("ELSEWHERE_CLOSED")) else {
        let _ = writeln!(std::io::stderr(), "skipped: table_of_closed: ELSEWHERE_OUT and ELSEWHERE_CLOSED name no folders");
        return;
    };
    let text = std::fs::read_to_string(root.join("answers.json")).expect("answers that were dumped");
    let answers: Vec<Value> = serde_json::from_str(&text).expect("a list");
    let all: Vec<Closed> = answers.iter().map(|a| read(a, &closed)).collect();
    for c in all.iter().filter(|c| !c.score.right) {
        let s = &c.score;
        println!("{} {} ({}): want {}; {} {}", s.name, c.group, s.what, s.want.join("+"), s.verdict, s.named.join("+"));
    }
    println!("{}\n{}", rows(&all), calibration(&all));
}

#[test]
fn law_shares_have_their_error() {
    assert_eq!(share(95, 100), "95.0 ± 2.2 % of 100");
    let one = |p: f64, held: bool| Closed {
        group: "A".to_owned(),
        score: Score { finished: true, ..Score::default() },
        aero: Vec::new(),
        strengths: Vec::new(),
        stated: vec![(p, held)],
    };
    let table = calibration(&[one(0.95, true), one(1.0, true), one(0.05, false)]);
    assert!(table.contains("| 0.9 to 1.0 | 2 | 97.5 % | 100.0 ± 0.0 % of 2 |"), "{table}");
    assert!(table.contains("| 0.0 to 0.1 | 1 | 5.0 % | 0.0 ± 0.0 % of 1 |"), "{table}");
}
