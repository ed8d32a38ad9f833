//! The causes of each joint's torque along the reference, by the controller's model.

use fivebar_files::robot::{MissingMasses, Robot};
use fivebar_kinematics::control::FrictionCompensation;
use fivebar_kinematics::dynamics::{Arm, TorqueComponents};
use fivebar_kinematics::five_bar::{PoseError, Side};
use fivebar_sim::simulation::Sample;
use nalgebra::Vector2;

/// The controller's model, which separates a robot's torques by cause.
pub(super) struct ShareModel<'a> {
    arm: &'a Arm<f64>,
    assembly: Side,
    friction: [FrictionCompensation<f64>; 2],
}

impl<'a> ShareModel<'a> {
    pub(super) fn new(robot: &'a Robot) -> Result<Self, MissingMasses> {
        let settings = robot.settings()?;
        let assembly = if settings.assembly_left {
            Side::Left
        } else {
            Side::Right
        };
        let smoothing = f64::from(settings.control.friction_smoothing);
        let friction = robot.drives()?.map(|drive| {
            FrictionCompensation::new(drive.viscous_friction, drive.coulomb_friction, smoothing)
        });
        Ok(Self {
            arm: robot.arm()?,
            assembly,
            friction,
        })
    }

    /// The parts of the torques that the reference of `sample` needs.
    ///
    /// # Errors
    /// The reference is out of reach or singular.
    pub(super) fn shares(&self, sample: &Sample) -> Result<TorqueComponents<f64>, PoseError> {
        let geometry = self.arm.geometry();
        let [theta1, theta4] = sample.reference_angle;
        let [omega1, omega4] = sample.reference_velocity;
        let [alpha1, alpha4] = sample.reference_acceleration;
        let pose = geometry.forward(theta1, theta4, self.assembly)?;
        let velocities = geometry.forward_velocities(&pose, omega1, omega4)?;
        let accelerations = geometry.forward_accelerations(&pose, &velocities, alpha1, alpha4)?;
        let friction = [0, 1].map(|j| self.friction[j].torque(sample.reference_velocity[j]));
        let free = Vector2::zeros();
        self.arm
            .torque_components(&pose, &velocities, &accelerations, free, friction)
    }
}
