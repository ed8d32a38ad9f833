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
        let homing = record.begun.is_none() && *fault == Fault::FollowingError;
        let forces = homing.then(|| self.homing_torques()).flatten();
        Some(sentence + &forces.unwrap_or_default())
    }

    /// What homing has to move the arm with: most arms that cannot be homed are too heavy
    /// for it.
    fn homing_torques(&self) -> Option<String> {
        let settings = self.robot.settings().ok()?;
        let arm = self.robot.arm().ok()?;
        let weight = arm.gravity_torque(&self.robot.home_pose().ok()?).ok()?;
        let both = |[torque1, torque4]: [f64; 2]| {
            let [torque1, torque4] = [torque1, torque4].map(|torque| quantity(torque, "N·m"));
            format!("{torque1} at joint 1 and {torque4} at joint 4")
        };
        let given = settings.axes.map(|axis| {
            let current = f64::from(settings.homing.current);
            current * f64::from(axis.torque_constant) * f64::from(axis.gear_ratio).abs()
        });
        let holding = if weight == [0.0; 2] {
            String::new()
        } else {
            format!(
                "; holding it up at home takes {}",
                both(weight.map(f64::abs))
            )
        };
        Some(format!(
            ". Homing moves it with 0.3 of the lesser `peak_current` at most, {}{holding}",
            both(given)
        ))
    }
}
