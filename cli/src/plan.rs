//! cli: `windfall plan`. In: a campaign and wanted errors. Out: runs that bring them, and `plan.json`.

use crate::args::PlanArgs;
use crate::session::{Failure, Session};
use std::fmt::Write as _;
use windfall_pid::plan::{Plan, Target, TargetPlan, Wanted, plan};
use windfall_scenarios::read_campaign_with_warnings;

/// Name of the result file.
const FILE: &str = "plan.json";

pub(crate) fn run(args: &PlanArgs, session: &mut Session<'_>) -> Result<bool, Failure> {
    let (campaign, notes) = read_campaign_with_warnings(&args.campaign)?;
    notes.iter().for_each(|n| session.warn(n));
    let folder = session.outputs(&[FILE.to_owned()])?;
    let spinner = session.spinner("planning");
    let found = session.pool()?.install(|| plan(&campaign, &args.target, args.between));
    spinner.finish_and_clear();
    let found = found.map_err(Failure::of_identification)?;
    found.warnings.iter().for_each(|w| session.warn(w));
    session.deliver(folder.as_deref(), FILE, &found, || words(&campaign.name, &found))?;
    // The verdict is no where a wanted error is out of reach.
    Ok(found.targets.iter().all(|t| t.std_error_now <= t.std_error_wanted || !t.options.is_empty()))
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

/// A target as typed: `NAME=5%` or `NAME=0.1`.
pub(crate) fn target(word: &str) -> Result<Target, String> {
    let fault = || format!("{word}: write PARAMETER=ERROR with a positive error, as in Cm_2=5% or Cm_2=10");
    let (name, error) = word.split_once('=').ok_or_else(fault)?;
    let number = |text: &str| text.trim().parse::<f64>().ok().filter(|v| *v > 0.0 && v.is_finite()).ok_or_else(fault);
    let error = match error.strip_suffix('%') {
        Some(percent) => Wanted::Percent(number(percent)?),
        None => Wanted::Absolute(number(error)?),
    };
    Ok(Target { parameter: name.trim().to_owned(), error })
}

/// A time of zero or more seconds.
pub(crate) fn seconds(word: &str) -> Result<f64, String> {
    word.parse()
        .ok()
        .filter(|s: &f64| *s >= 0.0 && s.is_finite())
        .ok_or_else(|| format!("{word}: a number of seconds, 0 or more"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn law_targets_as_typed() {
        let percent = Target { parameter: "Cm_2".to_owned(), error: Wanted::Percent(5.0) };
        assert_eq!(target("Cm_2=5%"), Ok(percent));
        assert_eq!(target("Cm_2 = 10").map(|t| t.error), Ok(Wanted::Absolute(10.0)));
        for bad in ["Cm_2", "Cm_2=", "Cm_2=-1", "Cm_2=nan", "Cm_2=0%", "Cm_2=inf"] {
            assert!(target(bad).is_err_and(|e| e.contains("PARAMETER=ERROR")), "{bad}");
        }
        assert!(seconds("-1").is_err() && seconds("0").is_ok());
    }
}
