//! One stretch of the time law: up or down to a speed, hold it, down to the speed wanted
//! at the end of the stretch.

use super::number::{max, min};
use super::ramp::{Caps, Phase, distance, ramp, speed_after_release};
use crate::Scalar;

/// The state that a plan starts from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Motion<S> {
    /// ṡ [m/s].
    pub(super) speed: S,
    /// s̈ [m/s²].
    pub(super) acceleration: S,
}

impl<S: Scalar> Motion<S> {
    pub(super) fn at_rest() -> Self {
        Self {
            speed: S::ZERO,
            acceleration: S::ZERO,
        }
    }
}

/// Seven phases of constant jerk.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Plan<S> {
    phases: [Phase<S>; 7],
    /// The phase in progress, and the time already spent in it [s].
    current: usize,
    elapsed: S,
    /// How many spans it covers, counted from the one in progress.
    pub(super) spans: usize,
    /// The speed it ends with, without acceleration [m/s].
    pub(super) exit: S,
}

impl<S: Scalar> Plan<S> {
    /// The fastest plan of this form over `length` [m], ending at `exit` [m/s] or, where
    /// that cannot be reached, as fast as can be. `None` where `length` is too short to
    /// slow down in or for a plan that holds `least` [m/s], or the motion is already past
    /// the caps: too fast, or slowing down so hard that it could not be let go before the
    /// motion turns back.
    ///
    /// The way needed grows with the speed held, so that speed is found by bisection, and
    /// what rounding leaves over lengthens the time it is held.
    pub(super) fn over(
        length: S,
        start: Motion<S>,
        exit: S,
        least: S,
        caps: &Caps<S>,
        spans: usize,
    ) -> Option<Self> {
        let hair = S::from_f64(1e-5);
        let released = speed_after_release(start.speed, start.acceleration, caps.jerk);
        let within = max(start.speed, released) <= caps.speed * (S::ONE + hair)
            && released >= -(caps.speed * hair)
            && start.acceleration.abs() <= caps.acceleration * (S::ONE + hair)
            && least <= caps.speed;
        if !within {
            return None;
        }
        let lowest = max(max(released, S::ZERO), least);
        let fastest = max(caps.speed, lowest);
        let ramps = |held: S| {
            let up = ramp(start.speed, start.acceleration, held, caps);
            let down = ramp(held, S::ZERO, min(held, exit), caps);
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
            spans,
            exit: min(held, exit),
        })
    }

    /// To rest as soon as the caps allow, however far that takes.
    pub(super) fn stop(start: Motion<S>, caps: &Caps<S>, spans: usize) -> Self {
        let [p0, p1, p2] = ramp(start.speed, start.acceleration, S::ZERO, caps);
        let none = Phase::none();
        Self {
            phases: [p0, p1, p2, none, none, none, none],
            current: 0,
            elapsed: S::ZERO,
            spans,
            exit: S::ZERO,
        }
    }

    /// What is left of the phase in progress, `None` when the plan is done.
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

    /// Leave the phase in progress behind.
    pub(super) fn skip_phase(&mut self) {
        self.current += 1;
        self.elapsed = S::ZERO;
    }

    /// Let `t` [s] of the phase in progress go by.
    pub(super) fn pass(&mut self, t: S) {
        self.elapsed = self.elapsed + t;
    }

    /// The time still to go [s], and the greatest speed on the way [m/s].
    pub(super) fn outlook(&self) -> (S, S) {
        let mut time = -self.elapsed;
        let mut peak = self.exit;
        for phase in self.phases.iter().skip(self.current) {
            time = time + phase.duration;
            peak = max(peak, phase.speed);
        }
        (time, peak)
    }
}

/// The time at which a phase has covered `way` [m], 0 ≤ `way` ≤ its distance.
///
/// The speed is never negative, so the way grows with time: Newton's steps, kept in the
/// bracket by bisection.
pub(super) fn time_to_cover<S: Scalar>(phase: &Phase<S>, way: S) -> S {
    if way <= S::ZERO {
        return S::ZERO;
    }
    let (mut low, mut high) = (S::ZERO, phase.duration);
    let mut t = if phase.speed > S::ZERO {
        min(way / phase.speed, high)
    } else {
        high * S::HALF
    };
    for _ in 0..40 {
        let reached = Phase {
            duration: t,
            ..*phase
        };
        let excess = reached.distance() - way;
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
