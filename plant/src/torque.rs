//! The arm with a torque on each rotor, step by step: for controllers that are not this project's.

use crate::drives::Drives;
use crate::mismatch::Mismatch;
use crate::motor::Motor;
use crate::parameters::Parameters;
use crate::plant::Plant;
use fivebar_firmware::ActuatorCommand;
use fivebar_kinematics::five_bar::{Joint, Pose};
use nalgebra::Vector2;

/// An arm whose drives make the torques that they are told, at once and without a limit.
///
/// It is a [`Plant`] whose bridges are off: links, rotors, friction, belts and gravity are the same. It has no brakes.
///
/// ```
/// use fivebar_firmware::Settings;
/// use fivebar_kinematics::five_bar::Joint;
/// use fivebar_plant::{Mismatch, Parameters, TorquePlant};
///
/// let settings = Settings::BENCHTOP;
/// let parameters = Parameters::from_settings(&settings, 24.0).unwrap();
/// let geometry = parameters.arm.geometry();
/// let start = geometry.forward(2.2, 0.9, settings.assembly()).unwrap(); // rad
/// let mut arm = TorquePlant::new(&parameters, &Mismatch::NONE, &start);
/// for _ in 0..100 {
///     arm.step([0.05, 0.0], 1e-3); // N·m, s
/// }
/// assert!(arm.angle(Joint::Joint1) > 2.2);
/// ```
#[derive(Clone, Debug)]
pub struct TorquePlant {
    arm: Plant,
}

impl TorquePlant {
    /// The arm with this mismatch, at rest in `pose`.
    pub fn new(parameters: &Parameters, mismatch: &Mismatch, pose: &Pose<f64>) -> Self {
        let mut parameters = parameters.clone();
        parameters.brake_torque = [0.0; 2];
        for motor in &mut parameters.motors {
            *motor = Motor {
                // No brushed motor: a winding without effect, which needs no short step.
                torque_constant: 0.0,
                resistance: 1.0,
                inductance: 1.0,
                ..*motor
            };
        }
        let mut arm = Plant::new(&parameters, mismatch, pose, 1);
        arm.drives = Some(Drives::new(&parameters, mismatch, arm.model(), arm.state()));
        Self { arm }
    }

    /// Advances by `time` [s] with these torques on the rotors, as they are at the joints [N·m].
    pub fn step(&mut self, torque: [f64; 2], time: f64) {
        if let Some(drives) = &mut self.arm.drives {
            drives.motor_torque = torque;
        }
        self.arm.advance(&ActuatorCommand::default(), time);
    }

    /// Lets this force [N] act on the tool from now on.
    pub fn set_tool_force(&mut self, force: Vector2<f64>) {
        self.arm.set_tool_force(force);
    }

    /// The angle of a driven joint [rad].
    pub fn angle(&self, joint: Joint) -> f64 {
        self.arm.angle(joint)
    }

    /// Its velocity [rad/s].
    pub fn velocity(&self, joint: Joint) -> f64 {
        self.arm.velocity(joint)
    }

    /// The position of the tool [m].
    pub fn tool(&self) -> Vector2<f64> {
        self.arm.tool()
    }

    /// The time since the start [s].
    pub fn time(&self) -> f64 {
        self.arm.time()
    }
}
