//! The moves that a host can ask for: in the protocol and in the planner's queue.

use serde::{Deserialize, Serialize};

/// The level of a tool that is down, or at full power.
pub const FULL_TOOL: u16 = u16::MAX;

/// One move. It starts where the move before it ends.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Move {
    /// The host's number for this move, such as a line of a job. It is repeated in the status
    /// and in errors.
    pub tag: u32,
    /// The level of the tool during the move: 0 is up or off, [`FULL_TOOL`] is down or full power.
    /// It changes where the move begins.
    pub tool: u16,
    /// What to do.
    pub kind: MoveKind,
}

/// The kinds of move. Positions are of the tool in the frame of the base [m].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum MoveKind {
    /// Straight to a point.
    Line {
        /// The end [m].
        to: [f32; 2],
        /// Speed along the path [m/s]; the limits may slow it.
        feed: f32,
    },
    /// Along a circle; a full turn if the end is the start.
    Arc {
        /// The end [m].
        to: [f32; 2],
        /// The circle's centre [m].
        center: [f32; 2],
        /// The sense of rotation.
        clockwise: bool,
        /// Speed along the path [m/s]; the limits may slow it.
        feed: f32,
    },
    /// Stand still.
    Dwell {
        /// For how long [s].
        duration: f32,
    },
    /// Both driven joints straight to their angles; both arrive at the same time.
    Joint {
        /// θ1, θ4 [rad].
        to: [f32; 2],
        /// Share of the joints' greatest speed, 0 to 1.
        speed: f32,
    },
}
