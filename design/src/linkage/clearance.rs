//! Pins that lie off their bearings' centres.
//!
//! A clearance is a massless link r e^{ia} in a joint (Shi 2005): it leads from the joint's
//! place on the link that exerts to its place on the link acted on, and keeps its direction
//! in the plane. The force in it is passed on from the one place to the other without a
//! moment: along the massless link it has none.

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
