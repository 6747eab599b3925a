//! cli: `windfall close`. In: a campaign, or a scenario that is flown first. Out: the story on a screenful, `close.json`,
//! `figures.json`, `tracks.json`, `smoothing.json` and `report.html`.

use crate::args::CloseArgs;
use crate::lines::folded;
use crate::session::{Failure, Session};
use std::cmp::Ordering;
use std::fmt::Write as _;
use std::path::Path;
use windfall::files::{series_text, text_atomically, write_json_atomically};
use windfall::report::{closing_page, number, p_value, p_with_sign, with_interval};
use windfall::results::{CheckedRuns, Closing, EffectLine, HeldOut, NORMAL_95, Verdict, statistics_table};
use windfall::{CampaignSource, Close, Fly, Published};

/// Names of the result files; without a campaign there are no figures.
const FILES: [&str; 5] = ["close.json", "figures.json", "tracks.json", "smoothing.json", "report.html"];
const STATISTICS_FILES: [&str; 2] = [FILES[0], FILES[4]];

pub(crate) fn run(args: &CloseArgs, session: &mut Session<'_>) -> Result<bool, Failure> {
    match (&args.campaign, &args.statistics) {
        (_, Some(file)) => close_statistics(file, &args.request, session),
        (Some(campaign), None) => close_campaign(campaign, &args.request, session),
        (None, None) => Ok(true),
    }
}

fn close_campaign(word: &Path, request: &Close, session: &mut Session<'_>) -> Result<bool, Failure> {
    let source = CampaignSource::find(word)?;
    if let CampaignSource::Campaign(campaign) = &source {
        session.warn_all(&campaign.warnings);
    }
    let folder = session.outputs(&FILES)?;
    let campaign = match source {
        CampaignSource::Campaign(campaign) => *campaign,
        CampaignSource::Scenario(scenario) => {
            let flights = session.fly(&scenario, &Fly::default())?;
            flights.summary(false).flights.iter().filter_map(|f| f.warning.as_deref()).for_each(|w| session.warn(w));
            flights.campaign()
        }
    };
    let (closing, (drawn, tracks, smoothed)) = session.work("closing the loop", || {
        let closing = campaign.close(request)?;
        let seen = || {
            let (drawn, tracks) = (campaign.figures(&closing), campaign.tracks(&closing));
            (drawn.unwrap_or_default(), tracks.unwrap_or_default(), campaign.smoothing(None).unwrap_or_default())
        };
        // Without a file nobody sees them.
        let seen = if folder.is_some() { seen() } else { Default::default() };
        Ok((closing, seen))
    })?;
    let series = [series_text(&tracks)?, series_text(&smoothed)?];
    session.write(folder.as_deref(), |stage| {
        write_json_atomically(&stage.join(FILES[0]), &closing)?;
        write_json_atomically(&stage.join(FILES[1]), &drawn)?;
        // Long series, a line for all.
        text_atomically(&stage.join(FILES[2]), &series[0])?;
        text_atomically(&stage.join(FILES[3]), &series[1])?;
        Ok(text_atomically(&stage.join(FILES[4]), &closing_page(&closing, &drawn, Some(&tracks), Some(&smoothed)))?)
    })?;
    session.show(&closing, || words(&closing))?;
    session.written(folder.as_deref(), &FILES);
    Ok(closing.verdict != Verdict::Unexplained)
}

fn close_statistics(word: &Path, request: &Close, session: &mut Session<'_>) -> Result<bool, Failure> {
    let published = Published::find(word)?;
    let folder = session.outputs(&STATISTICS_FILES)?;
    let closing = session.work("searching the catalogue", || published.close(request))?;
    session.write(folder.as_deref(), |stage| {
        write_json_atomically(&stage.join(STATISTICS_FILES[0]), &closing)?;
        Ok(text_atomically(&stage.join(STATISTICS_FILES[1]), &published.page(&closing)?)?)
    })?;
    session.show(&closing, || statistics_table(&closing))?;
    session.written(folder.as_deref(), &STATISTICS_FILES);
    Ok(closing.verdict != "unexplained")
}

/// What is printed of a closing: the result on a screenful.
#[must_use]
pub fn words(c: &Closing) -> String {
    let mut text = format!("{}: {}\n", c.campaign, folded(&c.concluded().sentence, c.campaign.len() + 2));
    c.effects.iter().for_each(|e| effect(&mut text, e));
    text += &crate::fitted::lines(c);
    channels(&mut text, c);
    if let (Some(b), Some(a)) = (&c.before.hold_out, &c.after.hold_out) {
        held_out(&mut text, b, a, !c.effects.is_empty());
    }
    checks(&mut text, c);
    text += &crate::wind_tunnel::lines(&c.wind_tunnel);
    for note in c.notes() {
        let _ = writeln!(text, "\n{}", folded(&note, 0));
    }
    for u in &c.unexplained {
        let _ = writeln!(text, "\nunexplained {}: {}", u.channel, folded(&u.description, u.channel.len() + 14));
    }
    text
}

