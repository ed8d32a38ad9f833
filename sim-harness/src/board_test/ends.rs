//! Rows that come last: flash times, the serial line, the watchdog, the cause of its reset, brown-out.

use super::bench::{Bench, LATER};
use super::row::{Limit, Row, Verdict};
use crate::link::LinkError;
use fivebar_firmware::protocol::{BoardFacts, BoardTest, FlashTime, Reset};
use std::io::{Read, Write};

/// Longest erase of a sector of 128 KiB, 32 bits at a time [s], and programming of a word [s].
const ERASE: f64 = 2.05;
const PROGRAM: f64 = 100e-6;
/// The watchdog's time: 1600 cycles of its oscillator, of 17 to 47 kHz [s].
const WATCHDOG: std::ops::RangeInclusive<f64> = 0.034..=0.0945;
const WATCHDOG_COUNTS: f64 = 1600.0;

pub(super) fn flash<L: Read + Write>(
    bench: &mut Bench<'_, L>,
    facts: &BoardFacts,
) -> Result<[Row; 2], LinkError> {
    let core = f64::from(facts.core);
    let erase = Limit::new(
        "flash erase",
        "2 s or less for a sector of 128 KiB",
        "data sheet of the STM32F405, 32 bits at a time",
    );
    let program = Limit::new(
        "flash write",
        "100 µs or less for a word",
        "data sheet of the STM32F405, 32 bits at a time",
    );
    let erased = bench.flash(BoardTest::EraseFlash)?;
    let programmed = bench.flash(BoardTest::ProgramFlash)?;
    let row = |limit: Limit, time: Result<FlashTime, Verdict>, most: f64, unit: f64, name: &str| {
        let time = match time {
            Ok(time) => time,
            Err(verdict) => return limit.row("", verdict),
        };
        let seconds = f64::from(time.longest) / core;
        let measured = format!(
            "{:.1} {name}, the longest of {}",
            seconds / unit,
            time.operations
        );
        let why = format!("the flash is slow: {:.1} {name}", seconds / unit);
        let remedy =
            "measure the supply: below 2.7 V the flash is slower; a worn chip must be replaced";
        limit.row(measured, Verdict::of(seconds <= most, why, remedy))
    };
    Ok([
        row(erase, erased, ERASE, 1e-3, "ms"),
        row(program, programmed, PROGRAM, 1e-6, "µs"),
    ])
}

/// Damaged frames, and how often the host had to repeat itself until now. A simulated chip may be slower
/// than real time, so that the host repeats itself without a fault of the line.
pub(super) fn serial<L: Read + Write>(bench: &Bench<'_, L>, simulated: bool) -> Row {
    let limit = Limit::new(
        "serial line",
        "no frame is damaged, no command is sent again",
        "docs/design/protocol.md: a damaged frame is dropped",
    );
    let (damaged, repeats) = (bench.client.counts().corrupt, bench.client.repeats());
    let measured = match simulated {
        true => format!("{damaged} damaged; {repeats} sent again, not judged in simulation"),
        false => format!("{damaged} damaged, {repeats} sent again"),
    };
    let why = format!("{damaged} frames were damaged, {repeats} commands were sent again");
    let remedy =
        "shorten the cable, connect the grounds, and use an adapter for 1 Mbaud with 3.3 V levels";
    let holds = damaged == 0 && (simulated || repeats == 0);
    limit.row(measured, Verdict::of(holds, why, remedy))
}

/// Watchdog, cause of the reset, brown-out. The controller has begun anew afterwards.
pub(super) fn watchdog<L: Read + Write>(
    bench: &mut Bench<'_, L>,
    before: &BoardFacts,
) -> Result<[Row; 3], LinkError> {
    let watchdog = Limit::new(
        "watchdog",
        "bites 34 to 94 ms after a hang",
        "1600 cycles of an oscillator of 17 to 47 kHz (firmware/src/board/stm32f405/watchdog.rs)",
    );
    let cause = Limit::new(
        "reset cause",
        "the watchdog",
        "RCC_CSR after the reset (firmware/src/board/stm32f405/post_mortem.rs)",
    );
    let power = "switch the board off and on";
    let (bitten, reset, facts) = match bench.hang() {
        Err(LinkError::Silent) => (
            watchdog.row(
                "no reset",
                Verdict::failed(
                    "the watchdog does not bite: the board hangs",
                    "compare IWDG with firmware/src/board/stm32f405/watchdog.rs; then switch the board off and on",
                ),
            ),
            cause.not_seen("the board hangs", power),
            *before,
        ),
        Err(error) => return Err(error),
        Ok(Err(refusal)) => {
            let why = refusal.to_string();
            (
                watchdog.not_seen(&why, LATER),
                cause.not_seen(&why, LATER),
                *before,
            )
        }
        Ok(Ok(identity)) => {
            let facts = bench.facts()?.unwrap_or(*before);
            let row = match facts.hung {
                Some(cycles) => {
                    let seconds = f64::from(cycles) / f64::from(before.core);
                    let measured = format!(
                        "{:.1} ms, an oscillator of {:.1} kHz",
                        1e3 * seconds,
                        WATCHDOG_COUNTS / seconds / 1e3
                    );
                    let why = format!("it bites after {:.1} ms", 1e3 * seconds);
                    let remedy = "compare IWDG with firmware/src/board/stm32f405/watchdog.rs";
                    watchdog.row(measured, Verdict::of(WATCHDOG.contains(&seconds), why, remedy))
                }
                None => watchdog.row(
                    "reset, time unknown",
                    Verdict::failed("the note in RAM did not survive the reset", power),
                ),
            };
            let found = format!("{:?}", identity.reset).to_lowercase();
            let verdict = Verdict::of(
                identity.reset == Reset::Watchdog,
                format!("the board says: {found}"),
                "check NRST: its capacitor must not pull a reset of the chip longer than 20 µs",
            );
            (row, cause.row(found, verdict), facts)
        }
    };
    Ok([bitten, reset, brown_out(&facts)])
}

fn brown_out(facts: &BoardFacts) -> Row {
    let limit = Limit::new(
        "brown-out",
        "level 3: reset below 2.7 V",
        "168 MHz with five wait states needs 2.7 V (firmware/src/board/stm32f405/brown_out.rs)",
    );
    let measured = match facts.brown_out {
        0 => "level 3",
        1 => "level 2",
        2 => "level 1",
        _ => "off",
    };
    let verdict = Verdict::of(
        facts.brown_out == 0,
        "the option bytes do not hold the brown-out level",
        "clear the protection of the option bytes with the probe, and start again",
    );
    limit.row(measured, verdict)
}
