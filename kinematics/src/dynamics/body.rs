//! The masses of the arm, checked at construction.

use crate::five_bar::Geometry;
use crate::{PlanarVector, Scalar};
use core::fmt;
use nalgebra::Vector2;

/// The inertia of one link.
///
/// ```
/// use fivebar_kinematics::dynamics::Link;
/// use fivebar_kinematics::nalgebra::Vector2;
///
/// // A rod of 60 g and 160 mm; its inertia about the middle is m l²/12 [kg·m²].
/// let rod = Link::uniform_rod(0.06_f64, 0.16);
/// assert_eq!(rod.com, Vector2::new(0.08, 0.0));
/// assert!((rod.inertia - 1.28e-4).abs() < 1e-18);
/// // Measured values, the centre of mass 2 mm beside the link.
/// let measured = Link { mass: 0.064, com: Vector2::new(0.075, 0.002), inertia: 1.5e-4 };
/// assert!(measured.inertia > rod.inertia);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Link<S> {
    /// Mass [kg].
    pub mass: S,
    /// Centre of mass [m], along the link and to its left, from A, B, D or E.
    pub com: Vector2<S>,
    /// Moment of inertia about the centre of mass [kg·m²].
    pub inertia: S,
}

impl<S: Scalar> Link<S> {
    /// A uniform rod of this mass [kg] and length [m]: its centre of mass is in its middle,
    /// its moment of inertia about that m l²/12.
    pub fn uniform_rod(mass: S, length: S) -> Self {
        Self {
            mass,
            com: Vector2::new(S::HALF * length, S::ZERO),
            inertia: mass * length * length * S::from_f64(1.0 / 12.0),
        }
    }
}

/// Geometry and inertia of the whole arm: what its equations of motion need.
///
/// ```
/// use fivebar_kinematics::dynamics::{Arm, Link};
/// use fivebar_kinematics::five_bar::{Geometry, Side, WorkingMode};
/// use fivebar_kinematics::nalgebra::Vector2;
///
/// let geometry = Geometry::new([0.10_f64, 0.16, 0.16, 0.10, 0.08])?;
/// let rods = [0.10, 0.16, 0.16, 0.10].map(|length| Link::uniform_rod(0.06, length)); // kg, m
/// let (payload, gravity) = (0.03, Vector2::new(0.0, -9.81)); // kg, m/s²
/// let arm = Arm::new(geometry, rods, payload, gravity, [2e-5; 2])?;
///
/// // A symmetric pose needs opposite torques [N·m] to hold the arm up.
/// let pose = geometry.inverse(Vector2::new(0.04, 0.20), WorkingMode::new(Side::Right, Side::Left))?;
/// let [torque1, torque4] = arm.gravity_torque(&pose)?;
/// assert!(torque1 < -0.01 && (torque1 + torque4).abs() < 1e-15);
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arm<S> {
    geometry: Geometry<S>,
    links: [Link<S>; 4],
    payload: S,
    gravity: Vector2<S>,
    rotor_inertia: [S; 2],
}

/// Why an arm's masses and inertias are refused.
///
/// ```
/// use fivebar_kinematics::dynamics::{Arm, Link, ModelError};
/// use fivebar_kinematics::five_bar::Geometry;
/// use fivebar_kinematics::nalgebra::Vector2;
///
/// let geometry = Geometry::new([0.10_f64, 0.16, 0.16, 0.10, 0.08])?;
/// let mut rods = [0.10, 0.16, 0.16, 0.10].map(|length| Link::uniform_rod(0.06, length));
/// rods[2].mass = -0.06;
/// let arm = Arm::new(geometry, rods, 0.0, Vector2::zeros(), [0.0; 2]);
/// assert_eq!(arm, Err(ModelError::Link(3)));
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum ModelError {
    /// Link `1..=4`: mass and inertia must be finite and not negative, the centre finite.
    Link(usize),
    /// The payload must be finite and not negative.
    Payload,
    /// Gravity must be finite.
    Gravity,
    /// A rotor's inertia must be finite and not negative.
    RotorInertia,
    /// Link 1 or 4 has no inertia about its driven joint, so its acceleration would be infinite.
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

/// Whether a mass or an inertia is finite and not negative.
fn sound<S: Scalar>(value: S) -> bool {
    value >= S::ZERO && value.is_finite()
}

impl<S: Scalar> Arm<S> {
    /// An arm of these links, with a point mass `payload` [kg] at C, `gravity` [m/s²] in
    /// the plane, and `rotor_inertia` [kg·m²] of each motor seen at its driven joint
    /// (gear ratio squared times the rotor's own).
    ///
    /// # Errors
    /// The first value that is not finite or is negative, and a driven link without any
    /// inertia about its joint.
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

    /// The same arm without gravity.
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
