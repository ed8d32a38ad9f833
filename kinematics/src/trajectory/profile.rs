//! A velocity profile: change to a speed, hold it, then slow down to the speed required at
//! the end.

use super::number::{max, min};
use super::ramp::{MotionLimits, Phase, distance, ramp, speed_after_release};
use crate::Scalar;

/// The state that a profile starts from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Motion<S> {
    /// ṡ [m/s].
    pub(super) speed: S,
    /// s̈ [m/s²].
    pub(super) acceleration: S,
}

impl<S: Scalar> Motion<S> {
    pub(super) const fn at_rest() -> Self {
        Self {
            speed: S::ZERO,
            acceleration: S::ZERO,
        }
    }
}

/// Seven phases of constant jerk.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct VelocityProfile<S> {
    phases: [Phase<S>; 7],
    /// The phase in progress, and the time already spent in it [s].
    current: usize,
    elapsed: S,
    /// The number of segments it covers, counted from the one in progress.
    pub(super) segments: usize,
    /// The speed it ends with, without acceleration [m/s].
    pub(super) exit: S,
}

impl<S: Scalar> VelocityProfile<S> {
    /// The fastest profile of this form over `length` [m]. It ends at `exit` [m/s] or, where
    /// that cannot be reached, at the greatest speed possible. `None` where `length` is too
    /// short to slow down, or where the start already violates the limits: it is too fast, or it decelerates so hard that the motion would reverse
    /// before the deceleration could be removed.
    ///
    /// The distance needed grows with the speed held, so bisection finds that speed. The
    /// remainder from rounding is added to the time at that speed.
    pub(super) fn over(
        length: S,
        start: Motion<S>,
        exit: S,
        limits: &MotionLimits<S>,
        segments: usize,
    ) -> Option<Self> {
        let hair = S::from_f64(1e-5);
        let released = speed_after_release(start.speed, start.acceleration, limits.jerk);
        let within = max(start.speed, released) <= limits.speed * (S::ONE + hair)
            && released >= -(limits.speed * hair)
            && start.acceleration.abs() <= limits.acceleration * (S::ONE + hair);
        if !within {
            return None;
        }
        let lowest = max(released, S::ZERO);
        let fastest = max(limits.speed, lowest);
        let ramps = |held: S| {
            let up = ramp(start.speed, start.acceleration, held, limits);
            let down = ramp(held, S::ZERO, min(held, exit), limits);
            (up, down)
        };
        let needed = |held: S| {
            let (up, down) = ramps(held);
            distance(&up) + distance(&down)
        };
        let held = if needed(fastest) <= length {
            fastest
        } else if needed(lowest) <= length {
            let (mut low, mut high) = (lowest, fastest);
            for _ in 0..40 {
                let middle = (low + high) * S::HALF;
                if middle <= low || middle >= high {
                    break;
                }
                if needed(middle) <= length {
                    low = middle;
                } else {
                    high = middle;
                }
            }
            low
        } else {
            return None;
        };
        if held <= S::ZERO {
            return None;
        }
        let ([p0, p1, p2], [p4, p5, p6]) = ramps(held);
        let hold = Phase {
            duration: max(length - needed(held), S::ZERO) / held,
            speed: held,
            ..Phase::none()
        };
        Some(Self {
            phases: [p0, p1, p2, hold, p4, p5, p6],
            current: 0,
            elapsed: S::ZERO,
            segments,
            exit: min(held, exit),
        })
    }

    /// To rest as soon as the limits allow, over whatever distance that needs.
    pub(super) fn stop(start: Motion<S>, limits: &MotionLimits<S>, segments: usize) -> Self {
        let [p0, p1, p2] = ramp(start.speed, start.acceleration, S::ZERO, limits);
        let none = Phase::none();
        Self {
            phases: [p0, p1, p2, none, none, none, none],
            current: 0,
            elapsed: S::ZERO,
            segments,
            exit: S::ZERO,
        }
    }

    /// The rest of the phase in progress; `None` when the profile is finished.
    pub(super) fn phase(&mut self) -> Option<Phase<S>> {
        loop {
            let phase = self.phases.get(self.current)?;
            let duration = phase.duration - self.elapsed;
            if duration > S::ZERO {
                let t = self.elapsed;
                return Some(Phase {
                    duration,
                    speed: phase.speed + (phase.acceleration + phase.jerk * S::HALF * t) * t,
                    acceleration: phase.acceleration + phase.jerk * t,
                    jerk: phase.jerk,
                });
            }
            self.skip_phase();
        }
    }

    /// Ends the phase in progress.
    pub(super) fn skip_phase(&mut self) {
        self.current += 1;
        self.elapsed = S::ZERO;
    }

    /// Advances the phase in progress by `t` [s].
    pub(super) fn pass(&mut self, t: S) {
        self.elapsed += t;
    }

    /// The remaining time [s].
    pub(super) fn time_left(&self) -> S {
        let phases = self.phases.iter().skip(self.current);
        phases.fold(-self.elapsed, |time, phase| time + phase.duration)
    }
}

/// The time at which a phase has covered `length` [m], 0 ≤ `length` ≤ its distance.
///
/// The speed is never negative, so the distance grows with time: Newton's method, kept in
/// its bracket by bisection.
pub(super) fn time_to_cover<S: Scalar>(phase: &Phase<S>, length: S) -> S {
    if length <= S::ZERO {
        return S::ZERO;
    }
    let (mut low, mut high) = (S::ZERO, phase.duration);
    let mut t = if phase.speed > S::ZERO {
        min(length / phase.speed, high)
    } else {
        high * S::HALF
    };
    for _ in 0..40 {
        let reached = Phase {
            duration: t,
            ..*phase
        };
        let excess = reached.distance() - length;
        if excess > S::ZERO {
            high = t;
        } else {
            low = t;
        }
        let speed = phase.speed + (phase.acceleration + phase.jerk * S::HALF * t) * t;
        let newton = t - excess / speed;
        let next = if newton > low && newton < high {
            newton
        } else {
            (low + high) * S::HALF
        };
        if next == t {
            break;
        }
        t = next;
    }
    t
}
