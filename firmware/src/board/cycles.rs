//! How long the tick takes, in cycles of the core, by the DWT's counter.

use cortex_m::peripheral::{DCB, DWT};

/// Measures spans and remembers the last and the longest.
pub struct CycleMeter {
    /// When the last span began.
    began: Option<u32>,
    last: u32,
    most: u32,
}

impl CycleMeter {
    /// Starts the cycle counter.
    pub fn new(dcb: &mut DCB, dwt: &mut DWT) -> Self {
        dcb.enable_trace();
        dwt.enable_cycle_counter();
        Self {
            began: None,
            last: 0,
            most: 0,
        }
    }

    /// How many periods of so many cycles went by unseen since the last span began.
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
