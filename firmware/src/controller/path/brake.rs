//! A stop on the path by time scaling: the time along the path slows down to zero rate.
//!
//! With the rate σ(x) = 1 − 3x² + 2x³, x = t/T, and σ̇ = −6x(1 − x)/T, the point p moves at σ p′
//! and accelerates by σ² p″ + σ̇ p′. From a constant speed v the deceleration is at most 1.5 v/T
//! and the jerk at most 6 v/T². The time along the path advances by ∫σ dt = T(x − x³ + ½x⁴),
//! T/2 in all.

use crate::settings::CheckedSettings;
use fivebar_kinematics::Scalar;

/// A stop in progress.
#[derive(Clone)]
pub(super) struct Brake {
    /// x, 0…1.
    phase: f32,
    /// T [s].
    time: f32,
    /// 1/T [1/s].
    rate: f32,
}

/// The time scaling at one tick of a stop.
#[derive(Clone)]
pub(super) struct TimeScaling {
    /// ∫σ dt since the stop began [s].
    pub(super) advance: f32,
    /// σ.
    pub(super) sigma: f32,
    /// σ̇ [1/s].
    pub(super) sigma_dot: f32,
    /// The stop is complete.
    pub(super) complete: bool,
}

/// T [s] of every stop: long enough that a stop from full speed on a straight path keeps the
/// limits of the tool's acceleration and jerk and of the joints' acceleration.
pub(crate) fn stopping_time(settings: &CheckedSettings) -> f32 {
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

impl Brake {
    /// A stop that takes T = `time` [s].
    pub(super) fn new(time: f32) -> Self {
        Self {
            phase: 0.0,
            time,
            rate: 1.0 / time,
        }
    }

    /// Advances the stop by one tick of `period` [s].
    #[inline(always)]
    pub(super) fn step(&mut self, period: f32) -> TimeScaling {
        self.phase += period * self.rate;
        if self.phase >= 1.0 {
            return TimeScaling {
                advance: 0.5 * self.time,
                sigma: 0.0,
                sigma_dot: 0.0,
                complete: true,
            };
        }
        let x = self.phase;
        let square = x * x;
        TimeScaling {
            advance: self.time * (x + x * square * (0.5 * x - 1.0)),
            sigma: 1.0 + square * (x + x - 3.0),
            sigma_dot: 6.0 * x * (x - 1.0) * self.rate,
            complete: false,
        }
    }
}
