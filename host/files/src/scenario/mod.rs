//! Scenarios: a robot, a job, a mismatch and injected faults.

mod control_law;
mod crossing;
mod fault_entry;
mod file;
mod mode_change;
mod placement;
mod wiring;

use crate::job::{
    Action, DEMONSTRATION, Job, JobError, JobOptions, JobReader, Placement, Warning, WarningKind,
};
use crate::robot::{HomeError, Robot};
use crate::source::FileError;
use fivebar_plant::{FaultKind, Mismatch, PlantFault, Wiring};

pub use control_law::ControlLaw;
pub use crossing::crossing_move;
pub use mode_change::{ModeChangeError, RefusedModeChange, change_of_mode};
pub use placement::RefusedMove;
pub use placement::{FitError, Kept, place_in_job};

/// Everything that defines a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Scenario {
    /// Its name.
    pub name: String,
    /// The arm as the controller's model has it.
    pub robot: Robot,
    /// The arm that the mismatch changes, if it is another one: one whose robot file was measured.
    pub arm: Option<Robot>,
    /// The job's file, as the user named it.
    pub job_file: String,
    /// The job's G-code.
    pub job_text: String,
    /// The position of the job's (0, 0) in the frame of the base [m]; none: the middle of the
    /// drawing is at the point where the arm moves best, or where the drawing fits.
    pub origin: Option<[f64; 2]>,
    /// Metres in the plane per metre in the job.
    pub scale: f64,
    /// The angle by which the job is turned about its (0, 0), counter-clockwise [rad].
    pub turn: f64,
    /// Whether a job without an origin may be longer than the largest clear page: it then lies along
    /// the edge of the reach.
    pub anywhere: bool,
    /// How far around what a job without an origin draws the arm must reach, too [m].
    pub margin: f64,
    /// The first line of the job that is done, or the first stroke of a drawing; none: the first of
    /// all. The place is that of the whole job.
    pub from_line: Option<u32>,
    /// How the job is read where its text leaves it open.
    pub options: JobOptions,
    /// What reads the job.
    pub reader: JobReader,
    /// Seed of all pseudo-random numbers of the run.
    pub seed: u64,
    /// How the arm differs from the controller's model.
    pub mismatch: Mismatch,
    /// Mistakes in the wiring.
    pub wiring: Wiring,
    /// Radial clearance of the joints A to E [m], 0 for a joint that is not worn. The run then
    /// records forces and contacts of all joints. None: ideal joints, nothing recorded.
    pub clearance: Option<[f64; 5]>,
    /// Faults that are active from power-up.
    pub initial_faults: Vec<FaultKind>,
    /// Faults that are injected during the job; their times count from its beginning.
    pub faults: Vec<PlantFault>,
    /// The control law of the controller.
    pub control_law: ControlLaw,
    /// Plan the job time-optimally with this share of the torque limits, 0 to 1; none: the
    /// controller plans it.
    pub time_optimal: Option<f64>,
    /// Greatest tip error of a job that counts as drawn [m]; none: what the drives allow.
    pub tolerance: Option<f64>,
}

/// Why a scenario cannot be run.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ScenarioError {
    /// A file that cannot be read.
    #[error("cannot read {file}: {source}")]
    Read {
        /// The file, as the user named it.
        file: String,
        /// The system's error.
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
        /// The error.
        error: JobError,
    },
    /// The job has no motion from this line on.
    #[error("{file} has no motion at or behind line {line}, where it is to start")]
    FromLine {
        /// The job's file.
        file: String,
        /// The line.
        line: u32,
    },
    /// The robot has no home pose.
    #[error(transparent)]
    HomeError(#[from] HomeError),
}

impl Scenario {
    /// The arm before the mismatch: the robot, unless the scenario names another one.
    pub fn arm(&self) -> &Robot {
        self.arm.as_ref().unwrap_or(&self.robot)
    }

    /// The same with PID at each joint, to compare with; none if it has PID itself, or steppers or hobby servos, which
    /// follow the same set-points under any law.
    pub fn under_pid(&self) -> Option<Self> {
        let follows = self.robot.has_steppers() || self.robot.hobby_servos().is_some();
        let compared = self.control_law != ControlLaw::Pid && !follows;
        compared.then(|| Self {
            control_law: ControlLaw::Pid,
            ..self.clone()
        })
    }

    /// A scenario with this robot and this job, under the declared mismatch.
    pub fn new(name: &str, robot: Robot, job_file: &str, job_text: String) -> Self {
        Self {
            name: name.into(),
            robot,
            arm: None,
            job_file: job_file.into(),
            job_text,
            origin: None,
            scale: 1.0,
            turn: 0.0,
            anywhere: false,
            margin: 0.0,
            from_line: None,
            options: JobOptions::default(),
            reader: JobReader::default(),
            seed: 1,
            mismatch: Mismatch::default(),
            wiring: Wiring::default(),
            clearance: None,
            initial_faults: Vec::new(),
            faults: Vec::new(),
            control_law: ControlLaw::ComputedTorque,
            time_optimal: None,
            tolerance: None,
        }
    }

    /// The demonstration job on this arm.
    pub fn demonstration(robot: Robot) -> Self {
        Self::new(
            "the demonstration",
            robot,
            "the demonstration job",
            DEMONSTRATION.into(),
        )
    }

    /// The job at this placement.
    fn read(&self, placement: &Placement) -> Result<Job, ScenarioError> {
        let options = JobOptions {
            tolerance: 0.5 * self.robot.motion.corner_tolerance / self.scale,
            levels: self.robot.tool_levels(),
            speed_without_feed: Some(self.robot.motion.max_speed),
            hatch: self.options.hatch.map(|distance| distance / self.scale),
            gap: self.options.gap / self.scale,
            ..self.options
        };
        let job = (self.reader.0)(&self.job_text, placement, &options);
        let mut job = job.map_err(|error| ScenarioError::Job {
            file: self.job_file.clone(),
            error,
        })?;
        self.note_speed(&mut job);
        Ok(job)
    }

    /// Notes the feed rates above the arm's greatest speed, which the planner limits.
    fn note_speed(&self, job: &mut Job) {
        let limit = self.robot.motion.max_speed;
        let too_fast = |feed: f64| feed > limit * (1.0 + 1e-6);
        let mut lines = job.steps.iter().filter_map(|step| match step.action {
            Action::Line {
                feed: Some(feed), ..
            }
            | Action::Arc { feed, .. } => too_fast(feed).then_some(step.line),
            _ => None,
        });
        if let Some(first) = lines.next() {
            job.warnings.push(Warning {
                count: 1 + lines.count() as u32,
                ..Warning::at(first, WarningKind::Speed(limit))
            });
        }
    }
}

/// The middle of what a job draws, or of all its motions if the pen is never down [m]; of an arc its end counts.
pub fn middle(job: &Job) -> [f64; 2] {
    let bounds = |drawn: bool| {
        job.steps
            .iter()
            .filter(|step| step.draws() || !drawn)
            .filter_map(|step| step.action.end())
            .fold(None, |bounds: Option<[[f64; 2]; 2]>, [x, y]| {
                let [[left, low], [right, high]] = bounds.unwrap_or([[x, y]; 2]);
                Some([[left.min(x), low.min(y)], [right.max(x), high.max(y)]])
            })
    };
    let [[left, low], [right, high]] = bounds(true).or_else(|| bounds(false)).unwrap_or_default();
    [0.5 * (left + right), 0.5 * (low + high)]
}
