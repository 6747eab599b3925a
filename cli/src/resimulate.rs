//! cli: `windfall resimulate`. In: a campaign and an identification. Out: how near its flights come, in the layout of Table 5.6.

use crate::args::ResimulateArgs;
use crate::session::{Failure, Session};
use std::fmt::Write as _;
use windfall::files::series_text;
use windfall::read_identification;
use windfall::results::{Resimulation, RunComparison, SignalTracks, Statistic};

/// Names of the result files.
const FILES: [&str; 2] = ["resimulation.json", "flights.json"];

pub(crate) fn run(args: &ResimulateArgs, session: &mut Session<'_>) -> Result<bool, Failure> {
    let campaign = session.campaign(&args.campaign)?;
    let model = read_identification(&args.model)?;
    let folder = session.outputs(&FILES)?;
    let (result, tracks) = session.work("flying the identified model", || {
        let result = campaign.resimulate(&model, &args.request)?;
        let tracks = if folder.is_some() { campaign.flight_tracks(&model)? } else { SignalTracks::default() };
        Ok((result, tracks))
    })?;
    session.warn_all(&result.warnings);
    let beside = [series_text(&tracks)?];
    session.deliver_with(folder.as_deref(), &FILES, (&result, &beside), || words(&campaign.data.name, &result))?;
    Ok(true)
}

/// What is printed of a re-simulation.
#[must_use]
pub fn words(campaign: &str, r: &Resimulation) -> String {
    let mut text = format!("{campaign}, parameters of {} by {}, {} seeds\n\n", r.data_set, r.method, r.seeds);
    let _ = writeln!(
        text,
        "{:<24}{:<10}{:>16}{:>16}{:>16}{:>10}",
        "run", "use", "attitude (deg)", "position (m)", "rates (deg/s)", "misfit"
    );
    for run in &r.runs {
        run_line(&mut text, run);
    }
    let all = &r.trajectory;
    let _ = writeln!(
        text,
        "{:<24}{:<10}{:>16.4}{:>16.5}{:>16.4}\n",
        "all, rms", "", all.attitude_rms_deg, all.position_rms_m, all.rate_rms_deg_s
    );
    let drawn = if r.statistics.iter().any(|s| s.draws_ci95.is_some()) { "95 % over parameters drawn" } else { "" };
    let _ = writeln!(
        text,
        "{:<18}{:<10}{:>12}{:>14}{:>18}{drawn:>30}",
        "quantity", "statistic", "test", "simulation", "std over seeds"
    );
    r.statistics.iter().for_each(|s| statistic_line(&mut text, s));
    text
}

fn run_line(text: &mut String, run: &RunComparison) {
    let t = &run.trajectory;
    let _ = writeln!(
        text,
        "{:<24}{:<10}{:>16.4}{:>16.5}{:>16.4}{:>10}",
        run.name,
        run.used,
        t.attitude_rms_deg,
        t.position_rms_m,
        t.rate_rms_deg_s,
        run.misfit.map_or_else(|| "–".to_owned(), |m| format!("{m:.3}"))
    );
}

fn statistic_line(text: &mut String, s: &Statistic) {
    let spread = s.simulation_std.map_or_else(String::new, |x| format!("{x:.4}"));
    let drawn = s.draws_ci95.map_or_else(String::new, |[a, b]| format!("[{a:.4}, {b:.4}]"));
    let line = format!("{:<18}{:<10}{:>12.4}{:>14.4}{spread:>18}{drawn:>30}", s.quantity, s.statistic, s.test, s.simulation);
    let _ = writeln!(text, "{}", line.trim_end());
}
