//! Changes of the working mode: the path of the joints from one pose of a tool's point to another,
//! through a stretched or folded leg.

use super::Scenario;
use super::crossing::crossing_moves;
use crate::job::{Action, Job};
use crate::robot::CrossingRefusal;
use fivebar_design::crossing::CrossingError;
use fivebar_design::joint_path::find_path;
use fivebar_firmware::planner::{MoveErrorKind, Planner};
use fivebar_firmware::{Move, MoveKind};
use fivebar_kinematics::five_bar::{
    JointLimits, PoseError, Side, WorkingMode, Workspace, WorkspaceViolation,
};
use nalgebra::Vector2;

/// Speed of the joints, as a share of their limits.
const SPEED: f32 = 0.4;

/// The sine by which nodes of the search are farther from the singularity than the margin, so that
/// the passages between them are clear, too.
const SLACK: f32 = 0.01;

/// Why the working mode is not changed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ModeChangeError {
    /// The tool cannot be at this point with these elbows.
    #[error("with {} the tool cannot be at ({:.1}, {:.1}) mm: {reason}", named(*.mode), 1e3 * .point[0], 1e3 * .point[1])]
    Place {
        /// The mode that is asked for.
        mode: WorkingMode,
        /// The tool's point [m].
        point: [f64; 2],
        /// The first that fails of reach, joint limits and margin.
        reason: WorkspaceViolation,
    },
    /// The tool can be there with these elbows, in the other assembly mode.
    #[error(
        "with {} and the tool at ({:.1}, {:.1}) mm the arm is in its other assembly mode, which only \
         a crossing reaches",
        named(*.mode), .point[0], .point[1]
    )]
    OtherAssembly {
        /// The mode that is asked for.
        mode: WorkingMode,
        /// The tool's point [m].
        point: [f64; 2],
    },
    /// Joint limits or margin leave no path.
    #[error(
        "no path of the joints was found to {} within their limits, their torque and the margin of links 2 \
         and 3: move the tool first",
        named(*.mode)
    )]
    NoWay {
        /// The mode that is asked for.
        mode: WorkingMode,
    },
    /// The controller refuses the path.
    #[error("on the way to {}: {reason}", named(*.mode))]
    Refused {
        /// The mode that is asked for.
        mode: WorkingMode,
        /// Its reason.
        reason: MoveErrorKind,
    },
    /// The robot crosses no singularity.
    #[error(transparent)]
    NoCrossing(#[from] CrossingRefusal),
    /// The crossing cannot be planned.
    #[error(transparent)]
    Crossing(#[from] CrossingError),
    /// The arm has no masses, or its settings are not valid.
    #[error("a change of the working mode needs an arm with masses and valid settings")]
    NoPlanner,
}

/// A change of the working mode that a line of a job asks for and that cannot be done.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("line {line}: {error}")]
pub struct RefusedModeChange {
    /// The line.
    pub line: u32,
    /// The reason.
    pub error: ModeChangeError,
}

/// The elbows of a mode in words.
fn named(mode: WorkingMode) -> String {
    let side = |side| match side {
        Side::Left => "left",
        Side::Right => "right",
    };
    let (elbow1, elbow4) = (side(mode.elbow1), side(mode.elbow4));
    format!("elbow 1 {elbow1} and elbow 4 {elbow4}")
}

/// θ1, θ4 [rad] at the corners of the path from the joint angles `from` to the pose in working mode
/// `mode` with the tool where it is. Empty if the arm is in this mode. The planner's checks hold on
/// the whole path.
///
/// # Errors
/// Why not.
pub fn change_of_mode(
    planner: &Planner,
    from: [f32; 2],
    mode: WorkingMode,
) -> Result<Vec<[f32; 2]>, ModeChangeError> {
    let space = planner.workspace();
    let [theta1, theta4] = from;
    let geometry = space.tool.geometry();
    let place = |point: Vector2<f32>, reason| ModeChangeError::Place {
        mode,
        point: [point.x.into(), point.y.into()],
        reason,
    };
    let pose = geometry
        .forward(theta1, theta4, planner.assembly())
        .map_err(|error| place(Vector2::zeros(), WorkspaceViolation::Pose(error)))?;
    if space.tool.working_mode(&pose) == mode {
        return Ok(Vec::new());
    }
    let point = space.tool.point(&pose);
    let there = Workspace { mode, ..*space };
    // The point may be in reach with these elbows in the other assembly mode only, where the limits
    // of the joints and the margin do not matter.
    let wanted = space.tool.inverse(point, mode);
    if wanted.is_ok_and(|pose| pose.assembly() != planner.assembly()) {
        let point = [point.x.into(), point.y.into()];
        return Err(ModeChangeError::OtherAssembly { mode, point });
    }
    let end = there.check(point).map_err(|reason| place(point, reason))?;
    let [end1, _, _, end4] = end.angles();
    let limits = space.limits.map(|limits| limits.ranges());
    let ranges = limits.unwrap_or([[-TURN / 2.0, TURN / 2.0]; 2]);
    let free = |at: [f64; 2]| is_free(planner, single(at));
    let clear = |a: [f64; 2], b: [f64; 2]| {
        let checked = planner.check_joints(single(a), single(b), SPEED);
        checked.is_ok()
    };
    let ranges64 = ranges.map(|range| range.map(f64::from));
    let targets = turns(end1, ranges[0], theta1).into_iter().flat_map(|to1| {
        turns(end4, ranges[1], theta4)
            .into_iter()
            .map(move |to4| [to1, to4])
    });
    let mut refusal = None;
    for to in targets {
        let corners = find_path(
            ranges64,
            from.map(f64::from),
            to.map(f64::from),
            free,
            clear,
        );
        if let Some(corners) = corners {
            return Ok(corners.into_iter().map(single).collect());
        }
        refusal = refusal.or(planner.check_joints(from, to, SPEED).err());
    }
    Err(match refusal.map(|refusal| refusal.kind) {
        Some(reason @ (MoveErrorKind::Torque(_) | MoveErrorKind::Number)) => {
            ModeChangeError::Refused { mode, reason }
        }
        _ => ModeChangeError::NoWay { mode },
    })
}

/// A turn [rad].
const TURN: f32 = std::f32::consts::TAU;

/// The angles of this direction within a range, the nearest to `near` first [rad].
fn turns(angle: f32, [low, high]: [f32; 2], near: f32) -> Vec<f32> {
    let turns = [-2.0, -1.0, 0.0, 1.0, 2.0].map(|turn: f32| angle + turn * TURN);
    let mut within: Vec<f32> = turns
        .into_iter()
        .filter(|at| (low..=high).contains(at))
        .collect();
    within.sort_by(|a, b| (a - near).abs().total_cmp(&(b - near).abs()));
    within
}

/// Whether the arm may be at these angles on the path: in its assembly mode, away from the
/// singularity of type 2.
fn is_free(planner: &Planner, [theta1, theta4]: [f32; 2]) -> bool {
    let space = planner.workspace();
    let pose = space
        .tool
        .geometry()
        .forward(theta1, theta4, planner.assembly());
    pose.is_ok_and(|pose| pose.sin32().abs() >= space.margin + SLACK)
}

/// The moves of a change.
fn joint_moves(corners: &[[f32; 2]], tag: u32) -> impl Iterator<Item = Move> + '_ {
    corners.iter().map(move |&to| Move {
        tag,
        tool: 0,
        kind: MoveKind::Joint { to, speed: SPEED },
    })
}