fn effect(text: &mut String, e: &EffectLine) {
    let _ = writeln!(text, "\n{}   chance from noise alone {}", e.family, p_value(e.p_value));
    let _ = writeln!(text, "  {}", folded(&e.physics, 2));
    for p in e.shown_parameters() {
        let unit = if p.unit == "-" { "" } else { p.unit.as_str() };
        let (estimate, half) = with_interval(p.estimate, p.std_error.map(|s| NORMAL_95 * s));
        let half = half.map_or_else(String::new, |h| format!(" ± {h} (95 %)"));
        let end = if p.at_end { " at the end of its range" } else { "" };
        let _ = writeln!(text, "  {:<20}{estimate:>12}{half} {unit}{end}", p.name);
    }
    for f in &e.flown {
        let name = f.words();
        let [least, most] = [&f.least, &f.most].map(|v| {
            let (estimate, half) = with_interval(v.estimate, Some(NORMAL_95 * v.std_error));
            format!("{estimate}{} ({})", half.map_or_else(String::new, |h| format!(" ± {h}")), v.run)
        });
        let _ = writeln!(text, "  {}", folded(&format!("{name}: {least} to {most}"), 2));
    }
    for r in &e.by_run {
        let (departure, half) = with_interval(r.value, Some(NORMAL_95 * r.std_error));
        let half = half.map_or_else(String::new, |h| format!(" ± {h} (95 %)"));
        let unit = if r.unit == "-" { " of itself" } else { " m" };
        let _ = writeln!(text, "  {}: {} differs by {departure}{half}{unit}", r.run, r.name);
    }
    if let Some([calm, strong]) = e.bursts {
        let _ = writeln!(text, "  in bursts: between {calm:.2} and {strong:.2} of its mean size in nine tenths of the time");
    }
    if e.steep_edges {
        let _ = writeln!(text, "  its band ends steeply at its edges");
    }
    if !e.rivals.is_empty() {
        let rivals = format!("rivals on these data: {}; what would separate them: {}", e.rivals.join(", "), e.separate_by);
        let _ = writeln!(text, "  {}", folded(&rivals, 2));
    }
}

fn channels(text: &mut String, c: &Closing) {
    let _ = writeln!(
        text,
        "\n{:<34}{:>10}{:>10}{:>10}{:>12}{:>12}",
        "residual rms of identified runs", "before", "after", "noise", "p before", "p after"
    );
    for (b, a) in c.residual.per_channel.iter().zip(&c.residual_after.per_channel) {
        let _ = writeln!(
            text,
            "  {:<32}{:>10}{:>10}{:>10}{:>12}{:>12}",
            b.channel,
            number(b.rms),
            number(a.rms),
            number(a.expected_rms),
            p_value(b.p_value),
            p_value(a.p_value)
        );
    }
}

/// How many of the checks run by run pass, and the worst of them.
fn checks(text: &mut String, c: &Closing) {
    let (all, failed) = (c.checks.len(), c.checks.iter().filter(|l| !l.ok).count());
    let Some(worst) = c.checks.iter().min_by(|a, b| (a.ok, a.p_value).partial_cmp(&(b.ok, b.p_value)).unwrap_or(Ordering::Equal))
    else {
        return;
    };
    let of = if worst.run.is_empty() { String::new() } else { format!(" of {}", worst.run) };
    let used = if worst.used == CheckedRuns::HoldOut { "held out" } else { "identified on" };
    let words = format!(
        "{} of {all} checks of runs and channels pass (1 %, all together); least {}: {}{of}, {used}",
        all - failed,
        p_with_sign(worst.p_value),
        worst.what
    );
    let _ = writeln!(text, "\n{}", folded(&words, 0));
}

fn held_out(text: &mut String, b: &HeldOut, a: &HeldOut, added: bool) {
    let _ = writeln!(text, "\n{:<34}{:>10}{:>10}{:>14}", "error on runs held out, rms", "before", "after", "after/before");
    let mut line = |what: &str, b: f64, a: f64| {
        let _ = writeln!(text, "  {what:<32}{:>10}{:>10}{:>14.3}", number(b), number(a), a / b);
    };
    let three = |v: [f64; 3]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
    if let (Some(b), Some(a)) = (b.specific_force_rms, a.specific_force_rms) {
        line("force over mass (m/s2)", three(b), three(a));
    }
    if let (Some(b), Some(a)) = (b.specific_moment_rms, a.specific_moment_rms) {
        line("moment over inertia (rad/s2)", three(b), three(a));
    }
    if let (Some(b), Some(a)) = (b.trajectory, a.trajectory) {
        if let (Some(b), Some(a)) = (b.attitude_rms_deg, a.attitude_rms_deg) {
            line("attitude, flown again (deg)", b, a);
        }
        if let (Some(b), Some(a)) = (b.rate_rms_deg_s, a.rate_rms_deg_s) {
            line("body rates, flown again (deg/s)", b, a);
        }
    }
    if let (Some(b), Some(a)) = (b.position_rms_m, a.position_rms_m) {
        line("position, flown again (mm)", 1e3 * b, 1e3 * a);
    }
    if let (Some(b), Some(a), true) = (b.log_likelihood, a.log_likelihood, added) {
        let _ = writeln!(text, "  {:<32}{:>20}", "gain of log-likelihood", number(a - b));
    }
}

#[cfg(test)]
mod tests {
    use super::folded;

    #[test]
    fn law_folding_keeps_words_and_width() {
        let words = "a residual beyond noise ".repeat(20);
        let lines = folded(words.trim(), 10);
        assert!(lines.lines().all(|l| l.chars().count() <= 100));
        assert_eq!(lines.split_whitespace().count(), 80);
    }
}
