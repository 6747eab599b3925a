//! cli: `windfall verify`. In: bundled scenarios. Out: every check of the program's own truth, figure beside bound, and `verify.json`.

use crate::args::VerifyArgs;
use crate::session::{Failure, Session};
use std::fmt::Write as _;
use windfall::Verification;
use windfall::results::{Check, CheckKind as Kind, CheckVerdict as Verdict};

/// Name of the result file.
const FILE: &str = "verify.json";

pub(crate) fn run(_: &VerifyArgs, session: &mut Session<'_>) -> Result<bool, Failure> {
    let folder = session.outputs(&[FILE])?;
    let all = session.work("checking", windfall::verify)?;
    let good = all.passed();
    session.deliver(folder.as_deref(), FILE, &all, || words(&all))?;
    Ok(good)
}

/// What is printed of the checks.
#[must_use]
pub fn words(verification: &Verification) -> String {
    let (all, good) = (&verification.checks, verification.passed());
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
