//! cli: `windfall report`. In: a folder of results. Out: `report.html` in it, or in `--out`; figures in `--figures`.

use crate::args::ReportArgs;
use crate::session::{Failure, Session};
use anyhow::{Context as _, anyhow};
use std::path::Path;
use windfall::ResultsFolder;
use windfall::files::{FileSet, text_atomically};
use windfall::report::PaperFigure;

/// Name of the page.
const FILE: &str = "report.html";

pub(crate) fn run(args: &ReportArgs, session: &mut Session<'_>) -> Result<bool, Failure> {
    let results = ResultsFolder::read(&args.folder)?;
    // A page is made of what lies beside it and can be made again: it is replaced.
    let to = args.common.out.clone().unwrap_or_else(|| args.folder.clone()).join(FILE);
    if args.common.out.is_some() {
        session.outputs(&[FILE])?;
    }
    text_atomically(&to, &results.page())?;
    session.say(&format!("written: {}", to.display()));
    let figures = match &args.figures {
        Some(folder) => paper(folder, &results.paper_figures(args.width), session)?,
        None => Vec::new(),
    };
    if session.common.json {
        session.print_json(&serde_json::json!({ "page": to.display().to_string(), "figures": figures }))?;
    }
    Ok(true)
}

/// Writes all figures, or none; gives their names.
fn paper(folder: &Path, figures: &[PaperFigure], session: &mut Session<'_>) -> Result<Vec<String>, Failure> {
    std::fs::create_dir_all(folder).with_context(|| format!("--figures {}: cannot be made a folder", folder.display()))?;
    let endings = ["svg", "pdf", "csv"];
    let taken = figures.iter().flat_map(|f| endings.map(|e| format!("{}.{e}", f.name))).find(|f| folder.join(f).exists());
    if let Some(file) = taken.filter(|_| !session.common.force) {
        return Err(anyhow!("{}: {file} exists and is not overwritten; try: another folder or --force", folder.display()).into());
    }
    let set = FileSet::new(folder)?;
    for f in figures {
        for (ending, bytes) in endings.into_iter().zip([f.svg.as_bytes(), &f.pdf, f.csv.as_bytes()]) {
            let path = set.stage().join(format!("{}.{ending}", f.name));
            std::fs::write(&path, bytes).with_context(|| format!("{}", path.display()))?;
        }
    }
    set.commit(session.common.force)?;
    session.say(&format!("written to {}: {} figures, each as {}", folder.display(), figures.len(), endings.join(", ")));
    Ok(figures.iter().map(|f| f.name.clone()).collect())
}
