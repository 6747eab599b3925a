//! report: measured against model over time, and the replay. In: tracks. Out: places that the page's program fills, with still figures
//! of the first held-out run for readers without it.

use crate::chart::{SIZE, chart};
use crate::html::{escape, section};
use crate::story::thinned;
use crate::svg;
use windfall_discover::close::{Figure, Role, RunTracks, SignalTracks, Topic};

/// Longest curve of a still figure, points: it is a column wide.
const STILL_POINTS: usize = 350;

/// Every channel of a run over time; `id` tells several tracks of one page apart. None without runs.
pub(crate) fn over_time(id: &str, t: &SignalTracks) -> Option<String> {
    let run = t.runs.iter().find(|r| r.used == "hold-out").or(t.runs.first())?;
    Some(format!(
        "<div class=\"tracks\" data-tracks=\"{id}\"></div>\n<div class=\"still\" data-still=\"{id}\"><p class=\"note\">Run {}; with \
         JavaScript every run and channel can be chosen.</p><div class=\"grid\">{}</div></div>\n",
        escape(&run.name),
        still(run)
    ))
}

/// Sections of tracks. Nothing without runs.
pub(crate) fn signals(id: &str, t: &SignalTracks) -> String {
    let Some(body) = over_time(id, t) else { return String::new() };
    let coefficients = t.runs.iter().all(|r| !r.channels.iter().any(|c| c.name.starts_with('X')));
    if coefficients {
        let lead = "Look for a blue curve inside the grey one, and for a residual without shape: the coefficient that the record's motion \
                    needs (grey), smoothed as the method does, and the identified model at the same states (blue). The scale is that of the run \
                    without its ends, where the smoother hangs on one side and the noise of its derivatives is many times that inside. Drag to zoom, with shift to move, all channels follow; double click \
                    shows all.";
        return section("Coefficients over time", lead, &body);
    }
    let replay = format!(
        "<div class=\"replay\" data-replay=\"{id}\"><p class=\"note\">The replay needs JavaScript and WebGL; the figures below show the same runs.</p></div>\n"
    );
    let lead = "Look whether both bodies move together: the measured one at the left, the simulated one at the right, on one clock with the \
                curves below.";
    let signals = "Look for the colours on the grey curve, and for a residual as narrow as the noise; as spectra, for residuals that have come down to the \
                   dashed noise at every frequency (a peak that stays is a motion which the model has at another frequency, or not at all). Drag to zoom, with \
                   shift to move, all channels follow; double click shows all; hover reads values and moves the replay. Spectra are of the span shown.";
    section("Replay", lead, &replay) + &section("Measured against model", signals, &body)
}

/// Each channel of a run.
fn still(run: &RunTracks) -> String {
    let one = |c: &windfall_discover::close::TrackSignal| {
        let sides = [(Role::Measured, &c.measured), (Role::Before, &c.before), (Role::After, &c.after)];
        let unit = if c.unit.is_empty() { c.name.clone() } else { format!("{} ({})", c.name, c.unit) };
        let figure = Figure {
            topic: Topic::Trajectory,
            title: format!("{}: {}", run.name, c.name),
            x_label: "time in the run (s)".to_owned(),
            y_label: unit,
            interior: run.interior_s,
            series: sides
                .into_iter()
                .filter(|(_, y)| !y.is_empty())
                .map(|(r, y)| thinned(r, &run.t_s, y, STILL_POINTS))
                .collect(),
            ..Figure::default()
        };
        chart(&figure, SIZE).map_or_else(String::new, |d| svg::figure(&d))
    };
    run.channels.iter().map(one).collect()
}
