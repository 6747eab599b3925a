//! report: the page of many campaigns. In: their summary. Out: HTML; a table, failures with their reasons, a forest plot of each parameter.

use crate::chart::Range;
use crate::data::data;
use crate::draw::Look;
use crate::html::{Cell, escape, page, section, table};
use crate::plot::{Plot, Plots};
use crate::words::{interval, number, p_value, p_with_sign, with_interval};
use windfall_discover::{NORMAL_95, ci95};
use windfall_study::many::{CampaignOutcome, ManySummary, PooledParameter, Status};

/// Title of the page.
pub(crate) const TITLE: &str = "Many campaigns";
/// Campaigns in a forest plot at most, those with the smallest errors.
const FOREST: usize = 80;

/// The page in one piece.
#[must_use]
pub fn many_page(s: &ManySummary) -> String {
    let mut plots = Plots::default();
    let body = many_body(s, &mut plots);
    page(TITLE, &body, &data(&[], &plots))
}

/// Its body.
pub(crate) fn many_body(s: &ManySummary, plots: &mut Plots) -> String {
    let failed: Vec<&CampaignOutcome> = s.outcomes.iter().filter(|o| o.status == Status::Failed).collect();
    let mut out = format!("<h1>{TITLE}</h1>\n<p class=\"lead\">{}</p>\n", escape(&lead(s)));
    out += &section(
        "Campaigns",
        "Look for small p and for verdicts other than their neighbours'; heads sort, words filter, and each campaign's path opens its page. p: of the \
                    channel that is least like noise under the declared model.",
        &campaigns(s),
    );
    let lead = "What each was refused for, or failed at; the others are not touched by it.";
    out += &section("Failures", lead, &failures(&failed));
    out += &section("Parameters over campaigns", POOLED, &pooled(s));
    for p in &s.pooled {
        let title = format!("{} {}", p.of, p.name);
        out += &section(&title, &heterogeneity(p), &forest(s, p, plots));
    }
    out
}

const POOLED: &str = "Random effects: mean with 95 % interval (Hartung and Knapp 2001), standard deviation τ between campaigns \
    (Paule and Mandel 1982; interval by the profile of Q), where one more campaign would lie with 95 %, and the chance of so \
    large a spread from the stated errors alone. Campaigns without a result, with a residual that nothing explains, or without a standard \
    error are left out; an effect's numbers are of the campaigns in which it was found. In \
    the figures each campaign has its 95 % interval; the mean's is thick, and thin where one more campaign would lie.";

fn lead(s: &ManySummary) -> String {
    let list = |all: &[windfall_study::many::Tally]| {
        all.iter().map(|t| format!("{} {}", t.count, t.name)).collect::<Vec<_>>().join(", ")
    };
    let verdicts = if s.verdicts.is_empty() { String::new() } else { format!(": {}", list(&s.verdicts)) };
    let families = if s.families.is_empty() { String::new() } else { format!(" Effects named: {}.", list(&s.families)) };
    format!("{} campaigns; {} with a result{verdicts}; {} failed.{families}", s.campaigns, s.ok, s.failed)
}

fn campaigns(s: &ManySummary) -> String {
    let closed = s.outcomes.iter().any(|o| o.verdict.is_some());
    let row = |o: &CampaignOutcome| {
        let number = |x: Option<f64>, as_text: fn(f64) -> String| Cell::Number(x.map_or_else(|| "–".to_owned(), as_text));
        let path = match &o.page {
            Some(page) => Cell::Made(format!("<a href=\"{}\">{}</a>", escape(&address(page)), escape(&o.path))),
            None => Cell::text(&o.path),
        };
        let mut cells = vec![path, Cell::text(&o.name)];
        let conclusion = o.verdict.map_or_else(|| o.method.clone(), |v| v.name().to_owned());
        cells.push(Cell::text(if o.status == Status::Failed { "failed".to_owned() } else { conclusion }));
        if closed {
            cells.push(Cell::text(o.families.join(", ")));
            cells.push(number(o.probability, |p| format!("{p:.2}")));
        }
        cells.push(Cell::text(&o.worst_channel));
        cells.push(number(o.p_value, p_value));
        cells
    };
    let heads: &[&str] = if closed {
        &["campaign", "name", "verdict", "families", "probability", "worst channel", "p"]
    } else {
        &["campaign", "name", "method", "worst residual", "p"]
    };
    let all = table(heads, &s.outcomes.iter().map(row).collect::<Vec<_>>());
    format!("<div data-filter=\"the campaigns\">{all}</div>\n")
}

/// A path as a relative address (RFC 3986).
fn address(path: &str) -> String {
    let one = |b: u8| match b {
        b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b'-' | b'.' | b'_' | b'~' | b'/' => char::from(b).to_string(),
        _ => format!("%{b:02X}"),
    };
    path.bytes().map(one).collect()
}

fn failures(failed: &[&CampaignOutcome]) -> String {
    let row = |o: &&CampaignOutcome| vec![Cell::text(&o.path), Cell::Number(o.exit_code.to_string()), Cell::text(&o.reason)];
    let rows: Vec<Vec<Cell>> = failed.iter().map(row).collect();
    if rows.is_empty() { String::new() } else { table(&["campaign", "exit code", "reason"], &rows) }
}

