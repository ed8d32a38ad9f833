//! How the controller finds the joints' angles.

use super::{AxisSettings, Settings};
use core::f32::consts::TAU;
use fivebar_kinematics::Scalar;
use serde::{Deserialize, Serialize};

/// Share of the homing speed with which a joint creeps to its switch or stop, and to its index pulse.
pub(crate) const CREEP: f32 = 0.125;
/// Samples in a row after which an index pulse is believed. A pulse lasts one count, and each count
/// twice as many ticks.
pub(crate) const INDEX_SAMPLES: u8 = 2;
/// Share of the angle from one index pulse to the next that a pulse must keep from the switch, so that
/// the switch tells which of the pulses it is.
pub const INDEX_MARGIN: f32 = 0.0625;

/// The search for the home switches or the hard stops.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct HomingSettings {
    /// Speed of the first approach [rad/s]; the second approach, and the motion to an index pulse, have
    /// an eighth of it.
    pub speed: f32,
    /// Distance to back off from a closed switch or a stop [rad].
    pub back_off: f32,
    /// Greatest motor current while homing [A].
    pub current: f32,
}

/// Where the joints' angles come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum HomingMethod {
    /// Each joint searches for its home switch.
    Switch,
    /// Each joint drives against a hard stop until its motor takes the homing current and it stands
    /// still.
    HardStop,
    /// Encoders that know their angle count from 0 at the home angles, or from whole turns of the joint.
    /// Nothing moves.
    Absolute,
    /// The arm stands at its home angles when the host asks for homing. Nothing moves.
    Given,
    /// Each joint searches for its home switch, and away from it for the encoder's index pulse. The
    /// home angle is that of the pulse.
    Index,
}

/// The source of the joints' angles, and how much it takes to believe it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct HomeReference {
    /// The source.
    pub method: HomingMethod,
    /// Samples in a row in which a switch, or the feeling of a stop, must be the same.
    pub samples: u8,
}

impl HomeReference {
    /// Home switches, which are believed after eight samples: 0.8 ms at 10 kHz. A disturbance by the
    /// motors' PWM lasts one tick; the switches' RC filter in `docs/use/wiring.md` takes 1 ms.
    pub const SWITCHES: Self = Self {
        method: HomingMethod::Switch,
        samples: 8,
    };
}

impl Settings {
    /// Whether the method can find this arm's angles within its limits.
    ///
    /// An index pulse must last long enough at the creeping speed. A stop is felt at no more than the continuous currents; until it is believed, the reference
    /// gains less than half of the greatest following error on the joint; and the range of the
    /// angles ends before it, by no more than the distance to back off. An absolute encoder shows one angle only in
    /// a range of a turn.
    pub(super) fn homing_method_fits(&self) -> bool {
        let search = &self.homing;
        let felt_in = f32::from(self.home_reference.samples) / self.control.tick_rate;
        let axes = &self.axes;
        match self.home_reference.method {
            HomingMethod::Switch | HomingMethod::Given => true,
            HomingMethod::Index => axes.iter().all(|axis| {
                let counts = axis.counts_per_turn();
                let fastest = HomingSettings::fastest_to_index(counts, self.control.tick_rate);
                search.speed <= fastest && axis.index_counts > 0
            }),
            HomingMethod::HardStop => {
                search.speed * felt_in <= 0.5 * self.protection.following_error
                    && axes.iter().all(|axis| {
                        search.current <= axis.continuous_current
                            && axis.ends_before_its_stop(search.back_off)
                    })
            }
            HomingMethod::Absolute => axes.iter().all(|axis| {
                let [low, high] = axis.angle_limits;
                high - low <= TAU
            }),
        }
    }
}

impl HomingSettings {
    /// The greatest homing speed [rad/s] at which an index pulse of one count is seen for sure, with
    /// so many counts in a turn of the joint: at the creeping speed, each count then lasts twice the
    /// samples after which a pulse is believed.
    pub fn fastest_to_index(counts_per_turn: f32, tick_rate: f32) -> f32 {
        let counts_per_second = tick_rate / (2.0 * f32::from(INDEX_SAMPLES));
        counts_per_second * TAU / (CREEP * counts_per_turn)
    }
}

impl AxisSettings {
    /// Encoder counts in a turn of the joint, whatever their sign.
    pub(crate) fn counts_per_turn(&self) -> f32 {
        self.encoder_counts as f32 * Scalar::abs(self.gear_ratio)
    }

    /// Whether the angles' range ends before a stop at the home angle, by no more than this.
    fn ends_before_its_stop(&self, back_off: f32) -> bool {
        let [low, high] = self.angle_limits;
        let beyond = if self.home_forward {
            self.home_angle - high
        } else {
            low - self.home_angle
        };
        (0.0..=back_off).contains(&beyond)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn at_the_fastest_creep_to_an_index_a_count_lasts_twice_its_samples() {
        let (counts_per_turn, tick_rate) = (65_536.0, 10_000.0);
        let speed = CREEP * HomingSettings::fastest_to_index(counts_per_turn, tick_rate);
        let ticks_per_count = tick_rate / (speed / TAU * counts_per_turn);
        assert!((ticks_per_count - 2.0 * f32::from(INDEX_SAMPLES)).abs() < 1e-3);
    }
}
