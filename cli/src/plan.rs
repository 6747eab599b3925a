//! cli: `windfall plan`. In: a campaign and wanted errors. Out: runs that bring them, and `plan.json`.

use crate::args::PlanArgs;
use crate::session::{Failure, Session};
use std::fmt::Write as _;
use windfall::results::{Plan, TargetPlan};

/// Name of the result file.
const FILE: &str = "plan.json";

pub(crate) fn run(args: &PlanArgs, session: &mut Session<'_>) -> Result<bool, Failure> {
    let campaign = session.campaign(&args.campaign)?;
    let folder = session.outputs(&[FILE])?;
    let found = session.work("planning", || campaign.plan(&args.request))?;
    session.warn_all(&found.warnings);
    session.deliver(folder.as_deref(), FILE, &found, || words(&campaign.data.name, &found))?;
    Ok(found.is_within_reach())
}

fn words(campaign: &str, found: &Plan) -> String {
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
