//! The sources' own half-angle solutions (Yu 2007), for comparison.
//!
//! They give the same roots as [`Geometry::forward`] and [`Geometry::inverse`], which are
//! better conditioned and need no trigonometry. Where one of the two roots is θ = π the
//! formulas are singular although the arm is not: the printed `atan` has no tangent for that
//! root, and for the other root the quotient is 0/0. `atan2` solves the first problem; the
//! second remains. Not used by the controller.

use super::{Geometry, Side, WorkingMode};
use crate::{PlanarVector, Scalar};
use nalgebra::Vector2;

impl<S: Scalar> Geometry<S> {
    /// θ2, θ3 [rad] from θ1, θ4 [rad]:
    ///
    /// θ2 = 2 atan2(B0 ± √(A0²+B0²−C0²), A0+C0), θ3 = atan2(yC−yD, xC−xD), with
    /// A0 = 2 l2 (xD−xB), B0 = 2 l2 (yD−yB), C0 = l2² + |BD|² − l3²; the upper sign on
    /// the `Left` assembly.
    ///
    /// `None` where no pose exists, and for the root beside θ2 = π, where A0 = −C0 and
    /// both arguments of atan2 vanish.
    pub fn half_angle_forward(&self, theta1: S, theta4: S, assembly: Side) -> Option<[S; 2]> {
        let (l2, l3) = (self.l2(), self.l3());
        let b = Vector2::unit(theta1) * self.l1();
        let d = self.e() + Vector2::unit(theta4) * self.l4();
        let p = d - b;
        let a0 = S::TWO * l2 * p.x;
        let b0 = S::TWO * l2 * p.y;
        let c0 = l2 * l2 + p.length_squared() - l3 * l3;
        let root = assembly.sign(root(a0 * a0 + b0 * b0 - c0 * c0)?);
        let theta2 = S::TWO * angle(b0 + root, a0 + c0)?;
        let c = b + Vector2::unit(theta2) * l2;
        Some([theta2, (c - d).polar_angle()])
    }

    /// θ1, θ4 [rad] from C [m]: of A0 + B0 cos θ + C0 sin θ = 0 the roots
    ///
    /// tan(θ/2) = (−C0 ± √(C0²+B0²−A0²))/(A0−B0), with, for leg 1,
    /// A0 = |rC−rA|² + l1² − l2², B0 = −2 l1 (xC−xA), C0 = −2 l1 (yC−yA), and leg 4 alike
    /// about E; the lower sign where the elbow turns `Left`.
    ///
    /// `None` where no pose exists, and for a leg's root beside θ = π, where A0 = B0 and
    /// both arguments of atan2 vanish.
    pub fn half_angle_inverse(&self, c: Vector2<S>, mode: WorkingMode) -> Option<[S; 2]> {
        let leg = |r: Vector2<S>, driven: S, distal: S, elbow: Side| {
            let a0 = r.length_squared() + driven * driven - distal * distal;
            let b0 = -S::TWO * driven * r.x;
            let c0 = -S::TWO * driven * r.y;
            let root = elbow.sign(root(c0 * c0 + b0 * b0 - a0 * a0)?);
            Some(S::TWO * angle(-c0 - root, a0 - b0)?)
        };
        Some([
            leg(c, self.l1(), self.l2(), mode.elbow1)?,
            leg(c - self.e(), self.l4(), self.l3(), mode.elbow4)?,
        ])
    }
}

fn root<S: Scalar>(radicand: S) -> Option<S> {
    (radicand >= S::ZERO).then(|| radicand.sqrt())
}

fn angle<S: Scalar>(y: S, x: S) -> Option<S> {
    (x != S::ZERO || y != S::ZERO).then(|| y.atan2(x))
}
