//! The planner's hand-over: trajectory segments to the controller, as many as it needs to
//! be able to stop on them.

use super::Planner;
use crate::controller::{Controller, PIECES, Stretch};
use crate::safety::Limits;
use fivebar_kinematics::Scalar;
use fivebar_kinematics::trajectory::{Piece, Reference};
use rtic_core::Mutex;

/// Pieces that one run hands out, unless these end in motion with hardly room for a stop.
pub const PIECES_PER_RUN: u32 = 4;

impl Planner {
    /// Hands the controller as much path as it should have. To be called at least every
    /// few milliseconds while the arm moves. The controller is not locked while a piece is
    /// planned.
    pub fn run(&mut self, controller: &mut impl Mutex<T = Controller>) {
        let mut snapshot = controller.lock(|controller| controller.planning_snapshot());
        for handed in 0..PIECES as u32 {
            self.follow(&snapshot);
            let enough = handed >= PIECES_PER_RUN && snapshot.path_is_enough;
            if enough || snapshot.path_is_full || snapshot.path_left >= self.horizon {
                break;
            }
            let Some(piece) = self.look_ahead.next_piece() else {
                break;
            };
            let slowed = self.slowed.oldest_ordered().any(|&tag| tag == piece.tag());
            let stretch = Stretch {
                piece,
                open: ends_in_motion(&piece),
                limits: Limits::NONE.with(Limits::SPEED, slowed),
            };
            let generation = self.path_generation;
            snapshot = controller.lock(|controller| {
                controller.extend_path(generation, stretch);
                controller.planning_snapshot()
            });
        }
    }
}

/// Whether another piece must follow this one: it ends with more than a rounding's speed.
fn ends_in_motion(piece: &Piece<f32>) -> bool {
    match piece.evaluate(piece.duration()) {
        Reference::Tool { velocity, .. } => velocity.norm_squared() > 1e-6,
        Reference::Joint { rates, .. } => rates.iter().any(|&rate| Scalar::abs(rate) > 1e-2),
    }
}
