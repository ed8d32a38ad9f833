//! A configuration of the arm: where its joints are and which way its links point.

use super::{Side, WorkingMode};
use crate::{PlanarVector, Scalar};
use nalgebra::Vector2;

/// A closed configuration of the five-bar.
///
/// Directions are unit vectors, because velocities and forces need sines and cosines and
/// seldom the angles.
///
/// ```
/// use fivebar_kinematics::five_bar::{Geometry, Side, WorkingMode};
/// use fivebar_kinematics::nalgebra::Vector2;
///
/// let geometry = Geometry::new([0.10_f64, 0.16, 0.16, 0.10, 0.08])?;
/// let pose = geometry.inverse(Vector2::new(0.04, 0.20), WorkingMode::new(Side::Right, Side::Left))?;
/// // C is on the arm's axis of symmetry, above the elbows.
/// let [theta1, _, _, theta4] = pose.angles();
/// assert!((theta1 + theta4 - core::f64::consts::PI).abs() < 1e-15);
/// assert_eq!(pose.assembly(), Side::Left);
/// assert!(((pose.c - pose.b).norm() - 0.16).abs() < 1e-15);
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose<S> {
    /// u(θ1), A to B.
    pub u1: Vector2<S>,
    /// u(θ2), B to C.
    pub u2: Vector2<S>,
    /// u(θ3), D to C.
    pub u3: Vector2<S>,
    /// u(θ4), E to D.
    pub u4: Vector2<S>,
    /// Elbow of leg 1 [m].
    pub b: Vector2<S>,
    /// Where links 2 and 3 meet [m]; also the tool, unless it has an offset.
    pub c: Vector2<S>,
    /// Elbow of leg 4 [m].
    pub d: Vector2<S>,
}

impl<S: Scalar> Pose<S> {
    /// θ1, θ2, θ3, θ4 [rad], each in (−π, π].
    #[inline]
    pub fn angles(&self) -> [S; 4] {
        [
            self.u1.polar_angle(),
            self.u2.polar_angle(),
            self.u3.polar_angle(),
            self.u4.polar_angle(),
        ]
    }

    /// The forward branch: `Left` where C lies left of the ray B→D.
    #[inline]
    pub fn assembly(&self) -> Side {
        Side::of((self.d - self.b).cross_z(self.c - self.b))
    }

    /// The inverse branch of C: which way each elbow turns, leg 1 being A–B–C. That of an
    /// offset tool: [`Tool::working_mode`](super::Tool::working_mode).
    #[inline]
    pub fn working_mode(&self) -> WorkingMode {
        WorkingMode::new(Side::of(self.sin21()), Side::of(self.sin34()))
    }

    /// sin(θ2−θ1): zero where leg 1 is straight or folded (type 1).
    #[inline]
    pub fn sin21(&self) -> S {
        self.u1.cross_z(self.u2)
    }

    /// sin(θ3−θ4): zero where leg 4 is straight or folded (type 1).
    #[inline]
    pub fn sin34(&self) -> S {
        self.u4.cross_z(self.u3)
    }

    /// sin(θ3−θ2): zero where B, C, D are in line or B meets D (type 2).
    #[inline]
    pub fn sin32(&self) -> S {
        self.u2.cross_z(self.u3)
    }
}
