//! The shares of speed and power that a user chooses while the arm draws.

use fivebar_firmware::{FULL_TOOL, Move, MoveKind};

/// The tag of a rapid move, by which its caller lets it follow [`Shares::rapid`].
pub const RAPID: u32 = u32::MAX;

/// The least and the greatest share of feed rates and of the tool's power.
const LIMITS: [f32; 2] = [0.1, 2.0];

/// What moves are given to the controller with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shares {
    /// Of the feed rates.
    pub feed: f32,
    /// Of the speed of moves with the tag [`RAPID`].
    pub rapid: f32,
    /// Of the tool's level.
    pub power: f32,
}

impl Shares {
    /// Everything as in the job.
    pub const WHOLE: Self = Self {
        feed: 1.0,
        rapid: 1.0,
        power: 1.0,
    };

    /// The nearest shares that are allowed. No move is faster than a rapid one at its whole speed.
    pub(super) fn limited(self) -> Self {
        let [least, greatest] = LIMITS;
        Self {
            feed: self.feed.clamp(least, greatest),
            rapid: self.rapid.clamp(least, 1.0),
            power: self.power.clamp(least, greatest),
        }
    }

    /// The share of this move's feed rate.
    pub(super) fn speed(&self, next: &Move) -> f32 {
        if next.tag == RAPID {
            self.rapid
        } else {
            self.feed
        }
    }

    /// The move at these shares.
    pub(super) fn apply(&self, next: Move) -> Move {
        let share = self.speed(&next);
        let kind = match next.kind {
            MoveKind::Line { to, feed } => MoveKind::Line {
                to,
                feed: feed * share,
            },
            MoveKind::Arc {
                to,
                center,
                clockwise,
                feed,
            } => MoveKind::Arc {
                to,
                center,
                clockwise,
                feed: feed * share,
            },
            other @ (MoveKind::Dwell { .. }
            | MoveKind::Joint { .. }
            | MoveKind::Timed(_)
            | MoveKind::Crossing(_)) => other,
        };
        let level = f32::from(next.tool) * self.power;
        let tool = level.round().min(f32::from(FULL_TOOL)) as u16;
        Move { tool, kind, ..next }
    }
}
