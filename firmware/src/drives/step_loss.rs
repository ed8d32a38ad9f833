//! Whether a stepper with an encoder follows its micro-steps.
//!
//! d = n − n₀ − (m − m₀), with the counts n in micro-steps and the micro-steps m that are made: how far the rotor is ahead
//! of its field. A load moves it by less than a full step, and brings a rotor to rest that is less than two away. At two
//! full steps it slips by four; a driver that misses pulses leaves it behind by as many. So a difference of 1 ½ full steps
//! is a fault.
//!
//! When its current comes, or a brake lets it go, a rotor jumps to its field, by two full steps at most, and swings about
//! it. So until the swing is small and the set-point moves, n₀ − m₀ is a mean over the swing, and nothing is judged.
//! Then the motor is led slowly to where its counts should be. Nothing of the swing is fed back: a loop around a rotor that
//! hardly damps its swings excites them.
//!
//! Where the set-point rests, n₀ − m₀ is such a mean, too. So steps that a driver has missed, if too few for a fault, are
//! made good at the next rest.

use super::resolution::Fineness;
use crate::safety::Fault;
use fivebar_kinematics::Scalar;

/// The difference that is a fault [full steps].
const MOST: f32 = 1.5;
/// The time constant of the mean [s]: some periods of a rotor's swing.
const MEAN: f32 = 0.04;
/// The difference of a rotor that hardly swings [full steps], and the time for which it stays within it [s]. The set-point
/// rests when it has not moved for as long.
const CALM: (f32, f32) = (0.5, 0.02);
/// How fast a motor is led to where its counts should be [full steps/s].
const LEADS: f32 = 10.0;

/// One joint's motor and encoder.
#[derive(Clone)]
pub(super) struct StepLoss {
    /// Counts in a turn of the motor.
    counts_per_turn: f32,
    /// The mean's gain in a tick.
    gain: f32,
    /// Ticks of [`CALM`].
    calms: u32,
    /// [`LEADS`] in a tick [full steps].
    leads: f32,
    /// Whether the set-point has moved since the current came.
    has_moved: bool,
    /// Ticks since it moved.
    rests: u32,
    /// Ticks until the rotor is calm.
    until_calm: u32,
    /// Counts and micro-steps in the first tick with current.
    start: Option<[i32; 2]>,
    /// n₀ − m₀, beside those of the start [micro-steps].
    offset: f32,
    /// As much of it as the motor has been led by [micro-steps].
    led: f32,
    /// n − m, beside those of the start [micro-steps].
    difference: f32,
}

impl StepLoss {
    pub(super) fn new(counts_per_turn: u32, tick_rate: f32) -> Self {
        Self {
            counts_per_turn: counts_per_turn as f32,
            gain: (1.0 / (MEAN * tick_rate)).min(1.0),
            // `as` cuts.
            calms: (CALM.1 * tick_rate) as u32,
            has_moved: false,
            rests: 0,
            until_calm: u32::MAX,
            start: None,
            leads: LEADS / tick_rate,
            offset: 0.0,
            led: 0.0,
            difference: 0.0,
        }
    }

    /// The motor has no current: the next tick that has it is the start.
    pub(super) fn rest(&mut self) {
        (self.start, self.has_moved, self.until_calm) = (None, false, u32::MAX);
        (self.offset, self.led, self.difference) = (0.0, 0.0, 0.0);
    }

    /// The set-point moves.
    #[inline(always)]
    pub(super) fn moves(&mut self) {
        (self.has_moved, self.rests) = (true, 0);
    }

    /// By how much the counts are ahead of where the motor is told to be [micro-steps].
    #[inline(always)]
    pub(super) fn ahead(&self) -> f32 {
        self.difference - self.led
    }

