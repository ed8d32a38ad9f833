//! The centre of an arc, from I and J or from R.

use super::GcodeError;
use std::f64::consts::TAU;

/// Greatest difference of the two radii of an arc, as a share of the radius [1] and as a
/// length [m]: files have two or three decimals of a millimetre.
const RADIUS_SHARE: f64 = 1e-3;
const RADIUS_LENGTH: f64 = 2e-5;
/// Points that are nearer to each other are one [m]: the controller's f32 rounds by less.
const SAME_POINT: f64 = 1e-7;

/// The centre of the arc from `start` to `end` [m], from I and J.
///
/// Rounding in the file makes the distances from the centre to start and end slightly
/// different. The centre is moved along the chord to the point at which they are equal.
pub(super) fn center_by_offset(
    start: [f64; 2],
    end: [f64; 2],
    offset: [f64; 2],
) -> Result<[f64; 2], GcodeError> {
    let center = [start[0] + offset[0], start[1] + offset[1]];
    let radius = offset[0].hypot(offset[1]);
    if radius == 0.0 {
        return Err(GcodeError::ArcRadius);
    }
    let end_radius = (end[0] - center[0]).hypot(end[1] - center[1]);
    if (radius - end_radius).abs() > RADIUS_LENGTH.max(RADIUS_SHARE * radius) {
        return Err(GcodeError::ArcEnds(1e3 * radius, 1e3 * end_radius));
    }
    let chord = [end[0] - start[0], end[1] - start[1]];
    let chord_squared = chord[0] * chord[0] + chord[1] * chord[1];
    if chord_squared == 0.0 {
        return Ok(center);
    }
    let middle = [0.5 * (start[0] + end[0]), 0.5 * (start[1] + end[1])];
    let along =
        ((middle[0] - center[0]) * chord[0] + (middle[1] - center[1]) * chord[1]) / chord_squared;
    Ok([center[0] + along * chord[0], center[1] + along * chord[1]])
}

/// The centre of the arc from `start` to `end` [m], from R: the arc is at most half a turn
/// if R is positive, and more if R is negative.
pub(super) fn center_by_radius(
    start: [f64; 2],
    end: [f64; 2],
    radius: f64,
    clockwise: bool,
) -> Result<[f64; 2], GcodeError> {
    if radius == 0.0 {
        return Err(GcodeError::ArcRadius);
    }
    let chord = [end[0] - start[0], end[1] - start[1]];
    let half = 0.5 * chord[0].hypot(chord[1]);
    let height_squared = radius * radius - half * half;
    // With rounded numbers, the radius of a half circle may be slightly too small.
    if half == 0.0 || height_squared < -RADIUS_SHARE * radius * radius {
        return Err(GcodeError::ArcChord);
    }
    let height = height_squared.max(0.0).sqrt() / (2.0 * half);
    // For a counter-clockwise arc of less than half a turn, the centre lies left of the chord.
    let left = if clockwise == (radius < 0.0) {
        height
    } else {
        -height
    };
    Ok([
        0.5 * (start[0] + end[0]) - left * chord[1],
        0.5 * (start[1] + end[1]) + left * chord[0],
    ])
}

/// Whether the end of an arc is less than `shortest` [m] ahead of its start. Such an arc is
/// no motion, and rounding could make a full turn of it.
pub(super) fn is_negligible(
    start: [f64; 2],
    end: [f64; 2],
    center: [f64; 2],
    clockwise: bool,
    shortest: f64,
) -> bool {
    let chord = [end[0] - start[0], end[1] - start[1]];
    let radius = [start[0] - center[0], start[1] - center[1]];
    let ahead = radius[0] * chord[1] - radius[1] * chord[0];
    let ahead = if clockwise { -ahead } else { ahead };
    chord[0].hypot(chord[1]) < shortest && ahead > 0.0
}

/// The radius of an arc [m] and the angle that it sweeps, 0…2π [rad]. It is a full turn if the end
/// is at the start.
pub fn sweep(start: [f64; 2], end: [f64; 2], center: [f64; 2], clockwise: bool) -> (f64, f64) {
    let radius = (start[0] - center[0]).hypot(start[1] - center[1]);
    if (end[0] - start[0]).hypot(end[1] - start[1]) < SAME_POINT {
        return (radius, TAU);
    }
    (radius, angle_between(start, end, center, clockwise))
}

/// The angle from one point about `center` to another in the arc's sense, in 0…2π [rad].
pub fn angle_between(from: [f64; 2], to: [f64; 2], center: [f64; 2], clockwise: bool) -> f64 {
    let angle = |[x, y]: [f64; 2]| (y - center[1]).atan2(x - center[0]);
    let turned = angle(to) - angle(from);
    (if clockwise { -turned } else { turned }).rem_euclid(TAU)
}
