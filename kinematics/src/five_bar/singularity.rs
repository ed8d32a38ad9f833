//! The distance of a pose from its singularities, as an angle and as a length.

use super::{Geometry, Pose, Singularity, Tool};
use crate::{PlanarVector, Scalar};
use nalgebra::Vector2;

/// Distance from one singularity.
///
/// ```
/// use fivebar_kinematics::five_bar::{Geometry, Side, WorkingMode};
/// use fivebar_kinematics::nalgebra::Vector2;
///
/// let geometry = Geometry::new([0.10_f64, 0.16, 0.16, 0.10, 0.08])?;
/// let c = Vector2::new(0.04, 0.20);
/// let pose = geometry.inverse(c, WorkingMode::new(Side::Right, Side::Left))?;
/// // C can move by l1 + l2 − |AC| = 56 mm before leg 1 is straight.
/// let leg1 = geometry.clearances(&pose).leg1;
/// assert!((leg1.length - (0.26 - c.norm())).abs() < 1e-15);
/// assert!((leg1.sine - pose.sin21().abs()).abs() < 1e-15);
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clearance<S> {
    /// |sin| of the angle that is 0 or π at the singularity, 0…1.
    pub sine: S,
    /// The least change of the distance between the dyad's ends that brings its links in line
    /// [m].
    pub length: S,
}

/// Distances from the three singularities of a pose.
///
/// ```
/// use fivebar_kinematics::five_bar::{Geometry, Side, WorkingMode};
/// use fivebar_kinematics::nalgebra::Vector2;
///
/// let geometry = Geometry::new([0.10_f64, 0.16, 0.16, 0.10, 0.08])?;
/// let outwards = WorkingMode::new(Side::Right, Side::Left);
/// let near = geometry.clearances(&geometry.inverse(Vector2::new(0.04, 0.20), outwards)?);
/// let far = geometry.clearances(&geometry.inverse(Vector2::new(0.04, 0.25), outwards)?);
/// // Both legs straighten as C moves away from the base.
/// assert!(far.leg1.sine < near.leg1.sine && far.leg4.sine < near.leg4.sine);
/// assert!((near.leg1.length - far.leg1.length - 0.0492).abs() < 1e-4); // m
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clearances<S> {
    /// Type 1 of leg A–B–C; C can move by at least this length.
    pub leg1: Clearance<S>,
    /// Type 1 of leg E–D–C; C can move by at least this length.
    pub leg4: Clearance<S>,
    /// Type 2, dyad B–C–D; the distance of the elbows can change by this length.
    pub parallel: Clearance<S>,
}

impl<S: Scalar> Geometry<S> {
    /// The distance of the pose from each singularity.
    pub fn clearances(&self, pose: &Pose<S>) -> Clearances<S> {
        let of = |sine: S, ends: Vector2<S>, first: S, second: S| {
            let distance = ends.length();
            let outwards = first + second - distance;
            let inwards = distance - (first - second).abs();
            let length = if outwards < inwards {
                outwards
            } else {
                inwards
            };
            Clearance {
                sine: sine.abs(),
                // Rounding can make the length of a straight dyad negative.
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
        nearest([self.sin21(), self.sin34(), self.sin32()])
    }
}

impl<S: Scalar> Tool<S> {
    /// The singularity whose sine is smallest, and |sine|, leg 1 being A–B–T.
    #[inline]
    pub fn nearest_singularity(&self, pose: &Pose<S>) -> (Singularity, S) {
        let [sine1, sine4] = self.elbow_sines(pose);
        nearest([sine1, sine4, pose.sin32()])
    }
}

/// The smallest of the sines of leg 1, leg 4 and the parallel dyad, by magnitude.
#[inline]
fn nearest<S: Scalar>([sine1, sine4, sine32]: [S; 3]) -> (Singularity, S) {
    let mut nearest = (Singularity::Leg1, sine1.abs());
    if sine4.abs() < nearest.1 {
        nearest = (Singularity::Leg4, sine4.abs());
    }
    if sine32.abs() < nearest.1 {
        nearest = (Singularity::Parallel, sine32.abs());
    }
    nearest
}
