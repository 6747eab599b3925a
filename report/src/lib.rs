//! report: figures and the page. In: results of `verify`, series for figures. Out: one self-contained HTML page; figures as files.
//!
//! Nothing is computed here but ratios of what a result holds and places on paper: a page shows a result, it never adds to it.

mod chart;
mod checks;
mod closing;
mod cut;
mod data;
mod descent;
mod draw;
mod envelope;
mod examined;
mod fitted;
mod folder;
mod held_out;
mod html;
mod identification;
mod laid_out;
mod legend;
mod many;
mod one_to_one;
mod pairs;
mod paper;
mod pdf;
mod plot;
mod scale;
mod shape;
mod signals;
mod smoothing;
mod statistics;
mod story;
mod study;
mod study_closings;
mod study_varied;
mod svg;
mod wind_tunnel;
mod words;

pub use closing::closing_page;
pub use envelope::{test_table, validity};
pub use examined::{agreement, identifiable, pressure_agreement};
pub use folder::{FolderResults, campaign_page, folder_figures, folder_page};
pub use many::many_page;
pub use paper::{PaperFigure, WIDTH_MM};
pub use words::{interval, number, p_value, p_with_sign, with_interval};
