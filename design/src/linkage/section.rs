//! Bars whose mass is computed from their length.

use fivebar_kinematics::dynamics::Link;
use fivebar_kinematics::{PlanarVector, Scalar};
use nalgebra::Vector2;

/// The section of a slender uniform bar, whose mass, centre of mass and moment of inertia are
/// computed from its length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BarSection<S> {
    /// S, the area of its section [m²].
    pub area: S,
    /// ρ, its density [kg/m³].
    pub density: S,
}

impl<S: Scalar> BarSection<S> {
    /// m = ρ S L, J = m L²/12 of a bar from the origin of its frame to `end` [m].
    pub(super) fn bar(&self, end: Vector2<S>) -> Link<S> {
        let mass = self.density * self.area * end.length();
        Link {
            mass,
            com: end * S::HALF,
            inertia: mass * end.length_squared() / S::from_f64(12.0),
        }
    }
}
