//! report: absolute checks of a closing. In: its checks. Out: a table, a row a run, a column a channel.

use crate::html::{Cell, escape, table};
use crate::words::{channel, number, p_with_sign};
use windfall_discover::close::{CheckLine, CheckedRuns, Closing};

/// Mean squares by run and channel, those that fail marked with their p-value; checks that square nothing after them.
pub(crate) fn checks(c: &Closing) -> String {
    let squared: Vec<&CheckLine> = c.checks.iter().filter(|l| l.mean_square.is_some()).collect();
    let mut channels: Vec<&str> = Vec::new();
    let mut runs: Vec<(&str, CheckedRuns)> = Vec::new();
    for line in &squared {
        if !channels.contains(&line.what.as_str()) {
            channels.push(&line.what);
        }
        if !runs.contains(&(line.run.as_str(), line.used)) {
            runs.push((&line.run, line.used));
        }
    }
    let row = |(run, used): &(&str, CheckedRuns)| {
        let of = |what: &&str| squared.iter().find(|l| l.run == *run && l.used == *used && l.what == **what);
        let cells = channels.iter().map(|what| of(what).map_or(Cell::Number(String::new()), |l| cell(l)));
        let name = if run.is_empty() { "all".to_owned() } else { (*run).to_owned() };
        [Cell::text(name), Cell::text(words(*used))].into_iter().chain(cells).collect::<Vec<_>>()
    };
    let rows: Vec<Vec<Cell>> = runs.iter().map(row).collect();
    let named: Vec<String> = channels.iter().map(|what| channel(what)).collect();
    let heads: Vec<&str> = ["run", "used for"].into_iter().chain(named.iter().map(String::as_str)).collect();
    let table = if rows.is_empty() { String::new() } else { table(&heads, &rows) };
    let others = c.checks.iter().filter(|l| l.mean_square.is_none());
    let other = |l: &CheckLine| {
        format!("<p>{}: {}, {}: {}.</p>\n", words(l.used), escape(&l.what), escape(&p_with_sign(l.p_value)), passes(l.ok))
    };
    table + &others.map(other).collect::<String>()
}

fn words(used: CheckedRuns) -> &'static str {
    match used {
        CheckedRuns::Identify => "identified on",
        CheckedRuns::HoldOut => "held out",
    }
}

fn passes(ok: bool) -> &'static str {
    if ok { "passes" } else { "<strong class=\"worse\">fails</strong>" }
}

fn cell(l: &CheckLine) -> Cell {
    let square = l.mean_square.map_or_else(String::new, number);
    if l.ok {
        return Cell::Number(square);
    }
    Cell::Made(format!("<strong class=\"worse\">{square} ({})</strong>", escape(&p_with_sign(l.p_value))))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A failing check stands out with its p-value, in the row of its run and the column of its channel.
    #[test]
    fn law_a_failing_check_stands_out() {
        let line = |run: &str, used: &str, what: &str, mean_square: f64, ok: bool| serde_json::json!({"run": run, "used": used, "what": what, "mean_square": mean_square, "p_value": if ok { 0.4 } else { 1e-9 }, "ok": ok});
        let c: Closing = serde_json::from_value(serde_json::json!({
            "campaign": "c", "verdict": "unexplained", "residual": {"per_channel": []}, "residual_after": {"per_channel": []}, "effects": [],
            "candidates": [], "bounds": [], "unexplained": [], "shifts": [], "before": {"parameters": [], "hold_out": null},
            "after": {"parameters": [], "hold_out": null}, "false_alarm_rate": 0.005,
            "checks": [line("a", "identify", "X_m", 1.0, true), line("b<", "hold-out", "X_m", 49.0, false),
                {"run": "", "used": "hold-out", "what": "parameters", "mean_square": null, "p_value": 0.3, "ok": true}]
        }))
        .expect("a closing");
        let page = checks(&c);
        for text in [
            "<td>a</td><td>identified on</td><td class=\"n\">1.000</td>",
            "<td>b&lt;</td><td>held out</td><td><strong class=\"worse\">49.00 (p = 1e-9)</strong></td>",
            "held out: parameters, p = 0.30: passes",
        ] {
            assert!(page.contains(text), "{text}: {page}");
        }
    }
}
