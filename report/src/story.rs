//! report: the story. In: a closing and its tracks. Out: declared model, residual, effect, before and after in four sentences and a figure.

use crate::html::{escape, section};
use crate::legend::{legend, share};
use crate::plot::{Plot, Plots};
use crate::words::{number, plain_key};
use std::fmt::Write as _;
use windfall_discover::close::{
    ChannelResidual, Closing, EffectLine, Figure, Role, RunTracks, Series, SignalTracks, Topic, TrackSignal,
};

/// Longest curve of the story's figure, points.
const POINTS: usize = 700;

/// The story as a section.
pub(crate) fn story(c: &Closing, tracks: Option<&SignalTracks>, plots: &mut Plots) -> String {
    let steps =
        [("Declared model", declared(c)), ("Residual", residual(c)), ("Effect", effect(c)), ("Before and after", after(c))];
    let mut body = String::from("<ol class=\"story\">");
    for (title, text) in steps {
        let _ = write!(body, "<li><h3>{title}</h3><p>{}</p></li>", escape(&text));
    }
    body += "</ol>\n";
    if let Some(figure) = tracks.and_then(telling) {
        body +=
            &format!("{}<div class=\"broad\">{}</div>", legend(std::slice::from_ref(&figure)), plots.put(Plot::Chart(figure)));
    }
    section("The story", "", &body)
}

fn declared(c: &Closing) -> String {
    let names: Vec<&str> = c.before.parameters.iter().map(|p| p.name.as_str()).collect();
    if names.is_empty() {
        return format!("The declared model of {} is held as it is: no parameter of it is fitted.", c.campaign);
    }
    let s = if names.len() == 1 { "" } else { "s" };
    format!(
        "The declared model of {} has {} parameter{s} ({}), fitted to the runs to identify on.",
        c.campaign,
        names.len(),
        names.join(", ")
    )
}

fn over(r: &ChannelResidual) -> f64 {
    r.rms / r.expected_rms
}

fn residual(c: &Closing) -> String {
    if let Some(words) = &c.declared_departs {
        return format!("It cannot be flown through these runs: {words}.");
    }
    let mut beyond: Vec<&ChannelResidual> = c.residual.per_channel.iter().filter(|r| r.p_value < c.false_alarm_rate).collect();
    beyond.sort_by(|a, b| over(b).total_cmp(&over(a)));
    match beyond.first() {
        None => "It leaves no more than the noise's mean square in any channel.".to_owned(),
        Some(most) => format!(
            "It leaves more than noise in {} of {} channels: most in {}, {} times the noise.",
            beyond.len(),
            c.residual.per_channel.len(),
            plain_key(&most.channel).0,
            number(over(most))
        ),
    }
}

/// The finding's own words, with the probability of what is named.
fn effect(c: &Closing) -> String {
    let one = |e: &EffectLine| e.probability.map(|p| format!("{} {}", e.family, share(p)));
    let all: Vec<String> = c.effects.iter().filter_map(one).collect();
    let odds = if all.is_empty() { String::new() } else { format!(" Probability: {}.", all.join(", ")) };
    c.lacks() + &odds
}

fn after(c: &Closing) -> String {
    c.held_out_errors().unwrap_or_else(|| "No run is held out, so that no prediction was tested.".to_owned())
}

/// The channel of a held-out run in which the models differ most: measured, before and after.
fn telling(t: &SignalTracks) -> Option<Figure> {
    let held: Vec<&RunTracks> = t.runs.iter().filter(|r| r.used == "hold-out").collect();
    let runs = if held.is_empty() { t.runs.iter().collect() } else { held };
    let all = runs.into_iter().flat_map(|r| r.channels.iter().map(move |c| (r, c)));
    let raw = all.filter(|(_, c)| c.noise_std.is_some() && !c.measured.is_empty() && !c.before.is_empty());
    let (run, channel) = raw.max_by(|a, b| departure(a.1).total_cmp(&departure(b.1)))?;
    let sides = [(Role::Measured, &channel.measured), (Role::Before, &channel.before), (Role::After, &channel.after)];
    Some(Figure {
        topic: Topic::Trajectory,
        title: format!("{} of held-out run {}: measured, and flown again", channel.name, run.name),
        x_label: "time in the run (s)".to_owned(),
        y_label: format!("{} ({})", channel.name, channel.unit),
        series: sides.into_iter().filter(|(_, y)| !y.is_empty()).map(|(role, y)| thinned(role, &run.t_s, y, POINTS)).collect(),
        ..Figure::default()
    })
}

/// Mean square of the declared model's error, over its sensor's noise.
fn departure(c: &TrackSignal) -> f64 {
    let n = c.measured.len().min(c.before.len()).max(1) as f64;
    let error = c.measured.iter().zip(&c.before).map(|(m, b)| (m - b).powi(2)).sum::<f64>() / n;
    c.noise_std.filter(|s| *s > 0.0).map_or(error, |s| error / (s * s))
}

/// A curve of at most so many points.
pub(crate) fn thinned(role: Role, x: &[f64], y: &[f64], points: usize) -> Series {
    let n = x.len().min(y.len());
    let stride = n.div_ceil(points).max(1);
    let some = |s: &[f64]| s[..n].iter().step_by(stride).copied().collect();
    Series { role, x: some(x), y: some(y), ..Series::default() }
}
