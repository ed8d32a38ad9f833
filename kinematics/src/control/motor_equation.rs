//! Whether a motor's current, voltage and speed belong together.
//!
//! L i̇ = v − R i − Ke ω holds for every motor. For a voltage held over a tick T, without looking at
//! the measured current,
//!
//! î[k+1] = a î[k] + (1 − a)/R (v[k] − Ke ω[k]), a = e^(−RT/L),
//!
//! where v is the voltage that acts in the tick. The error of î vanishes with L/R, so î is the current that
//! flows, but for errors of the constants. The measured current i contradicts the equation by
//!
//! e = |î − i| − 0.3 |î| − (0.03 |v| + 0.1 Ke |ω|)/R − 0.1 ic,
//!
//! ic being the continuous current. The terms are what a sound motor may need: copper that is hotter by
//! 100 K has 1.4 R, so i is 0.71 î; 3 % of the bus voltage; 10 % of the torque constant; and the zero and the
//! noise of the sensor. The sum of e over time, never below 0, is a contradiction above ic · 1.5 ms: a short
//! transient, in which L or the speed's lag matters, does not reach it, and a sensor that shows nothing of ic
//! does within 4 ms.

use super::discrete::decay;
use crate::Scalar;

/// Share of the computed current that hot copper explains: 1 − 1/1.4, and a little more.
const HOT_COPPER: f64 = 0.3;
/// Error of the bus voltage, as a share.
const OF_VOLTAGE: f64 = 0.03;
/// Error of the torque constant, as a share.
const OF_BACK_EMF: f64 = 0.1;
/// Error of the sensor's zero, and its noise, as a share of the continuous current.
const OF_ZERO: f64 = 0.1;
/// Longest contradiction by the continuous current [s].
const LONGEST: f64 = 1.5e-3;
/// Greatest resistance, by that of the settings: copper that is hotter by 100 K.
const HOTTEST: f64 = 1.4;
/// Least difference between î and i by which a motor's speed shows itself: as a share of i, for an error of
/// R, and as a share of the continuous current.
const SEEN: [f64; 2] = [0.04, 0.04];

/// The constants of a motor's equation.
///
/// ```
/// use fivebar_kinematics::control::{MotorEquation, MotorEstimate};
///
/// // 2.3 Ω, 0.24 mH, 0.187 V·s/rad at the joint, 1.3 A continuously, ticks of 0.1 ms.
/// let equation = MotorEquation::new(2.3, 0.24e-3, 0.187, 1.3, 1e-4);
/// let mut estimate = MotorEstimate::of(0.0);
/// // 3 V on a motor at rest drive 1.3 A. A sensor that shows them is right for ever …
/// assert!((0..1000).all(|_| !equation.contradicts(&mut estimate, 3.0, 0.0, 1.3_f64)));
/// // … and one that shows nothing is wrong within 4 ms.
/// let ticks = (1..).find(|_| equation.contradicts(&mut estimate, 3.0, 0.0, 0.0));
/// assert!(ticks < Some(40));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotorEquation<S> {
    /// a.
    kept: S,
    /// (1 − a)/R [A/V].
    gained: S,
    /// Ke [V·s/rad].
    back_emf: S,
    /// Of e: per volt [A/V], per rad/s [A·s/rad], and always [A].
    allowed: [S; 3],
    /// Greatest sum of e [A], over ticks.
    limit: S,
    /// Least difference of a turning motor, always [A].
    seen: S,
}

/// What the equation says of a motor.
///
/// ```
/// use fivebar_kinematics::control::{MotorEquation, MotorEstimate};
///
/// let equation = MotorEquation::new(2.0, 1e-6, 0.1, 1.0, 1e-4);
/// let mut estimate = MotorEstimate::of(0.0);
/// equation.contradicts(&mut estimate, 5.0, 10.0, 0.0_f64);
/// // (5 V − 0.1 V·s/rad · 10 rad/s)/2 Ω, a short time after the voltage was applied; 1.4 times less
/// // if the copper is hot.
/// assert!((estimate.current - 2.0).abs() < 1e-9);
/// assert!((estimate.least_current() - 2.0 / 1.4).abs() < 1e-9);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotorEstimate<S> {
    /// î [A].
    pub current: S,
    /// The sum of e [A], over ticks.
    excess: S,
}

impl<S: Scalar> MotorEstimate<S> {
    /// This current [A], and no contradiction.
    pub fn of(current: S) -> Self {
        Self {
            current,
            excess: S::ZERO,
        }
    }

    /// The least current [A] that the equation admits: that of hot copper.
    #[inline(always)]
    pub fn least_current(&self) -> S {
        self.current.abs() * S::from_f64(1.0 / HOTTEST)
    }
}

impl<S: Scalar> MotorEquation<S> {
    /// The equation of a motor of `resistance` R [Ω] and `inductance` L [H] whose back-EMF is
    /// `back_emf` [V·s/rad] times the velocity that [`MotorEquation::contradicts`] is given, and which
    /// stands `continuous_current` [A], at the tick period T [s].
    pub fn new(
        resistance: S,
        inductance: S,
        back_emf: S,
        continuous_current: S,
        period: S,
    ) -> Self {
        let kept = decay(resistance * period / inductance);
        let [_, seen] = SEEN;
        Self {
            kept,
            gained: (S::ONE - kept) / resistance,
            back_emf,
            allowed: [
                S::from_f64(OF_VOLTAGE) / resistance,
                S::from_f64(OF_BACK_EMF) * back_emf.abs() / resistance,
                S::from_f64(OF_ZERO) * continuous_current,
            ],
            limit: S::from_f64(LONGEST) * continuous_current / period,
            seen: S::from_f64(seen) * continuous_current,
        }
    }

