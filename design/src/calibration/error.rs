//! Why points are refused.

use core::fmt;

/// Why points on a plate do not give a calibration.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum CalibrationError {
    /// A value is not finite, or the standard deviation is not positive.
    NotFinite,
    /// There are this many different poses; the unknowns need five.
    TooFew(usize),
    /// The holes lie on one line.
    Collinear,
    /// The nominal lengths do not make an arm.
    Lengths,
    /// The points do not determine these unknowns.
    NotSeen {
        /// Their names.
        names: Vec<&'static str>,
        /// The rank of the Jacobian.
        rank: usize,
        /// How many unknowns there are.
        unknowns: usize,
    },
    /// No known length: all lengths may grow together.
    NoScale,
    /// The length of the bar with this index is not positive.
    BarLength(usize),
    /// This hole is touched in one pose only.
    LoneTouch(i64),
    /// The photograph with this index has points in this many poses.
    SmallPhoto(usize, usize),
    /// There are one or two holes of a plate among other measurements.
    SmallPlate(usize),
    /// Too many measurements of one kind are farther than 4 σ from the fit to all.
    Contradicts {
        /// The kind.
        kind: String,
        /// How many are far from the fit.
        far: usize,
        /// Of how many.
        of: usize,
    },
    /// The others contradict so many measurements of one kind that it is open which are wrong.
    TooManyWrong {
        /// What was measured: `plate`, `bars`, `holes`, `photo 1` and so on.
        kind: String,
        /// The rows that would be left out, by their index from 0.
        rows: Vec<usize>,
        /// Of how many.
        of: usize,
    },
    /// The measurements fit no arm: half of them are farther from the fit than this many σ.
    MixedNoFit(f64),
    /// The points fit the other assembly mode only.
    OtherAssembly,
    /// The points fit if the columns of the two joints are exchanged.
    SwappedJoints,
    /// The points fit the other assembly mode only, or if the columns are exchanged: an arm without a base does not tell
    /// which.
    OtherAssemblyOrSwappedJoints,
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
    #[expect(clippy::too_many_lines, reason = "a list of sentences")]
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotFinite => f.write_str(
                "all counts and coordinates must be finite, and the holes' standard deviation \
                 positive",
            ),
            Self::TooFew(count) => write!(
                f,
                "too few points: {count} different poses; the arm and its place need at least 5, and 12 \
                 spread over the workspace for a good calibration (--propose 12 lists such poses)"
            ),
            Self::Collinear => f.write_str(
                "the holes are collinear: on one line they do not determine the arm; use holes \
                 spread over the workspace (--propose 12 lists such poses)",
            ),
            Self::Lengths => f.write_str("the lengths of the robot file do not make an arm"),
            Self::NotSeen {
                names,
                rank,
                unknowns,
            } => write!(
                f,
                "these points do not determine {} (rank {rank} of {unknowns}): use holes spread over the \
                 workspace (--propose 12 lists such poses)",
                names.join(", ")
            ),
            Self::NoScale => f.write_str(
                "no known length: scale is not seen; unknown holes and photographs need at least \
                 one distance (--bars) or a plate (--points) besides them",
            ),
            Self::BarLength(index) => write!(
                f,
                "row {} of the bars: the length must be positive and finite",
                index + 1
            ),
            Self::LoneTouch(hole) => write!(
                f,
                "hole {hole} is touched in one pose: an unknown hole tells something only if it is touched \
                 in two working modes or more"
            ),
            Self::SmallPhoto(index, count) => write!(
                f,
                "photograph {} has points of {count} poses: its place takes four, so give at least five, and \
                 better twenty",
                index + 1
            ),
            Self::SmallPlate(count) => write!(
                f,
                "{count} hole{} of a plate: its place takes two, so give at least three, or none",
                if *count == 1 { "" } else { "s" }
            ),
            Self::Contradicts { kind, far, of } => write!(
                f,
                "{kind}: {far} of {of} rows are farther than 4 σ from the fit to all measurements: \
                 this table, or another, is not of this arm; check its units (metres), its columns and \
                 its stated deviation, and try the tables one by one"
            ),
            Self::TooManyWrong { kind, rows, of } => too_many_wrong(f, kind, rows, *of),
            Self::MixedNoFit(sigmas) => no_fit(
                f,
                "measurements fit",
                sigmas.is_finite().then(|| format!("{sigmas:.0} σ")),
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
            Self::OtherAssemblyOrSwappedJoints => f.write_str(
                "the points fit the other assembly mode only: C lies on the other side of the line from B to D than the \
                 robot file's `working_mode` and `home` say, or counts1 and counts4 are exchanged (with both hips about \
                 one axis the points do not tell which); check the columns and the encoders' wires, then measure in the \
                 mode of the robot file, or correct the file",
            ),
            Self::NoFit(distance) => no_fit(
                f,
                "points fit",
                distance
                    .is_finite()
                    .then(|| format!("{:.1} mm", 1e3 * distance)),
            ),
            Self::OtherArm {
                number,
                found,
                nominal,
            } => other_arm(f, *number, [*found, *nominal]),
        }
    }
}

fn too_many_wrong(
    f: &mut fmt::Formatter<'_>,
    kind: &str,
    rows: &[usize],
    of: usize,
) -> fmt::Result {
    let numbers: Vec<_> = rows.iter().map(|row| (row + 1).to_string()).collect();
    write!(
        f,
        "{kind}: rows {}, {} of {of}, contradict the others: these are more than a quarter, so the rows do not \
         tell which are wrong; measure those named again, then the others",
        numbers.join(", "),
        rows.len()
    )
}

/// `far` is the distance of half of the rows from the best fit, if there is a fit.
fn no_fit(f: &mut fmt::Formatter<'_>, what: &str, far: Option<String>) -> fmt::Result {
    let why = match far {
        Some(far) => format!("half of them are more than {far} from the best fit"),
        None => "the robot file's arm has too few of the poses".into(),
    };
    write!(
        f,
        "the {what} no arm in this assembly mode: {why}; check the counts per turn, the order of the columns, the \
         units (metres) and the arm"
    )
}

fn other_arm(f: &mut fmt::Formatter<'_>, number: usize, [found, nominal]: [f64; 2]) -> fmt::Result {
    let part = match number {
        5 => "the base".to_owned(),
        link => format!("link {link}"),
    };
    write!(
        f,
        "the points are of another arm: they give {part} a length of {:.2} mm, the robot file \
         {:.2} mm",
        1e3 * found,
        1e3 * nominal
    )
}

impl core::error::Error for CalibrationError {}
