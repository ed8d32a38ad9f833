//! Homing to switches: each joint searches for its own switch, both at the same time.
//!
//! A joint approaches until its switch closes, backs off until the switch is open and `back_off`
//! further, and creeps back at an eighth of the speed. The counts at which the switch closes then
//! belong to the home angle. A joint that starts on its switch begins by backing off. The search
//! fails if the joint passes its whole range without finding the switch, or cannot leave it.

use crate::settings::{AxisSettings, HomingSettings};
use fivebar_kinematics::Scalar;

/// The constants of one joint's search.
#[derive(Clone, Copy, Debug)]
pub(super) struct HomingConfig {
    /// Towards the switch, signed [rad/s].
    speed: f32,
    /// [rad].
    back_off: f32,
    /// The longest approach [rad]: the joint's range and an allowance for overrun.
    range: f32,
    /// Greatest change of the reference's speed [rad/s²].
    acceleration: f32,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Phase {
    Approach { from: f32 },
    BackOff { from: f32 },
    Creep { from: f32 },
    Found { counts: i32 },
}

/// The search of one joint.
#[derive(Clone, Copy, Debug)]
pub(super) struct HomingState {
    phase: Phase,
    /// Reference of the joint's angle [rad], from an unknown origin, and speed [rad/s].
    pub(super) angle: f32,
    pub(super) rate: f32,
}

/// The joint went as far as it may and did not find its switch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct SwitchNotFound;

impl HomingConfig {
    pub(super) fn new(axis: &AxisSettings, homing: &HomingSettings) -> Self {
        let [low, high] = axis.angle_limits;
        let speed = if axis.home_forward {
            homing.speed
        } else {
            -homing.speed
        };
        Self {
            speed,
            back_off: homing.back_off,
            range: high - low + 2.0 * homing.back_off,
            // The first approach reaches its speed in 0.1 s.
            acceleration: 10.0 * homing.speed,
        }
    }
}

impl HomingState {
    /// A search that begins at `angle` [rad]. If the switch is closed already, its first step
    /// begins to back off.
    pub(super) fn new(angle: f32) -> Self {
        Self {
            phase: Phase::Approach { from: angle },
            angle,
            rate: 0.0,
        }
    }

    /// The counts at which the switch closed, once found.
    pub(super) fn found(&self) -> Option<i32> {
        match self.phase {
            Phase::Found { counts } => Some(counts),
            Phase::Approach { .. } | Phase::BackOff { .. } | Phase::Creep { .. } => None,
        }
    }

    /// One tick of `period` [s], with the switch, the measured angle [rad] and its counts.
    pub(super) fn step(
        &mut self,
        config: &HomingConfig,
        closed: bool,
        angle: f32,
        counts: i32,
        period: f32,
    ) -> Result<(), SwitchNotFound> {
        let gone = |from: f32| Scalar::abs(angle - from);
        let wanted = match self.phase {
            Phase::Approach { from } => {
                if closed {
                    self.phase = Phase::BackOff { from: angle };
                } else if gone(from) > config.range {
                    return Err(SwitchNotFound);
                }
                config.speed
            }
            Phase::BackOff { from } => {
                if closed && gone(from) > 4.0 * config.back_off {
                    return Err(SwitchNotFound);
                }
                if !closed && gone(from) >= config.back_off {
                    self.phase = Phase::Creep { from: angle };
                }
                -config.speed
            }
            Phase::Creep { from } => {
                if closed {
                    self.phase = Phase::Found { counts };
                } else if gone(from) > 6.0 * config.back_off {
                    return Err(SwitchNotFound);
                }
                0.125 * config.speed
            }
            Phase::Found { .. } => 0.0,
        };
        let most = config.acceleration * period;
        self.rate += limited(wanted - self.rate, most);
        self.angle += self.rate * period;
        Ok(())
    }
}

/// `value` brought within ±`limit`; NaN stays NaN.
#[inline(always)]
pub(super) fn limited(value: f32, limit: f32) -> f32 {
    if Scalar::abs(value) > limit {
        if value > 0.0 { limit } else { -limit }
    } else {
        value
    }
}
