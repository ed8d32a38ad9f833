//! Failures of commands and their exit statuses.

use std::process::ExitCode;

/// Why a command failed, as a sentence for the user.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Failure {
    /// The input was refused or the run faulted: exit status 1.
    #[error("{0}")]
    Refused(String),
    /// The command line is not valid: exit status 2.
    #[error("{0}")]
    Usage(String),
}

impl Failure {
    /// The process's exit status.
    pub fn exit_code(&self) -> ExitCode {
        match self {
            Self::Refused(_) => ExitCode::from(1),
            Self::Usage(_) => ExitCode::from(2),
        }
    }
}

/// A refusal with this reason.
pub(super) fn refused(reason: impl std::fmt::Display) -> Failure {
    Failure::Refused(reason.to_string())
}
