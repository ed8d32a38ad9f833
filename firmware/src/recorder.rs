//! A log of chosen signals at the tick rate, in memory, which the host fetches afterwards.
//!
//! The tick's interrupt records a row, and the session below it begins the log and reads it. All
//! fields are atomic, so neither waits for the other: while the log is set up, it is idle.

use crate::drives::Drives;
use crate::drives::words::SensedWords;
use crate::io::{ArmCommand, ArmSample};
use core::sync::atomic::{AtomicU8, AtomicU16, AtomicU32, Ordering};
use serde::{Deserialize, Serialize};

/// Room of the log [words of 16 bits]: 0.3 s of four signals at 10 kHz.
pub const LOG_WORDS: usize = 12_288;
/// Words of a page, in rows of 32.
pub const PAGE_WORDS: usize = 2 * PAGE_ROW;
/// The longest array that serde reads.
const PAGE_ROW: usize = 32;

bitflags::bitflags! {
    /// The signals of a log, one bit each. A row holds one word for each, in this order.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub struct Signals: u8 {
        /// The lower 16 bits of joint 1's counts.
        const COUNTS_1 = 1;
        /// The same of joint 4.
        const COUNTS_4 = 2;
        /// What the drive of joint 1 senses: of a brushed motor its current [ADC codes], of other drives as in
        /// [`words`](crate::drives::words).
        const SENSED_1 = 4;
        /// The same of joint 4.
        const SENSED_4 = 8;
        /// What the drive of joint 1 is told: of a brushed motor its duty times 32767, as a signed number. It was computed
        /// from this row's sample and acts from the next tick on.
        const TOLD_1 = 16;
        /// The same of joint 4.
        const TOLD_4 = 32;
        /// What is sensed of both drives: with brushed motors the bus voltage [ADC codes].
        const SENSED_OF_BOTH = 64;
        /// Bits from the lowest: home switches of joints 1 and 4, emergency stop, fault outputs of
        /// bridges 1 and 4, enables of bridges 1 and 4, brake; above them the missed ticks, 255 at
        /// most.
        const INPUTS = 128;
    }
}

/// What is recorded.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct LogConfig {
    /// The bits of [`Signals`].
    pub signals: u8,
    /// Ticks from one row to the next, from 1.
    pub every: u16,
    /// Wait for a tick in which a bridge is on.
    pub powered: bool,
}

/// What the log does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum LogState {
    /// Nothing was recorded since the reset.
    Empty,
    /// It waits for power.
    Waiting,
    /// It records.
    Recording,
    /// It is full.
    Full,
}

/// A part of the log.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct LogPage {
    /// What the log does.
    pub state: LogState,
    /// Its words so far.
    pub words: u16,
    /// The tick of its first row.
    pub first_tick: u32,
    /// The words from the one asked for; zeros behind the last one.
    pub page: [[u16; PAGE_ROW]; 2],
}

/// The values are refused: no signals, or no ticks between rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct InvalidLog;

/// What a log does.
pub struct LogControl {
    state: AtomicU8,
    signals: AtomicU8,
    /// Words of a row.
    row: AtomicU8,
    every: AtomicU16,
    /// Ticks until the next row.
    wait: AtomicU16,
    words: AtomicU16,
    first_tick: AtomicU32,
}

/// The words of a log, and behind them a row of words that are written and never read. Each word is written
/// before it is read: memory that no start-up code clears will do.
pub struct LogWords([AtomicU16; LOG_WORDS + SIGNALS]);

/// A log with its memory in one piece, for desktops.
pub struct Log {
    control: LogControl,
    words: LogWords,
}

/// A log: what it does, and its memory, which may lie elsewhere.
#[derive(Clone, Copy)]
pub struct Recorder<'a> {
    control: &'a LogControl,
    store: &'a LogWords,
}

/// The number of [`Signals`].
const SIGNALS: usize = 8;

const EMPTY: u8 = 0;
const WAITING: u8 = 1;
const RECORDING: u8 = 2;
const FULL: u8 = 3;

impl LogControl {
    /// An empty log. All zeros: the linker then needs no copy of it in flash.
    pub const fn new() -> Self {
        Self {
            state: AtomicU8::new(EMPTY),
            signals: AtomicU8::new(0),
            row: AtomicU8::new(0),
            every: AtomicU16::new(0),
            wait: AtomicU16::new(0),
            words: AtomicU16::new(0),
            first_tick: AtomicU32::new(0),
        }
    }
}

impl LogWords {
    /// Words of an empty log.
    pub const fn new() -> Self {
        Self([const { AtomicU16::new(0) }; LOG_WORDS + SIGNALS])
    }
}

impl Default for LogControl {
    fn default() -> Self {
        Self::new()
    }
}

impl Default for LogWords {
    fn default() -> Self {
        Self::new()
    }
}

impl Log {
    /// An empty log.
    pub const fn new() -> Self {
        Self {
            control: LogControl::new(),
            words: LogWords::new(),
        }
    }

    /// What records in it and reads it.
    pub const fn recorder(&self) -> Recorder<'_> {
        Recorder::new(&self.control, &self.words)
    }
}

