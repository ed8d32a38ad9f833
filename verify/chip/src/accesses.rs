//! How many registers behind a bridge to a slower bus the program accesses in a tick: each makes the core wait.

use crate::mcu::DriveKind;
use crate::nvic::FIRST;

/// Accesses over APB1 and over APB2.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Accesses {
    now: [u32; 2],
    most: [u32; 2],
}

impl Accesses {
    /// In one tick.
    pub(crate) fn most(&self) -> [u32; 2] {
        self.most
    }

    /// An exception begins; that of the tick counts from 0.
    pub(crate) fn enter(&mut self, exception: u32, tick: u32) {
        if exception == tick {
            self.now = [0; 2];
        }
    }

    /// An access to a register of a peripheral; `active` is the exception that runs.
    pub(crate) fn count(&mut self, address: u32, active: Option<u32>, tick: u32) {
        let bus = match address {
            0x4000_0000..0x4001_0000 => 0,
            0x4001_0000..0x4002_0000 => 1,
            _ => return,
        };
        if active == Some(tick) {
            self.now[bus] += 1;
            self.most[bus] = self.most[bus].max(self.now[bus]);
        }
    }
}

/// The exception of the tick: of the converters, of TIM4, of TIM5.
pub(crate) fn tick_of(drives: DriveKind) -> u32 {
    FIRST
        + match drives {
            DriveKind::Brushed => 18,
            DriveKind::Steppers => 30,
            DriveKind::OnBus => 50,
        }
}
