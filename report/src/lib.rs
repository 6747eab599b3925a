//! report: figures and the page. In: results of `verify`, series for figures. Out: one self-contained HTML page.
//!
//! Nothing is computed here but ratios of what a result holds and places on paper: a page shows a result, it never adds to it.

mod closing;
mod folder;
mod html;
mod study;
mod svg;
mod words;

pub use closing::closing_page;
pub use folder::{FolderResults, folder_page};
pub use words::{number, p_value, sentence, with_interval};
