//! Values that are not valid: the key of each, and why. A check of values knows no file; [`Source::error`] finds the lines.
//!
//! [`Source::error`]: super::source::Source::error

use std::fmt;

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

    /// Its value can be read but is not valid.
    pub fn refused(self, reason: impl fmt::Display) -> Refusal {
        Refusal {
            key: self,
            line_of: None,
            reason: format!("{self} {reason}"),
            more: Vec::new(),
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

/// Why a value is refused.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Refusal {
    /// Its key.
    pub(crate) key: Key,
    /// The key whose line is named, if it is another.
    pub(crate) line_of: Option<Box<Key>>,
    /// The reason, with the key.
    pub(crate) reason: String,
    /// What else is wrong with the file.
    pub(crate) more: Vec<Refusal>,
}

/// All that is wrong with a file, so that its author is told at once.
#[derive(Default)]
pub struct Refusals(Vec<Refusal>);

impl Refusals {
    /// Notes what is refused. The result is returned as it is, for the value or to give up later.
    pub fn noted<T>(&mut self, result: Result<T, Refusal>) -> Result<T, Refusal> {
        if let Err(refusal) = &result {
            self.0.push(refusal.clone());
        }
        result
    }

    /// Notes what is refused.
    pub fn note<T>(&mut self, result: Result<T, Refusal>) {
        self.0.extend(result.err());
    }

    /// Refuses the value of a key.
    pub fn add(&mut self, key: Key, reason: impl fmt::Display) {
        self.0.push(key.refused(reason));
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Whether the value of this key is refused already.
    pub fn has(&self, key: Key) -> bool {
        self.0.iter().any(|refusal| refusal.key == key)
    }

    /// Whether a value of the n-th `[[section]]`, from 0, is refused already.
    pub fn has_of(&self, section: &str, index: usize) -> bool {
        let is_there = |key| matches!(key, Key::Of(of, at, _) if of == section && at == index);
        self.0.iter().any(|refusal| is_there(refusal.key))
    }

    /// # Errors
    /// The first, with all others.
    pub fn done(self) -> Result<(), Refusal> {
        let mut refusals = self.0.into_iter();
        match refusals.next() {
            None => Ok(()),
            Some(first) => Err(Refusal {
                more: refusals.collect(),
                ..first
            }),
        }
    }
}
