//! windfall: closing against published statistics. In: statistics by file or name. Out: what the declared model lacks beside them.

use crate::{Close, Error, Result};
use std::path::Path;
use windfall_discover::statistics::{
    FigureQuantity, Moment, StatisticFigure, StatisticsClosing, StatisticsOptions, StatisticsSetup, close_statistics,
};
use windfall_report::{FolderResults, folder_page};
use windfall_scenarios::{StatisticsFile, bundled_statistics, read_statistics};

/// Name of the bundled file.
const TABLE_5_6: &str = "table-5.6";

/// Statistics of a run that somebody published, with the declared model of its vehicle.
///
/// ```
/// use windfall::prelude::*;
/// let table = Published::find("table-5.6".as_ref())?;
/// assert!(!table.name.is_empty());
/// # Ok::<(), windfall::Error>(())
/// ```
#[derive(Debug)]
pub struct Published {
    /// Name.
    pub name: String,
    setup: StatisticsSetup,
}

impl Published {
    /// Reads a statistics file; `table-5.6` is bundled.
    ///
    /// # Errors
    /// Every fault of the file, a figure that makes no sense, a declared model that cannot be flown.
    pub fn find(word: &Path) -> Result<Self> {
        let file = if word == Path::new(TABLE_5_6) { bundled_statistics()? } else { read_statistics(word)? };
        let setup = setup(&file)?;
        Ok(Self { name: file.name, setup })
    }
    /// What the declared model lacks: the content of `close.json`.
    ///
    /// # Errors
    /// A flight that failed, a record that cannot be processed.
    pub fn close(&self, _request: &Close) -> Result<StatisticsClosing> {
        Ok(close_statistics(&self.setup, &StatisticsOptions::default())?)
    }
    /// The page of a closing.
    ///
    /// # Errors
    /// Never, as results are numbers and words.
    pub fn page(&self, closing: &StatisticsClosing) -> Result<String> {
        let value = serde_json::to_value(closing).map_err(|e| Error::Request(format!("result as JSON: {e}")))?;
        let title = format!("{}: closed against statistics", self.name);
        let others = [("Closed against published statistics".to_owned(), value)];
        Ok(folder_page(&title, &FolderResults { others: &others, ..FolderResults::default() }))
    }
}

fn setup(file: &StatisticsFile) -> Result<StatisticsSetup> {
    let figures: Option<Vec<StatisticFigure>> = file
        .figures
        .iter()
        .map(|f| {
            Some(StatisticFigure {
                quantity: FigureQuantity::from_name(&f.quantity)?,
                statistic: Moment::from_name(&f.statistic)?,
                test: f.test,
                simulation: f.simulation,
                fitted: f.fitted,
            })
        })
        .collect();
    let unknown = || Error::Request(format!("{}: a figure of a quantity or statistic that is not known", file.name));
    let (name, flight) = ((file.name.as_str(), file.source.as_str()), file.flight.clone());
    Ok(StatisticsSetup::new(name, file.seed, file.plant.clone(), flight, figures.ok_or_else(unknown)?)?)
}
