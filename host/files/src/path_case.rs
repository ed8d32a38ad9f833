//! Path files: a path in JSON, with the limits of its plan.

use super::source::FileError;
use super::text_file::{LARGEST_TOML, read_text};
use fivebar_design::time_optimal::{FourierSeries, PathPiece, PlanLimits, Waypoints, blend};
use fivebar_kinematics::five_bar::{Side, WorkingMode};
use nalgebra::Vector2;
use serde::Deserialize;
use serde::de::IgnoredAny;
use std::path::Path;

/// What happens where two pieces of a path meet.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Corners {
    /// Each piece is a run of its own, from rest to rest.
    Stop,
    /// One run along the whole path, which stops only where the direction jumps.
    #[default]
    Smooth,
    /// As `Smooth`, with the corners between lines replaced by arcs.
    Blend,
}

/// A path and how it is to be run along.
#[derive(Clone, Debug)]
pub struct PathCase {
    /// Its name, if it has one.
    pub name: Option<String>,
    /// The robot that it is meant for, if the file names one.
    pub robot: Option<String>,
    /// Its pieces; with [`Corners::Blend`] the arcs are among them.
    pub path: Vec<PathPiece>,
    /// The sides to which the elbows turn.
    pub working_mode: WorkingMode,
    /// The limits; they replace the robot's.
    pub limits: PlanLimits,
    /// What happens between two pieces.
    pub corners: Corners,
    /// In place of the robot's gravity [m/s²].
    pub gravity: Option<[f64; 2]>,
    /// In place of the robot's payload [kg].
    pub payload: Option<f64>,
}

/// The file as written.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct CaseFile {
    name: Option<String>,
    robot: Option<String>,
    path: Vec<PieceFile>,
    working_mode: [Side; 2],
    limits: LimitsFile,
    #[serde(default)]
    corners: Corners,
    corner_tolerance: Option<f64>,
    gravity: Option<[f64; 2]>,
    payload: Option<f64>,
    // Results, which a list of reference cases has beside each path. They are not used.
    #[serde(rename = "optimal_time_s")]
    _optimal_time: Option<IgnoredAny>,
    #[serde(rename = "cross_checks_s")]
    _cross_checks: Option<IgnoredAny>,
    #[serde(rename = "runs")]
    _runs: Option<IgnoredAny>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct LimitsFile {
    torque: Option<[f64; 2]>,
    speed: Option<[f64; 2]>,
    acceleration: Option<[f64; 2]>,
    voltage: Option<f64>,
    tip_speed: Option<f64>,
    tip_acceleration: Option<f64>,
}

#[derive(Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
enum PieceFile {
    Line {
        from: [f64; 2],
        to: [f64; 2],
    },
    Arc {
        centre: [f64; 2],
        radius: f64,
        start: f64,
        sweep: f64,
    },
    Fourier {
        x: Series,
        y: Series,
    },
    Waypoints {
        points: Points,
    },
}

/// The points of a smooth curve.
#[derive(Deserialize)]
#[serde(try_from = "Vec<[f64; 2]>")]
struct Points(Waypoints);

impl TryFrom<Vec<[f64; 2]>> for Points {
    type Error = &'static str;

    fn try_from(points: Vec<[f64; 2]>) -> Result<Self, Self::Error> {
        let points: Vec<_> = points.into_iter().map(Vector2::from).collect();
        let reason =
            "`points` are two or more [x, y] in metres, none of them the same as the one before";
        Waypoints::new(&points).map(Self).ok_or(reason)
    }
}

/// `[mean, [a1, b1], [a2, b2], …]`.
#[derive(Deserialize)]
#[serde(try_from = "Vec<Term>")]
struct Series(FourierSeries);

#[derive(Deserialize)]
#[serde(untagged, expecting = "expected a number or a pair of numbers")]
enum Term {
    Mean(f64),
    Harmonic([f64; 2]),
}

