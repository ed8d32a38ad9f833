//! The force between a pin and its bearing, and when they meet and part.
//!
//! The pin's centre lies at g from the bearing's, along n = g/|g|; they overlap by
//! d = |g| − c, where c = R_B − R_J is the clearance. In contact the pin feels
//!
//! −F n − μ F s(u/u₀) t, F = K d^1.5 (1 + D ḋ/v₀) ≥ 0, K = 2E/(3(1−ν²)) √(R_B R_J/c),
//!
//! where t is n turned by +90°, u the sliding of pin on bearing and s(x) = x/√(1 + x²) the
//! regularised sign. F acts on both at one point, R_B n from the bearing's centre, so that
//! it adds no momentum; all that is not elastic in it opposes the motion, so that it adds
//! no energy.

use crate::input::robot::Contact;
use nalgebra::Vector2;

/// Sliding speed u₀ over which friction turns round [m/s].
const SLIDING_WIDTH: f64 = 1e-3;
/// v₀ is never less than this [m/s]. The laws are of impacts: as v₀ → 0 the damping would
/// grow without bound. Touches slower than this lose a smaller share of their speed.
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

/// Where the pin is in the bearing and how both move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Eccentricity {
    /// g: the pin's centre from the bearing's [m].
    pub offset: Vector2<f64>,
    /// Its rate [m/s].
    pub rate: Vector2<f64>,
    /// How fast the pin turns [rad/s].
    pub pin_spin: f64,
    /// How fast the bearing turns [rad/s].
    pub bearing_spin: f64,
}

/// Whether pin and bearing touch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Phase {
    /// They do not.
    Flight,
    /// They do.
    Touching {
        /// v₀: how fast they met, at least as fast as the laws of impact hold [m/s].
        approach: f64,
    },
}

/// A force of contact and its arms.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touch {
    /// On the pin; the bearing feels the opposite [N].
    pub force: Vector2<f64>,
    /// Where it acts, from the pin's centre [m].
    pub on_pin: Vector2<f64>,
    /// Where it acts, from the bearing's centre [m].
    pub on_bearing: Vector2<f64>,
}

/// A clearance that leaves no pin.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error(
    "a clearance of {clearance} m leaves no pin in a bearing of radius {bearing_radius} m: \
     it must be above 0 and below that (`bearing_radius` of [contact])"
)]
pub struct NoJournal {
    clearance: f64,
    bearing_radius: f64,
}

impl Journal {
    /// A pin with this radial clearance [m] in a bearing of this kind.
    ///
    /// # Errors
    /// A clearance that is not above 0 or not below the bearing's radius.
    pub fn new(contact: &Contact, clearance: f64) -> Result<Self, NoJournal> {
        let bearing_radius = contact.bearing_radius;
        if !(clearance > 0.0 && clearance < bearing_radius) {
            return Err(NoJournal {
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

    /// d [m]: below zero, how far the pin is from the bearing.
    #[inline]
    pub fn penetration(&self, offset: Vector2<f64>) -> f64 {
        offset.norm() - self.clearance
    }

    /// Whether pin and bearing must have met, or parted, by now.
    #[inline]
    pub fn guard(&self, phase: Phase, offset: Vector2<f64>) -> bool {
        match phase {
            Phase::Flight => self.penetration(offset) > 0.0,
            Phase::Touching { .. } => self.penetration(offset) < 0.0,
        }
    }

    /// The phase that begins where the other one ends, with this motion.
    pub fn after_transition(&self, phase: Phase, motion: &Eccentricity) -> Phase {
        match phase {
            Phase::Flight => Phase::Touching {
                approach: motion.opening_rate().max(SLOWEST_APPROACH),
            },
            Phase::Touching { .. } => Phase::Flight,
        }
    }

    /// The force in contact; none in flight, nor from the bearing's middle.
    #[inline]
    pub fn touch(&self, phase: Phase, motion: &Eccentricity) -> Option<Touch> {
        let Phase::Touching { approach } = phase else {
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
        Some(Touch {
            force: -n * normal - t * tangential,
            on_pin: n * pin_arm,
            on_bearing: n * bearing_arm,
        })
    }

    /// Energy stored in the contact [J]: 2/5 K d^2.5.
    pub fn energy(&self, phase: Phase, offset: Vector2<f64>) -> f64 {
        match phase {
            Phase::Flight => 0.0,
            Phase::Touching { .. } => {
                let d = self.penetration(offset).max(0.0);
                0.4 * self.stiffness * d * d * d.sqrt()
            }
        }
    }
}

impl Eccentricity {
    /// ḋ [m/s].
    pub fn opening_rate(&self) -> f64 {
        let distance = self.offset.norm();
        if distance > 0.0 {
            self.rate.dot(&self.offset) / distance
        } else {
            self.rate.norm()
        }
    }
}
