//! Joint clearance: pins away from the centres of their bearings.
//!
//! A clearance is a massless link r e^{ia} in a joint (Shi 2005). It leads from the joint's
//! position on the link that exerts the reaction to its position on the link that receives
//! it, and keeps its direction in the plane. Its force acts along this massless link, so it is
//! transmitted between the two positions without a moment.

use fivebar_kinematics::{PlanarVector, Scalar};
use nalgebra::Vector2;

/// The offset of a pin from its bearing's centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clearance<S> {
    /// r [m].
    pub radius: S,
    /// a, its direction in the plane [rad].
    pub angle: S,
}

impl<S: Scalar> Clearance<S> {
    /// r e^{ia} [m].
    #[inline]
    pub fn offset(&self) -> Vector2<S> {
        Vector2::unit(self.angle) * self.radius
    }
}
