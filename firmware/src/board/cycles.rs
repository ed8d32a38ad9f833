//! How long the tick takes, in cycles of the core, by the DWT's counter.

use cortex_m::peripheral::{DCB, DWT};

/// Measures spans and remembers the last and the longest.
pub struct CycleMeter {
    last: u32,
    most: u32,
}

impl CycleMeter {
    /// Starts the cycle counter.
    pub fn new(dcb: &mut DCB, dwt: &mut DWT) -> Self {
        dcb.enable_trace();
        dwt.enable_cycle_counter();
        Self { last: 0, most: 0 }
    }

    /// Runs `work` and counts its cycles.
    #[inline]
    pub fn measure<R>(&mut self, work: impl FnOnce() -> R) -> R {
        let start = DWT::cycle_count();
        let result = work();
        self.last = DWT::cycle_count().wrapping_sub(start);
        self.most = self.most.max(self.last);
        result
    }

    /// Cycles of the last span.
    pub fn last(&self) -> u32 {
        self.last
    }

    /// Cycles of the longest span.
    pub fn most(&self) -> u32 {
        self.most
    }
}
