//! report: what the closings of a study name. In: their counts. Out: confusion matrix, stated probability against how often it is so.

use crate::chart::Range;
use crate::draw::Look;
use crate::html::{escape, section};
use crate::legend::key;
use crate::number;
use crate::plot::{Plot, Plots};
use crate::study_varied::{decades, quantity};
use crate::words::with_unit;
use std::fmt::Write as _;
use windfall_discover::NORMAL_95;
use windfall_discover::close::{Figure, Role, Series, Topic};
use windfall_study::{ClosingSummary, DependenceLine, ReliabilityPoint};

/// Quantities in the list, and those with a figure.
const MOST: usize = 16;
const SHOWN: usize = 6;

/// Two sections; nothing without closings.
pub(crate) fn closings(c: &ClosingSummary, plots: &mut Plots) -> String {
    let lead = "Look at the diagonal: draws in which exactly what acts was named. Rows: the families that act in a draw; columns: what its closing \
                names; darker: a larger share of the row. A rival that the data cannot tell apart counts as another name here.";
    let mut out = section("Confusion matrix", lead, &matrix(c));
    let lead = "Look for bars that hold the value in the name: of closings that state a probability for their set, the share in which it is the set \
                that acts. Bar: 95 % of what so few draws leave open.";
    let one = |r: &ReliabilityPoint| Range {
        name: format!("stated {:.1} % in the mean", 100.0 * r.stated),
        ends: r.ci95,
        inner: None,
        dot: r.share(),
        note: format!("{} of {}", r.count, r.of),
        look: Look::After,
    };
    let ranges: Vec<Range> = c.reliability.iter().map(one).collect();
    let drawn = plots.put(Plot::Ranges {
        title: "Stated probability of the named set against how often it acts".to_owned(),
        x_label: "share of closings".to_owned(),
        marks: vec![1.0],
        ranges,
    });
    out += &section("Stated probability against fraction true", lead, &drawn);
    out + &hangs(c, plots)
}

/// What naming the right set hangs on.
fn hangs(c: &ClosingSummary, plots: &mut Plots) -> String {
    let scored: Vec<(&DependenceLine, f64)> = c.dependence.iter().filter_map(|d| Some((d, d.score?))).collect();
    if scored.is_empty() {
        return String::new();
    }
    let one = |(d, score): &(&DependenceLine, f64)| Range {
        name: quantity(&d.name).0,
        ends: [score.min(0.0), score.max(0.0)],
        inner: None,
        dot: *score,
        note: if *score > 0.0 { "right where large" } else { "right where small" }.to_owned(),
        look: if score.abs() > NORMAL_95 { Look::After } else { Look::Plain },
    };
    let drawn = plots.put(Plot::Ranges {
        title: "How far right and wrong draws differ in what was varied".to_owned(),
        x_label: "score of Mann and Whitney, standard deviations".to_owned(),
        marks: vec![-NORMAL_95, 0.0, NORMAL_95],
        ranges: scored.iter().take(MOST).map(one).collect(),
    });
    let charts = plots.charts(scored.iter().take(SHOWN).map(|(d, _)| over(d)).collect::<Vec<_>>());
    let lead = "Look for dots outside the outer marks: then whether the right set is named hangs on that quantity (of twenty that do not \
                matter one lies outside). Below, the share of right draws over the first of them; a share that falls where an effect is weak is \
                its limit of detection. Bars: 95 % of what so few draws leave open; dashed: the share of all.";
    let marks = key(&[("after", "share of right draws"), ("noise", "of all")]);
    section("What right names hang on", lead, &format!("{drawn}{marks}<div class=\"grid\">{charts}</div>\n"))
}

/// Share of right draws over a quantity.
fn over(d: &DependenceLine) -> Figure {
    let (name, unit) = quantity(&d.name);
    let end = |k: usize| d.shares.iter().map(|s| s.ci95[k]).collect();
    let (x, y) = (d.values.clone(), d.shares.iter().map(ReliabilityPoint::share).collect());
    let points = Series { role: Role::After, x, y, band: Some([end(0), end(1)]), points: true };
    let ends = [d.values.first(), d.values.last()].into_iter().flatten().copied().collect();
    let whole =
        Series { role: Role::Noise, x: ends, y: d.shares.iter().take(2).map(|s| s.stated).collect(), ..Series::default() };
    Figure {
        topic: Topic::Variable,
        title: format!("Share of right draws over {name}"),
        x_label: with_unit(&name, unit),
        y_label: "share of draws named right".to_owned(),
        log_x: decades(&d.values),
        series: vec![whole, points],
        ..Figure::default()
    }
}

