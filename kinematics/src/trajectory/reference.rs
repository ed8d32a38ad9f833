//! The reference that the tick follows.

use nalgebra::Vector2;

/// The reference position of the arm with its derivatives.
///
/// ```
/// use fivebar_kinematics::nalgebra::Vector2;
/// use fivebar_kinematics::trajectory::{Reference, TrajectorySegment};
///
/// let dwell = TrajectorySegment::rest(Vector2::new(0.04, 0.18), 0.5, 0); // m, s
/// let Reference::Tool { position, velocity, .. } = dwell.evaluate(0.25) else {
///     panic!("a dwell holds the tool");
/// };
/// assert_eq!(position, Vector2::new(0.04, 0.18));
/// assert_eq!(velocity, Vector2::zeros());
/// ```
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
