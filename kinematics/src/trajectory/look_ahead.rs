//! Look-ahead: a bounded queue of moves becomes pieces of motion.
//!
//! The queue holds *spans*: segments, the blends that round the corners between them,
//! joint moves and dwells. Whatever is queued is always planned to end at rest.
//!
//! **Commitment.** A piece handed out by [`LookAhead::next_piece`] is committed. All else
//! is replanned when more is pushed; a corner is rounded if the motion at hand still
//! allows that, otherwise it is stopped at.

use super::blend::blend;
use super::envelope::Envelope;
use super::horizon::Horizon;
use super::number::{max, min};
use super::piece::{Piece, Shape, TimeLaw};
use super::plan::{Motion, Plan, time_to_cover};
use super::queue::{Queue, Span};
use super::ramp::{Caps, distance, greatest_entry_speed, ramp};
use super::segment::Segment;
use crate::Scalar;
use nalgebra::Vector2;

/// Why a move is not taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum PushError {
    /// No room: take pieces out first.
    Full,
    /// A cap is not a positive finite number, or a length or duration not a finite one, or
    /// negative.
    NotFinite,
}

/// A queue of up to `N` spans; a move takes one, and one more for the corner before it.
#[derive(Clone, Copy, Debug)]
pub struct LookAhead<S, const N: usize> {
    queue: Queue<S, N>,
    /// How far into the first span what is committed reaches [m].
    place: S,
    motion: Motion<S>,
    plan: Option<Plan<S>>,
    /// The first span has changed since planning.
    stale: bool,
}

impl<S: Scalar, const N: usize> Default for LookAhead<S, N> {
    fn default() -> Self {
        Self::new()
    }
}

impl<S: Scalar, const N: usize> LookAhead<S, N> {
    /// An empty queue, at rest.
    pub fn new() -> Self {
        Self {
            queue: Queue::new(),
            place: S::ZERO,
            motion: Motion::at_rest(),
            plan: None,
            stale: false,
        }
    }

    /// Whether any move can be pushed now.
    pub fn has_room(&self) -> bool {
        self.room() > 0
    }

    /// How many moves can be pushed now, whatever they are.
    pub fn room(&self) -> usize {
        (N - self.queue.len()) / 2
    }

    /// Whether everything pushed has been handed out.
    pub fn is_empty(&self) -> bool {
        self.queue.len() == 0
    }

    /// Append a stretch of path that starts where the last one ends, to be moved along
    /// within `caps`, which come from [`Envelope::admit`]. The corner before it is
    /// rounded within the envelope's tolerance where that can be, else stopped at.
    ///
    /// # Errors
    /// `Full`, `NotFinite`; nothing is changed then.
    pub fn push(
        &mut self,
        segment: &Segment<S>,
        caps: Caps<S>,
        tag: u32,
        envelope: &Envelope<S>,
    ) -> Result<(), PushError> {
        self.check(&caps, segment.length())?;
        if !self.push_rounded(segment, caps, tag, envelope) {
            self.queue.push(Span {
                shape: Shape::Path(*segment.curve()),
                length: segment.length(),
                free: segment.length() * S::HALF,
                caps,
                tag,
                from_rest: true,
            });
        }
        Ok(())
    }

    /// Append a straight move of both joints from rest to rest, `from` and `to` in rad.
    /// The caps are those of the joint that turns further, in rad. A move that goes
    /// nowhere is skipped.
    ///
    /// # Errors
    /// `Full`, `NotFinite`; nothing is changed then.
    pub fn push_joint(
        &mut self,
        from: [S; 2],
        to: [S; 2],
        caps: Caps<S>,
        tag: u32,
    ) -> Result<(), PushError> {
        let [from1, from4] = from;
        let [to1, to4] = to;
        let (d1, d4) = (to1 - from1, to4 - from4);
        let length = max(d1.abs(), d4.abs());
        self.check(&caps, d1.abs() + d4.abs())?;
        if length > S::ZERO {
            self.queue.push(Span {
                shape: Shape::Joint {
                    from,
                    direction: [d1 / length, d4 / length],
                },
                length,
                free: S::ZERO,
                caps,
                tag,
                from_rest: true,
            });
        }
        Ok(())
    }

    /// Append a rest of `duration` [s] with the tool at `position` [m].
    ///
    /// # Errors
    /// `Full`, `NotFinite`; nothing is changed then.
    pub fn push_dwell(
        &mut self,
        position: Vector2<S>,
        duration: S,
        tag: u32,
    ) -> Result<(), PushError> {
        let any = Caps {
            speed: S::ONE,
            acceleration: S::ONE,
            jerk: S::ONE,
        };
        self.check(&any, duration)?;
        self.queue.push(Span {
            shape: Shape::Rest(position),
            length: duration,
            free: S::ZERO,
            caps: any,
            tag,
            from_rest: true,
        });
        Ok(())
    }

    fn check(&self, caps: &Caps<S>, length: S) -> Result<(), PushError> {
        if !self.has_room() {
            return Err(PushError::Full);
        }
        if !(caps.are_sound() && length.is_finite() && length >= S::ZERO) {
            return Err(PushError::NotFinite);
        }
        Ok(())
    }