/// Counts as a table, each cell shaded by its share of the row.
fn matrix(c: &ClosingSummary) -> String {
    if c.confusion.is_empty() {
        return String::new();
    }
    // Truths first, in their order, so that right ones lie on the diagonal.
    let mut columns: Vec<&str> = c.confusion.iter().map(|l| l.truth.as_str()).collect();
    for found in c.confusion.iter().flat_map(|l| l.found.keys()) {
        if !columns.contains(&found.as_str()) {
            columns.push(found);
        }
    }
    let words = |set: &str| set.replace('+', " + ");
    let heads: String = columns.iter().map(|h| format!("<th scope=\"col\" class=\"n\">{}</th>", escape(&words(h)))).collect();
    let mut rows = String::new();
    for line in &c.confusion {
        let of = line.found.values().fold(0_u64, |sum, n| sum.saturating_add(*n));
        let _ = write!(rows, "<tr><th scope=\"row\">{}</th>", escape(&words(&line.truth)));
        for column in &columns {
            let n = line.found.get(*column).copied().unwrap_or(0);
            let right = if *column == line.truth { " right" } else { "" };
            let share = 100.0 * n as f64 / of.max(1) as f64;
            let text = if n == 0 { String::new() } else { n.to_string() };
            let _ = write!(rows, "<td class=\"n cell{right}\" style=\"--share:{share:.0}%\">{text}</td>");
        }
        let right = line.found.get(&line.truth).copied().unwrap_or(0);
        let _ = write!(rows, "<td class=\"n\">{of}</td><td class=\"n\">{}</td></tr>", number(right as f64 / of.max(1) as f64));
    }
    format!(
        "<div class=\"wide\" tabindex=\"0\" role=\"region\" aria-label=\"confusion matrix\"><table class=\"confusion\"><thead><tr><th \
         scope=\"col\">acts \\ named</th>{heads}<th scope=\"col\" class=\"n\">draws</th><th scope=\"col\" \
         class=\"n\">right</th></tr></thead><tbody>{rows}</tbody></table></div>\n"
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use windfall_study::ConfusionLine;

    #[test]
    fn law_the_matrix_has_every_count_once_and_its_diagonal() {
        let line = |truth: &str, found: &[(&str, u64)]| ConfusionLine {
            truth: truth.to_owned(),
            found: found.iter().map(|(f, n)| ((*f).to_owned(), *n)).collect(),
        };
        let confusion = vec![line("none", &[("none", 17), ("<mass>", 2)]), line("swirl", &[("swirl", 11), ("none", 4)])];
        let reliability = vec![ReliabilityPoint { stated: 0.97, count: 28, of: 34, ci95: [0.65, 0.93] }];
        let share = |count| ReliabilityPoint { stated: 0.5, count, of: 10, ci95: [0.0, 1.0] };
        let hangs = |score, name: &str| DependenceLine {
            name: name.to_owned(),
            score,
            values: vec![2.0, 3.0],
            shares: vec![share(1), share(9)],
        };
        let dependence =
            vec![hangs(Some(3.5), "vehicle.mass_kg"), hangs(Some(-0.5), "flight.release.attitude_deg.Ry"), hangs(None, "x")];
        let mut plots = Plots::default();
        let html = closings(&ClosingSummary { confusion, reliability, dependence }, &mut plots);
        for text in [">17<", ">2<", ">11<", ">4<", "&lt;mass&gt;", "stated 97.0 % in the mean", "28 of 34", ">0.8947<"] {
            assert!(html.contains(text), "{text} in {html}");
        }
        assert_eq!(html.matches("cell right").count(), 2);
        let Plot::Ranges { ranges, .. } = &plots.all[1] else { panic!("scores after the probabilities") };
        assert_eq!((ranges.len(), ranges[0].dot, ranges[0].look, ranges[1].look), (2, 3.5, Look::After, Look::Plain));
        let Plot::Chart(f) = &plots.all[2] else { panic!("a chart") };
        assert_eq!((f.x_label.as_str(), f.series[1].y.as_slice()), ("mass (kg)", &[0.1, 0.9][..]));
        // 17 of 19 are right: the cell is shaded by 89 %.
        assert!(html.contains("cell right\" style=\"--share:89%\">17<") && !html.contains("<mass>"));
    }
}
