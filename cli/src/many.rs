//! cli: `windfall many close` and `windfall many identify`. In: folders, campaign files. Out: a result of each campaign, `campaigns.parquet`,
//! `many.json`, `report.html`.

use crate::args::{ManyArgs, ManyVerb};
use crate::session::{Failure, Session};
use std::fmt::Write as _;
use windfall::report::{interval, number, p_value, with_interval};
use windfall::results::{ManySummary, Status, Tally};
use windfall::{Campaigns, Each, Many};

pub(crate) fn run(args: &ManyArgs, session: &mut Session<'_>) -> Result<bool, Failure> {
    let (paths, each, request) = match &args.verb {
        ManyVerb::Close(a) => (&a.paths, Each::Close(a.request.clone()), &a.many),
        ManyVerb::Identify(a) => (&a.paths, Each::Identify(a.request.clone()), &a.many),
    };
    let campaigns = Campaigns::find(paths, each)?;
    session.warn_all(campaigns.notes());
    let request = Many { force: session.common.force, ..request.clone() };
    let (folder, _temporary) = session.resumable(request.resume || request.shard.is_some())?;
    let store = campaigns.open(&folder, &request)?;
    crate::interrupt::listen();
    let missing = session.work("reading", || Ok(campaigns.missing(&store)))?;
    let all = campaigns.names().count();
    let bar = session.telling_bar("campaigns", missing.len());
    let done = session.pool()?.install(|| {
        campaigns.work(&store, missing, |outcome| {
            bar.inc(1);
            bar.set_message(outcome.path.clone());
            !crate::interrupt::asked()
        })
    });
    bar.finish_and_clear();
    done?;
    if let Some(shard) = request.shard.filter(|_| store.is_share()) {
        session.say(&format!("shard {shard} of {all} campaigns done in {}; join all with --resume", folder.display()));
        return Ok(true);
    }
    let summary = campaigns.finish(&store)?;
    session.show(&summary, || words(&summary))?;
    if session.common.out.is_some() {
        session.written(Some(&folder), &["campaigns.parquet", "many.json", "report.html", "results/"]);
    }
    Ok(true)
}

/// What is printed of it: the result on a screenful.
#[must_use]
pub fn words(s: &ManySummary) -> String {
    let list = |all: &[Tally]| all.iter().map(|t| format!("{} {}", t.count, t.name)).collect::<Vec<_>>().join(", ");
    let mut text = format!("{} campaigns: {} with a result, {} failed\n", s.campaigns, s.ok, s.failed);
    for (what, all) in [("verdicts", &s.verdicts), ("families", &s.families)] {
        if !all.is_empty() {
            let _ = writeln!(text, "{what}: {}", list(all));
        }
    }
    for o in s.outcomes.iter().filter(|o| o.status == Status::Failed) {
        let first = o.reason.lines().next().unwrap_or_default();
        let _ = writeln!(text, "failed: {} (exit code {}): {first}", o.path, o.exit_code);
    }
    if !s.pooled.is_empty() {
        let _ = writeln!(
            text,
            "\n{:<34}{:>4}{:>26}{:>12}{:>26}{:>9}",
            "over campaigns (random effects)", "n", "mean ± 95 %", "between", "one more campaign, 95 %", "p"
        );
    }
    for p in &s.pooled {
        let q = &p.pooled;
        let (mean, half) = with_interval(q.mean, Some(0.5 * (q.ci95[1] - q.ci95[0])));
        let mean = half.map_or_else(|| mean.clone(), |h| format!("{mean} ± {h}"));
        let next = q.prediction95.map_or_else(|| "-".to_owned(), interval);
        let name = format!("{} {}", p.of, p.name);
        let _ = writeln!(text, "{name:<34}{:>4}{mean:>26}{:>12}{next:>26}{:>9}", q.n, number(q.tau), p_value(q.p_value));
    }
    text
}
