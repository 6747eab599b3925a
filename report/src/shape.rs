//! report: what a closing says of innovations, noise, constants, parameters and sets. In: its lists. Out: figures and tables.

use crate::chart::Range;
use crate::cut::say_beyond;
use crate::draw::Look;
use crate::html::{Cell, escape, section, table};
use crate::legend::{legend, share};
use crate::plot::{Plot, Plots};
use crate::words::{number, plain_key, with_interval};
use windfall_discover::close::{Closing, Figure, InnovationShape, NoiseLine, Role, Series, Topic};
use windfall_discover::{NORMAL_95, ci95};

/// Histograms and autocorrelations of the innovations.
pub(crate) fn innovations(c: &Closing, plots: &mut Plots) -> String {
    if c.innovations.is_empty() {
        return String::new();
    }
    let added = !c.effects.is_empty();
    let mut all = Vec::new();
    for line in &c.innovations {
        let sides: Vec<(Role, &InnovationShape)> = if added {
            vec![(Role::Before, &line.before), (Role::After, &line.after)]
        } else {
            vec![(Role::Before, &line.before)]
        };
        let (channel, _) = plain_key(&line.channel);
        all.push(histogram(&channel, &sides));
        all.push(correlation(&channel, line.step_s, &sides));
    }
    let lead = "Look for histograms under the dashed bell, and correlations inside the dashed lines: then each sample brings only noise. \
                Innovation: what a sample adds to its prediction from all before it, over its standard deviation; what lies beyond five is not drawn, its share stands above each.";
    all.iter_mut().for_each(say_beyond);
    let key = legend(&all);
    section("Innovations", lead, &format!("{key}<div class=\"grid\">{}</div>", plots.charts(all)))
}

fn histogram(channel: &str, sides: &[(Role, &InnovationShape)]) -> Figure {
    let bell: Vec<f64> = (0..=80).map(|k| f64::from(k) / 10.0 - 4.0).collect();
    let density = bell.iter().map(|x| (-0.5 * x * x).exp() / std::f64::consts::TAU.sqrt()).collect();
    let mut series = vec![Series { role: Role::Noise, x: bell, y: density, ..Series::default() }];
    for (role, s) in sides {
        let width = (s.ends[1] - s.ends[0]) / s.density.len().max(1) as f64;
        // Steps: both ends of every bin.
        let (mut x, mut y) = (Vec::new(), Vec::new());
        for (k, d) in s.density.iter().enumerate() {
            let left = s.ends[0] + k as f64 * width;
            x.extend([left, left + width]);
            y.extend([*d, *d]);
        }
        series.push(Series { role: *role, x, y, ..Series::default() });
    }
    Figure {
        topic: Topic::Variable,
        title: format!("{channel}: distribution of the innovations"),
        x_label: "innovation (standard deviations)".to_owned(),
        y_label: "density (1)".to_owned(),
        series,
        ..Figure::default()
    }
}

fn correlation(channel: &str, step_s: f64, sides: &[(Role, &InnovationShape)]) -> Figure {
    let lags = sides.first().map_or(0, |(_, s)| s.autocorrelation.len());
    let x: Vec<f64> = (1..=lags).map(|k| k as f64 * step_s).collect();
    let bound = NORMAL_95 / (sides.first().map_or(1, |(_, s)| s.count.max(1)) as f64).sqrt();
    let flat = |y: f64| Series { role: Role::Noise, x: x.clone(), y: vec![y; lags], ..Series::default() };
    let mut series = vec![flat(bound), flat(-bound)];
    series.extend(sides.iter().map(|(role, s)| Series {
        role: *role,
        x: x.clone(),
        y: s.autocorrelation.clone(),
        ..Series::default()
    }));
    Figure {
        topic: Topic::Variable,
        title: format!("{channel}: autocorrelation of the innovations"),
        x_label: "lag (s)".to_owned(),
        y_label: "correlation (1)".to_owned(),
        series,
        ..Figure::default()
    }
}

