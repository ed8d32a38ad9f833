//! The greatest torque that a motor gives at its joint, whatever its kind.

use super::{MissingMasses, Robot};
use fivebar_kinematics::five_bar::Joint;
use fivebar_plant::Stepper;

/// What limits the torques at the joints.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TorqueLimit {
    /// A torque for each joint [N·m].
    Constant([f64; 2]),
    /// Above this torque a stepper loses steps; it falls with the speed.
    PullOut {
        /// The motors.
        motors: [Stepper; 2],
        /// The supply's voltage [V].
        supply: f64,
    },
}

impl TorqueLimit {
    /// The limit at a joint that turns with this speed [rad/s]: [N·m].
    pub fn at(&self, joint: Joint, speed: f64) -> f64 {
        match self {
            Self::Constant(torques) => torques[joint],
            Self::PullOut { motors, supply } => {
                let motor = &motors[joint];
                let gear = motor.gear_ratio.abs();
                gear * motor.pull_out_torque(gear * speed, *supply)
            }
        }
    }
}

impl Robot {
    /// What limits its torques: the torque at which a stepper loses steps, a servo's stall torque, or else the peak torque
    /// by current limit and `max_torque`.
    ///
    /// # Errors
    /// The robot has lengths only, no masses.
    pub fn torque_limit(&self) -> Result<TorqueLimit, MissingMasses> {
        if let Some(motors) = self.steppers() {
            let supply = self.supply.voltage;
            return Ok(TorqueLimit::PullOut { motors, supply });
        }
        if let Some(servos) = self.hobby_servos() {
            let stall = servos.map(|servo| servo.gear_ratio.abs() * servo.stall_torque);
            return Ok(TorqueLimit::Constant(stall));
        }
        let peak = self.drives()?.map(|drive| drive.peak_torque());
        Ok(TorqueLimit::Constant(peak))
    }

    /// The greatest torques of the weight at each joint, over the poses within the limits [N·m].
    pub(super) fn greatest_weights(&self) -> [f64; 2] {
        let Some(arm) = &self.arm else {
            return [0.0; 2];
        };
        let torques = self
            .poses()
            .into_iter()
            .filter_map(|pose| arm.gravity_torque(&pose).ok());
        torques.fold([0.0; 2], |[most1, most4]: [f64; 2], [torque1, torque4]| {
            [most1.max(torque1.abs()), most4.max(torque4.abs())]
        })
    }
}

#[cfg(test)]
mod tests {
    use super::TorqueLimit;
    use crate::robot::{BUILT_IN, Robot};
    use fivebar_kinematics::five_bar::Joint;

    #[test]
    fn a_stepper_has_its_holding_torque_at_rest_and_less_where_its_current_lags() {
        let robot = Robot::load("benchtop_stepper").unwrap();
        let limit = robot.torque_limit().unwrap();
        let TorqueLimit::PullOut { motors, .. } = limit else {
            panic!("{limit:?}");
        };
        for joint in Joint::ALL {
            let motor = &motors[joint];
            let holds = motor.gear_ratio.abs() * motor.holding_torque;
            assert_eq!(limit.at(joint, 0.0), holds);
            assert_eq!(limit.at(joint, -60.0), limit.at(joint, 60.0));
            assert!(limit.at(joint, 60.0) < 0.9 * holds);
        }
    }

    /// The settings say it, too, by another way.
    #[test]
    fn the_limit_of_drives_with_current_is_that_of_the_controller() {
        for built_in in BUILT_IN {
            let robot = built_in.robot().unwrap();
            let Ok(TorqueLimit::Constant(limits)) = robot.torque_limit() else {
                continue;
            };
            if robot.hobby_servos().is_some() {
                continue;
            }
            let settings = robot.settings().unwrap().check().unwrap();
            for (limit, controllers) in limits.into_iter().zip(settings.peak_torque()) {
                let off = limit / f64::from(controllers) - 1.0;
                assert!(
                    off.abs() < 1e-4,
                    "{}: {limit} and {controllers}",
                    robot.name
                );
            }
        }
    }
}
