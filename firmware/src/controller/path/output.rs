//! The tool's output along the path.
//!
//! The reference leads the arm by the lag of the current loop, so the output is delayed by as
//! many ticks: it then changes where the move begins. What switches the tool off passes no delay.

use crate::settings::{CheckedSettings, Share};

/// The values that the delay holds. A power of two.
const VALUES: usize = 8;

/// The greatest delay [ticks]. A servo and a switch rest for longer where they change.
const LONGEST_DELAY: u32 = VALUES as u32;

/// The output with its delay. The value of a tick is taken in the next one: so the tick of a stop
/// computes the way of the stop, or this delay, and never both.
pub(crate) struct PathOutput {
    now: Share,
    off: Share,
    /// The output stays as it is where a path ends.
    stays: bool,
    /// The value of the last tick.
    latest: f32,
    /// Ticks from taking a value to its output.
    delay: u32,
    count: u32,
    values: [Share; VALUES],
}

/// The delay [ticks].
fn delay(settings: &CheckedSettings) -> u32 {
    let control = &settings.control;
    let ticks = (control.tick_rate / control.current_bandwidth + 0.5) as u32;
    ticks.min(LONGEST_DELAY)
}

/// The shortest rest [s] that brings the output to its new value before the arm moves on: the
/// delay and two ticks.
pub(crate) fn least_rest(settings: &CheckedSettings) -> f32 {
    (delay(settings) + 2) as f32 / settings.control.tick_rate
}

impl PathOutput {
    pub(crate) fn new(settings: &CheckedSettings) -> Self {
        let off = settings.tool_output.off();
        Self {
            now: off,
            off,
            stays: settings.tool_output.waits(),
            latest: f32::from(off),
            delay: delay(settings).saturating_sub(1),
            count: 0,
            values: [off; VALUES],
        }
    }

    #[inline(always)]
    pub(super) fn now(&self) -> Share {
        self.now
    }

    pub(super) fn is_off(&self) -> bool {
        self.now == self.off
    }

    /// Sets this tick's value: cut to a whole number, a share.
    #[inline(always)]
    pub(super) fn set(&mut self, value: f32) {
        self.latest = value;
    }

    /// Takes the last tick's value.
    #[inline(always)]
    pub(super) fn step(&mut self) {
        self.count = self.count.wrapping_add(1);
        let [new, old] = [self.count, self.count.wrapping_sub(self.delay)];
        if let Some(slot) = self.values.get_mut(new as usize % VALUES) {
            // `as` saturates.
            *slot = self.latest as Share;
        }
        if let Some(&value) = self.values.get(old as usize % VALUES) {
            self.now = value;
        }
    }

    /// Switches the tool off at once. The path is dropped before the arm goes on.
    #[inline(always)]
    pub(super) fn switch_off(&mut self) {
        self.now = self.off;
    }

    /// The path is dropped: the tool is off.
    pub(super) fn clear(&mut self) {
        self.now = self.off;
        self.fill();
    }

    /// The path has ended. What stays is the value of the last ticks, because the arm has rested
    /// after each change.
    pub(super) fn end(&mut self) {
        if !self.stays {
            self.now = self.off;
        }
        self.fill();
    }

    fn fill(&mut self) {
        self.latest = f32::from(self.now);
        self.values = [self.now; VALUES];
    }
}
