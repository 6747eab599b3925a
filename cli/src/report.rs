//! cli: `windfall report`. In: a folder of results. Out: `report.html` in it, or in `--out`; figures in `--figures`.

use crate::args::ReportArgs;
use crate::session::{Failure, Session};
use windfall::files::{FileSet, text_atomically};
use windfall::{FIGURE_ENDINGS, ResultsFolder};

/// Name of the page.
const FILE: &str = "report.html";

pub(crate) fn run(args: &ReportArgs, session: &mut Session<'_>) -> Result<bool, Failure> {
    let results = ResultsFolder::read(&args.folder)?;
    // A page is made of what lies beside it and can be made again: it is replaced.
    let folder = args.common.out.as_ref().unwrap_or(&args.folder);
    let to = folder.join(FILE);
    if args.common.out.is_some() {
        session.outputs(&[FILE])?;
    }
    let set = FileSet::new(folder)?;
    text_atomically(&set.stage().join(FILE), &results.page())?;
    set.commit(true)?;
    session.say(&format!("written: {}", to.display()));
    let figures = match &args.figures {
        Some(folder) => {
            let names = results.write_figures(folder, args.width, session.common.force)?;
            let each = FIGURE_ENDINGS.join(", ");
            session.say(&format!("written to {}: {} figures, each as {each}", folder.display(), names.len()));
            names
        }
        None => Vec::new(),
    };
    if session.common.json {
        session.print_json(&serde_json::json!({ "page": to.display().to_string(), "figures": figures }))?;
    }
    Ok(true)
}
