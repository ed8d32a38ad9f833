//! The velocity of a joint from its encoder's angle: a second-order tracking loop.
//!
//! Between ticks a constant acceleration α is assumed: the desired one, which is known while
//! the arm follows its path. With the counted angle θ:
//!
//! θ⁻ = θ̂ + T(ω̂ + ½Tα), r = θ − θ⁻, θ̂ = θ⁻ + g1 r, ω̂ ← ω̂ + Tα + (g2/T) r.
//!
//! Both poles of the error lie at p = e^(−ωoT) with g1 = 1 − p², g2 = (1 − p)². In `f32`
//! angles near 3 rad are 2.4e-7 rad apart, a small part of any encoder's count, which
//! bounds what rounding does to θ̂ and, times g2/T, to ω̂.
//!
//! From θ to ω̂ without α this is s(2ωo s + ωo²)/(s + ωo)²: no velocity lag, and the phase
//! lost at ω ≪ ωo is 2(ω/ωo)³.

use super::discrete::decay;
use crate::Scalar;

/// The observer's constants.
///
/// ```
/// use fivebar_kinematics::control::{ObserverState, VelocityObserver};
///
/// let (period, speed) = (1e-4, 5.0); // s, rad/s
/// let count = core::f64::consts::TAU / 40_960.0; // rad
/// let observer = VelocityObserver::new(800.0, period);
/// let mut state = ObserverState::at_rest(0.0);
/// for tick in 1..1000 {
///     let angle = speed * period * f64::from(tick);
///     observer.update(&mut state, (angle / count).round() * count, 0.0);
/// }
/// // The velocity comes from whole counts to within 800 rad/s times one count.
/// assert!((state.velocity - speed).abs() < 800.0 * count);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VelocityObserver<S> {
    period: S,
    half_period: S,
    angle_gain: S,
    velocity_gain: S,
}

/// The observer's estimate for one joint.
///
/// ```
/// use fivebar_kinematics::control::{ObserverState, VelocityObserver};
///
/// let observer = VelocityObserver::new(800.0, 1e-4);
/// let mut state = ObserverState { angle: 0.3_f64, velocity: 2.0 }; // rad, rad/s
/// // The measured angle is where the state predicts it, so only the angle advances.
/// let innovation = observer.update(&mut state, 0.3 + 2.0 * 1e-4, 0.0);
/// assert!(innovation.abs() < 1e-15);
/// assert!((state.velocity - 2.0).abs() < 1e-9);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ObserverState<S> {
    /// θ̂: the estimated angle [rad].
    pub angle: S,
    /// ω̂: the estimated velocity [rad/s].
    pub velocity: S,
}

impl<S: Scalar> ObserverState<S> {
    /// A joint at rest at this angle [rad].
    pub fn at_rest(angle: S) -> Self {
        Self {
            angle,
            velocity: S::ZERO,
        }
    }
}

impl<S: Scalar> VelocityObserver<S> {
    /// An observer of the bandwidth ωo [rad/s] at the tick period T [s].
    pub fn new(bandwidth: S, period: S) -> Self {
        let pole = decay(bandwidth * period);
        let gone = S::ONE - pole;
        Self {
            period,
            half_period: S::HALF * period,
            angle_gain: S::ONE - pole * pole,
            velocity_gain: gone * gone / period,
        }
    }

    /// One tick: the counted angle is `angle` [rad], and the joint should have accelerated
    /// by `alpha` [rad/s²]. Gives the innovation r, measured less predicted angle [rad].
    #[inline(always)]
    pub fn update(&self, state: &mut ObserverState<S>, angle: S, alpha: S) -> S {
        let predicted = state.angle + self.period * (state.velocity + self.half_period * alpha);
        let innovation = angle - predicted;
        state.angle = predicted + self.angle_gain * innovation;
        state.velocity = state.velocity + self.period * alpha + self.velocity_gain * innovation;
        innovation
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const T: f64 = 1e-4;
    const Q: f64 = core::f64::consts::TAU / 40_960.0;

    /// Feeds quantised counts of θ(t) and returns the worst velocity error after `settle`.
    fn worst(
        observer: &VelocityObserver<f64>,
        theta: impl Fn(f64) -> f64,
        omega: impl Fn(f64) -> f64,
        alpha: impl Fn(f64) -> f64,
        settle: usize,
    ) -> f64 {
        let counted = |t: f64| Q * libm::round(theta(t) / Q);
        let mut state = ObserverState::at_rest(counted(0.0));
        let mut worst = 0.0_f64;
        for k in 1..8000_u32 {
            let t = f64::from(k) * T;
            observer.update(&mut state, counted(t), alpha(t - T));
            if k as usize > settle {
                worst = worst.max((state.velocity - omega(t)).abs());
            }
        }
        worst
    }

    #[test]
    fn error_dynamics_have_both_poles_where_asked() {
        // At a counted angle of zero the state obeys z² − (p² + 1 − (1−p)²) z + p² = (z − p)².
        let observer = VelocityObserver::new(1500.0, T);
        let step = |angle, velocity| {
            let mut state = ObserverState { angle, velocity };
            observer.update(&mut state, 0.0, 0.0);
            [state.angle, state.velocity]
        };
        let ([a, c], [b, d]) = (step(1.0, 0.0), step(0.0, 1.0));
        let p = libm::exp(-0.15);
        assert!((a + d - 2.0 * p).abs() < 1e-9);
        assert!((a * d - b * c - p * p).abs() < 1e-9);
    }

    #[test]
    fn a_known_acceleration_is_predicted_to_the_end_of_the_tick() {
        let observer = VelocityObserver::new(1500.0, T);
        let (omega, alpha) = (3.0, 1e4);
        let mut state = ObserverState {
            angle: 0.2,
            velocity: omega,
        };
        let angle = 0.2 + omega * T + 0.5 * alpha * T * T;
        let innovation = observer.update(&mut state, angle, alpha);
        assert!(innovation.abs() < 1e-15, "{innovation} rad");
        assert!((state.velocity - (omega + alpha * T)).abs() < 1e-9);
    }

    #[test]
    fn known_acceleration_leaves_only_quantisation() {
        let observer = VelocityObserver::new(800.0, T);
        let w = core::f64::consts::TAU * 3.0;
        let (theta, omega) = (|t| 0.5 * libm::sin(w * t), |t| 0.5 * w * libm::cos(w * t));
        let known = worst(
            &observer,
            theta,
            omega,
            |t| -0.5 * w * w * libm::sin(w * t),
            500,
        );
        let unknown = worst(&observer, theta, omega, |_| 0.0, 500);
        // The error of one count, half a q, passes with a gain of about ωo at most.
        assert!(known < 800.0 * Q, "{known}");
        assert!(unknown > 2.0 * known, "{unknown} against {known}");
    }

    proptest! {
        #[test]
        fn constant_velocity_is_found_without_bias(velocity in -20.0..20.0_f64) {
            let observer = VelocityObserver::new(800.0, T);
            let error = worst(&observer, |t| velocity * t, |_| velocity, |_| 0.0, 1000);
            prop_assert!(error < 800.0 * Q, "{error}");
        }

        #[test]
        fn standing_still_reads_zero(start in -1e3..1e3_f64) {
            let observer = VelocityObserver::new(800.0, T);
            let error = worst(&observer, |_| start, |_| 0.0, |_| 0.0, 0);
            prop_assert_eq!(error, 0.0);
        }
    }
}
