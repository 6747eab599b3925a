//! report: estimates beside what they are of. In: pairs of truth and estimate with intervals. Out: a drawing.

use crate::draw::{Anchor, Item, LETTERS, LineDrawing, Look, width};
use crate::scale::Scale;

/// One estimate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Pair {
    pub(crate) truth: f64,
    pub(crate) estimate: f64,
    /// Half of the 95 % interval.
    pub(crate) half: f64,
}

impl Pair {
    fn held(&self) -> bool {
        (self.estimate - self.truth).abs() <= self.half
    }
}

/// Room below for ticks and label, above, and right.
const ROOM: [f64; 3] = [40.0, 10.0, 14.0];

/// Estimates with their intervals over the truth, which is a line: an upward one where truths differ, a level one where all are the same, and
/// the estimates beside each other in their order. An interval that misses is of the other colour.
pub(crate) fn pairs(title: &str, y_label: &str, all: &[Pair], [w, h]: [f64; 2]) -> Option<LineDrawing> {
    let [below, above, right] = ROOM;
    let bottom = h - below;
    let ends = all.iter().flat_map(|p| [p.estimate - p.half, p.estimate + p.half, p.truth]);
    let y = Scale::new(ends, false, bottom, above)?;
    // Letters of a page may be wider than Helvetica's.
    let left = (1.15 * y.ticks().iter().map(|(_, t)| width(t)).fold(0.0, f64::max) + LETTERS + 16.0).ceil();
    let same = is_one_truth(all);
    let places: Vec<f64> = if same { (1..=all.len()).map(|k| k as f64).collect() } else { all.iter().map(|p| p.truth).collect() };
    let x = Scale::new(places.iter().copied(), false, left, w - right)?;
    let mut d = LineDrawing { title: title.to_owned(), size: [w, h], fixed: false, items: Vec::new() };
    for (v, text) in y.ticks() {
        if let Some(p) = y.place(v) {
            d.line(Look::Axis, &[[left, p], [w - right, p]]);
            d.text(Look::Soft, [left - 5.0, p + 3.5], Anchor::End, text);
        }
    }
    for (v, text) in x.ticks() {
        if let Some(p) = x.place(v) {
            d.line(Look::Axis, &[[p, bottom], [p, bottom + 4.0]]);
            d.text(Look::Soft, [p, bottom + 15.0], Anchor::Middle, text);
        }
    }
    d.line(Look::Axis, &[[left, bottom], [w - right, bottom]]);
    let x_label = if same { "draw" } else { "put in" };
    d.text(Look::Soft, [0.5 * (left + w - right), h - 6.0], Anchor::Middle, x_label);
    let (at, text) = ([LETTERS, 0.5 * (above + bottom)], y_label.to_owned());
    d.items.push(Item::Text { look: Look::Soft, at, anchor: Anchor::Middle, turned: true, text });
    let (low, high) = all.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), p| (a.min(p.truth), b.max(p.truth)));
    if let (Some(a), Some(b)) = (y.place(low), y.place(high)) {
        let ends = if same { [left, w - right] } else { [x.place(low)?, x.place(high)?] };
        d.line(Look::Mark, &[[ends[0], a], [ends[1], b]]);
    }
    for (p, at) in all.iter().zip(places) {
        let (Some(px), Some(py)) = (x.place(at), y.place(p.estimate)) else { continue };
        let look = if p.held() { Look::After } else { Look::Before };
        if let (Some(a), Some(b)) = (y.place(p.estimate - p.half), y.place(p.estimate + p.half)) {
            d.line(look, &[[px, a], [px, b]]);
        }
        d.items.push(Item::Disc { look, at: [px, py], radius: 2.4 });
    }
    Some(d)
}

/// Whether all truths are the same to nine digits; sums of estimate and error round.
pub(crate) fn is_one_truth(all: &[Pair]) -> bool {
    all.windows(2).all(|w| (w[0].truth - w[1].truth).abs() <= 1e-9 * w[0].truth.abs().max(w[0].half))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn discs(d: &LineDrawing) -> Vec<(Look, [f64; 2])> {
        let of = |i: &Item| if let Item::Disc { look, at, .. } = i { Some((*look, *at)) } else { None };
        d.items.iter().filter_map(of).collect()
    }

    /// Truths 1, 2, 3 lie evenly along the axis; the second estimate misses by more than its interval and has the other colour.
    #[test]
    fn exact_places_and_colours() {
        let pair = |truth, estimate| Pair { truth, estimate, half: 0.1 };
        let all = [pair(1.0, 1.05), pair(2.0, 2.2), pair(3.0, 3.0)];
        let d = pairs("t", "estimate", &all, [400.0, 250.0]).expect("a drawing");
        let found = discs(&d);
        assert_eq!(found.iter().map(|f| f.0).collect::<Vec<_>>(), [Look::After, Look::Before, Look::After]);
        let steps = [found[1].1[0] - found[0].1[0], found[2].1[0] - found[1].1[0]];
        assert!((steps[0] - steps[1]).abs() < 1e-9 && steps[0] > 50.0);
        // The line of truth passes through the third, which is right: one line that is neither axis nor interval.
        let line = d.items.iter().find_map(|i| match i {
            Item::Line { look: Look::Mark, pieces } => Some(pieces[0].clone()),
            _ => None,
        });
        let line = line.expect("a line of truth");
        assert!((line[1][0] - found[2].1[0]).abs() < 1e-9 && (line[1][1] - found[2].1[1]).abs() < 1e-9);
        let same = pairs("t", "estimate", &[pair(2.0, 2.0), pair(2.0, 2.1)], [400.0, 250.0]).expect("a drawing");
        assert!(discs(&same)[1].1[0] > discs(&same)[0].1[0], "beside each other");
        assert!(pairs("t", "e", &[], [400.0, 250.0]).is_none());
    }
}
