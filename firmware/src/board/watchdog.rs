//! The independent watchdog, refreshed only when every task has advanced.

use bitflags::bitflags;
use core::sync::atomic::{AtomicU32, Ordering};
use stm32f4xx_hal::pac::IWDG;
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::watchdog::IndependentWatchdog;

/// Timeout [ms]: without a refresh the chip resets, and the bridges are off.
const TIMEOUT: u32 = 50;
/// Timeout while settings are written [ms]: erasing a flash sector stalls the core for up to 2.6 s
/// (4 s at low voltage).
const ERASE_TIMEOUT: u32 = 8_000;

bitflags! {
    /// The tasks that must advance for a refresh.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub struct Tasks: u32 {
        /// The control tick.
        const TICK = 1;
        /// The session with the host and the planner.
        const SESSION = 2;
    }
}

/// The bits of the tasks that have advanced since the last refresh.
static ALIVE: AtomicU32 = AtomicU32::new(0);

impl Tasks {
    /// Reports that these tasks have advanced.
    #[inline]
    pub fn advanced(self) {
        ALIVE.fetch_or(self.bits(), Ordering::Relaxed);
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
        if ALIVE.load(Ordering::Relaxed) == Tasks::all().bits() {
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
