//! What a function returns.

use fivebar_kinematics::five_bar::{GeometryError, PoseError, Singularity, Unreachable};

/// Whether a function has written its result; if not, why. A refused call writes nothing.
#[derive(Clone, Copy)]
#[repr(i32)]
pub enum Status {
    /// The result is written.
    Ok = 0,
    /// A pointer is null.
    NullPointer = 1,
    /// A side is neither FIVEBAR_LEFT nor FIVEBAR_RIGHT.
    NoSuchSide = 2,
    /// A number is infinite or not a number.
    NotFinite = 3,
    /// fivebar_geometry_... or fivebar_tool_... has not written this arm or tool, or has refused it.
    NotPrepared = 4,
    /// Length l1 is not a positive finite number.
    LengthL1 = 10,
    /// Length l2 is not a positive finite number.
    LengthL2 = 11,
    /// Length l3 is not a positive finite number.
    LengthL3 = 12,
    /// Length l4 is not a positive finite number.
    LengthL4 = 13,
    /// The base is not a finite number of 0 or more.
    LengthBase = 14,
    /// The longest length exceeds the sum of the other four: the loop cannot close.
    CannotAssemble = 15,
    /// The tool's offset is not finite, or puts the tool on B.
    ToolOffset = 16,
    /// The point is farther from A than leg 1 reaches.
    Leg1TooFar = 20,
    /// The point is nearer to A than leg 1 reaches.
    Leg1TooNear = 21,
    /// The point is farther from E than leg 4 reaches.
    Leg4TooFar = 22,
    /// The point is nearer to E than leg 4 reaches.
    Leg4TooNear = 23,
    /// The elbows B and D are farther apart than l2 + l3.
    ElbowsTooFar = 24,
    /// The elbows B and D are nearer than |l2 - l3|.
    ElbowsTooNear = 25,
    /// Leg 1 is straight or folded, or its end is on A: a singularity of type 1.
    SingularLeg1 = 30,
    /// Leg 4 is straight or folded, or its end is on E: a singularity of type 1.
    SingularLeg4 = 31,
    /// B, C and D are in line, or B meets D: a singularity of type 2.
    SingularParallel = 32,
}

impl From<GeometryError> for Status {
    fn from(error: GeometryError) -> Self {
        match error {
            GeometryError::NotPositive(0) => Self::LengthL1,
            GeometryError::NotPositive(1) => Self::LengthL2,
            GeometryError::NotPositive(2) => Self::LengthL3,
            GeometryError::NotPositive(3) => Self::LengthL4,
            GeometryError::NotPositive(_) => Self::LengthBase,
            GeometryError::ToolOffset => Self::ToolOffset,
            // The enum may gain errors; this one is of all five lengths.
            _ => Self::CannotAssemble,
        }
    }
}

impl From<PoseError> for Status {
    fn from(error: PoseError) -> Self {
        match error {
            PoseError::NotFinite => Self::NotFinite,
            PoseError::Unreachable(why) => match why {
                Unreachable::Leg1TooFar => Self::Leg1TooFar,
                Unreachable::Leg1TooNear => Self::Leg1TooNear,
                Unreachable::Leg4TooFar => Self::Leg4TooFar,
                Unreachable::Leg4TooNear => Self::Leg4TooNear,
                Unreachable::ElbowsTooFar => Self::ElbowsTooFar,
                Unreachable::ElbowsTooNear => Self::ElbowsTooNear,
            },
            PoseError::Singular(which) => match which {
                Singularity::Leg1 => Self::SingularLeg1,
                Singularity::Leg4 => Self::SingularLeg4,
                Singularity::Parallel => Self::SingularParallel,
            },
        }
    }
}
