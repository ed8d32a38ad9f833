//! The codes of the current sensors at zero current, measured while the bridges are off: no motor
//! has a current then. The mean of 2048 ticks has an error of 0.04 codes where a code has 2.
//!
//! A zero is accepted if it is near the one of the settings and the sensor can still tell the
//! current that is a fault; otherwise the sensor or its wiring is at fault, and the arm is not
//! powered. Until the first zeros are measured, those of the settings are used.

use super::BrushedDrives;
use crate::settings::{AxisSettings, Settings};
use fivebar_kinematics::Scalar;
use fivebar_kinematics::five_bar::Joint;

/// Ticks of a mean.
const TICKS: u32 = 2048;
/// Ticks after the bridges went off in which the currents vanish.
const SETTLING_TICKS: u32 = 64;
/// Greatest difference from the settings' zero [codes]: 5 % of half the converter's range.
const TOLERANCE: f32 = 100.0;
/// The greatest code of the converters.
const FULL_SCALE: f32 = 4095.0;

/// Where the zero code of a sensor may lie.
#[derive(Clone)]
struct ZeroRange {
    /// The zero code of the settings.
    expected: f32,
    /// Codes that a sensor needs on either side: of the over-current, and one more.
    codes: f32,
}

/// The sums of the codes, and what was found last.
#[derive(Clone)]
pub(super) struct CurrentZeros {
    ranges: [ZeroRange; 2],
    sums: [u32; 2],
    /// Ticks since the bridges went off, or since the end of the last mean and the settling time.
    ticks: u32,
    plausible: [bool; 2],
}

impl CurrentZeros {
    pub(super) fn new(settings: &Settings) -> Self {
        let [axis1, axis4] = &settings.axes;
        let over_current = settings.protection.over_current;
        Self {
            ranges: [
                ZeroRange::new(axis1, over_current),
                ZeroRange::new(axis4, over_current),
            ],
            sums: [0; 2],
            ticks: 0,
            plausible: [true; 2],
        }
    }

    /// The bridges are on: the next mean begins when they are off.
    pub(super) fn restart(&mut self) {
        self.ticks = 0;
    }

    /// Whether both sensors' zeros are plausible, or not measured yet.
    pub(super) fn are_plausible(&self) -> bool {
        self.plausible == [true; 2]
    }

    /// Takes the codes of one tick with the bridges off; the means, once they are complete.
    fn take(&mut self, [code1, code4]: [u16; 2]) -> Option<[f32; 2]> {
        self.ticks += 1;
        if self.ticks <= SETTLING_TICKS {
            self.sums = [0; 2];
            return None;
        }
        let [sum1, sum4] = self.sums;
        self.sums = [sum1 + u32::from(code1), sum4 + u32::from(code4)];
        if self.ticks < SETTLING_TICKS + TICKS {
            return None;
        }
        let sums = core::mem::take(&mut self.sums);
        self.ticks = SETTLING_TICKS;
        Some(sums.map(|sum| sum as f32 / TICKS as f32))
    }
}

impl ZeroRange {
    fn new(axis: &AxisSettings, over_current: f32) -> Self {
        Self {
            expected: f32::from(axis.current_zero_code),
            codes: over_current / axis.current_per_code + 1.0,
        }
    }

    /// Whether a sensor with this zero code can be used.
    fn holds(&self, zero: f32) -> bool {
        let near = Scalar::abs(zero - self.expected) <= TOLERANCE;
        // Not `min`, which would call the library.
        near && self.codes <= zero && self.codes <= FULL_SCALE - zero
    }
}

impl BrushedDrives {
    /// One tick with the bridges off.
    pub(super) fn measure_zeros(&mut self, codes: [u16; 2]) {
        // Not a loop: the bound of the tick would have to state how often it runs.
        if let Some([zero1, zero4]) = self.zeros.take(codes) {
            self.judge_zero(Joint::Joint1, zero1);
            self.judge_zero(Joint::Joint4, zero4);
        }
    }

    /// Uses a joint's zero code, if it is plausible.
    fn judge_zero(&mut self, joint: Joint, zero: f32) {
        let zeros = &mut self.zeros;
        let (Some(range), Some(model), Some(plausible)) = (
            zeros.ranges.get(joint.index()),
            self.models.get_mut(joint.index()),
            zeros.plausible.get_mut(joint.index()),
        ) else {
            return;
        };
        *plausible = range.holds(zero);
        if *plausible {
            model.set_zero(zero);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_zero_leaves_room_for_the_over_current_and_one_code() {
        let [axis, _] = Settings::BENCHTOP.axes;
        // 6 A at 16/4096 A a code are 1536 codes.
        let axis = AxisSettings {
            current_zero_code: 1537,
            ..axis
        };
        let range = ZeroRange::new(&axis, 6.0);
        assert!(range.holds(1537.0));
        assert!(!range.holds(1536.5));
    }
}
