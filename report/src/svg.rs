//! report: drawings. In: series. Out: SVG that takes its colours from the page.

use crate::html::escape;
use std::fmt::Write as _;
use windfall_verify::close::{Figure, Role, Series};

/// Size of a chart, in its own units, and room for labels at the left, below, above and right.
const SIZE: [f64; 2] = [360.0, 220.0];
const ROOM: [f64; 4] = [54.0, 36.0, 10.0, 10.0];

/// A range of one axis and how it lies on paper.
struct Scale {
    low: f64,
    high: f64,
    log: bool,
    from: f64,
    to: f64,
}

impl Scale {
    fn new(values: impl Iterator<Item = f64>, log: bool, from: f64, to: f64) -> Option<Self> {
        let usable = values.filter(|v| v.is_finite() && (!log || *v > 0.0)).map(|v| if log { v.log10() } else { v });
        let (low, high) = usable.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)));
        if low > high {
            return None;
        }
        let margin = if high > low { 0.05 * (high - low) } else { 0.5 * high.abs().max(1e-12) };
        Some(Self { low: low - margin, high: high + margin, log, from, to })
    }
    /// Ends at the data; for time and frequency.
    fn tight(self) -> Self {
        let margin = (self.high - self.low) / 22.0;
        Self { low: self.low + margin, high: self.high - margin, ..self }
    }
    fn place(&self, v: f64) -> Option<f64> {
        let x = if self.log { v.log10() } else { v };
        x.is_finite().then(|| self.from + (x - self.low) / (self.high - self.low) * (self.to - self.from))
    }
    /// Round values inside, with their labels.
    fn ticks(&self) -> Vec<(f64, String)> {
        if self.log {
            return self.log_ticks();
        }
        linear_ticks(self.low, self.high)
    }
    fn log_ticks(&self) -> Vec<(f64, String)> {
        #[expect(clippy::cast_possible_truncation, reason = "exponents of doubles")]
        let (a, b) = (self.low.floor() as i32, self.high.ceil() as i32);
        let marks: &[f64] = if self.high - self.low < 1.6 { &[1.0, 2.0, 5.0] } else { &[1.0] };
        let all = (a..=b).flat_map(|e| marks.iter().map(move |m| m * 10_f64.powi(e)));
        let inside: Vec<f64> = all.filter(|v| (self.low..=self.high).contains(&v.log10())).collect();
        if inside.len() < 2 {
            return linear_ticks(10_f64.powf(self.low), 10_f64.powf(self.high));
        }
        let every = inside.len().div_ceil(6).max(1);
        inside.into_iter().step_by(every).map(|v| (v, plain(v))).collect()
    }
}

/// Round values between two ends, with labels.
fn linear_ticks(low: f64, high: f64) -> Vec<(f64, String)> {
    let step = round_step((high - low) / 5.0);
    let first = (low / step - 1e-9).ceil();
    (0..12).map(|k| (first + f64::from(k)) * step).take_while(|v| *v <= high + 1e-9 * step).map(|v| (v, label(v, step))).collect()
}

/// 1, 2 or 5 times a power of ten, not below what is asked for.
fn round_step(least: f64) -> f64 {
    let power = 10_f64.powf(least.abs().max(f64::MIN_POSITIVE).log10().floor());
    [1.0, 2.0, 5.0, 10.0].into_iter().map(|m| m * power).find(|s| *s >= least * (1.0 - 1e-9)).unwrap_or(10.0 * power)
}

fn label(v: f64, step: f64) -> String {
    if v.abs() < 1e-9 * step {
        return "0".to_owned();
    }
    let whole = -step.log10().floor();
    if !(-4.0..=4.0).contains(&whole) {
        return format!("{v:.1e}");
    }
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 4")]
    let digits = whole.max(0.0) as usize;
    format!("{v:.digits$}")
}

