//! The tool's output along the path.
//!
//! The reference leads the arm by the lag of the current loop, so the output is delayed by as
//! many ticks: it then changes where the move begins. What switches the tool off passes no delay.

use crate::settings::{CheckedSettings, Share};

/// The values that the delay holds. A power of two.
const VALUES: usize = 16;

/// The greatest delay [ticks]. A servo and a switch rest for longer where they change.
const LONGEST_DELAY: u32 = VALUES as u32 - 1;

/// The output with its delay.
pub(crate) struct PathOutput {
    now: Share,
    off: Share,
    /// The output stays as it is where a path ends.
    stays: bool,
    /// [ticks].
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
            delay: delay(settings),
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

    /// Takes this tick's value.
    #[inline(always)]
    pub(super) fn step(&mut self, value: Share) {
        self.count = self.count.wrapping_add(1);
        let [new, old] = [self.count, self.count.wrapping_sub(self.delay)];
        if let Some(slot) = self.values.get_mut(new as usize % VALUES) {
            *slot = value;
        }
        if let Some(&value) = self.values.get(old as usize % VALUES) {
            self.now = value;
        }
    }

    /// Switches the tool off at once. It stays off until a path is followed.
    pub(super) fn switch_off(&mut self) {
        self.now = self.off;
        self.values = [self.off; VALUES];
    }

    /// The path has ended. What stays is the value of the last ticks, because the arm has rested
    /// after each change.
    pub(super) fn end(&mut self) {
        if !self.stays {
            self.switch_off();
        }
        self.values = [self.now; VALUES];
    }
}
