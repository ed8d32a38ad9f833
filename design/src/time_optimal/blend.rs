//! Corners between lines, replaced by arcs.
//!
//! An arc of radius r tangent to both lines of a corner that turns by φ begins d = r tan(φ/2)
//! before it and passes it at r (1/cos(φ/2) − 1), the tolerance.

use super::path::PathPiece;
use fivebar_kinematics::PlanarVector;
use std::f64::consts::PI;

/// Turns nearer to 0 or to a reversal are left as they are [rad].
const LEAST_TURN: f64 = 1e-6;

/// The path with an arc at each corner between two lines, within `tolerance` [m] of it. An arc
/// takes half of either line at most. Corners of other pieces, and reversals, stay.
pub fn blend(pieces: &[PathPiece], tolerance: f64) -> Vec<PathPiece> {
    let mut blended: Vec<PathPiece> = Vec::with_capacity(2 * pieces.len());
    for (n, piece) in pieces.iter().enumerate() {
        let mut piece = piece.clone();
        if n > 0
            && let Some((arc, d)) = corner(&pieces[n - 1], &piece, tolerance)
        {
            if let Some(PathPiece::Line { from, to }) = blended.last_mut() {
                *to -= (*to - *from).normalize() * d;
            }
            blended.push(arc);
            if let PathPiece::Line { from, to } = &mut piece {
                *from += (*to - *from).normalize() * d;
            }
        }
        blended.push(piece);
    }
    blended.retain(|piece| piece.length() > 1e-12);
    blended
}

/// The arc between two lines, and how far from the corner it begins.
fn corner(before: &PathPiece, after: &PathPiece, tolerance: f64) -> Option<(PathPiece, f64)> {
    let (PathPiece::Line { from, to: at }, PathPiece::Line { to, .. }) = (before, after) else {
        return None;
    };
    let available = 0.5 * before.length().min(after.length());
    if available <= 0.0 {
        return None;
    }
    let (u, v) = ((at - from).normalize(), (to - at).normalize());
    let turn = u.cross_z(v).atan2(u.dot(&v));
    if turn.abs() < LEAST_TURN || turn.abs() > PI - LEAST_TURN {
        return None;
    }
    let half = 0.5 * turn.abs();
    let d = (tolerance / (1.0 / half.cos() - 1.0) * half.tan()).min(available);
    let radius = d / half.tan();
    let inward = u.perpendicular() * turn.signum();
    let arc = PathPiece::Arc {
        centre: at - u * d + inward * radius,
        radius,
        start: (-inward).polar_angle(),
        sweep: turn,
    };
    Some((arc, d))
}
