//! The kinds of drives that are explored, seen as brushed motors: what has a duty drives.

use super::arm::{Disturbance, FollowingArm, settings};
use fivebar_firmware::drives::{
    BrushedCommand, BrushedDrives, Drives, Resolution, StepDrives, StepSample,
};
use fivebar_firmware::{ActuatorCommand, ArmCommand, ArmSample, SensorSample, Settings, Status};

pub(super) trait ExploredDrives: Drives + Send + Sync {
    /// Nothing shows the joints' place without power.
    const OPEN_LOOP: bool;

    /// The settings of the arm with them.
    fn settings() -> Settings;

    /// Whether a disturbance changes what they do.
    fn feels(disturbance: Disturbance) -> bool;

    /// The sample of a tick.
    fn sample(arm: &FollowingArm, sensed: &SensorSample) -> ArmSample<Self::Sample>;

    /// The command of a tick.
    fn seen(command: &ArmCommand<Self::Command>) -> ActuatorCommand;

    /// A tick's motion under this command.
    fn step(
        arm: &mut FollowingArm,
        command: &ArmCommand<Self::Command>,
        status: &Status,
        settings: &Settings,
    );
}

impl ExploredDrives for BrushedDrives {
    const OPEN_LOOP: bool = false;

    fn settings() -> Settings {
        settings()
    }

    fn feels(_: Disturbance) -> bool {
        true
    }

    fn sample(_: &FollowingArm, sensed: &SensorSample) -> SensorSample {
        *sensed
    }

    fn seen(command: &ActuatorCommand) -> ActuatorCommand {
        *command
    }

    fn step(
        arm: &mut FollowingArm,
        command: &ActuatorCommand,
        status: &Status,
        settings: &Settings,
    ) {
        arm.step(command, status, settings);
    }
}

/// Steppers without encoders.
impl ExploredDrives for StepDrives {
    const OPEN_LOOP: bool = true;

    /// Only torques cross a singularity.
    fn settings() -> Settings {
        Settings {
            crossing_allowed: false,
            ..settings()
        }
    }

    fn feels(disturbance: Disturbance) -> bool {
        use Disturbance::{
            BusHigh, BusLow, DriverFault, EmergencyStop, FrozenCounts, LatePlanner, OverCurrent,
            Push, SwitchesClosed, SwitchesOpen, WrongTorque, WrongZero,
        };
        match disturbance {
            EmergencyStop | DriverFault | Push | SwitchesClosed | SwitchesOpen | LatePlanner => {
                true
            }
            BusLow | BusHigh | OverCurrent | WrongZero | FrozenCounts | WrongTorque => false,
        }
    }

    fn sample(arm: &FollowingArm, sensed: &SensorSample) -> ArmSample<StepSample> {
        sensed.with_drives(StepSample {
            steps: arm.made,
            resolution: [Resolution::default(); 2],
        })
    }

    fn seen(command: &ArmCommand<Self::Command>) -> ActuatorCommand {
        let duty = command.drives.steps.map(|steps| steps.signum() as f32);
        command.with_drives(BrushedCommand { duty })
    }

    fn step(
        arm: &mut FollowingArm,
        command: &ArmCommand<Self::Command>,
        _: &Status,
        settings: &Settings,
    ) {
        arm.make_steps(command.drives.steps, settings);
    }
}
