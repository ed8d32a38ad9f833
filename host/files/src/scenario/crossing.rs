//! Crossings of the singularity of type 2, to the other assembly mode, as moves of a controller.

use super::ModeChangeError;
use crate::robot::Robot;
use fivebar_design::crossing::{CrossingPlan, CrossingTask};
use fivebar_firmware::{CrossingMove, Move, MoveKind};
use fivebar_kinematics::five_bar::WorkingMode;

/// A plan as a move. Its law has the same s, ṡ and s̈ in the singularity, so it is the same polynomial.
pub fn crossing_move(task: &CrossingTask<'_>, plan: &CrossingPlan) -> MoveKind {
    let tau = plan.t_c / task.time;
    let [s, s_dot, s_ddot] = plan.law.at(tau);
    let (rate, acceleration) = (s_dot * task.time, s_ddot * task.time * task.time);
    // s = q(τ) + w(τ) b(τ − τc): q leads from rest to rest, w vanishes at both ends.
    let g = tau * (1.0 - tau);
    let slope = 1.0 - 2.0 * tau;
    let q = tau.powi(3) * (10.0 - 15.0 * tau + 6.0 * tau * tau);
    let (w, w_slope) = (g.powi(3), 3.0 * g * g * slope);
    let b0 = (s - q) / w;
    let b1 = (rate - 30.0 * g * g - w_slope * b0) / w;
    let bends = 60.0 * g * slope + 6.0 * g * (1.0 - 5.0 * g) * b0 + 2.0 * w_slope * b1;
    let b2 = (acceleration - bends) / (2.0 * w);
    let single = |value: f64| value as f32;
    MoveKind::Crossing(CrossingMove {
        from: [task.from.x, task.from.y].map(single),
        to: [task.to.x, task.to.y].map(single),
        duration: single(task.time),
        crosses_at: single(plan.t_c),
        law: [b0, b1, b2].map(single),
    })
}

/// The moves of a crossing between two points [m] in `time` [s], in a working mode. The first lifts the
/// tool.
pub(super) fn crossing_moves(
    robot: &Robot,
    mode: WorkingMode,
    ends: [[f64; 2]; 2],
    time: f64,
    tag: u32,
) -> Result<[Move; 2], ModeChangeError> {
    // The controller gets these points.
    let ends = ends.map(|end| end.map(|value| f64::from(value as f32)));
    let task = CrossingTask {
        mode,
        ..robot.crossing_task(ends, time)?
    };
    let plan = task.plan()?;
    let lift = MoveKind::Dwell { duration: 0.0 };
    let kinds = [lift, crossing_move(&task, &plan)];
    Ok(kinds.map(|kind| Move { tag, tool: 0, kind }))
}