/// θ1, θ4 with the tool at a point in a working mode, within the limits [rad].
fn joints_at(
    space: &Workspace<f32>,
    point: [f32; 2],
    mode: WorkingMode,
) -> Result<[f32; 2], ModeChangeError> {
    let refuse = |reason| ModeChangeError::Place {
        mode,
        point: point.map(f64::from),
        reason,
    };
    let there = Workspace { mode, ..*space };
    let pose = there.check(Vector2::from(point)).map_err(refuse)?;
    let [theta1, _, _, theta4] = pose.angles();
    let within = |limits: JointLimits<f32>| limits.angles_within(theta1, theta4).ok();
    let unreachable = || refuse(WorkspaceViolation::Pose(PoseError::NotFinite));
    space.limits.and_then(within).ok_or_else(unreachable)
}

fn single(angles: [f64; 2]) -> [f32; 2] {
    angles.map(|angle| angle as f32)
}

impl Scenario {
    /// The moves of a job that changes the working or the assembly mode, for an arm that is in `mode`
    /// before them.
    pub(super) fn moves_with_changes(
        &self,
        mut planner: Planner,
        mut mode: WorkingMode,
        job: &Job,
    ) -> Result<Vec<Move>, RefusedModeChange> {
        let mut moves = Vec::with_capacity(job.steps.len());
        let mut at: Option<[f64; 2]> = None;
        for step in &job.steps {
            let line = step.line;
            let refused = |error| RefusedModeChange { line, error };
            // A change follows the path to its place.
            let place = at.unwrap_or_default();
            match step.action {
                Action::ChangeMode(wanted) => {
                    let corners = joints_at(planner.workspace(), single(place), mode)
                        .and_then(|from| change_of_mode(&planner, from, wanted));
                    moves.extend(joint_moves(&corners.map_err(refused)?, line));
                    mode = wanted;
                }
                Action::Cross { to, time } => {
                    let crossing = crossing_moves(&self.robot, mode, [place, to], time, line);
                    moves.extend(crossing.map_err(refused)?);
                    let other = planner.assembly().opposite();
                    planner = planner.in_assembly(other);
                    at = Some(to);
                }
                _ => {
                    moves.extend(step.as_move(self.robot.motion.max_speed));
                    at = step.action.end().or(at);
                }
            }
        }
        Ok(moves)
    }
}
