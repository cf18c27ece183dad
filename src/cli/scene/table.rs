//! Tables of a scene file, whose every complaint tells the file, the line and what would work.

use std::borrow::Cow;
use std::ops::Range;
use std::path::{Path, PathBuf};

use glam::DVec3;
use thiserror::Error;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use crate::cli::preset::{did_you_mean, line_of, nearest};
use crate::cli::values;

/// Why a scene file cannot be used.
#[derive(Debug, Error)]
pub(in crate::cli) enum SceneError {
    #[error("{}: {error}", file.display())]
    Unreadable { file: PathBuf, error: std::io::Error },
    #[error("{}: {error}", file.display())]
    Syntax { file: PathBuf, error: Box<toml::de::Error> },
    #[error("{}, line {line}: {of} has no key {key}{}", file.display(), did_you_mean(suggestion.as_deref()))]
    Unknown { file: PathBuf, line: usize, of: Box<str>, key: Box<str>, suggestion: Option<String> },
    #[error("{}, line {line}: {key} of {of} {found}; {wanted}", file.display())]
    Value { file: PathBuf, line: usize, of: Box<str>, key: Box<str>, found: Box<str>, wanted: Box<str> },
    #[error("{}, line {line}: {of} {found}; {wanted}", file.display())]
    Table { file: PathBuf, line: usize, of: Box<str>, found: Box<str>, wanted: Box<str> },
}

/// A scene file and its text.
#[derive(Debug, Clone, Copy)]
pub(super) struct Source<'t> {
    pub(super) file: &'t Path,
    pub(super) text: &'t str,
}

/// A table, and what it is of.
#[derive(Clone)]
pub(super) struct Table<'t> {
    pub(super) source: Source<'t>,
    /// What it is called in messages.
    pub(super) of: String,
    entries: &'t DeTable<'t>,
    span: Range<usize>,
}

/// A key with its value.
#[derive(Clone)]
pub(super) struct Entry<'t> {
    source: Source<'t>,
    of: String,
    pub(super) key: &'t str,
    key_at: usize,
    pub(super) value: &'t Spanned<DeValue<'t>>,
}

impl<'t> Table<'t> {
    pub(super) fn new(source: Source<'t>, of: &str, table: &'t Spanned<DeTable<'t>>) -> Self {
        Self { source, of: of.to_owned(), entries: table.get_ref(), span: table.span() }
    }

    /// All entries.
    pub(super) fn entries(&self) -> impl Iterator<Item = Entry<'t>> + '_ {
        self.entries.iter().map(|(key, value): (&'t Spanned<Cow<'t, str>>, _)| Entry {
            source: self.source,
            of: self.of.clone(),
            key: key.get_ref(),
            key_at: key.span().start,
            value,
        })
    }

    /// The entry of a key, if there is one.
    pub(super) fn get(&self, key: &str) -> Option<Entry<'t>> {
        self.entries().find(|entry| entry.key == key)
    }

    /// Refuses keys that are not `known`.
    pub(super) fn only(&self, known: &[&str]) -> Result<(), SceneError> {
        match self.entries().find(|entry| !known.contains(&entry.key)) {
            Some(entry) => Err(entry.unknown(known.iter().copied())),
            None => Ok(()),
        }
    }

    /// That something is wrong with the table as a whole.
    pub(super) fn wrong(&self, found: &str, wanted: &str) -> SceneError {
        SceneError::Table {
            file: self.source.file.to_owned(),
            line: line_of(self.source.text, self.span.start),
            of: self.of.as_str().into(),
            found: found.into(),
            wanted: wanted.into(),
        }
    }
}

