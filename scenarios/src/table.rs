//! scenarios: walking a TOML file. In: text and the keys that are allowed. Out: values, and every fault with file, line, key.
//!
//! A value that is wrong or missing becomes NaN, empty or false here and a fault in the list; the caller goes on, so that all
//! faults of a file are reported at once, and gives up at the end when there are any.

use crate::error::{Fault, ReadError};
use crate::keys::spec::{Key, Kind, TableSpec};
use std::cell::{OnceCell, RefCell};
use std::ops::Range;
use std::path::Path;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// A file with the faults found in it so far.
pub(crate) struct Source<'t> {
    path: &'t Path,
    text: &'t str,
    /// Where lines end, found when the first fault asks: each of many faults asks again.
    line_ends: OnceCell<Vec<usize>>,
    faults: RefCell<Vec<Fault>>,
    /// Whether the tables that it names are bundled as well.
    bundled: bool,
}

impl<'t> Source<'t> {
    pub(crate) fn new(path: &'t Path, text: &'t str) -> Self {
        Self { path, text, line_ends: OnceCell::new(), faults: RefCell::new(Vec::new()), bundled: false }
    }
    /// A bundled file, whose tables are bundled as well.
    pub(crate) fn bundled(path: &'t Path, text: &'t str) -> Self {
        Self { bundled: true, ..Self::new(path, text) }
    }
    /// The text of a table that a bundled file names.
    pub(crate) fn bundled_table(&self, word: &str) -> Option<&'static str> {
        if self.bundled { crate::bundled::table(word) } else { None }
    }
    pub(crate) fn path(&self) -> &Path {
        self.path
    }
    /// The file's tables, or its syntax errors.
    pub(crate) fn parse(&self) -> Result<DeTable<'t>, ReadError> {
        let (table, errors) = DeTable::parse_recoverable(self.text);
        for e in &errors {
            self.fault(
                e.span(),
                "",
                "",
                format!("is not TOML: {}", e.message()),
                "correct the line; https://toml.io has the syntax",
            );
        }
        if errors.is_empty() { Ok(table.into_inner()) } else { Err(ReadError::Faults(self.take())) }
    }
    /// Line of a byte, from 1.
    fn line(&self, at: usize) -> usize {
        let ends = self.line_ends.get_or_init(|| self.text.match_indices('\n').map(|(i, _)| i).collect());
        ends.partition_point(|end| *end < at) + 1
    }
    pub(crate) fn fault(
        &self,
        span: Option<Range<usize>>,
        key: impl Into<String>,
        value: impl Into<String>,
        allowed: impl Into<String>,
        remedy: impl Into<String>,
    ) {
        let line = span.map(|s| self.line(s.start));
        self.faults.borrow_mut().push(Fault {
            file: self.path.to_owned(),
            line,
            key: key.into(),
            value: value.into(),
            allowed: allowed.into(),
            remedy: remedy.into(),
        });
    }
    pub(crate) fn has_faults(&self) -> bool {
        !self.faults.borrow().is_empty()
    }
    pub(crate) fn add(&self, faults: &[Fault]) {
        self.faults.borrow_mut().extend_from_slice(faults);
    }
    /// Text of a place in the file, shortened.
    pub(crate) fn snippet(&self, span: Range<usize>) -> String {
        let line = self.text.get(span).unwrap_or("").lines().next().unwrap_or("").to_owned();
        if line.chars().count() > 60 { line.chars().take(57).chain("...".chars()).collect() } else { line }
    }
    pub(crate) fn take(&self) -> Vec<Fault> {
        let mut all = self.faults.take();
        all.sort_by_key(|f| f.line.unwrap_or(usize::MAX));
        all
    }
    /// The value when no fault was found.
    pub(crate) fn finish<T>(&self, value: Option<T>) -> Result<T, ReadError> {
        let faults = self.take();
        match value {
            Some(v) if faults.is_empty() => Ok(v),
            _ => Err(ReadError::Faults(faults)),
        }
    }
}

/// One table of a file with the keys it may have.
pub(crate) struct Table<'a> {
    pub(crate) source: &'a Source<'a>,
    pub(crate) span: Range<usize>,
    /// Path in the file, for messages.
    pub(crate) path: String,
    table: &'a DeTable<'a>,
    spec: &'static TableSpec,
}

