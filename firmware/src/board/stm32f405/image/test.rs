//! The test of a bare board.

use super::Stm32f405;
use crate::board::image::{BoardServices, Parts, Watchdog};
use crate::board::stm32f405::post_mortem;
use crate::board::stm32f405::storage::SettingsFlash;
use crate::protocol::{BoardReport, BoardTest, CommandError, TimedSpan};
use crate::storage::{SettingsStorage, StorageError};

/// Does a step of the test.
pub(super) fn measure<P: Parts<Chip = Stm32f405>>(
    services: &mut BoardServices<P>,
    test: BoardTest,
    tick: u32,
) -> Result<Option<BoardReport>, CommandError> {
    let times = &mut services.times;
    let report = match test {
        BoardTest::Facts => BoardReport::Facts(services.facts.facts(tick)),
        BoardTest::BeginTiming => {
            times.begin();
            return Ok(None);
        }
        BoardTest::Timing(TimedSpan::Interrupt) => BoardReport::Timing(times.interrupt()),
        BoardTest::Timing(TimedSpan::Response) => BoardReport::Timing(times.response()),
        BoardTest::EraseFlash => timed(services, SettingsStorage::erase_older)?,
        BoardTest::ProgramFlash => timed(services, SettingsStorage::program_older)?,
        BoardTest::Hang => post_mortem::hang(),
    };
    Ok(Some(report))
}

/// Does something with the flash, and reports how long its operations take.
fn timed<P: Parts<Chip = Stm32f405>>(
    services: &mut BoardServices<P>,
    work: impl FnOnce(&mut SettingsStorage<SettingsFlash>) -> Result<(), StorageError>,
) -> Result<BoardReport, CommandError> {
    let storage = services.storage.as_mut();
    let storage = storage.ok_or(CommandError::Storage(StorageError::Range))?;
    storage.flash().take_time();
    services
        .watchdog
        .with_erase_timeout(|| work(storage))
        .map_err(CommandError::Storage)?;
    Ok(BoardReport::Flash(storage.flash().take_time()))
}
