//! cli: `windfall study`. In: a study file. Out: `runs.parquet` and `summary.json`; parts of them that survive a kill.

use crate::args::StudyArgs;
use crate::session::{Failure, Session};
use indicatif::ProgressBar;
use std::fmt::Write as _;
use std::sync::Mutex;
use windfall::files::Store;
use windfall::model::study::{CellKind, Row};
use windfall::results::{Moments, Summary};
use windfall::{Drawing, SUMMARY, Shard, Study};

pub(crate) fn run(args: &StudyArgs, session: &mut Session<'_>) -> Result<bool, Failure> {
    let drawing = Drawing::read(&args.study)?;
    session.warn_all(drawing.warnings());
    let request = Study { force: session.common.force, ..args.request.clone() };
    let (folder, _temporary) = session.resumable(request.resume || request.shard.is_some())?;
    let store = drawing.open(&folder, &request)?;
    crate::interrupt::listen();
    let live = Live::new(&drawing, &store, session)?;
    let drawn = session.pool()?.install(|| {
        drawing.draw(&store, |row| {
            live.see(row);
            !crate::interrupt::asked()
        })
    });
    live.bar.finish_and_clear();
    drawn?;
    if let Some(shard) = request.shard.filter(|s| *s != Shard::ALL) {
        let missing = store.missing()?.len();
        session.say(&format!(
            "shard {shard} done; {missing} of {} parts missing in {}{}",
            store.parts(),
            folder.display(),
            if missing == 0 { "; join them with --resume" } else { "" }
        ));
        return Ok(true);
    }
    let summary = drawing.finish(&store, &folder)?;
    if summary.failures.any.count > 0 {
        session.warn(&failures(&summary));
    }
    session.show(&summary, || words(&summary))?;
    if session.common.out.is_some() {
        session.say(&format!("written to {}: runs.parquet, {SUMMARY}", folder.display()));
    }
    if summary.failures.any.count == summary.draws {
        return Err(Failure::numerical(anyhow::anyhow!("every draw failed; see failures in {SUMMARY}")));
    }
    Ok(true)
}

/// What a terminal shows while draws are made: how many, time left, the asked-for quantity so far.
struct Live {
    bar: ProgressBar,
    asked: Option<(String, usize, CellKind)>,
    seen: Mutex<Moments>,
}

impl Live {
    fn new(drawing: &Drawing, store: &Store, session: &Session<'_>) -> Result<Self, Failure> {
        let wanted: u64 = store.wanted()?.iter().map(|r| r.end - r.start).sum();
        let columns = drawing.prepared().columns();
        let stop = drawing.prepared().study().stop.as_ref().map(|s| s.column.as_str());
        let first = columns.iter().find(|c| c.name.ends_with(".error")).map(|c| c.name.as_str());
        let asked = stop.or(first).and_then(|name| {
            let place = drawing.prepared().place(name)?;
            Some((name.to_owned(), place, columns[place].kind))
        });
        let bar = session.telling_bar("drawing", usize::try_from(wanted).unwrap_or(usize::MAX));
        Ok(Self { bar, asked, seen: Mutex::default() })
    }
    fn see(&self, row: &Row) {
        self.bar.inc(1);
        let Some((name, place, kind)) = self.asked.as_ref().filter(|_| !self.bar.is_hidden()) else { return };
        let Some(x) = row.cells[*place].number() else { return };
        let mut seen = self.seen.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        seen.push(x);
        if let Some([a, b]) = seen.ci95(*kind).filter(|_| seen.n.is_multiple_of(16)) {
            self.bar.set_message(format!("{name} {:.4e} ± {:.1e}", seen.mean, 0.5 * (b - a)));
        }
    }
}

fn failures(s: &Summary) -> String {
    let most = s.failures.messages.first().map_or("", |m| m.message.as_str());
    format!("{} of {} draws failed, most often: {most}; see failures in {SUMMARY}", s.failures.any.count, s.draws)
}

/// What is printed of it: the result on a screenful.
#[must_use]
pub fn words(s: &Summary) -> String {
    let early = if s.stopped_early { format!(", ended early of {}", s.draws_ordered) } else { String::new() };
    let mut text = format!("{}: {} draws{early}, seed {}\n", s.study, s.draws, s.seed);
    if !s.parameters.is_empty() {
        let _ = writeln!(
            text,
            "\n{:<16}{:<24}{:>11}{:>11}{:>11}{:>9}{:>24}",
            "method", "parameter", "bias", "scatter", "stated", "ratio", "coverage (95 % CI)"
        );
    }
    for p in &s.parameters {
        let number = |x: Option<f64>| x.map_or_else(|| "-".to_owned(), |x| format!("{x:.3e}"));
        let name = format!("{} {}", p.coefficient, p.name);
        let ratio = p.scatter_over_std_error.map_or_else(|| "-".to_owned(), |x| format!("{x:.3}"));
        let (bias, scatter, stated) = (number(Some(p.bias)), number(p.scatter), number(p.mean_std_error));
        let coverage = rate(p.coverage.rate, p.coverage.ci95);
        let _ = writeln!(text, "{:<16}{name:<24}{bias:>11}{scatter:>11}{stated:>11}{ratio:>9}{coverage:>24}", p.method);
    }
    let verdicts: Vec<_> = s.rates.iter().filter(|r| r.name.starts_with("close.") && r.name.matches('.').count() == 1).collect();
    if !verdicts.is_empty() {
        text.push('\n');
    }
    for r in verdicts {
        let _ = writeln!(text, "{:<28}{:>8} of {:<8}{:>24}", r.name, r.count, r.of, rate(r.rate, r.ci95));
    }
    text
}

fn rate(rate: Option<f64>, ci95: Option<[f64; 2]>) -> String {
    match (rate, ci95) {
        (Some(r), Some([a, b])) => format!("{r:.3} [{a:.3}, {b:.3}]"),
        _ => "-".to_owned(),
    }
}
