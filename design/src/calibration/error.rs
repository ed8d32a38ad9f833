//! Why points are refused.

use core::fmt;

/// Why points on a plate do not give a calibration.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum CalibrationError {
    /// A value is not finite, or the standard deviation is not positive.
    NotFinite,
    /// There are this many different poses; ten unknowns need five.
    TooFew(usize),
    /// The holes lie on one line.
    Collinear,
    /// The nominal lengths do not make an arm.
    Lengths,
    /// These unknowns cannot be told apart by the points: their names, with the rank.
    NotSeen(Vec<&'static str>, usize),
    /// The points fit the other assembly mode only.
    OtherAssembly,
    /// The points fit if the columns of the two joints are exchanged.
    SwappedJoints,
    /// The points fit no arm: half of them are farther from the fit than this [m].
    NoFit(f64),
    /// The points fit an arm with this length of link or base (1 to 5), far from the nominal
    /// one [m].
    OtherArm {
        /// 1 to 4 for the links, 5 for the base.
        number: usize,
        /// As found [m].
        found: f64,
        /// As in the robot file [m].
        nominal: f64,
    },
}

impl fmt::Display for CalibrationError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotFinite => f.write_str(
                "all counts and coordinates must be finite, and the holes' standard deviation \
                 positive",
            ),
            Self::TooFew(count) => write!(
                f,
                "too few points: {count} different poses; the ten unknowns need at least 5, and 12 \
                 spread over the workspace for a good calibration (--propose 12 lists such poses)"
            ),
            Self::Collinear => f.write_str(
                "the holes are collinear: on one line they do not determine the arm; use holes \
                 spread over the workspace (--propose 12 lists such poses)",
            ),
            Self::Lengths => f.write_str("the lengths of the robot file do not make an arm"),
            Self::NotSeen(names, rank) => write!(
                f,
                "these points do not determine {} (rank {rank} of 10): use holes spread over the \
                 workspace (--propose 12 lists such poses)",
                names.join(", ")
            ),
            Self::OtherAssembly => f.write_str(
                "the points were measured in the other assembly mode: C lies on the other side of \
                 the line from B to D than the robot file's `working_mode` and `home` say; measure \
                 in the mode of the robot file, or correct the file",
            ),
            Self::SwappedJoints => f.write_str(
                "the joints are swapped: the points fit if counts1 and counts4 are exchanged; \
                 exchange the columns, or the encoders' wires",
            ),
            Self::NoFit(distance) => write!(
                f,
                "the points fit no arm in this assembly mode: half of them are more than {:.1} mm \
                 from the best fit; check the counts per turn, the order of the columns, the \
                 units (metres) and the arm",
                1e3 * distance
            ),
            Self::OtherArm {
                number,
                found,
                nominal,
            } => {
                let part = match number {
                    5 => "the base".to_owned(),
                    link => format!("link {link}"),
                };
                write!(
                    f,
                    "the points are of another arm: they give {part} a length of {:.2} mm, the \
                     robot file {:.2} mm",
                    1e3 * found,
                    1e3 * nominal
                )
            }
        }
    }
}

impl core::error::Error for CalibrationError {}
