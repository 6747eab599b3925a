//! report: the page of a closing. In: a closing and its figures. Out: HTML.

use crate::chart::Bar;
use crate::checks::checks;
use crate::cut::say_beyond;
use crate::data::data;
use crate::draw::Look;
use crate::held_out::held_out;
use crate::html::{Cell, escape, page, section, table};
use crate::legend::{key, legend, share};
use crate::plot::{Plot, Plots};
use crate::shape::{constants, innovations, moves, noise, sets, warnings};
use crate::signals::signals;
use crate::smoothing::smoothing;
use crate::story::story;
use crate::svg::dots;
use crate::wind_tunnel::differences;
use crate::words::{channel, number, p_value, p_with_sign, plain_key, with_interval, with_unit};
use std::fmt::Write as _;
use windfall_discover::NORMAL_95;
use windfall_discover::close::{
    ChannelResidual, Closing, EffectLine, Figure, ParameterLine, SignalTracks, SmoothingTracks, Topic,
};

/// The page of a closing: story, replay, signals, errors before and after, effects, residuals, innovations, noise, constants,
/// parameters, candidates, bounds, leads, smoothing. Figures may be none, tracks and smoothed records may be missing.
#[must_use]
pub fn closing_page(
    c: &Closing,
    figures: &[Figure],
    tracks: Option<&SignalTracks>,
    smoothed: Option<&SmoothingTracks>,
) -> String {
    let mut plots = Plots::default();
    let body = closing_body(c, figures, tracks, &mut plots) + &smoothing(smoothed, &mut plots) + &footer();
    let named = [("tracks", tracks), (crate::smoothing::ID, smoothed.map(|s| &s.signals))];
    let named: Vec<(&str, &SignalTracks)> = named.into_iter().filter_map(|(id, t)| Some((id, t?))).collect();
    page(&format!("{}: loop closed", c.campaign), &body, &data(&named, &plots))
}

