//! Why a job was not driven to its end.

use crate::link::LinkError;
use crate::simulation::fault_name;
use crate::time_optimal::TimeOptimalError;
use fivebar_files::scenario::RefusedModeChange;
use fivebar_firmware::planner::MoveError;
use fivebar_firmware::planner::StreamReason;
use fivebar_firmware::protocol::{CommandError, SectionKey};
use fivebar_firmware::safety::{Fault, State};
use fivebar_firmware::settings::SettingsError;

/// Why a job was not driven to its end.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DriveError {
    /// The controller is silent or the connection failed.
    #[error(transparent)]
    Link(#[from] LinkError),
    /// The controller has settings for another arm.
    #[error(
        "the controller's settings differ from this robot's in {0:?}; choose the controller's \
         robot with --robot, or store this robot's settings with --upload"
    )]
    OtherSettings(Vec<SectionKey>),
    /// The robot's settings are not valid.
    #[error("the robot's settings are not valid: {0}")]
    Settings(SettingsError),
    /// The controller refused a command.
    #[error("the controller refuses to {what}: {error}")]
    Refused {
        /// The action that was requested.
        what: &'static str,
        /// The reason.
        error: CommandError,
    },
    /// A move cannot be done.
    #[error("line {}: {_0}", _0.tag)]
    Move(#[from] MoveError),
    /// The working mode cannot be changed as the job asks for.
    #[error(transparent)]
    ModeChange(#[from] RefusedModeChange),
    /// The job cannot be planned time-optimally.
    #[error(transparent)]
    TimeOptimal(#[from] TimeOptimalError),
    /// A stream of set-points has ended before its program ended it.
    #[error("the stream has ended: {0}")]
    Stream(StreamReason),
    /// A fault is latched.
    #[error(
        "the controller stopped the arm with fault {}, {}; repair the cause, then drive with \
         --clear",
        .0.number(),
        fault_name(*.0)
    )]
    Fault(Fault),
    /// The user stopped the job.
    #[error("stopped by the user{}; the bridges are off", at_line(*.0))]
    Stopped(Option<u32>),
    /// A pause waits for a key, and the input is closed.
    #[error("the job waits for Enter ({0}), but its input is closed; run it in a terminal")]
    NoInput(String),
    /// Homing did not find the switches.
    #[error("the joints did not find their home switches within 60 s")]
    NeverHomed,
    /// The arm stands in this state, and its moves are not done.
    #[error(
        "the arm has stood still for 10 s, and its moves are not done: the controller is {_0:?}; let no other program command it"
    )]
    NeverDone(State),
    /// The place of the arm is not known.
    #[error("the joint angles are unknown: home first")]
    NotHomed,
    /// No pose on the branch has the measured angles.
    #[error(
        "no pose on the arm's branch has the measured joint angles, so the position of the tool \
         is unknown; home the arm again"
    )]
    NoTool,
    /// The reply does not belong to the command.
    #[error("the controller replied to a move with {0}, which is no reply to it")]
    UnexpectedReply(String),
}

impl DriveError {
    pub(super) fn refused(what: &'static str, error: CommandError) -> Self {
        Self::Refused { what, error }
    }
}

fn at_line(tag: Option<u32>) -> String {
    tag.map_or_else(String::new, |line| format!(" on line {line}"))
}
