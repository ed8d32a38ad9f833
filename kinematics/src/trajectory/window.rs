//! Planning of the speed over the queued segments.
//!
//! Backward pass: from the next point of rest, each boundary between segments gets the
//! greatest speed that, without acceleration, still allows all later limits to be kept.
//! Forward pass: from the present motion, a [`VelocityProfile`] (change the speed, hold it,
//! slow down) is computed to each of these boundaries, within the tightest limits up to
//! there. The profile that reaches furthest is chosen, unless one with a nearer end is
//! faster and saves time in total. A profile may be replaced before its end: at each
//! boundary, and with each push, planning starts again from the present speed and
//! acceleration, and the present profile is kept unless a better one is found. So a run of
//! thousands of short segments is passed as if it were one segment.

use super::number::{max, min};
use super::profile::{Motion, VelocityProfile};
use super::queue::{PlannedSegment, Queue};
use super::ramp::{MotionLimits, greatest_entry_speed};
use super::shares::loss_of_gain;
use crate::Scalar;

/// The queued segments and the present motion.
pub(super) struct LookaheadWindow<'a, S, const N: usize> {
    pub(super) queue: &'a Queue<S, N>,
    /// The distance already covered in the first segment [m].
    pub(super) place: S,
    pub(super) motion: Motion<S>,
}

impl<S: Scalar, const N: usize> LookaheadWindow<'_, S, N> {
    /// The best profile from the present motion to one of the next `most` boundaries, or further if none leads to them.
    /// `kept` is the rest of the previous profile.
    // Large and called in two places: not inlined, to save flash.
    #[inline(never)]
    pub(super) fn best_profile(
        &self,
        kept: Option<VelocityProfile<S>>,
        most: usize,
    ) -> Option<VelocityProfile<S>> {
        let segments = self.queue.run();
        let entry = self.entry_speeds(segments);
        let speed_at = |boundary: usize| entry.get(boundary).copied().unwrap_or(S::ZERO);
        // For each boundary: the distance up to it and the tightest limits up to it.
        let first = self.queue.first()?;
        let mut ahead = [(S::ZERO, first.limits); N];
        let (mut distance, mut limits) = (-self.place, first.limits);
        for (index, (planned, slot)) in self.queue.iter().take(segments).zip(&mut ahead).enumerate()
        {
            distance += planned.length;
            limits = limits.tightest(&planned.limits);
            if index > 0 {
                limits.speed = min(limits.speed, planned.entry);
            }
            *slot = (distance, limits);
        }
        let mut best: Option<(VelocityProfile<S>, S)> = None;
        let near = most.min(segments);
        // The remaining time: from the boundary to the last of the near ones, each boundary passed
        // at its speed. A profile that arrives at less takes longer by what gaining the rest costs.
        let mut rest = S::ZERO;
        for boundary in (1..=near).rev().chain(near + 1..=segments) {
            if boundary > near && best.is_some() {
                break;
            }
            let &(distance, limits) = ahead.get(boundary - 1)?;
            if let Some(planned) = self.queue.get(boundary).filter(|_| boundary < near) {
                rest += passing_time(planned, speed_at(boundary), speed_at(boundary + 1));
            }
            let exit = speed_at(boundary);
            let fresh = VelocityProfile::over(distance, self.motion, exit, &limits, boundary);
            let kept = kept.filter(|profile| {
                profile.segments == boundary && profile.exit <= exit * S::from_f64(1.0 + 1e-5)
            });
            for profile in [fresh, kept].into_iter().flatten() {
                let time = profile.time_left();
                let late = self.queue.get(boundary).map_or(S::ZERO, |next| {
                    loss_of_gain(profile.exit, exit, &next.limits)
                });
                let total = time + rest + late;
                let better = best
                    .as_ref()
                    .is_none_or(|&(_, best_total)| total < best_total);
                if better {
                    best = Some((profile, total));
                }
            }
        }
        best.map(|(profile, ..)| profile)
    }

    /// The greatest speed at the start of each segment, without acceleration, from which all
    /// limits of the rest of the run can be kept.
    fn entry_speeds(&self, segments: usize) -> [S; N] {
        let mut entry = [S::ZERO; N];
        for boundary in (1..segments).rev() {
            let mut best = S::ZERO;
            let mut distance = S::ZERO;
            let Some((mut limits, entry_limit)) = self
                .queue
                .get(boundary)
                .map(|planned| (planned.limits, planned.entry))
            else {
                continue;
            };
            for (index, planned) in self.queue.iter().enumerate().take(segments).skip(boundary) {
                limits = limits.tightest(&planned.limits);
                if index > boundary {
                    limits.speed = min(limits.speed, planned.entry);
                }
                distance += planned.length;
                if limits.speed <= best {
                    break;
                }
                let exit = entry.get(index + 1).copied().unwrap_or(S::ZERO);
                let speed = with_reserve(exit, distance, &limits);
                best = max(best, min(speed, limits.speed));
            }
            let before = self
                .queue
                .get(boundary - 1)
                .map(|planned| planned.limits.speed);
            if let (Some(slot), Some(before)) = (entry.get_mut(boundary), before) {
                *slot = min(best, min(before, entry_limit));
            }
        }
        entry
    }
}

