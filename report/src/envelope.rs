//! report: what runs and data sets reached (thesis Table 5.1). In: their envelopes. Out: lines for the terminal, a table of the page.

use crate::html::{Cell, table};
use windfall_discover::{Envelope, RunEnvelope, SetEnvelope, TestTable};

/// Heads of the columns; angle and rates are the largest.
const HEADS: [&str; 9] =
    ["run or data set", "kind, use", "time s", "α_T deg", "|p| deg/s", "|q| deg/s", "|r| deg/s", "V_∞ m/s", "Reynolds"];

/// The range in which parameters are valid, in a line: that of the runs which they were identified on.
///
/// ```
/// use windfall_discover::Envelope;
/// let envelope = Envelope {
///     duration_s: 73.3, max_alpha_t_deg: 38.8, max_p_deg_s: 12.0, max_q_deg_s: 46.9, max_r_deg_s: 98.3, speed_m_s: [6.5, 8.25], reynolds_number: None,
/// };
/// let line = windfall_report::validity(&envelope);
/// assert!(line.starts_with("valid for α_T to 38.8 deg, |p| to 12.0, |q| to 46.9 and |r| to 98.3 deg/s, V_∞ from 6.50 to 8.25 m/s:"));
/// ```
#[must_use]
pub fn validity(e: &Envelope) -> String {
    let reynolds = e.reynolds_number.map_or_else(String::new, |r| format!(", Reynolds number about {}", power(r)));
    format!(
        "valid for α_T to {:.1} deg, |p| to {:.1}, |q| to {:.1} and |r| to {:.1} deg/s, V_∞ from {:.2} to {:.2} m/s{reynolds}: what these \
         runs reached; beyond it the model is extrapolated",
        e.max_alpha_t_deg, e.max_p_deg_s, e.max_q_deg_s, e.max_r_deg_s, e.speed_m_s[0], e.speed_m_s[1]
    )
}

/// Runs and data sets as lines of one table; none where there are no runs.
#[must_use]
pub fn test_table(all: &TestTable) -> Vec<String> {
    if all.runs.is_empty() {
        return Vec::new();
    }
    let head = std::iter::once(HEADS.map(str::to_owned));
    let rows: Vec<[String; 9]> = head.chain(all.runs.iter().map(run)).chain(all.data_sets.iter().map(set)).collect();
    let width = |k: usize| rows.iter().map(|r| r[k].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..9).map(width).collect();
    let cell = |(k, text): (usize, &String)| {
        let w = widths[k];
        if k < 2 { format!("{text:<w$}") } else { format!("{text:>w$}") }
    };
    let line = |r: &[String; 9]| r.iter().enumerate().map(cell).collect::<Vec<_>>().join("  ");
    let caption = "what the runs reached: largest angle of attack and rates, airspeeds, mean Reynolds number".to_owned();
    std::iter::once(caption).chain(rows.iter().map(line)).collect()
}

/// The same for the page; nothing where there are no runs.
pub(crate) fn envelopes(all: &TestTable) -> String {
    let cells = |row: [String; 9]| {
        let place = |(k, t): (usize, String)| if k < 2 { Cell::Text(t) } else { Cell::Number(t) };
        row.into_iter().enumerate().map(place).collect::<Vec<_>>()
    };
    let rows: Vec<Vec<Cell>> = all.runs.iter().map(run).chain(all.data_sets.iter().map(set)).map(cells).collect();
    if rows.is_empty() { String::new() } else { table(&HEADS, &rows) }
}

fn run(r: &RunEnvelope) -> [String; 9] {
    row(r.name.clone(), format!("{}, {}", r.kind, r.used), &r.envelope)
}

fn set(s: &SetEnvelope) -> [String; 9] {
    let runs = if s.runs.len() == 1 { "1 run".to_owned() } else { format!("{} runs", s.runs.len()) };
    row(format!("all of {}", s.name), runs, &s.envelope)
}

fn row(name: String, what: String, e: &Envelope) -> [String; 9] {
    let one = |x: f64| format!("{x:.1}");
    let [low, high] = e.speed_m_s;
    [
        name,
        what,
        one(e.duration_s),
        one(e.max_alpha_t_deg),
        one(e.max_p_deg_s),
        one(e.max_q_deg_s),
        one(e.max_r_deg_s),
        format!("{low:.2} to {high:.2}"),
        e.reynolds_number.map_or_else(|| "–".to_owned(), power),
    ]
}

/// Three digits, as `1.07e5`.
fn power(x: f64) -> String {
    format!("{x:.2e}")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Thesis Table 5.1 as it would be printed of the thesis' own runs, with a speed and no gas that is known.
    fn thesis() -> TestTable {
        let envelope = |duration_s, max_alpha_t_deg, max_q_deg_s, max_r_deg_s| Envelope {
            duration_s,
            max_alpha_t_deg,
            max_p_deg_s: 9.0,
            max_q_deg_s,
            max_r_deg_s,
            speed_m_s: [7.0, 8.0],
            reynolds_number: None,
        };
        let run = |name: &str, kind: &str, envelope| RunEnvelope {
            name: name.to_owned(),
            kind: kind.to_owned(),
            used: "identify".to_owned(),
            envelope,
        };
        let all = SetEnvelope {
            name: "combined".to_owned(),
            runs: vec!["a".to_owned(), "b".to_owned()],
            envelope: envelope(73.3, 38.8, 46.9, 98.3),
        };
        TestTable {
            runs: vec![
                run("a", "unperturbed", envelope(55.0, 8.6, 26.8, 54.4)),
                run("b", "perturbed", envelope(18.3, 38.8, 46.9, 98.3)),
            ],
            data_sets: vec![all],
        }
    }

    /// Columns stand under each other; every number of the thesis' table is there in its own digits.
    #[test]
    fn pub_table_5_1_is_laid_out() {
        let lines = test_table(&thesis());
        assert_eq!(lines.len(), 5);
        for (line, words) in
            lines.iter().skip(2).zip(["55.0 8.6 9.0 26.8 54.4", "18.3 38.8 9.0 46.9 98.3", "73.3 38.8 9.0 46.9 98.3"])
        {
            let numbers: Vec<&str> = line.split_whitespace().collect();
            assert!(numbers.join(" ").contains(words), "{line}");
        }
        let end = |line: &String| line.chars().count();
        assert!(lines[1..].iter().all(|l| end(l) == end(&lines[1])), "{lines:#?}");
        assert!(lines[4].starts_with("all of combined  2 runs"), "{}", lines[4]);
        let page = envelopes(&thesis());
        assert!(page.contains("<td class=\"n\">98.3</td>") && page.matches("<tr>").count() == 4, "{page}");
        assert_eq!((test_table(&TestTable::default()), envelopes(&TestTable::default())), (Vec::new(), String::new()));
    }
}
