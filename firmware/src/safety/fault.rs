//! Faults and limits, with stable numbers.

use num_enum::{IntoPrimitive, TryFromPrimitive};
use serde::{Deserialize, Serialize};

/// A fault. It stays latched until a host clears it. The numbers are stable, because they are
/// sent, logged and looked up.
///
/// ```
/// use fivebar_firmware::safety::Fault;
///
/// // The numbers are part of the protocol.
/// assert_eq!(Fault::EmergencyStop.number(), 10);
/// assert_eq!(Fault::try_from(3_u8), Ok(Fault::FollowingError));
/// assert!(Fault::try_from(200_u8).is_err());
/// ```
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, Hash, IntoPrimitive, TryFromPrimitive, Serialize, Deserialize,
)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[num_enum(error_type(name = UnknownFault, constructor = UnknownFault))]
#[serde(into = "u8", try_from = "u8")]
#[repr(u8)]
pub enum Fault {
    /// An encoder's counts differ from the observer's prediction by more than the joint can turn
    /// in a tick. The joint angles are unknown: home again.
    EncoderJump = 1,
    /// No pose on the arm's branch has the measured angles. The joint angles are unknown: home
    /// again.
    EncoderDisagreement = 2,
    /// A joint is too far from its reference.
    FollowingError = 3,
    /// A joint turns too fast.
    OverSpeed = 4,
    /// A motor's current is too high.
    OverCurrent = 5,
    /// A motor is too hot by the I²t model.
    OverTemperature = 6,
    /// The bus voltage is too low.
    UnderVoltage = 7,
    /// The bus voltage is too high.
    OverVoltage = 8,
    /// A bridge reports a fault.
    DriverFault = 9,
    /// The emergency stop was pressed or requested.
    EmergencyStop = 10,
    /// The arm left its envelope (joint limits, or too near a singularity), or a joint searched
    /// its whole range without finding its switch.
    Envelope = 11,
    /// The host was silent while the arm moved.
    CommandTimeout = 12,
    /// The queue of the path was nearly empty while the arm moved: the planner was too late.
    QueueUnderrun = 13,
    /// Ticks were missed.
    TickOverrun = 14,
    /// A number in the loop is infinite or not a number.
    NotANumber = 15,
    /// The clock did not start or failed.
    ClockFailure = 16,
    /// The watchdog reset the controller.
    WatchdogReset = 17,
    /// The stored settings are corrupt.
    SettingsCorrupt = 18,
    /// A position loop oscillates: the arm differs too much from its settings.
    Oscillation = 19,
    /// Homing found the switch, and no index pulse within a turn of the encoder after it.
    IndexNotFound = 20,
    /// The index pulse is so near to the switch that it could be that of the next turn.
    IndexAmbiguous = 21,
    /// Behind a singularity that the arm crossed, its torques do not show that it is in the other assembly mode.
    AssemblyMode = 22,
    /// A motor's measured current is not the one that its voltage and speed drive: its sensor, its leads or
    /// its bridge are at fault.
    CurrentSensor = 23,
    /// An encoder does not count while its motor turns. The joint angles are unknown: home again.
    EncoderStuck = 24,
    /// An index pulse or a home switch comes where the counts say that it cannot: counts were lost, or a
    /// coupling slipped. The joint angles are unknown: home again.
    LostCounts = 25,
    /// The holding brakes do not hold the arm, which was to be switched off: the bridges hold it.
    BrakeFailed = 26,
    /// The program panicked, and the controller restarted.
    Panic = 27,
    /// The processor raised a hard fault, and the controller restarted.
    HardFault = 28,
    /// The supply of the chip was too low, and the controller restarted.
    BrownOut = 29,
    /// The controller restarted by its reset pin, by a debugger, or for a reason that it does not know.
    UnexpectedReset = 30,
    /// A drive on the bus does not answer, or its answers come late.
    DriveSilent = 31,
    /// A drive on the bus tells an error, or gives no torque where it should.
    DriveError = 32,
    /// The controller has left the bus after too many errors: its wiring, or the drives' bit rate, is at fault.
    BusOff = 33,
    /// A stepper's encoder has left its micro-steps: steps are lost. The angles are those of the encoders.
    StepsLost = 34,
}

