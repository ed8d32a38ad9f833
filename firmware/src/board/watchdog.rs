//! The independent watchdog, refreshed only when every task has advanced.

use core::sync::atomic::{AtomicU32, Ordering};
use stm32f4xx_hal::pac::IWDG;
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::watchdog::IndependentWatchdog;

/// Timeout [ms]: without a refresh the chip resets, and the bridges are off.
const TIMEOUT: u32 = 50;
/// Timeout while settings are written [ms]: erasing a flash sector stalls the core for up to 2.6 s
/// (4 s at low voltage).
const ERASE_TIMEOUT: u32 = 8_000;

/// One task's sign of life: a bit of [`ALIVE`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Task {
    /// The control tick.
    Tick,
    /// The session with the host and the planner.
    Session,
}

/// The tasks that have advanced since the last refresh.
static ALIVE: AtomicU32 = AtomicU32::new(0);
/// [`ALIVE`] when all have advanced.
const ALL: u32 = Task::Tick.bit() | Task::Session.bit();

impl Task {
    const fn bit(self) -> u32 {
        1 << self as u32
    }

    /// Reports that this task has advanced.
    #[inline]
    pub fn advanced(self) {
        ALIVE.fetch_or(self.bit(), Ordering::Relaxed);
    }
}

/// The watchdog. Once started, only a reset stops it.
pub struct Watchdog {
    iwdg: IndependentWatchdog,
}

impl Watchdog {
    /// Starts it.
    pub fn start(iwdg: IWDG) -> Self {
        let mut iwdg = IndependentWatchdog::new(iwdg);
        iwdg.start(TIMEOUT.millis());
        Self { iwdg }
    }

    /// Refreshes the watchdog if every task has advanced since the last refresh.
    pub fn refresh_if_all_advanced(&mut self) {
        if ALIVE.load(Ordering::Relaxed) == ALL {
            ALIVE.store(0, Ordering::Relaxed);
            self.iwdg.feed();
        }
    }

    /// Runs `work` with a timeout that is long enough for erasing flash.
    pub fn with_erase_timeout<R>(&mut self, work: impl FnOnce() -> R) -> R {
        self.iwdg.start(ERASE_TIMEOUT.millis());
        let result = work();
        self.iwdg.start(TIMEOUT.millis());
        result
    }
}
