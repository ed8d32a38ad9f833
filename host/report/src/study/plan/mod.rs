//! Time-optimal plans of an arm along a path.
//!
//! The mechanics are in [`fivebar_design::time_optimal`].

mod answer;

use fivebar_design::time_optimal::{
    DrivenArm, PathPiece, PlanError, PlanLimits, Run, RunSample, plan,
};
use fivebar_files::path_case::{Corners, PathCase};
use fivebar_files::robot::{MissingMasses, Robot};
use fivebar_kinematics::dynamics::{Arm, Link, ModelError};
use fivebar_kinematics::five_bar::{GeometryError, Joint, JointLimits, PoseError};
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
    arm: DrivenArm,
    /// The pieces of each run.
    parts: Vec<Vec<PathPiece>>,
    has_masses: bool,
}

/// The motion of a plan at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanMoment {
    /// θ1, θ4 [rad], in (−π, π].
    pub theta: [f64; 2],
    /// ω1, ω4 [rad/s].
    pub omega: [f64; 2],
    /// α1, α4 [rad/s²].
    pub alpha: [f64; 2],
    /// The tool's position [m].
    pub tool: Vector2<f64>,
    /// Its velocity [m/s].
    pub velocity: Vector2<f64>,
    /// Its acceleration [m/s²].
    pub acceleration: Vector2<f64>,
    /// τ1, τ4 [N·m], with friction; none for a robot without masses.
    pub torque: Option<[f64; 2]>,
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
        let parts: Vec<Vec<PathPiece>> = match case.corners {
            Corners::Stop => pieces.chunks(1).map(<[_]>::to_vec).collect(),
            Corners::Smooth | Corners::Blend => vec![pieces.to_vec()],
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
            arm,
            parts,
            has_masses: robot.arm().is_ok(),
        })
    }

    /// The motion at a time from the beginning of the first run [s]; before and after the plan the arm rests at its ends.
    ///
    /// # Errors
    /// None on a path that has been planned, but at a point beside it by rounding.
    pub fn at(&self, mut t: f64) -> Result<PlanMoment, PoseError> {
        let mut index = 0;
        while index + 1 < self.runs.len() && t > self.runs[index].time {
            t -= self.runs[index].time;
            index += 1;
        }
        let [mut s, s_dot, s_ddot] = self.runs[index].at(t);
        let mut pieces = self.parts[index].iter();
        let mut piece = &self.parts[index][0];
        for next in pieces.by_ref() {
            piece = next;
            if s <= piece.length() {
                break;
            }
            s -= piece.length();
        }
        let point = piece.at(s.min(piece.length()));
        let demand = self.arm.demand(&point)?;
        let x = s_dot * s_dot;
        let along =
            |first: [f64; 2], second: [f64; 2]| [0, 1].map(|j| first[j] * s_ddot + second[j] * x);
        Ok(PlanMoment {
            theta: demand.direction.map(|u| u.y.atan2(u.x)),
            omega: demand.q1.map(|rate| rate * s_dot),
            alpha: along(demand.q1, demand.q2),
            tool: point.c,
            velocity: point.tangent * s_dot,
            acceleration: point.tangent * s_ddot + point.curvature * x,
            torque: self.has_masses.then(|| demand.torque(x, s_ddot)),
        })
    }

    /// ṡ of the maximum velocity curve at a sample.
    pub fn maximum_velocity(&self, sample: &RunSample) -> f64 {
        self.limits
            .maximum_velocity(&sample.demand, self.arm.drives())
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
    let limits = &case.limits;
    let needs_torque =
        limits.torque.iter().any(|limit| limit.is_finite()) || limits.voltage.is_some();
    let arm = match robot.arm() {
        Err(_) if !needs_torque => without_masses(robot)?,
        own => {
            let own = own?;
            Arm::new(
                robot.geometry,
                *own.links(),
                case.payload.unwrap_or(own.payload()),
                case.gravity.map_or(own.gravity(), Vector2::from),
                own.rotor_inertia(),
            )?
        }
    };
    let tool = robot.tool_on_link()?;
    let drives = robot.planned_drives();
    Ok(DrivenArm::new(&arm, tool, case.working_mode, drives)?)
}

/// An arm for a plan whose limits are of motion alone: its torques mean nothing.
fn without_masses(robot: &Robot) -> Result<Arm<f64>, ModelError> {
    let [l1, l2, l3, l4, _] = robot.geometry.lengths();
    let rods = [l1, l2, l3, l4].map(|length| Link::uniform_rod(1.0, length));
    Arm::new(robot.geometry, rods, 0.0, Vector2::zeros(), [0.0; 2])
}
