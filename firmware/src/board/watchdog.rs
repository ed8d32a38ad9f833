//! The independent watchdog, fed only when every task has advanced.

use core::sync::atomic::{AtomicU32, Ordering};
use stm32f4xx_hal::pac::IWDG;
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::watchdog::IndependentWatchdog;

/// Without food for this long the chip resets, and with it the bridges lose power [ms].
const TIMEOUT: u32 = 50;
/// Erasing a flash sector stalls the core for up to 2.6 s (4 s at low voltage) [ms].
const ERASE_TIMEOUT: u32 = 8_000;

/// One task's sign of life: a bit of [`ALIVE`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Task {
    /// The control tick.
    Tick,
    /// The session with the host and the planner.
    Session,
}

/// The tasks that advanced since the last meal.
static ALIVE: AtomicU32 = AtomicU32::new(0);
/// What [`ALIVE`] looks like when all did.
const ALL: u32 = Task::Tick.bit() | Task::Session.bit();

impl Task {
    const fn bit(self) -> u32 {
        1 << self as u32
    }

    /// Says that this task advanced.
    #[inline]
    pub fn advanced(self) {
        ALIVE.fetch_or(self.bit(), Ordering::Relaxed);
    }
}

/// The watchdog; once started nothing but a reset stops it.
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

    /// Feeds it if every task advanced since it was fed last.
    pub fn feed_if_all_advanced(&mut self) {
        if ALIVE.load(Ordering::Relaxed) == ALL {
            ALIVE.store(0, Ordering::Relaxed);
            self.iwdg.feed();
        }
    }

    /// Runs `work`, which may stall the core as long as erasing flash does.
    pub fn widened<R>(&mut self, work: impl FnOnce() -> R) -> R {
        self.iwdg.start(ERASE_TIMEOUT.millis());
        let result = work();
        self.iwdg.start(TIMEOUT.millis());
        result
    }
}
