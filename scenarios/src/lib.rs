//! scenarios: the only room that reads and writes files. In: TOML and CSV files, bundled scenarios. Out: checked campaigns and
//! scenarios; results on disk.
//!
//! Every fault of a file is reported at once, with file, line, key, value, what is allowed and what to try.

mod bundled;
mod campaign;
mod campaign_store;
mod clean;
mod column_unit;
mod columns;
mod dispersions;
mod error;
mod file_set;
mod find;
mod formats;
mod free_flight;
mod free_out;
mod free_scenario;
mod grid;
mod guess;
mod hash;
mod in_memory;
mod journal;
mod keys;
mod kind;
mod limits;
mod names;
mod numerics;
mod open;
mod own;
mod parquet_pages;
mod parquet_rows;
mod planet;
mod planet_out;
mod plant;
mod point;
mod point_body;
mod profile;
mod record;
mod reference;
mod reference_lists;
mod run_columns;
mod scenario;
mod statistics;
mod store;
mod store_error;
mod structure;
mod study;
mod table;
mod told;
mod toml_out;
mod uncertainty;
mod units;
mod wind_tunnel;
mod write;

pub use bundled::{FREE as BUNDLED_FREE, NAMES as BUNDLED, PLANETS as BUNDLED_PLANETS, bundled};
pub use campaign::{read_campaign, read_campaign_with_warnings};
pub use campaign_store::{CampaignStore, ManyIdentity, ResultFile, campaign_hash, table_bytes};
pub use columns::write_columns_csv;
pub use error::{Fault, ReadError, WriteError};
pub use file_set::{FileSet, settle};
pub use find::{FindError, FoundCampaign, FoundCampaigns, find_campaigns};
pub use free_out::{write_free_campaign, write_resolved_free};
pub use free_scenario::{FreeFile, FreeOrder, read_bundled_free, read_free};
pub use grid::LONGEST_BRIDGE_S;
pub use guess::{Draft, DraftKind, draft_campaign};
pub use in_memory::{RunColumns, runs_of_columns};
pub use kind::{FileKind, kind_of, must_be};
pub use open::read_json;
pub use planet::{PlanetFile, read_bundled_planet, read_planet};
pub use planet_out::write_resolved_planet;
pub use point::{Down, read_track};
pub use record::{
    FEWEST_SAMPLES, Piece, SHORTEST_PIECE_S, read_record_csv, read_record_pieces, record_columns, sensors_of_table_a3,
    write_record_csv,
};
pub use reference::{KeyMeaning, key_reference, meanings};
pub use scenario::{EffectValues, ScenarioFile, read_bundled, read_scenario_file};
pub use statistics::{PublishedFigure, StatisticsFile, TABLE_5_6, bundled_statistics, read_statistics};
pub use store::{FullPart, Identity, Merged, Opening, Part, Runs, Shard, Store, part_bytes, read_runs};
pub use store_error::StoreError;
pub use structure::read_structure;
pub use study::{StudyFile, read_study};
pub use told::{columns_of_campaign, columns_of_run};
pub use toml_out::{RunLine, write_campaign_toml, write_resolved_scenario, write_structure};
pub use write::{bytes_atomically, json_text, series_text, text_atomically, write_json_atomically};
