//! What the board knows of itself, for the test of a bare board.

use super::clocks::Clocks;
use crate::protocol::BoardFacts;
use cortex_m::peripheral::DWT;
use stm32f4xx_hal::pac::FLASH;
use stm32f4xx_hal::signature::FlashSize;

/// Where the chip's maker has stored its number, three words.
const UNIQUE_ID: *const [u32; 3] = 0x1fff_7a10 as *const [u32; 3];

/// What was found at the start.
pub struct Started {
    /// The clocks.
    pub clocks: Clocks,
    /// The code of the brown-out level in the option bytes.
    pub brown_out: u8,
    /// If the watchdog ended a hang of the board's test: how long it took [cycles].
    pub hung: Option<u32>,
}

impl Started {
    /// The facts, after the tick of this number.
    pub fn facts(&self, tick: u32) -> BoardFacts {
        let cycles = DWT::cycle_count();
        // SAFETY: the registers are only read, and every chip has its number there.
        #[allow(unsafe_code)]
        let (flash, unique_id) = unsafe { (&*FLASH::ptr(), UNIQUE_ID.read_volatile()) };
        let Self {
            clocks,
            brown_out,
            hung,
        } = self;
        BoardFacts {
            core: clocks.source.core(),
            crystal: clocks.crystal,
            flash_access: flash.acr().read().bits(),
            flash_size: FlashSize::get().kilo_bytes(),
            brown_out: *brown_out,
            unique_id,
            cycles,
            tick,
            hung: *hung,
        }
    }
}