/// Everything of a closing but the smoothed records and the footer.
pub(crate) fn closing_body(c: &Closing, figures: &[Figure], tracks: Option<&SignalTracks>, plots: &mut Plots) -> String {
    let mut out = head(c) + &story(c, tracks, plots);
    out += &tracks.map_or_else(String::new, |t| signals("tracks", t));
    let held = "Runs that nothing was fitted to: the right column says how much of the error is left. Parameters as identified; only each \
                run's initial state is estimated from it, and the run is flown again with its recorded tunnel speed. Force and moment \
                residuals include the sensor noise of the smoothed record. Statistics are those of the thesis' Table 5.6.";
    out += &section("Runs held out: before and after", held, &held_out(c));
    let lead = "Look for the blue curve on the grey one, and for errors that do not grow with time.";
    out += &topic(figures, Topic::Trajectory, "Runs held out, flown again", lead, plots);
    let lead = "Look for the colours on the grey steps: the share of the time that the model spends at an angle and at a rate, as the \
                thesis' figure 5.8 has it.";
    out += &topic(figures, Topic::Distribution, "Distributions of Θ and ω_q,r", lead, plots);
    let lead = "Each effect with its size and what it rests on; a rival is an effect that these data cannot tell from it.";
    out += &section("What the declared model lacks", lead, &(effects(c) + &sets(c)));
    let lead = "Compare the columns with that of the noise: a channel is explained when its p-value is not small. rms of what each model \
                leaves in the channel, over what noise would leave; p: chance of as much or more from noise alone.";
    out += &section("Residual against noise", lead, &residuals(c));
    let lead = "Look for marks: runs and channels in which the model with the effects leaves more than noise. Mean square of what is left over the \
                noise's, one where the model is right; all checks together at 1 % (Holm). Noise is said to remain only where all pass.";
    out += &section("Checks run by run", lead, &checks(c));
    let lead = "Look for curves that come down to the dashed line. All identified runs joined, each point a band of frequencies.";
    out += &topic(figures, Topic::Spectrum, "Residual spectra", lead, plots);
    out += &innovations(c, plots);
    let lead = "Look for histograms under the dashed bell, the stated noise of a sample, and correlations inside the dashed lines. A residual \
                that is wider and follows itself for many samples is a tracker's drift or a force that the model lacks. Cut at three times the reach of \
                the narrower one; what lies beyond is counted above each.";
    out += &topic(figures, Topic::Shape, "Residuals of the tracks: distribution and correlation", lead, plots);
    let lead = "Look for curves at one and for histograms under the dashed bell. Slow parts above one are a tracker's drift or a force that the \
                model lacks, fast ones noise that is larger than stated. Residuals of the runs held out with the initial state taken out, in \
                independent numbers from slow to fast, each over the noise of the tracker in it.";
    out += &topic(figures, Topic::Whitened, "Whitened residuals of the tracks", lead, plots);
    let lead = "Look for points that leave the dashed line together where a setting is large: a force that follows it (a spinning ball's \
                lift). Each point is a run, its push the parabola in what the model leaves of its track; bars: 95 % of the tracker's noise alone. Of a \
                lift coefficient: points along the blue line; one beside it by more than its bar is a launch with another spin.";
    out += &topic(figures, Topic::Setting, "What every run lacks over its settings", lead, plots);
    let lead =
        "Look for curves that become flat. Means over intervals of equal count, of the channels that stand highest above noise.";
    out += &topic(figures, Topic::Variable, "Residual over the variable that it follows best", lead, plots);
    out +=
        &section("What remains, as a lead", "A residual beyond noise that no effect of the catalogue accounts for.", &leads(c));
    let lead = "Look for ratios far from one: noise that is not as declared. Colour: correlation from one sample to the next.";
    out += &section("Noise learnt against noise declared", lead, &noise(c));
    let lead =
        "Look for dots away from zero by more than the bar: a constant found elsewhere than declared, in its own uncertainty.";
    out += &section("Constants found against constants declared", lead, &constants(c, plots));
    let lead = "Look for dots away from zero: declared parameters that the effects moved, in standard errors before.";
    out += &section("Parameters: how they moved", lead, &(moves(c, plots) + &crate::fitted::shifts(c)));
    let lead = "Look whether the points lie nearer to the blue curve than to the red one: an effect that brings identified static coefficients to a \
                balance's, which they were not fitted to, is real. The dashed line: the largest angle flown. About the geometric origin.";
    out += &topic(figures, Topic::Static, "Static coefficients against the wind tunnel", lead, plots);
    let side = |m: &str| if m == "before" { "declared model" } else { "with effects" }.to_owned();
    out += &section("Differences to the wind tunnel", "Look for a smaller rms with effects.", &differences(&c.wind_tunnel, side));
    let lead = "Look at what stands out. Twice the gain of log-likelihood by one step from the declared model, every effect of the \
                catalogue alone; p corrected for the number of effects (Šidák). The sets above are fitted in full.";
    out += &section("Candidates", lead, &candidates(c, plots));
    let lead =
        "How large an effect that was not found could still be and escape: its size stays under the bound with 95 % confidence.";
    out += &section("Bounds on what was not found", lead, &bounds(c));
    out + &warnings(&c.notes().into_iter().chain(tracks.map_or_else(Vec::new, notes)).collect::<Vec<_>>())
}

/// Below everything.
pub(crate) fn footer() -> String {
    format!("<footer>windfall {}</footer>\n", env!("CARGO_PKG_VERSION"))
}

/// What reading the runs had to say.
fn notes(t: &SignalTracks) -> Vec<String> {
    t.runs.iter().flat_map(|r| r.notes.iter().map(move |n| format!("{}: {n}", r.name))).collect()
}

fn head(c: &Closing) -> String {
    let finding = c.concluded();
    format!(
        "<h1>{}</h1>\n<p class=\"lead\">The loop closed with measured data: what the declared model lacks.</p>\n<div class=\"verdict \
         {}\"><b>{}</b><p>{}</p></div>\n",
        escape(&c.campaign),
        finding.level.name(),
        c.verdict.name(),
        escape(&finding.sentence)
    )
}

fn topic(figures: &[Figure], topic: Topic, title: &str, lead: &str, plots: &mut Plots) -> String {
    let mut own: Vec<Figure> = figures.iter().filter(|f| f.topic == topic).cloned().collect();
    for f in own.iter_mut().filter(|f| f.topic == Topic::Variable) {
        // A unit is on the axis; variables of the model are named by their keys.
        f.title = f.title.trim_end_matches(" (s)").to_owned();
        if let (name, Some(unit)) = plain_key(&f.x_label) {
            f.title = f.title.replace(&f.x_label, &name);
            f.x_label = with_unit(&name, Some(unit));
        }
    }
    own.iter_mut().for_each(say_beyond);
    let used = legend(&own);
    let drawn = plots.charts(own);
    if drawn.is_empty() { String::new() } else { section(title, lead, &format!("{used}<div class=\"grid\">{drawn}</div>")) }
}

