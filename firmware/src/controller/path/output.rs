//! The tool's output along the path.
//!
//! The reference leads the arm by the lag of the current loop, so the output is delayed by as
//! many ticks: it then changes where the move begins. What switches the tool off passes no delay.
//!
//! An output that does not change needs nothing in a tick: only segments that change it wake the
//! delay, which then goes on at the end of the tick, where no fault ends it.

use crate::settings::{ALWAYS, CheckedSettings, Share};
use fivebar_kinematics::trajectory::ToolOutput;

/// The values that the delay holds. A power of two.
const VALUES: usize = 8;

/// The greatest delay [ticks]. A servo and a switch rest for longer where they change.
const LONGEST_DELAY: u32 = VALUES as u32 - 1;

/// The output with its delay.
#[derive(Clone)]
pub(crate) struct PathOutput {
    now: Share,
    off: Share,
    /// The output stays as it is where a path ends.
    stays: bool,
    /// Ticks for which the delay has to go on.
    busy: u32,
    /// The delay holds more than the tool switched off.
    holds: bool,
    /// Ticks from a value to its output.
    delay: u32,
    count: u32,
    values: [Share; VALUES],
    /// The output of the segment that was pushed last.
    pushed: ToolOutput<f32>,
    /// The output of a move with the tool off.
    idle: ToolOutput<f32>,
}

/// The delay [ticks].
fn delay(settings: &CheckedSettings) -> u32 {
    let control = &settings.control;
    let ticks = (control.tick_rate / control.current_bandwidth + 0.5) as u32;
    ticks.min(LONGEST_DELAY)
}

/// The shortest rest [s] that brings the output to its new value before the arm moves on: the
/// delay and some ticks.
pub(crate) fn least_rest(settings: &CheckedSettings) -> f32 {
    (delay(settings) + 4) as f32 / settings.control.tick_rate
}

impl PathOutput {
    pub(crate) fn new(settings: &CheckedSettings) -> Self {
        let off = settings.tool_output.off();
        let idle = settings.tool_output.output(0, 1.0);
        Self {
            now: off,
            off,
            stays: settings.tool_output.waits(),
            busy: 0,
            holds: false,
            delay: delay(settings),
            count: 0,
            values: [off; VALUES],
            pushed: idle,
            idle,
        }
    }

    #[inline(always)]
    pub(super) fn now(&self) -> Share {
        self.now
    }

    pub(super) fn is_off(&self) -> bool {
        self.now == self.off
    }

    /// Whether a segment that is pushed now changes the output.
    pub(super) fn push(&mut self, output: &ToolOutput<f32>) -> bool {
        let changes = *output != self.pushed || output.per_speed != 0.0;
        self.pushed = *output;
        changes
    }

    /// A path begins with a segment of this output.
    pub(super) fn begin(&mut self, output: &ToolOutput<f32>, changes: bool) {
        if changes || *output != self.idle {
            self.wake();
        }
    }

    /// A segment that changes the output begins.
    #[inline(always)]
    pub(super) fn wake(&mut self) {
        self.busy = VALUES as u32 + 1;
        self.holds = true;
    }

    #[inline(always)]
    pub(super) fn is_busy(&self) -> bool {
        self.busy != 0
    }

    /// Takes the output of this tick, at the speed ṡ [m/s or rad/s].
    #[inline(always)]
    pub(super) fn step(&mut self, output: &ToolOutput<f32>, s_dot: f32) {
        if output.per_speed == 0.0 {
            self.busy = self.busy.saturating_sub(1);
        }
        self.count = self.count.wrapping_add(1);
        let [new, old] = [self.count, self.count.wrapping_sub(self.delay)];
        if let Some(slot) = self.values.get_mut(new as usize % VALUES) {
            // As `i32` it saturates in two instructions, as `u16` in nine.
            *slot = (output.at(s_dot) as i32).clamp(0, i32::from(ALWAYS)) as Share;
        }
        if let Some(&value) = self.values.get(old as usize % VALUES) {
            self.now = value;
        }
    }

    /// Switches the tool off at once. The path is dropped before the arm goes on.
    #[inline(always)]
    pub(super) fn switch_off(&mut self) {
        self.now = self.off;
        self.busy = 0;
    }

    /// All segments are dropped: the tool is off.
    pub(super) fn clear(&mut self) {
        self.forget();
        self.pushed = self.idle;
    }

    /// The path has ended. What stays is the value of the last ticks, because the arm has rested
    /// after each change.
    #[inline(always)]
    pub(super) fn end(&mut self) {
        if !self.stays {
            self.forget();
        }
    }

    #[inline(always)]
    fn forget(&mut self) {
        self.switch_off();
        if self.holds {
            self.fill();
        }
    }

    #[cold]
    #[inline(never)]
    fn fill(&mut self) {
        self.values = [self.off; VALUES];
        self.holds = false;
    }
}
