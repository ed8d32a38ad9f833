//! Errors of TOML files, with file, line, key and reason.

use super::similar::did_you_mean;
use super::text_file::LARGEST_TOML;
use std::fmt;
use std::ops::Range;
use toml::de::{DeTable, DeValue};

/// Why a file is refused.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "{file}{}: {reason}{}",
    line.map(|line| format!(", line {line}")).unwrap_or_default(),
    more.iter().map(|other| format!("\n{other}")).collect::<String>()
)]
pub struct FileError {
    /// The file, as the user named it.
    pub file: String,
    /// The line of the error, from 1.
    pub line: Option<usize>,
    /// The reason, with the key.
    pub reason: String,
    /// What else is wrong with the file.
    pub more: Vec<FileError>,
}

impl FileError {
    /// The error of a whole file, for `reason`.
    pub fn new(file: impl fmt::Display, reason: impl fmt::Display) -> Self {
        Self {
            file: file.to_string(),
            line: None,
            reason: reason.to_string(),
            more: Vec::new(),
        }
    }
}

/// All that is wrong with a file, so that its author is told at once.
#[derive(Default)]
pub struct Refusals(Vec<FileError>);

impl Refusals {
    /// Notes what is refused. The result is returned as it is, for the value or to give up later.
    pub fn noted<T>(&mut self, result: Result<T, FileError>) -> Result<T, FileError> {
        if let Err(error) = &result {
            self.0.push(error.clone());
        }
        result
    }

    /// Notes what is refused.
    pub fn check<T>(&mut self, result: Result<T, FileError>) {
        self.0.extend(result.err());
    }

    /// Adds one.
    pub fn add(&mut self, error: FileError) {
        self.0.push(error);
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Whether the value of this key is refused already.
    pub fn has(&self, key: Key) -> bool {
        let key = key.to_string();
        self.0.iter().any(|error| error.reason.starts_with(&key))
    }

    /// Whether a value of the n-th `[[section]]`, from 0, is refused already.
    pub fn has_of(&self, section: &str, index: usize) -> bool {
        let section = format!(" of [[{section}]] {} ", index + 1);
        self.0.iter().any(|error| error.reason.contains(&section))
    }

    /// # Errors
    /// The first, with all others.
    pub fn done(self) -> Result<(), FileError> {
        let mut errors = self.0.into_iter();
        match errors.next() {
            None => Ok(()),
            Some(first) => Err(FileError {
                more: errors.collect(),
                ..first
            }),
        }
    }
}

/// The key of a value in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Key {
    /// A key of the file itself.
    Top(&'static str),
    /// A key of `[section]`.
    In(&'static str, &'static str),
    /// A key of the n-th `[[section]]`, from 0.
    Of(&'static str, usize, &'static str),
}

impl Key {
    /// Its name within its section.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Top(name) | Self::In(_, name) | Self::Of(_, _, name) => name,
        }
    }
}

impl fmt::Display for Key {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Top(key) => write!(f, "`{key}`"),
            Self::In(section, key) => write!(f, "`{key}` of [{section}]"),
            Self::Of(section, index, key) => write!(f, "`{key}` of [[{section}]] {}", index + 1),
        }
    }
}

/// The name and text of a file, for errors with their line.
#[derive(Clone, Copy, Debug)]
pub struct Source<'a> {
    /// Its name in messages.
    pub file: &'a str,
    /// What it holds.
    pub text: &'a str,
}

impl<'a> Source<'a> {
    /// Reads the file's keys into `T`.
    pub fn parse<T: serde::de::DeserializeOwned>(&self) -> Result<T, FileError> {
        let size = self.text.len() as u64;
        if size > LARGEST_TOML {
            let reason = format_args!("it has {size} bytes; at most {LARGEST_TOML} are read");
            return Err(FileError::new(self.file, reason));
        }
        let refused = |error: toml::de::Error, reason: &str| {
            let reason = reason
                .trim_end()
                .replace('\n', ", ")
                .replace("expected f64", "expected a number")
                .replace("expected u32", "expected a whole number");
            let reason = match unknown_field(&reason) {
                Some((name, known)) => reason.clone() + &did_you_mean(name, known),
                None => reason,
            };
            let start = error.span().map(|span| span.start);
            let key = start.and_then(|start| self.key_at(start));
            FileError {
                file: self.file.into(),
                line: start.map(|start| self.line(start)),
                reason: match key {
                    Some(key) => format!("`{key}`: {reason}"),
                    None => reason,
                },
                more: Vec::new(),
            }
        };
        // A table of values refuses the third of three numbers for a pair, but its errors have no
        // line. What reads the text itself gives the line, but drops the third number.
        let table = toml::from_str::<toml::Table>(self.text);
        table.and_then(toml::Table::try_into).map_err(|error| {
            if let Err(error) = toml::from_str::<T>(self.text) {
                let reason = error.message().to_owned();
                return refused(error, &reason);
            }
            let reason = error.to_string();
            let line = self.line_of_path(&reason);
            FileError {
                line,
                ..refused(error, &reason)
            }
        })
    }

