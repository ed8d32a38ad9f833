//! How long a motor may carry about twice its continuous current.
//!
//! The I²t model lets a motor with a long time constant do so for many seconds: it stands that, but an arm that is
//! caught does not, nor who is caught in it. Once in `WATCHED_EVERY` ticks, the mean of the squared current is
//! compared with its limit:
//!
//! m ← m + (i² − m) T/0.3 s, a fault after 1.1 s in a row above (1.9 ic)²,
//!
//! T being their time and ic the continuous current. A constant 2 ic takes 0.3 s · ln(4/(4 − 1.9²)) = 0.7 s
//! to that limit, so it lasts 1.8 s. More current reaches the limit sooner, and less than 1.9 ic never does.

use crate::settings::AxisSettings;

/// Time constant of the mean [s].
const MEAN: f32 = 0.3;
/// The current that is an overload, per continuous current.
const OVERLOAD: f32 = 1.9;
/// Longest time for which it may flow in a row [s].
const LONGEST: f32 = 1.1;

/// The limits of one joint's motor.
#[derive(Clone)]
pub(super) struct OverloadLimits {
    /// Weight of a new square.
    weight: f32,
    /// Greatest mean square [A²].
    greatest: f32,
    /// Looks that it may last.
    looks: f32,
}

impl OverloadLimits {
    /// For a motor whose current is seen once in `period` [s].
    pub(super) fn new(axis: &AxisSettings, period: f32) -> Self {
        let current = OVERLOAD * axis.continuous_current;
        Self {
            weight: period / MEAN,
            greatest: current * current,
            looks: LONGEST / period,
        }
    }
}

/// A motor's overload.
#[derive(Clone)]
pub(super) struct Overload {
    /// m [A²].
    mean: f32,
    /// Looks for which it has lasted.
    looks: f32,
}

impl Overload {
    pub(super) const NONE: Self = Self {
        mean: 0.0,
        looks: 0.0,
    };

    /// Once in `WATCHED_EVERY` ticks: whether the motor has carried too much for too long, at this `current` [A].
    #[inline(always)]
    pub(super) fn lasts(&mut self, limits: &OverloadLimits, current: f32) -> bool {
        self.mean += (current * current - self.mean) * limits.weight;
        if self.mean > limits.greatest {
            self.looks += 1.0;
        } else {
            self.looks = 0.0;
        }
        self.looks > limits.looks
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::settings::Settings;

    /// Once in 16 ticks [s].
    const PERIOD: f32 = 1.6e-3;

    /// How long a motor of 1.3 A may carry this current [A] over time [s]; none: for a minute.
    fn longest(current: impl Fn(f32) -> f32) -> Option<f32> {
        let limits = OverloadLimits::new(&Settings::BENCHTOP.axes[0], PERIOD);
        let mut overload = Overload::NONE;
        let times = (0..40_000_u16).map(|look| f32::from(look) * PERIOD);
        let mut times = times.skip_while(|&t| !overload.lasts(&limits, current(t)));
        times.next()
    }

    #[test]
    fn twice_the_continuous_current_lasts_for_1_8_s() {
        for current in [2.6, -2.6] {
            let lasts = longest(|_| current).unwrap();
            assert!((lasts - 1.8).abs() < 0.02, "{lasts} s");
        }
        assert!(longest(|_| 4.0).unwrap() < 1.3);
    }

    /// Its mean square is that of twice the continuous current.
    #[test]
    fn a_current_that_alternates_counts_as_much() {
        let lasts = longest(|t| if t % 0.04 < 0.02 { 3.68 } else { 0.0 }).unwrap();
        assert!((1.6..2.0).contains(&lasts), "{lasts} s");
    }

    #[test]
    fn less_and_what_rests_between_last_for_ever() {
        assert_eq!(longest(|_| 2.45), None);
        assert_eq!(longest(|t| if t % 3.0 < 1.6 { 2.6 } else { 0.0 }), None);
    }
}
