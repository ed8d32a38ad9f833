//! The detectors: measured numbers against trip points.
//!
//! Each looks at one thing and names one fault; the tick asks them in the order of
//! gravity. A NaN passes every comparison here and is caught by the tick itself, in what
//! it is about to tell the bridges.

use super::Fault;
use crate::settings::Settings;
use core::f32::consts::TAU;
use fivebar_kinematics::Scalar;
use fivebar_kinematics::five_bar::Links;

/// An innovation of so many counts is noise of the encoder's edges, whatever the speed.
const JUMP_COUNTS: f32 = 4.0;

/// Missed ticks at once that are only counted.
pub(crate) const TOLERATED_TICKS: u32 = 2;

/// The trip points.
pub(crate) struct Monitor {
    /// [rad], each joint's.
    jump: [f32; 2],
    /// [rad/s].
    over_speed: f32,
    /// [A].
    over_current: f32,
    /// [rad].
    following_error: f32,
    /// [V].
    bus: [f32; 2],
    /// [rad], the middle of each joint's range.
    middle: [f32; 2],
    /// [rad], how far from there it may be: half the range, and half of what a following
    /// error may add.
    reach: [f32; 2],
    /// Least |r2 × r3|: l2 l3 times the least |sin| at C [m²].
    margin: f32,
    /// Ticks.
    silence: u32,
}

impl Monitor {
    pub(crate) fn new(settings: &Settings) -> Self {
        let protection = &settings.protection;
        let rate = settings.control.tick_rate;
        let [_, l2, l3, ..] = settings.lengths;
        let slack = 0.5 * protection.following_error;
        Self {
            // What the joint turns in a tick at the over-speed, or a few counts.
            jump: settings.axes.map(|axis| {
                let count = TAU / (Scalar::abs(axis.gear_ratio) * axis.encoder_counts as f32);
                (JUMP_COUNTS * count).max(protection.over_speed / rate)
            }),
            over_speed: protection.over_speed,
            over_current: protection.over_current,
            following_error: protection.following_error,
            bus: protection.bus_voltage,
            middle: settings.axes.map(|axis| {
                let [low, high] = axis.angle_limits;
                0.5 * (low + high)
            }),
            reach: settings.axes.map(|axis| {
                let [low, high] = axis.angle_limits;
                0.5 * (high - low) + slack
            }),
            margin: 0.5 * settings.motion.singularity_margin * l2 * l3,
            silence: (protection.command_timeout * rate) as u32,
        }
    }

    /// A count that no joint can have turned.
    #[inline(always)]
    pub(crate) fn jumped(&self, innovation: [f32; 2]) -> bool {
        let ([innovation1, innovation4], [jump1, jump4]) = (innovation, self.jump);
        Scalar::abs(innovation1) > jump1 || Scalar::abs(innovation4) > jump4
    }

    /// Bus voltage [V].
    #[inline(always)]
    pub(crate) fn bus(&self, voltage: f32) -> Option<Fault> {
        let [low, high] = self.bus;
        if low <= voltage && voltage <= high {
            None
        } else if voltage < low {
            Some(Fault::UnderVoltage)
        } else {
            Some(Fault::OverVoltage)
        }
    }

    /// Motor currents [A].
    #[inline(always)]
    pub(crate) fn over_current(&self, current: [f32; 2]) -> bool {
        either_exceeds(current, self.over_current)
    }

    /// Joint speeds [rad/s].
    #[inline(always)]
    pub(crate) fn over_speed(&self, velocity: [f32; 2]) -> bool {
        either_exceeds(velocity, self.over_speed)
    }

    /// Position errors [rad].
    #[inline(always)]
    pub(crate) fn lost_its_path(&self, error: [f32; 2]) -> bool {
        either_exceeds(error, self.following_error)
    }

    /// Joint angles [rad] outside their limits.
    #[inline(always)]
    pub(crate) fn outside(&self, angle: [f32; 2]) -> bool {
        let ([angle1, angle4], [middle1, middle4]) = (angle, self.middle);
        let [reach1, reach4] = self.reach;
        Scalar::abs(angle1 - middle1) > reach1 || Scalar::abs(angle4 - middle4) > reach4
    }

    /// Links 2 and 3 too nearly in line (type 2): the motors lose the tool. A leg straight
    /// or folded (type 1) is no danger to the joints; paths of the tool are planned clear
    /// of it, and the following error bounds how far the arm is from its path.
    #[inline(always)]
    pub(crate) fn near_parallel(&self, links: &Links<f32>) -> bool {
        Scalar::abs(links.cross) < self.margin
    }

    /// Ticks since the host was heard.
    #[inline(always)]
    pub(crate) fn silent(&self, ticks: u32) -> bool {
        ticks > self.silence
    }
}

#[inline(always)]
fn either_exceeds([value1, value4]: [f32; 2], limit: f32) -> bool {
    Scalar::abs(value1) > limit || Scalar::abs(value4) > limit
}
