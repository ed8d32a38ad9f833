//! What the test of a bare board asks for, and what the board reports. Only a board with timers,
//! converters and flash of its own can answer.

use serde::{Deserialize, Serialize};

/// Bins of the counts in [`Timing`].
pub const TIMING_BINS: usize = 32;
/// Width of a bin: a thirty-second of the 16,800 cycles from one tick to the next [cycles].
pub const TIMING_BIN: u32 = 525;

/// A step of a board's test. All but the first three need the bridges off.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum BoardTest {
    /// Report what the board knows of itself.
    Facts,
    /// Count the ticks' times from zero.
    BeginTiming,
    /// Report the times counted since.
    Timing(TimedSpan),
    /// Erase the sectors that do not hold the newest settings, and report the longest erase.
    EraseFlash,
    /// Program words of an erased sector with ones, which leaves them erased, and report the longest.
    ProgramFlash,
    /// Hang the session's task until the watchdog resets the board. Gets no reply.
    Hang,
}

/// What of a tick is timed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum TimedSpan {
    /// The interrupt's work, from the reading of the sensors to the last output.
    Interrupt,
    /// From the start of the converters to the last output: conversion, waiting, interrupt.
    Response,
}

/// A report of a board's test.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum BoardReport {
    /// To [`BoardTest::Facts`].
    Facts(BoardFacts),
    /// To [`BoardTest::Timing`].
    Timing(Timing),
    /// To [`BoardTest::EraseFlash`] and [`BoardTest::ProgramFlash`].
    Flash(FlashTime),
}

/// What a board knows of itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct BoardFacts {
    /// The core's clock [Hz].
    pub core: u32,
    /// The crystal's frequency, measured against the internal oscillator at the start [Hz]; none if it
    /// did not start.
    pub crystal: Option<u32>,
    /// The flash's access control register: wait states, prefetch and caches.
    pub flash_access: u32,
    /// Size of the flash [KiB].
    pub flash_size: u16,
    /// The brown-out level that the option bytes had at the start: 0 is the highest, 3 is off.
    pub brown_out: u8,
    /// The chip's number.
    pub unique_id: [u32; 3],
    /// The core's cycle counter and the number of the last tick, read together.
    pub cycles: u32,
    /// The number of the last tick.
    pub tick: u32,
    /// If the watchdog ended a [`BoardTest::Hang`]: how long it took [cycles].
    pub hung: Option<u32>,
}

/// The times of ticks [cycles].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Timing {
    /// The number of ticks below: those that the idle task saw.
    pub ticks: u32,
    /// The shortest of them.
    pub least: u32,
    /// The longest of all ticks, seen by the idle task or not.
    pub greatest: u32,
    /// Their sum.
    pub sum: u64,
    /// How many of them lie in each bin of [`TIMING_BIN`] cycles; the last bin holds all longer ones.
    pub bins: [u32; TIMING_BINS],
}

/// The time of operations of the flash.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct FlashTime {
    /// The longest operation [cycles of the core].
    pub longest: u32,
    /// The number of operations: sectors erased or words programmed.
    pub operations: u16,
}

impl Timing {
    /// No ticks.
    pub const NONE: Self = Self {
        ticks: 0,
        least: u32::MAX,
        greatest: 0,
        sum: 0,
        bins: [0; TIMING_BINS],
    };

    /// Counts a tick.
    pub fn add(&mut self, cycles: u32) {
        self.ticks = self.ticks.wrapping_add(1);
        self.least = self.least.min(cycles);
        self.greatest = self.greatest.max(cycles);
        self.sum = self.sum.wrapping_add(u64::from(cycles));
        let bin = (cycles / TIMING_BIN).min(TIMING_BINS as u32 - 1);
        if let Some(count) = self.bins.get_mut(bin as usize) {
            *count = count.wrapping_add(1);
        }
    }

    /// The mean [cycles]; none without ticks.
    pub fn mean(&self) -> Option<f64> {
        (self.ticks > 0).then(|| self.sum as f64 / f64::from(self.ticks))
    }
}

#[cfg(test)]
mod tests {
    use super::{TIMING_BIN, TIMING_BINS, Timing};

    #[test]
    fn ticks_are_counted_in_bins_and_the_last_one_holds_all_longer_ones() {
        let mut timing = Timing::NONE;
        assert_eq!(timing.mean(), None);
        for cycles in [TIMING_BIN - 1, TIMING_BIN, 40 * TIMING_BIN, u32::MAX] {
            timing.add(cycles);
        }
        assert_eq!(timing.bins[..2], [1, 1]);
        assert_eq!(timing.bins[TIMING_BINS - 1], 2);
        assert_eq!((timing.ticks, timing.least), (4, TIMING_BIN - 1));
        assert_eq!(timing.greatest, u32::MAX);
        let sum = u64::from(42 * TIMING_BIN - 1) + u64::from(u32::MAX);
        assert_eq!(timing.mean(), Some(sum as f64 / 4.0));
    }
}
