//! The settings with which a board starts: those stored, within its bounds.

use crate::Settings;
use crate::settings::{BoardLimits, CheckedSettings};
use crate::storage::{SettingsStorage, StorageError};
use embedded_storage::nor_flash::NorFlash;

/// Puts the stored settings in the place of these, if they are within the board's bounds.
///
/// # Errors
/// Why it cannot.
// A call of its own, as those that make the controllers: none takes the other's stack.
#[inline(never)]
pub fn load<F: NorFlash>(
    storage: &mut Option<SettingsStorage<F>>,
    limits: &BoardLimits,
    settings: &mut CheckedSettings,
) -> Result<(), StorageError> {
    let storage = storage.as_mut().ok_or(StorageError::Range)?;
    // By reference: the stack holds them once.
    match &storage.load() {
        Ok(stored) => check(stored, limits, settings),
        Err(error) => Err(*error),
    }
}

/// The settings of a board on which none were stored.
#[inline(never)]
pub fn benchtop() -> CheckedSettings {
    let Ok(settings) = Settings::BENCHTOP.check() else {
        panic!("the benchtop arm's settings are valid");
    };
    settings
}

/// Checks stored settings, within this board's bounds, and puts them in the place of those in use.
#[inline(never)]
fn check(
    stored: &Settings,
    limits: &BoardLimits,
    settings: &mut CheckedSettings,
) -> Result<(), StorageError> {
    let bounded = limits.check(stored);
    let checked = bounded.and_then(|()| stored.check());
    *settings = checked.map_err(|_| StorageError::Corrupt)?;
    Ok(())
}
