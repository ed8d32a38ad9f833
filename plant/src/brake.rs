//! Holding brakes. They engage when unpowered, so that an arm in gravity does not fall.
//!
//! A brake is an electromagnet against a spring: the current that holds it open takes time to fall and
//! to rise. Until then it does what it did before.

/// A joint slower than this is held at once [rad/s]; a faster one is slowed down first.
const HOLDING_SPEED: f64 = 0.2;

/// The brake of one joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Brake {
    /// Torque that slows the joint down [N·m]; zero without a brake.
    pub(crate) torque: f64,
    /// Time from the command to its torque [s].
    pub(crate) engage_time: f64,
    /// Time from the command to a free joint [s].
    release_time: f64,
    /// Whether it has its torque.
    engaged: bool,
    /// Time for which the command has differed from that [s].
    commanded_for: f64,
    /// Whether it holds the joint.
    pub(crate) holding: bool,
}

impl Brake {
    /// A brake that is engaged.
    pub(crate) fn new(torque: f64, [engage_time, release_time]: [f64; 2]) -> Self {
        Self {
            torque,
            engage_time,
            release_time,
            engaged: true,
            commanded_for: 0.0,
            holding: false,
        }
    }

    /// Takes the command of one tick of `period` [s] with the joint at `omega` [rad/s].
    pub(crate) fn command(&mut self, engage: bool, omega: f64, period: f64) {
        let time = if engage {
            self.engage_time
        } else {
            self.release_time
        };
        if engage == self.engaged {
            self.commanded_for = 0.0;
        } else if self.commanded_for >= time {
            self.engaged = engage;
            self.commanded_for = 0.0;
        } else {
            self.commanded_for += period;
        }
        let fitted = self.torque > 0.0;
        self.holding = fitted && self.engaged && (self.holding || omega.abs() <= HOLDING_SPEED);
    }

    /// It loses its torque, and never has one again.
    pub(crate) fn fail(&mut self) {
        self.torque = 0.0;
    }

    /// Its torque while it slows the joint down [N·m].
    pub(crate) fn slowing(&self, omega: f64) -> f64 {
        if self.engaged && !self.holding {
            -self.torque * omega.signum()
        } else {
            0.0
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Brake;

    /// Ticks of 1 ms until the brake holds, or no longer holds, a joint at rest.
    fn ticks_until(brake: &mut Brake, holds: bool) -> usize {
        (0..1000)
            .take_while(|_| {
                brake.command(holds, 0.0, 1e-3);
                brake.holding != holds
            })
            .count()
    }

    #[test]
    fn a_brake_holds_after_its_engage_time_and_is_free_after_its_release_time() {
        let mut brake = Brake::new(1.0, [0.03, 0.05]);
        assert_eq!(ticks_until(&mut brake, true), 0, "it begins engaged");
        assert!((50..=52).contains(&ticks_until(&mut brake, false)));
        assert!((30..=32).contains(&ticks_until(&mut brake, true)));
    }

    #[test]
    fn a_command_that_is_taken_back_in_time_changes_nothing() {
        let mut brake = Brake::new(1.0, [0.03, 0.05]);
        brake.command(true, 0.0, 1e-3);
        for _ in 0..40 {
            brake.command(false, 0.0, 1e-3);
            assert!(brake.holding);
        }
        brake.command(true, 0.0, 1e-3);
        assert!((50..=52).contains(&ticks_until(&mut brake, false)));
    }
}
