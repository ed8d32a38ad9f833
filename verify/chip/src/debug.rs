//! DBGMCU: what stops when a debugger halts the core (RM0090, 38.16).

use crate::peripherals::reset_cause::ResetCause;
use crate::violation::{Access, refuse};

// Bits of APB1_FZ: TIM4, TIM5, both watchdogs; of APB2_FZ: TIM1, TIM8.
pub(crate) const TIM4: u32 = 2;
pub(crate) const TIM5: u32 = 3;
const WWDG: u32 = 11;
pub(crate) const IWDG: u32 = 12;
pub(crate) const TIM1: u32 = 0;
pub(crate) const TIM8: u32 = 1;

/// DBGMCU, and whether a debugger halts the core.
#[derive(Clone, Debug, Default)]
pub(crate) struct Debug {
    apb1: u32,
    apb2: u32,
    halted: bool,
}

impl Debug {
    /// A reset: the registers stay but at power-up, and the core runs.
    pub(crate) fn reset(&mut self, cause: ResetCause) {
        self.halted = false;
        if cause == ResetCause::Power {
            *self = Self::default();
        }
    }

    pub(crate) fn is_halted(&self) -> bool {
        self.halted
    }

    /// The core halts, or goes on.
    pub(crate) fn halt(&mut self, halts: bool) {
        self.halted = halts;
    }

    /// Whether this bit of APB1_FZ (0) or APB2_FZ (1) stops its part now.
    pub(crate) fn stops(&self, bus: usize, bit: u32) -> bool {
        self.halted && [self.apb1, self.apb2][bus] >> bit & 1 != 0
    }

    /// A debugger stops the watchdogs for its halts.
    pub(crate) fn stop_watchdogs(&mut self) {
        self.apb1 |= 1 << WWDG | 1 << IWDG;
    }

    pub(crate) fn read(&self, offset: u32) -> u32 {
        match offset {
            0x0 => 0x1007_6413,
            0x8 => self.apb1,
            0xc => self.apb2,
            _ => 0,
        }
    }

    pub(crate) fn write(&mut self, offset: u32, value: u32) -> Access<()> {
        let (register, simulated) = match offset {
            0x8 => (
                &mut self.apb1,
                1 << TIM4 | 1 << TIM5 | 1 << WWDG | 1 << IWDG,
            ),
            0xc => (&mut self.apb2, 1 << TIM1 | 1 << TIM8),
            _ => {
                let rule = format!("offset {offset:#x} is not simulated");
                return refuse("DBGMCU", value, rule);
            }
        };
        if value & !simulated != 0 {
            return refuse("DBGMCU_FZ", value, "a stop that is not simulated");
        }
        *register = value;
        Ok(())
    }
}
