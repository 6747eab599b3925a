//! cli: `windfall verify`. In: bundled scenarios. Out: every check of the program's own truth, figure beside bound, and `verify.json`.

use crate::args::VerifyArgs;
use crate::session::{Failure, Session};
use serde::Serialize;
use std::fmt::Write as _;
use windfall_scenarios::read_bundled;
use windfall_verify::{Check, Kind, Setups, Verdict, all_pass, checks};

/// Name of the result file.
const FILE: &str = "verify.json";

/// What is written.
#[derive(Serialize)]
struct Report<'a> {
    verdict: &'static str,
    checks: &'a [Check],
}

pub(crate) fn run(args: &VerifyArgs, session: &mut Session<'_>) -> Result<bool, Failure> {
    let [appendix_c, full_scale, combined] = ["appendix-c", "full-scale-venus-20km", "sage-combined"].map(read_bundled);
    let (appendix_c, full_scale, combined) = (appendix_c?.scenario, full_scale?.scenario, combined?.scenario);
    // The table is the result; a file is written where one is asked for, so that the command can be run again and again.
    let folder = if args.common.out.is_some() { session.outputs(&[FILE.to_owned()])? } else { None };
    let spinner = session.spinner("checking");
    let setups = Setups { appendix_c: &appendix_c, full_scale: &full_scale, combined: &combined };
    let all = session.pool()?.install(|| checks(&setups));
    spinner.finish_and_clear();
    let all = all.map_err(Failure::of_verification)?;
    let good = all_pass(&all);
    let report = Report { verdict: if good { "pass" } else { "fail" }, checks: &all };
    session.deliver(folder.as_deref(), FILE, &report, || table(&all, good))?;
    Ok(good)
}

fn table(all: &[Check], good: bool) -> String {
    let mut text = String::new();
    for (kind, title) in [
        (Kind::Exact, "Exact: closed forms and conservation laws"),
        (Kind::Published, "Published: printed numbers"),
        (Kind::Recovered, "Recovered: what was put in is found again"),
    ] {
        let _ = writeln!(text, "{title}");
        all.iter().filter(|c| c.kind == kind).for_each(|c| lines(&mut text, c));
        text.push('\n');
    }
    let count = |v: Verdict| all.iter().filter(|c| c.verdict == v).count();
    let _ = writeln!(
        text,
        "{}: {} checks pass, {} fail, {} shown without a bound",
        if good { "PASS" } else { "FAIL" },
        count(Verdict::Pass),
        count(Verdict::Fail),
        count(Verdict::Shown)
    );
    text
}

/// Two lines: verdict and what is compared; figure, bound, the thesis' figure and where the bound comes from.
fn lines(text: &mut String, c: &Check) {
    let verdict = match c.verdict {
        Verdict::Pass => "pass ",
        Verdict::Fail => "FAIL ",
        Verdict::Shown => "shown",
    };
    let unit = if c.unit == "1" { String::new() } else { format!(" {}", c.unit) };
    let bound = if c.verdict == Verdict::Shown { "no bound".to_owned() } else { format!("bound {}", c.bound) };
    let thesis = c.thesis.map_or_else(String::new, |t| format!(", thesis {}", number(t)));
    let _ = writeln!(text, "  {verdict}  {}", c.what);
    let _ = writeln!(text, "         {}{unit}, {bound}{thesis}   [{}]", number(c.figure), c.source);
}

/// A figure in six digits, as short as its size allows.
fn number(x: f64) -> String {
    if x == 0.0 || (1e-3..1e5).contains(&x.abs()) { format!("{x:.5}") } else { format!("{x:.3e}") }
}
