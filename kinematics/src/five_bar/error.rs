//! Errors of lengths, poses and motions.

use core::fmt;

/// Why lengths or an offset of the tool are refused.
///
/// ```
/// use fivebar_kinematics::five_bar::{Geometry, GeometryError};
///
/// let negative = Geometry::new([0.10_f64, 0.16, -0.16, 0.10, 0.08]);
/// assert_eq!(negative, Err(GeometryError::NotPositive(2)));
/// let open = Geometry::new([0.10_f64, 0.16, 0.16, 0.10, 0.90]);
/// assert_eq!(open, Err(GeometryError::CannotAssemble));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum GeometryError {
    /// Length `0..=4` (l1…l4, base) is not a positive finite number; the base may be 0.
    NotPositive(usize),
    /// The longest length exceeds the sum of the others: the loop cannot close.
    CannotAssemble,
    /// The tool's offset from C is not finite, or puts the tool on B.
    ToolOffset,
}

/// Why no pose exists.
///
/// ```
/// use fivebar_kinematics::five_bar::{Geometry, PoseError, Side, Unreachable};
///
/// // With both driven links pointing outwards, B and D are 0.50 m apart: 0.18 m too far.
/// let geometry = Geometry::new([0.10_f64, 0.16, 0.16, 0.10, 0.30])?;
/// let pose = geometry.forward(core::f64::consts::PI, 0.0, Side::Left);
/// assert_eq!(pose, Err(PoseError::Unreachable(Unreachable::ElbowsTooFar)));
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Unreachable {
    /// C is farther from A than l1 + l2.
    Leg1TooFar,
    /// C is nearer to A than |l1 − l2|.
    Leg1TooNear,
    /// C is farther from E than l4 + l3.
    Leg4TooFar,
    /// C is nearer to E than |l4 − l3|.
    Leg4TooNear,
    /// B and D are farther apart than l2 + l3.
    ElbowsTooFar,
    /// B and D are nearer than |l2 − l3|.
    ElbowsTooNear,
}

/// A singularity: the arm loses (type 1) or gains (type 2) a degree of freedom.
///
/// ```
/// use fivebar_kinematics::five_bar::{Geometry, Side, Singularity, WorkingMode};
/// use fivebar_kinematics::nalgebra::Vector2;
///
/// // C is 0.2598 m from A, 0.2 mm short of a straight leg 1.
/// let geometry = Geometry::new([0.10_f64, 0.16, 0.20, 0.10, 0.08])?;
/// let outwards = WorkingMode::new(Side::Right, Side::Left);
/// let pose = geometry.inverse(Vector2::new(0.0, 0.2598), outwards)?;
/// let (singularity, sine) = pose.nearest_singularity();
/// assert_eq!(singularity, Singularity::Leg1);
/// assert!(sine < 0.1);
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Singularity {
    /// Type 1: A, B, C in line, sin(θ2−θ1) = 0.
    Leg1,
    /// Type 1: E, D, C in line, sin(θ3−θ4) = 0.
    Leg4,
    /// Type 2: B, C, D in line or B = D, sin(θ3−θ2) = 0.
    Parallel,
}

/// Why a pose or a motion does not exist.
///
/// ```
/// use fivebar_kinematics::five_bar::{Geometry, PoseError, Side, Unreachable, WorkingMode};
/// use fivebar_kinematics::nalgebra::Vector2;
///
/// let geometry = Geometry::new([0.10_f64, 0.16, 0.16, 0.10, 0.08])?;
/// let outwards = WorkingMode::new(Side::Right, Side::Left);
/// let error = geometry.inverse(Vector2::new(0.04, 0.50), outwards).unwrap_err();
/// assert_eq!(error, PoseError::Unreachable(Unreachable::Leg1TooFar));
/// assert_eq!(error.to_string(), "the point is farther from A than l1 + l2");
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum PoseError {
    /// No pose exists.
    Unreachable(Unreachable),
    /// The answer is not unique or not finite here.
    Singular(Singularity),
    /// An input is infinite or not a number.
    NotFinite,
}

impl fmt::Display for GeometryError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotPositive(4) => {
                f.write_str("length base must be a finite number of metres, 0 or more")
            }
            Self::NotPositive(index) => {
                let name = ["l1", "l2", "l3", "l4"].get(*index).unwrap_or(&"?");
                write!(
                    f,
                    "length {name} must be a positive finite number of metres"
                )
            }
            Self::CannotAssemble => {
                f.write_str("the longest length exceeds the sum of the other four")
            }
            Self::ToolOffset => {
                f.write_str("the tool's offset must be finite and not put the tool on B")
            }
        }
    }
}

impl fmt::Display for Unreachable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Leg1TooFar => "the point is farther from A than l1 + l2",
            Self::Leg1TooNear => "the point is nearer to A than |l1 − l2|",
            Self::Leg4TooFar => "the point is farther from E than l4 + l3",
            Self::Leg4TooNear => "the point is nearer to E than |l4 − l3|",
            Self::ElbowsTooFar => "the elbows B and D are farther apart than l2 + l3",
            Self::ElbowsTooNear => "the elbows B and D are nearer than |l2 − l3|",
        })
    }
}

impl fmt::Display for Singularity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Leg1 => "leg A–B–C is straight or folded (type 1)",
            Self::Leg4 => "leg E–D–C is straight or folded (type 1)",
            Self::Parallel => "B, C and D are in line, or B meets D (type 2)",
        })
    }
}

impl fmt::Display for PoseError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unreachable(why) => why.fmt(f),
            Self::Singular(which) => which.fmt(f),
            Self::NotFinite => f.write_str("a number given is infinite or not a number"),
        }
    }
}

impl core::error::Error for GeometryError {}
impl core::error::Error for PoseError {}
