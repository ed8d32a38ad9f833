//! A debugger that halts the core.
//!
//! The core's own counters, SysTick and that of the cycles, stop in every halt. Of the timers whose bit is set in
//! DBGMCU the counters stop, and the outputs of those with complementary ones are disabled as if MOE were cleared;
//! the others go on, and so do DMA and pins.

use crate::chip::Chip;
use crate::debug::{IWDG, TIM1, TIM4, TIM5, TIM8};
use crate::mcu::Mcu;

impl Mcu {
    /// A debugger halts the core, or lets it go on.
    fn halt(&mut self, halts: bool) {
        if self.debug.is_halted() == halts {
            return;
        }
        self.run_events();
        let now = self.now;
        self.cycles = self.cycle_at(now);
        self.cycles_at = now;
        self.debug.halt(halts);
        let debug = &self.debug;
        let ticks = if self.is_on_bus() { TIM5 } else { TIM4 };
        self.tim1.halt(debug.stops(1, TIM1), now);
        self.tim8.halt(debug.stops(1, TIM8), now);
        self.pulse.halt(debug.stops(1, TIM8), now);
        self.ticks.halt(debug.stops(0, ticks), now);
        self.iwdg.halt(debug.stops(0, IWDG), now);
        self.settle(now);
    }
}

impl Chip {
    /// A debugger halts the core: the program stands still until [`Chip::resume_core`] or a reset, and the rest of the
    /// chip goes on but for what DBGMCU stops.
    pub fn halt_core(&mut self) {
        self.mcu().halt(true);
    }

    /// The debugger lets the program go on.
    pub fn resume_core(&mut self) {
        self.mcu().halt(false);
    }

    /// Whether a debugger halts the core.
    pub fn is_core_halted(&self) -> bool {
        self.cpu().mcu.debug.is_halted()
    }

    /// A debugger stops the watchdogs for its halts, as its scripts do when it connects.
    pub fn debugger_stops_watchdogs(&mut self) {
        self.mcu().debug.stop_watchdogs();
    }
}
