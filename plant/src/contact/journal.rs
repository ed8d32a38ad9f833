//! The contact force between a pin and its bearing, and when contact begins and ends.
//!
//! The pin's centre lies at g from the bearing's centre, n = g/|g|. The penetration is
//! d = |g| − c, where c = R_B − R_J is the clearance. In contact the force on the pin is
//!
//! −F n − μ F s(u/u₀) t, F = K d^1.5 (1 + D ḋ/v₀) ≥ 0, K = 2E/(3(1−ν²)) √(R_B R_J/c),
//!
//! where t is n rotated by +90°, u the sliding speed of the pin on the bearing and
//! s(x) = x/√(1 + x²) the regularised sign. F acts on both bodies at the same point, at
//! R_B n from the bearing's centre, so that it adds no momentum. Its inelastic part opposes
//! the motion, so that it adds no energy.

use super::material::Contact;
use nalgebra::Vector2;

/// Sliding speed u₀ at which friction changes its sign smoothly [m/s].
const SLIDING_WIDTH: f64 = 1e-3;
/// Least value of v₀ [m/s]: as v₀ → 0 the damping of the impact laws would grow without
/// bound. Slower impacts lose a smaller share of their speed than the law says.
const SLOWEST_APPROACH: f64 = 1e-3;

/// A pin in a bearing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Journal {
    clearance: f64,
    bearing_radius: f64,
    stiffness: f64,
    hysteresis: f64,
    friction: f64,
}

/// Position of the pin in the bearing, and the motion of both.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Eccentricity {
    /// g: the pin's centre from the bearing's [m].
    pub offset: Vector2<f64>,
    /// ġ [m/s].
    pub rate: Vector2<f64>,
    /// Angular velocity of the pin [rad/s].
    pub pin_spin: f64,
    /// Angular velocity of the bearing [rad/s].
    pub bearing_spin: f64,
}

/// Whether pin and bearing touch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Phase {
    /// The pin is free in its clearance.
    Flight,
    /// Pin and bearing touch.
    Contact {
        /// v₀: the penetration rate at first touch, at least 1 mm/s [m/s].
        approach: f64,
    },
}

/// A contact force and its lever arms.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactForce {
    /// The force on the pin [N]; the force on the bearing is the opposite.
    pub force: Vector2<f64>,
    /// From the pin's centre to the point of contact [m].
    pub on_pin: Vector2<f64>,
    /// From the bearing's centre to the point of contact [m].
    pub on_bearing: Vector2<f64>,
}

/// The clearance is not between 0 and the bearing's radius.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error(
    "a clearance of {clearance} m leaves no pin in a bearing of radius {bearing_radius} m: \
     it must be above 0 and below `bearing_radius` of [contact]"
)]
pub struct ClearanceError {
    clearance: f64,
    bearing_radius: f64,
}

impl Journal {
    /// A pin with this radial clearance [m] in a bearing with these parameters.
    ///
    /// # Errors
    /// The clearance is not above 0 or not below the bearing's radius.
    pub fn new(contact: &Contact, clearance: f64) -> Result<Self, ClearanceError> {
        let bearing_radius = contact.bearing_radius;
        if !(clearance > 0.0 && clearance < bearing_radius) {
            return Err(ClearanceError {
                clearance,
                bearing_radius,
            });
        }
        let plane = contact.elastic_modulus / (1.0 - contact.poisson_ratio.powi(2));
        let pin_radius = bearing_radius - clearance;
        Ok(Self {
            clearance,
            bearing_radius,
            stiffness: 2.0 / 3.0 * plane * (bearing_radius * pin_radius / clearance).sqrt(),
            hysteresis: contact.law.hysteresis(contact.restitution),
            friction: contact.friction,
        })
    }

    /// c [m].
    pub fn clearance(&self) -> f64 {
        self.clearance
    }

    /// K [N/m^1.5].
    pub fn stiffness(&self) -> f64 {
        self.stiffness
    }

    /// The penetration d [m]; below zero it is the distance of pin and bearing.
    #[inline]
    pub fn penetration(&self, offset: Vector2<f64>) -> f64 {
        offset.norm() - self.clearance
    }

    /// Whether this phase ends at this offset: contact begins in flight, or ends in contact.
    #[inline]
    pub fn guard(&self, phase: Phase, offset: Vector2<f64>) -> bool {
        match phase {
            Phase::Flight => self.penetration(offset) > 0.0,
            Phase::Contact { .. } => self.penetration(offset) < 0.0,
        }
    }

    /// The phase that follows `phase`, when it ends in this motion.
    pub fn next_phase(&self, phase: Phase, motion: &Eccentricity) -> Phase {
        match phase {
            Phase::Flight => Phase::Contact {
                approach: motion.penetration_rate().max(SLOWEST_APPROACH),
            },
            Phase::Contact { .. } => Phase::Flight,
        }
    }

    /// The contact force; none in flight, or without penetration.
    #[inline]
    pub fn contact_force(&self, phase: Phase, motion: &Eccentricity) -> Option<ContactForce> {
        let Phase::Contact { approach } = phase else {
            return None;
        };
        let distance = motion.offset.norm();
        let d = distance - self.clearance;
        if d <= 0.0 {
            return None;
        }
        let n = motion.offset / distance;
        let t = Vector2::new(-n.y, n.x);
        let normal = (self.stiffness * d * d.sqrt())
            * (1.0 + self.hysteresis * motion.rate.dot(&n) / approach).max(0.0);
        let (pin_arm, bearing_arm) = (self.bearing_radius - distance, self.bearing_radius);
        let sliding =
            motion.rate.dot(&t) + motion.pin_spin * pin_arm - motion.bearing_spin * bearing_arm;
        let x = sliding / SLIDING_WIDTH;
        let tangential = self.friction * normal * x / (1.0 + x * x).sqrt();
        Some(ContactForce {
            force: -n * normal - t * tangential,
            on_pin: n * pin_arm,
            on_bearing: n * bearing_arm,
        })
    }

    /// Energy stored in the contact [J]: 2/5 K d^2.5.
    pub fn energy(&self, phase: Phase, offset: Vector2<f64>) -> f64 {
        match phase {
            Phase::Flight => 0.0,
            Phase::Contact { .. } => {
                let d = self.penetration(offset).max(0.0);
                0.4 * self.stiffness * d * d * d.sqrt()
            }
        }
    }
}

impl Eccentricity {
    /// The penetration rate ḋ [m/s].
    pub fn penetration_rate(&self) -> f64 {
        let distance = self.offset.norm();
        if distance > 0.0 {
            self.rate.dot(&self.offset) / distance
        } else {
            self.rate.norm()
        }
    }
}
