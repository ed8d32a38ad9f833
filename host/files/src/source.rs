//! Errors of TOML files, with file, line, key and reason.

use super::refusal::{Key, Refusal};
use super::similar::did_you_mean;
use super::text_file::LARGEST_TOML;
use std::cell::OnceCell;
use std::fmt;
use std::ops::Range;
use toml::Spanned;
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

/// The name and text of a file, for errors with their line.
#[derive(Debug)]
pub struct Source<'a> {
    /// Its name in messages.
    pub file: &'a str,
    /// What it holds.
    pub text: &'a str,
    /// The values with their places; none of a text that is no TOML. A check of a robot asks for some hundred places, so
    /// the text is read once for all.
    document: OnceCell<Option<DeTable<'a>>>,
}

impl<'a> Source<'a> {
    /// The text of a file called `file`.
    pub fn new(file: &'a str, text: &'a str) -> Self {
        Self {
            file,
            text,
            document: OnceCell::new(),
        }
    }

    fn document(&self) -> Option<&DeTable<'a>> {
        let read = || DeTable::parse(self.text).ok().map(Spanned::into_inner);
        self.document.get_or_init(read).as_ref()
    }

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
        let mut keys = path.split('.');
        let first = self.document()?.get(keys.next()?)?;
        let value = keys.try_fold(first, |value, key| value.get_ref().as_table()?.get(key))?;
        Some(self.line(value.span().start))
    }

    /// The error for a value that can be read but is not valid.
    pub fn refuse(&self, key: Key, reason: impl fmt::Display) -> FileError {
        self.error(key.refused(reason))
    }

    /// The error for what is refused, with its line.
    pub fn error(&self, refusal: Refusal) -> FileError {
        let more = refusal.more.into_iter();
        FileError {
            file: self.file.into(),
            line: self.line_of(refusal.line_of.map_or(refusal.key, |key| *key)),
            reason: refusal.reason,
            more: more.map(|other| self.error(other)).collect(),
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
        let document = self.document()?;
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
        key_in(self.document()?, offset).map(str::to_owned)
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
