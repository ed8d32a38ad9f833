//! The geometry of a move.

use fivebar_firmware::{ARC_TOLERANCE, MoveKind};
use fivebar_kinematics::Scalar;
use fivebar_kinematics::trajectory::{PathSegment, PathSegmentError, Sense};
use nalgebra::Vector2;

/// The line or arc of a move from `from` [m]; none if it is another kind of move.
pub fn segment<S: Scalar>(
    kind: &MoveKind,
    from: [f32; 2],
) -> Option<Result<PathSegment<S>, PathSegmentError>> {
    let point = |at: [f32; 2]| Vector2::from(at.map(|value| S::from_f64(value.into())));
    match *kind {
        MoveKind::Line { to, .. } => Some(PathSegment::line(point(from), point(to))),
        MoveKind::Arc {
            to,
            center,
            clockwise,
            ..
        } => {
            let sense = if clockwise {
                Sense::Clockwise
            } else {
                Sense::CounterClockwise
            };
            let tolerance = S::from_f64(ARC_TOLERANCE.into());
            let [from, to, center] = [from, to, center].map(point);
            Some(PathSegment::arc(from, to, center, sense, tolerance))
        }
        MoveKind::Dwell { .. }
        | MoveKind::Joint { .. }
        | MoveKind::Timed(_)
        | MoveKind::Crossing(_) => None,
    }
}
