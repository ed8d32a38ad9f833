//! Why the slider-driven mechanism has no pose or motion.

use core::fmt;

/// One of the two limbs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Limb {
    /// Links 3 and 4, from slider 2.
    Left,
    /// Links 6 and 7, from slider 8.
    Right,
}

/// Why the lengths are invalid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum GeometryError {
    /// A limb's length is not a positive finite number.
    Limb(Limb),
    /// The platform's width is negative or not finite.
    Platform,
}

/// Why a pose or a motion does not exist.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PoseError {
    /// The distance of P from the guide exceeds a limb's length.
    LimbTooShort(Limb),
    /// The sliders are farther apart than both limbs and the platform reach.
    SlidersTooFar,
    /// The sliders are so near that one limb's circle lies inside the other's.
    SlidersTooNear,
    /// The distance between the sliders that this height needs is beyond their travel.
    BeyondTravel,
    /// Type 1: a limb is perpendicular to the guide; its slider cannot move P along y.
    LimbPerpendicular(Limb),
    /// Type 2: the limbs are parallel, or in line along the guide; the sliders cannot hold P.
    Parallel,
    /// An input is infinite or not a number.
    NotFinite,
}

impl fmt::Display for Limb {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Left => "the left limb (l3)",
            Self::Right => "the right limb (l7)",
        })
    }
}

impl fmt::Display for GeometryError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Limb(limb) => write!(f, "{limb} must be a positive finite number of metres"),
            Self::Platform => f.write_str("the platform (l5) must be finite and not negative"),
        }
    }
}

impl fmt::Display for PoseError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::LimbTooShort(limb) => {
                write!(f, "the distance of P from the guide exceeds {limb}")
            }
            Self::SlidersTooFar => {
                f.write_str("the sliders are farther apart than limbs and platform reach")
            }
            Self::SlidersTooNear => {
                f.write_str("the sliders are too near for limbs of these lengths to meet")
            }
            Self::BeyondTravel => f.write_str("the sliders' travel does not allow this height"),
            Self::LimbPerpendicular(limb) => {
                write!(
                    f,
                    "{limb} is perpendicular to the guide (type 1 singularity)"
                )
            }
            Self::Parallel => f.write_str("the limbs are parallel or in line (type 2 singularity)"),
            Self::NotFinite => f.write_str("an input is infinite or not a number"),
        }
    }
}

impl core::error::Error for GeometryError {}
impl core::error::Error for PoseError {}