impl Default for Log {
    fn default() -> Self {
        Self::new()
    }
}

impl<'a> Recorder<'a> {
    /// A log in this memory.
    pub const fn new(control: &'a LogControl, store: &'a LogWords) -> Self {
        Self { control, store }
    }

    /// Drops what was recorded and begins a log.
    ///
    /// # Errors
    /// No signals, or rows 0 ticks apart; the log stays as it is.
    pub fn begin(&self, config: &LogConfig) -> Result<(), InvalidLog> {
        if config.signals == 0 || config.every == 0 {
            return Err(InvalidLog);
        }
        // The tick's interrupt leaves an empty log alone.
        self.control.state.store(EMPTY, Ordering::SeqCst);
        self.control.signals.store(config.signals, Ordering::SeqCst);
        let row = config.signals.count_ones() as u8;
        self.control.row.store(row, Ordering::SeqCst);
        self.control.every.store(config.every, Ordering::SeqCst);
        self.control.wait.store(0, Ordering::SeqCst);
        self.control.words.store(0, Ordering::SeqCst);
        let state = if config.powered { WAITING } else { RECORDING };
        self.control.state.store(state, Ordering::SeqCst);
        Ok(())
    }

    /// Records a tick of a controller with these drives, if a row is due. Its number counts from the reset.
    #[inline(always)]
    pub fn record<D: Drives>(
        &self,
        drives: &D,
        sample: &ArmSample<D::Sample>,
        command: &ArmCommand<D::Command>,
        tick: u32,
    ) {
        let state = self.control.state.load(Ordering::Relaxed);
        if state == EMPTY || state == FULL {
            return;
        }
        let [enable1, enable4] = command.enable;
        if state == WAITING {
            if !(enable1 || enable4) {
                return;
            }
            self.control.state.store(RECORDING, Ordering::Relaxed);
        }
        let wait = self.control.wait.load(Ordering::Relaxed);
        if wait > 0 {
            self.control.wait.store(wait - 1, Ordering::Relaxed);
            return;
        }
        let every = self.control.every.load(Ordering::Relaxed);
        self.control
            .wait
            .store(every.saturating_sub(1), Ordering::Relaxed);
        let start = self.control.words.load(Ordering::Relaxed);
        let row = u16::from(self.control.row.load(Ordering::Relaxed));
        if usize::from(start) + usize::from(row) > LOG_WORDS {
            self.control.state.store(FULL, Ordering::Relaxed);
            return;
        }
        if start == 0 {
            self.control.first_tick.store(tick, Ordering::Relaxed);
        }
        let rest = self.store.0.get(usize::from(start)..);
        let Some(words) = rest.and_then(<[AtomicU16]>::first_chunk::<SIGNALS>) else {
            return;
        };
        // Without a branch: a signal that is not chosen is overwritten by the next one, or lies behind the row.
        let mut signals = usize::from(self.control.signals.load(Ordering::Relaxed));
        let mut place = 0;
        let mut put = |value: u16| {
            if let Some(word) = words.get(place % SIGNALS) {
                word.store(value, Ordering::Relaxed);
            }
            place += signals & 1;
            signals >>= 1;
        };
        let SensedWords { joints, both } = drives.sensed_words(&sample.drives);
        let ([counts1, counts4], [sensed1, sensed4]) = (sample.counts, joints);
        let [told1, told4] = drives.told_words(&command.drives);
        // In the order of the bits of `Signals`.
        put(counts1 as u16);
        put(counts4 as u16);
        put(sensed1);
        put(sensed4);
        put(told1);
        put(told4);
        put(both);
        put(inputs(sample, command));
        self.control.words.store(start + row, Ordering::Relaxed);
    }

    /// The words from `from` on.
    pub fn page(&self, from: u16) -> LogPage {
        let words = self.control.words.load(Ordering::Relaxed);
        let mut page = [[0; PAGE_ROW]; 2];
        let recorded = self.store.0.get(usize::from(from)..usize::from(words));
        for (slot, word) in page
            .iter_mut()
            .flatten()
            .zip(recorded.into_iter().flatten())
        {
            *slot = word.load(Ordering::Relaxed);
        }
        LogPage {
            state: match self.control.state.load(Ordering::Relaxed) {
                WAITING => LogState::Waiting,
                RECORDING => LogState::Recording,
                FULL => LogState::Full,
                _ => LogState::Empty,
            },
            words,
            first_tick: self.control.first_tick.load(Ordering::Relaxed),
            page,
        }
    }
}

/// The word of [`Signals::INPUTS`].
#[inline(always)]
fn inputs<S, C>(sample: &ArmSample<S>, command: &ArmCommand<C>) -> u16 {
    let ([home1, home4], [driver1, driver4]) = (sample.home, sample.driver_fault);
    let [enable1, enable4] = command.enable;
    let missed = sample.missed_ticks.min(255) as u16;
    u16::from(home1)
        | u16::from(home4) << 1
        | u16::from(sample.emergency_stop) << 2
        | u16::from(driver1) << 3
        | u16::from(driver4) << 4
        | u16::from(enable1) << 5
        | u16::from(enable4) << 6
        | u16::from(command.brake) << 7
        | missed << 8
}
