//! Arcs, from I and J or from R, as arcs of circles that pass exactly through their ends.
//!
//! The numbers of a file are rounded, so that the distances r₀ and r₁ of the centre from the arc's start and end differ by
//! some roundings. The file's centre is the truth, and the difference of the radii is spread along the arc: it is a
//! spiral about this centre. A circle through both ends of a chord c has its centre |r₁² − r₀²| / (2c) beside that of
//! the spiral, so an arc that nearly closes, whose ends are close to each other, is divided into thirds: c ≥ r, and
//! the centres move by less than the file's rounding.

use super::GcodeError;
use std::f64::consts::{PI, TAU};

/// Greatest difference of the two radii of an arc, as a share of the radius [1].
const RADIUS_SHARE: f64 = 1e-3;
/// Points that are nearer to each other are one [m]: the controller's f32 rounds by less.
const SAME_POINT: f64 = 1e-7;
/// A smaller sweep is a full turn [rad], as Grbl's `ARC_ANGULAR_TRAVEL_EPSILON`.
const NO_SWEEP: f64 = 5e-7;
/// Parts of an arc that nearly closes.
const PARTS: u8 = 3;

/// An arc of a circle from where the last one ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct CircularArc {
    /// The end [m].
    pub(super) to: [f64; 2],
    /// The centre [m].
    pub(super) center: [f64; 2],
}

/// The arc from `start` to `end` [m] about the centre that I and J give, as one arc or three. `rounding` is the
/// greatest difference of radii that the file's decimals explain [m].
pub(super) fn by_offset(
    [start, end]: [[f64; 2]; 2],
    offset: [f64; 2],
    clockwise: bool,
    rounding: f64,
) -> Result<Vec<CircularArc>, GcodeError> {
    let center = [start[0] + offset[0], start[1] + offset[1]];
    let radius = offset[0].hypot(offset[1]);
    if radius == 0.0 {
        return Err(GcodeError::ArcRadius);
    }
    let end_radius = distance(end, center);
    if (radius - end_radius).abs() > rounding.max(RADIUS_SHARE * radius) {
        return Err(GcodeError::ArcEnds(1e3 * radius, 1e3 * end_radius));
    }
    if end == start {
        return Ok(vec![CircularArc { to: end, center }]);
    }
    let swept = match angle_between(start, end, center, clockwise) {
        none if none < NO_SWEEP => TAU,
        swept => swept,
    };
    let nearly_closes = swept > PI && distance(start, end) < radius;
    let parts = if nearly_closes { PARTS } else { 1 };
    let first = (start[1] - center[1]).atan2(start[0] - center[0]);
    let signed = if clockwise { -swept } else { swept };
    let mut from = start;
    let part = |part: u8| {
        let share = f64::from(part) / f64::from(parts);
        let (sin, cos) = (first + share * signed).sin_cos();
        let radius = radius + share * (end_radius - radius);
        let to = match part == parts {
            true => end,
            false => [center[0] + radius * cos, center[1] + radius * sin],
        };
        let center = equidistant(from, to, center);
        from = to;
        CircularArc { to, center }
    };
    Ok((1..=parts).map(part).collect())
}

/// The point nearest to `center` that has the same distance from both ends of a chord [m].
fn equidistant(start: [f64; 2], end: [f64; 2], center: [f64; 2]) -> [f64; 2] {
    let chord = [end[0] - start[0], end[1] - start[1]];
    let chord_squared = chord[0] * chord[0] + chord[1] * chord[1];
    if chord_squared == 0.0 {
        return center;
    }
    let middle = [0.5 * (start[0] + end[0]), 0.5 * (start[1] + end[1])];
    let along =
        ((middle[0] - center[0]) * chord[0] + (middle[1] - center[1]) * chord[1]) / chord_squared;
    [center[0] + along * chord[0], center[1] + along * chord[1]]
}

/// The arc from `start` to `end` [m], from R: it is at most half a turn if R is positive, and more if R is negative.
/// With rounded numbers, R may be smaller than half the chord: the arc is then the half circle on the chord.
pub(super) fn by_radius(
    [start, end]: [[f64; 2]; 2],
    radius: f64,
    clockwise: bool,
    rounding: f64,
) -> Result<CircularArc, GcodeError> {
    if radius == 0.0 {
        return Err(GcodeError::ArcRadius);
    }
    let chord = [end[0] - start[0], end[1] - start[1]];
    let half = 0.5 * chord[0].hypot(chord[1]);
    let missing = half - radius.abs();
    if half == 0.0 || missing > rounding.max(RADIUS_SHARE * radius.abs()) {
        return Err(GcodeError::ArcChord);
    }
    let height_squared = radius * radius - half * half;
    let height = height_squared.max(0.0).sqrt() / (2.0 * half);
    // For a counter-clockwise arc of less than half a turn, the centre lies left of the chord.
    let left = if clockwise == (radius < 0.0) {
        height
    } else {
        -height
    };
    let center = [
        0.5 * (start[0] + end[0]) - left * chord[1],
        0.5 * (start[1] + end[1]) + left * chord[0],
    ];
    Ok(CircularArc { to: end, center })
}

/// Whether the end of an arc is less than `shortest` [m] ahead of its start. Such an arc is
/// no motion, and rounding could make a full turn of it.
pub(super) fn is_negligible(
    start: [f64; 2],
    CircularArc { to, center }: CircularArc,
    clockwise: bool,
    shortest: f64,
) -> bool {
    let chord = [to[0] - start[0], to[1] - start[1]];
    let radius = [start[0] - center[0], start[1] - center[1]];
    let ahead = radius[0] * chord[1] - radius[1] * chord[0];
    let ahead = if clockwise { -ahead } else { ahead };
    chord[0].hypot(chord[1]) < shortest && ahead > 0.0
}

/// The radius of an arc [m] and the angle that it sweeps, 0…2π [rad]. It is a full turn if the end
/// is at the start.
pub fn sweep(start: [f64; 2], end: [f64; 2], center: [f64; 2], clockwise: bool) -> (f64, f64) {
    let radius = distance(start, center);
    if distance(start, end) < SAME_POINT {
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

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}
