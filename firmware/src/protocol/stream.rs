//! What the controller tells of a stream of set-points while it lasts.

use crate::planner::StreamProgress;
use serde::{Deserialize, Serialize};

/// A stream and the joints after a tick. Pairs are of joint 1 and joint 4.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct StreamState {
    /// Ticks since the reset.
    pub tick: u32,
    /// What the stream has done.
    pub progress: StreamProgress,
    /// Ticks until its last point is due; less than 0 if it was due, 0 at rest.
    pub buffered: i16,
    /// Measured [rad].
    pub angle: [f32; 2],
    /// Estimated [rad/s].
    pub velocity: [f32; 2],
    /// Demanded [N·m].
    pub torque: [f32; 2],
}