/// The time [s] to pass a segment from one speed to another: with constant acceleration, or
/// by a profile of its own where that is shorter.
///
/// On a long segment between two slow corners the speed is mostly far above that of both
/// corners. Such segments are rare and a profile is expensive, so one is computed only where
/// the limit of the acceleration alone, v² = ½(v₀² + v₁²) + aℓ, allows twice the speed.
fn passing_time<S: Scalar>(planned: &PlannedSegment<S>, from: S, to: S) -> S {
    let (sum, limits) = (from + to, &planned.limits);
    let plain = (sum > S::ZERO).then(|| S::TWO * planned.length / sum);
    let peak_squared = (from * from + to * to) * S::HALF + limits.acceleration * planned.length;
    let planned = if limits.speed > sum && peak_squared > sum * sum {
        let start = Motion {
            speed: from,
            acceleration: S::ZERO,
        };
        VelocityProfile::over(planned.length, start, to, limits, 1)
            .filter(|profile| profile.exit >= to * S::from_f64(0.99))
            .map(|profile| profile.time_left())
    } else {
        None
    };
    match (plain, planned) {
        (Some(plain), Some(planned)) => min(plain, planned),
        (one, other) => one.or(other).unwrap_or(S::ZERO),
    }
}

/// The greatest speed from which `exit` can be reached within `distance`, with a reserve for
/// rounding between the planning of a speed and its use: a thousandth of acceleration and
/// jerk, and the last bits of the speed. Within a micrometre rounding costs no more.
fn with_reserve<S: Scalar>(exit: S, distance: S, limits: &MotionLimits<S>) -> S {
    let share = S::from_f64(0.999);
    let limits = MotionLimits {
        speed: limits.speed,
        acceleration: limits.acceleration * share,
        jerk: limits.jerk * share,
    };
    let speed = greatest_entry_speed(exit, distance, &limits);
    max(exit, speed - S::from_f64(4.0) * S::EPSILON * speed)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Also over a micrometre, where single precision resolves few speeds.
        #[test]
        fn a_speed_in_reserve_can_be_kept_in_single_precision(
            exit in 0.0..0.5_f64, exponent in -7.0..-1.0_f64, a in 0.1..20.0_f64, j in 1.0..500.0_f64,
        ) {
            let (exit, distance) = (exit as f32, 10_f64.powf(exponent) as f32);
            let limits = MotionLimits { speed: 10.0, acceleration: a as f32, jerk: j as f32 };
            let speed = with_reserve(exit, distance, &limits);
            let start = Motion { speed, acceleration: 0.0 };
            let profile = VelocityProfile::over(distance, start, exit, &limits, 1);
            prop_assert!(profile.is_some_and(|profile| profile.exit == exit), "{speed} to {exit} in {distance} m");
        }
    }
}
