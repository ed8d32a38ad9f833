//! The account of the energy that rendered springs give away, and the damping that gets it back.
//!
//! A spring that is rendered late gives a hand a little more than the hand has put in: over a tick (τ − τs)·Δθ, where τ is the torque
//! that acts and τs is that of the same spring without lags. The level E goes down by that, rises by what dampers take, and is 0
//! at most, so that nothing is kept for later. Below 0 the arm is damped, more and more up to all of it at −[`DEPTH`]. What the
//! host gives, by moving the spring's end or by a force, is not on this account.
//!
//! τ follows from the demanded torques u as the current loop makes it: τ[k+1] = τ[k] + g (u[k−1] − τ[k−1]). τs is the mean of
//! those at both ends of the tick, which is exact for a spring that is linear there.

use crate::Scalar;

/// The energy at which the arm is damped most [J].
const DEPTH: f64 = 5e-3;

/// The account's constants.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EnergyTank<S> {
    gain: S,
    per_depth: S,
}

/// An account. Pairs are of joint 1 and joint 4.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TankState<S> {
    /// E [J].
    level: S,
    /// At the last tick [rad].
    angles: [S; 2],
    /// τs at the last tick [N·m].
    spring: [S; 2],
    /// τ since the last tick and in the tick before [N·m].
    acting: [[S; 2]; 2],
    /// u of the last tick and of the tick before [N·m].
    demanded: [[S; 2]; 2],
}

impl<S: Scalar> TankState<S> {
    /// Full, where nothing acts.
    pub fn at_rest(angles: [S; 2]) -> Self {
        Self {
            level: S::ZERO,
            angles,
            spring: [S::ZERO; 2],
            acting: [[S::ZERO; 2]; 2],
            demanded: [[S::ZERO; 2]; 2],
        }
    }

    /// E [J], at most 0.
    pub fn level(&self) -> S {
        self.level
    }

    /// Takes energy [J] that a spring was given.
    #[inline(always)]
    pub fn charge(&mut self, energy: S) {
        self.level -= energy;
    }
}

impl<S: Scalar> EnergyTank<S> {
    /// Of torques with this gain of their current loop in a tick.
    pub fn new(gain: S) -> Self {
        Self {
            gain,
            per_depth: S::from_f64(1.0 / DEPTH),
        }
    }

    /// One that never damps: what its absence does is a test.
    #[doc(hidden)]
    pub fn absent() -> Self {
        Self {
            gain: S::ZERO,
            per_depth: S::ZERO,
        }
    }

    /// One tick: the joints are at these angles [rad], where the springs without lags give these torques [N·m]. Gives the share of
    /// the damping that is due.
    #[inline(always)]
    pub fn settle(&self, state: &mut TankState<S>, angles: [S; 2], spring: [S; 2]) -> S {
        let [acting1, acting4] = state.acting[0];
        let [spring1, spring4] = spring;
        let [last1, last4] = state.spring;
        let ideal = [S::HALF * (last1 + spring1), S::HALF * (last4 + spring4)];
        let given = (acting1 - ideal[0]) * (angles[0] - state.angles[0])
            + (acting4 - ideal[1]) * (angles[1] - state.angles[1]);
        let level = state.level - given;
        // Also where it is not a number.
        state.level = if level < S::ZERO { level } else { S::ZERO };
        let [before1, before4] = state.acting[1];
        let [demanded1, demanded4] = state.demanded[1];
        state.acting = [
            [
                acting1 + self.gain * (demanded1 - before1),
                acting4 + self.gain * (demanded4 - before4),
            ],
            [acting1, acting4],
        ];
        (state.angles, state.spring) = (angles, spring);
        let share = -state.level * self.per_depth;
        if share < S::ONE { share } else { S::ONE }
    }

    /// The torques that springs and dampers shall give from this tick on [N·m].
    #[inline(always)]
    pub fn demand(&self, state: &mut TankState<S>, torque: [S; 2]) {
        state.demanded = [torque, state.demanded[0]];
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const T: f64 = 1e-4;

    /// A joint of 2e-3 kg·m² without friction on a spring of `k` that acts late, and with the tank's damping. Gives the greatest
    /// energy over that at the beginning [J], and the least level.
    fn swings(tank: &EnergyTank<f64>, k: f64, gain: f64, speed: f64) -> [f64; 2] {
        let (inertia, most) = (2e-3, 0.3);
        let (mut theta, mut omega) = (0.0, speed);
        let mut state = TankState::at_rest([0.0; 2]);
        let (mut now, mut before) = (0.0, 0.0);
        let mut told = 0.0;
        let begun = 0.5 * inertia * speed * speed;
        let [mut gained, mut least] = [0.0_f64; 2];
        for _ in 0..20_000 {
            let share = tank.settle(&mut state, [theta, 0.0], [-k * theta, 0.0]);
            let torque = -k * theta - share * most * omega;
            tank.demand(&mut state, [torque, 0.0]);
            let acting = now;
            (now, before) = (now + gain * (told - before), now);
            told = torque;
            omega += T / inertia * acting;
            theta += T * omega;
            gained = gained.max(0.5 * inertia * omega * omega + 0.5 * k * theta * theta - begun);
            least = least.min(state.level());
        }
        [gained, least]
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        /// With the tank a late spring never has more than its depth over what it was given; without, it has.
        #[test]
        fn a_late_spring_gives_no_more_than_the_tanks_depth(
            k in 0.5..8.0_f64, gain in 0.2..0.4_f64, speed in 1.0..5.0_f64,
        ) {
            let [gained, level] = swings(&EnergyTank::new(gain), k, gain, speed);
            prop_assert!(gained < DEPTH && level > -DEPTH, "{gained} {level}");
            let [without, _] = swings(&EnergyTank::absent(), k, gain, speed);
            prop_assert!(without > 5.0 * gained, "{without} {gained}");
        }
    }

    #[test]
    fn the_account_is_the_energy_that_a_late_spring_gives() {
        // Moved to and fro by a hand, the torque one tick and a lag of 1/g late: π k τ a² a turn, τ = T (1/g + 1/2).
        let (k, gain, omega, size) = (3.0, 0.3, 40.0_f64, 0.1);
        let tank = EnergyTank {
            per_depth: 0.0,
            ..EnergyTank::new(gain)
        };
        let mut state = TankState::at_rest([size, 0.0]);
        let ticks = (core::f64::consts::TAU / (omega * T)).round() as u32;
        let mut first = 0.0;
        for tick in 0..3 * ticks {
            if tick == 2 * ticks {
                first = state.level();
            }
            let theta = size * (omega * T * f64::from(tick)).cos();
            tank.settle(&mut state, [theta, 0.0], [-k * theta, 0.0]);
            tank.demand(&mut state, [-k * theta, 0.0]);
        }
        let wanted = core::f64::consts::PI * k * (omega * T * (1.0 / gain + 0.5)) * size * size;
        let given = first - state.level();
        assert!((given / wanted - 1.0).abs() < 0.01, "{given} {wanted}");
    }

    #[test]
    fn what_dampers_take_is_not_kept_for_later() {
        let tank = EnergyTank::new(0.35);
        let mut state = TankState::at_rest([0.0; 2]);
        for tick in 1..100 {
            let theta = 1e-3 * f64::from(tick);
            assert_eq!(tank.settle(&mut state, [theta, 0.0], [0.0; 2]), 0.0);
            tank.demand(&mut state, [-0.1, 0.0]);
        }
        assert_eq!(state.level(), 0.0);
        state.charge(1e-3);
        assert!((state.level() + 1e-3).abs() < 1e-12);
    }
}
