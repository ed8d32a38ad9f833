//! What the session asks of this board: settings stored in its flash.

use super::pwm::TICK_RATE;
use super::stack;
use super::storage::SettingsFlash;
use super::watchdog::Watchdog;
use crate::protocol::StackUse;
use crate::session::Board;
use crate::storage::{SettingsStorage, StorageError};
use crate::{Command, Controller, Sensed, Settings};
use stm32f4xx_hal::pac::{FLASH, IWDG};

/// The settings' storage, and the watchdog that has to wait while they are written.
pub struct BoardServices {
    storage: Option<SettingsStorage<SettingsFlash>>,
    /// Fed where all tasks advance.
    pub watchdog: Watchdog,
}

impl BoardServices {
    /// Opens the storage and starts the watchdog; also the stored settings, if there are any
    /// that this board can use.
    pub fn start(flash: FLASH, watchdog: IWDG) -> (Self, Result<Settings, StorageError>) {
        let (storage, settings) =
            match SettingsStorage::new(SettingsFlash::new(flash), SettingsFlash::RANGE) {
                Ok(mut storage) => {
                    let settings = storage.load().and_then(usable);
                    (Some(storage), settings)
                }
                Err(error) => (None, Err(error)),
            };
        let watchdog = Watchdog::start(watchdog);
        (Self { storage, watchdog }, settings)
    }
}

/// Settings that are sound and of this board's tick rate.
fn usable(settings: Settings) -> Result<Settings, StorageError> {
    if settings.control.tick_rate == TICK_RATE && settings.validate().is_ok() {
        Ok(settings)
    } else {
        Err(StorageError::Corrupt)
    }
}

impl Board for BoardServices {
    fn save(&mut self, settings: &Settings) -> Result<(), StorageError> {
        let storage = self.storage.as_mut().ok_or(StorageError::Range)?;
        self.watchdog.widened(|| storage.save(settings))
    }

    fn tick_rate(&self) -> Option<f32> {
        Some(TICK_RATE)
    }

    fn tick(&mut self, _: &mut Controller, _: &Sensed) -> Option<(Command, u32)> {
        None
    }

    fn stack(&self) -> Option<StackUse> {
        Some(stack::used())
    }
}
