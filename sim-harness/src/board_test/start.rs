//! Rows of what the board found at its start: crystal, flash, clock of the ticks.

use super::bench::{Bench, LATER, SECOND};
use super::row::{Limit, Row, Verdict};
use crate::link::LinkError;
use fivebar_firmware::protocol::BoardFacts;
use std::io::{Read, Write};

/// Five wait states, prefetch, code cache and data cache, in FLASH_ACR.
const ACCELERATED: u32 = 0x705;
const ACCELERATION_BITS: u32 = 0x707;
/// The flash that holds settings in sectors 8 to 11 [KiB].
const FLASH_SIZE: u16 = 1024;
/// Cycles from one tick to the next, and the greatest error of that.
const TICK_CYCLES: f64 = 16_800.0;
const TICK_ERROR: f64 = 0.001;
/// What to do about a crystal that the image does not take.
pub(super) const FIT_CRYSTAL: &str = "fit a crystal of 8, 12 or 16 MHz with its two capacitors, or build the image for one of 24 or 25 MHz \
     (FIVEBAR_CRYSTAL), and power the board up again";

pub(super) fn crystal(facts: &BoardFacts) -> Row {
    let limit = Limit::new(
        "crystal",
        "8, 12 or 16 MHz −5 to +9.4 %, measured by the internal oscillator; 24 or 25 in an image built for it",
        "the internal oscillator has −8 to +4.5 % (firmware/src/drivers/crystal.rs)",
    );
    let Some(frequency) = facts.crystal else {
        let why = "the crystal does not start";
        return limit.row("none", Verdict::failed(why, FIT_CRYSTAL));
    };
    let mega = f64::from(frequency) / 1e6;
    let why =
        format!("the crystal has {mega:.1} MHz, from which the image does not make its clock");
    let verdict = Verdict::of(runs_from_crystal(facts), why, FIT_CRYSTAL);
    limit.row(format!("{mega:.3} MHz"), verdict)
}

pub(super) fn accelerator(facts: &BoardFacts) -> Row {
    let limit = Limit::new(
        "flash accelerator",
        "5 wait states, prefetch and both caches on",
        "168 MHz at 2.7 V and more (RM0090, FLASH_ACR)",
    );
    let bits = facts.flash_access & ACCELERATION_BITS;
    let on = |bit: u32| if bits >> bit & 1 == 1 { "on" } else { "off" };
    let measured = format!(
        "{} wait states, prefetch {}, code cache {}, data cache {}",
        bits & 7,
        on(8),
        on(9),
        on(10)
    );
    let verdict = Verdict::of(
        bits == ACCELERATED,
        "the flash is read without its accelerator, so the interrupt takes longer",
        "compare FLASH_ACR after the start with firmware/src/board/stm32f405/clocks.rs; a chip that only resembles an \
         STM32F405 may have no accelerator",
    );
    limit.row(measured, verdict)
}

pub(super) fn size(facts: &BoardFacts) -> Row {
    let limit = Limit::new(
        "flash size",
        "1024 KiB or more",
        "the settings lie in sectors 8 to 11 (firmware/src/board/stm32f405/storage.rs)",
    );
    let why = "the chip has no sectors for the settings";
    let verdict = Verdict::of(
        facts.flash_size >= FLASH_SIZE,
        why,
        "fit an STM32F405RG, not an RE",
    );
    limit.row(format!("{} KiB", facts.flash_size), verdict)
}

/// Cycles of the core from one tick to the next, over a second.
pub(super) fn tick_period<L: Read + Write>(bench: &mut Bench<'_, L>) -> Result<Row, LinkError> {
    let limit = Limit::new(
        "tick period",
        "16,800 cycles of the core ± 0.1 %",
        "168 MHz / 10 kHz (firmware/src/board/stm32f405/brushed/pwm.rs)",
    );
    let Some(before) = bench.facts()?.filter(runs_from_crystal) else {
        return Ok(limit.not_seen("the core runs from the internal oscillator", FIT_CRYSTAL));
    };
    let passed = bench.pass(SECOND)?;
    let after = bench.facts()?.filter(|_| passed);
    let Some(after) = after else {
        return Ok(limit.row("no ticks", Verdict::failed("no tick comes", LATER)));
    };
    let cycles = f64::from(after.cycles.wrapping_sub(before.cycles));
    let period = cycles / f64::from(after.tick.wrapping_sub(before.tick));
    let verdict = Verdict::of(
        (period / TICK_CYCLES - 1.0).abs() <= TICK_ERROR,
        format!(
            "the PWM's timer starts a tick every {period:.0} cycles, at {:.2} kHz",
            168e3 / period
        ),
        "compare the timer's clock and period with firmware/src/board/stm32f405/brushed/pwm.rs",
    );
    Ok(limit.row(format!("{period:.1} cycles"), verdict))
}

/// The row of what needs a core that runs from the crystal.
pub(super) fn needs_crystal(name: &'static str) -> Row {
    Limit::new(name, "", "").not_seen("the core runs from the internal oscillator", FIT_CRYSTAL)
}

/// Whether the core runs from the crystal.
pub(super) fn runs_from_crystal(facts: &BoardFacts) -> bool {
    facts.core > 100_000_000
}
