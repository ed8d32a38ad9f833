//! The closed arm as four vectors, the form in which the tick computes with it.
//!
//! With r1 = AB, r2 = BC, r3 = DC, r4 = ED and X = r2 × r3 = l2 l3 sin(θ3−θ2), rates and
//! torques need no unit vector, length or sine: ω2 = v·r3/X for Yu 2007's ω2 = v·u3/(l2
//! sin(θ3−θ2)), v being the velocity of D relative to B, and so on.

use super::dyad::DyadSolution;
use super::forward::refusal;
use super::{Geometry, Pose, PoseError, Side};
use crate::{PlanarVector, Scalar};
use nalgebra::Vector2;

/// The links of a closed arm, away from the parallel singularity [m].
///
/// ```
/// use fivebar_kinematics::PlanarVector;
/// use fivebar_kinematics::five_bar::{Geometry, Side};
/// use fivebar_kinematics::nalgebra::Vector2;
///
/// let geometry = Geometry::new([0.10_f64, 0.16, 0.16, 0.10, 0.08])?;
/// let (u1, u4) = (Vector2::<f64>::unit(2.0), Vector2::unit(1.1)); // rad
/// let links = geometry.links(u1, u4, Side::Left)?;
/// // Both ways from A to C.
/// let by_leg4 = geometry.e() + links.ed + links.dc;
/// assert!((links.ab + links.bc - by_leg4).norm() < 1e-15);
/// assert!((geometry.pose(&links).sin32() - links.cross / (0.16 * 0.16)).abs() < 1e-14);
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Links<S> {
    /// r1, A to B.
    pub ab: Vector2<S>,
    /// r2, B to C.
    pub bc: Vector2<S>,
    /// r3, D to C.
    pub dc: Vector2<S>,
    /// r4, E to D.
    pub ed: Vector2<S>,
    /// r2 × r3 [m²], not zero: positive on the `Left` assembly.
    pub cross: S,
}

impl<S: Scalar> Geometry<S> {
    /// The links with the driven ones along the unit vectors `u1` and `u4`, on the given
    /// assembly branch.
    ///
    /// # Errors
    /// `Unreachable` where links 2 and 3 cannot meet, `Singular` at type 2, `NotFinite`.
    #[inline(always)]
    pub fn links(
        &self,
        u1: Vector2<S>,
        u4: Vector2<S>,
        assembly: Side,
    ) -> Result<Links<S>, PoseError> {
        let ab = u1 * self.l1();
        let ed = u4 * self.l4();
        let bd = ed - (ab - self.e());
        let DyadSolution { joint: bc, cross } = self.tip().solve(bd, assembly).map_err(refusal)?;
        Ok(Links {
            ab,
            bc,
            dc: bc - bd,
            ed,
            cross,
        })
    }

    /// The pose of these links.
    #[inline]
    pub fn pose(&self, links: &Links<S>) -> Pose<S> {
        let Links { ab, bc, dc, ed, .. } = *links;
        let [per_l1, per_l2, per_l3, per_l4] = self.per_length();
        Pose {
            u1: ab * per_l1,
            u2: bc * per_l2,
            u3: dc * per_l3,
            u4: ed * per_l4,
            b: ab,
            c: ab + bc,
            d: self.e() + ed,
        }
    }
}

/// How fast links 2 and 3 turn while one driven joint turns at 1 rad/s and the other rests.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PartialRates<S> {
    /// ∂θ2/∂θ1, ∂θ2/∂θ4.
    pub link2: [S; 2],
    /// ∂θ3/∂θ1, ∂θ3/∂θ4.
    pub link3: [S; 2],
}

impl<S: Scalar> Links<S> {
    /// ω21 = r3×r1/X, ω24 = −r3×r4/X, ω31 = r2×r1/X, ω34 = −r2×r4/X.
    #[inline(always)]
    pub fn partial_rates(&self) -> PartialRates<S> {
        let Self {
            ab: r1,
            bc: r2,
            dc: r3,
            ed: r4,
            cross,
        } = *self;
        let per_cross = S::ONE / cross;
        PartialRates {
            link2: [r3.cross_z(r1) * per_cross, r4.cross_z(r3) * per_cross],
            link3: [r2.cross_z(r1) * per_cross, r4.cross_z(r2) * per_cross],
        }
    }

    /// The links of a pose.
    pub fn of(pose: &Pose<S>, geometry: &Geometry<S>) -> Self {
        let (bc, dc) = (pose.c - pose.b, pose.c - pose.d);
        Self {
            ab: pose.b,
            bc,
            dc,
            ed: pose.d - geometry.e(),
            cross: bc.cross_z(dc),
        }
    }
}
