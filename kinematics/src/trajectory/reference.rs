//! The reference that the tick follows.

use nalgebra::Vector2;

/// The reference position of the arm with its derivatives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reference<S> {
    /// Of the tool.
    Tool {
        /// [m].
        position: Vector2<S>,
        /// [m/s].
        velocity: Vector2<S>,
        /// [m/s²].
        acceleration: Vector2<S>,
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
