//! TIM1: a counter with repetition counter, four PWM outputs, break input, trigger output, and the slave mode in which a
//! trigger starts it anew. TIM8 is its like.

mod registers;

use crate::register::Register;
use crate::time::{NEVER, Time};

/// How the outputs are connected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Output {
    /// Not driven by the timer.
    Released,
    /// At its idle level.
    Idle(bool),
    /// High for this share of the period [core counts of the timer], of the period's length.
    Pwm {
        /// Counts for which the output is high.
        high: u32,
        /// Counts of a whole period.
        period: u32,
    },
}

/// Which way the repetition counter is loaded: the manual says two things.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RepetitionReading {
    /// The description of the counter: its preload arrives at an update only.
    AtUpdate,
    /// The sentence on odd values: written after the start, the update is at the underflow,
    /// written before, at the overflow.
    BySentence,
}

/// What happened in the timer.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Tim1Events {
    /// The trigger output rose.
    pub(crate) trigger: bool,
}

/// The timer.
#[derive(Clone, Debug)]
pub(crate) struct Tim1 {
    cr1: Register,
    cr2: Register,
    smcr: Register,
    dier: Register,
    sr: Register,
    ccmr: [Register; 2],
    ccer: Register,
    psc: Register,
    arr: Register,
    rcr: Register,
    ccr: [Register; 4],
    bdtr: Register,
    bdtr_locked: bool,
    /// What is in effect behind the preload registers.
    prescaler: u32,
    top: u32,
    compare: [u32; 4],
    /// What `compare` was before the last update.
    compare_before: [u32; 4],
    repetitions: u32,
    pub(crate) reading: RepetitionReading,
    repetitions_written_running: bool,
    /// The place in the period at `since` [counts]; up to twice the top when centre aligned.
    phase: u64,
    since: Time,
    /// Period of the timer's clock.
    clock: Time,
    /// The next overflow or underflow.
    boundary_at: Time,
    /// The break input is active now.
    break_active: bool,
    /// TIM4 among its triggers.
    trigger: u32,
    /// The next match of a channel's compare value, where a trigger starts the counter anew.
    edge_at: Time,
    /// A debugger halts the core, and the counter stops with it.
    halted: bool,
}

/// The slave mode in which a trigger starts the counter anew.
const RESET_MODE: u32 = 4;
const UIF: u32 = 0;
const BIF: u32 = 7;
const MOE: u32 = 15;
const FLAGS: u32 = 0x1eff;

impl Tim1 {
    pub(crate) fn new(clock: Time) -> Self {
        // TIM4 is its trigger 3.
        Self::with_trigger(clock, 3)
    }

    /// TIM8, whose trigger 2 is TIM4. Its registers are reported by the names of TIM1's.
    pub(crate) fn tim8(clock: Time) -> Self {
        Self::with_trigger(clock, 2)
    }

    fn with_trigger(clock: Time, trigger: u32) -> Self {
        let names = ["TIM1_CCR1", "TIM1_CCR2", "TIM1_CCR3", "TIM1_CCR4"];
        Self {
            cr1: Register::new("TIM1_CR1", 0, 0x3ff, 0),
            cr2: Register::new("TIM1_CR2", 0, 0x7ffd, 0),
            smcr: Register::new("TIM1_SMCR", 0, 0xfff7, 0),
            dier: Register::new("TIM1_DIER", 0, 0x7fff, 0),
            sr: Register::new("TIM1_SR", 0, 0, FLAGS),
            ccmr: [
                Register::new("TIM1_CCMR1", 0, 0xffff, 0),
                Register::new("TIM1_CCMR2", 0, 0xffff, 0),
            ],
            ccer: Register::new("TIM1_CCER", 0, 0x3fff, 0),
            psc: Register::new("TIM1_PSC", 0, 0xffff, 0),
            arr: Register::new("TIM1_ARR", 0xffff, 0xffff, 0xffff),
            rcr: Register::new("TIM1_RCR", 0, 0xff, 0),
            ccr: names.map(|name| Register::new(name, 0, 0xffff, 0)),
            bdtr: Register::new("TIM1_BDTR", 0, 0xffff, 0),
            bdtr_locked: false,
            prescaler: 0,
            top: 0xffff,
            compare: [0; 4],
            compare_before: [0; 4],
            repetitions: 0,
            reading: RepetitionReading::AtUpdate,
            repetitions_written_running: false,
            phase: 0,
            since: 0,
            clock,
            boundary_at: NEVER,
            break_active: false,
            trigger,
            edge_at: NEVER,
            halted: false,
        }
    }

