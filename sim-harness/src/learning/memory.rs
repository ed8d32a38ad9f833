//! What was learnt, as a file: the path with its shift by place, and what it belongs to.
//!
//! It holds for one robot with its payload and settings under one control law, and for one job at one place. A digest
//! of each tells whether they are still the same; otherwise what was learnt is forgotten.

use super::LearningError;
use super::shift::Learnt;
use super::spline::{LEAST, Spline};
use super::timed_path::{Mark, Motion, TimedPath};
use fivebar_files::robot::Robot;
use fivebar_files::scenario::Scenario;
use fivebar_firmware::Move;
use nalgebra::Vector2;
use serde::{Deserialize, Serialize};
use std::fmt::{self, Write};

/// The version of the file.
const VERSION: u32 = 1;

/// What a shift belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Digest {
    /// Of the robot, its payload and its settings.
    robot: u64,
    /// Of the job's moves.
    job: u64,
}

/// FNV-1a over what a value shows of itself.
struct Fnv(u64);

impl Write for Fnv {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        for byte in text.bytes() {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
        Ok(())
    }
}

fn digest(value: &impl fmt::Debug) -> u64 {
    let mut hash = Fnv(0xcbf2_9ce4_8422_2325);
    // It cannot fail.
    let _ = write!(hash, "{value:?}");
    hash.0
}

impl Digest {
    /// Of a scenario whose job has these moves.
    ///
    /// # Errors
    /// The robot has no masses.
    pub(super) fn new(scenario: &Scenario, moves: &[Move]) -> Result<Self, LearningError> {
        let robot = &scenario.robot;
        let settings = robot.settings()?;
        Ok(Self {
            robot: digest(&(settings, robot.actuators, scenario.control_law)),
            job: digest(&moves),
        })
    }
}

/// A shift that was learnt.
#[derive(Clone, Debug, PartialEq)]
pub struct Memory {
    pub(super) digest: Digest,
    pub(super) learnt: Learnt,
}

/// Why a shift of before is not used.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Forgotten {
    /// The robot is another one.
    #[error("the robot, its payload or its settings have changed since")]
    Robot,
    /// The job is another one.
    #[error("the job, its place or its speed has changed since")]
    Job,
    /// The file is not one of this program.
    #[error("the file cannot be read: {0}")]
    File(String),
}

/// The file.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    version: u32,
    digest: Digest,
    /// Ticks between two knots.
    knot_ticks: usize,
    lead: Vec<Move>,
    motions: Vec<MotionFile>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct MotionFile {
    rest_s: f64,
    marks: Vec<Mark>,
    /// Distance along the path, the tool's place there and its shift [m].
    place_x_y_dx_dy_m: Vec<[f64; 5]>,
}

impl Memory {
    /// The greatest shift [m].
    pub fn greatest(&self) -> f64 {
        self.learnt.greatest()
    }

    /// As JSON.
    ///
    /// # Errors
    /// It never fails with numbers that are finite.
    pub fn to_json(&self) -> serde_json::Result<String> {
        let path = &self.learnt.path;
        let places = path.places();
        let rows = path.motions.iter().zip(&self.learnt.shifts).zip(places);
        let motions = rows.map(|((motion, shift), places)| {
            let knots = motion.wanted.knots().iter().zip(shift.knots());
            let row = |((wanted, shift), place): ((&Vector2<f64>, &Vector2<f64>), f64)| {
                [place, wanted.x, wanted.y, shift.x, shift.y]
            };
            MotionFile {
                rest_s: motion.rest,
                marks: motion.marks.clone(),
                place_x_y_dx_dy_m: knots.zip(places).map(row).collect(),
            }
        });
        serde_json::to_string(&File {
            version: VERSION,
            digest: self.digest,
            knot_ticks: path.knot_ticks,
            lead: path.lead.clone(),
            motions: motions.collect(),
        })
    }

    /// From JSON, if it belongs to a scenario whose job has these moves.
    ///
    /// # Errors
    /// Why it is forgotten.
    pub fn of(json: &str, scenario: &Scenario, moves: &[Move]) -> Result<Self, Forgotten> {
        let file: File =
            serde_json::from_str(json).map_err(|error| Forgotten::File(error.to_string()))?;
        let digest =
            Digest::new(scenario, moves).map_err(|error| Forgotten::File(error.to_string()))?;
        if file.digest.robot != digest.robot {
            return Err(Forgotten::Robot);
        }
        if file.digest.job != digest.job {
            return Err(Forgotten::Job);
        }
        file.learnt(&scenario.robot)
            .map(|learnt| Self { digest, learnt })
            .ok_or_else(|| Forgotten::File("its motions are not whole".into()))
    }
}

impl File {
    fn learnt(self, robot: &Robot) -> Option<Learnt> {
        let (mut motions, mut shifts) = (Vec::new(), Vec::new());
        for motion in self.motions {
            let rows = motion.place_x_y_dx_dy_m;
            let finite = rows.iter().flatten().all(|value| value.is_finite());
            if self.version != VERSION || self.knot_ticks == 0 || rows.len() <= LEAST || !finite {
                return None;
            }
            let of = |x: usize| {
                let knots = rows.iter().map(|row| Vector2::new(row[x], row[x + 1]));
                Spline::through(knots.collect())
            };
            shifts.push(of(3));
            motions.push(Motion {
                rest: motion.rest_s,
                wanted: of(1),
                marks: motion.marks,
            });
        }
        let path = TimedPath::new(robot, self.lead, motions, self.knot_ticks);
        Some(Learnt { path, shifts })
    }
}
