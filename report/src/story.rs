//! report: the story. In: a closing and its tracks. Out: declared model, residual, effect, before and after in four sentences and a figure.

use crate::html::{escape, section};
use crate::legend::{legend, share};
use crate::plot::{Plot, Plots};
use crate::words::{listed, no_form_holds, number, plain_key};
use std::fmt::Write as _;
use windfall_discover::close::{
    ChannelResidual, Closing, Figure, HeldOut, Role, RunTracks, Series, SignalTracks, Topic, TrackSignal, Verdict,
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
    let mut beyond: Vec<&ChannelResidual> = c.residual.per_channel.iter().filter(|r| r.p_value < c.false_alarm_rate).collect();
    beyond.sort_by(|a, b| over(b).total_cmp(&over(a)));
    match beyond.first() {
        None => "What it leaves is noise in every channel.".to_owned(),
        Some(most) => format!(
            "It leaves more than noise in {} of {} channels: most in {}, {} times the noise.",
            beyond.len(),
            c.residual.per_channel.len(),
            plain_key(&most.channel).0,
            number(over(most))
        ),
    }
}

fn effect(c: &Closing) -> String {
    match c.verdict {
        Verdict::Consistent => "No effect of the catalogue is needed.".to_owned(),
        Verdict::Unexplained => "No effect of the catalogue accounts for it.".to_owned(),
        Verdict::Effect => {
            let one = |e: &windfall_discover::close::EffectLine| {
                let odds = e.probability.map_or_else(String::new, |p| format!(" (probability {})", share(p)));
                format!("{}{odds}", e.family)
            };
            let names: Vec<String> = c.effects.iter().map(one).collect();
            let rivals: Vec<&str> = c.effects.iter().flat_map(|e| e.rivals.iter().map(String::as_str)).collect();
            let or =
                if rivals.is_empty() { String::new() } else { format!("; these data cannot tell it from {}", listed(&rivals)) };
            let fails = no_form_holds(c);
            let how = if fails { "Nearest to it comes" } else { "It traces to" };
            let form = if fails { ", whose form does not hold" } else { "" };
            format!("{how} {}{or}{form}.", listed(&names))
        }
    }
}

fn after(c: &Closing) -> String {
    let (Some(b), Some(a)) = (&c.before.hold_out, &c.after.hold_out) else {
        return "No run is held out, so that no prediction was tested.".to_owned();
    };
    let angle = |h: &HeldOut| h.trajectory.and_then(|t| t.attitude_rms_deg);
    let added = c.verdict == Verdict::Effect;
    let pair = |what: &str, b: f64, a: f64, unit: &str| {
        if added { format!("{what} {}{unit} → {}{unit}", number(b), number(a)) } else { format!("{what} {}{unit}", number(b)) }
    };
    let attitude = angle(b).zip(angle(a)).map(|(b, a)| pair("attitude", b, a, "°"));
    let position = b.position_rms_m.zip(a.position_rms_m).map(|(b, a)| pair("position", 1e3 * b, 1e3 * a, " mm"));
    let all: Vec<String> = attitude.into_iter().chain(position).collect();
    let what = if added { "declared model → with the effects added" } else { "with the model as it is" };
    format!("Error on runs held out, rms, {what}: {}.", all.join(", "))
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
