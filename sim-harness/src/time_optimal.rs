//! Whole jobs by time-optimal motion: moves become timed moves, planned on the host.
//!
//! The path is that of the controller's own look-ahead, with its rounded corners. The feed rates
//! do not apply: each run from rest to rest is as fast as the joints' torques, speeds and
//! accelerations and the motors' voltage allow.

use crate::segment::segment;
use fivebar_design::time_optimal::{
    DrivenArm, JobPath, PathPart, PathPiece, PlanError, PlanLimits, Smoothing, TimedPiece,
    TimedRun, plan_timed,
};
use fivebar_files::robot::{MissingMasses, Robot, WorkspaceError};
use fivebar_firmware::planner::{MoveError, Planner};
use fivebar_firmware::settings::ToolOutputSettings;
use fivebar_firmware::{Move, MoveKind, TimedCurve, TimedMove};
use fivebar_kinematics::dynamics::ModelError;
use fivebar_kinematics::five_bar::{GeometryError, Side, WorkingMode};
use fivebar_kinematics::trajectory::{
    Curve, Envelope, MotionLimits, PathError, PathSegmentError, TorqueLimits,
};
use nalgebra::Vector2;
use rayon::prelude::*;

/// Why a job is not planned.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TimeOptimalError {
    /// The robot has lengths only.
    #[error(transparent)]
    Masses(#[from] MissingMasses),
    /// The robot's masses are not valid.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// The robot's tool is not valid.
    #[error(transparent)]
    Tool(#[from] GeometryError),
    /// The robot has no workspace.
    #[error(transparent)]
    Workspace(#[from] WorkspaceError),
    /// The tool's power follows its speed, but the job's feed rates do not apply.
    #[error(
        "the tool's power follows its speed (`scale_with_speed`), so it needs the job's feed rates; \
         run the job without --time-optimal"
    )]
    PowerBySpeed,
    /// Hobby servos are late by more than such a plan's pieces last.
    #[error(
        "a hobby servo reads a set-point in each frame and follows late, so a motion at the limit of its torque is not drawn as \
         planned: leave out the time-optimal plan"
    )]
    HobbyServos,
    /// The links are too heavy for the steppers that turn them.
    #[error(
        "the links' inertia at a motor is {0:.0} times the rotor's: above {MOST_INERTIA} a stepper swings so much that it \
         loses steps; draw without --time-optimal, or give the arm a greater `gear_ratio`"
    )]
    Swings(f64),
    /// A move leaves the workspace.
    #[error("line {0}: {1}")]
    Path(u32, PathError<f64>),
    /// A move is no path.
    #[error("line {0}: {1}")]
    Segment(u32, PathSegmentError),
    /// No motion along the path from a line on keeps the limits.
    #[error("the path from line {0} on: {1}")]
    Plan(u32, PlanError),
    /// A move is refused.
    #[error(transparent)]
    Move(#[from] MoveError),
}

/// The share of the joints' speeds and accelerations, and of the supply, that plans use.
const JOINT_SHARE: f64 = 0.98;
/// The greatest ratio of the links' inertia at a stepper to its rotor's. Of twenty simulated arms of other sizes and
/// gear ratios, none with a ratio up to 29 lost a step, and all three from 34 on did.
const MOST_INERTIA: f64 = 30.0;
/// Time between the knots of a plan's spline, on arms that are not on steppers [s].
const INTERVAL: f64 = 4e-3;
/// Half a swing of a rotor, of the period of the file's arm: of an arm that is 15 % heavier on motors that are 10 % weaker,
/// ½ √(1.15/0.9). Such an arm needs the most torque, so it has the least left for a swing
/// (docs/verify/stepper-motion.md).
const HALF_A_SWING: f64 = 0.565;
/// The limits of the tool by which the look-ahead chooses between rounding a corner and stopping
/// there: more than an arm's.
const TOOL: MotionLimits<f64> = MotionLimits {
    speed: 10.0,
    acceleration: 1000.0,
    jerk: 1e4,
};

/// A planned move, and the index of the job's move that it belongs to; none for the first move,
/// which leads to the job.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlannedMove {
    /// The move.
    pub next: Move,
    /// The index.
    pub source: Option<usize>,
}

/// What becomes of a job: runs to plan, and moves that stay as they are.
enum Stage {
    Run(WorkingMode, Vec<PathPart>),
    Move(PlannedMove),
}

/// A robot's planner of whole jobs.
#[derive(Clone)]
pub struct JobPlanner {
    arm: DrivenArm,
    envelope: Envelope<f64>,
    limits: PlanLimits,
    smoothing: Smoothing,
    waits: bool,
    /// [m/s].
    approach: f32,
}

