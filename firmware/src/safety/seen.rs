//! Which faults are seen with which kind of drive: the one source of the tables in the documents.

use super::Fault;

/// A kind of drive, as a robot file names it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DriveKind {
    /// Brushed motors on H-bridges.
    Brushed,
    /// Steppers without encoders.
    Stepper,
    /// Steppers with encoders.
    StepperWithEncoder,
    /// Torque drives on a CAN bus.
    CanTorque,
    /// Hobby servos.
    HobbyServo,
}

/// Why a fault is not seen.
type NotSeen = &'static str;

const NO_ENCODER: NotSeen = "no encoder";
const NO_CURRENT: NotSeen = "the current is not measured";
const NO_SUPPLY: NotSeen = "the bus voltage is not measured";
const NO_HEAT: NotSeen = "the heat is not modelled";
const NO_OUTPUT: NotSeen = "no fault output";
const OWN_ERROR: NotSeen = "the drive tells it: 32";
const OWN_LOOP: NotSeen = "the loop is the drive's own";
const NO_INDEX: NotSeen = "no index output";
const NO_CROSSING: NotSeen = "no crossings";
const NO_BUS: NotSeen = "no bus";
const NO_MOTOR: NotSeen = "no measured voltage: 3";
const BY_STEPS: NotSeen = "it is 34";
const NO_SWITCH: NotSeen = "no home switch";
const NO_STEPS: NotSeen = "no micro-steps";

impl DriveKind {
    /// Every kind, in the order of the tables.
    pub const ALL: [Self; 5] = [
        Self::Brushed,
        Self::Stepper,
        Self::StepperWithEncoder,
        Self::CanTorque,
        Self::HobbyServo,
    ];

    /// The heading of its column.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Brushed => "brushed",
            Self::Stepper => "stepper",
            Self::StepperWithEncoder => "stepper with encoders",
            Self::CanTorque => "CAN",
            Self::HobbyServo => "hobby servo",
        }
    }

    /// What turns the joints, in a sentence.
    pub const fn motors(self) -> &'static str {
        match self {
            Self::Brushed => "brushed motors",
            Self::Stepper => "steppers without encoders",
            Self::StepperWithEncoder => "steppers with encoders",
            Self::CanTorque => "drives on a CAN bus",
            Self::HobbyServo => "hobby servos",
        }
    }

    /// Whether the controller sees this fault with such drives.
    ///
    /// # Errors
    /// Why it does not.
    ///
    /// ```
    /// use fivebar_firmware::safety::{DriveKind, Fault};
    ///
    /// assert!(DriveKind::Brushed.sees(Fault::UnderVoltage).is_ok());
    /// let why = DriveKind::Stepper.sees(Fault::UnderVoltage);
    /// assert_eq!(why, Err("the bus voltage is not measured"));
    /// ```
    pub const fn sees(self, fault: Fault) -> Result<(), NotSeen> {
        use DriveKind::{Brushed, CanTorque, HobbyServo, Stepper, StepperWithEncoder};
        use Fault as F;
        match (fault, self) {
            (
                F::EncoderJump
                | F::EncoderDisagreement
                | F::FollowingError
                | F::OverSpeed
                | F::EncoderStuck
                | F::StepsLost,
                Stepper | HobbyServo,
            ) => Err(NO_ENCODER),
            (F::OverCurrent | F::CurrentSensor, Stepper | StepperWithEncoder | HobbyServo) => {
                Err(NO_CURRENT)
            }
            (F::OverCurrent, CanTorque) => Err(OWN_ERROR),
            (F::CurrentSensor, CanTorque) => Err(NO_CURRENT),
            (F::OverTemperature, CanTorque) => Err(OWN_ERROR),
            (F::OverTemperature, Stepper | StepperWithEncoder | HobbyServo) => Err(NO_HEAT),
            // No image but that for brushed motors samples the divider.
            (
                F::UnderVoltage | F::OverVoltage,
                Stepper | StepperWithEncoder | CanTorque | HobbyServo,
            ) => Err(NO_SUPPLY),
            (F::DriverFault, CanTorque) => Err(OWN_ERROR),
            (F::DriverFault, HobbyServo) => Err(NO_OUTPUT),
            (F::Oscillation, Stepper | StepperWithEncoder | CanTorque | HobbyServo) => {
                Err(OWN_LOOP)
            }
            (F::IndexNotFound | F::IndexAmbiguous, Stepper | CanTorque | HobbyServo) => {
                Err(NO_INDEX)
            }
            (F::AssemblyMode, Stepper | StepperWithEncoder | CanTorque | HobbyServo) => {
                Err(NO_CROSSING)
            }
            (F::EncoderStuck, StepperWithEncoder) => Err(BY_STEPS),
            (F::EncoderStuck, CanTorque) => Err(NO_MOTOR),
            (F::LostCounts, HobbyServo) => Err(NO_SWITCH),
            (F::BrakeFailed, Stepper | HobbyServo) => Err(NO_ENCODER),
            (
                F::DriveSilent | F::DriveError | F::BusOff,
                Brushed | Stepper | StepperWithEncoder | HobbyServo,
            ) => Err(NO_BUS),
            (F::StepsLost, Brushed | CanTorque) => Err(NO_STEPS),
            _ => Ok(()),
        }
    }
}
