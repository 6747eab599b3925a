//! cli: `windfall report`. In: a folder of results. Out: `report.html` in it, or in `--out`.

use crate::args::ReportArgs;
use crate::session::{Failure, Session};
use anyhow::anyhow;
use serde_json::Value;
use std::path::{Path, PathBuf};
use windfall_report::{FolderResults, folder_page};
use windfall_scenarios::{read_json, text_atomically};
use windfall_verify::close::{Closing, Figure};
use windfall_verify::study::Summary;

/// Name of the page.
const FILE: &str = "report.html";
/// Results beside a closing, with their titles.
const OTHERS: [(&str, &str); 3] = [
    ("identification.json", "Identification"),
    ("resimulation.json", "Re-simulation"),
    ("verify.json", "Checks of the program's own truth"),
];

pub(crate) fn run(args: &ReportArgs, session: &mut Session<'_>) -> Result<bool, Failure> {
    let folder = &args.folder;
    let mut others = Vec::new();
    let mut closing: Option<Closing> = None;
    if let Some(path) = there(folder, "close.json") {
        let value: Value = read_json(&path)?;
        // A closing against statistics names its source and no campaign.
        if value.get("campaign").is_some() {
            closing = Some(read_json(&path)?);
        } else {
            others.push(("Closed against published statistics".to_owned(), value));
        }
    }
    let figures: Vec<Figure> = there(folder, "figures.json").map(|p| read_json(&p)).transpose()?.unwrap_or_default();
    for (file, title) in OTHERS {
        if let Some(path) = there(folder, file) {
            others.push((title.to_owned(), read_json(&path)?));
        }
    }
    let study: Option<Summary> = there(folder, "summary.json").map(|p| read_json(&p)).transpose()?;
    if closing.is_none() && study.is_none() && others.is_empty() {
        let known: Vec<&str> = ["close.json", "summary.json"].into_iter().chain(OTHERS.map(|(f, _)| f)).collect();
        let what = format!("{}: holds no result; looked for {}", folder.display(), known.join(", "));
        return Err(anyhow!("{what}; try: the --out folder of another command").into());
    }
    let title = folder.canonicalize().ok().and_then(|p| Some(p.file_name()?.to_string_lossy().into_owned()));
    let title = title.unwrap_or_else(|| folder.display().to_string());
    let results = FolderResults { closing: closing.as_ref(), figures: &figures, study: study.as_ref(), others: &others };
    let page = folder_page(&title, &results);
    // A page is made of what lies beside it and can be made again: it is replaced.
    let to = args.common.out.clone().unwrap_or_else(|| folder.clone());
    if args.common.out.is_some() {
        session.outputs(&[FILE.to_owned()])?;
    }
    text_atomically(&to.join(FILE), &page)?;
    if session.common.json {
        session.print_json(&serde_json::json!({ "page": to.join(FILE).display().to_string() }))?;
    }
    session.say(&format!("written: {}", to.join(FILE).display()));
    Ok(true)
}

fn there(folder: &Path, file: &str) -> Option<PathBuf> {
    Some(folder.join(file)).filter(|p| p.is_file())
}
