//! report: drawings as SVG. In: lists of marks. Out: SVG that takes its colours from the page, or brings its own for a file.

use crate::draw::{Anchor, Item, LETTERS, LineDrawing, Look};
use crate::html::escape;
use std::fmt::Write as _;

/// Where a drawing goes.
#[derive(Clone, Copy, PartialEq)]
enum Ground {
    /// A page with a style sheet.
    Page,
    /// A file of its own, this wide, mm.
    File(f64),
}

/// A figure of a page with its caption.
pub(crate) fn figure(d: &LineDrawing) -> String {
    let caption = if d.title.is_empty() { String::new() } else { format!("<figcaption>{}</figcaption>", escape(&d.title)) };
    let class = if d.fixed { " class=\"rows\"" } else { "" };
    format!("<figure{class}>{caption}{}</figure>\n", drawn(d, Ground::Page))
}

/// A file, `width_mm` wide.
pub(crate) fn file(d: &LineDrawing, width_mm: f64) -> String {
    format!("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n{}\n", drawn(d, Ground::File(width_mm)))
}

fn drawn(d: &LineDrawing, ground: Ground) -> String {
    let [w, h] = d.size;
    let title = escape(&d.title);
    let mut out = match ground {
        Ground::Page if d.fixed => {
            format!("<svg viewBox=\"0 0 {w} {h}\" style=\"width:{w}px\" role=\"img\" aria-label=\"{title}\">")
        }
        Ground::Page => format!("<svg viewBox=\"0 0 {w} {h}\" role=\"img\" aria-label=\"{title}\">"),
        Ground::File(mm) => format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {w} {h}\" width=\"{mm}mm\" height=\"{:.2}mm\" \
             font-family=\"Helvetica, Arial, sans-serif\" font-size=\"{LETTERS}\"><title>{title}</title>",
            mm * h / w
        ),
    };
    d.items.iter().for_each(|i| item(&mut out, i, ground));
    out.push_str("</svg>");
    out
}

/// What a mark of that look has as attributes; `filled` or only its line.
fn dress(look: Look, kind: &str, filled: bool, ground: Ground) -> String {
    if ground == Ground::Page {
        return format!("class=\"{kind} {}\"", look.class());
    }
    let [r, g, b] = look.rgb();
    let colour = format!("#{r:02x}{g:02x}{b:02x}");
    if filled {
        let clear = if kind == "band" { " fill-opacity=\"0.22\"" } else { "" };
        return format!("fill=\"{colour}\"{clear}");
    }
    let dash = look.dash().map_or_else(String::new, |[a, b]| format!(" stroke-dasharray=\"{a} {b}\""));
    format!("fill=\"none\" stroke=\"{colour}\" stroke-width=\"{}\"{dash}", look.width())
}

fn path(points: &[[f64; 2]]) -> String {
    points.iter().enumerate().map(|(k, [x, y])| format!("{}{x:.1} {y:.1}", if k == 0 { 'M' } else { 'L' })).collect()
}

fn item(out: &mut String, item: &Item, ground: Ground) {
    let _ = match item {
        Item::Line { look, pieces } => {
            let kind = if matches!(look, Look::Axis | Look::Mark) { "line" } else { "curve" };
            let d: String = pieces.iter().map(|p| path(p)).collect();
            write!(out, "<path {} d=\"{d}\"/>", dress(*look, kind, false, ground))
        }
        Item::Area { look, points } => write!(out, "<path {} d=\"{}Z\"/>", dress(*look, "band", true, ground), path(points)),
        Item::Rect { look, at: [x, y, w, h] } => write!(
            out,
            "<rect {} x=\"{x:.1}\" y=\"{y:.1}\" width=\"{w:.1}\" height=\"{h}\" rx=\"1.5\"/>",
            dress(*look, "mark", true, ground)
        ),
        Item::Disc { look, at: [x, y], radius } => {
            write!(out, "<circle {} cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{radius}\"/>", dress(*look, "mark", true, ground))
        }
        Item::Text { look, at: [x, y], anchor, turned, text } => {
            let anchor = match anchor {
                Anchor::Start => "start",
                Anchor::Middle => "middle",
                Anchor::End => "end",
            };
            let place = if *turned {
                format!("transform=\"translate({x:.1} {y:.1}) rotate(-90)\"")
            } else {
                format!("x=\"{x:.1}\" y=\"{y:.1}\"")
            };
            let dress = dress(*look, "words", true, ground);
            write!(out, "<text {dress} {place} text-anchor=\"{anchor}\">{}</text>", escape(text))
        }
    };
}

/// Ratios before and after as two dots on one common logarithmic line, with a mark at one.
pub(crate) fn dots(before: f64, after: f64, highest: f64) -> String {
    let (w, h) = (200.0, 16.0);
    let high = highest.max(3.0).log10() * 1.03;
    let low = -0.35;
    let place = |v: f64| 6.0 + (v.max(1e-9).log10().clamp(low, high) - low) / (high - low) * (w - 12.0);
    let (one, b, a) = (place(1.0), place(before), place(after));
    format!(
        "<svg viewBox=\"0 0 {w} {h}\" style=\"width:{w}px\" role=\"img\" aria-label=\"{} before, {} after\"><path class=\"line \
         one\" d=\"M{one:.1} 0V{h}\"/><path class=\"link\" d=\"M{b:.1} 8H{a:.1}\"/><circle class=\"mark before\" cx=\"{b:.1}\" \
         cy=\"8\" r=\"6\"/><circle class=\"mark after\" cx=\"{a:.1}\" cy=\"8\" r=\"3.6\"/></svg>",
        crate::number(before),
        crate::number(after)
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn law_words_are_escaped_in_every_drawing() {
        let mut d = LineDrawing { title: "<script>".to_owned(), size: [100.0, 50.0], fixed: false, items: Vec::new() };
        d.text(Look::Ink, [1.0, 2.0], Anchor::End, "a<b & \"c\"");
        for text in [figure(&d), file(&d, 86.0)] {
            assert!(!text.contains("<script>") && text.contains("a&lt;b &amp; &quot;c&quot;"), "{text}");
        }
        assert!(file(&d, 86.0).contains("width=\"86mm\" height=\"43.00mm\""));
    }
}
