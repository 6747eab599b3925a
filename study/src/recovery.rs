//! study: estimates of a study beside what they are of. In: columns of results. Out: truth and estimate of some draws, how often stated
//! intervals of every size hold the truth, and what closings name where something acts.

use super::dependence::{DependenceLine, dependence};
use super::reliability::ReliabilityPoint;
use super::select::Read;
use serde::{Deserialize, Serialize};
use statrs::distribution::{ContinuousCDF, Normal};
use std::collections::BTreeMap;
use windfall_model::study::{Cell, CellKind, Column};

/// Shows every cell of a column, each time it is asked.
type ReadColumn<'r, E> = &'r dyn Fn(&Column, &mut dyn FnMut(Cell)) -> Result<(), E>;

/// Draws of a parameter that a summary keeps one by one.
const KEPT: usize = 60;
/// Draws from which reliability is judged: 1000 tell a share of 95 % to 0.7 %, and no more is held.
const JUDGED: usize = 1000;
/// Stated probabilities at which intervals are judged.
const STATED: [f64; 12] = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95, 0.98, 0.99];
/// Ends of the classes of a closing's stated probability.
const CLASSES: [f64; 6] = [0.0, 0.5, 0.7, 0.9, 0.99, 1.0];

/// One draw of a parameter.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct RecoveredDraw {
    /// What was put in.
    pub truth: f64,
    /// What was found.
    pub estimate: f64,
    /// Stated standard error.
    pub std_error: f64,
    /// Number of its row in the results.
    #[serde(default)]
    pub row: u64,
}

/// A varied quantity of the first draws.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct VariedLine {
    /// Key that is varied.
    pub name: String,
    /// Its value in each row of the results, from the first.
    pub values: Vec<f64>,
}

/// Every varied quantity in the rows of which estimates are kept.
pub(super) fn varied<E>(columns: &[Column], lines: &[RecoveryLine], each: ReadColumn<'_, E>) -> Result<Vec<VariedLine>, E> {
    let last = lines.iter().flat_map(|l| &l.draws).map(|d| d.row).max();
    let rows = usize::try_from(last.map_or(0, |l| l + 1)).unwrap_or(JUDGED).min(JUDGED);
    let mut all = Vec::new();
    for column in columns.iter().filter(|c| c.name.starts_with("vary.") && rows > 0) {
        let values = first_numbers(&|see| each(column, see))?.into_iter().take(rows).map(|x| x.unwrap_or(f64::NAN));
        let values: Vec<f64> = values.collect();
        if values.iter().all(|x| x.is_finite()) {
            all.push(VariedLine { name: column.name.trim_start_matches("vary.").to_owned(), values });
        }
    }
    Ok(all)
}

/// A parameter's draws.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RecoveryLine {
    /// Method; `close` for an effect.
    pub method: String,
    /// Coefficient; family of an effect.
    pub coefficient: String,
    /// Parameter.
    pub name: String,
    /// The first draws that have an estimate.
    pub draws: Vec<RecoveredDraw>,
    /// Intervals of normal errors at several stated probabilities.
    pub reliability: Vec<ReliabilityPoint>,
}

/// What was named in draws in which the same acts.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ConfusionLine {
    /// Families that act, joined by `+`; `none`.
    pub truth: String,
    /// What was named, `none`, or `unexplained`, and how often.
    pub found: BTreeMap<String, u64>,
}

/// Closings of a study.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ClosingSummary {
    /// A line for each set of families that acts.
    pub confusion: Vec<ConfusionLine>,
    /// Stated probability of the named set against how often it is the one that acts.
    pub reliability: Vec<ReliabilityPoint>,
    /// What naming exactly the set that acts hangs on: a line for every varied quantity, of the first 1000 draws, the strongest first.
    #[serde(default)]
    pub dependence: Vec<DependenceLine>,
}

