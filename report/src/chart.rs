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
    let y = Scale::new(ordinates(f).into_iter(), f.log_y, h - below, above)?;
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

/// Ordinates and bands that set the scale: of the figure's interior where it has one with any of them in it, else all.
fn ordinates(f: &Figure) -> Vec<f64> {
    let of = |[from, to]: [f64; 2]| -> Vec<f64> {
        let all = |s: &Series| -> Vec<f64> {
            let here: Vec<usize> = (0..s.x.len().min(s.y.len())).filter(|&i| (from..=to).contains(&s.x[i])).collect();
            let band = s.band.iter().flatten();
            here.iter().map(|&i| s.y[i]).chain(band.flat_map(|b| here.iter().map(|&i| b[i]))).collect()
        };
        f.series.iter().flat_map(all).collect()
    };
    let whole = [f64::NEG_INFINITY, f64::INFINITY];
    f.interior.map(of).filter(|inside| inside.iter().any(|v| v.is_finite())).unwrap_or_else(|| of(whole))
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
    all.into_iter().flat_map(|piece| within(&piece, y.ends())).collect()
}

/// Pieces of a curve between two heights of the paper, cut where it passes them.
fn within(curve: &[[f64; 2]], [low, high]: [f64; 2]) -> Vec<Vec<[f64; 2]>> {
    let is_inside = |p: &[f64; 2]| (low..=high).contains(&p[1]);
    // A straight line from a point inside to the end that it passes.
    let cut = |from: [f64; 2], to: [f64; 2]| {
        let end = to[1].clamp(low, high);
        let share = (end - from[1]) / (to[1] - from[1]);
        [from[0] + share * (to[0] - from[0]), end]
    };
    let mut all: Vec<Vec<[f64; 2]>> = vec![Vec::new()];
    let mut last: Option<[f64; 2]> = None;
    for p in curve {
        let (was, is) = (last.filter(is_inside), is_inside(p));
        let Some(piece) = all.last_mut() else { break };
        match (was, last) {
            (Some(a), _) if !is => piece.push(cut(a, *p)),
            (None, Some(a)) if is => piece.push(cut(*p, a)),
            _ => {}
        }
        if is {
            piece.push(*p);
        } else if !piece.is_empty() {
            all.push(Vec::new());
        }
        last = Some(*p);
    }
    all.retain(|piece| !piece.is_empty());
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

#[cfg(test)]
mod tests {
    use super::*;
    use windfall_discover::close::Series;

    /// Of a curve that is 6.2 to 7.5 inside and 26 at its end, the inside sets the scale, and the curve is cut where it leaves the figure: halfway
    /// between 7 and 27 the paper would end at 7.565, so that the cut is at 0.02825 of that step.
    #[test]
    fn exact_the_ends_do_not_set_the_scale() {
        let series = vec![Series { x: vec![0.0, 1.0, 2.0, 3.0], y: vec![6.2, 7.5, 7.0, 27.0], ..Series::default() }];
        let figure = Figure { series, interior: Some([0.0, 2.5]), ..Figure::default() };
        let drawn = |f: &Figure| chart(f, SIZE).expect("something to draw");
        let curve = |d: &LineDrawing| -> Vec<[f64; 2]> {
            d.items
                .iter()
                .find_map(|i| if let Item::Line { look: Look::Measured, pieces } = i { Some(pieces.concat()) } else { None })
                .expect("a curve")
        };
        let inside = curve(&drawn(&figure));
        let [below, above, _] = ROOM;
        let (bottom, low, high) = (SIZE[1] - below, 6.2 - 0.065, 7.5 + 0.065);
        let at = |v: f64| bottom + (v - low) / (high - low) * (above - bottom);
        for (p, v) in inside.iter().zip([6.2, 7.5, 7.0]) {
            assert!((p[1] - at(v)).abs() < 1e-9, "{p:?} for {v}");
        }
        let share = (high - 7.0) / 20.0;
        let [step, cut] = [inside[2][0] - inside[1][0], inside[3][0] - inside[2][0]];
        assert!((inside[3][1] - above).abs() < 1e-9 && (cut / step - share).abs() < 1e-9, "{inside:?}");
        // Without an interior all of it is inside.
        assert_eq!(curve(&drawn(&Figure { interior: None, ..figure })).len(), 4);
    }
}
