//! The monitor compares measured values with their trip points.
//!
//! Each function detects one fault; the tick calls them with the most serious fault first. A NaN
//! passes every comparison here; the tick detects it in the duties, before the bridges get them.

use crate::settings::CheckedSettings;
use core::f32::consts::TAU;
use fivebar_kinematics::Scalar;
use fivebar_kinematics::five_bar::Links;

/// An innovation of up to this many counts is noise of the encoder's edges at any speed.
const JUMP_COUNTS: f32 = 4.0;

/// So many missed ticks in a row are counted and raise no fault.
pub(crate) const TOLERATED_TICKS: u32 = 2;

/// Ticks within which the tick notices that a host is silent, and latches the fault.
pub(crate) const NOTICED_WITHIN: u32 = 9;

/// The trip points.
#[derive(Clone)]
pub(crate) struct Monitor {
    /// Greatest innovation of each joint [rad].
    jump: [f32; 2],
    /// [rad/s].
    over_speed: f32,
    /// [rad].
    following_error: f32,
    /// The middle of each joint's range [rad].
    middle: [f32; 2],
    /// Greatest distance from the middle [rad]: half the range, and half of the greatest
    /// following error.
    reach: [f32; 2],
    /// Least |r2 × r3|: l2 l3 times the least |sin| at C [m²].
    margin: f32,
    /// The command timeout, less [`NOTICED_WITHIN`] [ticks].
    silence: u32,
    /// The disarm timeout, less the same [ticks].
    abandonment: u32,
}

impl Monitor {
    pub(crate) fn new(settings: &CheckedSettings) -> Self {
        let protection = &settings.protection;
        let rate = settings.control.tick_rate;
        let [_, l2, l3, ..] = settings.lengths;
        let slack = 0.5 * protection.following_error;
        Self {
            // The angle of one tick at the over-speed, or a few counts if that is more.
            jump: settings.axes.map(|axis| {
                let count = TAU / (Scalar::abs(axis.gear_ratio) * axis.encoder_counts as f32);
                (JUMP_COUNTS * count).max(protection.over_speed / rate)
            }),
            over_speed: protection.over_speed,
            following_error: protection.following_error,
            middle: settings.axes.map(|axis| {
                let [low, high] = axis.angle_limits;
                0.5 * (low + high)
            }),
            reach: settings.axes.map(|axis| {
                let [low, high] = axis.angle_limits;
                0.5 * (high - low) + slack
            }),
            margin: 0.5 * settings.motion.singularity_margin * l2 * l3,
            silence: in_time(protection.command_timeout * rate),
            // An arm that nobody commands must not stay powered for ever.
            abandonment: in_time(settings.advanced.disarm_timeout * rate),
        }
    }

    /// Whether a joint's innovation [rad] is physically impossible.
    #[inline(always)]
    pub(crate) fn jumped(&self, innovation: [f32; 2]) -> bool {
        let ([innovation1, innovation4], [jump1, jump4]) = (innovation, self.jump);
        Scalar::abs(innovation1) > jump1 || Scalar::abs(innovation4) > jump4
    }

    /// Whether a joint's speed [rad/s] is too high.
    #[inline(always)]
    pub(crate) fn over_speed(&self, velocity: [f32; 2]) -> bool {
        either_exceeds(velocity, self.over_speed)
    }

    /// Whether a position error [rad] is too large.
    #[inline(always)]
    pub(crate) fn following_error_exceeded(&self, error: [f32; 2]) -> bool {
        either_exceeds(error, self.following_error)
    }

    /// Whether a joint's angle [rad] is outside its limits.
    #[inline(always)]
    pub(crate) fn outside(&self, angle: [f32; 2]) -> bool {
        let ([angle1, angle4], [middle1, middle4]) = (angle, self.middle);
        let [reach1, reach4] = self.reach;
        Scalar::abs(angle1 - middle1) > reach1 || Scalar::abs(angle4 - middle4) > reach4
    }

    /// Whether links 2 and 3 are too nearly in line (type 2), where the motors cannot hold the
    /// tool. A leg straight or folded (type 1) is not a fault: the joints stay controllable,
    /// paths of the tool keep clear of it, and the following error bounds the distance from the
    /// path.
    #[inline(always)]
    pub(crate) fn near_parallel(&self, links: &Links<f32>) -> bool {
        Scalar::abs(links.cross) < self.margin
    }

    /// Whether the host has been silent for so many ticks that the arm is left alone.
    #[inline(always)]
    pub(crate) fn abandoned(&self, ticks: u32) -> bool {
        ticks > self.abandonment
    }

    /// Whether the host has been silent for too many ticks.
    #[inline(always)]
    pub(crate) fn silent(&self, ticks: u32) -> bool {
        ticks > self.silence
    }
}

/// The ticks of silence after which a fault is latched within `ticks` of it.
fn in_time(ticks: f32) -> u32 {
    (ticks as u32).saturating_sub(NOTICED_WITHIN)
}

#[inline(always)]
fn either_exceeds([value1, value4]: [f32; 2], limit: f32) -> bool {
    Scalar::abs(value1) > limit || Scalar::abs(value4) > limit
}

#[cfg(test)]
mod tests;
