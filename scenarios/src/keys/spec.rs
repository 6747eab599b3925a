//! scenarios: what is said of a key. In: nothing. Out: the shape of a table of keys.

/// What a key holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Kind {
    /// A number.
    Number,
    /// A whole number.
    Integer,
    /// So many numbers.
    Numbers(usize),
    /// Any number of numbers, two at least.
    Series,
    /// Text.
    Text,
    /// One of these words.
    Choice(&'static [&'static str]),
    /// true or false.
    Bool,
    /// A list of words.
    Words,
    /// One of these words, or a table.
    WordOrTable(&'static [&'static str]),
    /// A number, or the name of a run input.
    Setting,
    /// Three of them.
    Settings,
    /// A column of a run file: a name, a number or a table.
    Column,
    /// A table with keys of its own, read by its own rules.
    Table,
    /// A list of tables.
    Tables,
}

/// One key.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Key {
    pub(crate) name: &'static str,
    pub(crate) kind: Kind,
    /// `-` for none.
    pub(crate) unit: &'static str,
    /// Smallest and largest allowed value, inclusive.
    pub(crate) range: [f64; 2],
    pub(crate) needed: bool,
    pub(crate) meaning: &'static str,
}

/// One table of a file.
#[derive(Debug)]
pub(crate) struct TableSpec {
    /// Its path in the file.
    pub(crate) path: &'static str,
    pub(crate) meaning: &'static str,
    /// Empty: keys are not fixed (parameters by name).
    pub(crate) keys: &'static [Key],
}

impl TableSpec {
    /// The key that it stands under in the table around it: the last word of its path.
    pub(crate) fn name(&self) -> &'static str {
        self.path.rsplit('.').next().unwrap_or(self.path)
    }
}