fn plain(v: f64) -> String {
    if (1e-3..1e4).contains(&v) { format!("{v}") } else { format!("{v:.0e}") }
}

/// CSS class of a role.
pub(crate) fn class(role: Role) -> &'static str {
    match role {
        Role::Measured => "measured",
        Role::Before => "before",
        Role::After => "after",
        Role::Noise => "noise",
    }
}

/// Curves over axes, with a caption; nothing when there is nothing to draw.
pub(crate) fn chart(f: &Figure) -> String {
    let [w, h] = SIZE;
    let [left, below, above, right] = ROOM;
    let xs = f.series.iter().flat_map(|s| s.x.iter().copied());
    let ys = f.series.iter().flat_map(|s| s.y.iter().chain(s.band.iter().flatten().flatten()).copied());
    let (Some(x), Some(y)) = (Scale::new(xs, false, left, w - right), Scale::new(ys, f.log_y, h - below, above)) else {
        return String::new();
    };
    let x = x.tight();
    let mut out = format!(
        "<figure><figcaption>{}</figcaption><svg viewBox=\"0 0 {w} {h}\" role=\"img\" aria-label=\"{}\">",
        escape(&f.title),
        escape(&f.title)
    );
    axes(&mut out, &x, &y, f);
    for s in &f.series {
        if let Some(band) = &s.band {
            let _ = write!(out, "<path class=\"band {}\" d=\"{}\"/>", class(s.role), outline(&x, &y, s, band));
        }
    }
    for s in &f.series {
        let mut d = String::new();
        let mut pen = 'M';
        for (a, b) in s.x.iter().zip(&s.y) {
            let (Some(a), Some(b)) = (x.place(*a), y.place(*b)) else {
                pen = 'M';
                continue;
            };
            let _ = write!(d, "{pen}{a:.1} {b:.1}");
            pen = 'L';
        }
        let _ = write!(out, "<path class=\"curve {}\" d=\"{d}\"/>", class(s.role));
    }
    out.push_str("</svg></figure>\n");
    out
}

/// Along the lower end of a band and back along the upper.
fn outline(x: &Scale, y: &Scale, s: &Series, [low, high]: &[Vec<f64>; 2]) -> String {
    let there = s.x.iter().zip(low);
    let back = s.x.iter().zip(high).rev();
    let points = there.chain(back).filter_map(|(a, b)| Some((x.place(*a)?, y.place(*b)?)));
    let path = points.enumerate().map(|(k, (a, b))| format!("{}{a:.1} {b:.2}", if k == 0 { 'M' } else { 'L' }));
    path.collect::<String>() + "Z"
}

fn axes(out: &mut String, x: &Scale, y: &Scale, f: &Figure) {
    let [w, h] = SIZE;
    let [left, below, above, right] = ROOM;
    let (bottom, end) = (h - below, w - right);
    for (v, text) in x.ticks() {
        if let Some(p) = x.place(v) {
            let _ = write!(
                out,
                "<path class=\"axis\" d=\"M{p:.1} {bottom}v4\"/><text x=\"{p:.1}\" y=\"{}\" text-anchor=\"middle\">{text}</text>",
                bottom + 15.0
            );
        }
    }
    for (v, text) in y.ticks() {
        if let Some(p) = y.place(v) {
            let _ = write!(
                out,
                "<path class=\"axis\" d=\"M{left} {p:.1}H{end}\"/><text x=\"{}\" y=\"{:.1}\" text-anchor=\"end\">{text}</text>",
                left - 5.0,
                p + 3.5
            );
        }
    }
    let _ = write!(
        out,
        "<path class=\"axis\" d=\"M{left} {bottom}H{end}\"/><text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>\
         <text transform=\"translate(11 {}) rotate(-90)\" text-anchor=\"middle\">{}</text>",
        0.5 * (left + end),
        h - 5.0,
        escape(&f.x_label),
        0.5 * (above + bottom),
        escape(&f.y_label)
    );
}

