//! What each image sets up of the chip: from the reset to the one body's start.

use super::{CLOCK_FAILED, Line, OnChip, crystal_failed};
use crate::board::image::Hardware;
use crate::board::image::tasks::Commands;
use crate::board::stm32f405::clocks::{self, Source};
use crate::board::stm32f405::self_test::Started;
use crate::board::stm32f405::serial::Buffers;
use crate::board::stm32f405::storage::SettingsFlash;
use crate::board::stm32f405::tool::ToolTimer;
use crate::board::stm32f405::{brown_out, halt, pins, post_mortem, serial};
use crate::storage::SettingsStorage;
use core::sync::atomic::Ordering;
use stm32f4xx_hal::pac;

/// What each image takes of the chip.
#[allow(missing_docs, reason = "the names are those of the chip")]
pub struct CommonPeripherals {
    pub rcc: pac::RCC,
    pub flash: pac::FLASH,
    pub debug: pac::DBGMCU,
    pub watchdog: pac::IWDG,
    pub crystal_timer: pac::TIM11,
    pub tool_timer: pac::TIM3,
    pub usart: pac::USART1,
    pub dma: pac::DMA2,
}

/// Sets the chip up. Interrupts are masked.
#[inline(always)]
pub fn set_up<P: OnChip>(
    common: CommonPeripherals,
    own: P::Peripherals,
    buffers: &'static mut Buffers,
    commands: Commands,
) -> Hardware<P> {
    let (reset, hung) = post_mortem::reset_reason(&common.rcc);
    halt::prepare(&common.debug);
    let brown_out = brown_out::enable_reset(&common.flash);
    let (mut rcc, clocks) = clocks::start(common.rcc, &common.flash, &common.crystal_timer);
    let source = clocks.source;
    let crystal_runs = source == Source::Crystal;
    if !crystal_runs {
        defmt::error!(
            "no clock from a crystal that this image takes; it has {} Hz",
            clocks.crystal
        );
    }
    let parts = P::new(own, source, &mut rcc);
    let brake = pins::set_up();
    let tool = ToolTimer::new(common.tool_timer, source.tool_timer(), &mut rcc);
    let (receiver, sender) = serial::new(
        &common.usart,
        &common.dma,
        buffers,
        source.second_bus(),
        &mut rcc,
    );
    let flash = SettingsFlash::new(common.flash);
    Hardware {
        parts,
        clock: source,
        clock_runs: crystal_runs,
        reset,
        brake,
        tool,
        receiver,
        lines: Line { commands, sender },
        locals: (),
        storage: SettingsStorage::new(flash, SettingsFlash::RANGE).ok(),
        watchdog: common.watchdog,
        facts: Started {
            clocks,
            brown_out,
            hung,
        },
    }
}

/// What the end of the start does about the crystal.
pub fn started<P: OnChip>(source: Source) {
    let crystal_runs = source == Source::Crystal;
    if !crystal_runs {
        CLOCK_FAILED.store(true, Ordering::Relaxed);
    }
    if crystal_runs && CLOCK_FAILED.load(Ordering::Relaxed) {
        // It failed meanwhile, and what came behind it set up pins and dividers as if it had not.
        crystal_failed::<P>();
    }
}
