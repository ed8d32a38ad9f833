//! Step and direction: stepper motors whose position is that of the micro-steps.

use super::{DriveReport, Drives, Excitation, Excited, JointState, Needs, Stage};
use crate::drives::Demand;
use crate::safety::Fault;
use crate::settings::{CheckedSettings, Settings};
use core::f32::consts::TAU;
use fivebar_kinematics::PlanarVector;
use fivebar_kinematics::five_bar::Joint;
use nalgebra::Vector2;
use serde::{Deserialize, Serialize};

/// The micro-steps that are made so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct StepSample {
    /// Of each joint; they wrap.
    pub steps: [i32; 2],
}

/// The micro-steps to make until the next tick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct StepCommand {
    /// Of each joint, evenly spread over the tick; positive ones turn the motor forwards.
    pub steps: [i32; 2],
}

/// Both stepper drives. Each makes the micro-steps that lead from where its motor is told to be to the set-point.
///
/// Without an encoder, the counts of the sample are the micro-steps made: the controller takes the place that the motor
/// is told for the place where it is, and no check sees a motor that has lost steps. The axis settings are those of an
/// encoder with one count a micro-step.
#[derive(Clone)]
pub struct StepDrives {
    /// Micro-steps per radian at the joint, negative if the motor turns against it.
    per_radian: [f32; 2],
    /// The most micro-steps in a tick.
    most: [i32; 2],
    steps: [i32; 2],
}

/// The joints' speeds that steps are made for, over the greatest speed of the settings: what a set-point that has
/// waited for the drives catches up with.
const MARGIN: f32 = 1.5;

impl Drives for StepDrives {
    type Sample = StepSample;
    type Command = StepCommand;

    const NEEDS: Needs = Needs::Motion;
    /// From the enable of a driver to the full current in its windings.
    const WAKE_UP_TIME: f32 = 5e-3;

    fn new(settings: &CheckedSettings) -> Self {
        let [axis1, axis4] = &settings.axes;
        let per_radian =
            [axis1, axis4].map(|axis| axis.encoder_counts as f32 * axis.gear_ratio * (1.0 / TAU));
        let most = [(axis1, per_radian[0]), (axis4, per_radian[1])].map(|(axis, per_radian)| {
            let steps = MARGIN * axis.max_speed * per_radian.abs() / settings.control.tick_rate;
            // `as` cuts: one more.
            steps as i32 + 1
        });
        Self {
            per_radian,
            most,
            steps: [0; 2],
        }
    }

    /// The steps of a tick end at its end.
    fn lag(settings: &Settings, _: Stage) -> f32 {
        1.0 / settings.control.tick_rate
    }

    fn keep_heat(&mut self, _: &Settings, _: &Self, _: &Settings) {}

    fn select(&mut self, _: Joint, _: Stage) {}

    fn sense(&mut self, _: &StepSample) {}

    fn drive_fault(&self) -> Option<Fault> {
        None
    }

    fn supply_fault(&self) -> Option<Fault> {
        None
    }

    fn contradiction(&mut self, _: [JointState; 2]) -> Option<Fault> {
        None
    }

    /// n = (θd − θ) N/2π, rounded, of the set-point θd at the end of the tick; what rounding leaves is in the next
    /// tick's difference.
    #[inline(always)]
    fn drive(&mut self, demand: &Demand) -> bool {
        let [u1, u4] = Vector2::units(demand.counted);
        let [d1, d4] = demand.motion.direction.map(Vector2::from);
        let [per1, per4] = self.per_radian;
        let [most1, most4] = self.most;
        let (steps1, limited1) = whole(u1.cross_z(d1) * per1, most1);
        let (steps4, limited4) = whole(u4.cross_z(d4) * per4, most4);
        self.steps = [steps1, steps4];
        limited1 || limited4
    }

    #[inline(always)]
    fn command(&self) -> StepCommand {
        StepCommand { steps: self.steps }
    }

