//! A stream of set-points: how it begins, and its points.

use super::Impedance;
use serde::{Deserialize, Serialize};

/// What the points of a stream say.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum StreamMode {
    /// θ1, θ4 [rad] and their velocities [rad/s].
    Joint,
    /// x, y of the tool in the frame of the base [m] and its velocity [m/s].
    Tip,
    /// Nothing: a hand leads the arm, and its points are the host's signs of life.
    Free,
    /// The other end of a spring and a damper at the tool: x, y in the frame of the base [m] and its velocity [m/s], and a force [N].
    Impedance(Impedance),
}

impl StreamMode {
    /// Whether the arm gives way to forces.
    pub(crate) fn gives_way(&self) -> bool {
        match self {
            Self::Joint | Self::Tip => false,
            Self::Free | Self::Impedance(_) => true,
        }
    }

    /// Whether it renders springs at its points.
    pub(crate) fn renders(&self) -> bool {
        matches!(self, Self::Impedance(_))
    }
}

/// What becomes of a stream of the joints or the tip with a point that a limit keeps the arm from.
// Four bytes: a message with an odd one is copied by a call in the interrupt that receives it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[repr(u32)]
pub enum StreamPolicy {
    /// The arm stops before it, and the stream ends.
    #[default]
    Stop,
    /// The arm goes towards it as fast as its limits let it, and the stream goes on.
    Limit,
}

/// How a stream of set-points begins, where the arm is held.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
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
    /// What becomes of it with a point beyond a limit.
    pub policy: StreamPolicy,
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
    /// A force on the tool in the frame of the base [N], in the mode Joint torques on the joints [N·m]: what the motors give besides
    /// those of the motion. In the modes Joint and Tip it passes evenly from one point's to the next's, and NaN is 0.
    pub force: (f32, f32),
}

impl StreamPoint {
    /// With the force of the model alone where it says none.
    pub(crate) fn with_known_force(self) -> Self {
        let known = |force: f32| if force.is_nan() { 0.0 } else { force };
        let force = (known(self.force.0), known(self.force.1));
        Self { force, ..self }
    }

    /// Whether all its numbers are finite.
    pub(crate) fn is_finite(&self) -> bool {
        [self.position, self.velocity, self.force]
            .into_iter()
            .all(|(first, second)| first.is_finite() && second.is_finite())
    }
}
