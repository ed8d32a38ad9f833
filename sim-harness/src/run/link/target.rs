//! What a run needs of a controller.

use super::LinkError;
use fivebar_firmware::controller::{Refusal, Request};
use fivebar_firmware::planner::MoveRefusal;
use fivebar_firmware::{Command, Move, Sensed, Status};

/// A controller, run in lockstep with a plant.
///
/// What it answers depends on nothing but what it was told and in which order, so that two
/// targets told the same give the same bits.
pub trait Target {
    /// Hands over one tick's samples; the bridges' command and the state after the tick.
    ///
    /// # Errors
    /// The other end does not answer.
    fn tick(&mut self, sensed: &Sensed) -> Result<(Command, Status), TargetError>;

    /// Asks for something other than a move.
    ///
    /// # Errors
    /// The controller refuses it, or does not answer.
    fn request(&mut self, request: Request) -> Result<(), TargetError>;

    /// Offers the next move of the job. False if there is no room for it yet.
    ///
    /// # Errors
    /// The move cannot be done from where the last one ends, or there is no answer.
    fn offer(&mut self, next: &Move) -> Result<bool, TargetError>;

    /// Whether all moves taken have been done and the arm holds still.
    fn is_idle(&self) -> bool;
}

/// What a target could not do.
#[derive(Debug, thiserror::Error)]
pub enum TargetError {
    /// The controller refused a request.
    #[error("the controller refuses to {request:?}: {refusal:?}")]
    Request {
        /// What was asked.
        request: Request,
        /// Why not.
        refusal: Refusal,
    },
    /// The controller refused a move.
    #[error("line {}: {_0}", _0.tag)]
    Move(MoveRefusal),
    /// There is no answer.
    #[error(transparent)]
    Link(#[from] LinkError),
    /// The answer is not one to the question.
    #[error("the controller answers a question of the run with {0}")]
    Unexpected(String),
    /// A joint did not find its home switch in time.
    #[error(
        "the joints did not find their home switches within {0} s; they look for them at 2 % of \
         the lesser `max_speed` of [limits]"
    )]
    NeverHomed(f64),
    /// Whoever began the run wants it no longer.
    #[error("the run was interrupted")]
    Interrupted,
}
