//! The pulses of hobby servos: where the settings of an arm say them.
//!
//! A servo has no converter, no model of its heat and no index output, so their numbers in [`AxisSettings`] say what its pulses
//! need, as they do of drives on a bus. No other settings are longer for that.
//!
//! | number of an axis | with a hobby servo |
//! |---|---|
//! | `index_counts` | the width of the pulse at the home angle [ns] |
//! | `thermal_time_constant` | pulses in a second [Hz] |

use super::{AxisSettings, HomingMethod, Settings};

/// [1/ns].
const NANOSECONDS: f32 = 1e9;

/// The pulses of a servo.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ServoPulse {
    /// Width at the home angle [s].
    pub home_width: f32,
    /// Pulses in a second [Hz].
    pub frame_rate: f32,
}

impl ServoPulse {
    /// The shortest and the longest pulse that any servo takes, in microseconds.
    pub const WIDTHS: [u32; 2] = [300, 2700];
    /// The least and the greatest number of pulses in a second [Hz]: of analogue and of digital servos.
    pub const FRAME_RATES: [f32; 2] = [50.0, 333.0];

    /// What an axis says; none if it is no servo's.
    fn of(axis: &AxisSettings) -> Option<Self> {
        let [shortest, longest] = Self::WIDTHS.map(|width| 1000 * width);
        let [least, most] = Self::FRAME_RATES;
        let is_servo = (shortest..=longest).contains(&axis.index_counts)
            && (least..=most).contains(&axis.thermal_time_constant);
        is_servo.then(|| Self {
            home_width: axis.index_counts as f32 / NANOSECONDS,
            frame_rate: axis.thermal_time_constant,
        })
    }

    /// Writes it into an axis.
    pub fn put(&self, axis: &mut AxisSettings) {
        // `as` saturates.
        axis.index_counts = (self.home_width * NANOSECONDS + 0.5) as u32;
        axis.thermal_time_constant = self.frame_rate;
    }
}

impl Settings {
    /// The pulses of the servos of joint 1 and joint 4; none if other motors turn them.
    pub fn servo_pulses(&self) -> Option<[ServoPulse; 2]> {
        let [axis1, axis4] = &self.axes;
        let pulses = [ServoPulse::of(axis1)?, ServoPulse::of(axis4)?];
        let knows_its_angle = self.home_reference.method == HomingMethod::Absolute;
        (knows_its_angle && self.bus_drives().is_none()).then_some(pulses)
    }
}