impl TryFrom<Vec<Term>> for Series {
    type Error = &'static str;

    fn try_from(terms: Vec<Term>) -> Result<Self, Self::Error> {
        let mut terms = terms.into_iter();
        let Some(Term::Mean(mean)) = terms.next() else {
            return Err("a series begins with its mean, a number");
        };
        let harmonics = terms.map(|term| match term {
            Term::Harmonic(pair) => Ok(pair),
            Term::Mean(_) => Err("a series has pairs of numbers after its mean"),
        });
        let harmonics = harmonics.collect::<Result<_, _>>()?;
        Ok(Self(FourierSeries { mean, harmonics }))
    }
}

impl PathCase {
    /// Reads a path file.
    ///
    /// # Errors
    /// A file that cannot be read, and a missing key or a value that is not valid, with its line.
    pub fn read(path: &Path) -> Result<Self, FileError> {
        let text = read_text(path, LARGEST_TOML);
        let text = text.map_err(|error| FileError::new(path.display(), error))?;
        Self::parse(&path.display().to_string(), &text)
    }

    /// The path in the text of a file called `file`.
    ///
    /// # Errors
    /// A missing key, or a value that is not valid, with its line.
    pub fn parse(file: &str, text: &str) -> Result<Self, FileError> {
        let case: Result<CaseFile, _> = serde_json::from_str(text);
        let case = case.map_err(|error| FileError::new(file, error))?;
        let LimitsFile {
            torque,
            acceleration,
            tip_acceleration,
            ..
        } = &case.limits;
        if torque.is_none() && acceleration.is_none() && tip_acceleration.is_none() {
            let reason = "`limits` has no limit of forces or accelerations, so the arm would start and stop in no time: give \
                          `torque` [N·m], `acceleration` [rad/s²] or `tip_acceleration` [m/s²]";
            return Err(FileError::new(file, reason));
        }
        let tolerance = match (case.corners, case.corner_tolerance) {
            (Corners::Blend, Some(tolerance)) if tolerance > 0.0 => tolerance,
            (Corners::Blend, _) => {
                let reason = "`corners` is \"blend\": give a positive `corner_tolerance` [m]";
                return Err(FileError::new(file, reason));
            }
            _ => return Ok(case.into()),
        };
        let mut case = Self::from(case);
        case.path = blend(&case.path, tolerance);
        Ok(case)
    }
}

impl From<CaseFile> for PathCase {
    fn from(file: CaseFile) -> Self {
        let [elbow1, elbow4] = file.working_mode;
        let limits = file.limits;
        Self {
            name: file.name,
            robot: file.robot,
            path: file.path.into_iter().map(PathPiece::from).collect(),
            working_mode: WorkingMode::new(elbow1, elbow4),
            limits: PlanLimits {
                torque: limits.torque.unwrap_or([f64::INFINITY; 2]),
                falling_torque: None,
                speed: limits.speed.unwrap_or([f64::INFINITY; 2]),
                acceleration: limits.acceleration.unwrap_or([f64::INFINITY; 2]),
                voltage: limits.voltage,
                tip_speed: limits.tip_speed,
                tip_acceleration: limits.tip_acceleration,
            },
            corners: file.corners,
            gravity: file.gravity,
            payload: file.payload,
        }
    }
}

impl From<PieceFile> for PathPiece {
    fn from(piece: PieceFile) -> Self {
        match piece {
            PieceFile::Line { from, to } => Self::Line {
                from: Vector2::from(from),
                to: Vector2::from(to),
            },
            PieceFile::Arc {
                centre,
                radius,
                start,
                sweep,
            } => Self::Arc {
                centre: Vector2::from(centre),
                radius,
                start,
                sweep,
            },
            PieceFile::Fourier { x, y } => Self::Fourier { x: x.0, y: y.0 },
            PieceFile::Waypoints { points } => Self::Waypoints(points.0),
        }
    }
}