/// One bar of a bar chart.
pub(crate) struct Bar {
    pub(crate) name: String,
    pub(crate) value: f64,
    pub(crate) note: String,
    /// `after-mark`, `before-mark` or `plain-mark`.
    pub(crate) class: &'static str,
}

/// Bars to the right of their names, on a logarithmic scale from one.
pub(crate) fn bars(all: &[Bar], x_label: &str) -> String {
    let (w, row, left, right) = (760.0, 19.0, 150.0, 190.0);
    let most = all.iter().map(|b| b.value).filter(|v| v.is_finite()).fold(10.0, f64::max).log10();
    let bottom = row * all.len() as f64 + 4.0;
    let place = |v: f64| left + v.max(1.0).log10() / most * (w - left - right);
    let mut out = format!("<figure><svg viewBox=\"0 0 {w} {}\" style=\"max-width:{w}px\" role=\"img\">", bottom + 34.0);
    #[expect(clippy::cast_possible_truncation, reason = "an exponent")]
    for e in 0..=(most.floor() as i32) {
        let p = place(10_f64.powi(e));
        let _ = write!(
            out,
            "<path class=\"axis\" d=\"M{p:.1} 0V{bottom}\"/><text x=\"{p:.1}\" y=\"{}\" text-anchor=\"middle\">{}</text>",
            bottom + 13.0,
            plain(10_f64.powi(e))
        );
    }
    for (k, b) in all.iter().enumerate() {
        let (y, end) = (row * k as f64 + 3.0, place(b.value));
        let _ = write!(
            out,
            "<text class=\"name\" x=\"{}\" y=\"{:.1}\" text-anchor=\"end\">{}</text><rect class=\"{}\" x=\"{left}\" y=\"{y:.1}\" \
             width=\"{:.1}\" height=\"13\" rx=\"1.5\"/><text x=\"{:.1}\" y=\"{:.1}\">{}</text>",
            left - 8.0,
            y + 10.5,
            escape(&b.name),
            b.class,
            (end - left).max(1.0),
            end + 6.0,
            y + 10.5,
            escape(&b.note)
        );
    }
    close_bars(&mut out, 0.5 * (left + w - right), bottom, x_label);
    out
}

/// Ends a figure with the label under its axis, which is at `bottom`.
fn close_bars(out: &mut String, middle: f64, bottom: f64, label: &str) {
    let y = bottom + 29.0;
    let _ = writeln!(out, "<text x=\"{middle}\" y=\"{y}\" text-anchor=\"middle\">{}</text></svg></figure>", escape(label));
}

/// Ratios before and after as two dots on one common logarithmic line, with a mark at one.
pub(crate) fn dots(before: f64, after: f64, highest: f64) -> String {
    let (w, h) = (260.0, 16.0);
    let high = highest.max(3.0).log10() * 1.03;
    let low = -0.35;
    let place = |v: f64| 6.0 + (v.max(1e-9).log10().clamp(low, high) - low) / (high - low) * (w - 12.0);
    let (one, b, a) = (place(1.0), place(before), place(after));
    format!(
        "<svg viewBox=\"0 0 {w} {h}\" style=\"width:{w}px\" role=\"img\" aria-label=\"{} before, {} after\"><path class=\"axis one\" \
         d=\"M{one:.1} 0V{h}\"/><path class=\"link\" d=\"M{b:.1} 8H{a:.1}\"/><circle class=\"before-mark\" cx=\"{b:.1}\" cy=\"8\" \
         r=\"6\"/><circle class=\"after-mark\" cx=\"{a:.1}\" cy=\"8\" r=\"3.6\"/></svg>",
        crate::number(before),
        crate::number(after)
    )
}

/// One line of a chart of ranges: a bar from low to high, a thicker one inside it where there is such, a dot.
pub(crate) struct Range {
    pub(crate) name: String,
    pub(crate) ends: [f64; 2],
    pub(crate) inner: Option<[f64; 2]>,
    pub(crate) dot: f64,
    pub(crate) note: String,
}

