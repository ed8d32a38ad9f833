//! Look-ahead: turns a bounded queue of moves into trajectory segments.
//!
//! The queue holds planned segments: path segments, the blends that round the corners
//! between them, joint moves and dwells. The plan for the queued segments always ends at rest.
//!
//! **Commitment.** A segment returned by [`LookaheadPlanner::next_segment`] is committed. All
//! other segments are planned again when more are pushed. A corner is rounded if the present
//! motion still allows it; otherwise the motion stops there.

use super::envelope::Envelope;
use super::error::PushError;
use super::number::max;
use super::path_segment::PathSegment;
use super::profile::{Motion, VelocityProfile, time_to_cover};
use super::queue::{PlannedSegment, Queue};
use super::ramp::MotionLimits;
use super::trajectory_segment::{Shape, TimeLaw, ToolOutput, TrajectorySegment};
use super::window::LookaheadWindow;
use crate::Scalar;
use nalgebra::Vector2;

/// Planned segments of a move: its own, and two for the halves of the corner before it.
const SEGMENTS_PER_MOVE: usize = 3;

/// So many planned segments a plan in haste looks ahead.
const NEAR: usize = 6;

/// A queue of up to `N` segments; a move takes one, and two more for the corner before it.
///
/// ```
/// use fivebar_kinematics::trajectory::{LookaheadPlanner, MotionLimits, Reference};
///
/// // Joint 1 turns by 0.5 rad, joint 4 by −0.2 rad, from rest to rest.
/// let limits = MotionLimits { speed: 2.0, acceleration: 20.0, jerk: 1000.0 }; // rad/s, …
/// let mut planner = LookaheadPlanner::<f64, 8>::new();
/// planner.push_joint([2.0, 1.1], [2.5, 0.9], limits, 0)?;
///
/// let (mut time, mut last) = (0.0, None);
/// while let Some(segment) = planner.next_segment() {
///     time += segment.duration();
///     last = Some(segment.evaluate(segment.duration()));
/// }
/// // 0.5/2 s at full speed, 2/20 s to gain and lose it, 20/1000 s for the jerk.
/// assert!((time - 0.37).abs() < 1e-9);
/// let Some(Reference::Joint { angles: [_, theta4], .. }) = last else { panic!("no motion") };
/// assert!((theta4 - 0.9).abs() < 1e-12);
/// # Ok::<(), fivebar_kinematics::trajectory::PushError>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct LookaheadPlanner<S, const N: usize> {
    pub(super) queue: Queue<S, N>,
    /// The end of the committed motion, as distance in the first planned segment [m].
    pub(super) place: S,
    pub(super) motion: Motion<S>,
    pub(super) profile: Option<VelocityProfile<S>>,
    /// The tool's output during the moves that are pushed next.
    pub(super) tool: ToolOutput<S>,
    /// The first planned segment has changed since the last planning.
    stale: bool,
}

impl<S: Scalar, const N: usize> Default for LookaheadPlanner<S, N> {
    fn default() -> Self {
        Self::new()
    }
}

impl<S: Scalar, const N: usize> LookaheadPlanner<S, N> {
    /// An empty queue, at rest.
    pub const fn new() -> Self {
        Self {
            queue: Queue::new(),
            place: S::ZERO,
            motion: Motion::at_rest(),
            profile: None,
            tool: ToolOutput::constant(S::ZERO),
            stale: false,
        }
    }

    /// Drops all moves, and is at rest as a new one, in place.
    pub fn clear(&mut self) {
        let Self {
            queue,
            place,
            motion,
            profile,
            tool,
            stale,
        } = self;
        queue.clear();
        *place = S::ZERO;
        *motion = Motion::at_rest();
        *profile = None;
        *tool = ToolOutput::constant(S::ZERO);
        *stale = false;
    }

    /// Whether any move can be pushed now.
    pub fn has_free_slot(&self) -> bool {
        self.free_slots() > 0
    }

    /// The number of moves of any kind that can be pushed now.
    pub fn free_slots(&self) -> usize {
        (N - self.queue.len()) / SEGMENTS_PER_MOVE
    }

