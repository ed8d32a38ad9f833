//! Pieces of path, as the tick evaluates them.

use fivebar_kinematics::PlanarVector;
use fivebar_kinematics::five_bar::{Geometry, Side, Tool, WorkingMode, Workspace};
use fivebar_kinematics::trajectory::{
    Caps, Curve, Envelope, LookAhead, Piece, Reference, Segment, Sense,
};
use nalgebra::Vector2;

/// The pieces on the line, the corner and the arc of a short path, in this order.
pub(crate) fn pieces() -> Option<[Piece<f32>; 3]> {
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
        tool_motion: Caps {
            speed: 0.2,
            acceleration: 4.0,
            jerk: 1000.0,
        },
        corner_tolerance: 1e-4,
    };
    let [a, b, c] = [[0.03, 0.16], [0.06, 0.18], [0.08, 0.18]].map(|[x, y]| Vector2::new(x, y));
    let centre = Vector2::new(0.07, 0.17);
    let line = Segment::line(a, b).ok()?;
    let arc = Segment::arc(b, c, centre, Sense::Clockwise, 1e-6).ok()?;
    let mut look_ahead = LookAhead::<f32, 8>::new();
    for segment in [line, arc] {
        let caps = envelope.admit(&segment, 0.1).ok()?;
        look_ahead.push(&segment, caps, 0, &envelope).ok()?;
    }
    let mut found = [None; 3];
    while let Some(piece) = look_ahead.next_piece() {
        let kind = match piece.curve()? {
            Curve::Line { .. } => 0,
            Curve::Blend { .. } => 1,
            Curve::Arc { .. } => 2,
        };
        if let Some(slot) = found.get_mut(kind) {
            *slot = Some(piece);
        }
    }
    let [line, corner, arc] = found;
    Some([line?, corner?, arc?])
}

/// The reference half-way through a piece.
#[inline(never)]
pub(crate) fn reference(piece: &Piece<f32>) -> Reference<f32> {
    piece.evaluate(0.5 * piece.duration())
}