fn pooled(s: &ManySummary) -> String {
    let row = |p: &PooledParameter| {
        let q = &p.pooled;
        let half = 0.5 * (q.ci95[1] - q.ci95[0]);
        let (mean, half) = with_interval(q.mean, Some(half));
        vec![
            Cell::text(format!("{} {}", p.of, p.name)),
            Cell::text(if p.unit == "-" { "" } else { &p.unit }),
            Cell::Number(q.n.to_string()),
            Cell::Number(half.map_or_else(|| mean.clone(), |h| format!("{mean} ± {h}"))),
            Cell::Number(format!("{} {}", number(q.tau), interval(q.tau_ci95))),
            Cell::Number(q.prediction95.map_or_else(|| "–".to_owned(), interval)),
            Cell::Number(p_value(q.p_value)),
        ]
    };
    let rows: Vec<Vec<Cell>> = s.pooled.iter().map(row).collect();
    if rows.is_empty() {
        return String::new();
    }
    let mut heads = vec!["parameter", "unit", "campaigns", "mean ± 95 %", "τ [95 %]", "one more campaign, 95 %", "p"];
    let mut rows = rows;
    if s.pooled.iter().all(|p| p.unit == "-") {
        heads.remove(1);
        rows.iter_mut().for_each(|r| drop(r.remove(1)));
    }
    table(&heads, &rows)
}

fn heterogeneity(p: &PooledParameter) -> String {
    let q = &p.pooled;
    let word = if q.p_value < 0.05 {
        "campaigns differ by more than their errors"
    } else {
        "campaigns differ by no more than their errors"
    };
    format!("Q = {} of {} degrees of freedom, {}: {word}.", number(q.q), q.n.saturating_sub(1), p_with_sign(q.p_value))
}

/// Estimates of the campaigns with their 95 % intervals, then the mean with its own and, thin, that of one more campaign.
fn forest(s: &ManySummary, p: &PooledParameter, plots: &mut Plots) -> String {
    let mut all = s.estimates(p);
    let total = all.len();
    if total > FOREST {
        let mut errors: Vec<f64> = all.iter().map(|e| e.2).collect();
        errors.sort_by(f64::total_cmp);
        all.retain(|e| e.2 <= errors[FOREST - 1]);
        all.truncate(FOREST);
    }
    let unit = if p.unit == "-" { "no unit".to_owned() } else { p.unit.clone() };
    let half = |x: f64, half: f64| {
        let (x, half) = with_interval(x, Some(half));
        half.map_or_else(|| x.clone(), |h| format!("{x} ± {h}"))
    };
    let one = |(path, y, error): &(&str, f64, f64)| Range {
        name: path.strip_suffix("/campaign.toml").unwrap_or(path).to_owned(),
        ends: ci95(*y, *error),
        inner: None,
        dot: *y,
        note: half(*y, NORMAL_95 * error),
        look: Look::After,
    };
    let mut ranges: Vec<Range> = all.iter().map(one).collect();
    let q = &p.pooled;
    ranges.push(Range {
        name: format!("mean of {total}"),
        ends: q.prediction95.unwrap_or(q.ci95),
        inner: Some(q.ci95),
        dot: q.mean,
        note: half(q.mean, 0.5 * (q.ci95[1] - q.ci95[0])),
        look: Look::Before,
    });
    let few = if total > FOREST { format!("; the {FOREST} of {total} with the smallest errors") } else { String::new() };
    let x_label = format!("{} ({unit}){few}", p.name);
    let title = format!("{} {} over campaigns", p.of, p.name);
    plots.put(Plot::Ranges { title, x_label, marks: vec![q.mean], ranges })
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn summary() -> ManySummary {
        let one = |path: &str, y: f64, s: f64| {
            let parameter = json!({"of": "CA", "name": "CA_T0", "estimate": y, "std_error": s, "unit": "-", "effect": false});
            json!({"path": path, "name": "n", "status": "ok", "exit_code": 0, "reason": "", "method": "", "verdict": "effect",
                "families": ["swirl"], "probability": 0.75, "worst_channel": "X_m", "p_value": 0.25, "parameters": [parameter]})
        };
        let mut failed = one("c/<x>/campaign.toml", 0.0, 0.0);
        let other =
            json!({"status": "failed", "exit_code": 2, "reason": "no <run>", "verdict": null, "families": [], "parameters": []});
        other.as_object().expect("a record").iter().for_each(|(k, v)| failed[k] = v.clone());
        let mut outcomes = [one("a/campaign.toml", 6.0, 0.1), one("b.toml", 7.0, 0.1), failed];
        outcomes[0]["page"] = json!("results/a b/\"x\"/report.html");
        let outcomes = outcomes.map(|o| serde_json::from_value(o).expect("an outcome")).to_vec();
        ManySummary::new("0", json!({"close": {}}), ["campaigns.parquet".to_owned(), String::new()], outcomes)
    }

    #[test]
    fn law_a_page_of_many_campaigns_has_its_rows_and_forests() {
        let s = summary();
        let page = many_page(&s);
        for text in [
            "3 campaigns; 2 with a result: 2 effect; 1 failed. Effects named: 2 swirl.",
            "no &lt;run&gt;",
            "c/&lt;x&gt;/campaign.toml",
            "p = 2e-12",
            "<a href=\"results/a%20b/%22x%22/report.html\">a/campaign.toml</a>",
        ] {
            assert!(page.contains(text), "{text} in {page}");
        }
        assert!(!page.contains("<run>"));
        let mut plots = Plots::default();
        many_body(&s, &mut plots);
        let Plot::Ranges { ranges, marks, .. } = &plots.all[0] else { panic!("a forest") };
        let names: Vec<&str> = ranges.iter().map(|r| r.name.as_str()).collect();
        assert_eq!((names, marks.len(), plots.all.len()), (vec!["a", "b.toml", "mean of 2"], 1, 1));
        assert!((ranges[0].ends[1] - 6.0 - 0.1 * NORMAL_95).abs() < 1e-12 && (ranges[2].dot - 6.5).abs() < 1e-12);
    }
}