    /// Reads the keys of a file that is no robot file; one that is gets its own error, with what
    /// takes it.
    pub fn parse_no_robot<T: serde::de::DeserializeOwned>(
        &self,
        what: &str,
    ) -> Result<T, FileError> {
        self.parse().map_err(|error| {
            let table = toml::from_str::<toml::Table>(self.text);
            let is_robot = table.is_ok_and(|it| it.contains_key("link") && it.contains_key("base"));
            match is_robot {
                false => error,
                true => FileError::new(
                    self.file,
                    format_args!(
                        "this is a robot file, not {what}: give it with --robot to sim, workspace, \
                         accuracy or margins"
                    ),
                ),
            }
        })
    }

    /// The line of the value that an error names at its end: "…in `mismatch.stiffness`".
    fn line_of_path(&self, reason: &str) -> Option<usize> {
        let (_, path) = reason.trim_end().strip_suffix('`')?.rsplit_once('`')?;
        let document = DeTable::parse(self.text).ok()?;
        let mut keys = path.split('.');
        let first = document.get_ref().get(keys.next()?)?;
        let value = keys.try_fold(first, |value, key| value.get_ref().as_table()?.get(key))?;
        Some(self.line(value.span().start))
    }

    /// The error for a value that can be read but is not valid.
    pub fn refuse(&self, key: Key, reason: impl fmt::Display) -> FileError {
        FileError {
            file: self.file.into(),
            line: self.line_of(key),
            reason: format!("{key} {reason}"),
            more: Vec::new(),
        }
    }

    /// The number of a key, also as it is written: of a list, the one at `index`.
    pub fn number_of(&self, key: Key, index: usize) -> Option<(f64, String)> {
        let document: toml::Table = self.text.parse().ok()?;
        let value = match key {
            Key::Top(name) => document.get(name)?,
            Key::In(section, name) => document.get(section)?.get(name)?,
            Key::Of(section, index, name) => document.get(section)?.get(index)?.get(name)?,
        };
        let value = value
            .as_array()
            .map_or(Some(value), |items| items.get(index))?;
        match *value {
            toml::Value::Integer(number) => Some((number as f64, number.to_string())),
            toml::Value::Float(number) => Some((number, format!("{number:?}"))),
            _ => None,
        }
    }

    /// Whether the file has a value for a key.
    pub fn holds(&self, key: Key) -> bool {
        self.span_of(key).is_some()
    }

    /// The line of a key's value, or of the section that should hold it.
    pub fn line_of(&self, key: Key) -> Option<usize> {
        self.place_of(key).map(|(span, _)| self.line(span.start))
    }

    /// The bytes of a key's value; none if the file has no value for it.
    pub fn span_of(&self, key: Key) -> Option<Range<usize>> {
        let (span, held) = self.place_of(key)?;
        held.then_some(span)
    }

    /// The bytes of a key's value, and true; without a value, those of its section, and false.
    fn place_of(&self, key: Key) -> Option<(Range<usize>, bool)> {
        let document = DeTable::parse(self.text).ok()?;
        let document = document.get_ref();
        let (section, name) = match key {
            Key::Top(name) => return Some((document.get(name)?.span(), true)),
            Key::In(section, name) => (document.get(section)?, name),
            Key::Of(section, index, name) => {
                let items = document.get(section)?.get_ref().as_array()?;
                (items.get(index)?, name)
            }
        };
        let held = section.get_ref().as_table().and_then(|it| it.get(name));
        Some(match held {
            Some(value) => (value.span(), true),
            None => (section.span(), false),
        })
    }

    /// The key whose value lies at `offset`.
    fn key_at(&self, offset: usize) -> Option<String> {
        let document = DeTable::parse(self.text).ok()?;
        key_in(document.get_ref(), offset).map(str::to_owned)
    }

    fn line(&self, offset: usize) -> usize {
        let before = self.text.as_bytes().iter().take(offset);
        1 + before.filter(|&&byte| byte == b'\n').count()
    }
}

/// The unknown key and the known ones, of "unknown field `a`, expected `b`" or "… one of `b`, `c`".
fn unknown_field(reason: &str) -> Option<(&str, Vec<&str>)> {
    let (_, rest) = reason.split_once("unknown field `")?;
    let (name, rest) = rest.split_once('`')?;
    let known = rest.split('`').skip(1).step_by(2).collect();
    Some((name, known))
}

/// The key of a table, or of a table within it, whose value lies at `offset`.
fn key_in<'d>(table: &'d DeTable<'_>, offset: usize) -> Option<&'d str> {
    table.iter().find_map(|(key, value)| match value.get_ref() {
        DeValue::Table(inner) => key_in(inner, offset),
        DeValue::Array(items) if items.iter().any(|item| item.get_ref().is_table()) => items
            .iter()
            .filter_map(|item| item.get_ref().as_table())
            .find_map(|inner| key_in(inner, offset))
            // An error at a whole inline table is one of the list's key.
            .or_else(|| {
                let starts = items.iter().any(|item| item.span().start == offset);
                starts.then(|| key.get_ref().as_ref())
            }),
        _ => value
            .span()
            .contains(&offset)
            .then(|| key.get_ref().as_ref()),
    })
}
