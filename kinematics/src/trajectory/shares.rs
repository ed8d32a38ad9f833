//! How the tool's limits are shared out where a path bends.
//!
//! With x = ṡ², the tool's acceleration is r″x + r′s̈ and its jerk r‴ṡ³ + 3r″ṡs̈ + r′s⃛. To give
//! s(t) constant limits, s̈ and s⃛ get shares aₜ and jₜ of the limits, and what they leave bounds
//! the speed.
//!
//! On the blend of a corner the curvature is mostly greatest in the middle and falls towards both
//! ends, so one speed for all of it would be too low. In place of it the speed is bounded in the
//! middle, x ≤ x₀; then |s̈| ≤ aₜ alone keeps x ≤ x₀ + 2 aₜ |d| at a distance d from there. So x₀ is
//! bounded by what the places along the blend allow, less 2 aₜ |d|.
//!
//! Which shares are best depends on the need: a sharp corner is left at a fraction of the speed
//! and needs acceleration, a flat arc hardly takes any of the limits. Of a few shares those are
//! taken that lose the least time against the full speed.

use super::bounds::{Bend, CurveBounds, PLACES};
use super::number::{cube_root, min};
use super::path_segment::PathSegment;
use super::ramp::{MotionLimits, greatest_entry_speed};
use crate::Scalar;

/// Shares of the acceleration along the path that are tried: most of it for a sharp corner, little for
/// a flat arc.
const ACCELERATIONS: [f64; 5] = [0.9, 0.65, 0.45, 0.25, 0.08];
/// Shares of the jerk along the path that are tried with each of them.
const JERKS: [f64; 4] = [0.75, 0.5, 0.3, 0.2];

/// The share of the limits that is used. The rest covers what lies between the places.
const USABLE: f64 = 0.99;

/// The limits of the motion along a blend or an arc.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct BendLimits<S> {
    /// Greatest speed in the middle [m/s].
    pub(super) middle: S,
    /// The limits of both halves.
    pub(super) halves: MotionLimits<S>,
}

impl<S: Scalar> BendLimits<S> {
    fn even(halves: MotionLimits<S>) -> Self {
        Self {
            middle: halves.speed,
            halves,
        }
    }

    /// The speed that is reached `half` [m] behind the middle.
    pub(super) fn speed_after(&self, half: S) -> S {
        if self.middle >= self.halves.speed {
            return self.halves.speed;
        }
        let speed = greatest_entry_speed(self.middle, half, &self.halves);
        min(speed, self.halves.speed)
    }

    /// The time [s] that the path from the middle of a blend to full speed takes longer than at
    /// full speed.
    fn loss_behind(&self, half: S, straight: &MotionLimits<S>) -> S {
        let out = self.speed_after(half);
        let along = half * S::TWO / (self.middle + out) - half / straight.speed;
        along + loss_of_gain(out, straight.speed, straight)
    }

    /// The time [s] that a start from rest on an arc and the path along it take longer than at full
    /// speed.
    fn loss_along(&self, length: S, straight: &MotionLimits<S>) -> S {
        let speed = self.halves.speed;
        length / speed - length / straight.speed + loss_of_gain(S::ZERO, speed, &self.halves)
    }
}

/// The time [s] that a change from one speed to another takes longer than its distance at the other.
pub(super) fn loss_of_gain<S: Scalar>(from: S, to: S, limits: &MotionLimits<S>) -> S {
    if to <= from {
        return S::ZERO;
    }
    let (gain, a, j) = (to - from, limits.acceleration, limits.jerk);
    let time = if gain * j > a * a {
        gain / a + a / j
    } else {
        S::TWO * (gain / j).sqrt()
    };
    time * gain / (to + to)
}

/// The limits that keep the tool's own limits on a segment, moved along at no more than `speed`
/// [m/s].
pub(super) fn tool_limits<S: Scalar>(
    segment: &PathSegment<S>,
    speed: S,
    tool: &MotionLimits<S>,
) -> BendLimits<S> {
    let bounds = CurveBounds::of(segment.curve());
    let straight = MotionLimits {
        speed: min(speed, tool.speed) / bounds.first,
        acceleration: tool.acceleration / bounds.first,
        jerk: tool.jerk / bounds.first,
    };
    let bends = match bounds.bends {
        Some(bends) => bends,
        None => return BendLimits::even(straight),
    };
    let length = segment.length();
    let half = length * S::HALF;
    let mut best: Option<(BendLimits<S>, S)> = None;
    for rise in [S::ZERO, length] {
        // An arc bends as much everywhere.
        if rise > S::ZERO && bounds.is_even {
            break;
        }
        for along in ACCELERATIONS {
            for jerk in JERKS {
                let shares = [along, jerk].map(S::from_f64);
                let Some(limits) = with_shares(&bends, rise, &straight, shares) else {
                    continue;
                };
                let loss = if bounds.is_even {
                    limits.loss_along(length, &straight)
                } else {
                    limits.loss_behind(half, &straight)
                };
                if best.as_ref().is_none_or(|&(_, least)| loss < least) {
                    best = Some((limits, loss));
                }
            }
        }
    }
    let none = MotionLimits {
        speed: S::ZERO,
        ..straight
    };
    best.map_or(BendLimits::even(none), |(limits, _)| limits)
}

/// The limits with these shares of the acceleration and of the jerk along the path. The speed
/// rises along half of `rise` [m] from the middle.
fn with_shares<S: Scalar>(
    bends: &[Bend<S>; PLACES],
    rise: S,
    straight: &MotionLimits<S>,
    [along, jerk]: [S; 2],
) -> Option<BendLimits<S>> {
    let c = S::from_f64;
    let (a, j) = (straight.acceleration * c(USABLE), straight.jerk * c(USABLE));
    let (at, jt) = (along * a, jerk * j);
    let three = c(3.0);
    let fastest = straight.speed * straight.speed;
    let mut middle = fastest;
    let mut d = S::ZERO;
    for bend in bends {
        let risen = S::TWO * at * d * rise;
        d += c(0.5 / (PLACES - 1) as f64);
        // What is left across a part along r′, by the cosine between the two.
        let left = |whole: S, part: S, cos: S| {
            (whole * whole - part * part * (S::ONE - cos * cos)).sqrt() - part * cos
        };
        let by_acceleration = left(a, at * bend.first, bend.second_lean);
        if bend.second * fastest > by_acceleration {
            middle = min(middle, by_acceleration / bend.second - risen);
        }
        // |r‴| ṡ³ + 3|r″| aₜ ṡ: from above, Newton's steps fall to the root.
        let by_jerk = left(j, jt * bend.first, bend.third_lean);
        let (of_cube, of_speed) = (bend.third, three * bend.second * at);
        let demand = |v: S| (of_cube * v * v + of_speed) * v;
        let mut v = straight.speed;
        if demand(v) > by_jerk {
            if of_cube * v * v * v > by_jerk {
                v = cube_root(by_jerk / of_cube);
            }
            if of_speed * v > by_jerk {
                v = by_jerk / of_speed;
            }
            for _ in 0..4 {
                v = v - (demand(v) - by_jerk) / (three * of_cube * v * v + of_speed);
            }
            middle = min(middle, v * v - risen);
        }
    }
    (middle > S::ZERO).then(|| BendLimits {
        middle: middle.sqrt(),
        halves: MotionLimits {
            speed: min(straight.speed, (middle + at * rise).sqrt()),
            acceleration: at,
            jerk: jt,
        },
    })
}

#[cfg(test)]
mod tests;
