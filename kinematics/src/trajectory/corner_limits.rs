//! How fast the corner between two lines may be passed.
//!
//! In the middle of such a corner's blend the curvature κ is greatest, and towards its ends it
//! falls to 0. So the speed is limited most in the middle: x = ṡ² may be x₀ there, and, with
//! |s̈| ≤ aₜ, it is at most x₀ + 2 aₜ |d| at a distance d from it. With D = d/ℓ, 0 … ½,
//!
//! κ = κ₀ (1 − 4D²), |r‴| = 8 κ₀ D/ℓ, r′·n = δ (3/2 D − 2D³)
//!
//! where n is the direction of r″ and r‴, and δ = |Δt|. At each D the tool's acceleration has the
//! components κx along n and aₜ along r′; its jerk, |r‴|ṡ³ + 3κṡaₜ and jₜ. What is left for κx and
//! for ṡ bounds x₀.
//!
//! Which shares aₜ and jₜ of the limits are best depends on the corner: a sharp one is left at a
//! fraction of the speed and needs acceleration, a flat one needs none. Of a few shares the one is
//! taken that loses the least time on the way from the middle to the full speed.

use super::bounds::CurveBounds;
use super::motion_limits::{share_out, tool_straight};
use super::number::{cube_root, min};
use super::path_segment::PathSegment;
use super::ramp::{MotionLimits, greatest_entry_speed};
use crate::Scalar;

/// Shares of the acceleration and of the jerk along the path that are tried.
const ACCELERATIONS: [f64; 5] = [0.9, 0.65, 0.45, 0.25, 0.08];
const JERKS: [f64; 3] = [0.75, 0.5, 0.3];

/// Places D at which the limits are evaluated, and the reserve for what lies between them.
const PLACES: u8 = 8;
const RESERVE: f64 = 0.99;

/// The limits of the motion along a rounded corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct CornerLimits<S> {
    /// Greatest speed in the middle [m/s].
    pub(super) middle: S,
    /// The limits of both halves.
    pub(super) halves: MotionLimits<S>,
}

impl<S: Scalar> CornerLimits<S> {
    /// The speed that is reached `half` [m] behind the middle.
    pub(super) fn speed_after(&self, half: S) -> S {
        if self.middle >= self.halves.speed {
            return self.halves.speed;
        }
        let speed = greatest_entry_speed(self.middle, half, &self.halves);
        min(speed, self.halves.speed)
    }

    /// The time [s] that the way from the middle to full speed takes longer than at full speed.
    fn loss(&self, half: S, straight: &MotionLimits<S>) -> S {
        let full = straight.speed;
        let out = self.speed_after(half);
        let rest = full - out;
        let (a, j) = (straight.acceleration, straight.jerk);
        let gaining = if rest * j > a * a {
            rest / a + a / j
        } else {
            S::TWO * (rest / j).sqrt()
        };
        half * S::TWO / (self.middle + out) - half / full + gaining * rest / (full + full)
    }
}

/// The limits that keep the tool's own limits on a corner's blend, moved along at no more than
/// `speed` [m/s].
pub(super) fn corner_limits<S: Scalar>(
    blend: &PathSegment<S>,
    speed: S,
    tool: &MotionLimits<S>,
) -> CornerLimits<S> {
    let bounds = CurveBounds::of(blend.curve());
    let straight = tool_straight(&bounds, speed, tool);
    let even = |halves: MotionLimits<S>| CornerLimits {
        middle: halves.speed,
        halves,
    };
    if bounds.second == S::ZERO {
        return even(straight);
    }
    let shared = even(share_out(&straight, &bounds));
    if !bounds.apart {
        return shared;
    }
    let half = blend.length() * S::HALF;
    let mut best = (shared, shared.loss(half, &straight));
    for rising in [true, false] {
        for along in ACCELERATIONS {
            for jerk in JERKS {
                let shares = [along, jerk].map(S::from_f64);
                let Some(limits) = with_shares(&bounds, blend.length(), &straight, shares, rising)
                else {
                    continue;
                };
                let loss = limits.loss(half, &straight);
                if loss < best.1 {
                    best = (limits, loss);
                }
            }
        }
    }
    best.0
}

/// The limits with these shares of the acceleration and of the jerk along the path.
fn with_shares<S: Scalar>(
    bounds: &CurveBounds<S>,
    length: S,
    straight: &MotionLimits<S>,
    [along, jerk]: [S; 2],
    rising: bool,
) -> Option<CornerLimits<S>> {
    let c = S::from_f64;
    let (a, j) = (straight.acceleration * c(RESERVE), straight.jerk * c(RESERVE));
    let (at, jt) = (along * a, jerk * j);
    let rise = if rising { S::TWO * at * length } else { S::ZERO };
    let turn = bounds.second * length * c(2.0 / 3.0);
    let third = c(3.0);
    let greatest = straight.speed * straight.speed;
    let mut middle = greatest;
    for place in 0..=PLACES {
        let d = c(f64::from(place) / f64::from(PLACES) / 2.0);
        let curvature = bounds.second * (S::ONE - c(4.0) * d * d);
        let bending = bounds.third * (d + d);
        let cos = min(turn * d * (c(1.5) - S::TWO * d * d), S::ONE);
        let across = |whole: S, along: S| {
            (whole * whole - along * along * (S::ONE - cos * cos)).sqrt() - along * cos
        };
        let by_acceleration = across(a, at);
        if curvature * greatest > by_acceleration {
            middle = min(middle, by_acceleration / curvature - rise * d);
        }
        // |r‴| ṡ³ + 3 κ aₜ ṡ: from above, Newton's steps fall to the root.
        let (of_cube, of_speed) = (bending, third * curvature * at);
        let by_jerk = across(j, jt);
        let mut v = straight.speed;
        if of_cube * v * v * v + of_speed * v > by_jerk {
            if of_cube > S::ZERO {
                v = min(v, cube_root(by_jerk / of_cube));
            }
            if of_speed * v > by_jerk {
                v = by_jerk / of_speed;
            }
            for _ in 0..4 {
                let excess = of_cube * v * v * v + of_speed * v - by_jerk;
                v = v - excess / (third * of_cube * v * v + of_speed);
            }
            middle = min(middle, v * v - rise * d);
        }
    }
    let slowest = S::from_f64(1e-6) * straight.speed * straight.speed;
    (middle > slowest).then(|| {
        let ends = middle + rise * S::HALF;
        CornerLimits {
            middle: middle.sqrt(),
            halves: MotionLimits {
                speed: min(straight.speed, ends.sqrt()),
                acceleration: at,
                jerk: jt,
            },
        }
    })
}
