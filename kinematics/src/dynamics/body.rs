//! The masses of the arm, validated once.

use crate::five_bar::Geometry;
use crate::{PlanarVector, Scalar};
use core::fmt;
use nalgebra::Vector2;

/// The inertia of one link.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Link<S> {
    /// Mass [kg].
    pub mass: S,
    /// Centre of mass [m], along the link and to its left, from A, B, D or E.
    pub com: Vector2<S>,
    /// Moment of inertia about the centre of mass [kg·m²].
    pub inertia: S,
}

/// Geometry and inertia of the whole arm: what its equations of motion need.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arm<S> {
    geometry: Geometry<S>,
    links: [Link<S>; 4],
    payload: S,
    gravity: Vector2<S>,
    rotor_inertia: [S; 2],
}

/// Why numbers are not an arm's inertia.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ModelError {
    /// Link `1..=4`: mass and inertia must be finite and not negative, the centre finite.
    Link(usize),
    /// The payload must be finite and not negative.
    Payload,
    /// Gravity must be finite.
    Gravity,
    /// A rotor's inertia must be finite and not negative.
    RotorInertia,
    /// Link 1 or 4 has neither mass, inertia nor rotor: no torque could be in balance.
    NoInertia(usize),
}

impl fmt::Display for ModelError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Link(number) => write!(
                f,
                "link {number}: mass and inertia must be finite and not negative, com finite"
            ),
            Self::Payload => f.write_str("payload must be finite and not negative"),
            Self::Gravity => f.write_str("gravity must be finite"),
            Self::RotorInertia => f.write_str("rotor inertia must be finite and not negative"),
            Self::NoInertia(number) => write!(
                f,
                "link {number} needs some inertia about its driven joint: its own or the rotor's"
            ),
        }
    }
}

impl core::error::Error for ModelError {}

fn sound<S: Scalar>(value: S) -> bool {
    value >= S::ZERO && value.is_finite()
}

impl<S: Scalar> Arm<S> {
    /// An arm of these links, with a point mass `payload` [kg] at C, `gravity` [m/s²] in
    /// the plane, and `rotor_inertia` [kg·m²] of each motor seen at its driven joint
    /// (gear ratio squared times the rotor's own).
    ///
    /// # Errors
    /// The first of the numbers that is not sound.
    pub fn new(
        geometry: Geometry<S>,
        links: [Link<S>; 4],
        payload: S,
        gravity: Vector2<S>,
        rotor_inertia: [S; 2],
    ) -> Result<Self, ModelError> {
        for (index, link) in links.iter().enumerate() {
            let finite = link.com.x.is_finite() && link.com.y.is_finite();
            if !(sound(link.mass) && sound(link.inertia) && finite) {
                return Err(ModelError::Link(index + 1));
            }
        }
        if !sound(payload) {
            return Err(ModelError::Payload);
        }
        if !(gravity.x.is_finite() && gravity.y.is_finite()) {
            return Err(ModelError::Gravity);
        }
        if !rotor_inertia.iter().all(|&inertia| sound(inertia)) {
            return Err(ModelError::RotorInertia);
        }
        let [link1, .., link4] = links;
        for (number, link, rotor) in [(1, link1, rotor_inertia[0]), (4, link4, rotor_inertia[1])] {
            let about_joint = link.mass * link.com.length_squared() + link.inertia + rotor;
            if about_joint == S::ZERO {
                return Err(ModelError::NoInertia(number));
            }
        }
        Ok(Self {
            geometry,
            links,
            payload,
            gravity,
            rotor_inertia,
        })
    }

    /// The same arm where nothing weighs anything.
    pub(super) fn weightless(&self) -> Self {
        Self {
            gravity: Vector2::zeros(),
            ..*self
        }
    }

    /// The lengths.
    #[inline]
    pub fn geometry(&self) -> &Geometry<S> {
        &self.geometry
    }
    /// Links 1 to 4.
    #[inline]
    pub fn links(&self) -> &[Link<S>; 4] {
        &self.links
    }
    /// The point mass at C [kg].
    #[inline]
    pub fn payload(&self) -> S {
        self.payload
    }
    /// In-plane gravity [m/s²].
    #[inline]
    pub fn gravity(&self) -> Vector2<S> {
        self.gravity
    }
    /// Each rotor's inertia at its driven joint [kg·m²].
    #[inline]
    pub fn rotor_inertia(&self) -> [S; 2] {
        self.rotor_inertia
    }
}
