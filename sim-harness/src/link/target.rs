//! What a run needs from a controller.

use super::LinkError;
use fivebar_firmware::controller::{Request, RequestError};
use fivebar_firmware::drives::{BrushedDrives, DriveInterface};
use fivebar_firmware::planner::MoveError;
use fivebar_firmware::{ArmCommand, ArmSample, Move, Status};

/// A controller with this interface to its drives, run in lockstep with a plant.
///
/// Its outputs depend only on its inputs and their order: two targets with the same inputs
/// give the same bits.
pub trait Target<I: DriveInterface = BrushedDrives> {
    /// Runs one tick on these samples; returns its outputs and the status after it.
    ///
    /// # Errors
    /// The controller does not reply.
    fn tick(
        &mut self,
        sample: &ArmSample<I::Sample>,
    ) -> Result<(ArmCommand<I::Command>, Status), TargetError>;

    /// Makes a request of the controller.
    ///
    /// # Errors
    /// The controller refuses it or does not reply.
    fn request(&mut self, request: Request) -> Result<(), TargetError>;

    /// Offers the next move of the job. False if the controller has no room for it yet.
    ///
    /// # Errors
    /// The move cannot be done from the end of the last one, or the controller does not
    /// reply.
    fn offer(&mut self, next: &Move) -> Result<bool, TargetError>;

    /// Whether all accepted moves are done and the arm holds its position.
    fn is_idle(&self) -> bool;
}

/// Why a run cannot go on.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TargetError {
    /// The controller refused a request.
    #[error("the controller refuses to {request:?}: {error:?}")]
    Request {
        /// The request.
        request: Request,
        /// The reason.
        error: RequestError,
    },
    /// The controller refused a move.
    #[error("line {}: {_0}", _0.tag)]
    Move(MoveError),
    /// The controller did not reply.
    #[error(transparent)]
    Link(#[from] LinkError),
    /// The reply does not belong to the command.
    #[error("the controller sent an unexpected reply: {0}")]
    Unexpected(String),
    /// A joint did not find its home switch in time.
    #[error(
        "the joints did not find their home switches within {0} s; they search at 2 % of the \
         lower `max_speed` of [limits]"
    )]
    NeverHomed(f64),
    /// The arm stands, and its moves are not done.
    #[error(
        "the arm has stood still for {0:.0} s, and its moves are not done: the controller does not begin them"
    )]
    NeverDone(f64),
    /// The user interrupted the run.
    #[error("the run was interrupted")]
    Interrupted,
}
