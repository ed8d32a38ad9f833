//! The torques that a motion needs by the arm's model: of drives that follow a motion the controller tells none.
//!
//! τ = M(q) q̈ + h(q, q̇) + friction(q̇), of the motion that a status has as the joints' reference.

use fivebar_firmware::controller::JointReference;
use fivebar_firmware::settings::CheckedSettings;
use fivebar_kinematics::PlanarVector;
use fivebar_kinematics::control::FrictionCompensation;
use fivebar_kinematics::dynamics::BaseParameterModel;
use fivebar_kinematics::five_bar::{Geometry, Side};
use nalgebra::Vector2;

/// The arm's model, as its controller has it.
#[derive(Clone, Debug)]
pub(super) struct Load {
    geometry: Geometry<f32>,
    assembly: Side,
    equations: BaseParameterModel<f32>,
    friction: [FrictionCompensation<f32>; 2],
}

impl Load {
    /// The model in these settings.
    pub(super) fn new(settings: &CheckedSettings) -> Self {
        let smoothing = settings.control.friction_smoothing;
        Self {
            geometry: *settings.arm().geometry(),
            assembly: settings.assembly(),
            equations: BaseParameterModel::new(settings.arm()),
            friction: settings.axes.each_ref().map(|axis| {
                FrictionCompensation::new(axis.viscous_friction, axis.coulomb_friction, smoothing)
            }),
        }
    }

    /// The torques at both joints [N·m]; none where the arm has no pose.
    pub(super) fn torques(&self, reference: &JointReference) -> Option<[f64; 2]> {
        let JointReference {
            angle,
            velocity,
            acceleration,
        } = *reference;
        let [u1, u4] = angle.map(Vector2::unit);
        let links = self.geometry.links(u1, u4, self.assembly).ok()?;
        let [torque1, torque4] = self.equations.torques(&links, velocity, acceleration);
        let [friction1, friction4] = &self.friction;
        let [omega1, omega4] = velocity;
        let torques = [
            torque1 + friction1.torque(omega1),
            torque4 + friction4.torque(omega4),
        ];
        Some(torques.map(f64::from))
    }
}
