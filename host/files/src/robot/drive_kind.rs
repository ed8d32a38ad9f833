//! What turns the joints of an arm: the kinds, and what each of them is for those that ask for no more.

use super::Robot;
use super::actuator::{Actuator, Drive};
use fivebar_firmware::safety::DriveKind as MonitoredKind;
use serde::Deserialize;
use std::fmt;

/// What turns a joint.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum DriveKind {
    /// A brushed motor on an H-bridge, with an encoder.
    #[default]
    Brushed,
    /// A stepper motor on a step and direction driver.
    Stepper,
    /// A drive on a CAN bus that takes a torque.
    CanTorque,
    /// A hobby servo.
    Servo,
}

impl fmt::Display for DriveKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Brushed => "brushed",
            Self::Stepper => "stepper",
            Self::CanTorque => "can-torque",
            Self::Servo => "servo",
        })
    }
}

/// The robot has other drives, where brushed motors are needed.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("robot `{robot}` has {drives}, but {needs}. {instead}")]
pub struct NotBrushed {
    /// The robot's name.
    pub robot: String,
    /// Its drives.
    drives: &'static str,
    /// What needs others.
    needs: &'static str,
    /// What applies to them in place of what was asked for.
    instead: &'static str,
}

impl DriveKind {
    /// What applies to drives that are not brushed motors in place of what is of brushed motors.
    const fn instead(self) -> Option<&'static str> {
        match self {
            Self::Brushed => None,
            Self::Stepper => Some(
                "`fivebar sim`, `serve` and `pil` run jobs on them, and `drive` with the image `stm32f405_stepper` or \
                 `rp2350_stepper` \
                 (docs/use/wiring.md). `torque_share` is their margin, and `sim` shows the `lost_steps`",
            ),
            Self::CanTorque => Some(
                "`fivebar sim`, `serve` and `pil` run jobs on them, and `drive` with the image `stm32f405_can` \
                 (docs/use/wiring.md). Tune and check their own loops by their maker's program",
            ),
            Self::Servo => Some(
                "`fivebar sim`, `serve` and `pil` run jobs on them, and `drive` with the image `rp2350_servo` \
                 (docs/use/wiring.md). A servo has a loop of its own and tells nothing: `sim` shows how far its arm is from its \
                 set-points",
            ),
        }
    }

    /// Whether the supply's voltage limits its torque by its winding's equation, as of a brushed motor. A stepper is limited
    /// by its pull-out torque, and other drives by their greatest speed.
    pub(super) const fn is_limited_by_winding(self) -> bool {
        matches!(self, Self::Brushed)
    }
}

impl Actuator {
    /// What it is.
    pub fn kind(&self) -> DriveKind {
        match self.drive {
            Drive::Brushed => DriveKind::Brushed,
            Drive::Stepper(_) => DriveKind::Stepper,
            Drive::CanTorque(_) => DriveKind::CanTorque,
            Drive::HobbyServo(_) => DriveKind::Servo,
        }
    }
}

impl Robot {
    /// What turns its joints; brushed motors stand for ideal torque sources.
    pub fn drive_kind(&self) -> DriveKind {
        self.actuators
            .map_or(DriveKind::Brushed, |[first, _]| first.kind())
    }

    /// The same, as the tables of faults and of wiring mistakes have it.
    pub(crate) fn monitored_kind(&self) -> MonitoredKind {
        match self.drive_kind() {
            DriveKind::Brushed => MonitoredKind::Brushed,
            DriveKind::Stepper if self.has_steppers_with_encoders() => {
                MonitoredKind::StepperWithEncoder
            }
            DriveKind::Stepper => MonitoredKind::Stepper,
            DriveKind::CanTorque => MonitoredKind::CanTorque,
            DriveKind::Servo => MonitoredKind::HobbyServo,
        }
    }

    /// The robot, for what needs brushed motors.
    ///
    /// # Errors
    /// Other drives turn its joints.
    pub fn brushed(&self) -> Result<&Self, NotBrushed> {
        self.other_drives("loops and logs are of brushed motors")
    }

    /// The robot, for what needs drives whose torques are known.
    ///
    /// # Errors
    /// Steppers or hobby servos turn its joints.
    pub fn with_known_torque(&self) -> Result<&Self, NotBrushed> {
        match self.drive_kind() {
            DriveKind::CanTorque => Ok(self),
            _ => self.other_drives(
                "only loops over brushed motors and drives on a CAN bus are the controller's, and only their torques are known",
            ),
        }
    }

    fn other_drives(&self, needs: &'static str) -> Result<&Self, NotBrushed> {
        let kind = self.drive_kind();
        kind.instead().map_or(Ok(self), |instead| {
            let drives = match self.monitored_kind() {
                MonitoredKind::Stepper | MonitoredKind::StepperWithEncoder => "steppers",
                other => other.motors(),
            };
            Err(NotBrushed {
                robot: self.name.clone(),
                drives,
                needs,
                instead,
            })
        })
    }
}