fn effects(c: &Closing) -> String {
    if c.effects.is_empty() {
        return "<p>No effect of the catalogue was needed, or none explained enough to be named.</p>\n".to_owned();
    }
    let held_out = c.after.hold_out.is_some();
    c.effects.iter().map(|e| effect(e, held_out)).collect()
}

fn effect(e: &EffectLine, held_out: bool) -> String {
    let mut out =
        format!("<h3>{}</h3>\n<p>{}</p>\n<p class=\"note\">{}</p>\n", escape(&e.family), escape(&e.physics), escape(&e.source));
    let rows: Vec<Vec<Cell>> = e.shown_parameters().map(parameter).collect();
    out += &table(&["parameter", "estimate", "± 95 %", "95 % interval", "unit"], &rows);
    out += &crate::fitted::flown(e);
    out += &crate::fitted::by_run(e);
    let held = match e.held_out_gain {
        Some(gain) if gain > 0.0 => format!("Confirmed on runs held out: log-likelihood + {}.", number(gain)),
        Some(gain) => format!("Not confirmed on runs held out: log-likelihood − {}.", number(-gain)),
        None if held_out => "Runs held out are judged with all effects together, above.".to_owned(),
        None => "Not confirmed on other runs: no run is held out.".to_owned(),
    };
    let _ = writeln!(
        out,
        "<p>Chance of such a find anywhere in the catalogue from noise alone: {}. {held}</p>",
        escape(&p_value(e.p_value))
    );
    if let Some(p) = e.probability {
        let _ = writeln!(out, "<p>Probability that it acts, given the data: {}.</p>", share(p));
    }
    if let Some([calm, strong]) = e.bursts {
        let _ = writeln!(
            out,
            "<p>It comes in bursts: between {calm:.2} and {strong:.2} of its mean size in nine tenths of the time.</p>"
        );
    }
    if e.steep_edges {
        out += "<p>Its band ends steeply at its edges.</p>\n";
    }
    out += &form(e);
    let _ = if e.rivals.is_empty() {
        writeln!(out, "<p>No rival: these data tell it from every other effect.</p>")
    } else {
        let rivals = e.rivals.join(", ");
        writeln!(
            out,
            "<p><strong>Rivals that these data cannot tell from it: {}.</strong> What would separate them: {}.</p>",
            escape(&rivals),
            escape(&e.separate_by)
        )
    };
    out
}

/// Whether the form of an effect holds.
fn form(e: &EffectLine) -> String {
    let Some(form) = &e.form else { return String::new() };
    let word = if form.ok {
        "<span class=\"better\">Its form holds</span>"
    } else {
        "<strong class=\"worse\">Its form fails: the place is right, the dependence is not</strong>"
    };
    let checks: Vec<String> = form.checks.iter().map(|c| format!("{} ({})", c.what, p_with_sign(c.p_value))).collect();
    format!("<p>{word}. Held against it: {}.</p>\n", escape(&checks.join("; ")))
}

fn parameter(p: &ParameterLine) -> Vec<Cell> {
    let (estimate, half) = with_interval(p.estimate, p.std_error.map(|s| NORMAL_95 * s));
    let bound = |x: f64| with_interval(x, p.std_error.map(|s| NORMAL_95 * s)).0;
    let mut interval = p.ci95.map_or_else(|| "not determined".to_owned(), |[a, b]| format!("[{}, {}]", bound(a), bound(b)));
    if p.at_end {
        interval += "; at the end of its range";
    }
    vec![
        Cell::text(&p.name),
        Cell::Number(estimate),
        Cell::Number(half.unwrap_or_else(|| "–".to_owned())),
        Cell::Number(interval),
        Cell::text(unit(&p.unit)),
    ]
}

fn unit(u: &str) -> &str {
    if u == "-" { "" } else { u }
}

