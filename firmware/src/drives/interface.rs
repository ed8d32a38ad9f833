//! What goes over the wires between a controller and its arm in a tick.

use super::Drives;
use crate::settings::CheckedSettings;
use crate::{ArmCommand, ArmSample};
use core::fmt::Debug;
use serde::Serialize;
use serde::de::DeserializeOwned;

/// A tick's sample as it comes from the arm with drives of a kind, and its command as it goes to them. Where the host steps
/// the ticks, these are exchanged with it, so all code between the wires and the tick runs on the board.
pub trait DriveInterface {
    /// The drives of the controller.
    type Drives: Drives;
    /// What comes from the drives.
    type Sample: Copy + Default + Debug + Send + Serialize + DeserializeOwned;
    /// What goes to them.
    type Command: Copy + Default + Debug + Send + Serialize + DeserializeOwned;
    /// What lies between, with a memory of its own.
    type Link: Send;

    /// The link to the drives of these settings.
    fn link(settings: &CheckedSettings) -> Self::Link;

    /// The tick's sample. Called once in each tick.
    fn sense(
        link: &mut Self::Link,
        sample: &ArmSample<Self::Sample>,
    ) -> ArmSample<<Self::Drives as Drives>::Sample>;

    /// What goes to the drives for a tick's command. Called once in each tick.
    fn command(
        link: &mut Self::Link,
        command: &ArmCommand<<Self::Drives as Drives>::Command>,
    ) -> ArmCommand<Self::Command>;
}

/// Drives whose sample and command themselves are on the wires.
impl<D> DriveInterface for D
where
    D: Drives<Sample: Serialize + DeserializeOwned, Command: Serialize + DeserializeOwned>,
{
    type Drives = D;
    type Sample = D::Sample;
    type Command = D::Command;
    type Link = ();

    fn link(_: &CheckedSettings) {}

    #[inline(always)]
    fn sense((): &mut (), sample: &ArmSample<D::Sample>) -> ArmSample<D::Sample> {
        *sample
    }

    #[inline(always)]
    fn command((): &mut (), command: &ArmCommand<D::Command>) -> ArmCommand<D::Command> {
        *command
    }
}
