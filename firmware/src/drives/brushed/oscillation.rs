//! How the tick finds a loop that oscillates, before its motor gets hot.
//!
//! An unstable loop soon demands current from limit to limit. Once in all turns, the changes of the
//! current set-point over half of them and over all are compared with the greatest current:
//!
//! m ← m + (|i − i₋₈| + |i − i₋₁₆| − m)/256, a fault above the peak current.
//!
//! At 10 kHz these are the changes over 0.8 ms and 1.6 ms, once in 1.6 ms. A sine of full amplitude and
//! frequency f has the mean (4/π) (|sin(π f · 0.8 ms)| + |sin(π f · 1.6 ms)|), which is above 1 from 108 Hz on. The
//! change over 0.8 ms alone would find it from 161 Hz on, and that over 1.6 ms would not find 625 Hz. An arm
//! that moves has a tenth; the counts of an arm whose tool is far from its joints can
//! make 0.8. The mean is over 0.4 s, so an arm that chatters for a moment is no fault.

use crate::settings::AxisSettings;
use fivebar_kinematics::Scalar;

/// Weight of a new change.
const WEIGHT: f32 = 1.0 / 256.0;
/// Greatest mean of both changes together, per peak current.
const GREATEST: f32 = 1.0;

/// The mean changes of a joint's current set-point.
#[derive(Clone)]
pub(super) struct Oscillation {
    /// The set-points half of the turns ago, and all of them ago [A].
    before: [f32; 2],
    /// m [A].
    mean: f32,
}

/// The greatest mean of the changes [A] of a joint's current set-point.
pub(super) fn limit(axis: &AxisSettings) -> f32 {
    GREATEST * axis.peak_current
}

impl Oscillation {
    pub(super) const NONE: Self = Self {
        before: [0.0; 2],
        mean: 0.0,
    };

    /// Half of the turns before [`Oscillation::exceeds`].
    #[inline(always)]
    pub(super) fn begin(&mut self, demand: f32) {
        let [half, _] = &mut self.before;
        *half = demand;
    }

    /// Whether the mean of the changes of the set-point `demand` [A] is above the limit [A].
    #[inline(always)]
    pub(super) fn exceeds(&mut self, demand: f32, limit: f32) -> bool {
        let [half, all] = self.before;
        let changes = Scalar::abs(demand - half) + Scalar::abs(demand - all);
        self.before = [half, demand];
        self.mean += (changes - self.mean) * WEIGHT;
        self.mean > limit
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::settings::Settings;
    use core::f32::consts::TAU;

    #[test]
    fn the_limit_is_the_joint_s_own_peak_current() {
        for axis in Settings::BENCHTOP.axes {
            for peak_current in [1.2, 6.0] {
                let axis = AxisSettings {
                    peak_current,
                    ..axis
                };
                assert_eq!(limit(&axis), peak_current);
            }
        }
    }

    /// The turns after which a set-point, as a function of the time [turns], is a fault.
    fn turns(set_point: impl Fn(f32) -> f32) -> Option<u32> {
        let mut oscillation = Oscillation::NONE;
        (1..2000).find(|&turn| {
            oscillation.begin(set_point(turn as f32 - 0.5));
            oscillation.exceeds(set_point(turn as f32), GREATEST)
        })
    }

    #[test]
    fn sines_from_limit_to_limit_are_found_from_the_stated_frequency_on() {
        // Cycles in a turn; those of 108 Hz at 10 kHz are 0.173.
        let sine = |cycles: f32| move |time: f32| (TAU * cycles * time).sin();
        for cycles in [0.18, 0.21, 0.28, 0.31, 0.47, 0.61, 0.83, 1.13, 1.43, 1.61] {
            let found = turns(sine(cycles));
            assert!(
                found.is_some_and(|turns| turns < 1000),
                "{cycles} {found:?}"
            );
        }
        for cycles in [0.0, 0.01, 0.05, 0.1, 0.15, 0.165] {
            assert_eq!(turns(sine(cycles)), None, "{cycles}");
        }
        // Between the limits of the current and of the tick the amplitude decides.
        assert_eq!(turns(|time| 0.35 * sine(0.47)(time)), None);
    }

    #[test]
    fn two_reversals_of_the_peak_current_are_no_oscillation() {
        let reversed = |time: f32| {
            if (20.2..30.2).contains(&time) {
                1.0
            } else {
                -1.0
            }
        };
        assert_eq!(turns(reversed), None);
        let alternating = |time: f32| if time.fract() < 0.25 { 1.0 } else { -1.0 };
        assert_eq!(turns(alternating), Some(177));
    }
}
