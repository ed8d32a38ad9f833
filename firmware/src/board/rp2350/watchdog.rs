//! The watchdog, refreshed only when every task has advanced. It counts microseconds of the crystal.

use crate::board::{alive, image};
use rp235x_pac::{PSM, WATCHDOG, psm, watchdog};

/// 50 ms.
const RUNNING: u32 = 50_000;
/// 12 s: a sector is erased in 45 ms, in 400 ms at most, and storing erases two.
const ERASING: u32 = 12_000_000;
/// What a reset by the watchdog resets: everything but the oscillators.
const ALL: u32 = 0x01ff_fff3;

/// The watchdog. Once started, only a reset stops it.
pub struct Watchdog {
    watchdog: WATCHDOG,
}

impl image::Watchdog for Watchdog {
    type Stopped = (WATCHDOG, PSM);

    fn start((watchdog, psm): Self::Stopped) -> Self {
        choose_all(&psm);
        let mut watchdog = Self { watchdog };
        watchdog.load(RUNNING);
        // It counts on while a debugger halts the core.
        watchdog.watchdog.ctrl().write(|w| {
            w.pause_jtag().clear_bit().pause_dbg0().clear_bit();
            w.pause_dbg1().clear_bit().enable().set_bit()
        });
        watchdog
    }

    fn refresh_if_all_advanced(&mut self) {
        if alive::all_advanced() {
            self.load(RUNNING);
        }
    }

    fn with_erase_timeout<R>(&mut self, work: impl FnOnce() -> R) -> R {
        self.load(ERASING);
        let result = work();
        self.load(RUNNING);
        result
    }
}

impl Watchdog {
    fn load(&mut self, microseconds: u32) {
        // SAFETY: 24 bits.
        #[allow(unsafe_code)]
        self.watchdog
            .load()
            .write(|w| unsafe { w.bits(microseconds) });
    }
}

/// Resets the chip now, for a program that ends.
pub fn force(watchdog: &watchdog::RegisterBlock, psm: &psm::RegisterBlock) {
    choose_all(psm);
    watchdog.ctrl().write(|w| w.trigger().set_bit());
}

fn choose_all(psm: &psm::RegisterBlock) {
    // SAFETY: any bits are a choice of what is reset.
    #[allow(unsafe_code)]
    psm.wdsel().write(|w| unsafe { w.bits(ALL) });
}
