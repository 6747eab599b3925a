//! study: what all draws of a study say. In: columns of results. Out: bias, scatter, coverage, quantiles, rates, with intervals.

use super::draw::PreparedStudy;
use super::recovery::{ClosingSummary, RecoveryLine, VariedLine, closings, recovery, varied};
use super::select::{Read, quantiles};
use super::stop::{Moments, clopper_pearson};
use serde::{Deserialize, Serialize};
use statrs::distribution::{ChiSquared, ContinuousCDF};
use std::collections::BTreeMap;
use windfall_model::study::{Cell, CellKind, Column};

/// Probabilities of the quantiles.
const QUANTILES: [f64; 7] = [0.025, 0.05, 0.25, 0.5, 0.75, 0.95, 0.975];

/// A rate with its 95 % interval (Clopper and Pearson 1934).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Rate {
    /// Column, or parameter.
    pub name: String,
    /// How often.
    pub count: u64,
    /// Out of how many.
    pub of: u64,
    /// `count/of`.
    pub rate: Option<f64>,
    /// Interval.
    pub ci95: Option<[f64; 2]>,
}

impl Rate {
    fn new(name: &str, count: u64, of: u64) -> Self {
        let some = of > 0;
        Self {
            name: name.to_owned(),
            count,
            of,
            rate: some.then(|| count as f64 / of as f64),
            ci95: some.then(|| clopper_pearson(count, of)),
        }
    }
}

/// A quantile of a column (linear between order statistics; Hyndman and Fan 1996, type 7).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Quantile {
    /// Probability.
    pub p: f64,
    /// Value.
    pub value: f64,
}

/// A column of numbers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct NumberLine {
    /// Column.
    pub name: String,
    /// Draws that have a number there.
    pub n: u64,
    /// Mean.
    pub mean: f64,
    /// Its 95 % interval (Student).
    pub mean_ci95: Option<[f64; 2]>,
    /// Standard deviation.
    pub std: Option<f64>,
    /// Its 95 % interval (χ², for normal numbers).
    pub std_ci95: Option<[f64; 2]>,
    /// Smallest.
    pub min: f64,
    /// Largest.
    pub max: f64,
    /// Quantiles.
    pub quantiles: Vec<Quantile>,
}

/// How well one parameter is found.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ParameterSummary {
    /// Method; `close` for an effect.
    pub method: String,
    /// Coefficient; family of an effect.
    pub coefficient: String,
    /// Parameter.
    pub name: String,
    /// Draws with an estimate.
    pub n: u64,
    /// Mean of estimate − truth.
    pub bias: f64,
    /// Its 95 % interval.
    pub bias_ci95: Option<[f64; 2]>,
    /// Standard deviation of estimate − truth.
    pub scatter: Option<f64>,
    /// Its 95 % interval.
    pub scatter_ci95: Option<[f64; 2]>,
    /// Root of the mean squared error.
    pub rms_error: f64,
    /// Mean of the stated standard errors.
    pub mean_std_error: Option<f64>,
    /// Scatter over mean stated standard error: one where stated errors are true.
    pub scatter_over_std_error: Option<f64>,
    /// How often the stated 95 % interval covers the truth.
    pub coverage: Rate,
}

/// How often a word stands in a column.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct WordLine {
    /// Column.
    pub name: String,
    /// Words by how often, then by alphabet.
    pub counts: Vec<Rate>,
}

/// Draws that failed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FailureKind {
    /// Rate of any failure.
    pub any: Rate,
    /// Each message.
    pub messages: Vec<Count>,
}

/// A message and how often.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Count {
    /// Message; numbers in it as of its first draw.
    pub message: String,
    /// How often.
    pub count: u64,
}

/// `summary.json`, without what belongs to the file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    /// Study.
    pub study: String,
    /// Seed.
    pub seed: u64,
    /// Draws in the results.
    pub draws: u64,
    /// Draws ordered.
    pub draws_ordered: u64,
    /// The stopping rule ended the study before all draws.
    pub stopped_early: bool,
    /// Draws that failed.
    pub failures: FailureKind,
    /// Parameters, by method.
    pub parameters: Vec<ParameterSummary>,
    /// Flags: detection rates, coverages, verdicts.
    pub rates: Vec<Rate>,
    /// Words.
    pub words: Vec<WordLine>,
    /// Numbers.
    pub numbers: Vec<NumberLine>,
    /// Estimates beside what was put in, by method.
    #[serde(default)]
    pub recovery: Vec<RecoveryLine>,
    /// Varied quantities in the rows of these.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub varied: Vec<VariedLine>,
    /// What closings name where something acts.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub closings: Option<ClosingSummary>,
}

