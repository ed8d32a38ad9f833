//! How long the tick takes, in cycles of the core, by the DWT's counter.
//!
//! The tick stores the times of the last span and of the longest. The idle task counts what it finds;
//! while it is busy for longer than a tick, it misses some.

use crate::protocol::Timing;
use core::sync::atomic::{AtomicU32, Ordering};
use cortex_m::peripheral::{DCB, DWT};

/// Cycles of the last span; the idle task takes them and leaves 0.
static LAST: AtomicU32 = AtomicU32::new(0);
/// Cycles of the last response, stored before `LAST`.
static LAST_RESPONSE: AtomicU32 = AtomicU32::new(0);
static LONGEST: AtomicU32 = AtomicU32::new(0);
static LONGEST_RESPONSE: AtomicU32 = AtomicU32::new(0);

/// Measures spans.
pub struct CycleMeter {
    /// When the last span began.
    began: Option<u32>,
}

impl CycleMeter {
    /// Starts the cycle counter.
    pub fn new(dcb: &mut DCB, dwt: &mut DWT) -> Self {
        dcb.enable_trace();
        dwt.enable_cycle_counter();
        Self { began: None }
    }

    /// Number of periods of `period` cycles that were missed since the last span began.
    #[inline]
    pub fn missed(&self, period: u32) -> u32 {
        let Some(began) = self.began else { return 0 };
        let elapsed = DWT::cycle_count().wrapping_sub(began);
        ((elapsed + period / 2) / period).saturating_sub(1)
    }

    /// Runs `work` and counts its cycles; `waited` have passed since it was due.
    #[inline]
    pub fn measure<R>(&mut self, waited: u32, work: impl FnOnce() -> R) -> R {
        let start = DWT::cycle_count();
        self.began = Some(start);
        let result = work();
        let cycles = DWT::cycle_count().wrapping_sub(start);
        let response = cycles.wrapping_add(waited);
        LAST_RESPONSE.store(response, Ordering::Relaxed);
        LAST.store(cycles, Ordering::Relaxed);
        store_longer(&LONGEST, cycles);
        store_longer(&LONGEST_RESPONSE, response);
        result
    }
}

/// Only the tick raises it. When the idle task counts from zero, a tick just before is lost at most.
#[inline]
fn store_longer(longest: &AtomicU32, cycles: u32) {
    if cycles > longest.load(Ordering::Relaxed) {
        longest.store(cycles, Ordering::Relaxed);
    }
}

/// The times that the idle task has counted.
pub struct TickTimes {
    interrupt: Timing,
    response: Timing,
    last: u32,
}

impl TickTimes {
    /// None.
    pub const fn new() -> Self {
        Self {
            interrupt: Timing::NONE,
            response: Timing::NONE,
            last: 0,
        }
    }

    /// Counts the last tick, unless it is counted. Called in each round of the idle task.
    pub fn count(&mut self) {
        let cycles = LAST.swap(0, Ordering::Relaxed);
        if cycles > 0 {
            self.last = cycles;
            self.interrupt.add(cycles);
            self.response.add(LAST_RESPONSE.load(Ordering::Relaxed));
        }
    }

    /// Counts from zero.
    pub fn begin(&mut self) {
        self.interrupt = Timing::NONE;
        self.response = Timing::NONE;
        LONGEST.store(0, Ordering::Relaxed);
        LONGEST_RESPONSE.store(0, Ordering::Relaxed);
    }

    /// The times of the interrupt.
    pub fn interrupt(&self) -> Timing {
        Timing {
            greatest: LONGEST.load(Ordering::Relaxed),
            ..self.interrupt
        }
    }

    /// The times from the start of the converters to the last output.
    pub fn response(&self) -> Timing {
        Timing {
            greatest: LONGEST_RESPONSE.load(Ordering::Relaxed),
            ..self.response
        }
    }

    /// Cycles of the last tick counted, and of the longest.
    pub fn last_and_longest(&self) -> (u32, u32) {
        (self.last, LONGEST.load(Ordering::Relaxed))
    }
}

impl Default for TickTimes {
    fn default() -> Self {
        Self::new()
    }
}
