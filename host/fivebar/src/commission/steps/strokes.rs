//! Short strokes that load one motor alone, as fast as its share of the torque allows.
//!
//! At rest τ = M(θ) θ̈ and v̇ = J θ̈, so a tool that is accelerated along d = J M⁻¹ e needs a torque of the one joint whose unit
//! vector e is. What the strokes show is then of its motor, whatever the other one can do.

use super::super::bench::Bench;
use super::super::finding::StepError;
use super::moving::middle;
use fivebar_files::robot::Robot;
use fivebar_firmware::{Move, MoveKind};
use fivebar_kinematics::five_bar::Joint;
use fivebar_sim::drive::Drive;
use fivebar_sim::time_optimal::JobPlanner;
use nalgebra::Vector2;

/// Half the length of a stroke, of an outstretched leg: short, so that a motor that stalls in one is not far behind at its end.
const STROKE: f64 = 0.08;
/// How often they lead there and back.
const ROUNDS: usize = 2;
/// The share of its greatest speed with which a joint goes to the first one.
const APPROACH: f64 = 0.1;
/// The turn by which the direction is found [rad].
const TURN: f64 = 1e-4;

/// The strokes of a joint through the middle of the workspace, with this share of the torque, or with the robot's own shares if
/// steppers turn its joints.
pub(super) fn plan(
    bench: &mut Bench,
    robot: &Robot,
    joint: Joint,
    share: f64,
) -> Result<Vec<Move>, StepError> {
    let settings = bench.settings;
    let moves = strokes(bench, joint)?;
    let fast = JobPlanner::new(robot, share).map_err(StepError::other)?;
    let mut drive = Drive::new(&mut bench.client, &|| false);
    let (from, mut planner) = (drive.tool()?, drive.planner(&settings)?);
    let moves = fast.moves(from, &moves, &mut planner);
    moves.map_err(StepError::other)
}

/// How long they take [s].
pub(super) fn duration(moves: &[Move]) -> f64 {
    let times = moves.iter().map(|one| match &one.kind {
        MoveKind::Timed(timed) => f64::from(timed.duration),
        _ => 0.0,
    });
    times.sum()
}

/// Slowly to the middle of the workspace, then there and back along the direction that loads this joint.
fn strokes(bench: &Bench, joint: Joint) -> Result<Vec<Move>, StepError> {
    let at = middle(bench)?;
    let [one, other] = ends(bench, at, joint)?;
    let to_middle = MoveKind::Joint {
        to: at.map(|angle| angle as f32),
        speed: APPROACH as f32,
    };
    let lines = [one, other].into_iter().cycle().take(2 * ROUNDS);
    let lines = lines.map(|place| MoveKind::Line {
        to: [place.x as f32, place.y as f32],
        feed: bench.robot.motion.max_speed as f32,
    });
    Ok((0..)
        .zip([to_middle].into_iter().chain(lines))
        .map(|(tag, kind)| Move { tag, tool: 0, kind })
        .collect())
}

/// Both ends of the strokes of a joint about the pose with these angles [m].
fn ends(bench: &Bench, at: [f64; 2], joint: Joint) -> Result<[Vector2<f64>; 2], StepError> {
    let robot = &bench.robot;
    let assembly = robot.home_pose().map_err(StepError::other)?.assembly();
    let tool = robot.tool_on_link().map_err(StepError::other)?;
    let pose = |[theta1, theta4]: [f64; 2]| {
        let pose = robot.geometry.forward(theta1, theta4, assembly);
        pose.map_err(StepError::other)
    };
    let arm = robot.arm().map_err(StepError::other)?;
    let mass = arm.mass_matrix(&pose(at)?).map_err(StepError::other)?;
    // The column of M⁻¹ but for its size.
    let (m, j) = (mass, joint.index());
    let mut turn = Vector2::zeros();
    (turn[j], turn[1 - j]) = (m[(1 - j, 1 - j)], -m[(0, 1)]);
    let turn = TURN * turn.normalize();
    let place = |sign: f64| {
        let there = [at[0] + sign * turn.x, at[1] + sign * turn.y];
        Ok::<_, StepError>(tool.point(&pose(there)?))
    };
    let [l1, l2, ..] = robot.geometry.lengths();
    let along = STROKE * (l1 + l2) * (place(1.0)? - place(-1.0)?).normalize();
    let center = place(0.0)?;
    Ok([center + along, center - along])
}