/// Most failure messages that are listed.
const LISTED: usize = 20;

/// Summarises a study of so many draws; `each` shows every cell of a column of the results, as often as asked. Nothing is held that
/// grows with the number of draws.
///
/// # Errors
/// Those of `each`.
pub fn summarise<E>(
    prepared: &PreparedStudy,
    draws: u64,
    each: impl Fn(&Column, &mut dyn FnMut(Cell)) -> Result<(), E>,
) -> Result<Summary, E> {
    let study = prepared.study();
    let (mut rates, mut words, mut numbers) = (Vec::new(), Vec::new(), Vec::new());
    let mut failures = FailureKind { any: Rate::new("failure", 0, draws), messages: Vec::new() };
    for column in prepared.columns() {
        let read: Read<'_, E> = &|see| each(column, see);
        match column.kind {
            CellKind::Number => numbers.extend(number_line(&column.name, read)?),
            CellKind::Flag => rates.push(rate(&column.name, read)?),
            CellKind::Word if column.name == "failure" => failures = failed(&counted(read)?, draws),
            CellKind::Word => words.push(word_line(&column.name, &counted(read)?, draws)),
        }
    }
    let mut recovered = Vec::new();
    for column in prepared.columns() {
        recovered.extend(recovery(column, prepared.columns(), &each)?);
    }
    let varied = varied(prepared.columns(), &recovered, &each)?;
    let closings = closings(prepared.columns(), &each)?;
    let parameters = prepared.columns().iter().filter_map(|c| parameter(c, &numbers, &rates)).collect();
    Ok(Summary {
        study: study.name.clone(),
        seed: study.seed,
        draws,
        draws_ordered: study.draws,
        stopped_early: draws < study.draws,
        failures,
        parameters,
        rates,
        words,
        numbers,
        recovery: recovered,
        varied,
        closings,
    })
}

fn number_line<E>(name: &str, read: Read<'_, E>) -> Result<Option<NumberLine>, E> {
    let mut m = Moments::default();
    read(&mut |cell| {
        if let Some(x) = cell.number() {
            m.push(x);
        }
    })?;
    if m.n == 0 {
        return Ok(None);
    }
    let ends = quantiles(&[[0.0, 1.0].as_slice(), &QUANTILES].concat(), m.n, read)?;
    let middle = QUANTILES.into_iter().zip(ends[2..].iter().copied());
    Ok(Some(NumberLine {
        name: name.to_owned(),
        n: m.n,
        mean: m.mean,
        mean_ci95: m.mean_ci95(),
        std: m.std(),
        std_ci95: std_ci95(&m),
        min: ends[0],
        max: ends[1],
        quantiles: middle.map(|(p, value)| Quantile { p, value }).collect(),
    }))
}

fn std_ci95(m: &Moments) -> Option<[f64; 2]> {
    let chi = ChiSquared::new(m.n.checked_sub(1)? as f64).ok()?;
    Some([0.975, 0.025].map(|p| (m.m2 / chi.inverse_cdf(p)).sqrt())).filter(|[a, b]| a.is_finite() && b.is_finite())
}

fn rate<E>(name: &str, read: Read<'_, E>) -> Result<Rate, E> {
    let (mut count, mut of) = (0, 0);
    read(&mut |cell| {
        if let Cell::Flag(Some(x)) = cell {
            count += u64::from(x);
            of += 1;
        }
    })?;
    Ok(Rate::new(name, count, of))
}

/// Words by how often, then by alphabet.
fn counted<E>(read: Read<'_, E>) -> Result<Vec<(String, u64)>, E> {
    let mut counts: BTreeMap<String, u64> = BTreeMap::new();
    read(&mut |cell| {
        if let Cell::Word(w) = cell {
            *counts.entry(w).or_default() += 1;
        }
    })?;
    let mut all: Vec<_> = counts.into_iter().collect();
    all.sort_by_key(|(_, n)| std::cmp::Reverse(*n));
    Ok(all)
}

