//! The position loop of a robot with drives on a bus over its workspace.

use super::servo::PoseMass;
use super::{MissingMasses, Robot};
use fivebar_design::servo::{BusDrive, BusServo};
use fivebar_firmware::drives::can::told_after;
use fivebar_firmware::drives::{DriveStiffness, Drives, Stage, TorqueDrives};
use fivebar_kinematics::five_bar::{Joint, Pose};
use nalgebra::Matrix2;

/// The position loops of a robot with drives on a bus, over its workspace.
pub struct BusServos {
    /// At poses all over the joints' limits, in the robot's assembly and working mode and clear of singularities. Home comes
    /// first.
    pub servos: Vec<(Pose<f64>, BusServo)>,
    /// The arms that may be meant there: links of −20 to +30 % inertia, without payload and with twice as much.
    pub unlike: Vec<[BusServo; 4]>,
}

impl Robot {
    /// The position loops over the workspace; none if other drives turn the joints, or the settings are refused.
    ///
    /// # Errors
    /// The robot has lengths only, no masses.
    pub fn bus_servos(&self) -> Result<Option<BusServos>, MissingMasses> {
        let (Some((protocol, drives)), Ok(settings)) = (self.can_bus(), self.settings()?.check())
        else {
            return Ok(None);
        };
        let (springs, of_loop) = (DriveStiffness::of(&settings), self.servo_drives()?);
        let arrival = told_after(&protocol);
        let drives = Joint::ALL.map(|joint| BusDrive {
            drive: of_loop[joint],
            arrival: arrival[joint].into(),
            lag: drives[joint].lag,
            stiffness: springs[joint].stiffness.into(),
            damping: springs[joint].damping.into(),
        });
        let servo = |mass_matrix: Matrix2<f64>| BusServo {
            mass_matrix,
            drives,
            period: 1.0 / self.control.tick_rate,
            lead: TorqueDrives::lag(&settings, Stage::Moves).into(),
        };
        let at = |(pose, mass): PoseMass| (pose, servo(mass));
        Ok(Some(BusServos {
            servos: self.masses()?.into_iter().map(at).collect(),
            unlike: self
                .unlike_masses()?
                .into_iter()
                .map(|masses| masses.map(servo))
                .collect(),
        }))
    }
}
