//! The pieces of path that the tick follows, and the clock by which it does.
//!
//! The clock counts ticks from the beginning of a piece, so that it stays true however long
//! the piece: a sum of `f32` periods would lose minutes in an hour.
//!
//! It can be slowed to a stand at any moment, which stops the arm on its path: with the
//! rate σ(x) = 1 − 3x² + 2x³, x = t/T, and σ̇ = −6x(1 − x)/T, the place p moves at σ p′ and
//! accelerates by σ² p″ + σ̇ p′. From a steady speed v the braking takes 1.5 v/T at most
//! and its jerk is 6 v/T² at most. The path gets ∫σ dt = T(x − x³ + ½x⁴) further, T/2 in all.
//!
//! Pieces come one by one, and ticks come between them. So a path that ends at rest goes on
//! only when what follows is enough to stop on, however long planning it takes.

use super::queue::{PIECES, Queue};
use crate::safety::Limits;
use crate::settings::Settings;
use fivebar_kinematics::Scalar;
use fivebar_kinematics::trajectory::{Piece, Reference};

/// With so many pieces to come or more, the planner is not behind, however short they are.
const FEW_PIECES: u32 = PIECES as u32 / 2;

/// A path that breaks off in motion is committed with so much in hand beyond a stop [s].
const READY: f32 = 0.02;

/// Pieces that one tick may leave behind; more make the path wait for the next tick.
const PIECES_PER_TICK: u32 = 2;

/// A piece of path and what the tick must know about it.
#[derive(Clone, Copy, Debug)]
pub struct Stretch {
    /// The piece.
    pub piece: Piece<f32>,
    /// It ends in motion: another must follow in time.
    pub open: bool,
    /// The limits for which its move goes slower than was asked for.
    pub limits: Limits,
}

/// The queue and the place in it; what every tick needs in front, see [`Controller`].
///
/// [`Controller`]: super::Controller
#[repr(C)]
pub(crate) struct Path {
    /// Ticks at full rate in the first piece.
    ticks: u32,
    /// Time into the first piece before those ticks [s].
    offset: f32,
    /// Committed time left, as of the last tick [s].
    left: f32,
    /// Of that, the time behind the first piece [s].
    behind: f32,
    /// The last committed stretch ends in motion.
    open: bool,
    /// The last stretch ends in motion.
    pushed_open: bool,
    brake: Option<Brake>,
    /// T [s].
    stopping_time: f32,
    /// What a stop takes of the path, T/2 and two ticks [s].
    least: f32,
    /// [s].
    period: f32,
    queue: Queue,
}

/// A stop in progress.
struct Brake {
    /// x, 0…1.
    phase: f32,
    /// T [s].
    time: f32,
    /// 1/T [1/s].
    rate: f32,
}

/// The clock while it is slowed.
struct Slowed {
    /// ∫σ dt, by which it has advanced since [s].
    advance: f32,
    /// σ.
    rate: f32,
    /// σ̇ [1/s].
    slope: f32,
    /// It stands.
    stands: bool,
}

/// T [s] of every stop: so long that even from full speed no limit of the tool's or the
/// joints' acceleration, or of the tool's jerk, is passed on a straight path.
pub(crate) fn stopping_time(settings: &Settings) -> f32 {
    let motion = &settings.motion;
    let mut time = Scalar::sqrt(6.0 * motion.max_speed / motion.max_jerk);
    let acceleration = (motion.max_speed, motion.max_acceleration);
    let joints = settings
        .axes
        .map(|axis| (axis.max_speed, axis.max_acceleration));
    for (speed, acceleration) in joints.into_iter().chain([acceleration]) {
        time = time.max(1.5 * speed / acceleration);
    }
    time
}

/// One tick's step along the path.
pub(crate) struct Step {
    /// Where the arm should be.
    pub(crate) reference: Reference<f32>,
    /// The limits for which its move goes slower than was asked for.
    pub(crate) limits: Limits,
    /// The arm has come to rest, at the path's end or braked.
    pub(crate) at_rest: bool,
}

impl Path {
    /// No path; stops will take `stopping_time` [s], ticks `period` [s].
    pub(crate) fn new(stopping_time: f32, period: f32) -> Self {
        Self {
            stopping_time,
            least: 0.5 * stopping_time + 2.0 * period,
            period,
            ticks: 0,
            offset: 0.0,
            left: 0.0,
            behind: 0.0,
            open: false,
            pushed_open: false,
            brake: None,
            queue: Queue::new(),
        }
    }

    /// Forgets everything.
    pub(crate) fn clear(&mut self) {
        self.pushed_open = false;
        self.queue.clear();
        self.finish();
    }

    /// Leaves all behind that was committed.
    pub(crate) fn finish(&mut self) {
        self.ticks = 0;
        self.offset = 0.0;
        self.left = 0.0;
        self.behind = 0.0;
        self.open = false;
        self.brake = None;
        self.queue.finish();
    }

