//! How long the tick takes, in cycles of the core, by the DWT's counter.

use core::sync::atomic::{AtomicU32, Ordering};
use cortex_m::peripheral::{DCB, DWT};

/// Cycles of the last span and of the longest, for the log to read.
static LAST: AtomicU32 = AtomicU32::new(0);
static LONGEST: AtomicU32 = AtomicU32::new(0);

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

    /// Runs `work` and counts its cycles.
    #[inline]
    pub fn measure<R>(&mut self, work: impl FnOnce() -> R) -> R {
        let start = DWT::cycle_count();
        self.began = Some(start);
        let result = work();
        let cycles = DWT::cycle_count().wrapping_sub(start);
        LAST.store(cycles, Ordering::Relaxed);
        // Nothing else writes it.
        if cycles > LONGEST.load(Ordering::Relaxed) {
            LONGEST.store(cycles, Ordering::Relaxed);
        }
        result
    }
}

/// Cycles of the last span.
pub fn last() -> u32 {
    LAST.load(Ordering::Relaxed)
}

/// Cycles of the longest span.
pub fn longest() -> u32 {
    LONGEST.load(Ordering::Relaxed)
}
