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

/// Pieces that one tick may leave behind; more make the path wait for the next tick.
const PIECES_PER_TICK: u32 = 4;

/// The queue and the place in it.
pub(crate) struct Path {
    pieces: Deque<Piece<f32>, PIECES>,
    /// Whether the last piece in the queue ends in motion.
    open: bool,
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
    /// The arm has come to rest, at the path's end or braked.
    pub(crate) at_rest: bool,
}

impl Path {
    pub(crate) fn new() -> Self {
        Self {
            pieces: Deque::new(),
            open: false,
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
        self.left < horizon && !self.pieces.is_full()
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.pieces.is_empty()
    }

    /// Time left in the queue [s].
    #[inline]
    pub(crate) fn left(&self) -> f32 {
        self.left
    }

    /// Whether the path breaks off in motion, nothing has been done about it and there is
    /// room for more: the planner is behind.
    #[inline]
    pub(crate) fn waits_for_more(&self) -> bool {
        self.open && self.brake.is_none() && !self.pieces.is_full()
    }

    /// Tag of the piece in progress.
    pub(crate) fn tag(&self) -> Option<u32> {
        self.pieces.front().map(Piece::tag)
    }

    /// Appends a piece, `open` if it ends in motion; gives it back where there is no room.
    pub(crate) fn push(&mut self, piece: Piece<f32>, open: bool) -> Result<(), Piece<f32>> {
        self.pieces.push_back(piece)?;
        self.open = open;
        self.left += piece.duration();
        Ok(())
    }

    /// Begins to come to rest within `duration` [s], or sooner where a path that breaks
    /// off leaves no room for that.
    #[inline]
    pub(crate) fn brake(&mut self, duration: f32, period: f32) {
        if self.brake.is_none() {
            let room = 2.0 * (self.left - 2.0 * period);
            let duration = if self.open && room < duration {
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
        if self.pieces.is_empty() {
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
            let duration = self.pieces.front()?.duration();
            if self.time < duration || self.pieces.len() == 1 {
                break;
            }
            self.time -= duration;
            self.pieces.pop_front();
        }
        let piece = self.pieces.front()?;
        let ended = self.time >= piece.duration() && self.pieces.len() == 1;
        let time = self.time.min(piece.duration());
        let reference = piece.evaluate(time);
        Some(Step {
            reference: if self.brake.is_some() {
                reference.clocked(rate, slope)
            } else {
                reference
            },
            at_rest: ended || braked,
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