/// The recovery of the parameter whose column of errors this is.
pub(super) fn recovery<E>(column: &Column, columns: &[Column], each: ReadColumn<'_, E>) -> Result<Option<RecoveryLine>, E> {
    let Some(stem) = column.name.strip_suffix(".error") else { return Ok(None) };
    let Some(stated) = columns.iter().find(|c| c.name.strip_prefix(stem).is_some_and(|rest| rest == ".std_error")) else {
        return Ok(None);
    };
    let Some(estimate) = columns.iter().find(|c| c.name.strip_prefix(stem).is_some_and(|rest| rest == ".estimate")) else {
        return Ok(None);
    };
    let first = |c: &Column| first_numbers(&|see| each(c, see));
    let (estimates, errors, stated) = (first(estimate)?, first(column)?, first(stated)?);
    let whole: Vec<RecoveredDraw> = estimates
        .into_iter()
        .zip(errors)
        .zip(stated)
        .zip(0_u64..)
        .filter_map(|(((estimate, error), std_error), row)| {
            let std_error = std_error.filter(|s| *s > 0.0)?;
            Some(RecoveredDraw { truth: estimate? - error?, estimate: estimate?, std_error, row })
        })
        .collect();
    if whole.is_empty() {
        return Ok(None);
    }
    let mut parts = stem.splitn(3, '.').map(str::to_owned);
    let mut part = || parts.next().unwrap_or_default();
    let reliability = reliability(&whole);
    Ok(Some(RecoveryLine {
        method: part(),
        coefficient: part(),
        name: part(),
        draws: whole.into_iter().take(KEPT).collect(),
        reliability,
    }))
}

/// The cells of the first draws.
fn first_numbers<E>(read: Read<'_, E>) -> Result<Vec<Option<f64>>, E> {
    let mut all = Vec::new();
    read(&mut |cell| {
        if all.len() < JUDGED {
            all.push(cell.number());
        }
    })?;
    Ok(all)
}

fn reliability(draws: &[RecoveredDraw]) -> Vec<ReliabilityPoint> {
    let sizes: Vec<f64> = draws.iter().map(|d| ((d.estimate - d.truth) / d.std_error).abs()).collect();
    let one = |stated: f64| {
        let reach = Normal::standard().inverse_cdf(0.5 + 0.5 * stated);
        ReliabilityPoint::new(stated, sizes.iter().filter(|z| **z <= reach).count() as u64, sizes.len() as u64)
    };
    STATED.into_iter().map(one).collect()
}

/// What closings name, where the study has some and kept what acts.
pub(super) fn closings<E>(columns: &[Column], each: ReadColumn<'_, E>) -> Result<Option<ClosingSummary>, E> {
    let of = |name: &str| columns.iter().find(|c| c.name == name);
    let (Some(truth), Some(verdict), Some(found), Some(probability)) =
        (of("close.truth"), of("close.verdict"), of("close.families"), of("close.probability"))
    else {
        return Ok(None);
    };
    let words = |c: &Column| -> Result<Vec<String>, E> {
        let mut all = Vec::new();
        each(c, &mut |cell| all.push(if let Cell::Word(w) = cell { w } else { String::new() }))?;
        Ok(all)
    };
    let (truths, verdicts, named) = (words(truth)?, words(verdict)?, words(found)?);
    let mut stated = Vec::new();
    each(probability, &mut |cell| stated.push(cell.number()))?;
    let mut confusion: BTreeMap<String, BTreeMap<String, u64>> = BTreeMap::new();
    let mut classes = [(0.0, 0_u64, 0_u64); CLASSES.len() - 1];
    let mut right = Vec::new();
    for (((truth, verdict), named), stated) in truths.iter().zip(&verdicts).zip(&named).zip(stated) {
        // A draw that failed has no verdict.
        if verdict.is_empty() {
            right.push(None);
            continue;
        }
        let acts = set_of(truth);
        let found = if named.is_empty() && verdict == "unexplained" { verdict.clone() } else { set_of(named) };
        right.push(Some(found == acts));
        if let Some(p) = stated {
            let class = CLASSES[1..].iter().position(|end| p < *end).unwrap_or(classes.len() - 1);
            let c = &mut classes[class];
            *c = (c.0 + p, c.1 + u64::from(found == acts), c.2 + 1);
        }
        *confusion.entry(acts).or_default().entry(found).or_default() += 1;
    }
    let mut hangs = Vec::new();
    for column in columns.iter().filter(|c| c.name.starts_with("vary.")) {
        let values = first_numbers(&|see| each(column, see))?;
        hangs.extend(dependence(column.name.trim_start_matches("vary."), &values, &right));
    }
    let strength = |l: &DependenceLine| l.score.map_or(0.0, f64::abs);
    hangs.sort_by(|a, b| strength(b).total_cmp(&strength(a)));
    let filled = classes.iter().filter(|c| c.2 > 0);
    Ok(Some(ClosingSummary {
        confusion: confusion.into_iter().map(|(truth, found)| ConfusionLine { truth, found }).collect(),
        reliability: filled.map(|(sum, count, of)| ReliabilityPoint::new(sum / *of as f64, *count, *of)).collect(),
        dependence: hangs,
    }))
}