    pub(crate) fn reset(&mut self) {
        let reading = self.reading;
        *self = Self::with_trigger(self.clock, self.trigger);
        self.reading = reading;
    }

    fn is_centred(&self) -> bool {
        self.cr1.field(5, 2) != 0
    }

    fn runs(&self) -> bool {
        self.cr1.bit(0) && !self.halted
    }

    /// The counter stops, with its outputs off, or goes on.
    pub(crate) fn halt(&mut self, halts: bool, now: Time) {
        self.rebase(now);
        self.halted = halts;
        self.plan();
    }

    fn count_time(&self) -> Time {
        self.clock * u64::from(self.prescaler + 1)
    }

    /// Counts in a whole period.
    fn cycle(&self) -> u64 {
        let top = u64::from(self.top);
        if self.is_centred() { 2 * top } else { top + 1 }
    }

    fn phase_at(&self, now: Time) -> u64 {
        if !self.runs() {
            return self.phase;
        }
        let counted = now.saturating_sub(self.since) / self.count_time();
        (self.phase + counted) % self.cycle().max(1)
    }

    /// The counter, and whether it counts down.
    pub(crate) fn counter(&self, now: Time) -> (u32, bool) {
        let phase = self.phase_at(now);
        if phase > u64::from(self.top) {
            ((self.cycle() - phase) as u32, true)
        } else {
            // At the top the direction has turned already.
            (
                phase as u32,
                self.is_centred() && phase == u64::from(self.top),
            )
        }
    }

    /// Takes the phase at `now` as the new origin; plans the next boundary.
    fn rebase(&mut self, now: Time) {
        self.phase = self.phase_at(now);
        self.since = now;
        self.plan();
    }

    fn plan(&mut self) {
        self.edge_at = self.next_edge().unwrap_or(NEVER);
        let (top, cycle) = (u64::from(self.top), self.cycle());
        if !self.runs() || top == 0 {
            self.boundary_at = NEVER;
            return;
        }
        let next = if self.is_centred() && self.phase < top {
            top
        } else {
            cycle
        };
        self.boundary_at = self.since + (next - self.phase) * self.count_time();
    }

    /// Whether a trigger starts the counter anew.
    fn is_restarted(&self) -> bool {
        self.smcr.field(0, 3) == RESET_MODE
    }

    /// The next match of an enabled channel's compare value in this period.
    fn next_edge(&self) -> Option<Time> {
        if !self.runs() || !self.is_restarted() {
            return None;
        }
        let enabled = (0..4).filter(|channel| self.ccer.bit(4 * channel));
        let matches = enabled
            .map(|channel| u64::from(self.compare[channel as usize]))
            .filter(|&compare| self.phase < compare && compare <= u64::from(self.top));
        let next = matches.min()?;
        Some(self.since + (next - self.phase) * self.count_time())
    }

    /// TIM4's trigger: in its slave mode, the counter starts anew, with an update whatever the repetition counter is.
    pub(crate) fn restart(&mut self, at: Time) {
        if !self.halted && self.is_restarted() && self.smcr.field(4, 3) == self.trigger {
            (self.phase, self.since) = (0, at);
            self.update(true);
            self.plan();
        }
    }

    /// The level that channel 0…3 drives in PWM mode 1 or 2 while it counts up; none where it drives none.
    pub(crate) fn level(&self, channel: usize, now: Time) -> Option<bool> {
        let high = match self.output(channel) {
            Output::Released => return None,
            Output::Idle(level) => return Some(level),
            Output::Pwm { .. } => self.counter(now).0 >= self.compare[channel],
        };
        let bit = channel as u32;
        let inverted = self.ccmr[channel / 2].field(4 + 8 * (bit % 2), 3) == 6;
        Some(high ^ inverted ^ self.ccer.bit(4 * bit + 1))
    }

    /// The clock's period changed.
    pub(crate) fn set_clock(&mut self, clock: Time, now: Time) {
        if clock != self.clock {
            self.phase = self.phase_at(now);
            self.since = now;
            self.clock = clock;
            self.plan();
        }
    }

    pub(crate) fn due(&self) -> Time {
        self.boundary_at.min(self.edge_at)
    }