    /// Push with the corner rounded; false, and nothing changed, where that cannot be.
    fn push_rounded(
        &mut self,
        segment: &Segment<S>,
        caps: Caps<S>,
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
        let before = Segment::new(curve, last.length);
        let speed = min(last.caps.speed, caps.speed);
        let Some((corner, corner_caps)) = blend(&before, segment, envelope.corner_tolerance, reach)
            .and_then(|corner| Some((corner, envelope.admit(&corner, speed).ok()?)))
        else {
            return false;
        };
        let half = corner.length() * S::HALF;
        let in_hand = self.queue.run() == self.queue.len();
        let middle = S::HALF * min(before.length(), segment.length());
        if !saves_time(&corner_caps, half, middle, &last.caps.tightest(&caps)) {
            return false;
        }
        let unshortened = *last;
        self.queue.shorten_last(half);
        self.queue.push(Span {
            shape: Shape::Path(*corner.curve()),
            length: corner.length(),
            free: S::ZERO,
            caps: corner_caps,
            tag,
            from_rest: false,
        });
        let rest = segment.part(half, segment.length());
        self.queue.push(Span {
            shape: Shape::Path(*rest.curve()),
            length: rest.length(),
            free: segment.length() * S::HALF,
            caps,
            tag,
            from_rest: false,
        });
        if !in_hand {
            // There is a rest before it, and it will be planned from there.
            return true;
        }
        // The plan in hand may end where the corner was.
        let kept = self.plan.filter(|plan| plan.spans + 2 < self.queue.run());
        self.plan = match self.horizon().best_plan(kept) {
            None if self.motion != Motion::at_rest() => {
                self.queue.drop_last(3);
                self.queue.push(unshortened);
                return false;
            }
            plan => plan,
        };
        true
    }

    /// The next piece of motion, from where the last one ended, or `None` when all that
    /// was pushed has been handed out. The last piece before that ends at rest.
    pub fn next_piece(&mut self) -> Option<Piece<S>> {
        // Each turn hands out a piece or leaves a span or a plan behind.
        for _ in 0..4 * N {
            let head = *self.queue.first()?;
            if let Shape::Rest(position) = head.shape {
                self.leave_span();
                if head.length <= S::ZERO {
                    continue;
                }
                return Some(Piece::rest(position, head.length, head.tag));
            }
            if let Some(piece) = self.advance(&head) {
                return Some(piece);
            }
        }
        None
    }

    /// Follow the plan to the end of its phase or of the first span, whichever is first.
    fn advance(&mut self, head: &Span<S>) -> Option<Piece<S>> {
        if self.stale || self.plan.is_none() {
            self.plan = self.horizon().best_plan(self.plan);
            self.stale = false;
        }
        let left = head.length - self.place;
        let Some(mut plan) = self.plan else {
            if left <= S::ZERO || self.motion == Motion::at_rest() {
                // Nothing of any length is left of this run.
                self.leave_span();
            } else {
                debug_assert!(false, "a committed motion can always be carried on");
                self.plan = Some(Plan::stop(self.motion, &head.caps, self.queue.run()));
            }
            return None;
        };
        let Some(phase) = plan.phase() else {
            self.plan = None;
            // Rounding may end a plan on the last hair of the span before its last.
            if plan.spans <= 1 || left <= head.length * S::from_f64(1e-6) {
                self.leave_span();
            }
            return None;
        };
        let law = TimeLaw::new(self.place, phase.speed, phase.acceleration, phase.jerk);
        let way = phase.distance();
        // In its last span a plan runs to its own end: rounding aside, the span's.
        let whole = way <= left || plan.spans <= 1;
        let duration = if whole {
            plan.skip_phase();
            self.place = self.place + way;
            phase.duration
        } else {
            let t = time_to_cover(&phase, max(left, S::ZERO));
            plan.pass(t);
            t
        };
        self.motion = match plan.phase() {
            Some(next) => Motion {
                speed: next.speed,
                acceleration: next.acceleration,
            },
            None => Motion {
                speed: plan.exit,
                acceleration: S::ZERO,
            },
        };
        self.plan = Some(plan);
        if !whole {
            self.leave_span();
            if let Some(plan) = &mut self.plan {
                plan.spans -= 1;
            }
        }
        // In a nanosecond nothing moves, and a handover can be as short as that.
        (duration > S::from_f64(1e-9)).then_some(Piece {
            shape: head.shape,
            law,
            duration,
            tag: head.tag,
        })
    }

    fn horizon(&self) -> Horizon<'_, S, N> {
        Horizon {
            queue: &self.queue,
            place: self.place,
            motion: self.motion,
        }
    }

    fn leave_span(&mut self) {
        self.queue.pop();
        self.place = S::ZERO;
        self.stale = true;
    }
}

/// Whether passing a corner at its cap is faster than stopping at it: the time from
/// `middle` [m] before the corner, half of the corner's blend being passed at its cap.
///
/// Under a low jerk a tight corner's cap can be so low, and hold for so long, that
/// slowing to rest and setting off again takes less time.
fn saves_time<S: Scalar>(corner: &Caps<S>, half: S, middle: S, straight: &Caps<S>) -> bool {
    let time = |speed: S, way: S| {
        let fast = min(greatest_entry_speed(speed, way, straight), straight.speed);
        let slowing = ramp(fast, S::ZERO, speed, straight);
        let rest = max(way - distance(&slowing), S::ZERO) / fast;
        slowing.iter().fold(rest, |sum, phase| sum + phase.duration)
    };
    let rounded = half / corner.speed + time(corner.speed, middle - half);
    rounded < time(S::ZERO, middle)
}