    /// Whether there is no room for another piece.
    pub(crate) fn is_full(&self) -> bool {
        self.queue.is_full()
    }

    /// What is left of all that was pushed, as of the last tick [s].
    pub(crate) fn left(&self) -> f32 {
        self.left + self.queue.uncommitted()
    }

    /// Whether there is nothing to follow.
    #[inline(always)]
    pub(crate) fn is_empty(&self) -> bool {
        self.queue.is_empty()
    }

    /// Whether all that was pushed ends at rest, fills the queue, or is enough to begin with.
    pub(crate) fn is_enough(&self) -> bool {
        !self.pushed_open || self.queue.is_full() || self.left() >= self.least + READY
    }

    /// Whether the path breaks off in motion, and all that is left of it is needed to stop
    /// on, in few pieces: the planner is behind. A queue of many pieces can be as short while
    /// the planner keeps it full.
    #[inline(always)]
    pub(crate) fn runs_short(&self) -> bool {
        // The first comparison is the one that mostly decides.
        self.left < self.least && self.open && self.brake.is_none() && self.queue.len() < FEW_PIECES
    }

    /// Tag of the piece in progress.
    pub(crate) fn tag(&self) -> Option<u32> {
        self.queue.first().map(|first| first.stretch.piece.tag())
    }

    /// Appends a stretch, unless the queue is full.
    pub(crate) fn push(&mut self, stretch: Stretch) {
        if self.queue.push(stretch).is_err() {
            return;
        }
        self.pushed_open = stretch.open;
        // The committed path already ends in motion, so commit any extension at once.
        if self.open || self.is_enough() {
            self.commit();
        }
    }

    fn commit(&mut self) {
        let begins = self.is_empty();
        self.queue.commit();
        self.open = self.pushed_open;
        if let Some(first) = self.queue.first() {
            let before = self.behind;
            self.behind = self.queue.behind(first);
            self.left += self.behind - before;
            if begins {
                self.left += first.stretch.piece.duration();
            }
        }
    }

    /// Begins to come to rest; sooner than usual where a path that breaks off leaves no
    /// room for that.
    #[cold]
    pub(crate) fn brake(&mut self) {
        if self.brake.is_none() {
            let mut time = self.stopping_time;
            if self.open && self.left < self.least {
                let tick = self.period;
                time = 2.0 * (self.left - tick - tick);
                if time < tick + tick {
                    time = tick + tick;
                }
            }
            self.brake = Some(Brake {
                phase: 0.0,
                time,
                rate: 1.0 / time,
            });
        }
    }

    /// One tick along the path; `None` where there is none.
    #[inline(always)]
    pub(crate) fn step(&mut self) -> Option<Step> {
        let mut first = self.queue.first()?;
        let slowed = match &mut self.brake {
            None => {
                self.ticks = self.ticks.wrapping_add(1);
                None
            }
            Some(brake) => Some(brake.step(self.period)),
        };
        let advance = slowed.as_ref().map_or(0.0, |slowed| slowed.advance);
        let mut time = self.offset + self.period * self.ticks as f32 + advance;
        let mut duration = first.stretch.piece.duration();
        let mut ended = false;
        if time >= duration {
            for _ in 0..PIECES_PER_TICK {
                if self.queue.is_last() {
                    ended = true;
                    break;
                }
                time -= duration;
                self.queue.leave();
                first = self.queue.first()?;
                duration = first.stretch.piece.duration();
                if time < duration {
                    break;
                }
            }
            if time > duration {
                // The path has ended, or waits.
                time = duration;
            }
            self.ticks = 0;
            self.offset = time - advance;
            self.behind = self.queue.behind(first);
        }
        self.left = duration - time + self.behind;
        let mut progress = first.stretch.piece.progress(time);
        if let Some(Slowed { rate, slope, .. }) = slowed {
            progress = progress.clocked(rate, slope);
        }
        Some(Step {
            at_rest: ended || slowed.is_some_and(|slowed| slowed.stands),
            reference: first.stretch.piece.reference(progress),
            limits: first.stretch.limits,
        })
    }
}

impl Brake {
    /// One tick of the slowing clock.
    #[inline(always)]
    fn step(&mut self, period: f32) -> Slowed {
        self.phase += period * self.rate;
        if self.phase >= 1.0 {
            return Slowed {
                advance: 0.5 * self.time,
                rate: 0.0,
                slope: 0.0,
                stands: true,
            };
        }
        let x = self.phase;
        let square = x * x;
        Slowed {
            advance: self.time * (x + x * square * (0.5 * x - 1.0)),
            rate: 1.0 + square * (x + x - 3.0),
            slope: 6.0 * x * (x - 1.0) * self.rate,
            stands: false,
        }
    }
}

#[cfg(test)]
mod tests;
