//! What the tick is given to follow.

use crate::{Scalar, Vec2};

/// Where the arm should be, and how it should be moving.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reference<S> {
    /// Of the tool.
    Tool {
        /// [m].
        position: Vec2<S>,
        /// [m/s].
        velocity: Vec2<S>,
        /// [m/s²].
        acceleration: Vec2<S>,
    },
    /// Of the driven joints, θ1 and θ4.
    Joint {
        /// [rad].
        angles: [S; 2],
        /// [rad/s].
        rates: [S; 2],
        /// [rad/s²].
        accelerations: [S; 2],
    },
}

impl<S: Scalar> Reference<S> {
    /// The same place passed with the piece's clock running at `rate` σ and changing by
    /// `slope` σ̇ [1/s]: v = σ p′, a = σ² p″ + σ̇ p′.
    #[inline(always)]
    #[must_use]
    pub fn clocked(self, rate: S, slope: S) -> Self {
        let squared = rate * rate;
        match self {
            Self::Tool {
                position,
                velocity,
                acceleration,
            } => Self::Tool {
                position,
                velocity: velocity * rate,
                acceleration: acceleration * squared + velocity * slope,
            },
            Self::Joint {
                angles,
                rates: [rate1, rate4],
                accelerations: [acceleration1, acceleration4],
            } => Self::Joint {
                angles,
                rates: [rate1 * rate, rate4 * rate],
                accelerations: [
                    acceleration1 * squared + rate1 * slope,
                    acceleration4 * squared + rate4 * slope,
                ],
            },
        }
    }
}
