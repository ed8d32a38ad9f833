//! The independent watchdog, refreshed only when every task has advanced.
//!
//! Its oscillator has 32 kHz nominally, 17 to 47 kHz over parts and temperature. New values
//! take five of its cycles to arrive (0.3 ms at most), and a refresh before that loads the old
//! ones; so every change here waits for its arrival and then refreshes. It counts on while a debugger halts the core
//! ([`halt`]).

use super::halt;
use crate::board::{alive, image};
use stm32f4xx_hal::pac::IWDG;

/// The values of the key register: access to the others, refresh, start.
const ACCESS: u16 = 0x5555;
const REFRESH: u16 = 0xaaaa;
const START: u16 = 0xcccc;
/// How often the update flags are looked at: more than 5 slow cycles, even of the fastest core.
const TIMEOUT_READS: u32 = 100_000;

/// A prescaler, as its register's value, and a reload value.
#[derive(Clone, Copy)]
struct Timeout {
    prescaler: u8,
    reload: u16,
}

/// 400 counts of 4 slow cycles: 50 ms, 34 to 94 ms over the oscillator's tolerance.
const RUNNING: Timeout = Timeout {
    prescaler: 0,
    reload: 399,
};
/// 1500 counts of 256 slow cycles: 12 s, 8 s at least. Erasing two flash sectors stalls the core
/// for up to 4 s.
const ERASING: Timeout = Timeout {
    prescaler: 6,
    reload: 1499,
};

/// The watchdog. Once started, only a reset stops it.
pub struct Watchdog {
    iwdg: IWDG,
}

impl image::Watchdog for Watchdog {
    type Stopped = IWDG;

    /// Until the first values arrive, it bites after 0.5 s.
    fn start(iwdg: IWDG) -> Self {
        let mut watchdog = Self { iwdg };
        watchdog.write_key(START);
        watchdog.set(RUNNING);
        watchdog
    }

    fn refresh_if_all_advanced(&mut self) {
        if alive::all_advanced() {
            self.write_key(REFRESH);
            halt::keep_watchdog_counting();
        }
    }

    fn with_erase_timeout<R>(&mut self, work: impl FnOnce() -> R) -> R {
        self.set(ERASING);
        let result = work();
        self.set(RUNNING);
        result
    }
}

impl Watchdog {
    /// Sets a timeout, waits until it has arrived, and refreshes.
    fn set(&mut self, timeout: Timeout) {
        self.write_key(ACCESS);
        // SAFETY: 3 and 12 bits are any value of these registers.
        #[allow(unsafe_code)]
        unsafe {
            self.iwdg.pr().write(|w| w.pr().bits(timeout.prescaler));
            self.iwdg.rlr().write(|w| w.rl().bits(timeout.reload));
        }
        let arrived = || {
            let status = self.iwdg.sr().read();
            status.pvu().bit_is_clear() && status.rvu().bit_is_clear()
        };
        // If they never arrive, the old values stay: they are as safe.
        let _ = (0..TIMEOUT_READS).any(|_| arrived());
        self.write_key(REFRESH);
    }

    fn write_key(&mut self, key: u16) {
        // SAFETY: any 16 bits are a key or have no effect.
        #[allow(unsafe_code)]
        self.iwdg.kr().write(|w| unsafe { w.key().bits(key) });
    }
}
