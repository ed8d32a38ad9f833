//! The I²t model of a motor's heating.
//!
//! τ ẋ = i² − x. x is the square of the constant current that leads to the present temperature
//! in the steady state, so its limit is the square of the continuous current. Within one tick
//! x changes by a few parts in a million, near the resolution of `f32`; the sum is therefore
//! compensated for its rounding error (Kahan).

use crate::Scalar;

/// The heating of a motor.
///
/// ```
/// use fivebar_kinematics::control::{MotorHeat, MotorHeating};
///
/// // 2 A continuous, a time constant of 5 s, ticks of 1 ms; 4 A flow.
/// let heating = MotorHeating::new(2.0, 5.0, 1e-3);
/// let mut heat = MotorHeat::cold();
/// let ticks = (1..).find(|_| heating.update(&mut heat, 4.0_f64)).unwrap_or(0);
/// // i²(1 − e^(−t/τ)) = 4 A² at t = τ ln(16/12) = 1.438 s.
/// assert!((f64::from(ticks) * 1e-3 - 1.438).abs() < 2e-3);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotorHeating<S> {
    rate: S,
    limit: S,
}

/// The state of a motor's heating: x [A²] and the rounding error of its sum.
///
/// ```
/// use fivebar_kinematics::control::{MotorHeat, MotorHeating};
///
/// let heating = MotorHeating::new(2.0, 5.0, 1e-3);
/// let mut heat = MotorHeat::cold();
/// for _ in 0..5000 { // one time constant at 1 A
///     heating.update(&mut heat, 1.0_f64);
/// }
/// assert!((heat.squared_current() - (1.0 - f64::exp(-1.0))).abs() < 1e-3); // A²
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotorHeat<S> {
    x: S,
    lost: S,
}

impl<S: Scalar> MotorHeat<S> {
    /// A motor at the temperature of its surroundings.
    pub fn cold() -> Self {
        Self {
            x: S::ZERO,
            lost: S::ZERO,
        }
    }

    /// A motor with this share of the heat that it has permanently at `continuous_current` [A].
    pub fn at_share(share: S, continuous_current: S) -> Self {
        Self {
            x: share * continuous_current * continuous_current,
            lost: S::ZERO,
        }
    }

    /// The heat as a share of that at `continuous_current` [A].
    pub fn share(&self, continuous_current: S) -> S {
        self.x / (continuous_current * continuous_current)
    }

    /// x [A²].
    #[inline]
    pub fn squared_current(&self) -> S {
        self.x
    }
}

impl<S: Scalar> MotorHeating<S> {
    /// A motor with this `continuous_current` [A], which it can carry permanently, and this
    /// `time_constant` [s] of heating, at the tick period [s].
    pub fn new(continuous_current: S, time_constant: S, period: S) -> Self {
        Self {
            rate: period / time_constant,
            limit: continuous_current * continuous_current,
        }
    }

    /// One tick at `current` [A]. True while the motor is too hot.
    #[inline(always)]
    pub fn update(&self, heat: &mut MotorHeat<S>, current: S) -> bool {
        let step = self.rate * (current * current - heat.x) - heat.lost;
        let next = heat.x + step;
        heat.lost = (next - heat.x) - step;
        heat.x = next;
        next > self.limit
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn trips_when_the_closed_form_says_so() {
        // x(t) = i²(1 − e^(−t/τ)) reaches the limit at t = τ ln(i²/(i² − limit)).
        for (current, continuous, tau) in [
            (4.0_f32, 2.0_f32, 5.0_f32),
            (2.2, 2.0, 5.0),
            (3.0, 2.0, 20.0),
            // Here a tick adds less than ten roundings of x.
            (4.0, 2.0, 400.0),
        ] {
            let heating = MotorHeating::new(continuous, tau, 1e-4);
            let mut heat = MotorHeat::cold();
            let (i2, limit) = (
                f64::from(current * current),
                f64::from(continuous * continuous),
            );
            let expected = f64::from(tau) * libm::log(i2 / (i2 - limit)) * 1e4;
            let ticks = (0..2_000_000)
                .take_while(|_| !heating.update(&mut heat, current))
                .count();
            assert!(
                (ticks as f64 / expected - 1.0).abs() < 1e-3,
                "{ticks} for {expected}"
            );
        }
    }

    #[test]
    fn bears_the_continuous_current_for_ever() {
        let heating = MotorHeating::new(2.0_f32, 0.5, 1e-4);
        let mut heat = MotorHeat::cold();
        assert!((0..100_000).all(|_| !heating.update(&mut heat, 1.999)));
        assert!(heat.squared_current() > 3.99);
    }

    #[test]
    fn cools_towards_zero() {
        let heating = MotorHeating::new(1.0_f32, 0.5, 1e-4);
        let mut heat = MotorHeat { x: 0.9, lost: 0.0 };
        for _ in 0..5000 {
            heating.update(&mut heat, 0.0);
        }
        // One time constant.
        assert!((heat.squared_current() - 0.9 * 0.36788).abs() < 1e-4);
    }
}
