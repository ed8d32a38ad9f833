//! The pieces of path that the tick follows, and the clock by which it does.
//!
//! The clock can be slowed to a stand at any moment, which stops the arm on its path: with
//! the rate σ(x) = 1 − 3x² + 2x³, x = t/T, and σ̇ = −6x(1 − x)/T, the place p moves at
//! σ p′ and accelerates by σ² p″ + σ̇ p′. At a steady speed v the braking takes 1.5 v/T at
//! most and its jerk is 6 v/T² at most, and the path gets T/2 further.

use crate::settings::Settings;
use fivebar_kinematics::Scalar;
use fivebar_kinematics::trajectory::{Piece, Reference};
use heapless::Deque;

/// Pieces that wait for the tick: the committed future of the arm.
pub const PIECES: usize = 32;

/// A path that breaks off in motion is begun with so much in hand [s].
const READY: f32 = 0.02;

/// Pieces that one tick may leave behind; more make the path wait for the next tick.
const PIECES_PER_TICK: u32 = 4;

/// A piece of path and what the tick must know about it.
#[derive(Clone, Copy, Debug)]
pub struct Stretch {
    /// The piece.
    pub piece: Piece<f32>,
    /// It ends in motion: another must follow in time.
    pub open: bool,
    /// Its move goes slower than was asked for, to keep a limit.
    pub slowed: bool,
}

/// The queue and the place in it.
pub(crate) struct Path {
    stretches: Deque<Stretch, PIECES>,
    /// Time into the first piece [s].
    time: f32,
    /// Time left in the queue [s].
    left: f32,
    brake: Option<Brake>,
}

/// A stop in progress.
struct Brake {
    /// x, 0…1.
    phase: f32,
    /// 1/T [1/s].
    rate: f32,
}

/// The limits that brakes keep.
pub(crate) struct BrakeLimits {
    acceleration: f32,
    jerk: f32,
    joint_acceleration: [f32; 2],
}

impl BrakeLimits {
    pub(crate) fn new(settings: &Settings) -> Self {
        Self {
            acceleration: settings.motion.max_acceleration,
            jerk: settings.motion.max_jerk,
            joint_acceleration: settings.axes.map(|axis| axis.max_acceleration),
        }
    }

    /// T for a stop from this speed of the tool [m/s] and of the joints [rad/s]: never
    /// shorter than 10 ms.
    #[inline]
    pub(crate) fn duration(&self, speed: f32, omega: [f32; 2]) -> f32 {
        let [omega1, omega4] = omega;
        let [alpha1, alpha4] = self.joint_acceleration;
        (1.5 * speed / self.acceleration)
            .max(Scalar::sqrt(6.0 * speed / self.jerk))
            .max(1.5 * Scalar::abs(omega1) / alpha1)
            .max(1.5 * Scalar::abs(omega4) / alpha4)
            .max(0.01)
    }
}

/// The longest stop [s]: from full speed.
pub(crate) fn longest_stop(settings: &Settings) -> f32 {
    let omega = settings.axes.map(|axis| axis.max_speed);
    BrakeLimits::new(settings).duration(settings.motion.max_speed, omega)
}

/// One tick's step along the path.
pub(crate) struct Step {
    /// Where the arm should be.
    pub(crate) reference: Reference<f32>,
    /// Its move goes slower than was asked for.
    pub(crate) slowed: bool,
    /// The arm has come to rest, at the path's end or braked.
    pub(crate) at_rest: bool,
}

impl Path {
    pub(crate) fn new() -> Self {
        Self {
            stretches: Deque::new(),
            time: 0.0,
            left: 0.0,
            brake: None,
        }
    }

    /// Forgets everything.
    pub(crate) fn clear(&mut self) {
        *self = Self::new();
    }

    /// Whether there is room for another piece, and less than `horizon` [s] of path.
    pub(crate) fn wants(&self, horizon: f32) -> bool {
        self.left < horizon && !self.stretches.is_full()
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.stretches.is_empty()
    }

    /// Time left in the queue [s].
    #[inline]
    pub(crate) fn left(&self) -> f32 {
        self.left
    }

    /// Whether there is enough of a path to begin with.
    #[inline]
    pub(crate) fn is_ready(&self) -> bool {
        !self.is_empty() && (self.left >= READY || !self.waits_for_more())
    }

    /// Whether the path breaks off in motion, nothing has been done about it and there is
    /// room for more: the planner is behind.
    #[inline]
    pub(crate) fn waits_for_more(&self) -> bool {
        self.is_open() && self.brake.is_none() && !self.stretches.is_full()
    }

    /// Tag of the piece in progress.
    pub(crate) fn tag(&self) -> Option<u32> {
        self.stretches.front().map(|stretch| stretch.piece.tag())
    }

    /// Appends a stretch; gives it back where there is no room.
    pub(crate) fn push(&mut self, stretch: Stretch) -> Result<(), Stretch> {
        self.stretches.push_back(stretch)?;
        self.left += stretch.piece.duration();
        Ok(())
    }

    /// Whether the path breaks off in motion.
    #[inline]
    fn is_open(&self) -> bool {
        self.stretches.back().is_some_and(|stretch| stretch.open)
    }

    /// Begins to come to rest within `duration` [s], or sooner where a path that breaks
    /// off leaves no room for that.
    #[inline]
    pub(crate) fn brake(&mut self, duration: f32, period: f32) {
        if self.brake.is_none() {
            let room = 2.0 * (self.left - 2.0 * period);
            let duration = if self.is_open() && room < duration {
                room.max(2.0 * period)
            } else {
                duration
            };
            self.brake = Some(Brake {
                phase: 0.0,
                rate: 1.0 / duration,
            });
        }
    }

    /// One tick of `period` [s] along the path; `None` where there is none.
    #[inline]
    pub(crate) fn step(&mut self, period: f32) -> Option<Step> {
        if self.stretches.is_empty() {
            return None;
        }
        let (rate, slope, braked) = match &mut self.brake {
            None => (1.0, 0.0, false),
            Some(brake) => brake.step(period),
        };
        let passed = period * rate;
        self.time += passed;
        self.left -= passed;
        for _ in 0..PIECES_PER_TICK {
            let duration = self.stretches.front()?.piece.duration();
            if self.time < duration || self.stretches.len() == 1 {
                break;
            }
            self.time -= duration;
            self.stretches.pop_front();
        }
        let Stretch { piece, slowed, .. } = self.stretches.front()?;
        let ended = self.time >= piece.duration() && self.stretches.len() == 1;
        let time = self.time.min(piece.duration());
        let reference = piece.evaluate(time);
        Some(Step {
            reference: if self.brake.is_some() {
                reference.clocked(rate, slope)
            } else {
                reference
            },
            at_rest: ended || braked,
            slowed: *slowed,
        })
    }
}

impl Brake {
    /// σ, σ̇ [1/s] and whether the clock stands.
    #[inline]
    fn step(&mut self, period: f32) -> (f32, f32, bool) {
        self.phase += period * self.rate;
        if self.phase >= 1.0 {
            return (0.0, 0.0, true);
        }
        let x = self.phase;
        (
            1.0 + x * x * (x + x - 3.0),
            6.0 * x * (x - 1.0) * self.rate,
            false,
        )
    }
}
