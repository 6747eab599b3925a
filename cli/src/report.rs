//! cli: `windfall report`. In: a folder of results. Out: `report.html` in it, or in `--out`.

use crate::args::ReportArgs;
use crate::session::{Failure, Session};
use windfall::ResultsFolder;
use windfall::files::text_atomically;

/// Name of the page.
const FILE: &str = "report.html";

pub(crate) fn run(args: &ReportArgs, session: &mut Session<'_>) -> Result<bool, Failure> {
    let page = ResultsFolder::read(&args.folder)?.page();
    // A page is made of what lies beside it and can be made again: it is replaced.
    let to = args.common.out.clone().unwrap_or_else(|| args.folder.clone()).join(FILE);
    if args.common.out.is_some() {
        session.outputs(&[FILE])?;
    }
    text_atomically(&to, &page)?;
    if session.common.json {
        session.print_json(&serde_json::json!({ "page": to.display().to_string() }))?;
    }
    session.say(&format!("written: {}", to.display()));
    Ok(true)
}
