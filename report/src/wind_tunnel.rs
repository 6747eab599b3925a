//! report: identified static coefficients beside wind-tunnel points. In: differences at the points. Out: points for a curve's figure, a table.

use crate::html::{Cell, table};
use windfall_discover::close::{Role, Series};
use windfall_discover::{NORMAL_95, WindTunnelLine, WindTunnelModel};

/// Points of a test with their 95 % uncertainty.
pub(crate) fn points(line: &WindTunnelLine) -> Series {
    let end = |sign: f64| line.measured.iter().zip(&line.std).map(|(v, s)| v + sign * NORMAL_95 * s).collect();
    Series {
        role: Role::Measured,
        x: line.angle_deg.clone(),
        y: line.measured.clone(),
        band: (!line.std.is_empty()).then(|| [end(-1.0), end(1.0)]),
        points: true,
    }
}

/// Size of the differences, a row for each coefficient and model; nothing without points.
pub(crate) fn differences(lines: &[WindTunnelLine], name: impl Fn(&str) -> String) -> String {
    let row = |l: &WindTunnelLine, m: &WindTunnelModel| {
        let largest = l.measured.iter().map(|v| v.abs()).fold(f64::MIN_POSITIVE, f64::max);
        let n = l.measured.len();
        vec![
            Cell::text(&l.test),
            Cell::text(&l.quantity),
            Cell::text(name(&m.model)),
            Cell::Number(n.to_string()),
            Cell::number(m.rms),
            Cell::Number(format!("{:.1} %", 100.0 * m.rms / largest)),
            Cell::number(m.mean),
            Cell::Number(m.apart.map_or_else(|| "–".to_owned(), |a| format!("{a} of {n}"))),
            Cell::Number(m.beyond_runs.to_string()),
        ]
    };
    let rows: Vec<Vec<Cell>> = lines.iter().flat_map(|l| l.models.iter().map(move |m| row(l, m))).collect();
    let heads = [
        "test",
        "coefficient",
        "model",
        "points",
        "rms difference",
        "of the largest",
        "mean (measured − model)",
        "beyond 95 % of both",
        "beyond the angles flown",
    ];
    if rows.is_empty() { String::new() } else { table(&heads, &rows) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_error_bars_and_shares() {
        let value = serde_json::json!({"test": "<b>", "quantity": "C_m", "angle_deg": [0.0, 10.0], "measured": [0.0, -0.5], "std": [0.01, 0.02],
            "models": [{"model": "after", "value": [0.0, -0.4], "rms": 0.05, "mean": -0.05, "beyond_runs": 1, "apart": 1}]});
        let line: WindTunnelLine = serde_json::from_value(value).expect("a line");
        let band = points(&line).band.expect("stated");
        assert!((band[1][1] + 0.5 - 0.02 * NORMAL_95).abs() < 1e-12 && (band[0][0] + 0.01 * NORMAL_95).abs() < 1e-12);
        let html = differences(&[line], str::to_uppercase);
        for text in ["&lt;b&gt;", ">AFTER<", ">10.0 %<", ">1 of 2<"] {
            assert!(html.contains(text), "{text} in {html}");
        }
        assert!(differences(&[], str::to_owned).is_empty());
    }
}