/// A value with its place.
pub(crate) type Value<'a> = &'a Spanned<DeValue<'a>>;

impl<'a> Table<'a> {
    /// Opens a table; keys that it may not have are faults.
    pub(crate) fn new(
        source: &'a Source<'a>,
        path: &str,
        table: &'a DeTable<'a>,
        span: Range<usize>,
        spec: &'static TableSpec,
    ) -> Self {
        let t = Self { source, span, path: path.to_owned(), table, spec };
        if !spec.keys.is_empty() {
            for (key, value) in table {
                if !spec.keys.iter().any(|k| k.name == key.get_ref().as_ref()) {
                    t.unknown(key, value, &spec.keys.iter().map(|k| k.name).collect::<Vec<_>>());
                }
            }
        }
        t
    }
    /// Reports a key that is not one of `allowed`.
    pub(crate) fn unknown(&self, key: &Spanned<std::borrow::Cow<'_, str>>, value: Value<'_>, allowed: &[&str]) {
        let remedy = match nearest(key.get_ref(), allowed) {
            Some(name) => name.to_owned(),
            None => "remove it".to_owned(),
        };
        let what = format!("unknown key; allowed: {}", allowed.join(", "));
        self.source.fault(Some(key.span()), self.full(key.get_ref()), self.source.snippet(value.span()), what, remedy);
    }
    /// All entries, in file order.
    pub(crate) fn entries(&self) -> impl Iterator<Item = (&'a Spanned<std::borrow::Cow<'a, str>>, Value<'a>)> + use<'a> {
        self.table.iter()
    }
    /// Path of a key for messages.
    pub(crate) fn full(&self, key: &str) -> String {
        if self.path.is_empty() { key.to_owned() } else { format!("[{}] {key}", self.path) }
    }
    fn key(&self, name: &str) -> &'static Key {
        self.spec.keys.iter().find(|k| k.name == name).expect("the reader asks only for keys of the table's own list")
    }
    /// The value of a key; missing is a fault when it is needed.
    pub(crate) fn value(&self, name: &str) -> Option<Value<'a>> {
        let found = self.table.get(name);
        let key = self.key(name);
        if found.is_none() && key.needed {
            let unit = if key.unit == "-" { String::new() } else { format!(", {}", key.unit) };
            self.source.fault(
                Some(self.span.clone()),
                self.full(name),
                "",
                format!("is missing ({}{unit}); it has no default", key.meaning),
                format!("{name} = ..."),
            );
        }
        found
    }
    /// Where a key's value stands; the table when it is absent.
    pub(crate) fn at(&self, name: &str) -> Option<Range<usize>> {
        Some(self.table.get(name).map_or_else(|| self.span.clone(), Spanned::span))
    }
    pub(crate) fn has(&self, name: &str) -> bool {
        self.table.contains_key(name)
    }
    fn wrong(&self, name: &str, value: Value<'_>, allowed: impl Into<String>) {
        let key = self.key(name);
        self.source.fault(Some(value.span()), self.full(name), self.source.snippet(value.span()), allowed, remedy(key));
    }
    fn checked(&self, name: &str, at: Value<'_>) -> f64 {
        let key = self.key(name);
        match number(at) {
            Some(x) if x.is_finite() && x >= key.range[0] && x <= key.range[1] => return x,
            Some(_) => self.wrong(name, at, allowed_range(key.range, key.unit)),
            None => self.wrong(name, at, format!("must be a number, is {}", at.get_ref().type_str())),
        }
        f64::NAN
    }
    /// A number; NaN with a fault.
    pub(crate) fn number(&self, name: &str) -> f64 {
        self.value(name).map_or(f64::NAN, |v| self.checked(name, v))
    }
    /// A number that may be absent.
    pub(crate) fn number_if(&self, name: &str) -> Option<f64> {
        self.table.get(name).map(|v| self.checked(name, v))
    }
    /// A whole number that may be absent.
    pub(crate) fn integer_if(&self, name: &str) -> Option<u64> {
        let at = self.table.get(name)?;
        let parsed = at.get_ref().as_integer().and_then(|i| u64::from_str_radix(i.as_str(), i.radix()).ok());
        let [low, high] = self.key(name).range;
        if !parsed.is_some_and(|x| (low..=high).contains(&(x as f64))) {
            self.wrong(name, at, format!("must be a whole number from {low} to {high}"));
        }
        parsed
    }
    /// A list of exactly N numbers.
    pub(crate) fn numbers<const N: usize>(&self, name: &str) -> [f64; N] {
        let Some(at) = self.value(name) else { return [f64::NAN; N] };
        match at.get_ref().as_array() {
            Some(list) if list.len() == N => std::array::from_fn(|i| list.get(i).map_or(f64::NAN, |v| self.checked(name, v))),
            _ => {
                self.wrong(name, at, format!("must be a list of {N} numbers"));
                [f64::NAN; N]
            }
        }
    }
    /// A list of two numbers or more.
    pub(crate) fn series(&self, name: &str) -> Vec<f64> {
        let Some(at) = self.value(name) else { return Vec::new() };
        match at.get_ref().as_array() {
            Some(list) if list.len() >= 2 => list.iter().map(|v| self.checked(name, v)).collect(),
            _ => {
                self.wrong(name, at, "must be a list of two numbers or more");
                Vec::new()
            }
        }
    }
    /// A list of words, each with its place; absent: none.
    pub(crate) fn words(&self, name: &str) -> Vec<(String, Range<usize>)> {
        let Some(at) = self.value(name) else { return Vec::new() };
        let word = |v: &Spanned<DeValue<'_>>| v.get_ref().as_str().map(|s| (s.to_owned(), v.span()));
        match at.get_ref().as_array().and_then(|l| l.iter().map(word).collect()) {
            Some(words) => words,
            None => {
                self.wrong(name, at, "must be a list of words in quotes");
                Vec::new()
            }
        }
    }
    /// Text, not empty.
    pub(crate) fn text(&self, name: &str) -> String {
        let Some(at) = self.value(name) else { return String::new() };
        match at.get_ref().as_str() {
            Some(s) if !s.trim().is_empty() => return s.to_owned(),
            Some(_) => self.wrong(name, at, "must not be empty"),
            None => self.wrong(name, at, format!("must be text in quotes, is {}", at.get_ref().type_str())),
        }
        String::new()
    }
    /// Text that may be absent.
    pub(crate) fn text_if(&self, name: &str) -> Option<String> {
        self.has(name).then(|| self.text(name))
    }
    /// One of the words of a choice, by its place.
    pub(crate) fn choice(&self, name: &str) -> Option<usize> {
        let at = self.value(name)?;
        let Kind::Choice(words) = self.key(name).kind else { return None };
        let found = at.get_ref().as_str().and_then(|s| words.iter().position(|w| *w == s));
        if found.is_none() {
            self.wrong(
                name,
                at,
                format!("must be one of {}", words.iter().map(|w| format!("\"{w}\"")).collect::<Vec<_>>().join(", ")),
            );
        }
        found
    }
    /// true or false.
    pub(crate) fn bool(&self, name: &str) -> bool {
        let Some(at) = self.value(name) else { return false };
        at.get_ref().as_bool().unwrap_or_else(|| {
            self.wrong(name, at, "must be true or false");
            false
        })
    }
    /// A table inside this one under its own name, opened with its own keys.
    pub(crate) fn table(&self, spec: &'static TableSpec) -> Option<Table<'a>> {
        self.table_named(spec.name(), spec)
    }
    /// The same, where it is there.
    pub(crate) fn table_if(&self, spec: &'static TableSpec) -> Option<Table<'a>> {
        self.has(spec.name()).then(|| self.table(spec)).flatten()
    }
    /// The same under another name.
    pub(crate) fn table_named(&self, name: &str, spec: &'static TableSpec) -> Option<Table<'a>> {
        let at = self.value(name)?;
        let path = if self.path.is_empty() { name.to_owned() } else { format!("{}.{name}", self.path) };
        self.open(name, at, &path, spec)
    }
    fn open(&self, name: &str, at: Value<'a>, path: &str, spec: &'static TableSpec) -> Option<Table<'a>> {
        match at.get_ref().as_table() {
            Some(table) => Some(Table::new(self.source, path, table, at.span(), spec)),
            None => {
                self.wrong(name, at, format!("must be a table, is {}", at.get_ref().type_str()));
                None
            }
        }
    }
    /// One of the words of a key that may be a table as well; `Err` holds the table, opened.
    pub(crate) fn word_or_table(&self, spec: &'static TableSpec) -> Option<Result<usize, Table<'a>>> {
        let name = spec.name();
        let at = self.value(name)?;
        let Kind::WordOrTable(words) = self.key(name).kind else { return None };
        if at.get_ref().as_table().is_some() {
            return self.table(spec).map(Err);
        }
        let found = at.get_ref().as_str().and_then(|s| words.iter().position(|w| *w == s));
        if found.is_none() {
            let words = words.iter().map(|w| format!("\"{w}\"")).collect::<Vec<_>>().join(", ");
            self.wrong(name, at, format!("must be one of {words}, or a table"));
        }
        found.map(Ok)
    }
    /// One table or a list of them, each opened.
    pub(crate) fn one_or_more(&self, spec: &'static TableSpec) -> Vec<Table<'a>> {
        let name = spec.name();
        match self.table.get(name) {
            Some(at) if at.get_ref().as_table().is_some() => self.open(name, at, name, spec).into_iter().collect(),
            _ => self.tables(spec),
        }
    }
    /// A list of tables, each opened; an empty list is a fault.
    pub(crate) fn tables(&self, spec: &'static TableSpec) -> Vec<Table<'a>> {
        let name = spec.name();
        let Some(at) = self.value(name) else { return Vec::new() };
        match at.get_ref().as_array() {
            Some(list) if !list.is_empty() => {
                list.iter().enumerate().filter_map(|(i, v)| self.open(name, v, &format!("{name} {}", i + 1), spec)).collect()
            }
            _ => {
                self.wrong(name, at, format!("must be one table [[{name}]] or more"));
                Vec::new()
            }
        }
    }
}

/// What is allowed, in words.
pub(crate) fn allowed_range([low, high]: [f64; 2], unit: &str) -> String {
    let unit = if unit == "-" { String::new() } else { format!(" {unit}") };
    match (low.is_finite(), high.is_finite()) {
        (true, true) => format!("must be a finite number from {low:e} to {high:e}{unit}"),
        _ => "must be a finite number".to_owned(),
    }
}

fn remedy(key: &Key) -> String {
    if key.unit == "-" { key.meaning.to_owned() } else { format!("{} in {}", key.meaning, key.unit) }
}

/// A number of either TOML kind.
pub(crate) fn number(v: Value<'_>) -> Option<f64> {
    match v.get_ref() {
        DeValue::Float(x) => x.as_str().parse().ok(),
        #[expect(
            clippy::cast_precision_loss,
            reason = "whole numbers beyond 2^53 are out of every key's range or need no last digit"
        )]
        DeValue::Integer(i) => i64::from_str_radix(i.as_str(), i.radix()).ok().map(|x| x as f64),
        _ => None,
    }
}

/// The allowed word that differs least, when it differs by little.
pub(crate) fn nearest<'n>(word: &str, allowed: &[&'n str]) -> Option<&'n str> {
    let letters = word.chars().count();
    allowed
        .iter()
        // Words differ by their difference in length at least.
        .filter(|a| a.chars().count().abs_diff(letters) <= 2.max(a.len() / 3))
        .map(|a| (distance(&word.to_lowercase(), &a.to_lowercase()), *a))
        .filter(|(d, a)| *d <= 2.max(a.len() / 3))
        .min_by_key(|(d, _)| *d)
        .map(|(_, a)| a)
}

/// Levenshtein distance of two words (Levenshtein 1966).
fn distance(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, ca) in a.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, cb) in b.iter().enumerate() {
            let next = (diagonal + usize::from(ca != *cb)).min(row[j] + 1).min(row[j + 1] + 1);
            diagonal = std::mem::replace(&mut row[j + 1], next);
        }
    }
    row[b.len()]
}
