//! Drives on a bus, whose frames are on the wires.

use super::{Frame, Frames, Link, MOST_FRAMES, MOST_RECEIVED};
use crate::drives::{DriveHealth, DriveInterface, TorqueDrives, TorqueSample, TorqueSetPoint};
use crate::settings::CheckedSettings;
use crate::{ArmCommand, ArmSample};
use serde::{Deserialize, Serialize};

/// What is sensed of drives that the settings do not name: counts, and the rest of a sample.
pub const UNKNOWN: ([i32; 2], TorqueSample) = (
    [0; 2],
    TorqueSample {
        torque: [0.0; 2],
        age: [u16::MAX; 2],
        health: [DriveHealth::Off; 2],
        bus_off: false,
    },
);

/// The frames that have arrived since the tick before, in their order.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct BusSample {
    /// The frames, then none.
    pub frames: [Option<Frame>; MOST_RECEIVED],
    /// The controller's part on the bus has met so many errors that it takes part no more.
    pub is_off: bool,
}

/// The frames of a tick, in their order.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct BusCommand {
    /// The frames, then none.
    pub frames: [Option<Frame>; MOST_FRAMES],
}

/// [`TorqueDrives`] behind a [`Link`], of which the wires see the frames alone.
#[derive(Clone, Copy, Debug)]
pub struct BusDrives;

impl DriveInterface for BusDrives {
    type Drives = TorqueDrives;
    type Sample = BusSample;
    type Command = BusCommand;
    /// None while the settings name no drives.
    type Link = Option<Link>;

    fn link(settings: &CheckedSettings) -> Option<Link> {
        Link::of(settings)
    }

    /// The counts are those of the drives' encoders, which are in the frames.
    fn sense(link: &mut Option<Link>, sample: &ArmSample<BusSample>) -> ArmSample<TorqueSample> {
        let BusSample { frames, is_off } = &sample.drives;
        let (counts, drives) = link.as_mut().map_or(UNKNOWN, |link| {
            for frame in frames.iter().flatten() {
                link.receive(frame);
            }
            link.sample(*is_off)
        });
        ArmSample {
            counts,
            ..sample.with_drives(drives)
        }
    }

    fn command(
        link: &mut Option<Link>,
        command: &ArmCommand<TorqueSetPoint>,
    ) -> ArmCommand<BusCommand> {
        let mut sent = Frames::new();
        if let Some(link) = link {
            link.send(command.enable, &command.drives, &mut sent);
        }
        let mut drives = BusCommand::default();
        for (place, frame) in drives.frames.iter_mut().zip(sent) {
            *place = Some(frame);
        }
        command.with_drives(drives)
    }
}
