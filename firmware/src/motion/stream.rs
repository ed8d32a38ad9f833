//! A stream of set-points: how it begins, and its points.

use serde::{Deserialize, Serialize};

/// What the points of a stream say.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum StreamMode {
    /// θ1, θ4 [rad] and their velocities [rad/s].
    Joint,
    /// x, y of the tool in the frame of the base [m] and its velocity [m/s].
    Tip,
    /// Nothing: a hand leads the arm, and its points are the host's signs of life.
    Free,
}

/// How a stream of set-points begins, where the arm is held.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct StreamConfig {
    /// The host's number for the stream: each point repeats it, so a late point of another stream is not taken.
    pub id: u32,
    /// What its points say.
    pub mode: StreamMode,
    /// Ticks from one point to the next.
    pub period: u16,
    /// Ticks from the time at which the host makes a point to the tick in which it is due.
    pub delay: u16,
}

/// A set-point. Between two of them each coordinate is the cubic by their positions and velocities.
// Pairs in place of arrays, so that a message is copied without a call in the interrupt that receives it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct StreamPoint {
    /// The number of its stream.
    pub id: u32,
    /// The controller's tick in which the set-point is there.
    pub due: u32,
    /// θ1, θ4 [rad] or x, y [m]; those of the mode Free mean nothing.
    pub position: (f32, f32),
    /// Its velocity [rad/s or m/s].
    pub velocity: (f32, f32),
}