    /// The number of planned segments in the queue.
    pub fn len(&self) -> usize {
        self.queue.len()
    }

    /// Whether all pushed moves have been returned as trajectory segments.
    pub fn is_empty(&self) -> bool {
        self.queue.len() == 0
    }

    /// Sets the tool's output during the moves that are pushed from now on; it is 0 until then.
    /// On the way from one output to another the motion does not stop. At a rounded corner the
    /// output changes in the corner's middle, which is the point nearest to the end of the move.
    pub fn set_tool_output(&mut self, tool: ToolOutput<S>) {
        self.tool = tool;
    }

    /// Appends a path segment that starts where the last one ends. The motion keeps `limits`,
    /// which come from [`Envelope::check`]. The corner before the segment is rounded within
    /// the envelope's tolerance where possible; otherwise the motion stops there.
    ///
    /// # Errors
    /// `Full`, `NotFinite`; the queue is unchanged then.
    pub fn push(
        &mut self,
        segment: &PathSegment<S>,
        limits: MotionLimits<S>,
        tag: u32,
        envelope: &Envelope<S>,
    ) -> Result<(), PushError> {
        self.check(&limits, segment.length())?;
        if !self.push_rounded(segment, limits, tag, envelope) {
            self.queue.push(PlannedSegment {
                shape: Shape::Path(*segment.curve()),
                offset: S::ZERO,
                length: segment.length(),
                free: segment.length() * S::HALF,
                limits,
                entry: limits.speed,
                tag,
                tool: self.tool,
                from_rest: true,
            });
        }
        Ok(())
    }

    /// Appends a straight move of both joints from rest to rest, `from` and `to` in rad. The
    /// limits are those of the joint that turns further, in rad. A move of length zero is
    /// skipped.
    ///
    /// # Errors
    /// `Full`, `NotFinite`; the queue is unchanged then.
    pub fn push_joint(
        &mut self,
        from: [S; 2],
        to: [S; 2],
        limits: MotionLimits<S>,
        tag: u32,
    ) -> Result<(), PushError> {
        let [from1, from4] = from;
        let [to1, to4] = to;
        let (d1, d4) = (to1 - from1, to4 - from4);
        let length = max(d1.abs(), d4.abs());
        self.check(&limits, d1.abs() + d4.abs())?;
        if length > S::ZERO {
            self.queue.push(PlannedSegment {
                shape: Shape::Joint {
                    from,
                    direction: [d1 / length, d4 / length],
                },
                offset: S::ZERO,
                length,
                free: S::ZERO,
                limits,
                entry: limits.speed,
                tag,
                tool: self.tool,
                from_rest: true,
            });
        }
        Ok(())
    }

    /// Appends a dwell of `duration` [s] with the tool at `position` [m].
    ///
    /// # Errors
    /// `Full`, `NotFinite`; the queue is unchanged then.
    pub fn push_dwell(
        &mut self,
        position: Vector2<S>,
        duration: S,
        tag: u32,
    ) -> Result<(), PushError> {
        let any = MotionLimits {
            speed: S::ONE,
            acceleration: S::ONE,
            jerk: S::ONE,
        };
        self.check(&any, duration)?;
        self.queue.push(PlannedSegment {
            shape: Shape::Rest(position),
            offset: S::ZERO,
            length: duration,
            free: S::ZERO,
            limits: any,
            entry: any.speed,
            tag,
            tool: self.tool,
            from_rest: true,
        });
        Ok(())
    }

    fn check(&self, limits: &MotionLimits<S>, length: S) -> Result<(), PushError> {
        // Behind a dwell no corner is rounded, so every move takes one place.
        let rests = self
            .queue
            .last()
            .is_some_and(|last| matches!(last.shape, Shape::Rest(_)));
        let free = N - self.queue.len();
        if free == 0 || (free < SEGMENTS_PER_MOVE && !rests) {
            return Err(PushError::Full);
        }
        if !(limits.are_valid() && length.is_finite() && length >= S::ZERO) {
            return Err(PushError::NotFinite);
        }
        Ok(())
    }

