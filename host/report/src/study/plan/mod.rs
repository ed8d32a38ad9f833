//! Time-optimal plans of an arm along a path.
//!
//! The mechanics are in [`fivebar_design::time_optimal`].

mod answer;

use fivebar_design::time_optimal::{
    DrivenArm, PlanError, PlanLimits, PlannedDrive, Run, RunSample, plan,
};
use fivebar_files::path_case::{Corners, PathCase};
use fivebar_files::robot::{MissingMasses, Robot};
use fivebar_kinematics::dynamics::{Arm, ModelError};
use fivebar_kinematics::five_bar::{GeometryError, Joint, JointLimits};
use nalgebra::Vector2;
use std::time::{Duration, Instant};

/// Why there is no plan.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PlanStudyError {
    /// The robot has lengths only.
    #[error(transparent)]
    Masses(#[from] MissingMasses),
    /// The path file's payload or gravity is not valid.
    #[error("the path file's values: {0}")]
    Model(#[from] ModelError),
    /// The robot's tool is not valid.
    #[error(transparent)]
    Tool(#[from] GeometryError),
    /// The path cannot be run along; the run is counted from 1.
    #[error("run {0}: {1}")]
    Run(usize, PlanError),
}

/// A time-optimal plan along a path.
#[derive(Clone, Debug)]
pub struct PlanStudy {
    /// The runs, each from rest to rest.
    pub runs: Vec<Run>,
    /// How long the planning took.
    pub planning: Duration,
    /// The limits, with the share of the torque.
    pub limits: PlanLimits,
    drives: [PlannedDrive; 2],
}

impl PlanStudy {
    /// Plans a path with `torque_share` of the torque limits, and with joint jerks of at most
    /// `jerk` [rad/s³].
    ///
    /// # Errors
    /// A robot without masses, and a path that the arm cannot run along.
    pub fn new(
        robot: &Robot,
        case: &PathCase,
        torque_share: f64,
        jerk: Option<f64>,
    ) -> Result<Self, PlanStudyError> {
        let begin = Instant::now();
        let arm = driven_arm(robot, case)?;
        let limits = PlanLimits {
            torque: case.limits.torque.map(|torque| torque_share * torque),
            ..case.limits
        };
        let pieces = &case.path[..];
        let parts: Vec<_> = match case.corners {
            Corners::Stop => pieces.chunks(1).collect(),
            Corners::Smooth | Corners::Blend => vec![pieces],
        };
        let runs = parts.iter().enumerate().map(|(n, pieces)| {
            let run = plan(&arm, &limits, pieces, jerk);
            run.map_err(|error| PlanStudyError::Run(n + 1, error))
        });
        let runs = runs.collect::<Result<_, _>>()?;
        Ok(Self {
            runs,
            planning: begin.elapsed(),
            limits,
            drives: *arm.drives(),
        })
    }

    /// ṡ of the maximum velocity curve at a sample.
    pub fn maximum_velocity(&self, sample: &RunSample) -> f64 {
        self.limits.maximum_velocity(&sample.demand, &self.drives)
    }

    /// The run, from 1, and the place where a joint first leaves the robot's `limits.angle`.
    pub fn outside(&self, robot: &Robot) -> Option<(usize, f64, Joint)> {
        let [range1, range4] = robot.limits.angle;
        let ranges = JointLimits::new(range1, range4).ok()?;
        let runs = self.runs.iter().enumerate();
        let mut samples = runs.flat_map(|(n, run)| run.samples.iter().map(move |at| (n + 1, at)));
        samples.find_map(|(n, at)| {
            let [theta1, theta4] = at.demand.direction.map(|u| u.y.atan2(u.x));
            let outside = ranges.angles_within(theta1, theta4).err()?;
            Some((n, at.s, outside.joint()))
        })
    }

    /// The duration of all runs [s].
    pub fn time(&self) -> f64 {
        self.runs.iter().map(|run| run.time).sum()
    }
}

fn driven_arm(robot: &Robot, case: &PathCase) -> Result<DrivenArm, PlanStudyError> {
    let own = robot.arm()?;
    let arm = Arm::new(
        robot.geometry,
        *own.links(),
        case.payload.unwrap_or(own.payload()),
        case.gravity.map_or(own.gravity(), Vector2::from),
        own.rotor_inertia(),
    )?;
    let tool = robot.tool_on_link()?;
    let drives = robot.planned_drives();
    Ok(DrivenArm::new(&arm, tool, case.working_mode, drives)?)
}
