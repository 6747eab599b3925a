//! report: what a model says over what was measured, instant by instant. In: tracks. Out: a section of figures.

use crate::html::section;
use crate::legend::key;
use crate::plot::Plots;
use windfall_discover::close::{Figure, Role, RunTracks, Series, SignalTracks, Topic};

/// Ends of a run that are left out where the run does not say which, s: derivatives hang on one side there.
const EDGE_S: f64 = 0.5;
/// Most points of a figure's series.
const POINTS: usize = 400;

/// A figure for each channel that is both measured and modelled; nothing without such.
pub(crate) fn one_to_one(t: &SignalTracks, plots: &mut Plots) -> String {
    let Some(first) = t.runs.first() else { return String::new() };
    let both = |c: &&windfall_discover::close::TrackSignal| !c.measured.is_empty() && !c.after.is_empty();
    let figures = first.channels.iter().filter(both).map(|c| figure(t, &c.name, &c.unit));
    let drawn = plots.charts(figures.collect::<Vec<_>>());
    if drawn.is_empty() {
        return drawn;
    }
    let held = t.runs.iter().any(|r| r.used == "hold-out");
    let mut marks = vec![("after", "runs identified on")];
    if held {
        marks.push(("before", "runs held out"));
    }
    marks.push(("noise", "model as measured"));
    let lead = "Look for a cloud along the dashed line, as narrow at its ends as in its middle: a cloud that bends or turns away from it is a term that the \
                structure lacks, one that is only wide is noise of the record. Each point an instant; the \
                ends of a run, where the smoother hangs on one side, are left out.";
    section("Model over measurement", lead, &format!("{}<div class=\"grid\">{drawn}</div>\n", key(&marks)))
}

fn figure(t: &SignalTracks, name: &str, unit: &str) -> Figure {
    let of = |held: bool| -> Vec<[f64; 2]> {
        let own = |r: &&RunTracks| (r.used == "hold-out") == held;
        let pairs = |r: &RunTracks| -> Vec<[f64; 2]> {
            let Some(c) = r.channels.iter().find(|c| c.name == name) else { return Vec::new() };
            let [from_s, end_s] = r.interior_s.unwrap_or([EDGE_S, r.t_s.last().copied().unwrap_or(0.0) - EDGE_S]);
            let inside = |t: &f64| (from_s..=end_s).contains(t);
            let all = r.t_s.iter().zip(c.measured.iter().zip(&c.after)).filter(|(t, _)| inside(t)).map(|(_, (m, a))| [*m, *a]);
            all.filter(|p| p.iter().all(|x| x.is_finite())).collect()
        };
        t.runs.iter().filter(own).flat_map(pairs).collect()
    };
    let clouds = [(Role::After, of(false)), (Role::Before, of(true))];
    let ends =
        clouds.iter().flat_map(|(_, p)| p).flatten().fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], x| [a.min(*x), b.max(*x)]);
    let line = Series { role: Role::Noise, x: ends.to_vec(), y: ends.to_vec(), ..Series::default() };
    let points = clouds.into_iter().filter(|(_, p)| !p.is_empty()).map(|(role, p)| cloud(role, p));
    let unit = if unit.is_empty() { "1" } else { unit };
    Figure {
        topic: Topic::Variable,
        title: format!("{name}: model over measurement"),
        x_label: format!("measured {name} ({unit})"),
        y_label: format!("model {name} ({unit})"),
        series: std::iter::once(line).chain(points).collect(),
        ..Figure::default()
    }
}

/// Evenly picked points in the order of their abscissae.
fn cloud(role: Role, points: Vec<[f64; 2]>) -> Series {
    let stride = points.len().div_ceil(POINTS).max(1);
    let mut some: Vec<[f64; 2]> = points.into_iter().step_by(stride).collect();
    some.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let (x, y) = some.into_iter().map(|[a, b]| (a, b)).unzip();
    Series { role, x, y, points: true, ..Series::default() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plot::Plot;
    use windfall_discover::close::TrackSignal;

    /// Two runs: each its own colour, points in order, and a line from the least to the largest of both sides.
    #[test]
    fn exact_clouds_of_two_runs() {
        let run = |used: &str, measured: Vec<f64>, after: Vec<f64>| RunTracks {
            name: used.to_owned(),
            kind: String::new(),
            used: used.to_owned(),
            t_s: vec![0.0, 1.0, 2.0, 3.0],
            channels: vec![TrackSignal {
                name: "Cm".to_owned(),
                unit: String::new(),
                noise_std: None,
                measured,
                before: Vec::new(),
                after,
            }],
            notes: Vec::new(),
            interior_s: None,
        };
        let runs = vec![
            run("identify", vec![9.0, 0.3, 0.1, 9.0], vec![0.0, 0.25, 0.1, 0.0]),
            run("hold-out", vec![9.0, -0.2, 0.0, 9.0], vec![0.0, -0.4, 0.0, 0.0]),
        ];
        let mut plots = Plots::default();
        let html = one_to_one(&SignalTracks { runs, ..SignalTracks::default() }, &mut plots);
        assert!(html.contains("runs held out") && html.contains("model Cm (1)"));
        let Plot::Chart(f) = &plots.all[0] else { panic!("a chart") };
        assert_eq!((f.series[0].x.as_slice(), f.series[1].x.as_slice()), (&[-0.4, 0.3][..], &[0.1, 0.3][..]));
        assert!(f.series[2].role == Role::Before && f.series[2].points);
        assert!(one_to_one(&SignalTracks::default(), &mut plots).is_empty());
    }
}