/// What a fault does to the arm.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Response {
    /// Both bridges are off in the same tick, and the brake is engaged.
    PowerOff,
    /// The arm comes to rest on its path and is held there.
    ControlledStop,
}

impl Fault {
    /// Every fault, in the order of the numbers.
    pub fn all() -> impl Iterator<Item = Self> {
        (0..=u8::MAX).filter_map(|number| Self::try_from(number).ok())
    }

    /// The fault's number.
    pub const fn number(self) -> u8 {
        self as u8
    }

    /// What the fault does to the arm. A controlled stop needs loops that still work, which is
    /// so for three faults: a silent host, a queue underrun, and brakes that do not hold the arm. Outside
    /// the envelope the branch, and with it the sign of the model, is uncertain, so the bridges are
    /// switched off.
    pub const fn response(self) -> Response {
        match self {
            Self::CommandTimeout | Self::QueueUnderrun | Self::BrakeFailed => {
                Response::ControlledStop
            }
            Self::EncoderJump
            | Self::EncoderDisagreement
            | Self::FollowingError
            | Self::OverSpeed
            | Self::OverCurrent
            | Self::OverTemperature
            | Self::UnderVoltage
            | Self::OverVoltage
            | Self::DriverFault
            | Self::EmergencyStop
            | Self::Envelope
            | Self::TickOverrun
            | Self::NotANumber
            | Self::ClockFailure
            | Self::WatchdogReset
            | Self::SettingsCorrupt
            | Self::Oscillation
            | Self::IndexNotFound
            | Self::IndexAmbiguous
            | Self::AssemblyMode
            | Self::CurrentSensor
            | Self::EncoderStuck
            | Self::LostCounts
            | Self::Panic
            | Self::HardFault
            | Self::BrownOut
            | Self::UnexpectedReset
            | Self::DriveSilent
            | Self::DriveError
            | Self::BusOff
            | Self::StepsLost => Response::PowerOff,
        }
    }

    /// Whether the joint angles are unknown after it.
    pub(crate) const fn loses_angles(self) -> bool {
        matches!(
            self,
            Self::EncoderJump
                | Self::EncoderDisagreement
                | Self::AssemblyMode
                | Self::EncoderStuck
                | Self::LostCounts
        )
    }
}

/// No fault has this number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct UnknownFault(pub u8);

impl core::fmt::Display for UnknownFault {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "no fault has the number {}", self.0)
    }
}

impl core::error::Error for UnknownFault {}

/// The limits that clip in a tick without being faults, one stable bit each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Limits(u8);

bitflags::bitflags! {
    impl Limits: u8 {
        /// The demanded torque exceeded the motors' peak torque.
        const TORQUE = 1;
        /// The bus voltage was too low for the demanded current.
        const VOLTAGE = 2;
        /// The move goes slower than requested: a limit of the tool or of a joint, or a
        /// singularity, is near.
        const SPEED = 4;
    }
}

impl Limits {
    /// Adds `limit` if `active`.
    #[inline]
    #[must_use]
    pub(crate) const fn with(self, limit: Self, active: bool) -> Self {
        if active { self.union(limit) } else { self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_silent_host_an_empty_queue_and_failed_brakes_leave_the_arm_held() {
        for fault in Fault::all() {
            let held = matches!(
                fault,
                Fault::CommandTimeout | Fault::QueueUnderrun | Fault::BrakeFailed
            );
            assert_eq!(
                fault.response() == Response::ControlledStop,
                held,
                "{fault:?}"
            );
        }
    }

    #[test]
    fn only_encoders_lost_counts_and_an_unknown_assembly_mode_lose_the_angles() {
        for fault in Fault::all() {
            let lost = matches!(
                fault,
                Fault::EncoderJump
                    | Fault::EncoderDisagreement
                    | Fault::AssemblyMode
                    | Fault::EncoderStuck
                    | Fault::LostCounts
            );
            assert_eq!(fault.loses_angles(), lost, "{fault:?}");
        }
    }
}
