//! Why a job was not driven to its end.

use crate::run::link::LinkError;
use crate::run::simulation::fault_name;
use fivebar_firmware::planner::MoveRefusal;
use fivebar_firmware::protocol::{Refusal, SectionKey};
use fivebar_firmware::safety::Fault;
use fivebar_firmware::settings::SettingsError;

/// Why a job was not driven to its end.
#[derive(Debug, thiserror::Error)]
pub enum DriveError {
    /// The line is silent or broken.
    #[error(transparent)]
    Link(#[from] LinkError),
    /// The controller believes in another arm.
    #[error(
        "the controller's settings are not this robot's: {0:?} differ; give the robot it \
         has by --robot, or this robot's settings to it by --upload"
    )]
    OtherSettings(Vec<SectionKey>),
    /// The robot's settings make no sense.
    #[error("the robot's settings make no sense: {0}")]
    Unsound(SettingsError),
    /// The controller refused something.
    #[error("the controller refuses to {what}: {refusal}")]
    Refused {
        /// What was asked.
        what: &'static str,
        /// Why not.
        refusal: Refusal,
    },
    /// A move cannot be done.
    #[error("line {}: {_0}", _0.tag)]
    Move(#[from] MoveRefusal),
    /// A fault is latched.
    #[error(
        "the controller stopped the arm by fault {}, {}; mend the cause, then drive with \
         --clear",
        .0.number(),
        fault_name(*.0)
    )]
    Fault(Fault),
    /// The user wants it.
    #[error("stopped as asked{}; the bridges are off", at_line(*.0))]
    Stopped(Option<u32>),
    /// The switches were not found.
    #[error("the joints did not find their home switches within 60 s")]
    NeverHomed,
    /// The measured angles close no arm.
    #[error("the controller does not know where its tool is")]
    NoTool,
    /// The answer is not one to the question.
    #[error("the controller answers a move with {0}")]
    Confused(String),
}

impl DriveError {
    pub(super) fn refused(what: &'static str, refusal: Refusal) -> Self {
        Self::Refused { what, refusal }
    }
}

fn at_line(tag: Option<u32>) -> String {
    tag.map_or_else(String::new, |line| format!(" on line {line}"))
}
