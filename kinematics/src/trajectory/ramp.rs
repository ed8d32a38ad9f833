//! Changing speed with bounded acceleration and jerk: the S-curve and its inverses.
//!
//! From speed v₀ and acceleration a₀ to speed V and no acceleration, as fast as
//! |s̈| ≤ a and |s⃛| ≤ j allow: jerk σj until the acceleration peaks at σâ, hold it, jerk
//! −σj until it is zero. Reducing a₀ to zero at once would end at v₀ + a₀|a₀|/2j; σ is the
//! side of that speed on which V lies. The speed gained on the way up and down gives
//!
//! â² = j σ(V−v₀) + ½a₀², t₁ = (â − σa₀)/j, t₃ = â/j,
//!
//! and where â would exceed a: â = a, t₂ = (σ(V−v₀) − (2a² − a₀²)/2j)/a.

use super::number::{cube_root, max, min};
use crate::Scalar;

/// The limits of the motion along a path; for a joint move in rad instead of m.
///
/// ```
/// use fivebar_kinematics::trajectory::{LookaheadPlanner, MotionLimits};
///
/// // The same joint move takes longer with a tenth of the jerk.
/// let time = |jerk: f64| {
///     let limits = MotionLimits { speed: 2.0, acceleration: 20.0, jerk };
///     let mut planner = LookaheadPlanner::<f64, 4>::new();
///     planner.push_joint([0.0, 0.0], [1.0, 0.0], limits, 0)?;
///     Ok(std::iter::from_fn(|| planner.next_segment()).map(|segment| segment.duration()).sum())
/// };
/// let (stiff, soft): (f64, f64) = (time(1000.0)?, time(100.0)?);
/// assert!((stiff - 0.62).abs() < 1e-9 && soft > stiff + 0.1); // s
/// # Ok::<(), fivebar_kinematics::trajectory::PushError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotionLimits<S> {
    /// |ṡ| [m/s].
    pub speed: S,
    /// |s̈| [m/s²].
    pub acceleration: S,
    /// |s⃛| [m/s³].
    pub jerk: S,
}

impl<S: Scalar> MotionLimits<S> {
    /// Whether all are positive and finite.
    pub fn are_valid(&self) -> bool {
        [self.speed, self.acceleration, self.jerk]
            .iter()
            .all(|&limit| limit > S::ZERO && limit.is_finite())
    }

    /// The lesser of each.
    pub(super) fn tightest(&self, other: &Self) -> Self {
        Self {
            speed: min(self.speed, other.speed),
            acceleration: min(self.acceleration, other.acceleration),
            jerk: min(self.jerk, other.jerk),
        }
    }
}

/// A phase of constant jerk.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Phase<S> {
    /// [s].
    pub(super) duration: S,
    /// Speed at its start [m/s].
    pub(super) speed: S,
    /// Acceleration at its start [m/s²].
    pub(super) acceleration: S,
    /// [m/s³].
    pub(super) jerk: S,
}

impl<S: Scalar> Phase<S> {
    /// A phase of no duration.
    pub(super) fn none() -> Self {
        Self {
            duration: S::ZERO,
            speed: S::ZERO,
            acceleration: S::ZERO,
            jerk: S::ZERO,
        }
    }

    /// The distance covered in it [m].
    pub(super) fn distance(&self) -> S {
        let t = self.duration;
        let sixth = S::from_f64(1.0 / 6.0);
        (self.speed + (self.acceleration * S::HALF + self.jerk * sixth * t) * t) * t
    }

    /// The phase that follows, with the given jerk.
    fn then(&self, duration: S, acceleration: S, jerk: S) -> Self {
        let t = self.duration;
        Self {
            duration,
            speed: self.speed + (self.acceleration + self.jerk * S::HALF * t) * t,
            acceleration,
            jerk,
        }
    }
}

/// The speed reached when the acceleration is reduced to zero at once, within the jerk.
pub(super) fn speed_after_release<S: Scalar>(speed: S, acceleration: S, jerk: S) -> S {
    speed + acceleration * acceleration.abs() / (S::TWO * jerk)
}

