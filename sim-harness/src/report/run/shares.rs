//! What each joint's torque goes into along a motion: the question that Yu 2007 answers
//! with "inertia forces dominate".
//!
//! τ = M(q) α + c(q, ω) + g(q) + friction(ω): inverse dynamics with some of its inputs set
//! to zero gives the terms one by one.

use crate::robot::{KinematicsOnly, Robot};
use crate::run::Sample;
use fivebar_kinematics::Vec2;
use fivebar_kinematics::control::FrictionCompensation;
use fivebar_kinematics::dynamics::Arm;
use fivebar_kinematics::five_bar::{PoseError, Side};

/// Torques [τ1, τ4] [N·m] that one motion asks for, by cause.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Shares {
    /// Speeding up links, payload and rotors: M(q) α.
    pub(super) inertia: [f64; 2],
    /// Centripetal and Coriolis forces: c(q, ω).
    pub(super) velocity_products: [f64; 2],
    /// Weight: g(q).
    pub(super) gravity: [f64; 2],
    /// Friction of the driven joints.
    pub(super) friction: [f64; 2],
}

impl Shares {
    /// The causes by name, in the order of the report.
    pub(super) fn named(&self) -> [(&'static str, [f64; 2]); 4] {
        [
            ("inertia", self.inertia),
            ("velocity products", self.velocity_products),
            ("gravity", self.gravity),
            ("friction", self.friction),
        ]
    }
}

/// The model by which a robot's torques are told apart: the controller's.
pub(super) struct ShareModel<'a> {
    arm: &'a Arm<f64>,
    assembly: Side,
    friction: [FrictionCompensation<f64>; 2],
}

impl<'a> ShareModel<'a> {
    pub(super) fn new(robot: &'a Robot) -> Result<Self, KinematicsOnly> {
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

    /// The torques that the reference of `sample` asks for.
    ///
    /// # Errors
    /// A reference out of reach or singular.
    pub(super) fn shares(&self, sample: &Sample) -> Result<Shares, PoseError> {
        let geometry = self.arm.geometry();
        let [theta1, theta4] = sample.reference_angle;
        let pose = geometry.forward(theta1, theta4, self.assembly)?;
        let torque = |[omega1, omega4]: [f64; 2], [alpha1, alpha4]: [f64; 2]| {
            let velocities = geometry.forward_velocities(&pose, omega1, omega4)?;
            let accelerations =
                geometry.forward_accelerations(&pose, &velocities, alpha1, alpha4)?;
            self.arm
                .inverse_dynamics(&pose, &velocities, &accelerations, Vec2::zero())
        };
        let omega = sample.reference_velocity;
        let gravity = torque([0.0; 2], [0.0; 2])?;
        let bias = torque(omega, [0.0; 2])?;
        let total = torque(omega, sample.reference_acceleration)?;
        let less = |a: [f64; 2], b: [f64; 2]| [a[0] - b[0], a[1] - b[1]];
        Ok(Shares {
            inertia: less(total, bias),
            velocity_products: less(bias, gravity),
            gravity,
            friction: [0, 1].map(|joint| self.friction[joint].torque(omega[joint])),
        })
    }
}
