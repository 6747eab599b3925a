//! cli: `windfall close`. In: a campaign, or a scenario that is flown first. Out: the story on a screenful, `close.json`,
//! `figures.json` and `report.html`.

use crate::args::CloseArgs;
use crate::close_statistics;
use crate::flights;
use crate::session::{Failure, Session, is_bundled, scenario};
use std::fmt::Write as _;
use std::path::Path;
use windfall_model::Campaign;
use windfall_report::{closing_page, number, p_value, sentence, with_interval};
use windfall_scenarios::{FileKind, kind_of, read_campaign_with_warnings, text_atomically, write_json_atomically};
use windfall_verify::close::{Closing, EffectLine, HeldOut, Options, Verdict, close, figures};

/// Names of the result files.
pub(crate) const FILES: [&str; 3] = ["close.json", "figures.json", "report.html"];

pub(crate) fn run(args: &CloseArgs, session: &mut Session<'_>) -> Result<bool, Failure> {
    match (&args.campaign, &args.statistics) {
        (_, Some(file)) => close_statistics::run(file, session),
        (Some(campaign), None) => close_campaign(campaign, session),
        (None, None) => Ok(true),
    }
}

fn close_campaign(word: &Path, session: &mut Session<'_>) -> Result<bool, Failure> {
    let read = read(word, session)?;
    let folder = session.outputs(&FILES.map(str::to_owned))?;
    let campaign = match read {
        Input::Campaign(campaign) => *campaign,
        Input::Scenario(file) => flights::campaign(&file, session)?,
    };
    let options = Options::default();
    let spinner = session.spinner("closing the loop");
    let closed = session.pool()?.install(|| {
        let closing = close(&campaign, &options)?;
        let drawn = if folder.is_some() { figures(&campaign, &closing, &options).unwrap_or_default() } else { Vec::new() };
        Ok((closing, drawn))
    });
    spinner.finish_and_clear();
    let (closing, drawn) = closed.map_err(Failure::of_verification)?;
    if let Some(folder) = &folder {
        write_json_atomically(&folder.join(FILES[0]), &closing)?;
        write_json_atomically(&folder.join(FILES[1]), &drawn)?;
        text_atomically(&folder.join(FILES[2]), &closing_page(&closing, &drawn))?;
    }
    if session.common.json {
        session.print_json(&closing)?
    } else {
        session.print(&story(&closing))?
    }
    if let Some(folder) = &folder {
        session.say(&format!("written to {}: {}", folder.display(), FILES.join(", ")));
    }
    Ok(closing.verdict != Verdict::Unexplained)
}

/// What the word on the command line names.
enum Input {
    Campaign(Box<Campaign>),
    Scenario(Box<windfall_scenarios::ScenarioFile>),
}

fn read(word: &Path, session: &mut Session<'_>) -> Result<Input, Failure> {
    if is_bundled(word) || (word.is_file() && kind_of(word)? == FileKind::Scenario) {
        return Ok(Input::Scenario(Box::new(scenario(word)?)));
    }
    let (campaign, notes) = read_campaign_with_warnings(word)?;
    notes.iter().for_each(|n| session.warn(n));
    Ok(Input::Campaign(Box::new(campaign)))
}

/// The result on a screenful.
fn story(c: &Closing) -> String {
    let mut text = format!("{}: {}\n", c.campaign, folded(&sentence(c), c.campaign.len() + 2));
    c.effects.iter().for_each(|e| effect(&mut text, e));
    channels(&mut text, c);
    if let (Some(b), Some(a)) = (&c.before.hold_out, &c.after.hold_out) {
        held_out(&mut text, b, a);
    }
    for u in &c.unexplained {
        let _ = writeln!(text, "\nunexplained {}: {}", u.channel, folded(&u.description, u.channel.len() + 14));
    }
    text
}

/// Words in lines of at most a hundred characters, `indent` already taken on the first.
fn folded(words: &str, indent: usize) -> String {
    let mut out = String::new();
    let mut at = indent;
    for word in words.split(' ') {
        if at + word.chars().count() > 100 {
            out.push_str("\n  ");
            at = 2;
        } else if !out.is_empty() {
            out.push(' ');
            at += 1;
        }
        out.push_str(word);
        at += word.chars().count();
    }
    out
}

fn effect(text: &mut String, e: &EffectLine) {
    let _ = writeln!(text, "\n{}   chance from noise alone {}", e.family, p_value(e.p_value));
    let _ = writeln!(text, "  {}", folded(&e.physics, 2));
    for p in &e.parameters {
        let unit = if p.unit == "-" { "" } else { p.unit.as_str() };
        let (estimate, half) = with_interval(p.estimate, p.std_error.map(|s| 1.96 * s));
        let half = half.map_or_else(String::new, |h| format!(" ± {h} (95 %)"));
        let _ = writeln!(text, "  {:<20}{estimate:>12}{half} {unit}", p.name);
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

fn held_out(text: &mut String, b: &HeldOut, a: &HeldOut) {
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
    if let (Some(b), Some(a)) = (b.log_likelihood, a.log_likelihood) {
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
