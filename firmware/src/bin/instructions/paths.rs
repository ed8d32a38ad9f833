//! Trajectory segments, as the tick evaluates them.

use fivebar_kinematics::five_bar::{Geometry, Side, Tool, WorkingMode, Workspace};
use fivebar_kinematics::trajectory::{
    Curve, Envelope, LookaheadPlanner, MotionLimits, PathSegment, Reference, Sense,
    TrajectorySegment,
};
use nalgebra::Vector2;

/// The segments on the line, the corner and the arc of a short path, in this order.
pub(crate) fn segments() -> Option<[TrajectorySegment<f32>; 3]> {
    let geometry = Geometry::new([0.12, 0.16, 0.16, 0.12, 0.10]).ok()?;
    let envelope = Envelope {
        workspace: Workspace {
            tool: Tool::new(geometry, Vector2::zeros()).ok()?,
            mode: WorkingMode::new(Side::Right, Side::Left),
            limits: None,
            margin: 0.05,
        },
        joint_speed: [30.0; 2],
        joint_acceleration: [1000.0; 2],
        torque: None,
        tool_motion: MotionLimits {
            speed: 0.2,
            acceleration: 4.0,
            jerk: 1000.0,
        },
        corner_tolerance: 1e-4,
    };
    let [a, b, c] = [[0.03, 0.16], [0.06, 0.18], [0.08, 0.18]].map(|[x, y]| Vector2::new(x, y));
    let centre = Vector2::new(0.07, 0.17);
    let line = PathSegment::line(a, b).ok()?;
    let arc = PathSegment::arc(b, c, centre, Sense::Clockwise, 1e-6).ok()?;
    let mut lookahead = LookaheadPlanner::<f32, 8>::new();
    for segment in [line, arc] {
        let motion_limits = envelope.check(&segment, 0.1).ok()?;
        lookahead.push(&segment, motion_limits, 0, &envelope).ok()?;
    }
    let mut found = [None; 3];
    while let Some(segment) = lookahead.next_segment() {
        let kind = match segment.curve()? {
            Curve::Line { .. } => 0,
            Curve::Blend { .. } => 1,
            Curve::Arc { .. } => 2,
        };
        if let Some(slot) = found.get_mut(kind) {
            *slot = Some(segment);
        }
    }
    let [line, corner, arc] = found;
    Some([line?, corner?, arc?])
}

/// The reference half-way through a segment.
#[inline(never)]
pub(crate) fn reference(segment: &TrajectorySegment<f32>) -> Reference<f32> {
    segment.evaluate(0.5 * segment.duration())
}
