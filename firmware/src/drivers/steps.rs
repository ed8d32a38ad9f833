//! The micro-steps of a tick as pulses of a timer that every tick starts anew.
//!
//! n pulses take periods of P = ⌊T/n⌋ clocks, with T the clocks of a tick. A pulse is low in the first half of its period and
//! high in the second one, so its rising edge, the step, is at (k + ½) P: what the last period leaves of the tick, 6 clocks
//! or less for up to 20 pulses, is the only unevenness. At 20 pulses, high and low last 2.5 µs each.
//!
//! **Direction.** Its pin changes only in a tick in which the timer makes no pulse, and pulses follow in the next one. So the
//! pin is steady for microseconds after a pulse and for tens of them before the next one, whatever the driver asks for.

/// Clocks of a tick of such a timer: 100 µs at 168 MHz.
pub const TICK_CLOCKS: u16 = 16_800;
/// The most micro-steps of an axis in a tick: 200 000 in a second.
pub const MOST_STEPS: i32 = 20;
/// No count of a timer that the tick starts anew.
const NEVER: u16 = u16::MAX;

/// What the timer of an axis is told for a tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pulses {
    /// The count with which a period ends.
    pub top: u16,
    /// The count from which on the pulse is high.
    pub compare: u16,
}

impl Pulses {
    /// No pulse.
    pub const NONE: Self = Self {
        top: NEVER,
        compare: NEVER,
    };

    /// So many pulses, [`MOST_STEPS`] at most.
    #[inline]
    pub fn of(steps: u32) -> Self {
        match u32::from(TICK_CLOCKS).checked_div(steps) {
            None => Self::NONE,
            Some(period) => Self {
                top: period as u16 - 1,
                compare: period as u16 / 2,
            },
        }
    }
}

/// The micro-steps of one axis: those made, and those that the timer makes and will make.
#[derive(Clone, Debug, Default)]
pub struct StepAxis {
    /// With the tick that has begun; they wrap.
    made: i32,
    /// In the tick that has begun.
    now: i32,
    /// Prepared for the next one.
    next: i32,
    /// The level of the direction pin.
    forwards: bool,
}

impl StepAxis {
    /// A tick has begun, `missed` ticks after the last one that was told. Where the timer has `taken` what was prepared, it
    /// makes that; otherwise, what it made before. Returns the micro-steps made at the end of the tick.
    #[inline]
    pub fn begin(&mut self, taken: bool, missed: u32) -> i32 {
        if taken {
            self.now = self.next;
        }
        let ticks = missed.wrapping_add(1).cast_signed();
        self.made = self.made.wrapping_add(self.now.wrapping_mul(ticks));
        self.made
    }

    /// The same where what was prepared is made in one tick, and nothing in a tick that finds nothing prepared.
    #[inline]
    pub fn begin_once(&mut self, taken: bool) -> i32 {
        self.now = if taken { self.next } else { 0 };
        self.made = self.made.wrapping_add(self.now);
        self.made
    }

    /// Prepares these micro-steps for the next tick, or none if the direction cannot change before. Returns how many pulses
    /// that makes, [`MOST_STEPS`] at most.
    #[inline]
    pub fn prepare(&mut self, steps: i32) -> u32 {
        let steps = steps.clamp(-MOST_STEPS, MOST_STEPS);
        let turns = steps != 0 && (steps > 0) != self.forwards;
        self.next = if turns && self.now != 0 { 0 } else { steps };
        if turns && self.now == 0 {
            self.forwards = !self.forwards;
        }
        self.next.unsigned_abs()
    }

    /// The level of the direction pin from now on.
    #[inline]
    pub fn forwards(&self) -> bool {
        self.forwards
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use heapless::Vec;

    /// The rising edges of a timer in one tick [clocks], counted clock by clock.
    fn edges(pulses: Pulses) -> Vec<u32, 32> {
        let mut edges = Vec::new();
        let (mut count, mut high) = (0, false);
        for clock in 0..u32::from(TICK_CLOCKS) {
            let is_high = count >= u32::from(pulses.compare);
            if is_high && !high {
                edges.push(clock).expect("at most 32 pulses");
            }
            high = is_high;
            count = if count == u32::from(pulses.top) {
                0
            } else {
                count + 1
            };
        }
        edges
    }

    #[test]
    fn a_tick_has_its_steps_evenly_to_100_nanoseconds_and_pulses_of_2_4_microseconds() {
        for steps in 0..=MOST_STEPS.unsigned_abs() {
            let pulses = Pulses::of(steps);
            let edges = edges(pulses);
            assert_eq!(edges.len(), steps as usize);
            for (k, &edge) in (0_u32..).zip(&edges) {
                let even = (f64::from(k) + 0.5) * f64::from(TICK_CLOCKS) / f64::from(steps);
                let off = (f64::from(edge) - even).abs() / 168e6;
                assert!(off < 40e-9, "{steps} steps, edge {k}: {off:e} s");
            }
            if steps > 0 {
                let (low, period) = (pulses.compare, pulses.top + 1);
                assert!(low.min(period - low) >= 420, "{steps} steps: {pulses:?}");
            }
        }
    }

    #[test]
    fn the_direction_changes_in_a_tick_without_pulses_and_every_step_is_counted() {
        let mut axis = StepAxis::default();
        let mut position = 0;
        let mut sent = (Pulses::NONE, axis.forwards());
        for tick in 0..4000_i32 {
            // The timer makes what was prepared, in the direction that the pin has.
            let (pulses, direction) = sent;
            let made = edges(pulses).len() as i32;
            position += if direction { made } else { -made };
            assert_eq!(axis.begin(true, 0), position, "tick {tick}");
            // It turns slowly, and from one tick to the next.
            let time = f64::from(tick);
            let wanted = (time * 0.05).sin() * 200.0 + (time * 2.9).sin() * 15.0;
            let pulses = Pulses::of(axis.prepare(wanted as i32 - position));
            assert!(made == 0 || axis.forwards() == direction, "tick {tick}");
            sent = (pulses, axis.forwards());
        }
    }

    #[test]
    fn what_the_timer_has_not_taken_is_not_counted_and_what_it_repeats_is() {
        let mut axis = StepAxis::default();
        axis.prepare(3);
        assert_eq!(axis.begin(true, 0), 3);
        axis.prepare(5);
        assert_eq!(axis.begin(false, 0), 6);
        assert_eq!(axis.begin(true, 1), 16);
    }

    #[test]
    fn what_is_made_once_is_counted_in_the_tick_that_makes_it() {
        let mut axis = StepAxis::default();
        axis.prepare(3);
        // A tick too late, and made in the next one; none is made after it.
        assert_eq!(axis.begin_once(false), 0);
        assert_eq!(axis.begin_once(true), 3);
        assert_eq!(axis.prepare(0), 0);
        assert_eq!(axis.begin_once(true), 3);
        axis.prepare(5);
        assert_eq!(axis.begin_once(true), 8);
        // It turns only behind a tick without pulses.
        assert_eq!((axis.prepare(-2), axis.forwards()), (0, true));
    }
}
