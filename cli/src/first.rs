//! cli: `windfall init` and `windfall explain`. In: run files; words. Out: `campaign.toml`; what the words mean.

use crate::args::{ExplainArgs, InitArgs};
use crate::session::{Failure, Session};
use windfall::files::text_atomically;

/// Name of the campaign file.
const FILE: &str = "campaign.toml";

pub(crate) fn init(args: &InitArgs, session: &mut Session<'_>) -> Result<bool, Failure> {
    let draft = windfall::init(&args.runs, &args.request)?;
    session.common.out = Some(args.folder.clone());
    let files: Vec<&str> = std::iter::once(FILE).chain(draft.structure.iter().map(|(name, _)| *name)).collect();
    let folder = session.outputs(&files)?;
    session.write(folder.as_deref(), |stage| {
        text_atomically(&stage.join(FILE), &draft.campaign)?;
        if let Some((name, text)) = &draft.structure {
            text_atomically(&stage.join(name), text)?;
        }
        Ok(())
    })?;
    let path = args.folder.join(FILE);
    if session.common.json {
        session.print_json(&serde_json::json!({ "campaign": path.display().to_string() }))?;
    } else {
        session.print(&draft.campaign)?;
    }
    session.say(&format!("written: {0}; next: fill in what is nan, then windfall check {0}", path.display()));
    Ok(true)
}

pub(crate) fn explain(args: &ExplainArgs, session: &mut Session<'_>) -> Result<bool, Failure> {
    let text = windfall::explain(&args.request)?;
    session.show(&serde_json::json!({ "text": text }), || text.clone())?;
    Ok(true)
}
