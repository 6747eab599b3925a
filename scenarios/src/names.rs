//! scenarios: names that become those of files. In: a name. Out: whether every system takes it.

use crate::table::Table;

/// Names that are safe in a file's name on every system.
pub(crate) fn is_file_name(name: &str) -> bool {
    name.len() <= 100 && name.chars().all(|c| c.is_ascii_alphanumeric() || "-_.".contains(c))
}

/// The name of a flight becomes a file's.
pub(crate) fn name_of_file(t: &Table<'_>, name: &str) {
    if !name.is_empty() && !is_file_name(name) {
        let what = "must be of letters, digits, - _ . and at most a hundred of them (it becomes a file name)";
        t.source.fault(t.at("name"), t.full("name"), name, what, "perturbed-1");
    }
}