impl JobPlanner {
    /// A planner for the robot's working mode, whose plans use `torque_share` of the torque limits; the
    /// rest is for feedback.
    ///
    /// # Errors
    /// A robot without masses, with a tool whose power follows its speed, or with steppers that would swing.
    pub fn new(robot: &Robot, torque_share: f64) -> Result<Self, TimeOptimalError> {
        if let ToolOutputSettings::Power {
            scale_with_speed: true,
            ..
        } = robot.tool_output
        {
            return Err(TimeOptimalError::PowerBySpeed);
        }
        let arm = robot.arm()?;
        if robot.hobby_servos().is_some() {
            return Err(TimeOptimalError::HobbyServos);
        }
        if let Some(ratio) = robot.inertia_ratio().filter(|ratio| *ratio > MOST_INERTIA) {
            return Err(TimeOptimalError::Swings(ratio));
        }
        let drives = robot.drives()?;
        // A stepper's limits have their own share, of its pull-out torque.
        let falling_torque = robot.falling_torque();
        let torque_share = match falling_torque {
            Some(_) => JOINT_SHARE,
            None => torque_share,
        };
        let torque = drives.map(|drive| torque_share * drive.peak_torque());
        let share = |values: [f64; 2]| values.map(|value| JOINT_SHARE * value);
        let [fastest1, fastest4] = robot.limits.max_speed;
        let speed = share(match robot.led_speed() {
            Some([led1, led4]) => [fastest1.min(led1), fastest4.min(led4)],
            None => [fastest1, fastest4],
        });
        let tool = robot.tool_on_link()?;
        let mode = robot.working_mode();
        let workspace = robot.workspace(mode)?;
        Ok(Self {
            arm: DrivenArm::new(arm, tool, mode, robot.planned_drives())?,
            envelope: Envelope {
                workspace,
                joint_speed: speed,
                joint_acceleration: share(robot.limits.max_acceleration),
                torque: Some(TorqueLimits { arm: *arm, torque }),
                tool_motion: TOOL,
                corner_tolerance: robot.motion.corner_tolerance,
            },
            limits: PlanLimits {
                torque,
                falling_torque,
                speed,
                acceleration: share(robot.limits.max_acceleration),
                voltage: robot
                    .actuators
                    .is_some()
                    .then_some(JOINT_SHARE * robot.supply.voltage),
                tip_speed: None,
                tip_acceleration: None,
            },
            smoothing: match robot.swing_period() {
                Some(swing) => Smoothing::HalfSwing(HALF_A_SWING * swing),
                None => Smoothing::Knots(INTERVAL),
            },
            waits: robot.tool_output.waits(),
            approach: robot.motion.max_speed as f32,
        })
    }

    /// The same job by timed moves, with the tool at rest at `from` [m] before it in the working and
    /// assembly mode of the controller's `planner`, which checks it. Dwells and joint
    /// moves stay as they are. The first move is a line to `from`, because an arm is never held
    /// quite there.
    ///
    /// # Errors
    /// The line that cannot be planned, and why.
    pub fn moves(
        &self,
        from: [f32; 2],
        moves: &[Move],
        planner: &mut Planner,
    ) -> Result<Vec<Move>, TimeOptimalError> {
        let planned = self.plan(from, moves, planner)?;
        Ok(planned.into_iter().map(|planned| planned.next).collect())
    }

    /// As [`Self::moves`], with the origin of each move.
    ///
    /// # Errors
    /// As [`Self::moves`].
    pub fn plan(
        &self,
        from: [f32; 2],
        moves: &[Move],
        planner: &mut Planner,
    ) -> Result<Vec<PlannedMove>, TimeOptimalError> {
        let way = Move {
            tag: 0,
            tool: 0,
            kind: MoveKind::Line {
                to: from,
                feed: self.approach,
            },
        };
        let mut stages = vec![Stage::Move(PlannedMove {
            next: way,
            source: None,
        })];
        stages.extend(self.stages(from, moves, planner)?);
        let planned: Result<Vec<Vec<PlannedMove>>, TimeOptimalError> = stages
            .into_par_iter()
            .map(|stage| match stage {
                Stage::Move(next) => Ok(vec![next]),
                Stage::Run(mode, parts) => self.run(mode, &parts, moves),
            })
            .collect();
        Ok(planned?.concat())
    }

