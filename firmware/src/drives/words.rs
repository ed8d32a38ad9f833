//! What a row of the log and the last sample tell of the drives: words of 16 bits, whose meaning is that of the kind of drive.
//!
//! | | sensed of each joint | told to each joint | sensed of both |
//! |---|---|---|---|
//! | brushed motors | current [ADC codes] | duty times 32767 | bus voltage [ADC codes] |
//! | torque drives | torque that the drive tells | torque that it is told to give | ticks since the answers of joints 1 (lower byte) and 4, 255 at most |
//! | step drives | micro-steps made so far, the lower 16 bits | micro-steps until the next tick | 0 |
//!
//! A torque is one at the joint, as a signed share of the drive's peak torque: that is [`PEAK_TORQUE`].

use serde::{Deserialize, Serialize};

/// The word of a drive's peak torque. A word holds up to twice as much.
pub const PEAK_TORQUE: f32 = 16_384.0;

/// The words of what the drives sense.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct SensedWords {
    /// Of each joint.
    pub joints: [u16; 2],
    /// Of both.
    pub both: u16,
}

/// The torque of a word [N·m], of a drive with this peak torque at the joint [N·m].
pub fn torque_of(word: u16, peak_torque: f32) -> f32 {
    f32::from(word as i16) * (peak_torque / PEAK_TORQUE)
}
