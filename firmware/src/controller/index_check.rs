//! Index pulses and home switches in passing: both must come where the counts say. Counts that were
//! lost, or a coupling that slips, show there.
//!
//! A pulse may be missed: it can be shorter than a tick. A pulse in the wrong place is evidence, and
//! two of them without a right one between are a fault: one may be a disturbance of the wire. The
//! index is on the encoder's disc, so it shows lost counts and no slip behind the encoder. The home
//! switch is on the joint and shows both. Between the angles at which it may close it is not judged.

use super::ArmController;
use crate::drives::Drives;
use crate::io::ArmSample;
use crate::safety::Fault;
use crate::settings::{AxisSettings, HomingMethod, Settings};
use core::f32::consts::TAU;
use fivebar_kinematics::Scalar;

/// The greatest distance of a pulse from its place at rest [counts]: a pulse may last four counts, and
/// homing finds it from one side.
const PULSE_WIDTH: f32 = 8.0;
/// Ticks by which pulse and counts may be sampled apart.
const APART: f32 = 1.0;
/// Wrong pulses in a row that are a fault.
const WRONG_PULSES: u8 = 2;
/// Time by which a switch and its filter may be late [s].
const SWITCH_DELAY: f32 = 0.005;
/// The farthest that a switch may open behind the angle at which it closes, in distances to back
/// off: homing takes no more.
const HYSTERESIS: f32 = 4.0;
/// Looks in a row at a wrong switch that are a fault; each joint has one look in all turns.
const WRONG_LOOKS: u8 = 4;

/// What one joint passes.
#[derive(Clone)]
pub(super) struct Landmarks {
    /// Counts from one index pulse to the next.
    index_counts: i32,
    /// Counts in a tick per speed [s/rad].
    counts_per_speed: f32,
    wrong_pulses: u8,
    /// Where and how fast the last pulse came that nobody has compared [counts, rad/s].
    pulse: Option<(i32, f32)>,
    /// The joint finds its angle by its switch, or by the switch and the index.
    has_switch: bool,
    /// 1 or −1: whether its angle grows towards the switch.
    forward: f32,
    home_angle: f32,
    /// Distances behind the home angle between which the switch may close [rad].
    closes: [f32; 2],
    wrong_looks: u8,
}

impl Landmarks {
    fn new(axis: &AxisSettings, settings: &Settings) -> Self {
        let counts_per_radian = axis.counts_per_turn() / TAU;
        let (has_switch, behind) = match settings.home_reference.method {
            HomingMethod::Switch => (true, 0.0),
            // Within a turn of the encoder behind the pulse.
            HomingMethod::Index => (true, axis.index_counts as f32 / counts_per_radian),
            HomingMethod::HardStop | HomingMethod::Absolute | HomingMethod::Given => (false, 0.0),
        };
        let back_off = settings.homing.back_off;
        Self {
            index_counts: axis.index_counts.cast_signed(),
            counts_per_speed: APART * counts_per_radian / settings.control.tick_rate,
            wrong_pulses: 0,
            pulse: None,
            has_switch,
            forward: if axis.home_forward { 1.0 } else { -1.0 },
            home_angle: axis.home_angle,
            closes: [-HYSTERESIS * back_off, behind + back_off],
            wrong_looks: 0,
        }
    }

    /// Both joints'.
    pub(super) fn of(settings: &Settings) -> [Self; 2] {
        settings
            .axes
            .each_ref()
            .map(|axis| Self::new(axis, settings))
    }

    /// Forgets the pulses of before, whose counts are from another origin.
    pub(super) fn forget_pulses(&mut self) {
        self.wrong_pulses = 0;
        self.pulse = None;
    }

    /// A pulse, so many counts from another one. True if counts were lost.
    #[inline(always)]
    fn pulse_is_wrong(&mut self, turned: i32, velocity: f32) -> bool {
        // None where there is no such distance.
        let Some(rest) = turned.checked_rem(self.index_counts) else {
            return false;
        };
        let beyond = Scalar::abs(rest as f32);
        let before = self.index_counts as f32 - beyond;
        let distance = if beyond < before { beyond } else { before };
        let allowed = PULSE_WIDTH + self.counts_per_speed * Scalar::abs(velocity);
        if distance <= allowed {
            self.wrong_pulses = 0;
            return false;
        }
        self.wrong_pulses = self.wrong_pulses.saturating_add(1);
        self.wrong_pulses >= WRONG_PULSES
    }

    /// A look at the switch of a joint with this angle [rad] and velocity [rad/s]. True if counts were
    /// lost.
    fn switch_is_wrong(&mut self, pressed: bool, angle: f32, velocity: f32) -> bool {
        if !self.has_switch {
            return false;
        }
        let behind = self.forward * (angle - self.home_angle);
        let late = SWITCH_DELAY * Scalar::abs(velocity);
        let [first, last] = self.closes;
        let wrong = if pressed {
            behind < first - late
        } else {
            behind > last + late
        };
        self.wrong_looks = if wrong {
            self.wrong_looks.saturating_add(1)
        } else {
            0
        };
        self.wrong_looks >= WRONG_LOOKS
    }
}

