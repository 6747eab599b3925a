//! cli: `windfall plan`. In: a campaign and wanted errors. Out: runs that bring them, and `plan.json`.

use crate::args::PlanArgs;
use crate::session::{Failure, Session};
use std::fmt::Write as _;
use windfall::results::{NextRun, Planned, Separation, TargetPlan, TestPlan};

/// Name of the result file.
const FILE: &str = "plan.json";

pub(crate) fn run(args: &PlanArgs, session: &mut Session<'_>) -> Result<bool, Failure> {
    let campaign = session.campaign(&args.campaign)?;
    let folder = session.outputs(&[FILE])?;
    let found = session.work("planning", || campaign.plan(&args.request))?;
    if let Planned::Targets(plan) = &found {
        session.warn_all(&plan.warnings);
    }
    session.deliver(folder.as_deref(), FILE, &found, || words(&campaign.data.name, &found))?;
    Ok(found.is_within_reach())
}

/// What is printed of a plan.
#[must_use]
pub fn words(campaign: &str, found: &Planned) -> String {
    match found {
        Planned::Targets(plan) => targets(campaign, plan),
        Planned::Rivals(separation) => parted(separation),
    }
}

fn targets(campaign: &str, found: &TestPlan) -> String {
    let mut text = format!(
        "{campaign}, {}\nhovers at {:.3} m/s; flown so far up to {:.1} deg; {:.0} s between runs\n",
        found.method, found.trim_m_s, found.flown_deg, found.between_s
    );
    found.targets.iter().for_each(|t| target_words(&mut text, t, found.flown_deg));
    text
}

fn target_words(text: &mut String, t: &TargetPlan, flown_deg: f64) {
    let percent = |e: f64| 100.0 * e / t.estimate.abs();
    let _ = writeln!(
        text,
        "\n{} = {:.5} with a standard error of {:.3e} ({:.2} %); wanted {:.3e} ({:.2} %)",
        t.parameter,
        t.estimate,
        t.std_error_now,
        percent(t.std_error_now),
        t.std_error_wanted,
        percent(t.std_error_wanted)
    );
    if t.std_error_now <= t.std_error_wanted {
        text.push_str("  reached already: no more tunnel time\n");
    }
    let Some(best) = t.options.first() else { return };
    let _ = writeln!(
        text,
        "  {:.1} min of tunnel time: {} run(s) of {:.0} s released at {:.0} deg",
        best.minutes, best.runs, best.run_s, best.release_deg
    );
    let _ = writeln!(text, "  {:>12}{:>8}{:>10}{:>10}{:>12}", "release deg", "runs", "each s", "minutes", "error %");
    for o in &t.options {
        let beyond = if o.release_deg > flown_deg { "   beyond the angles flown: extrapolated" } else { "" };
        let e = percent(o.std_error);
        let _ = writeln!(text, "  {:>12.0}{:>8}{:>10.0}{:>10.1}{e:>12.2}{beyond}", o.release_deg, o.runs, o.run_s, o.minutes);
    }
}

/// A table of pairs and of bounds.
fn parted(s: &Separation) -> String {
    let set = |f: &[String]| if f.is_empty() { "nothing".to_owned() } else { f.join(" + ") };
    let mut text = format!("{}: {} is named; {} runs were tried\n", s.campaign, set(&s.families), s.tried);
    if s.pairs.is_empty() {
        text.push_str("no other set comes within twenty to one: nothing to part\n");
    }
    for pair in &s.pairs {
        let _ = writeln!(text, "\n{} or {}: {:.1} to 1 now", set(&pair.families), set(&pair.rival), pair.log_odds_now.exp());
        if pair.runs.is_empty() {
            text.push_str("  no run that was tried parts them\n");
        } else {
            let _ = writeln!(text, "  {}{:>24}{:>22}", HEAD, "expected log odds", "when flown");
        }
        for r in &pair.runs {
            let [a, b] = r.log_odds;
            let flown = r.simulated.map_or_else(String::new, |[a, b]| format!("{a:.1} or {b:.1}"));
            let _ = writeln!(text, "  {}{:>24}{flown:>22}", columns(&r.run), format!("{a:.1} or {b:.1}"));
        }
    }
    if !s.bounds.is_empty() {
        let _ = writeln!(
            text,
            "\nwide bounds, and the run that sharpens each most for its tunnel time\n  {HEAD}{:>24}",
            "standard error"
        );
    }
    for b in &s.bounds {
        let errors = format!("{:.2e} -> {:.2e}", b.std_error_now, b.std_error_then);
        let _ = writeln!(text, "  {}{errors:>24}  {} {} ({})", columns(&b.run), b.family, b.parameter, b.unit);
    }
    text
}

const HEAD: &str = "release deg  spin deg/s  offset m  speed swing  length s";

fn columns(r: &NextRun) -> String {
    let swing = format!("{:.0} %", 100.0 * r.speed_swing);
    format!("{:>11.0}{:>12.0}{:>10.1}{swing:>13}{:>10.0}", r.release_deg, r.spin_deg_s, r.offset_m, r.duration_s)
}
