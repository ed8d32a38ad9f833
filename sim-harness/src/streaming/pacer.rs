//! The ticks in which points are due.

use fivebar_firmware::motion::StreamConfig;

/// The share of a period by which points are moved while the program is slower than the stream's rate. Clocks differ by a
/// fiftieth of that.
const SLIP: f64 = 0.005;

/// The ticks in which points are due: one period after the other. A program whose clock is slow would use the delay up in
/// minutes, so its points are moved a little.
#[derive(Clone, Debug)]
pub(super) struct Pacer {
    /// The tick in which the next point is due.
    due: u32,
    /// How much later the motion is there [ticks].
    fraction: f64,
    period: u16,
    delay: u16,
}

impl Pacer {
    /// The first point may be made in this tick.
    pub(super) fn new(config: &StreamConfig, tick: u32) -> Self {
        Self {
            due: tick.wrapping_add(config.delay.into()),
            fraction: 0.0,
            period: config.period,
            delay: config.delay,
        }
    }

    /// Whether a point that is made in this tick is due no more than the delay later.
    pub(super) fn is_due(&self, tick: u32) -> bool {
        self.ahead(tick) <= i32::from(self.delay)
    }

    fn ahead(&self, tick: u32) -> i32 {
        self.due.wrapping_sub(tick) as i32
    }

    /// The tick in which the next point is due that is made in this one, and how much later that is than the motion
    /// [ticks].
    pub(super) fn next(&mut self, tick: u32) -> (u32, f64) {
        if self.ahead(tick) < i32::from(self.delay) - i32::from(self.period) {
            self.fraction += SLIP * f64::from(self.period);
        }
        let whole = self.fraction.round();
        self.fraction -= whole;
        let due = self.due.wrapping_add(whole as u32);
        self.due = due.wrapping_add(self.period.into());
        (due, -self.fraction)
    }
}
