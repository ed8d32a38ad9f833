//! Counting executed instructions by SysTick.
//!
//! Under QEMU's `-icount shift=0` each instruction takes 1 ns of virtual time, and the
//! emulated SysTick runs at 168 MHz of it: instructions = SysTick counts · 1000/168. The
//! count repeats exactly from run to run. It counts instructions, not cycles.

use cortex_m::peripheral::SYST;
use cortex_m::peripheral::syst::SystClkSource;

/// SysTick is 24 bits wide.
const WRAP: u32 = 1 << 24;

/// A free-running count of instructions, good for spans under 99 million.
pub struct InstructionCounter {
    _systick: SYST,
}

impl InstructionCounter {
    /// Takes SysTick and lets it run freely.
    pub fn new(mut systick: SYST) -> Self {
        systick.set_clock_source(SystClkSource::Core);
        systick.set_reload(WRAP - 1);
        systick.clear_current();
        systick.enable_counter();
        Self { _systick: systick }
    }

    /// A moment, for [`InstructionCounter::since`].
    #[inline]
    pub fn now(&self) -> u32 {
        SYST::get_current()
    }

    /// Instructions executed since `start`, to within one SysTick count (6 instructions).
    #[inline]
    pub fn since(&self, start: u32) -> u32 {
        let counts = start.wrapping_sub(SYST::get_current()) % WRAP;
        // 1000/168 = 125/21; a count below 2²⁴ times 125 stays below 2³¹.
        (counts * 125 + 10) / 21
    }
}
