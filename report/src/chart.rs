//! report: figures as drawings. In: curves over axes, bars, ranges. Out: lists of marks.

use crate::draw::{Anchor, Item, LETTERS, LineDrawing, Look, width};
use crate::scale::{Scale, plain};
use windfall_discover::close::{Figure, Role, Series};

/// Size of a chart on a page, drawing units.
pub(crate) const SIZE: [f64; 2] = [420.0, 250.0];
/// Room below for ticks and label, above, and right.
const ROOM: [f64; 3] = [40.0, 10.0, 14.0];

pub(crate) fn look(role: Role) -> Look {
    match role {
        Role::Measured => Look::Measured,
        Role::Before => Look::Before,
        Role::After => Look::After,
        Role::Noise => Look::Noise,
    }
}

/// Curves over axes; none when there is nothing to draw.
pub(crate) fn chart(f: &Figure, [w, h]: [f64; 2]) -> Option<LineDrawing> {
    let [below, above, right] = ROOM;
    let xs = f.series.iter().flat_map(|s| s.x.iter().copied());
    let ys = f.series.iter().flat_map(|s| s.y.iter().chain(s.band.iter().flatten().flatten()).copied());
    let y = Scale::new(ys, f.log_y, h - below, above)?;
    let widest = y.ticks().iter().map(|(_, t)| width(t)).fold(0.0, f64::max);
    let left = (widest + LETTERS + 16.0).ceil();
    let x = Scale::new(xs.chain(f.marks.iter().copied()), f.log_x, left, w - right)?.tight();
    let mut d = LineDrawing { title: f.title.clone(), size: [w, h], fixed: false, items: Vec::new() };
    axes(&mut d, &x, &y, f, left);
    for p in f.marks.iter().filter_map(|m| x.place(*m)) {
        d.line(Look::Mark, &[[p, above], [p, h - below]]);
    }
    for s in &f.series {
        if let Some(band) = s.band.as_ref().filter(|_| !s.points) {
            d.items.push(Item::Area { look: look(s.role), points: outline(&x, &y, s, band) });
        }
    }
    // Points lie on the curves.
    for s in f.series.iter().filter(|s| !s.points) {
        d.items.push(Item::Line { look: look(s.role), pieces: pieces(&x, &y, s) });
    }
    f.series.iter().filter(|s| s.points).for_each(|s| dots(&mut d, &x, &y, s));
    Some(d)
}

/// Discs, with their bands as error bars.
fn dots(d: &mut LineDrawing, x: &Scale, y: &Scale, s: &Series) {
    let look = if s.role == Role::Measured { Look::Point } else { look(s.role) };
    let radius = if s.x.len() > 60 { 1.6 } else { 2.8 };
    for (k, (a, b)) in s.x.iter().zip(&s.y).enumerate() {
        let (Some(px), Some(py)) = (x.place(*a), y.place(*b)) else { continue };
        if let Some([low, high]) = &s.band
            && let (Some(low), Some(high)) = (y.place(low[k]), y.place(high[k]))
        {
            d.line(look, &[[px, low], [px, high]]);
        }
        d.items.push(Item::Disc { look, at: [px, py], radius });
    }
}

/// Points of a curve, broken where it is not known.
fn pieces(x: &Scale, y: &Scale, s: &Series) -> Vec<Vec<[f64; 2]>> {
    let mut all = vec![Vec::new()];
    for (a, b) in s.x.iter().zip(&s.y) {
        match (x.place(*a), y.place(*b), all.last_mut()) {
            (Some(a), Some(b), Some(piece)) => piece.push([a, b]),
            _ => all.push(Vec::new()),
        }
    }
    all.retain(|p| !p.is_empty());
    all
}

/// Along the lower end of a band and back along the upper.
fn outline(x: &Scale, y: &Scale, s: &Series, [low, high]: &[Vec<f64>; 2]) -> Vec<[f64; 2]> {
    let there = s.x.iter().zip(low);
    let back = s.x.iter().zip(high).rev();
    there.chain(back).filter_map(|(a, b)| Some([x.place(*a)?, y.place(*b)?])).collect()
}

fn axes(d: &mut LineDrawing, x: &Scale, y: &Scale, f: &Figure, left: f64) {
    let [w, h] = d.size;
    let [below, above, right] = ROOM;
    let (bottom, end) = (h - below, w - right);
    for (v, text) in y.ticks() {
        if let Some(p) = y.place(v) {
            d.line(Look::Axis, &[[left, p], [end, p]]);
            d.text(Look::Soft, [left - 5.0, p + 3.5], Anchor::End, text);
        }
    }
    for (v, text) in x.ticks() {
        if let Some(p) = x.place(v) {
            d.line(Look::Axis, &[[p, bottom], [p, bottom + 4.0]]);
            // The last label stays inside the drawing.
            let p = p.min(w - 0.5 * width(&text));
            d.text(Look::Soft, [p, bottom + 15.0], Anchor::Middle, text);
        }
    }
    d.line(Look::Axis, &[[left, bottom], [end, bottom]]);
    d.text(Look::Soft, [0.5 * (left + end), h - 6.0], Anchor::Middle, f.x_label.clone());
    let (at, text) = ([LETTERS, 0.5 * (above + bottom)], f.y_label.clone());
    d.items.push(Item::Text { look: Look::Soft, at, anchor: Anchor::Middle, turned: true, text });
}

