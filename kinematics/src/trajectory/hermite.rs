//! A piece of motion between two points with their velocities: the cubic of Hermite.
//!
//! r(u) = p + T v u + (3Δ − T(2v + w)) u² + (T(v + w) − 2Δ) u³, u = t/T, Δ = q − p: at p with v, T later at q with w.

use super::curve::Curve;
use super::trajectory_segment::{TimeLaw, ToolOutput, TrajectorySegment};
use crate::{PlanarVector, Scalar};
use nalgebra::Vector2;

/// The least length of a piece's curve [m]: where nothing moves, its parameter still goes on.
const LEAST: f64 = 1e-6;

/// A place of the tool [m] and its velocity there [m/s].
///
/// ```
/// use fivebar_kinematics::nalgebra::Vector2;
/// use fivebar_kinematics::trajectory::{Reference, ToolMotion, ToolOutput, TrajectorySegment};
///
/// // 1 mm in 10 ms, from rest to 0.2 m/s.
/// let begin = ToolMotion { position: Vector2::new(0.04_f64, 0.18), velocity: Vector2::zeros() };
/// let end = ToolMotion { position: Vector2::new(0.041, 0.18), velocity: Vector2::new(0.2, 0.0) };
/// let piece = TrajectorySegment::between(&begin, &end, 0.01, 0, ToolOutput::constant(0.0));
/// let Reference::Tool { position, velocity, .. } = piece.evaluate(0.01) else { panic!("the tool") };
/// assert!((position - end.position).norm() < 1e-15 && (velocity - end.velocity).norm() < 1e-15);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToolMotion<S> {
    /// [m].
    pub position: Vector2<S>,
    /// [m/s].
    pub velocity: Vector2<S>,
}

impl<S: Scalar> TrajectorySegment<S> {
    /// The tool from one place and velocity to another in `duration` [s], which is positive. Its acceleration is a straight
    /// line over the time, so it jumps between two such pieces.
    pub fn between(
        from: &ToolMotion<S>,
        to: &ToolMotion<S>,
        duration: S,
        tag: u32,
        tool: ToolOutput<S>,
    ) -> Self {
        let three = S::from_f64(3.0);
        let displacement = to.position - from.position;
        let [begins, ends] = [from.velocity * duration, to.velocity * duration];
        let c2 = displacement * three - begins * S::TWO - ends;
        let c3 = begins + ends - displacement * S::TWO;
        // No shorter than the motion: |dr/du| ≤ |c₁| + 2|c₂| + 3|c₃|.
        let length =
            begins.length() + c2.length() * S::TWO + c3.length() * three + S::from_f64(LEAST);
        let nothing = Vector2::zeros();
        let curve = Curve::Blend {
            coefficients: [from.position, begins, c2, c3, nothing, nothing],
            inverse_length: S::ONE / length,
        };
        let law = TimeLaw::new(S::ZERO, length / duration, S::ZERO, S::ZERO);
        Self::along(curve, law, duration, tag, tool)
    }
}
