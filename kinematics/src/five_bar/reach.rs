//! The reach of C: leg A–B–C reaches the annulus |l1 − l2| ≤ |rC − rA| ≤ l1 + l2,
//! leg E–D–C likewise.

use super::inverse::{refusal1, refusal4};
use super::{Geometry, PoseError, Side};
use crate::Scalar;
use nalgebra::Vector2;

impl<S: Scalar> Geometry<S> {
    /// Whether both legs reach `c` [m]; then every working mode has a pose there. The
    /// exception is a base pivot whose leg has equal links.
    ///
    /// # Errors
    /// `Unreachable` with the leg and the side of its annulus that `c` is beyond,
    /// `NotFinite`.
    pub fn reach(&self, c: Vector2<S>) -> Result<(), PoseError> {
        let leg1 = self.leg1().joint(c, Side::Left).map_err(refusal1);
        let leg4 = self
            .leg4()
            .joint(c - self.e(), Side::Left)
            .map_err(refusal4);
        for leg in [leg1, leg4] {
            match leg {
                Ok(_) | Err(PoseError::Singular(_)) => {}
                Err(other) => return Err(other),
            }
        }
        Ok(())
    }

    /// |l1 − l2| and l1 + l2 [m].
    pub fn leg1_radii(&self) -> [S; 2] {
        [(self.l1() - self.l2()).abs(), self.l1() + self.l2()]
    }

    /// |l4 − l3| and l4 + l3 [m].
    pub fn leg4_radii(&self) -> [S; 2] {
        [(self.l4() - self.l3()).abs(), self.l4() + self.l3()]
    }
}
