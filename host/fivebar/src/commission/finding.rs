//! What ends a step early.

use fivebar_firmware::safety::Fault;
use fivebar_sim::drive::DriveError;
use fivebar_sim::link::LinkError;
use fivebar_sim::simulation::fault_name;
use std::fmt::Display;

/// Why a step did not end well.
#[derive(Debug, thiserror::Error)]
pub(crate) enum StepError {
    /// Something is wrong with the arm.
    #[error("{wrong}.\nTo do: {change}.")]
    Wrong {
        /// What is wrong, and where.
        wrong: String,
        /// What to change.
        change: String,
    },
    /// The controller latched a fault.
    #[error(
        "the controller latched fault {}, {}.\nTo do: look it up in docs/use/faults.md, remove its \
         cause, and run the same command again.",
        .0.number(), fault_name(*.0)
    )]
    Fault(Fault),
    /// The connection failed.
    #[error(transparent)]
    Link(#[from] LinkError),
    /// Homing or a job failed.
    #[error(transparent)]
    Drive(#[from] DriveError),
    /// Anything else.
    #[error("{0}")]
    Other(String),
}

impl StepError {
    /// Something is wrong with the arm.
    pub(crate) fn wrong(wrong: impl Display, change: impl Display) -> Self {
        Self::Wrong {
            wrong: wrong.to_string(),
            change: change.to_string(),
        }
    }

    /// Anything that has a text.
    pub(crate) fn other(error: impl Display) -> Self {
        Self::Other(error.to_string())
    }
}