    /// One tick with current: the fault that counts and micro-steps show together.
    #[inline(always)]
    pub(super) fn fault(&mut self, counts: i32, steps: i32, fineness: &Fineness) -> Option<Fault> {
        let [start_counts, start_steps] = *self.start.get_or_insert([counts, steps]);
        let per_count = fineness.per_turn / self.counts_per_turn;
        let counted = per_count * counts.wrapping_sub(start_counts) as f32;
        self.difference = counted - steps.wrapping_sub(start_steps) as f32;
        let ahead = self.difference - self.offset;
        let full_step = fineness.per_full_step;
        self.rests = self.rests.saturating_add(1);
        if !self.has_moved || self.until_calm > 0 || self.rests > self.calms {
            self.offset += self.gain * ahead;
        }
        if self.until_calm > 0 {
            let (most, _) = CALM;
            let is_calm = Scalar::abs(ahead) < most * full_step;
            self.until_calm = if is_calm {
                self.until_calm.min(self.calms) - 1
            } else {
                u32::MAX
            };
            return None;
        }
        let leads = self.leads * full_step;
        // `clamp` could panic.
        self.led += (self.offset - self.led).max(-leads).min(leads);
        let most = MOST * full_step;
        // Also if it is not a number.
        let follows = ahead >= -most && ahead <= most;
        (!follows).then_some(Fault::StepsLost)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drives::Resolution;

    fn nema17() -> Fineness {
        let resolution = Resolution {
            full_steps: 200,
            microsteps: 16,
        };
        Fineness::new(resolution, 0.0)
    }

    /// 4000 counts a turn, 20 a full step, and their check at 10 kHz, settled at these counts and micro-steps.
    fn settled(counts: i32, steps: i32) -> StepLoss {
        let mut slip = StepLoss::new(4000, 1e4);
        for _ in 0..2000 {
            assert_eq!(slip.fault(counts, steps, &nema17()), None);
        }
        slip.moves();
        slip
    }

    #[test]
    fn a_rotor_more_than_a_step_and_a_half_from_its_field_has_lost_steps() {
        for (start, sign) in [(0, 1), (i32::MAX, 1), (i32::MIN, -1), (77, -1)] {
            let mut slip = settled(start, 5);
            // 30 counts and 24 micro-steps are 1 ½ full steps.
            for (counts, steps, lost) in [
                (30, 0, false),
                (31, 0, true),
                (0, -24, false),
                (0, -25, true),
                (4000, 3200, false),
                (4000, 3175, true),
            ] {
                let counts = start.wrapping_add(sign * counts);
                let fault = slip.fault(counts, 5 + sign * steps, &nema17());
                assert_eq!(fault, lost.then_some(Fault::StepsLost), "{counts} {steps}");
            }
        }
    }

    #[test]
    fn a_rotor_that_jumps_to_its_field_when_the_current_comes_has_lost_none() {
        let mut slip = settled(0, 0);
        slip.rest();
        // It rested 36 counts ahead of its field, goes there and swings about it.
        for tick in 0..2000_u16 {
            let phase = f32::from(tick) * 0.05;
            let counts = 36.0 * phase.cos() * (1.0 - f32::from(tick) / 2000.0);
            assert_eq!(slip.fault(136 + counts as i32, 7, &nema17()), None);
        }
        slip.moves();
        // The field is 36 counts, 28.8 micro-steps, behind the start: the motor is led there.
        assert_eq!(slip.fault(136, 7, &nema17()), None);
        for _ in 0..2000 {
            assert_eq!(slip.fault(136, 7, &nema17()), None);
        }
        assert!(slip.ahead().abs() < 0.5, "{}", slip.ahead());
        assert_eq!(slip.fault(136 + 28, 7, &nema17()), None);
        assert_eq!(slip.fault(136 + 33, 7, &nema17()), Some(Fault::StepsLost));
    }

    #[test]
    fn a_motor_that_was_led_makes_no_step_when_its_current_comes_again() {
        let mut slip = settled(0, 0);
        slip.rest();
        assert_eq!(slip.fault(0, 0, &nema17()), None);
        // It jumps by 36 counts, 28.8 micro-steps, and is led there.
        for _ in 0..20_000 {
            assert_eq!(slip.fault(36, 0, &nema17()), None);
        }
        assert!(slip.ahead().abs() < 0.5, "{}", slip.ahead());
        slip.rest();
        for _ in 0..3 {
            assert_eq!(slip.ahead(), 0.0);
            assert_eq!(slip.fault(36, 0, &nema17()), None);
        }
    }
}
