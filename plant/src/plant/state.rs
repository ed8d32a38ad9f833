//! What can be read of a simulated arm.

use super::Plant;
use crate::chain::PerJoint;
use crate::drives::Drives;
use crate::dynamics::{DRIVEN, Model, State};
use crate::encoder::EncoderSide;
use crate::worn_joints::WornJoints;
use fivebar_kinematics::five_bar::Joint;
use nalgebra::Vector2;

impl Plant {
    /// The arm's model, mismatch included.
    pub fn model(&self) -> &Model {
        &self.model
    }
    /// Positions, velocities and currents.
    pub fn state(&self) -> &State {
        &self.state
    }
    /// Time since the start [s].
    pub fn time(&self) -> f64 {
        self.time
    }
    /// True angle of a driven joint [rad].
    pub fn angle(&self, joint: Joint) -> f64 {
        self.state.q[DRIVEN[joint]].angular
    }
    /// True velocity of a driven joint [rad/s].
    pub(crate) fn velocity(&self, joint: Joint) -> f64 {
        self.joint(joint).1
    }

    /// True position of the tool [m].
    pub fn tool(&self) -> Vector2<f64> {
        self.model.tool(&self.state)
    }
    /// The bus voltage [V]: the supply's behind the contactor, less what its resistance takes.
    pub fn bus_voltage(&self) -> f64 {
        let bus = self.contactor.behind(self.bus_voltage);
        match &self.drives {
            None => bus,
            Some(drives) => bus - drives.voltage_drop(&self.state),
        }
    }
    /// The angle of a drive's rotor, over the gear ratio [rad]; of a rigid drive, its
    /// joint's.
    pub fn rotor_angle(&self, joint: Joint) -> f64 {
        self.rotor(joint).0
    }
    /// The drives, if any of their effects is on.
    pub fn drives(&self) -> Option<&Drives> {
        self.drives.as_ref()
    }
    /// The force through each joint, A to E, on the body nearer to E [N].
    pub fn reactions(&self) -> PerJoint {
        let (model, state) = (&self.model, &self.state);
        if let Some(drives) = &self.drives {
            return drives.reactions(model, state, self.tool_force);
        }
        let torque = model.drive_torque(state);
        let (_, forces) = match &self.wear {
            Some(wear) => wear.accelerations(model, state, torque, self.tool_force),
            None => model.accelerations(state, torque, self.tool_force),
        };
        forces
    }
    /// The worn joints, if the arm has any.
    pub fn wear(&mut self) -> Option<&mut WornJoints> {
        self.wear.as_mut()
    }
    /// The angle [rad] and speed [rad/s] of an encoder's shaft, over the gear ratio.
    pub(super) fn shaft(&self, joint: Joint) -> (f64, f64) {
        match self.encoders[joint].side {
            EncoderSide::Motor => self.rotor(joint),
            EncoderSide::Joint => self.joint(joint),
        }
    }

    /// The angle [rad] and speed [rad/s] of a drive's rotor, over the gear ratio.
    pub(crate) fn rotor(&self, joint: Joint) -> (f64, f64) {
        let behind = self.drives.as_ref().and_then(|drives| drives.rotor(joint));
        behind.unwrap_or_else(|| self.joint(joint))
    }

    fn joint(&self, joint: Joint) -> (f64, f64) {
        let link = DRIVEN[joint];
        (self.state.q[link].angular, self.state.v[link].angular)
    }

    /// Whether no fault and no emergency stop cuts a motor's power.
    pub(crate) fn is_powered(&self, joint: Joint) -> bool {
        let cut = self.faults.disconnected[joint] || self.faults.driver_fault[joint];
        !cut && !self.is_stopped()
    }

    /// The encoder's counts.
    pub(super) fn counts(&self, joint: Joint) -> i32 {
        let delay = self.delay.as_ref();
        let delayed = delay.and_then(|delay| delay.angle(joint, self.time));
        let angle = delayed.unwrap_or_else(|| self.shaft(joint).0);
        let slip = self.faults.slipping[joint];
        let turned = match (self.encoders[joint].side, slip) {
            (EncoderSide::Motor, Some(slip)) => slip.motor(angle),
            _ => angle,
        };
        let measured = self.encoders[joint].measured(turned);
        self.sensors[joint].counts(measured, self.count_origin[joint])
    }
}
