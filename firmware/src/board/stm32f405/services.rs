//! What the session needs from this board: settings stored in flash, the tool's timer, and the
//! stack's use.

use super::post_mortem;
use super::self_test::Started;
use super::storage::SettingsFlash;
use super::tool::ToolTimer;
use super::watchdog::Watchdog;
use crate::board::cycles::TickTimes;
use crate::board::stack;
use crate::drives::Drives;
use crate::protocol::{BoardReport, BoardTest, CommandError, StackUse, TimedSpan};
use crate::recorder::{LogControl, LogWords, Recorder};
use crate::session::Board;
use crate::settings::{BoardLimits, CheckedSettings};
use crate::storage::{SettingsStorage, StorageError};
use crate::{ActuatorCommand, ArmController, SensorSample, Settings, ToldSample};
use stm32f4xx_hal::pac::{FLASH, IWDG};

static LOG: LogControl = LogControl::new();
/// In the core-coupled memory, which nothing clears at the start.
#[allow(unsafe_code)]
// SAFETY: the linker script reserves the section for such data, and no word is read before it was written.
#[unsafe(link_section = ".ccm.log")]
static LOG_WORDS: LogWords = LogWords::new();

/// The log at the tick rate.
#[inline(always)]
pub fn recorder() -> Recorder<'static> {
    Recorder::new(&LOG, &LOG_WORDS)
}

/// Drives that this board has an image for.
pub trait OnBoard: Drives {
    /// The board's bounds with them.
    const LIMITS: BoardLimits;
}

/// The settings' storage, and the watchdog, whose timeout is longer while settings are written.
pub struct BoardServices {
    storage: Option<Storage>,
    tool: ToolTimer,
    /// Refreshed when all tasks have advanced.
    pub watchdog: Watchdog,
    /// The sample of the last tick.
    pub sample: ToldSample,
    /// How long the ticks take.
    pub times: TickTimes,
    started: Started,
}

impl BoardServices {
    /// Starts the watchdog: after the stored settings were read, because that may erase a sector.
    pub fn start(
        storage: Option<Storage>,
        watchdog: IWDG,
        tool: ToolTimer,
        started: Started,
    ) -> Self {
        Self {
            storage,
            tool,
            watchdog: Watchdog::start(watchdog),
            sample: ToldSample::default(),
            times: TickTimes::new(),
            started,
        }
    }
}

/// The settings' storage.
pub type Storage = SettingsStorage<SettingsFlash>;

/// Opens the storage.
pub fn open(flash: FLASH) -> Option<Storage> {
    SettingsStorage::new(SettingsFlash::new(flash), SettingsFlash::RANGE).ok()
}

// What any drives need is compiled once, below.
impl<D: OnBoard> Board<D> for BoardServices {
    fn save(&mut self, settings: &Settings) -> Result<(), StorageError> {
        self.store(settings)
    }

    fn use_settings(&mut self, settings: &CheckedSettings) {
        self.tool.configure(&settings.tool_output);
    }

    fn limits(&self) -> Option<BoardLimits> {
        Some(D::LIMITS)
    }

    fn tick(
        &mut self,
        _: &mut ArmController<D>,
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

    fn test(&mut self, test: BoardTest, tick: u32) -> Result<Option<BoardReport>, CommandError> {
        self.measure(test, tick)
    }
}

impl BoardServices {
    fn store(&mut self, settings: &Settings) -> Result<(), StorageError> {
        let storage = self.storage.as_mut().ok_or(StorageError::Range)?;
        self.watchdog.with_erase_timeout(|| storage.save(settings))
    }

    fn measure(&mut self, test: BoardTest, tick: u32) -> Result<Option<BoardReport>, CommandError> {
        let report = match test {
            BoardTest::Facts => BoardReport::Facts(self.started.facts(tick)),
            BoardTest::BeginTiming => {
                self.times.begin();
                return Ok(None);
            }
            BoardTest::Timing(TimedSpan::Interrupt) => BoardReport::Timing(self.times.interrupt()),
            BoardTest::Timing(TimedSpan::Response) => BoardReport::Timing(self.times.response()),
            BoardTest::EraseFlash => self.timed(SettingsStorage::erase_older)?,
            BoardTest::ProgramFlash => self.timed(SettingsStorage::program_older)?,
            BoardTest::Hang => post_mortem::hang(),
        };
        Ok(Some(report))
    }

    /// Does something with the flash, and reports how long its operations take.
    fn timed(
        &mut self,
        work: impl FnOnce(&mut SettingsStorage<SettingsFlash>) -> Result<(), StorageError>,
    ) -> Result<BoardReport, CommandError> {
        let storage = self.storage.as_mut();
        let storage = storage.ok_or(CommandError::Storage(StorageError::Range))?;
        storage.flash().take_time();
        self.watchdog
            .with_erase_timeout(|| work(storage))
            .map_err(CommandError::Storage)?;
        Ok(BoardReport::Flash(storage.flash().take_time()))
    }
}
