//! Which tasks have advanced since the watchdog was refreshed last.

use bitflags::bitflags;
use core::sync::atomic::{AtomicU32, Ordering};

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

/// The bits of the tasks that have advanced.
static ALIVE: AtomicU32 = AtomicU32::new(0);

impl Tasks {
    /// Reports that these tasks have advanced.
    #[inline]
    pub fn advanced(self) {
        ALIVE.fetch_or(self.bits(), Ordering::Relaxed);
    }
}

/// Whether every task has advanced since this was true last.
pub fn all_advanced() -> bool {
    let all = ALIVE.load(Ordering::Relaxed) == Tasks::all().bits();
    if all {
        ALIVE.store(0, Ordering::Relaxed);
    }
    all
}
