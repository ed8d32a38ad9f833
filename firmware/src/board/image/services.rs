//! What the session needs from a board: settings stored in flash, the tool's output, the stack's use and the log.

use super::{Chip, Parts, Tool, Watchdog};
use crate::board::cycles::TickTimes;
use crate::board::stack;
use crate::protocol::{BoardReport, BoardTest, CommandError, StackUse};
use crate::recorder::Recorder;
use crate::session::Board;
use crate::settings::{BoardLimits, CheckedSettings};
use crate::storage::{SettingsStorage, StorageError};
use crate::{ActuatorCommand, ArmController, SensorSample, Settings, ToldSample};

/// The settings' storage, and the watchdog, whose timeout is longer while settings are written.
pub struct BoardServices<P: Parts> {
    /// None if the flash has no place for it.
    pub storage: Option<SettingsStorage<<P::Chip as Chip>::Flash>>,
    /// The tool's output.
    pub tool: <P::Chip as Chip>::Tool,
    /// Refreshed when all tasks have advanced.
    pub watchdog: <P::Chip as Chip>::Watchdog,
    /// The sample of the last tick.
    pub sample: ToldSample,
    /// How long the ticks take.
    pub times: TickTimes,
    /// For the test of a bare board.
    pub facts: <P::Chip as Chip>::Facts,
}

impl<P: Parts> Board<P::Drives> for BoardServices<P> {
    fn save(&mut self, settings: &Settings) -> Result<(), StorageError> {
        let storage = self.storage.as_mut().ok_or(StorageError::Range)?;
        self.watchdog.with_erase_timeout(|| storage.save(settings))
    }

    fn use_settings(&mut self, settings: &CheckedSettings) {
        self.tool.configure(&settings.tool_output);
    }

    fn limits(&self) -> Option<BoardLimits> {
        Some(P::LIMITS)
    }

    fn tick(
        &mut self,
        _: &mut ArmController<P::Drives>,
        _: &SensorSample,
    ) -> Option<(ActuatorCommand, u32)> {
        None
    }

    fn stack(&self) -> Option<StackUse> {
        Some(stack::used())
    }

    fn recorder(&self) -> Option<Recorder<'_>> {
        Some(P::Chip::recorder())
    }

    fn sample(&self) -> Option<ToldSample> {
        Some(self.sample)
    }

    fn test(&mut self, test: BoardTest, tick: u32) -> Result<Option<BoardReport>, CommandError> {
        P::Chip::test(self, test, tick)
    }
}
