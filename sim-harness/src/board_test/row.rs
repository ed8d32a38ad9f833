//! A row of the report: what was measured, what it must be, and the verdict.

use serde::Serialize;

/// A row.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// What was measured.
    pub name: &'static str,
    /// The measured value, with its unit; empty if nothing was measured.
    pub measured: String,
    /// What the value must be.
    pub bound: String,
    /// Where the bound comes from.
    pub source: &'static str,
    /// The verdict.
    #[serde(flatten)]
    pub verdict: Verdict,
}

/// Whether a row is as it must be.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case", tag = "verdict")]
pub enum Verdict {
    /// It is.
    Passed,
    /// It is not.
    Failed {
        /// What is wrong.
        why: String,
        /// What to do.
        remedy: String,
    },
    /// It could not be measured.
    NotSeen {
        /// The reason.
        why: String,
        /// What to do.
        remedy: String,
    },
}

impl Verdict {
    pub(super) fn failed(why: impl Into<String>, remedy: impl Into<String>) -> Self {
        Self::Failed {
            why: why.into(),
            remedy: remedy.into(),
        }
    }

    pub(super) fn not_seen(why: impl Into<String>, remedy: impl Into<String>) -> Self {
        Self::NotSeen {
            why: why.into(),
            remedy: remedy.into(),
        }
    }

    /// Failed with this reason and remedy, unless it `holds`.
    pub(super) fn of(holds: bool, why: impl Into<String>, remedy: impl Into<String>) -> Self {
        match holds {
            true => Self::Passed,
            false => Self::failed(why, remedy),
        }
    }

    /// Whether the row has failed.
    pub fn is_failed(&self) -> bool {
        matches!(self, Self::Failed { .. })
    }

    /// The verdict in a word or two.
    pub fn word(&self) -> &'static str {
        match self {
            Self::Passed => "passed",
            Self::Failed { .. } => "failed",
            Self::NotSeen { .. } => "not seen",
        }
    }

    /// The reason and the remedy, unless it has passed.
    pub fn reason(&self) -> Option<(&str, &str)> {
        match self {
            Self::Passed => None,
            Self::Failed { why, remedy } | Self::NotSeen { why, remedy } => Some((why, remedy)),
        }
    }
}

/// What a row must be: its name, its bound and the source of that.
#[derive(Clone, Debug)]
pub(super) struct Limit {
    pub(super) name: &'static str,
    pub(super) bound: String,
    pub(super) source: &'static str,
}

impl Limit {
    pub(super) fn new(name: &'static str, bound: impl Into<String>, source: &'static str) -> Self {
        Self {
            name,
            bound: bound.into(),
            source,
        }
    }

    /// The row of a measured value.
    pub(super) fn row(self, measured: impl Into<String>, verdict: Verdict) -> Row {
        Row {
            name: self.name,
            measured: measured.into(),
            bound: self.bound,
            source: self.source,
            verdict,
        }
    }

    /// The row of what was not measured.
    pub(super) fn not_seen(self, why: &str, remedy: &str) -> Row {
        self.row("", Verdict::not_seen(why, remedy))
    }
}