fn residuals(c: &Closing) -> String {
    let pairs: Vec<_> = c.residual.per_channel.iter().zip(&c.residual_after.per_channel).collect();
    let over = |rms: f64, expected: f64| rms / expected;
    let highest = pairs
        .iter()
        .flat_map(|(b, a)| [over(b.rms, b.expected_rms), over(a.rms, a.expected_rms)])
        .filter(|r| r.is_finite())
        .fold(1.0, f64::max);
    if c.effects.is_empty() {
        let one = |(b, _): &(&ChannelResidual, &ChannelResidual)| {
            let numbers = [b.rms, b.expected_rms].map(Cell::number);
            let over = Cell::Number(format!("{:.2}", over(b.rms, b.expected_rms)));
            let [rms, noise] = numbers;
            vec![Cell::text(channel(&b.channel)), rms, noise, over, Cell::Number(p_value(b.p_value))]
        };
        let rows: Vec<Vec<Cell>> = pairs.iter().map(one).collect();
        let heads = ["channel", "declared model", "noise", "over noise", "p"];
        return if rows.is_empty() { String::new() } else { table(&heads, &rows) };
    }
    let rows: Vec<Vec<Cell>> = pairs
        .iter()
        .map(|(b, a)| {
            let [before, after] = [over(b.rms, b.expected_rms), over(a.rms, a.expected_rms)];
            vec![
                Cell::text(channel(&b.channel)),
                Cell::number(b.rms),
                Cell::number(a.rms),
                Cell::number(a.expected_rms),
                Cell::Number(p_value(b.p_value)),
                Cell::Number(p_value(a.p_value)),
                Cell::Made(dots(before, after, highest)),
            ]
        })
        .collect();
    if rows.is_empty() {
        return String::new();
    }
    let heads = ["channel", "declared model", "with effects", "noise", "p before", "p after", "over noise (log; dashes: 1)"];
    key(&[("before", "declared model"), ("after", "with the effects added")]) + &table(&heads, &rows)
}

fn leads(c: &Closing) -> String {
    if c.unexplained.is_empty() {
        return String::new();
    }
    let one = |u: &windfall_discover::close::Unexplained| {
        format!("<li><strong>{}</strong>: {}</li>", escape(&channel(&u.channel)), escape(&u.description))
    };
    format!("<ul>{}</ul>\n", c.unexplained.iter().map(one).collect::<String>())
}

fn candidates(c: &Closing, plots: &mut Plots) -> String {
    let added = |family: &str| c.effects.iter().any(|e| e.family == family);
    let rival = |family: &str| c.effects.iter().any(|e| e.rivals.iter().any(|r| r == family));
    let mut sorted: Vec<_> = c.candidates.iter().collect();
    sorted.sort_by(|a, b| b.score.total_cmp(&a.score));
    let all: Vec<Bar> = sorted
        .iter()
        .map(|k| Bar {
            name: k.family.clone(),
            value: k.score,
            note: format!("{}, p {}", number(k.score), p_value(k.p_value)),
            look: if added(&k.family) {
                Look::After
            } else if rival(&k.family) {
                Look::Before
            } else {
                Look::Plain
            },
        })
        .collect();
    if all.is_empty() {
        return String::new();
    }
    let (title, x_label) = ("Every effect of the catalogue alone".to_owned(), "score (logarithmic, from 1)".to_owned());
    key(&[("after", "added"), ("before", "rival"), ("plain", "neither")]) + &plots.put(Plot::Bars { title, x_label, bars: all })
}

fn bounds(c: &Closing) -> String {
    if c.bounds.is_empty() {
        return String::new();
    }
    let rows: Vec<Vec<Cell>> = c
        .bounds
        .iter()
        .map(|b| vec![Cell::text(&b.family), Cell::text(&b.parameter), Cell::number(b.upper95), Cell::text(unit(&b.unit))])
        .collect();
    let heads = ["family", "parameter", "below", "unit"];
    let mut rows = rows.into_iter();
    let half: Vec<Vec<Cell>> = rows.by_ref().take(c.bounds.len().div_ceil(2)).collect();
    let rest: Vec<Vec<Cell>> = rows.collect();
    let second = if rest.is_empty() { String::new() } else { table(&heads, &rest) };
    format!("<div class=\"columns\">{}{second}</div>", table(&heads, &half))
}
