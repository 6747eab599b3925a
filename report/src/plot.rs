//! report: plots of a page. In: figures, bars and ranges with their data. Out: HTML now, and files later; each is kept as it is made.

use crate::chart::{Bar, Range, SIZE, bars, chart, ranges};
use crate::draw::LineDrawing;
use crate::pairs::{Pair, pairs};
use crate::svg;
use std::fmt::Write as _;
use windfall_discover::close::Figure;

/// Width of rows of bars and ranges on a page, drawing units.
const ROWS: f64 = 760.0;

/// A plot with its data.
pub(crate) enum Plot {
    Chart(Figure),
    Bars { title: String, x_label: String, bars: Vec<Bar> },
    Ranges { title: String, x_label: String, marks: Vec<f64>, ranges: Vec<Range> },
    Pairs { title: String, y_label: String, pairs: Vec<Pair> },
}

impl Plot {
    /// As marks; of a chart in that size, of rows in that width. None when there is nothing to draw.
    pub(crate) fn drawing(&self, [w, h]: [f64; 2]) -> Option<LineDrawing> {
        match self {
            Self::Chart(f) => chart(f, [w, h]),
            Self::Bars { title, x_label, bars: all } => bars(title, all, x_label, w),
            Self::Ranges { title, x_label, marks, ranges: all } => ranges(title, all, marks, x_label, w),
            Self::Pairs { title, y_label, pairs: all } => pairs(title, y_label, all, [w, h]),
        }
    }
    pub(crate) fn title(&self) -> &str {
        match self {
            Self::Chart(f) => &f.title,
            Self::Bars { title, .. } | Self::Ranges { title, .. } | Self::Pairs { title, .. } => title,
        }
    }
    /// What is drawn, a row a point; units are in the heads.
    pub(crate) fn csv(&self) -> String {
        match self {
            Self::Chart(f) => chart_csv(f),
            Self::Bars { x_label, bars, .. } => {
                let mut out = format!("name,{},note\n", quoted(x_label));
                for b in bars {
                    let _ = writeln!(out, "{},{},{}", quoted(&b.name), b.value, quoted(&b.note));
                }
                out
            }
            Self::Pairs { y_label, pairs, .. } => {
                let mut out = format!("put in,{},low,high\n", quoted(y_label));
                for p in pairs {
                    let _ = writeln!(out, "{},{},{},{}", p.truth, p.estimate, p.estimate - p.half, p.estimate + p.half);
                }
                out
            }
            Self::Ranges { x_label, ranges, .. } => {
                let mut out = format!("name,{},low,high,note\n", quoted(x_label));
                for r in ranges {
                    let [low, high] = r.ends;
                    let _ = writeln!(out, "{},{},{low},{high},{}", quoted(&r.name), r.dot, quoted(&r.note));
                }
                out
            }
        }
    }
}

fn chart_csv(f: &Figure) -> String {
    let mut out = format!("series,{},{},low,high\n", quoted(&f.x_label), quoted(&f.y_label));
    for s in &f.series {
        let name = crate::chart::look(s.role).class();
        for (k, (x, y)) in s.x.iter().zip(&s.y).enumerate() {
            let end = |side: usize| s.band.as_ref().and_then(|b| b[side].get(k)).map_or_else(String::new, f64::to_string);
            let _ = writeln!(out, "{name},{x},{y},{},{}", end(0), end(1));
        }
    }
    for m in &f.marks {
        let _ = writeln!(out, "mark,{m},,,");
    }
    out
}

/// A field of a CSV file.
fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\n']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.to_owned() }
}

/// Plots in the order of a page.
#[derive(Default)]
pub(crate) struct Plots {
    pub(crate) all: Vec<Plot>,
}

impl Plots {
    /// Keeps a plot and gives its figure; nothing when there is nothing to draw.
    pub(crate) fn put(&mut self, plot: Plot) -> String {
        let size = if matches!(plot, Plot::Chart(_) | Plot::Pairs { .. }) { SIZE } else { [ROWS, 0.0] };
        let Some(drawing) = plot.drawing(size) else { return String::new() };
        let html = svg::figure(&drawing);
        let number = self.all.len();
        let html = if matches!(plot, Plot::Chart(_)) {
            html.replacen("<figure", &format!("<figure data-plot=\"{number}\""), 1)
        } else {
            html
        };
        self.all.push(plot);
        html
    }
    pub(crate) fn charts(&mut self, figures: impl IntoIterator<Item = Figure>) -> String {
        figures.into_iter().map(|f| self.put(Plot::Chart(f))).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use windfall_discover::close::{Role, Series, Topic};

    #[test]
    fn exact_data_as_csv() {
        let series = vec![Series {
            role: Role::After,
            x: vec![0.0, 1.5],
            y: vec![2.0, 3.0],
            band: Some([vec![1.0, 2.0], vec![3.0, 4.0]]),
            ..Series::default()
        }];
        let (title, x_label, y_label) = ("t".to_owned(), "time (s)".to_owned(), "a, b (m)".to_owned());
        let plot = Plot::Chart(Figure { topic: Topic::Trajectory, title, x_label, y_label, series, ..Figure::default() });
        assert_eq!(plot.csv(), "series,time (s),\"a, b (m)\",low,high\nafter,0,2,1,3\nafter,1.5,3,2,4\n");
    }
}
