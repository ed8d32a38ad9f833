//! What the slider-driven mechanism cannot do, by name.

use core::fmt;

/// One of the two limbs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Limb {
    /// Links 3 and 4, from slider 2.
    Left,
    /// Links 6 and 7, from slider 8.
    Right,
}

/// Why three numbers are not this mechanism.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GeometryError {
    /// A limb's length is not a positive finite number.
    Limb(Limb),
    /// The platform's width is negative or not finite.
    Platform,
}

/// Why a pose or a motion cannot be given.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PoseError {
    /// P is farther from the guide than a limb is long.
    LimbTooShort(Limb),
    /// The sliders are farther apart than both limbs and the platform reach.
    SlidersTooFar,
    /// The limbs' circles lie one inside the other.
    SlidersTooNear,
    /// The sliders' travel does not let them stand as far apart, or as near, as asked.
    BeyondTravel,
    /// Type 1: a limb stands square to the guide, its slider's place says nothing of y.
    LimbPerpendicular(Limb),
    /// Type 2: the limbs are parallel, or in line along the guide; the sliders do not
    /// hold P.
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
                write!(f, "P is farther from the guide than {limb} is long")
            }
            Self::SlidersTooFar => {
                f.write_str("the sliders are farther apart than limbs and platform reach")
            }
            Self::SlidersTooNear => {
                f.write_str("the sliders are too near for limbs of these lengths to meet")
            }
            Self::BeyondTravel => f.write_str("the sliders' travel does not allow this height"),
            Self::LimbPerpendicular(limb) => {
                write!(f, "{limb} stands square to the guide (type 1)")
            }
            Self::Parallel => f.write_str("the limbs are parallel or in line (type 2)"),
            Self::NotFinite => f.write_str("a number given is infinite or not a number"),
        }
    }
}

impl core::error::Error for GeometryError {}
impl core::error::Error for PoseError {}