/// One bar of a bar chart.
pub(crate) struct Bar {
    pub(crate) name: String,
    pub(crate) value: f64,
    pub(crate) note: String,
    pub(crate) look: Look,
}

/// Height of a line of bars or ranges.
const ROW: f64 = 19.0;

/// Room for names at the left and notes at the right of rows of a chart.
fn room<'a>(names: impl Iterator<Item = &'a str>, notes: impl Iterator<Item = &'a str>) -> [f64; 2] {
    let widest = |all: &mut dyn Iterator<Item = &'a str>| all.map(width).fold(0.0, f64::max);
    let (mut names, mut notes) = (names, notes);
    // Letters of a page may be wider than Helvetica's.
    [1.12 * widest(&mut names) + 14.0, 1.12 * widest(&mut notes) + 14.0]
}

/// Bars to the right of their names, on a logarithmic scale from one.
pub(crate) fn bars(title: &str, all: &[Bar], x_label: &str, w: f64) -> Option<LineDrawing> {
    let [left, right] = room(all.iter().map(|b| b.name.as_str()), all.iter().map(|b| b.note.as_str()));
    let most = all.iter().map(|b| b.value).filter(|v| v.is_finite()).fold(10.0, f64::max).log10();
    let bottom = ROW * all.len() as f64 + 4.0;
    let place = |v: f64| left + v.max(1.0).log10() / most * (w - left - right);
    let mut d = LineDrawing { title: title.to_owned(), size: [w, bottom + 34.0], fixed: true, items: Vec::new() };
    #[expect(clippy::cast_possible_truncation, reason = "an exponent")]
    let last = most.floor() as i32;
    for e in (0..=last).step_by(usize::try_from(last / 6 + 1).unwrap_or(1)) {
        let p = place(10_f64.powi(e));
        d.line(Look::Axis, &[[p, 0.0], [p, bottom]]);
        d.text(Look::Soft, [p, bottom + 13.0], Anchor::Middle, plain(10_f64.powi(e)));
    }
    for (k, b) in all.iter().enumerate() {
        let (y, end) = (ROW * k as f64 + 3.0, place(b.value));
        d.text(Look::Ink, [left - 8.0, y + 10.5], Anchor::End, b.name.clone());
        d.items.push(Item::Rect { look: b.look, at: [left, y, (end - left).max(1.0), 13.0] });
        d.text(Look::Soft, [end + 6.0, y + 10.5], Anchor::Start, b.note.clone());
    }
    d.text(Look::Soft, [0.5 * (left + w - right), bottom + 29.0], Anchor::Middle, x_label);
    (!all.is_empty()).then_some(d)
}

/// One line of a chart of ranges: a bar from low to high, a thicker one inside it where there is such, a dot.
pub(crate) struct Range {
    pub(crate) name: String,
    pub(crate) ends: [f64; 2],
    pub(crate) inner: Option<[f64; 2]>,
    pub(crate) dot: f64,
    pub(crate) note: String,
    pub(crate) look: Look,
}

/// Ranges below each other on one axis, with marks down through all; none when there is nothing to draw.
pub(crate) fn ranges(title: &str, all: &[Range], marks: &[f64], x_label: &str, w: f64) -> Option<LineDrawing> {
    let [left, right] = room(all.iter().map(|b| b.name.as_str()), all.iter().map(|b| b.note.as_str()));
    let values = all.iter().flat_map(|r| r.ends.into_iter().chain([r.dot])).chain(marks.iter().copied());
    let x = Scale::new(values, false, left, w - right).filter(|_| !all.is_empty())?;
    let bottom = ROW * all.len() as f64 + 4.0;
    let mut d = LineDrawing { title: title.to_owned(), size: [w, bottom + 34.0], fixed: true, items: Vec::new() };
    for (v, text) in x.ticks() {
        if let Some(p) = x.place(v) {
            d.line(Look::Axis, &[[p, 0.0], [p, bottom + 3.0]]);
            d.text(Look::Soft, [p, bottom + 14.0], Anchor::Middle, text);
        }
    }
    for p in marks.iter().filter_map(|m| x.place(*m)) {
        d.line(Look::Mark, &[[p, 0.0], [p, bottom]]);
    }
    for (k, r) in all.iter().enumerate() {
        range(&mut d, &x, r, ROW * (k as f64 + 0.5) + 2.0, [left - 8.0, w - right + 8.0]);
    }
    d.text(Look::Soft, [0.5 * (left + w - right), bottom + 29.0], Anchor::Middle, x_label);
    Some(d)
}

fn range(d: &mut LineDrawing, x: &Scale, r: &Range, y: f64, [name_at, note_at]: [f64; 2]) {
    for ([a, b], height) in [(Some(r.ends), 3.0), (r.inner, 9.0)].into_iter().filter_map(|(e, h)| Some((e?, h))) {
        if let (Some(a), Some(b)) = (x.place(a), x.place(b)) {
            d.items.push(Item::Rect { look: Look::Plain, at: [a, y - 0.5 * height, (b - a).max(1.0), height] });
        }
    }
    if let Some(p) = x.place(r.dot) {
        d.items.push(Item::Disc { look: r.look, at: [p, y], radius: 3.6 });
    }
    d.text(Look::Ink, [name_at, y + 3.5], Anchor::End, r.name.clone());
    d.text(Look::Soft, [note_at, y + 3.5], Anchor::Start, r.note.clone());
}
