//! Cogging and the ripple of the torque constant.
//!
//! k(θm) = k (1 + r sin(Nr n θm))
//! τc = C sin(Nc n θm), from the energy U = C/(Nc n) cos(Nc n θm)
//!
//! n θm is the angle of the motor's shaft. A brushed motor of two poles and five slots has Nc = lcm(2, 5) = 10 positions of
//! least reluctance in a turn (Hanselman, Brushless Permanent Magnet Motor Design, 2003), and its five segments under two
//! brushes commutate Nr = 10 times. The back-EMF constant has the same ripple as the torque constant, so that no power
//! appears.
//!
//! A common outrunner has 12 slots and 14 poles. If all magnets were alike, its cogging would have lcm(12, 14) = 84 periods
//! and be small. Magnets that differ leave a period a slot, Nc = 12 (Gašparin, Černigoj, Markič, Fišer, Additional cogging
//! torque components in permanent-magnet motors due to manufacturing imperfections, IEEE Trans. Magn. 45, 2009). The fifth
//! and seventh harmonics of its back-EMF ripple the torque of sinusoidal currents six times in each of its seven electrical
//! turns, Nr = 42 (Hanselman).

use crate::motor::Motor;

/// Periods in a turn of the motor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RipplePeriods {
    /// Nc, of the cogging.
    pub cogging: f64,
    /// Nr, of the torque constant.
    pub torque: f64,
}

impl RipplePeriods {
    /// Of a brushed motor.
    pub const BRUSHED: Self = Self {
        cogging: 10.0,
        torque: 10.0,
    };
    /// Of the motor of a drive on a bus.
    pub const OUTRUNNER: Self = Self {
        cogging: 12.0,
        torque: 42.0,
    };
}

/// Cogging and torque ripple of one motor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Ripple {
    /// r.
    share: f64,
    /// C at the joint [N·m].
    cogging: f64,
    /// Nc n and Nr n, periods per turn of the joint; their sign is the gear ratio's.
    periods: RipplePeriods,
}

impl Ripple {
    /// None without either.
    pub(crate) fn new(
        motor: &Motor,
        share: f64,
        cogging: f64,
        per_turn: RipplePeriods,
    ) -> Option<Self> {
        (share != 0.0 || cogging != 0.0).then_some(Self {
            share,
            cogging,
            periods: RipplePeriods {
                cogging: per_turn.cogging * motor.gear_ratio,
                torque: per_turn.torque * motor.gear_ratio,
            },
        })
    }

    /// k(θm)/k, and the cogging torque at the joint [N·m].
    #[inline]
    pub(crate) fn at(&self, angle: f64) -> (f64, f64) {
        let [torque, cogging] =
            [self.periods.torque, self.periods.cogging].map(|periods| libm::sin(periods * angle));
        (1.0 + self.share * torque, self.cogging * cogging)
    }

    /// U [J].
    pub(crate) fn energy(&self, angle: f64) -> f64 {
        let periods = self.periods.cogging;
        self.cogging / periods * libm::cos(periods * angle)
    }

    /// Natural frequency of a rotor of `inertia` in its positions of rest [rad/s].
    pub(crate) fn resonance(&self, inertia: f64) -> f64 {
        (self.cogging * self.periods.cogging.abs() / inertia).sqrt()
    }

    /// Rate of its faster phase at the motor's speed over the gear ratio [1/s].
    pub(crate) fn rate(&self, omega: f64) -> f64 {
        let RipplePeriods { cogging, torque } = self.periods;
        (cogging.abs().max(torque.abs()) * omega).abs()
    }
}