fn word_line(name: &str, counts: &[(String, u64)], of: u64) -> WordLine {
    WordLine { name: name.to_owned(), counts: counts.iter().map(|(w, n)| Rate::new(w, *n, of)).collect() }
}

fn failed(counts: &[(String, u64)], draws: u64) -> FailureKind {
    let all = || counts.iter().filter(|(w, _)| !w.is_empty());
    let any = Rate::new("failure", all().map(|a| a.1).sum(), draws);
    let messages = all().take(LISTED).map(|(m, n)| Count { message: m.clone(), count: *n }).collect();
    FailureKind { any, messages }
}

/// The summary of the parameter whose column of errors this is.
fn parameter(column: &Column, numbers: &[NumberLine], rates: &[Rate]) -> Option<ParameterSummary> {
    let stem = column.name.strip_suffix(".error")?;
    let line = |what: &str| numbers.iter().find(|n| n.name.strip_prefix(stem).is_some_and(|rest| rest == what));
    let error = line(".error")?;
    let stated = line(".std_error").map(|n| n.mean);
    let mut parts = stem.splitn(3, '.');
    let mut part = || parts.next().unwrap_or_default().to_owned();
    let (method, coefficient, name) = (part(), part(), part());
    let coverage = rates.iter().find(|r| r.name.strip_prefix(stem).is_some_and(|rest| rest == ".covered"))?;
    let n = error.n as f64;
    let spread = error.std.map_or(0.0, |s| s * s * (n - 1.0) / n);
    Some(ParameterSummary {
        n: error.n,
        bias: error.mean,
        bias_ci95: error.mean_ci95,
        scatter: error.std,
        scatter_ci95: error.std_ci95,
        rms_error: (error.mean * error.mean + spread).sqrt(),
        mean_std_error: stated,
        scatter_over_std_error: error.std.zip(stated).map(|(a, b)| a / b).filter(|x| x.is_finite()),
        coverage: Rate { name: format!("{coefficient} {name}"), ..coverage.clone() },
        method,
        coefficient,
        name,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Errors −1, 0, 1, 2, stated 0.4 in the mean: bias ½, scatter √(5/3), rms √1.5; χ²(3) quantiles 9.348404 and 0.215795.
    #[test]
    fn exact_summary_of_four_errors() {
        let cells: Vec<Cell> = [-1.0, 0.0, 1.0, 2.0].iter().map(|x| Cell::Number(Some(*x))).collect();
        let of = |cells: Vec<Cell>| {
            move |see: &mut dyn FnMut(Cell)| {
                cells.iter().cloned().for_each(see);
                Ok::<(), ()>(())
            }
        };
        let stated: Vec<Cell> = [0.5, 1.5].iter().map(|x| Cell::Number(Some(0.4 * x))).collect();
        let numbers = [("m.C.p.error", cells), ("m.C.p.std_error", stated)];
        let numbers = numbers.map(|(name, cells)| number_line(name, &of(cells)).expect("reads").expect("numbers"));
        let flags = [Cell::Flag(Some(true)), Cell::Flag(Some(false)), Cell::Flag(None), Cell::Flag(Some(true))];
        let rates = vec![rate("m.C.p.covered", &of(flags.to_vec())).expect("reads")];
        let column = Column { name: "m.C.p.error".to_owned(), kind: CellKind::Number };
        let p = parameter(&column, &numbers, &rates).expect("a parameter");
        assert!((p.bias - 0.5).abs() < 1e-15 && (p.rms_error - 1.5_f64.sqrt()).abs() < 1e-15);
        assert!((p.scatter_over_std_error.expect("stated 0.4") - (5.0_f64 / 3.0).sqrt() / 0.4).abs() < 1e-14);
        let [a, b] = p.scatter_ci95.expect("four numbers");
        assert!((a - (5.0_f64 / 9.348_404).sqrt()).abs() < 1e-6 && (b - (5.0_f64 / 0.215_795).sqrt()).abs() < 1e-4, "{a} {b}");
        assert_eq!((p.coverage.count, p.coverage.of), (2, 3));
        assert_eq!((p.method.as_str(), p.coefficient.as_str(), p.name.as_str()), ("m", "C", "p"));
    }
}
