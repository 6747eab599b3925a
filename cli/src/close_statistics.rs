//! cli: `windfall close --statistics`. In: published statistics of a run. Out: a table, `close.json` and `report.html`.

use crate::session::{Failure, Session, is_bundled};
use anyhow::anyhow;
use std::path::Path;
use windfall_report::{FolderResults, folder_page};
use windfall_scenarios::{StatisticsFile, bundled_statistics, read_statistics, text_atomically, write_json_atomically};
use windfall_verify::statistics::{
    Figure, Moment, Quantity, StatisticsError, StatisticsOptions, StatisticsSetup, close_statistics, statistics_table,
};

/// Names of the result files.
const FILES: [&str; 2] = ["close.json", "report.html"];

pub(crate) fn run(word: &Path, session: &mut Session<'_>) -> Result<bool, Failure> {
    let file = match word.to_str().filter(|_| is_bundled(word) || word == Path::new("table-5.6")) {
        Some("table-5.6") => bundled_statistics()?,
        _ => read_statistics(word)?,
    };
    let setup = setup(&file)?;
    let folder = session.outputs(&FILES.map(str::to_owned))?;
    let spinner = session.spinner("searching the catalogue");
    let closed = session.pool()?.install(|| close_statistics(&setup, &StatisticsOptions::default()));
    spinner.finish_and_clear();
    let closing = closed.map_err(of_statistics)?;
    let table = statistics_table(&closing);
    if let Some(folder) = &folder {
        let value = serde_json::to_value(&closing)?;
        write_json_atomically(&folder.join(FILES[0]), &closing)?;
        let others = [("Closed against published statistics".to_owned(), value)];
        let title = format!("{}: closed against statistics", file.name);
        text_atomically(
            &folder.join(FILES[1]),
            &folder_page(&title, &FolderResults { others: &others, ..FolderResults::default() }),
        )?;
    }
    if session.common.json {
        session.print_json(&closing)?
    } else {
        session.print(&table)?
    }
    if let Some(folder) = &folder {
        session.say(&format!("written to {}: {}", folder.display(), FILES.join(", ")));
    }
    Ok(closing.verdict != "unexplained")
}

fn setup(file: &StatisticsFile) -> Result<StatisticsSetup, Failure> {
    let figures: Option<Vec<Figure>> = file
        .figures
        .iter()
        .map(|f| {
            Some(Figure {
                quantity: Quantity::from_name(&f.quantity)?,
                statistic: Moment::from_name(&f.statistic)?,
                test: f.test,
                simulation: f.simulation,
                fitted: f.fitted,
            })
        })
        .collect();
    let figures = figures.ok_or_else(|| anyhow!("{}: a figure of a quantity or statistic that is not known", file.name))?;
    StatisticsSetup::new((&file.name, &file.source), file.seed, file.plant.clone(), file.flight.clone(), figures)
        .map_err(of_statistics)
}

fn of_statistics(error: StatisticsError) -> Failure {
    match error {
        StatisticsError::Simulate(e) => Failure::of_flight("of the declared model", e),
        other => Failure::Input(other.into()),
    }
}