    /// Steps are whole numbers.
    fn is_finite(&self) -> bool {
        true
    }

    fn rest(&mut self, _: &StepSample) {}

    fn wake(&mut self) {}

    fn is_ready(&self) -> bool {
        true
    }

    #[inline(always)]
    fn release(&mut self) {
        self.steps = [0; 2];
    }

    fn watch_heat(&mut self, _: Joint) -> Option<Fault> {
        None
    }

    fn watch_loop(&mut self, _: Joint) -> Option<Fault> {
        None
    }

    /// A driver tells nothing of its motor.
    fn report(&self) -> DriveReport {
        DriveReport::default()
    }

    /// Not known: a stepper takes the torque that its load needs, up to its pull-out torque.
    fn torque(&self, _: [f32; 2]) -> [f32; 2] {
        [0.0; 2]
    }

    fn admits(_: &Settings, _: &Excitation) -> bool {
        false
    }

    fn excite(&mut self, _: Joint, _: Excited, _: f32, _: f32) {}
}

/// The nearest whole number of steps, within ±`most`; true if that limits it. Of what is not a number, none.
#[inline(always)]
fn whole(steps: f32, most: i32) -> (i32, bool) {
    // `as` saturates, and cuts towards 0.
    let rounded = (steps + if steps < 0.0 { -0.5 } else { 0.5 }) as i32;
    let limited = rounded.clamp(-most, most);
    (limited, limited != rounded)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drives::Motion;

    fn demand(counted: f32, wanted: f32) -> Demand {
        let direction = Vector2::unit(wanted).into();
        Demand {
            torque: [0.0; 2],
            keeps_to_motion: true,
            velocity: [0.0; 2],
            counted: [counted; 2],
            motion: Motion {
                direction: [direction; 2],
                velocity: [0.0; 2],
                acceleration: [0.0; 2],
            },
        }
    }

    #[test]
    fn steps_follow_the_set_point_to_half_a_step_and_never_drift() {
        let mut settings = Settings::BENCHTOP;
        for axis in &mut settings.axes {
            (axis.encoder_counts, axis.gear_ratio) = (3200, 4.0);
        }
        settings.axes[1].gear_ratio = -4.0;
        let settings = settings.check().expect("settings");
        let mut drives = StepDrives::new(&settings);
        let step = TAU / 12_800.0;
        let mut made = [0_i32; 2];
        for tick in 0..200_000_u32 {
            let wanted = 1.2 * (tick as f32 * 5e-4).sin();
            let at = [made[0] as f32 * step, made[1] as f32 * -step];
            let mut demand = demand(0.0, wanted);
            demand.counted = at;
            assert!(!drives.drive(&demand), "tick {tick}");
            for (made, steps) in made.iter_mut().zip(drives.command().steps) {
                *made += steps;
            }
            for at in [made[0] as f32 * step, made[1] as f32 * -step] {
                assert!(
                    (at - wanted).abs() < 0.51 * step,
                    "tick {tick}: {at} for {wanted}"
                );
            }
        }
    }

    #[test]
    fn more_steps_than_a_motor_can_make_are_limited_and_what_is_no_number_is_no_step() {
        let mut drives = StepDrives::new(&Settings::BENCHTOP.check().expect("settings"));
        assert!(drives.drive(&demand(0.0, 1.0)));
        let [most, _] = drives.command().steps;
        let axis = &Settings::BENCHTOP.axes[0];
        let fastest = axis.max_speed * axis.encoder_counts as f32 * axis.gear_ratio / TAU * 1e-4;
        assert!((1.5 * fastest..1.5 * fastest + 1.0).contains(&(most as f32)));
        assert!(!drives.drive(&demand(f32::NAN, 0.0)));
        assert_eq!(drives.command().steps, [0; 2]);
        drives.drive(&demand(0.0, 0.01));
        drives.release();
        assert_eq!(drives.command(), StepCommand::default());
    }
}
