//! A voltage or a current on one motor, to measure motor and wiring before anything is known of them.

use crate::settings::Settings;
use fivebar_kinematics::Scalar;
use serde::{Deserialize, Serialize};

/// The longest excitation [s].
pub const LONGEST_EXCITATION: f32 = 2.0;
/// The longest pulse whose current may reach the over-current [s]: the bridge's own limit shows in it.
pub const LONGEST_PULSE: f32 = 2e-3;
/// The farthest travel of a joint during an excitation [rad].
pub const FARTHEST_EXCITATION: f32 = 2.0;

/// What an excitation sets.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Excited {
    /// The motor's voltage; values in V.
    Voltage,
    /// The motor's current, by the current loop; values in A.
    Current,
}

/// An excitation: `offset` ± `amplitude`, the sign by a pseudo-random binary sequence.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Excitation {
    /// The bridge: 0 is joint 1's, 1 is joint 4's.
    pub joint: u8,
    /// What is set.
    pub of: Excited,
    /// The mean [V or A].
    pub offset: f32,
    /// The amplitude of the sequence around it [V or A]; 0 for a constant value.
    pub amplitude: f32,
    /// Ticks for which each value of the sequence lasts, from 1.
    pub hold: u16,
    /// Duration [ticks], at most [`LONGEST_EXCITATION`].
    pub ticks: u32,
    /// Measured current of either motor at which it ends [A]; at most the motor's continuous
    /// current, or the over-current for a voltage of at most [`LONGEST_PULSE`]. Voltages are at most twice what drives it through the winding at rest.
    pub current: f32,
    /// Travel of either joint at which it ends [rad]; at most [`FARTHEST_EXCITATION`].
    pub travel: f32,
}

impl Excitation {
    /// Whether every value is within its bounds for an arm of these settings.
    pub(crate) fn is_bounded(&self, settings: &Settings) -> bool {
        let Some(axis) = settings.axes.get(usize::from(self.joint)) else {
            return false;
        };
        let most = match self.of {
            Excited::Voltage => 2.0 * axis.resistance * self.current,
            Excited::Current => self.current,
        };
        let size = Scalar::abs(self.offset) + Scalar::abs(self.amplitude);
        // A comparison with NaN is false.
        let rate = settings.control.tick_rate;
        let is_pulse = self.of == Excited::Voltage && (self.ticks as f32) <= LONGEST_PULSE * rate;
        let greatest = if is_pulse {
            settings.protection.over_current
        } else {
            axis.continuous_current
        };
        let small = size <= most && self.current > 0.0 && self.current <= greatest;
        let near = self.travel > 0.0 && self.travel <= FARTHEST_EXCITATION;
        let short = (self.ticks as f32) <= LONGEST_EXCITATION * rate;
        small && near && short && self.ticks > 0 && self.hold > 0
    }
}