/// Families in alphabetical order.
fn set_of(joined: &str) -> String {
    let mut all: Vec<&str> = joined.split('+').filter(|f| !f.is_empty()).collect();
    all.sort_unstable();
    if all.is_empty() { "none".to_owned() } else { all.join("+") }
}

/// A column of words or numbers that closings have beside their verdict.
pub(super) const CLOSING_COLUMNS: [(&str, CellKind); 2] =
    [("close.truth", CellKind::Word), ("close.probability", CellKind::Number)];

#[cfg(test)]
mod tests {
    use super::*;
    use std::convert::Infallible;

    fn column(name: &str, kind: CellKind) -> Column {
        Column { name: name.to_owned(), kind }
    }

    /// Errors of 0.5, 1.5 and 2.5 stated errors: 38.3 % intervals hold the first, 86.6 % the second, 98.8 % the third (tables of the normal
    /// distribution); a draw without an estimate is none.
    #[test]
    fn exact_reliability_of_three_errors() {
        let names = ["m.C.p.estimate", "m.C.p.error", "m.C.p.std_error"];
        let columns = names.map(|n| column(n, CellKind::Number));
        let cells = |c: &Column| match c.name.rsplit('.').next() {
            Some("estimate") => [Some(7.5), None, Some(10.0), Some(4.5)],
            Some("error") => [Some(0.5), None, Some(3.0), Some(-2.5)],
            _ => [Some(1.0), None, Some(2.0), Some(1.0)],
        };
        let each = |c: &Column, see: &mut dyn FnMut(Cell)| {
            cells(c).into_iter().for_each(|x| see(Cell::Number(x)));
            Ok::<(), Infallible>(())
        };
        let line = recovery(&columns[1], &columns, &each).expect("reads").expect("a parameter");
        assert_eq!((line.method.as_str(), line.coefficient.as_str(), line.name.as_str()), ("m", "C", "p"));
        assert!(line.draws.len() == 3 && line.draws.iter().all(|d| (d.truth - 7.0).abs() < 1e-12));
        let counts: Vec<u64> = line.reliability.iter().map(|r| r.count).collect();
        //              0.1 0.2 0.3 0.4 0.5 0.6 0.7 0.8 0.9 .95 .98 .99
        assert_eq!(counts, [0, 0, 0, 1, 1, 1, 1, 1, 2, 2, 2, 3]);
        assert!(recovery(&columns[0], &columns, &each).expect("reads").is_none());
    }

    #[test]
    fn exact_confusion_and_stated_probability() {
        let rows = [
            ("", "consistent", "", Some(0.8)),
            ("swirl", "effect", "swirl", Some(0.95)),
            ("swirl+mass", "effect", "mass+swirl", Some(0.97)),
            ("swirl", "effect", "magnus", Some(0.6)),
            ("swirl", "effect", "swirl", Some(1.0)),
            ("swirl", "unexplained", "", None),
            ("swirl", "", "", None),
        ];
        let columns = ["close.truth", "close.verdict", "close.families"]
            .map(|n| column(n, CellKind::Word))
            .into_iter()
            .chain([column("close.probability", CellKind::Number)]);
        let columns: Vec<Column> = columns.collect();
        let each = |c: &Column, see: &mut dyn FnMut(Cell)| {
            for (truth, verdict, found, p) in rows {
                let word = |w: &str| Cell::Word(w.to_owned());
                see(match c.name.as_str() {
                    "close.truth" => word(truth),
                    "close.verdict" => word(verdict),
                    "close.families" => word(found),
                    _ => Cell::Number(p),
                });
            }
            Ok::<(), Infallible>(())
        };
        let c = closings(&columns, &each).expect("reads").expect("closings");
        let lines: Vec<(String, Vec<(String, u64)>)> =
            c.confusion.into_iter().map(|l| (l.truth, l.found.into_iter().collect())).collect();
        let line = |truth: &str, found: &[(&str, u64)]| {
            (truth.to_owned(), found.iter().map(|(f, n)| ((*f).to_owned(), *n)).collect::<Vec<_>>())
        };
        let expected = [
            line("mass+swirl", &[("mass+swirl", 1)]),
            line("none", &[("none", 1)]),
            line("swirl", &[("magnus", 1), ("swirl", 2), ("unexplained", 1)]),
        ];
        assert_eq!(lines, expected);
        let points: Vec<(u64, u64)> = c.reliability.iter().map(|r| (r.count, r.of)).collect();
        assert_eq!(points, [(0, 1), (1, 1), (2, 2), (1, 1)]);
        assert!((c.reliability[2].stated - 0.96).abs() < 1e-12);
        assert!(closings(&columns[1..], &each).expect("reads").is_none());
    }
}