/// Ranges below each other on one axis, with marks down through all; nothing when there is nothing to draw.
pub(crate) fn ranges(title: &str, all: &[Range], marks: &[f64], x_label: &str) -> String {
    let (w, row, left, right) = (760.0, 19.0, 200.0, 150.0);
    let values = all.iter().flat_map(|r| r.ends.into_iter().chain([r.dot])).chain(marks.iter().copied());
    let Some(x) = Scale::new(values, false, left, w - right).filter(|_| !all.is_empty()) else { return String::new() };
    let bottom = row * all.len() as f64 + 4.0;
    let title = escape(title);
    let mut out = format!(
        "<figure><figcaption>{title}</figcaption><svg viewBox=\"0 0 {w} {}\" style=\"max-width:{w}px\" role=\"img\" \
         aria-label=\"{title}\">",
        bottom + 34.0
    );
    for (v, text) in x.ticks() {
        if let Some(p) = x.place(v) {
            let y = bottom + 13.0;
            let _ = write!(
                out,
                "<path class=\"axis\" d=\"M{p:.1} {bottom}v3\"/><text x=\"{p:.1}\" y=\"{y}\" text-anchor=\"middle\">{text}</text>"
            );
        }
    }
    for p in marks.iter().filter_map(|m| x.place(*m)) {
        let _ = write!(out, "<path class=\"axis one\" d=\"M{p:.1} 0V{bottom}\"/>");
    }
    for (k, r) in all.iter().enumerate() {
        let y = row * (k as f64 + 0.5) + 2.0;
        let bar = |[a, b]: [f64; 2], h: f64, class: &str| {
            let (Some(a), Some(b)) = (x.place(a), x.place(b)) else { return String::new() };
            format!(
                "<rect class=\"{class}\" x=\"{a:.1}\" y=\"{:.1}\" width=\"{:.1}\" height=\"{h}\" rx=\"1\"/>",
                y - 0.5 * h,
                (b - a).max(1.0)
            )
        };
        out += &bar(r.ends, 3.0, "plain-mark");
        out += &r.inner.map_or_else(String::new, |i| bar(i, 9.0, "plain-mark"));
        if let Some(p) = x.place(r.dot) {
            let _ = write!(out, "<circle class=\"after-mark\" cx=\"{p:.1}\" cy=\"{y:.1}\" r=\"3.6\"/>");
        }
        let _ = write!(
            out,
            "<text class=\"name\" x=\"{}\" y=\"{:.1}\" text-anchor=\"end\">{}</text><text x=\"{}\" y=\"{:.1}\">{}</text>",
            left - 8.0,
            y + 3.5,
            escape(&r.name),
            w - right + 8.0,
            y + 3.5,
            escape(&r.note)
        );
    }
    close_bars(&mut out, 0.5 * (left + w - right), bottom, x_label);
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_steps_are_round() {
        for (least, step) in [(0.9, 1.0), (1.1, 2.0), (2.1, 5.0), (6.0, 10.0), (0.03, 0.05)] {
            assert!((round_step(least) / step - 1.0).abs() < 1e-12, "{least}");
        }
    }

    #[test]
    fn law_ticks_lie_inside() {
        for (low, high, log) in [(0.0, 12.0, false), (-3e-4, 2e-4, false), (1e-7, 3e-2, true), (0.8, 1.3, true)] {
            let s = Scale::new([low, high].into_iter(), log, 0.0, 100.0).expect("finite");
            let ticks = s.ticks();
            assert!((2..=12).contains(&ticks.len()), "{low} {high}: {ticks:?}");
            for (v, _) in ticks {
                let p = s.place(v).expect("finite");
                assert!((-1e-6..=100.000_001).contains(&p), "{v}");
            }
        }
    }
}