    /// The next trajectory segment, starting where the last one ended; `None` when all moves
    /// have been returned. The last segment before `None` ends at rest.
    pub fn next_segment(&mut self) -> Option<TrajectorySegment<S>> {
        self.next_planned(usize::MAX)
    }

    /// The same without a search for anything better, for a follower that soon needs it: the plan goes on as it is. At
    /// its end the next one looks only a few segments ahead, so that the motion may be slower.
    pub fn next_segment_in_haste(&mut self) -> Option<TrajectorySegment<S>> {
        self.next_planned(NEAR)
    }

    /// The next trajectory segment; a plan is made anew for at most `most` segments.
    fn next_planned(&mut self, most: usize) -> Option<TrajectorySegment<S>> {
        // Each pass returns a segment or finishes a planned segment or a profile.
        for _ in 0..4 * N {
            let head = *self.queue.first()?;
            if let Shape::Rest(position) = head.shape {
                self.leave_segment();
                if head.length <= S::ZERO {
                    continue;
                }
                let rest = TrajectorySegment::rest(position, head.length, head.tag);
                return Some(TrajectorySegment {
                    tool: head.tool,
                    ..rest
                });
            }
            if let Some(segment) = self.advance(&head, most) {
                return Some(segment);
            }
        }
        None
    }

    /// Advances to the end of the profile's phase or to the end of the first planned segment,
    /// whichever comes first.
    fn advance(&mut self, head: &PlannedSegment<S>, most: usize) -> Option<TrajectorySegment<S>> {
        let in_haste = most < N;
        if self.stale && !in_haste || self.profile.is_none() {
            self.profile = self.window().best_profile(self.profile, most);
            self.stale = in_haste;
        }
        let left = head.length - self.place;
        let Some(mut profile) = self.profile else {
            if left <= S::ZERO || self.motion == Motion::at_rest() {
                // The rest of this run has no length.
                self.leave_segment();
            } else {
                debug_assert!(false, "a committed motion can always be carried on");
                self.profile = Some(VelocityProfile::stop(
                    self.motion,
                    &head.limits,
                    self.queue.run(),
                ));
            }
            return None;
        };
        let Some(phase) = profile.phase() else {
            self.profile = None;
            // By rounding, a profile may end just before the end of its last segment but one.
            if profile.segments <= 1 || left <= head.length * S::from_f64(1e-6) {
                self.leave_segment();
            }
            return None;
        };
        let law = TimeLaw::new(
            head.offset + self.place,
            phase.speed,
            phase.acceleration,
            phase.jerk,
        );
        let distance = phase.distance();
        // In its last segment a profile runs to its own end, which is the segment's end apart
        // from rounding.
        let whole = distance <= left || profile.segments <= 1;
        let duration = if whole {
            profile.skip_phase();
            self.place += distance;
            phase.duration
        } else {
            let t = time_to_cover(&phase, max(left, S::ZERO));
            profile.pass(t);
            t
        };
        self.motion = match profile.phase() {
            Some(next) => Motion {
                speed: next.speed,
                acceleration: next.acceleration,
            },
            None => Motion {
                speed: profile.exit,
                acceleration: S::ZERO,
            },
        };
        self.profile = Some(profile);
        if !whole {
            self.leave_segment();
            if let Some(profile) = &mut self.profile {
                profile.segments -= 1;
            }
        }
        // A remainder of under a nanosecond moves nothing, so it is dropped.
        (duration > S::from_f64(1e-9)).then_some(TrajectorySegment {
            shape: head.shape,
            law,
            duration,
            tag: head.tag,
            tool: head.tool,
        })
    }

    pub(super) fn window(&self) -> LookaheadWindow<'_, S, N> {
        LookaheadWindow {
            queue: &self.queue,
            place: self.place,
            motion: self.motion,
        }
    }

    fn leave_segment(&mut self) {
        self.queue.pop();
        self.place = S::ZERO;
        self.stale = true;
    }
}
