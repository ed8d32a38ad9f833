//! The branches: which of the mirrored solutions the arm has.

use core::fmt;

/// Left or right of a directed line, seen with the plane's normal towards the viewer.
///
/// ```
/// use fivebar_kinematics::PlanarVector;
/// use fivebar_kinematics::five_bar::Side;
/// use fivebar_kinematics::nalgebra::Vector2;
///
/// let (x_axis, up) = (Vector2::new(1.0, 0.0), Vector2::new(0.2, 0.7));
/// assert_eq!(Side::of(x_axis.cross_z(up)), Side::Left);
/// assert_eq!(Side::Left.opposite(), Side::Right);
/// assert_eq!(Side::Right.sign(0.3), -0.3);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
// The numbers are the sign bits of `f32`: the tick gives a value its sign without a branch.
#[repr(u32)]
pub enum Side {
    /// To the left: the cross product is positive.
    Left = 0,
    /// To the right: the cross product is negative.
    Right = 1 << 31,
}

impl Side {
    /// Both sides.
    pub const BOTH: [Self; 2] = [Self::Left, Self::Right];

    /// The side on which a cross product says the second vector lies.
    #[inline]
    pub fn of<S: crate::Scalar>(cross: S) -> Self {
        if cross > S::ZERO {
            Self::Left
        } else {
            Self::Right
        }
    }

    /// `value` on the left, −`value` on the right.
    #[inline]
    pub fn sign<S: crate::Scalar>(self, value: S) -> S {
        value.xor_sign(self as u32)
    }

    /// The other side.
    #[inline]
    #[must_use]
    pub fn opposite(self) -> Self {
        match self {
            Self::Left => Self::Right,
            Self::Right => Self::Left,
        }
    }
}

impl fmt::Display for Side {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Left => "left",
            Self::Right => "right",
        })
    }
}

/// Which way each leg's elbow turns: the branch of the inverse solution.
///
/// Leg 1 ends in the point P that the solution places: the tool T of a [`Tool`], C of a
/// [`Geometry`], which has no tool. Where T is offset from C, one pose can have a mode of T
/// and another of C; [`Tool::working_mode`] and [`Pose::working_mode`] give them.
///
/// ```
/// use fivebar_kinematics::five_bar::{Geometry, WorkingMode};
/// use fivebar_kinematics::nalgebra::Vector2;
///
/// let geometry = Geometry::new([0.10_f64, 0.16, 0.16, 0.10, 0.08])?;
/// for mode in WorkingMode::ALL {
///     let pose = geometry.inverse(Vector2::new(0.06, 0.18), mode)?;
///     assert_eq!(pose.working_mode(), mode);
/// }
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
///
/// [`Geometry`]: super::Geometry
/// [`Pose::working_mode`]: super::Pose::working_mode
/// [`Tool`]: super::Tool
/// [`Tool::working_mode`]: super::Tool::working_mode
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct WorkingMode {
    /// `Left` where AB×BP > 0.
    pub elbow1: Side,
    /// `Left` where ED×DC > 0.
    pub elbow4: Side,
}

impl WorkingMode {
    /// All four working modes.
    pub const ALL: [Self; 4] = [
        Self::new(Side::Left, Side::Left),
        Self::new(Side::Left, Side::Right),
        Self::new(Side::Right, Side::Left),
        Self::new(Side::Right, Side::Right),
    ];

    /// The mode with these elbows.
    pub const fn new(elbow1: Side, elbow4: Side) -> Self {
        Self { elbow1, elbow4 }
    }
}
