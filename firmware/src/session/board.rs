//! What the session needs of a board.

use crate::controller::ArmController;
use crate::drives::{BrushedCommand, BrushedDrives, BrushedSample, Drives};
use crate::protocol::{BoardReport, BoardTest, CommandError, StackUse};
use crate::recorder::Recorder;
use crate::safety::State;
use crate::settings::{BoardLimits, CheckedSettings};
use crate::storage::StorageError;
use crate::{ArmCommand, ArmSample, Settings, ToldSample};
use rtic_core::Mutex;

/// What the session needs from its board, whose controller is that of an arm with these drives. Where the host steps the ticks,
/// each has a sample with `S` and a command with `C`.
pub trait Board<D: Drives = BrushedDrives, S = BrushedSample, C = BrushedCommand> {
    /// Stores settings for the next start. They are those in use, so they were checked.
    ///
    /// # Errors
    /// Why they are not stored.
    fn save(&mut self, settings: &Settings) -> Result<(), StorageError>;

    /// Takes from new settings what the board's own parts need. Called with the bridges off.
    fn use_settings(&mut self, _settings: &CheckedSettings) {}

    /// The board's bounds of the settings; `None` where the host steps the ticks.
    fn limits(&self) -> Option<BoardLimits> {
        None
    }

    /// Runs one tick on a sample from the host. Returns the actuator command and the number of
    /// instructions, 0 where they are not counted. `None` on a board with sensors of its own.
    fn tick(
        &mut self,
        controller: &mut ArmController<D>,
        sample: &ArmSample<S>,
    ) -> Option<(ArmCommand<C>, u32)>;

    /// How much of the stack has been used; `None` where that is not measured.
    fn stack(&self) -> Option<StackUse> {
        None
    }

    /// The log at the tick rate; `None` on a board without one.
    fn recorder(&self) -> Option<Recorder<'_>> {
        None
    }

    /// The sensor sample of the last tick; `None` where samples come from the host.
    fn sample(&self) -> Option<ToldSample> {
        None
    }

    /// Does a step of the board's test after the tick of this number; `None` where it reports nothing.
    ///
    /// # Errors
    /// Why it is not done: a board without a test of its own does none.
    fn test(&mut self, _test: BoardTest, _tick: u32) -> Result<Option<BoardReport>, CommandError> {
        Err(CommandError::Unsupported)
    }
}

/// The controller as the session shares it with the tick.
pub trait SharedController<D: Drives = BrushedDrives>: Mutex<T = ArmController<D>> {
    /// Puts a new controller for these settings, which must be homed, in the place of a stopped one. It keeps
    /// the motors' heat.
    ///
    /// # Errors
    /// The state of a controller that is not stopped; it stays.
    fn renew(&mut self, settings: &CheckedSettings) -> Result<(), State>;
}

/// A controller that is not shared.
impl<D: Drives> SharedController<D> for ArmController<D> {
    fn renew(&mut self, settings: &CheckedSettings) -> Result<(), State> {
        let mut new = Self::new(settings);
        self.hand_over(&mut new)?;
        *self = new;
        Ok(())
    }
}