    /// Passes the boundaries that are due.
    pub(crate) fn advance(&mut self, now: Time) -> Tim1Events {
        let mut events = Tim1Events::default();
        while self.boundary_at <= now {
            let at_top = self.is_centred() && self.phase < u64::from(self.top);
            self.since = self.boundary_at;
            self.phase = if at_top { self.top.into() } else { 0 };
            let due = match self.reading {
                RepetitionReading::AtUpdate => self.repetitions == 0,
                RepetitionReading::BySentence => self.due_by_sentence(at_top),
            };
            if due {
                events.trigger |= self.update(false);
            } else {
                self.repetitions = self.repetitions.saturating_sub(1);
            }
            self.plan();
        }
        if self.edge_at <= now {
            self.rebase(now);
        }
        events
    }

    /// The other reading: an odd value's update is at the underflow if it was written while
    /// the counter ran, at the overflow otherwise.
    fn due_by_sentence(&mut self, at_top: bool) -> bool {
        self.repetitions = self.repetitions.min(self.rcr.value);
        let odd = self.rcr.value % 2 == 1;
        self.repetitions == 0 && (!odd || at_top != self.repetitions_written_running)
    }

    /// An update event; true if it drives the trigger output.
    fn update(&mut self, by_software: bool) -> bool {
        if self.cr1.bit(1) {
            return false;
        }
        self.repetitions = self.rcr.value;
        self.prescaler = self.psc.value;
        self.top = self.arr.value;
        self.compare_before = std::mem::replace(&mut self.compare, self.ccr.map(|ccr| ccr.value));
        if !(by_software && self.cr1.bit(2)) {
            self.sr.set(UIF, true);
        }
        if self.bdtr.bit(14) && !self.is_broken() {
            self.bdtr.set(MOE, true);
        }
        self.cr2.field(4, 3) == 0b010
    }

    fn is_broken(&self) -> bool {
        self.break_active && self.bdtr.bit(12)
    }

    /// The levels of the break sources: the input pin, and the clock security system.
    pub(crate) fn set_break(&mut self, pin: bool, clock_failed: bool) {
        let polarity = self.bdtr.bit(13);
        self.break_active = pin == polarity || clock_failed;
        if self.is_broken() {
            self.bdtr.set(MOE, false);
            self.sr.set(BIF, true);
        }
    }

    pub(crate) fn break_interrupt(&self) -> bool {
        self.sr.bit(BIF) && self.dier.bit(7)
    }

    pub(crate) fn update_interrupt(&self) -> bool {
        self.sr.bit(UIF) && self.dier.bit(0)
    }

    /// What channel 0…3 drives.
    pub(crate) fn output(&self, channel: usize) -> Output {
        let bit = 4 * channel as u32;
        if !self.ccer.bit(bit) {
            return Output::Released;
        }
        if !self.bdtr.bit(MOE) || self.halted {
            let idle = self.cr2.bit(8 + 2 * channel as u32);
            return if self.bdtr.bit(10) {
                Output::Idle(idle)
            } else {
                Output::Released
            };
        }
        let period = self.cycle() as u32;
        let mode = self.ccmr[channel / 2].field(4 + 8 * (channel as u32 % 2), 3);
        let compare = self.compare[channel];
        let below = if !self.runs() {
            if self.counter(0).0 < compare {
                period
            } else {
                0
            }
        } else if self.is_centred() {
            if compare > self.top {
                period
            } else {
                2 * compare
            }
        } else {
            compare.min(period)
        };
        let high = match mode {
            6 => below,
            7 => period - below,
            5 => period,
            _ => 0,
        };
        let high = if self.ccer.bit(bit + 1) {
            period - high
        } else {
            high
        };
        Output::Pwm { high, period }
    }

    /// How long before `until` channel 0…3 switched: the edge of the half period before the last
    /// update, and that of the half period after it. None where the output stays as it is, or if the
    /// edge is not before `until`, which is less than half a period after the update.
    pub(crate) fn ages_of_edges(&self, channel: usize, until: Time) -> [Option<Time>; 2] {
        if !self.runs() || !self.is_centred() || !matches!(self.output(channel), Output::Pwm { .. })
        {
            return [None; 2];
        }
        let since = (until - self.since) / self.count_time();
        // Counted from the boundary: at the bottom the edge is where the counter meets the compare
        // value, at the top where it comes back to it.
        let distance = |compare: u32| match self.phase {
            0 => u64::from(compare),
            _ => u64::from(self.top.saturating_sub(compare)),
        };
        let switches = |compare: u32| (1..self.top).contains(&compare);
        let age = |counts: u64| counts * self.count_time();
        let before = self.compare_before[channel];
        let after = self.compare[channel];
        [
            switches(before).then(|| age(since + distance(before))),
            (switches(after) && distance(after) <= since).then(|| age(since - distance(after))),
        ]
    }
}
