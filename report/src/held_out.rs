//! report: errors on runs held out. In: a closing. Out: tables.

use crate::html::{Cell, table};
use crate::words::number;
use std::fmt::Write as _;
use windfall_discover::close::{Closing, HeldOut};

/// A line of the table before and after.
struct Line {
    what: String,
    unit: &'static str,
    before: f64,
    after: f64,
}

fn held_out_lines(b: &HeldOut, a: &HeldOut) -> Vec<Line> {
    let mut lines = Vec::new();
    let mut line = |what: &str, unit, before: f64, after: f64| lines.push(Line { what: what.to_owned(), unit, before, after });
    for (axis, name) in ["x", "y", "z"].iter().enumerate() {
        if let (Some(b), Some(a)) = (b.specific_force_rms, a.specific_force_rms) {
            line(&format!("force residual over mass, body {name}"), "m/s²", b[axis], a[axis]);
        }
    }
    for (axis, name) in ["x", "y", "z"].iter().enumerate() {
        if let (Some(b), Some(a)) = (b.specific_moment_rms, a.specific_moment_rms) {
            line(&format!("moment residual over inertia, body {name}"), "rad/s²", b[axis], a[axis]);
        }
    }
    if let (Some(b), Some(a)) = (b.trajectory, a.trajectory) {
        if let (Some(b), Some(a)) = (b.attitude_rms_deg, a.attitude_rms_deg) {
            line("attitude, flown again", "deg", b, a);
        }
        if let (Some(b), Some(a)) = (b.rate_rms_deg_s, a.rate_rms_deg_s) {
            line("body rates, flown again", "deg/s", b, a);
        }
    }
    if let (Some(b), Some(a)) = (b.position_rms_m, a.position_rms_m) {
        line("position, flown again", "mm", 1e3 * b, 1e3 * a);
    }
    lines
}

/// Errors before and after; of a closing without effects those of the declared model alone.
pub(crate) fn held_out(c: &Closing) -> String {
    let (Some(b), Some(a)) = (&c.before.hold_out, &c.after.hold_out) else {
        return "<p>The campaign holds no run out: mark one with <code>use = \"hold-out\"</code>.</p>".to_owned();
    };
    let added = !c.effects.is_empty();
    let rows: Vec<Vec<Cell>> = held_out_lines(b, a)
        .into_iter()
        .map(|l| {
            let mut cells = vec![Cell::text(l.what), Cell::text(l.unit), Cell::number(l.before)];
            if added {
                cells.extend([Cell::number(l.after), Cell::Made(ratio(l.after / l.before))]);
            }
            cells
        })
        .collect();
    let heads = ["rms error", "unit", "declared model", "with effects", "after / before"];
    let mut out = table(if added { &heads } else { &heads[..3] }, &rows);
    if let (Some(b), Some(a), true) = (b.log_likelihood, a.log_likelihood, added) {
        let _ = writeln!(
            out,
            "<p>Log-likelihood of these runs, averaged over what identification leaves of the parameters, up to a constant of the data: {} before, {} after, a gain of {}.</p>",
            number(b),
            number(a),
            number(a - b)
        );
    }
    let rows: Vec<Vec<Cell>> = b
        .statistics
        .iter()
        .zip(&a.statistics)
        .map(|(b, a)| {
            let name = format!("{} {}", b.statistic, statistic_name(&b.quantity));
            let mut cells = vec![Cell::text(name), Cell::number(b.test), Cell::number(b.simulation)];
            if added {
                cells.push(Cell::number(a.simulation));
            }
            cells
        })
        .collect();
    if !rows.is_empty() {
        let heads = ["statistic", "test", "declared model", "with effects"];
        out += &table(if added { &heads } else { &heads[..3] }, &rows);
    }
    out
}

fn statistic_name(quantity: &str) -> &str {
    match quantity {
        "theta_deg" => "of Θ (deg)",
        "omega_qr_deg_s" => "of ω_q,r (deg/s)",
        other => other,
    }
}

fn ratio(r: f64) -> String {
    let class = if r < 0.98 {
        "better"
    } else if r > 1.02 {
        "worse"
    } else {
        ""
    };
    let text = if r.is_finite() { format!("× {r:.3}") } else { "–".to_owned() };
    format!("<span class=\"{class}\">{text}</span>")
}
