//! Why a run was refused or did not come to its end, in a sentence.

use super::{Record, RunError, Scenario, fault_name};
use crate::link::TargetError;
use crate::report::quantity;
use fivebar_firmware::safety::Fault;

impl Scenario {
    /// Why a run of this scenario was refused or broke off. A refused move is one of the
    /// job's: its line is a line of that file.
    pub fn told(&self, error: &RunError) -> String {
        match error {
            RunError::Target(error @ TargetError::Move(_)) => {
                format!("{}, {error}", self.job_file)
            }
            other => other.to_string(),
        }
    }

    /// By which fault the arm was stopped, and when; none if it was not.
    pub fn stopped_by(&self, record: &Record) -> Option<String> {
        let (time, fault) = record.faults.first()?;
        let when = match record.begun {
            Some(begun) => format!("{:.4} s into the job", time - begun),
            None => format!("{time:.4} s after power-up, while homing"),
        };
        let (number, name) = (fault.number(), fault_name(*fault));
        let sentence = format!("the arm stopped {when} by fault {number}, {name}");
        if *fault != Fault::FollowingError {
            return Some(sentence);
        }
        let cause = match record.begun {
            Some(_) => self.falls(),
            None => self.homing_torques(),
        };
        Some(sentence + &cause.unwrap_or_default())
    }

    /// Whether the arm falls once homed, until it is powered again for the job.
    fn falls(&self) -> Option<String> {
        let home = self.robot.home_pose().ok()?;
        let weight = self.robot.arm().ok()?.gravity_torque(&home).ok()?;
        let drives = self.robot.drives().ok()?;
        let joint = (0..2).find(|&joint| {
            let drive = &drives[joint];
            weight[joint].abs() > drive.brake_torque + drive.coulomb_friction
        })?;
        let [needed, brake] = [weight[joint].abs(), drives[joint].brake_torque];
        Some(format!(
            ". Unpowered it falls: holding it up at home takes {} at joint {}, its `brake_torque` \
             is {}",
            quantity(needed, "N·m"),
            [1, 4][joint],
            quantity(brake, "N·m")
        ))
    }

    /// What homing has to move the arm with: most arms that cannot be homed are too heavy
    /// for it.
    fn homing_torques(&self) -> Option<String> {
        let settings = self.robot.settings().ok()?;
        let [torque1, torque4] = settings.axes.map(|axis| {
            let current = f64::from(settings.homing.current);
            let torque = current * f64::from(axis.torque_constant * axis.gear_ratio);
            quantity(torque.abs(), "N·m")
        });
        Some(format!(
            ". Homing moves it with {torque1} at joint 1 and {torque4} at joint 4 at most: what \
             holds it up at home, and 0.3 of the lesser `peak_current`"
        ))
    }
}
