//! How a command ends when it does not end well.

use std::process::ExitCode;

/// Why a command did not do what was asked, in a sentence for the person who asked.
#[derive(Debug, thiserror::Error)]
pub enum Failure {
    /// The input was refused or the run faulted: exit status 1.
    #[error("{0}")]
    Refused(String),
    /// The command line itself makes no sense: exit status 2.
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

/// A refusal, with the reason that the error gives.
pub(super) fn refused(reason: impl std::fmt::Display) -> Failure {
    Failure::Refused(reason.to_string())
}
