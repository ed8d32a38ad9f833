//! Planning over the spans ahead.
//!
//! Backwards from the next place of rest, each boundary between spans gets the greatest
//! speed at which, passed without acceleration, everything behind it can still be kept.
//! Forwards from the motion at hand, a [`Plan`] (change speed, hold it, slow down) is
//! tried to each of those boundaries, under the tightest caps on its way. The plan that
//! reaches furthest is taken, unless a nearer end lets it go faster and saves time over
//! all. It need not be finished: at each boundary, and with each push, planning starts
//! anew from the motion at hand, its acceleration included, and the plan in hand is kept
//! unless a better one is found. So a run of thousands of tiny segments is passed as if
//! it were one.

use super::number::{max, min};
use super::plan::{Motion, Plan};
use super::queue::{Queue, Span};
use super::ramp::{Caps, greatest_entry_speed};
use crate::Scalar;

/// The spans ahead and the motion at hand.
pub(super) struct Horizon<'a, S, const N: usize> {
    pub(super) queue: &'a Queue<S, N>,
    /// How far into the first span the motion is [m].
    pub(super) place: S,
    pub(super) motion: Motion<S>,
}

impl<S: Scalar, const N: usize> Horizon<'_, S, N> {
    /// The best plan from the motion at hand, `kept` being what is left of the one before.
    // Large, and asked for in two places.
    #[inline(never)]
    pub(super) fn best_plan(&self, kept: Option<Plan<S>>) -> Option<Plan<S>> {
        let spans = self.queue.run();
        let entry = self.entry_speeds(spans);
        let speed_at = |boundary: usize| entry.get(boundary).copied().unwrap_or(S::ZERO);
        // Up to each boundary: the way and the tightest caps.
        let first = self.queue.first()?;
        let mut ahead = [(S::ZERO, first.caps); N];
        let (mut way, mut caps) = (-self.place, first.caps);
        for (span, slot) in self.queue.iter().take(spans).zip(&mut ahead) {
            way = way + span.length;
            caps = caps.tightest(&span.caps);
            *slot = (way, caps);
        }
        let mut best: Option<(Plan<S>, S, S)> = None;
        let on_time = S::from_f64(0.99);
        // The time from the boundary to the end of the run, passing each boundary at its
        // speed: what a plan that arrives with that speed can count on, and too little for
        // one that is still gathering speed, which must therefore be the faster one to be
        // preferred.
        let mut rest = S::ZERO;
        for boundary in (1..=spans).rev() {
            let &(way, caps) = ahead.get(boundary - 1)?;
            if let Some(span) = self.queue.get(boundary).filter(|_| boundary < spans) {
                rest = rest + passing_time(span, speed_at(boundary), speed_at(boundary + 1));
            }
            // A plan slower than both its boundary and the best would not be chosen.
            let least = best.as_ref().map_or(S::ZERO, |&(_, best_peak, _)| {
                min(best_peak, speed_at(boundary) * on_time)
            });
            let exit = speed_at(boundary);
            let fresh = Plan::over(way, self.motion, exit, least, &caps, boundary);
            let kept = kept.filter(|plan| {
                plan.spans == boundary && plan.exit <= exit * S::from_f64(1.0 + 1e-5)
            });
            for plan in [fresh, kept].into_iter().flatten() {
                let (time, peak) = plan.outlook();
                let total = time + rest;
                let better = best.as_ref().is_none_or(|&(_, best_peak, best_total)| {
                    total < best_total && (plan.exit >= exit * on_time || peak > best_peak)
                });
                if better {
                    best = Some((plan, peak, total));
                }
            }
        }
        best.map(|(plan, ..)| plan)
    }

    /// The greatest speed at the start of each span, passed without acceleration, from
    /// which the rest of the run can be kept.
    fn entry_speeds(&self, spans: usize) -> [S; N] {
        let mut entry = [S::ZERO; N];
        for boundary in (1..spans).rev() {
            let mut best = S::ZERO;
            let mut way = S::ZERO;
            let Some(mut caps) = self.queue.get(boundary).map(|span| span.caps) else {
                continue;
            };
            for (index, span) in self.queue.iter().enumerate().take(spans).skip(boundary) {
                caps = caps.tightest(&span.caps);
                way = way + span.length;
                if caps.speed <= best {
                    break;
                }
                let exit = entry.get(index + 1).copied().unwrap_or(S::ZERO);
                let speed = with_reserve(exit, way, &caps);
                best = max(best, min(speed, caps.speed));
            }
            let before = self.queue.get(boundary - 1).map(|span| span.caps.speed);
            if let (Some(slot), Some(before)) = (entry.get_mut(boundary), before) {
                *slot = min(best, before);
            }
        }
        entry
    }
}

/// The time [s] to pass a span from one speed to another: as if by constant acceleration,
/// or by a plan of its own where that is less.
///
/// A long span between two slow corners spends most of its time far above either speed.
/// Most spans are not such, and making a plan takes a while: one is made where the
/// acceleration's cap alone, v² = ½(v₀² + v₁²) + aℓ, lets the speed double.
fn passing_time<S: Scalar>(span: &Span<S>, from: S, to: S) -> S {
    let (sum, caps) = (from + to, &span.caps);
    let plain = (sum > S::ZERO).then(|| S::TWO * span.length / sum);
    let peak_squared = (from * from + to * to) * S::HALF + caps.acceleration * span.length;
    let planned = if caps.speed > sum && peak_squared > sum * sum {
        let start = Motion {
            speed: from,
            acceleration: S::ZERO,
        };
        Plan::over(span.length, start, to, S::ZERO, caps, 1)
            .filter(|plan| plan.exit >= to * S::from_f64(0.99))
            .map(|plan| plan.outlook().0)
    } else {
        None
    };
    match (plain, planned) {
        (Some(plain), Some(planned)) => min(plain, planned),
        (one, other) => one.or(other).unwrap_or(S::ZERO),
    }
}

/// The greatest speed from which `exit` can be reached within `way`, with something kept back
/// for the roundings between the planning of a speed and its use: a thousandth of
/// acceleration and jerk, and the last bits of the speed, since within a micrometre no more
/// than those can be lost.
fn with_reserve<S: Scalar>(exit: S, way: S, caps: &Caps<S>) -> S {
    let share = S::from_f64(0.999);
    let caps = Caps {
        speed: caps.speed,
        acceleration: caps.acceleration * share,
        jerk: caps.jerk * share,
    };
    let speed = greatest_entry_speed(exit, way, &caps);
    max(exit, speed - S::from_f64(4.0) * S::EPSILON * speed)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Over a micrometre too, where single precision tells few speeds apart.
        #[test]
        fn a_speed_in_reserve_can_be_kept_in_single_precision(
            exit in 0.0..0.5_f64, exponent in -7.0..-1.0_f64, a in 0.1..20.0_f64, j in 1.0..500.0_f64,
        ) {
            let (exit, way) = (exit as f32, 10_f64.powf(exponent) as f32);
            let caps = Caps { speed: 10.0, acceleration: a as f32, jerk: j as f32 };
            let speed = with_reserve(exit, way, &caps);
            let start = Motion { speed, acceleration: 0.0 };
            let plan = Plan::over(way, start, exit, 0.0, &caps, 1);
            prop_assert!(plan.is_some_and(|plan| plan.exit == exit), "{speed} to {exit} in {way} m");
        }
    }
}
