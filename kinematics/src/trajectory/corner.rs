//! A move behind another: the corner between them, rounded where that is possible and saves time.

use super::blend::{blend, time_to_corner};
use super::envelope::Envelope;
use super::lookahead::LookaheadPlanner;
use super::number::{max, min};
use super::path_segment::PathSegment;
use super::profile::Motion;
use super::queue::PlannedSegment;
use super::ramp::MotionLimits;
use super::trajectory_segment::Shape;
use crate::Scalar;

/// A corner is rounded where that takes at most this share of the time with a stop. The estimate
/// leaves out that acceleration and jerk stay low on the way out of a corner.
const MARGIN: f64 = 0.95;

impl<S: Scalar, const N: usize> LookaheadPlanner<S, N> {
    /// Pushes the segment with its corner rounded: the two halves of the corner's blend, and
    /// what they leave of the segment. Returns false, with the queue unchanged, where the corner
    /// cannot be rounded.
    pub(super) fn push_rounded(
        &mut self,
        segment: &PathSegment<S>,
        limits: MotionLimits<S>,
        tag: u32,
        envelope: &Envelope<S>,
    ) -> bool {
        let Some(last) = self.queue.last() else {
            return false;
        };
        let Shape::Path(curve) = last.shape else {
            return false;
        };
        let done = if self.queue.len() == 1 {
            self.place
        } else {
            S::ZERO
        };
        let reach = [
            min(last.free, last.length - done),
            segment.length() * S::HALF,
        ];
        let before = PathSegment::new(curve, last.length);
        let speed = min(last.limits.speed, limits.speed);
        let straight = last.limits.tightest(&limits);
        let Some((corner, corner_limits)) =
            blend(&before, segment, envelope.corner_tolerance, reach)
                .and_then(|corner| Some((corner, envelope.check_bend(&corner, speed).ok()?)))
        else {
            return false;
        };
        let half = corner.length() * S::HALF;
        let in_hand = self.queue.run() == self.queue.len();
        // A blend before this one has taken of the segment before, so this one may reach past its middle.
        let middle = max(S::HALF * min(before.length(), segment.length()), half);
        let rounded = time_to_corner(Some((&corner_limits, half)), middle, &straight);
        if rounded >= S::from_f64(MARGIN) * time_to_corner(None, middle, &straight) {
            return false;
        }
        let unshortened = *last;
        let first_half = PlannedSegment {
            shape: Shape::Path(*corner.curve()),
            offset: S::ZERO,
            length: half,
            free: S::ZERO,
            limits: corner_limits.halves,
            entry: corner_limits.halves.speed,
            tag,
            tool: last.tool,
            from_rest: false,
        };
        self.queue.shorten_last(half);
        self.queue.push(first_half);
        self.queue.push(PlannedSegment {
            offset: half,
            entry: corner_limits.middle,
            tool: self.tool,
            ..first_half
        });
        let rest = segment.part(half, segment.length());
        self.queue.push(PlannedSegment {
            shape: Shape::Path(*rest.curve()),
            offset: S::ZERO,
            length: rest.length(),
            free: segment.length() * S::HALF,
            limits,
            entry: limits.speed,
            tag,
            tool: self.tool,
            from_rest: false,
        });
        if !in_hand {
            // A point of rest lies before it, so planning starts there.
            return true;
        }
        // The present profile may end at the former corner.
        let kept = self
            .profile
            .filter(|profile| profile.segments + 3 < self.queue.run());
        self.profile = match self.window().best_profile(kept, usize::MAX) {
            None if self.motion != Motion::at_rest() => {
                self.queue.drop_last(4);
                self.queue.push(unshortened);
                return false;
            }
            profile => profile,
        };
        true
    }
}
