//! What is to be run: a robot, a job, and what is wrong with the arm.

mod fault;
mod faults;
mod file;
mod mismatch;

pub use fault::{FaultKind, PlantFault};
pub use mismatch::{Mismatch, UnsoundMismatch};

use crate::input::job::{Job, JobError, Placement};
use crate::input::robot::{NoHome, Robot};
use crate::input::source::FileError;

/// A run, ready to be done.
#[derive(Clone, Debug, PartialEq)]
pub struct Scenario {
    /// Its name.
    pub name: String,
    /// The arm as the controller believes it to be.
    pub robot: Robot,
    /// The job's file, as the user named it.
    pub job_file: String,
    /// The job's G-code.
    pub job_text: String,
    /// Where the job's (0, 0) lies in the frame of the base [m]; without it the middle of
    /// the drawing goes where the arm moves best.
    pub origin: Option<[f64; 2]>,
    /// Metres in the plane per metre in the job.
    pub scale: f64,
    /// Seed of every random number of the run.
    pub seed: u64,
    /// How the arm differs from what the controller believes.
    pub mismatch: Mismatch,
    /// Radial clearance of the joints A to E [m], 0 for a joint that is not worn, in a run
    /// that watches what they go through; without it all are ideal and none is watched.
    pub clearance: Option<[f64; 5]>,
    /// What is broken from power-up.
    pub broken: Vec<FaultKind>,
    /// What breaks later, at its time from the beginning of the job.
    pub faults: Vec<PlantFault>,
    /// Control by the arm's model; else by a PD at each joint.
    pub computed_torque: bool,
}

/// Why a scenario cannot be run.
#[derive(Debug, thiserror::Error)]
pub enum ScenarioError {
    /// A file that cannot be read.
    #[error("cannot read {file}: {source}")]
    Read {
        /// The file, as the user named it.
        file: String,
        /// What the system says.
        source: std::io::Error,
    },
    /// A key or a value of the scenario's or the robot's file.
    #[error(transparent)]
    File(#[from] FileError),
    /// A line of the job.
    #[error("{file}, {error}")]
    Job {
        /// The job's file.
        file: String,
        /// What is wrong.
        error: JobError,
    },
    /// The robot has no place to start from.
    #[error(transparent)]
    NoHome(#[from] NoHome),
}

impl Scenario {
    /// The declared mismatch, a job and an arm.
    pub fn new(name: &str, robot: Robot, job_file: &str, job_text: String) -> Self {
        Self {
            name: name.into(),
            robot,
            job_file: job_file.into(),
            job_text,
            origin: None,
            scale: 1.0,
            seed: 1,
            mismatch: Mismatch::default(),
            clearance: None,
            broken: Vec::new(),
            faults: Vec::new(),
            computed_torque: true,
        }
    }

    /// The demonstration, done by this arm.
    pub fn demonstration(robot: Robot) -> Self {
        /// The job, which comes with the program.
        const JOB: &str = include_str!("../../../jobs/fivebar.gcode");
        Self::new(
            "the demonstration",
            robot,
            "the demonstration job",
            JOB.into(),
        )
    }

    /// The job, read and placed.
    ///
    /// # Errors
    /// A line that cannot be done as written, or a robot without a home.
    pub fn job(&self) -> Result<Job, ScenarioError> {
        let home = self.robot.tool_at(&self.robot.home_pose()?);
        let placed = |origin| {
            let placement = Placement {
                origin,
                scale: self.scale,
                home,
            };
            Job::parse(&self.job_text, &placement).map_err(|error| ScenarioError::Job {
                file: self.job_file.clone(),
                error,
            })
        };
        if let Some(origin) = self.origin {
            return placed(origin);
        }
        let [middle_x, middle_y] = middle(&placed([0.0; 2])?);
        let [x, y] = self.robot.best_point()?;
        placed([x - middle_x, y - middle_y])
    }
}

/// Middle of what a job draws, or of its motions where it never puts the pen down [m].
fn middle(job: &Job) -> [f64; 2] {
    let bounds = |drawn: bool| {
        job.steps
            .iter()
            .filter(|step| step.pen_down || !drawn)
            .filter_map(|step| step.action.end())
            .fold(None, |bounds: Option<[[f64; 2]; 2]>, [x, y]| {
                let [[left, low], [right, high]] = bounds.unwrap_or([[x, y]; 2]);
                Some([[left.min(x), low.min(y)], [right.max(x), high.max(y)]])
            })
    };
    let [[left, low], [right, high]] = bounds(true).or_else(|| bounds(false)).unwrap_or_default();
    [0.5 * (left + right), 0.5 * (low + high)]
}