impl<'t> Entry<'t> {
    /// That the key is none of `known`.
    pub(super) fn unknown<'k>(&self, known: impl IntoIterator<Item = &'k str>) -> SceneError {
        SceneError::Unknown {
            file: self.source.file.to_owned(),
            line: line_of(self.source.text, self.key_at),
            of: self.of.as_str().into(),
            key: self.key.into(),
            suggestion: nearest(self.key, known),
        }
    }

    /// That the value is something else than what was wanted.
    pub(super) fn wrong(&self, wanted: &str) -> SceneError {
        self.because(&format!("is {}", self.value.get_ref().type_str()), &format!("use {wanted}"))
    }

    /// What is wrong with the value, and what would work.
    pub(super) fn because(&self, found: &str, wanted: &str) -> SceneError {
        SceneError::Value {
            file: self.source.file.to_owned(),
            line: line_of(self.source.text, self.value.span().start),
            of: self.of.as_str().into(),
            key: self.key.into(),
            found: found.into(),
            wanted: wanted.into(),
        }
    }

    /// A table.
    pub(super) fn table(&self, of: String) -> Result<Table<'t>, SceneError> {
        let entries = self.value.get_ref().as_table().ok_or_else(|| self.wrong("a table"))?;
        Ok(Table { source: self.source, of, entries, span: self.key_at..self.value.span().end })
    }

    /// The tables of a list.
    pub(super) fn tables(&self, of: &str) -> Result<Vec<Table<'t>>, SceneError> {
        let wanted = "a list of tables, as [[joint]] begins each";
        let items = self.value.get_ref().as_array().ok_or_else(|| self.wrong(wanted))?;
        let table = |(number, item): (usize, &'t Spanned<DeValue<'t>>)| {
            let entries = item.get_ref().as_table().ok_or_else(|| self.wrong(wanted))?;
            Ok(Table { source: self.source, of: format!("{of} {number}"), entries, span: item.span() })
        };
        (1..).zip(items.iter()).map(table).collect()
    }

    pub(super) fn text(&self) -> Result<&'t str, SceneError> {
        self.value.get_ref().as_str().ok_or_else(|| self.wrong("a text"))
    }

    pub(super) fn truth(&self) -> Result<bool, SceneError> {
        self.value.get_ref().as_bool().ok_or_else(|| self.wrong("true or false"))
    }

    /// A text, or several.
    pub(super) fn texts(&self) -> Result<Vec<&'t str>, SceneError> {
        let text = |value: &'t Spanned<DeValue<'t>>| value.get_ref().as_str();
        let texts = match self.value.get_ref().as_array() {
            Some(values) => values.iter().map(text).collect(),
            None => text(self.value).map(|one| vec![one]),
        };
        texts.ok_or_else(|| self.wrong("a text or a list of texts"))
    }

    pub(super) fn number(&self) -> Result<f64, SceneError> {
        number(self.value.get_ref()).ok_or_else(|| self.wrong("a number"))
    }

    /// Whole, and at least 1.
    pub(super) fn count(&self) -> Result<usize, SceneError> {
        let whole = |n: f64| ((1.0..=1e4).contains(&n) && n.fract() == 0.0).then_some(n as usize);
        number(self.value.get_ref())
            .and_then(whole)
            .ok_or_else(|| self.wrong("a whole number from 1 to 10000"))
    }

    /// A length in millimetres: a number, or a text with a unit.
    pub(super) fn length(&self) -> Result<f64, SceneError> {
        length(self.value.get_ref()).ok_or_else(|| self.wrong("a length, as 4 or \"4mm\""))
    }

    /// Three lengths.
    pub(super) fn lengths(&self) -> Result<DVec3, SceneError> {
        three(self.value.get_ref(), length).ok_or_else(|| self.wrong("three lengths, as [0, 0, \"12mm\"]"))
    }

    /// Three numbers.
    pub(super) fn numbers(&self) -> Result<DVec3, SceneError> {
        three(self.value.get_ref(), number).ok_or_else(|| self.wrong("three numbers, as [0, 0, 90]"))
    }

    /// Points in space.
    pub(super) fn points(&self) -> Result<Vec<DVec3>, SceneError> {
        let points = |values: &'t toml::de::DeArray<'t>| {
            values.iter().map(|value| three(value.get_ref(), length)).collect::<Option<Vec<DVec3>>>()
        };
        let wanted = "a list of points, as [[0, 0, 0], [10, 0, 5], [20, 4, 5]]";
        self.value.get_ref().as_array().and_then(points).ok_or_else(|| self.wrong(wanted))
    }
}

fn number(value: &DeValue<'_>) -> Option<f64> {
    let whole = || value.as_integer().filter(|n| n.radix() == 10).map(|n| n.as_str());
    let text = value.as_float().map(|number| number.as_str()).or_else(whole)?;
    text.replace('_', "").parse().ok().filter(|number: &f64| number.is_finite())
}

fn length(value: &DeValue<'_>) -> Option<f64> {
    number(value).or_else(|| values::length(value.as_str()?).ok())
}

fn three(value: &DeValue<'_>, read: impl Fn(&DeValue<'_>) -> Option<f64>) -> Option<DVec3> {
    let numbers: Vec<f64> =
        value.as_array()?.iter().map(|item| read(item.get_ref())).collect::<Option<_>>()?;
    <[f64; 3]>::try_from(numbers).ok().map(DVec3::from)
}
