//! How far a pose is from its singularities, as an angle and as a length.

use super::{Geometry, Pose, Singularity};
use crate::{Scalar, Vec2};

/// Distance from one singularity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clearance<S> {
    /// |sin| of the angle that the singularity closes, 0…1.
    pub sine: S,
    /// How far the dyad's ends can still be drawn apart or together before its two links
    /// are in line [m].
    pub length: S,
}

/// Distances from the three singularities of a pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clearances<S> {
    /// Type 1 of leg A–B–C: the length is what C can move, at least.
    pub leg1: Clearance<S>,
    /// Type 1 of leg E–D–C: the length is what C can move, at least.
    pub leg4: Clearance<S>,
    /// Type 2, dyad B–C–D: the length is what the elbows can move apart or together.
    pub parallel: Clearance<S>,
}

impl<S: Scalar> Geometry<S> {
    /// How far the pose is from each singularity.
    pub fn clearances(&self, pose: &Pose<S>) -> Clearances<S> {
        let of = |sine: S, ends: Vec2<S>, first: S, second: S| {
            let distance = ends.norm();
            let outwards = first + second - distance;
            let inwards = distance - (first - second).abs();
            let length = if outwards < inwards {
                outwards
            } else {
                inwards
            };
            Clearance {
                sine: sine.abs(),
                // Rounding can put a straight dyad past straight.
                length: if length > S::ZERO { length } else { S::ZERO },
            }
        };
        Clearances {
            leg1: of(pose.sin21(), pose.c, self.l1(), self.l2()),
            leg4: of(pose.sin34(), pose.c - self.e(), self.l4(), self.l3()),
            parallel: of(pose.sin32(), pose.d - pose.b, self.l2(), self.l3()),
        }
    }
}

impl<S: Scalar> Pose<S> {
    /// The singularity whose sine is smallest, and |sine|.
    #[inline]
    pub fn nearest_singularity(&self) -> (Singularity, S) {
        let mut nearest = (Singularity::Leg1, self.sin21().abs());
        let sin34 = self.sin34().abs();
        if sin34 < nearest.1 {
            nearest = (Singularity::Leg4, sin34);
        }
        let sin32 = self.sin32().abs();
        if sin32 < nearest.1 {
            nearest = (Singularity::Parallel, sin32);
        }
        nearest
    }
}