impl<D: Drives> ArmController<D> {
    /// Keeps where the index pulses of this tick came.
    #[inline(always)]
    pub(super) fn note_pulses(&mut self, sample: &ArmSample<D::Sample>) {
        let ([joint1, joint4], [landmarks1, landmarks4]) = (&self.joints, &mut self.landmarks);
        let [index1, index4] = sample.index;
        if index1 {
            landmarks1.pulse = Some((joint1.turned(), joint1.velocity()));
        }
        if index4 {
            landmarks4.pulse = Some((joint4.turned(), joint4.velocity()));
        }
    }

    /// Compares a joint's last index pulse with its counts.
    #[inline(always)]
    pub(super) fn compare_pulse(&mut self, index: usize) {
        if let Some(landmarks) = self.landmarks.get_mut(index)
            && let Some((turned, velocity)) = landmarks.pulse.take()
            && self.homed_by_index
            && landmarks.pulse_is_wrong(turned, velocity)
        {
            self.pending_off = Some(Fault::LostCounts);
        }
    }

    /// Compares a joint's home switch with its angle.
    #[inline(never)]
    pub(super) fn compare_switch(&mut self, index: usize, sample: &ArmSample<D::Sample>) {
        if let (true, Some(&pressed), Some(joint), Some(landmarks)) = (
            self.homed,
            sample.home.get(index),
            self.joints.get(index),
            self.landmarks.get_mut(index),
        ) && landmarks.switch_is_wrong(pressed, joint.angle(), joint.velocity())
        {
            self.pending_off = Some(Fault::LostCounts);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn landmarks(method: HomingMethod) -> [Landmarks; 2] {
        let mut settings = Settings::BENCHTOP;
        settings.home_reference.method = method;
        Landmarks::of(&settings)
    }

    #[test]
    fn a_pulse_is_right_within_its_width_and_what_passes_in_a_tick() {
        // 16384 counts in a turn of the motor, 8 turns of it: 2.086 counts in a tick at 1 rad/s.
        for (turned, velocity, right) in [
            (0, 0.0, true),
            (8, 0.0, true),
            (-8, 0.0, true),
            (9, 0.0, false),
            (-9, 0.0, false),
            (16_384 - 8, 0.0, true),
            (16_384 - 9, 0.0, false),
            (-5 * 16_384 + 8, 0.0, true),
            (28, -10.0, true),
            (29, 10.0, false),
            (8192, 10.0, false),
        ] {
            let [mut joint, _] = landmarks(HomingMethod::Index);
            assert!(!joint.pulse_is_wrong(turned, velocity), "one is no fault");
            let wrong = joint.pulse_is_wrong(turned, velocity);
            assert_eq!(wrong, !right, "{turned} at {velocity}");
        }
    }

    #[test]
    fn a_right_pulse_forgives_a_wrong_one() {
        let [mut joint, _] = landmarks(HomingMethod::Index);
        for _ in 0..10 {
            assert!(!joint.pulse_is_wrong(5000, 0.0));
            assert!(!joint.pulse_is_wrong(16_384, 0.0));
        }
    }

    #[test]
    fn a_switch_is_judged_beyond_its_hysteresis_on_either_side() {
        // Backing off 0.05 rad; joint 4's angle falls towards its switch.
        for (method, joint, home, behind) in [
            (HomingMethod::Switch, 0, 2.792_526_8, 0.0),
            (HomingMethod::Switch, 1, 0.349_065_9, 0.0),
            (HomingMethod::Index, 0, 2.792_526_8, TAU / 8.0),
            (HomingMethod::Index, 1, 0.349_065_9, TAU / 8.0),
        ] {
            let sign = [1.0, -1.0][joint];
            for (pressed, at, velocity, right) in [
                (true, -0.19, 0.0, true),
                (true, -0.21, 0.0, false),
                (true, -0.21, 10.0, true),
                (true, -0.25, 2.0, false),
                (false, -1.0, 0.0, true),
                (false, behind + 0.04, 0.0, true),
                (false, behind + 0.06, 0.0, false),
                (false, behind + 0.06, -10.0, true),
                (false, behind + 0.1, -2.0, false),
                (true, behind + 1.0, 0.0, true),
            ] {
                let joint = &mut landmarks(method)[joint];
                let mut look = || joint.switch_is_wrong(pressed, home + sign * at, velocity);
                let found = [look(), look(), look(), look()];
                let expected = [false, false, false, !right];
                assert_eq!(found, expected, "{method:?} {pressed} {at} {velocity}");
            }
        }
    }

    #[test]
    fn an_arm_without_switches_has_none_that_are_wrong() {
        for method in [
            HomingMethod::HardStop,
            HomingMethod::Absolute,
            HomingMethod::Given,
        ] {
            let [mut joint, _] = landmarks(method);
            assert!((0..10).all(|_| !joint.switch_is_wrong(true, 0.0, 0.0)));
        }
    }
}
