//! Why a log is refused.

use core::fmt;
use fivebar_kinematics::five_bar::Joint;

/// Why a log does not identify an arm.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum IdentificationError {
    /// The log lasts this long [s]; at least half a second is needed.
    TooShort(f64),
    /// It has more rows than this.
    TooLong(usize),
    /// A value of this row, from 1, is not finite.
    NotFinite(usize),
    /// Between this row, from 1, and the next this time passes [s].
    Gap(usize, f64),
    /// The rows come at the first rate, the robot file gives the second [Hz].
    Rate(f64, f64),
    /// The angle of this joint jumps behind this row, from 1.
    Jump(Joint, usize),
    /// This joint turns by this angle [rad] only.
    Still(Joint, f64),
    /// The current of this joint is at its limit in this many rows.
    Saturated(Joint, usize),
    /// The angles are those of the other joints.
    SwappedAngles,
    /// In this share of the rows the arm has no pose in its working mode.
    OtherMode(f64),
    /// The currents are those of the other joints.
    SwappedCurrents,
    /// With these torques the arm has no positive inertia.
    Reversed,
    /// The motion does not determine these parameters; with the condition.
    NotSeen(Vec<String>, f64),
    /// The payload would be this mass, with this deviation [kg].
    NoPayload(f64, f64),
    /// This share of the torques of a second log is not predicted.
    Unpredicted(f64),
    /// This share of the torque of this joint is not explained.
    Unexplained(Joint, f64),
}

impl fmt::Display for IdentificationError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TooShort(time) => write!(
                f,
                "the log lasts {time:.3} s; an identification needs 0.5 s at least, and ten periods \
                 of an excitation for a good one (--propose)"
            ),
            Self::TooLong(rows) => write!(f, "the log has more than {rows} rows: cut it"),
            Self::NotFinite(row) => write!(f, "row {row} has a value that is not finite"),
            Self::Gap(row, time) => write!(
                f,
                "the log has a gap: {:.4} ms pass behind row {row}; record every tick",
                1e3 * time
            ),
            Self::Rate(found, wanted) => write!(
                f,
                "the log has {found:.1} rows a second, but the robot file's tick_rate is \
                 {wanted:.1} Hz: record every tick, or correct the file"
            ),
            Self::Jump(joint, row) => {
                write!(f, "the angle of {joint} jumps behind row {row}")
            }
            Self::Still(joint, range) => write!(
                f,
                "{joint} never moves (its angle changes by {:.2} mrad): excite both joints",
                1e3 * range
            ),
            Self::Saturated(joint, rows) => write!(
                f,
                "the current of {joint} is saturated, at its limit in {rows} rows: use a \
                 smaller or slower excitation"
            ),
            Self::SwappedAngles => f.write_str(
                "the joints are swapped: theta1_rad and theta4_rad fit the arm if they are \
                 exchanged",
            ),
            Self::OtherMode(share) => write!(
                f,
                "in {:.0} % of the rows the arm has no pose in the robot file's working mode: the \
                 angles are of another arm or mode, or their zeros are wrong (calibrate first)",
                1e2 * share
            ),
            Self::SwappedCurrents => f.write_str(
                "the joints are swapped: current1_a and current4_a explain the motion if they are \
                 exchanged",
            ),
            Self::Reversed => f.write_str(
                "with these currents the arm would have a negative inertia: a current has the \
                 wrong sign (positive currents turn their joint forwards), or the columns are \
                 exchanged",
            ),
            Self::NoPayload(mass, sd) => write!(
                f,
                "the payload would be {:.1} ± {:.1} g: move faster, or check the masses of the \
                 robot file (identify without --payload finds them)",
                1e3 * mass,
                1e3 * sd
            ),
            Self::NotSeen(names, condition) => write!(
                f,
                "this motion does not determine {} (condition {condition:.0}): excite both joints \
                 faster and farther (--propose)",
                names.join(", ")
            ),
            Self::Unpredicted(share) => write!(
                f,
                "{:.0} % of its torques are not predicted by what the first log gave: it is of another \
                 arm, or its currents have other signs or columns",
                1e2 * share
            ),
            Self::Unexplained(joint, share) => write!(
                f,
                "{:.0} % of the torque of {joint} stays unexplained by masses and friction: \
                 the columns, the torque constant's joint, the lengths or the zeros are wrong",
                1e2 * share
            ),
        }
    }
}

impl core::error::Error for IdentificationError {}