/// The three phases that lead from `speed` and `acceleration` to `target` speed.
pub(super) fn ramp<S: Scalar>(
    speed: S,
    acceleration: S,
    target: S,
    limits: &MotionLimits<S>,
) -> [Phase<S>; 3] {
    let (a, j) = (limits.acceleration, limits.jerk);
    let side = if target < speed_after_release(speed, acceleration, j) {
        -S::ONE
    } else {
        S::ONE
    };
    let gain = side * (target - speed);
    let a0 = side * acceleration;
    let peak = max(j * gain + S::HALF * a0 * a0, S::ZERO).sqrt();
    let (peak, hold) = if peak > a {
        let rest = gain - (S::TWO * a * a - a0 * a0) / (S::TWO * j);
        (a, max(rest / a, S::ZERO))
    } else {
        (peak, S::ZERO)
    };
    let up = Phase {
        duration: max((peak - a0) / j, S::ZERO),
        speed,
        acceleration,
        jerk: side * j,
    };
    let hold = up.then(hold, side * peak, S::ZERO);
    let down = hold.then(peak / j, side * peak, -(side * j));
    [up, hold, down]
}

/// The distance that phases cover [m].
pub(super) fn distance<S: Scalar>(phases: &[Phase<S>]) -> S {
    phases
        .iter()
        .fold(S::ZERO, |sum, phase| sum + phase.distance())
}

/// The greatest speed, held steadily, from which `target` speed can be reached within
/// `distance` [m].
///
/// Speeding down from v takes (v + w)/2 · T with T = 2√((v−w)/j), or (v−w)/a + a/j where
/// that would pass the acceleration a. With y = √(v−w) the first is y³ + 2wy = d√j, a
/// convex function whose Newton steps from above fall to the root; the second is a
/// quadratic in v.
pub(super) fn greatest_entry_speed<S: Scalar>(
    target: S,
    distance: S,
    limits: &MotionLimits<S>,
) -> S {
    let (w, a, j) = (target, limits.acceleration, limits.jerk);
    if distance <= S::ZERO {
        return w;
    }
    let q = distance * j.sqrt();
    let mut y = cube_root(q);
    if w + w > y * y {
        y = q / (w + w);
    }
    let three = S::from_f64(3.0);
    for _ in 0..6 {
        y = y - (y * y * y + S::TWO * w * y - q) / (three * y * y + S::TWO * w);
    }
    if y * y * j <= a * a {
        return w + y * y;
    }
    // v² + bv + bw − w² − 2ad = 0, b = a²/j.
    let b = a * a / j;
    let c = b * w - w * w - S::TWO * a * distance;
    max((b * b - S::from_f64(4.0) * c).sqrt() - b, S::ZERO) * S::HALF
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn limits(a: f64, j: f64) -> MotionLimits<f64> {
        MotionLimits {
            speed: 10.0,
            acceleration: a,
            jerk: j,
        }
    }

    proptest! {
        #[test]
        fn a_ramp_ends_at_its_target_within_its_limits(
            v0 in 0.0..2.0, share in -1.0..1.0, target in 0.0..2.0, a in 0.1..20.0, j in 1.0..500.0,
        ) {
            let a0 = share * a;
            let limits = limits(a, j);
            let phases = ramp(v0, a0, target, &limits);
            let end = phases[2].then(0.0, 0.0, 0.0);
            prop_assert!((end.speed - target).abs() < 1e-12 * (1.0 + a * a / j));
            let mut acceleration = a0;
            for phase in phases {
                prop_assert!(phase.duration >= 0.0);
                prop_assert!(phase.jerk.abs() <= j);
                prop_assert!((phase.acceleration - acceleration).abs() < 1e-9 * a);
                acceleration = phase.acceleration + phase.jerk * phase.duration;
                prop_assert!(acceleration.abs() <= a * (1.0 + 1e-12));
            }
            prop_assert!(acceleration.abs() < 1e-9 * a);
        }

        #[test]
        fn the_greatest_entry_speed_uses_up_the_distance(
            w in 0.0..1.0, d in 1e-6..0.5, a in 0.1..20.0, j in 1.0..500.0,
        ) {
            let limits = limits(a, j);
            let v = greatest_entry_speed(w, d, &limits);
            let used = distance(&ramp(v, 0.0, w, &limits));
            // The answer is rounded to half an ε of v, and the distance goes with √(v − w).
            let bound = 1e-12 + f64::EPSILON * v / (v - w);
            prop_assert!((used / d - 1.0).abs() < bound, "{used} of {d}");
        }
    }
}