    /// The timed moves of one run.
    fn run(
        &self,
        mode: WorkingMode,
        parts: &[PathPart],
        moves: &[Move],
    ) -> Result<Vec<PlannedMove>, TimeOptimalError> {
        let pieces: Vec<PathPiece> = parts.iter().map(|part| part.piece.clone()).collect();
        let tag = |part: &PathPart| moves.get(part.source).map_or(0, |source| source.tag);
        let line = parts.first().map_or(0, tag);
        let TimedRun { pieces: timed, .. } = plan_timed(
            &self.arm.in_mode(mode),
            &self.limits,
            &pieces,
            self.smoothing,
        )
        .map_err(|error| TimeOptimalError::Plan(line, error))?;
        let timed = timed.iter().filter_map(|piece| {
            let part = &parts[piece.piece];
            let next = Move {
                tag: tag(part),
                tool: part.level,
                kind: MoveKind::Timed(timed_move(&part.piece, piece)?),
            };
            Some(PlannedMove {
                next,
                source: Some(part.source),
            })
        });
        Ok(timed.collect())
    }

    fn stages(
        &self,
        from: [f32; 2],
        moves: &[Move],
        planner: &mut Planner,
    ) -> Result<Vec<Stage>, TimeOptimalError> {
        planner.check_all(from, moves)?;
        let mut envelope = self.envelope;
        envelope.workspace.mode = planner.workspace().mode;
        let mut path = JobPath::new(self.waits);
        let mut assembly = planner.assembly();
        let mut stages = Vec::new();
        let mut at = from;
        for (source, next) in moves.iter().enumerate() {
            let tag = next.tag;
            let Some(segment) = segment(&next.kind, at) else {
                let mode = envelope.workspace.mode;
                stages.extend(path.finish().into_iter().map(|run| Stage::Run(mode, run)));
                stages.push(Stage::Move(PlannedMove {
                    next: *next,
                    source: Some(source),
                }));
                if let MoveKind::Joint { to, .. } = next.kind
                    && let Some((place, mode)) = self.after_joints(to, assembly)
                {
                    at = place;
                    envelope.workspace.mode = mode;
                }
                if let MoveKind::Crossing(crossing) = next.kind {
                    at = crossing.to;
                    assembly = assembly.opposite();
                }
                continue;
            };
            match segment {
                Ok(segment) => path
                    .push(&segment, source, next.tool, &envelope)
                    .map_err(|error| TimeOptimalError::Path(tag, error))?,
                Err(PathSegmentError::ZeroLength) => {}
                Err(error) => return Err(TimeOptimalError::Segment(tag, error)),
            }
            if let MoveKind::Line { to, .. } | MoveKind::Arc { to, .. } = next.kind {
                at = to;
            }
        }
        let mode = envelope.workspace.mode;
        stages.extend(path.finish().into_iter().map(|run| Stage::Run(mode, run)));
        Ok(stages)
    }

    /// The tool [m] and the working mode at these joint angles [rad].
    fn after_joints(
        &self,
        [theta1, theta4]: [f32; 2],
        assembly: Side,
    ) -> Option<([f32; 2], WorkingMode)> {
        let tool = &self.envelope.workspace.tool;
        let [theta1, theta4] = [theta1, theta4].map(f64::from);
        let pose = tool.geometry().forward(theta1, theta4, assembly).ok()?;
        let point = tool.point(&pose);
        Some(([point.x as f32, point.y as f32], tool.working_mode(&pose)))
    }
}

/// A piece of a plan as a move.
fn timed_move(piece: &PathPiece, timed: &TimedPiece) -> Option<TimedMove> {
    let PathPiece::Curve { curve, from, .. } = piece else {
        return None;
    };
    let [s, s_dot, s_ddot, jerk] = timed.law;
    Some(TimedMove {
        curve: single_curve(curve),
        law: [from + s, s_dot, s_ddot, jerk].map(|value| value as f32),
        duration: timed.duration as f32,
    })
}

fn single_curve(curve: &Curve<f64>) -> TimedCurve {
    let single = |v: Vector2<f64>| [v.x as f32, v.y as f32];
    match *curve {
        Curve::Line { start, tangent } => TimedCurve::Line {
            start: single(start),
            tangent: single(tangent),
        },
        Curve::Arc {
            start,
            tangent,
            curvature,
        } => TimedCurve::Arc {
            start: single(start),
            tangent: single(tangent),
            curvature: curvature as f32,
        },
        Curve::Blend {
            coefficients,
            inverse_length,
        } => TimedCurve::Blend {
            coefficients: coefficients.map(single),
            inverse_length: inverse_length as f32,
        },
    }
}