    /// One tick: whether the measured `current` [A] contradicts the `voltage` [V] that acted until now,
    /// at `velocity` [rad/s].
    #[inline(always)]
    pub fn contradicts(
        &self,
        estimate: &mut MotorEstimate<S>,
        voltage: S,
        velocity: S,
        current: S,
    ) -> bool {
        let [per_volt, per_speed, always] = self.allowed;
        let driven =
            self.kept * estimate.current + self.gained * (voltage - self.back_emf * velocity);
        let allowed = S::from_f64(HOT_COPPER) * driven.abs()
            + per_volt * voltage.abs()
            + per_speed * velocity.abs()
            + always;
        let excess = estimate.excess + ((driven - current).abs() - allowed);
        estimate.current = driven;
        estimate.excess = if excess > S::ZERO { excess } else { S::ZERO };
        excess > self.limit
    }

    /// Whether a motor whose estimate supposes that it stands turns, by its back-EMF: its measured
    /// `current` [A] is not the one that the voltage drives through a motor that stands.
    #[inline(always)]
    pub fn turns(&self, estimate: &MotorEstimate<S>, current: S) -> bool {
        let [share, _] = SEEN;
        (estimate.current - current).abs() > S::from_f64(share) * current.abs() + self.seen
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const T: f64 = 1e-4;
    const R: f64 = 2.3;
    const L: f64 = 0.24e-3;
    const K: f64 = 0.187;
    const CONTINUOUS: f64 = 1.3;

    fn equation() -> MotorEquation<f64> {
        MotorEquation::new(R, L, K, CONTINUOUS, T)
    }

    /// A motor with its own R, L, K and bus error, under a voltage and a speed over time; the tick in
    /// which a sensor contradicts the equation.
    fn found(
        [r, l, k, bus]: [f64; 4],
        ticks: u32,
        voltage: impl Fn(f64) -> f64,
        speed: impl Fn(f64) -> f64,
        sensor: impl Fn(f64) -> f64,
    ) -> Option<u32> {
        let equation = equation();
        let mut estimate = MotorEstimate::of(0.0);
        let mut current = 0.0;
        (0..ticks).find(|&tick| {
            let t = f64::from(tick) * T;
            let (v, omega) = (voltage(t), speed(t));
            let a = libm::exp(-r * T / l);
            current = a * current + (1.0 - a) / r * (v - k * omega);
            equation.contradicts(&mut estimate, bus * v, omega, sensor(current))
        })
    }

    proptest! {
        #[test]
        fn a_sound_sensor_of_a_motor_that_differs_never_contradicts(
            r in 0.9 * R..1.4 * R,
            l in 0.7 * L..1.3 * L,
            k in 0.9 * K..1.1 * K,
            bus in 0.97..1.03_f64,
            offset in -0.1..0.1_f64,
            volts in 0.0..15.0_f64,
            speed in 0.0..20.0_f64,
            frequency in 1.0..400.0_f64,
        ) {
            let w = core::f64::consts::TAU * frequency;
            let tick = found(
                [r, l, k, bus],
                5000,
                |t| volts * libm::sin(w * t),
                |t| speed * libm::sin(0.1 * w * t),
                |i| i + offset,
            );
            prop_assert_eq!(tick, None);
        }

        #[test]
        fn a_sensor_that_fails_is_found_within_20_ms_of_the_continuous_current(
            current in 1.3..5.0_f64,
            speed in -5.0..5.0_f64,
            kind in 0..4_usize,
        ) {
            let sensors: [fn(f64) -> f64; 4] = [|_| 0.0, |i| 0.25 * i, |i| -i, |_| 8.0];
            let volts = R * current + K * speed;
            let tick = found([R, L, K, 1.0], 200, |_| volts, |_| speed, sensors[kind]);
            prop_assert!(tick.is_some_and(|tick| tick < 200), "{tick:?}");
        }

        #[test]
        fn half_a_gain_is_found_within_20_ms_of_a_quarter_more_than_the_continuous_current(
            current in 1.25 * 1.3..5.0_f64,
            speed in -3.0..3.0_f64,
        ) {
            let volts = R * current + K * speed;
            let tick = found([R, L, K, 1.0], 200, |_| volts, |_| speed, |i| 0.5 * i);
            prop_assert!(tick.is_some_and(|tick| tick < 200), "{tick:?}");
        }
    }

    #[test]
    fn a_zero_that_shifts_by_half_an_ampere_is_found_on_a_motor_at_rest() {
        let tick = found([R, L, K, 1.0], 200, |_| 0.0, |_| 0.0, |i| i - 0.5);
        assert_eq!(tick, Some(52));
    }

    #[test]
    fn the_equation_of_a_reversed_gear_is_that_of_the_same_gear_forward() {
        let reversed = MotorEquation::new(R, L, -K, CONTINUOUS, T);
        let (mut one, mut other) = (MotorEstimate::of(0.0), MotorEstimate::of(0.0));
        for _ in 0..50 {
            let forward = equation().contradicts(&mut one, 3.0, 10.0, 0.9);
            assert_eq!(reversed.contradicts(&mut other, 3.0, -10.0, 0.9), forward);
            assert_eq!(one, other);
        }
    }

    #[test]
    fn a_motor_that_turns_unseen_shows_its_back_emf_and_one_that_stands_shows_none() {
        let equation = equation();
        let mut estimate = MotorEstimate::of(0.0);
        for (volts, turns) in [(9.2, false), (9.2 + 5.0 * K, true)] {
            for _ in 0..20 {
                equation.contradicts(&mut estimate, volts, 0.0, 4.0);
            }
            assert_eq!(equation.turns(&estimate, 4.0), turns, "{volts} V");
        }
    }
}
