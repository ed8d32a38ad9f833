//! What the session needs from this board: settings stored in flash, the tool's output, the stack's use and the log.

use super::flash::SettingsFlash;
use super::tool::ToolTimer;
use super::watchdog::Watchdog;
use crate::board::cycles::TickTimes;
use crate::board::stack;
use crate::drives::BlindStepDrives;
use crate::protocol::StackUse;
use crate::recorder::{Log, Recorder};
use crate::session::Board;
use crate::settings::{BoardLimits, CheckedSettings};
use crate::storage::{SettingsStorage, StorageError};
use crate::{ActuatorCommand, ArmController, SensorSample, Settings, ToldSample};

static LOG: Log = Log::new();

/// The log at the tick rate.
#[inline(always)]
pub fn recorder() -> Recorder<'static> {
    LOG.recorder()
}

/// The settings' storage.
pub type Storage = SettingsStorage<SettingsFlash>;

/// Opens the storage.
pub fn open() -> Option<Storage> {
    SettingsStorage::new(SettingsFlash::new(), SettingsFlash::RANGE).ok()
}

/// The services. Of the test of a bare board there are none: its bounds are those of the STM32F405.
pub struct BoardServices {
    /// None if the flash has no place for it.
    pub storage: Option<Storage>,
    /// What the image can do.
    pub limits: BoardLimits,
    /// The tool's output.
    pub tool: ToolTimer,
    /// Refreshed when all tasks have advanced.
    pub watchdog: Watchdog,
    /// The sample of the last tick.
    pub sample: ToldSample,
    /// How long the ticks take.
    pub times: TickTimes,
}

impl Board<BlindStepDrives> for BoardServices {
    fn save(&mut self, settings: &Settings) -> Result<(), StorageError> {
        let storage = self.storage.as_mut().ok_or(StorageError::Range)?;
        self.watchdog.with_erase_timeout(|| storage.save(settings))
    }

    fn use_settings(&mut self, settings: &CheckedSettings) {
        self.tool.configure(&settings.tool_output);
    }

    fn limits(&self) -> Option<BoardLimits> {
        Some(self.limits)
    }

    fn tick(
        &mut self,
        _: &mut ArmController<BlindStepDrives>,
        _: &SensorSample,
    ) -> Option<(ActuatorCommand, u32)> {
        None
    }

    fn stack(&self) -> Option<StackUse> {
        Some(stack::used())
    }

    fn recorder(&self) -> Option<Recorder<'_>> {
        Some(recorder())
    }

    fn sample(&self) -> Option<ToldSample> {
        Some(self.sample)
    }
}
