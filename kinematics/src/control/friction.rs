//! Friction fed forward: b ωd + τc ωd/(|ωd| + ωs).
//!
//! It follows the desired velocity, which has no noise, so that it does not chatter. The
//! smooth sign reaches half of Coulomb's torque τc at ωs, and it and its slope are
//! continuous through rest.

use crate::Scalar;

/// The controller's model of the friction of a driven joint.
///
/// ```
/// use fivebar_kinematics::control::FrictionCompensation;
///
/// // 0.02 N·m·s/rad, 0.3 N·m, smoothed over 0.01 rad/s.
/// let friction = FrictionCompensation::new(0.02, 0.3, 0.01);
/// assert_eq!(friction.torque(0.0), 0.0);
/// // Half of Coulomb's torque at the smoothing velocity.
/// assert!((friction.torque(0.01) - 0.1502_f64).abs() < 1e-12);
/// // Almost all of it, and the viscous torque, at 10 rad/s.
/// assert!((friction.torque(10.0) - 0.5_f64).abs() < 1e-3);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrictionCompensation<S> {
    viscous: S,
    coulomb: S,
    smoothing: S,
}

impl<S: Scalar> FrictionCompensation<S> {
    /// Viscous b [N·m·s/rad] and Coulomb τc [N·m] friction, its sign smoothed over
    /// `smoothing` ωs > 0 [rad/s].
    pub const fn new(viscous: S, coulomb: S, smoothing: S) -> Self {
        Self {
            viscous,
            coulomb,
            smoothing,
        }
    }

    /// The torque [N·m] that overcomes friction at this velocity [rad/s].
    #[inline(always)]
    pub fn torque(&self, velocity: S) -> S {
        velocity * (self.viscous + self.coulomb / (velocity.abs() + self.smoothing))
    }

    /// The part of it that does not grow with the velocity [N·m].
    #[inline(always)]
    pub fn dry(&self, velocity: S) -> S {
        velocity * (self.coulomb / (velocity.abs() + self.smoothing))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn is_odd_and_tends_to_coulombs_torque_and_the_viscous_slope() {
        let friction = FrictionCompensation::new(0.02_f64, 0.3, 0.01);
        assert_eq!(friction.torque(0.0), 0.0);
        assert!((friction.torque(0.01) - (0.15 + 0.0002)).abs() < 1e-12);
        assert_eq!(friction.torque(-1.7), -friction.torque(1.7));
        assert!((friction.torque(1.7) - friction.dry(1.7) - 0.02 * 1.7).abs() < 1e-12);
        assert!((friction.torque(10.0) - (0.3 + 0.2)).abs() < 1e-3);
    }

    #[test]
    fn slope_is_continuous_through_rest() {
        let friction = FrictionCompensation::new(0.02_f64, 0.3, 0.01);
        let slope = |v: f64| (friction.torque(v + 1e-7) - friction.torque(v - 1e-7)) / 2e-7;
        let at_rest = 0.02 + 0.3 / 0.01;
        for v in [-1e-6, 0.0, 1e-6] {
            assert!((slope(v) / at_rest - 1.0).abs() < 1e-3);
        }
    }
}