/// Noise learnt beside noise declared.
pub(crate) fn noise(c: &Closing) -> String {
    // Of tracks colour, lines and gaps are not looked for.
    let plain = |n: &NoiseLine| n.coloured_share <= 0.0 && n.lines_hz.is_empty() && n.missing == 0 && n.outliers == 0;
    let tracks = c.innovations.is_empty() && c.noise.iter().all(plain);
    let rows: Vec<Vec<Cell>> = c
        .noise
        .iter()
        .map(|n| {
            let mut cells = vec![
                Cell::text(crate::words::channel(&n.channel)),
                Cell::number(n.declared_std),
                Cell::number(n.learnt_std),
                Cell::Number(format!("× {:.2}", n.learnt_std / n.declared_std)),
            ];
            if tracks {
                return cells;
            }
            let lines: Vec<String> = n.lines_hz.iter().map(|f| number(*f)).collect();
            cells.extend([
                Cell::Number(format!("{:.2}", n.colour)),
                Cell::Number(format!("{:.0} %", 100.0 * n.coloured_share)),
                Cell::Number(n.missing.to_string()),
                Cell::Number(n.outliers.to_string()),
                Cell::text(if lines.is_empty() { "none".to_owned() } else { lines.join(", ") }),
            ]);
            cells
        })
        .collect();
    let heads =
        ["channel", "declared std", "learnt std", "ratio", "colour", "coloured part", "missing", "outliers", "lines (Hz)"];
    if rows.is_empty() { String::new() } else { table(if tracks { &heads[..4] } else { &heads }, &rows) }
}

/// Constants found beside declared, in their own uncertainties.
pub(crate) fn constants(c: &Closing, plots: &mut Plots) -> String {
    if c.constants.is_empty() {
        return String::new();
    }
    let one = |k: &windfall_discover::close::ConstantLine| {
        let (moved, error) = ((k.estimate - k.declared) / k.uncertainty, k.std_error? / k.uncertainty);
        Some(Range {
            name: k.key.clone(),
            ends: ci95(moved, error),
            inner: None,
            dot: moved,
            note: String::new(),
            look: Look::After,
        })
    };
    let ranges: Vec<Range> = c.constants.iter().filter_map(one).collect();
    let rows: Vec<Vec<Cell>> = c
        .constants
        .iter()
        .map(|k| {
            let (estimate, half) = with_interval(k.estimate, k.std_error.map(|s| NORMAL_95 * s));
            vec![
                Cell::text(&k.key),
                Cell::number(k.declared),
                Cell::number(k.uncertainty),
                Cell::Number(estimate),
                Cell::Number(half.unwrap_or_else(|| "–".to_owned())),
                Cell::text(&k.unit),
            ]
        })
        .collect();
    let plot = Plot::Ranges {
        title: "Constants: found less declared".to_owned(),
        x_label: "declared standard uncertainties; bar: 95 %".to_owned(),
        marks: vec![-NORMAL_95, 0.0, NORMAL_95],
        ranges,
    };
    plots.put(plot) + &table(&["constant", "declared", "uncertainty", "found", "± 95 %", "unit"], &rows)
}

/// How far the effects moved declared parameters.
pub(crate) fn moves(c: &Closing, plots: &mut Plots) -> String {
    let one = |s: &windfall_discover::close::Shift| {
        let before = c.before.parameters.iter().find(|p| p.name == s.name).and_then(|p| p.std_error)?;
        let (moved, half) = ((s.after - s.before) / before, NORMAL_95 * s.std_error_after / before);
        let ends = [moved - half, moved + half];
        let found = moved.is_finite() && half.is_finite();
        let (name, note) = (s.name.clone(), format!("{} → {}", number(s.before), number(s.after)));
        found.then_some(Range { name, ends, inner: None, dot: moved, note, look: Look::After })
    };
    let ranges: Vec<Range> = if c.effects.is_empty() { Vec::new() } else { c.shifts.iter().filter_map(one).collect() };
    plots.put(Plot::Ranges {
        title: "Declared parameters: with the effects less before".to_owned(),
        x_label: "standard errors before; bar: 95 % with the effects".to_owned(),
        marks: vec![-NORMAL_95, 0.0, NORMAL_95],
        ranges,
    })
}

/// Sets of effects with their probabilities.
pub(crate) fn sets(c: &Closing) -> String {
    let rows: Vec<Vec<Cell>> = c
        .sets
        .iter()
        .take(12)
        .map(|s| {
            let name = if s.families.is_empty() { "none: the declared model".to_owned() } else { s.families.join(" + ") };
            vec![Cell::text(name), Cell::Number(share(s.probability))]
        })
        .collect();
    if rows.is_empty() {
        return String::new();
    }
    format!("<h3>Sets of effects</h3>\n{}", table(&["effects together", "probability"], &rows))
}

/// Causes and next steps.
pub(crate) fn warnings(all: &[String]) -> String {
    let items: String = all.iter().map(|w| format!("<li>{}</li>", escape(w))).collect();
    let body = if items.is_empty() { String::new() } else { format!("<ul class=\"warnings\">{items}</ul>\n") };
    section("Warnings", "What was bridged, removed, held or doubted; each with its cause.", &body)
}
