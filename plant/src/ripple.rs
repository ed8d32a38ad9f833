//! Cogging and the ripple of the torque constant.
//!
//! k(θm) = k (1 + r sin(N n θm))
//! τc = C sin(N n θm), from the energy U = C/(N n) cos(N n θm)
//!
//! n θm is the angle of the motor's shaft and N = 10: a brushed motor of two poles and five slots
//! has lcm(2, 5) = 10 positions of least reluctance in a turn (Hanselman, Brushless Permanent
//! Magnet Motor Design, 2003), and its five segments under two brushes commutate 10 times. The
//! back-EMF constant has the same ripple as the torque constant, so that no power appears.

use crate::motor::Motor;

/// Periods of cogging and torque ripple in a turn of the motor, N.
pub const PERIODS_PER_TURN: f64 = 10.0;

/// Cogging and torque ripple of one motor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Ripple {
    /// r.
    share: f64,
    /// C at the joint [N·m].
    cogging: f64,
    /// N n, periods per turn of the joint; its sign is the gear ratio's.
    periods: f64,
}

impl Ripple {
    /// None without either.
    pub(crate) fn new(motor: &Motor, share: f64, cogging: f64) -> Option<Self> {
        (share != 0.0 || cogging != 0.0).then_some(Self {
            share,
            cogging,
            periods: PERIODS_PER_TURN * motor.gear_ratio,
        })
    }

    /// k(θm)/k, and the cogging torque at the joint [N·m].
    #[inline]
    pub(crate) fn at(&self, angle: f64) -> (f64, f64) {
        let sine = libm::sin(self.periods * angle);
        (1.0 + self.share * sine, self.cogging * sine)
    }

    /// U [J].
    pub(crate) fn energy(&self, angle: f64) -> f64 {
        self.cogging / self.periods * libm::cos(self.periods * angle)
    }

    /// Natural frequency of a rotor of `inertia` in its positions of rest [rad/s].
    pub(crate) fn resonance(&self, inertia: f64) -> f64 {
        (self.cogging * self.periods.abs() / inertia).sqrt()
    }

    /// Rate of its phase at the motor's speed over the gear ratio [1/s].
    pub(crate) fn rate(&self, omega: f64) -> f64 {
        (self.periods * omega).abs()
    }
}
