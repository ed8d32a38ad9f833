//! The three lengths, checked at construction.

use super::{GeometryError, Limb};
use fivebar_kinematics::Scalar;

/// The lengths of a slider-driven mechanism [m].
///
/// ```
/// use fivebar_design::slider::{Geometry, WorkingMode};
/// use nalgebra::Vector2;
///
/// // l3, l7 and l5 [m]; the limbs are 1.2 m and 1.1 m long.
/// let geometry = Geometry::new(1.2_f64, 1.1, 0.6)?;
/// let pose = geometry.inverse(Vector2::new(0.0, 0.9), WorkingMode::APART)?;
/// let back = geometry.forward(pose.x2, pose.x8, pose.assembly())?;
/// assert!((back.p - pose.p).norm() < 1e-15);
/// assert!((pose.x2 + 0.3 + (1.2_f64 * 1.2 - 0.9 * 0.9).sqrt()).abs() < 1e-15);
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Geometry<S> {
    left: S,
    right: S,
    platform: S,
}

impl<S: Scalar> Geometry<S> {
    /// The mechanism with the limbs `left` = l3 and `right` = l7 and the width `platform` = l5
    /// [m]; l5 = 0 is PRRRP.
    ///
    /// # Errors
    /// A limb that is not positive and finite, or a platform that is negative or not finite.
    pub fn new(left: S, right: S, platform: S) -> Result<Self, GeometryError> {
        for (length, limb) in [(left, Limb::Left), (right, Limb::Right)] {
            if !(length > S::ZERO && length.is_finite()) {
                return Err(GeometryError::Limb(limb));
            }
        }
        if !(platform >= S::ZERO && platform.is_finite()) {
            return Err(GeometryError::Platform);
        }
        Ok(Self {
            left,
            right,
            platform,
        })
    }

    /// l3, the left limb [m].
    #[inline]
    pub fn l3(&self) -> S {
        self.left
    }
    /// l7, the right limb [m].
    #[inline]
    pub fn l7(&self) -> S {
        self.right
    }
    /// l5, the platform's width [m].
    #[inline]
    pub fn l5(&self) -> S {
        self.platform
    }
    /// l5/2, from P to the platform's ends [m].
    #[inline]
    pub(super) fn half_platform(&self) -> S {
        S::HALF * self.platform
    }
}
