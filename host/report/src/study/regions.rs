//! The regions of an arm by working and assembly mode, and where a motion can cross between them.
//!
//! At a place of type 2 a straight motion with C′ = e meets N·r̈C + f0 = 0 with s̈ = −f0/(N·e). It can cross
//! there if N·e is not ≈ 0, if θ3 − θ2 changes along e, and if at some speed within the limits of the
//! joints this acceleration is within theirs too. Directions e of half a turn are tried.

use fivebar_design::crossing::CrossingCondition;
use fivebar_design::workspace::{Grid, WorkspaceMap, singularity_curves};
use fivebar_files::robot::{MissingMasses, Robot};
use fivebar_kinematics::PlanarVector;
use fivebar_kinematics::dynamics::Arm;
use fivebar_kinematics::five_bar::{JointLimits, Pose, Side, Singularity, WorkingMode};
use nalgebra::Vector2;
use std::f64::consts::PI;

/// Cells along the longer side of the picture, about.
const CELLS: f64 = 60.0;
/// Directions that are tried, in half a turn from N on.
const DIRECTIONS: usize = 16;
/// The least cosine between e and N.
const LEAST_COSINE: f64 = 0.05;
/// Speeds that are tried, as equal shares of the greatest.
const SPEEDS: usize = 20;
/// The least change of θ3 − θ2 with the crossing, as a share of the turns of links 2 and 3.
const LEAST_TURN: f64 = 0.05;

/// The regions of one working mode.
#[derive(Clone, Debug)]
pub struct ModeRegions {
    /// The working mode.
    pub mode: WorkingMode,
    /// Reached places [m] of assembly left and right.
    pub reached: [Vec<Vector2<f64>>; 2],
    /// The curves of type 2 [m], in the parts where a motion can cross, and the others.
    pub crossable: Vec<Vec<Vector2<f64>>>,
    /// See `crossable`.
    pub barred: Vec<Vec<Vector2<f64>>>,
}

/// The regions of all four working modes, for a tool at C; none of a robot whose limits are not valid
/// or that reaches nothing.
///
/// # Errors
/// A robot without masses.
pub fn regions(robot: &Robot) -> Result<Vec<ModeRegions>, MissingMasses> {
    let arm = robot.arm()?;
    let modes = WorkingMode::ALL.into_iter();
    Ok(modes.filter_map(|mode| of_mode(robot, arm, mode)).collect())
}

fn of_mode(robot: &Robot, arm: &Arm<f64>, mode: WorkingMode) -> Option<ModeRegions> {
    let workspace = robot.workspace(mode).ok()?;
    let [_, far4] = arm.geometry().leg4_radii();
    let grid = Grid::over(&workspace.tool, 2.0 * far4 / CELLS).ok()?;
    let map = WorkspaceMap::new(workspace, grid);
    let mut reached = [Vec::new(), Vec::new()];
    for (place, _) in map.reached() {
        if let Ok(pose) = arm.geometry().inverse(place, mode) {
            let side = usize::from(pose.assembly() == Side::Right);
            reached[side].push(place);
        }
    }
    let (mut crossable, mut barred) = (Vec::new(), Vec::new());
    let curves = singularity_curves(&workspace.tool, mode);
    for curve in curves
        .iter()
        .filter(|curve| curve.singularity == Singularity::Parallel)
    {
        let can: Vec<(Vector2<f64>, bool)> = curve
            .points
            .iter()
            .map(|&c| (c, crossing_direction(robot, arm, mode, c).is_some()))
            .collect();
        for part in can.chunk_by(|one, next| one.1 == next.1) {
            let points = part.iter().map(|(c, _)| *c).collect();
            let list = if part[0].1 {
                &mut crossable
            } else {
                &mut barred
            };
            list.push(points);
        }
    }
    Some(ModeRegions {
        mode,
        reached,
        crossable,
        barred,
    })
}

/// The direction in which a motion crosses most surely at a place of type 2 [m]; none if none can.
pub fn crossing_direction(
    robot: &Robot,
    arm: &Arm<f64>,
    mode: WorkingMode,
    c: Vector2<f64>,
) -> Option<Vector2<f64>> {
    let (geometry, limits) = (arm.geometry(), &robot.limits);
    let pose = geometry.inverse(c, mode).ok()?;
    if pose.sin21().abs().min(pose.sin34().abs()) < limits.singularity_margin {
        return None;
    }
    let [theta1, _, _, theta4] = pose.angles();
    let ranges = JointLimits::new(limits.angle[0], limits.angle[1]).ok();
    if ranges.is_some_and(|ranges| ranges.angles_within(theta1, theta4).is_err()) {
        return None;
    }
    let still = geometry.inverse_velocities(&pose, Vector2::zeros()).ok()?;
    let n = CrossingCondition::new(arm, &pose, &still).n;
    let first = n.try_normalize(0.0)?;
    let directions = (0..DIRECTIONS).map(|k| {
        let turn = PI * k as f64 / DIRECTIONS as f64;
        Vector2::unit(turn).to_base_frame(first)
    });
    let crossing = |along: Vector2<f64>| Some((along, sureness(robot, arm, &pose, (n, along))?));
    let best = directions.filter_map(crossing);
    let best = best.max_by(|(_, one), (_, other)| one.total_cmp(other));
    best.map(|(along, _)| along)
}

/// How surely a motion through a pose along a direction crosses: the cosine to N times the change of
/// θ3 − θ2 [rad/m]; none if it cannot.
fn sureness(
    robot: &Robot,
    arm: &Arm<f64>,
    pose: &Pose<f64>,
    (n, along): (Vector2<f64>, Vector2<f64>),
) -> Option<f64> {
    let (geometry, limits) = (arm.geometry(), &robot.limits);
    let share = n.dot(&along);
    let [w1, w2, w3, w4] = geometry.inverse_velocities(pose, along).ok()?.omega;
    let (cosine, turn) = (share.abs() / n.norm(), (w3 - w2).abs());
    if cosine < LEAST_COSINE || turn < LEAST_TURN * (w2.abs() + w3.abs()) {
        return None;
    }
    let [most1, most4] = limits.max_speed;
    let fastest = (most1 / w1.abs()).min(most4 / w4.abs());
    let within = |speed: f64| {
        let velocities = geometry.inverse_velocities(pose, along * speed).ok()?;
        let f0 = CrossingCondition::new(arm, pose, &velocities).f0;
        let acceleration = along * (-f0 / share);
        let all = geometry.inverse_accelerations(pose, &velocities, acceleration);
        let [a1, _, _, a4] = all.ok()?.alpha;
        let [most1, most4] = limits.max_acceleration;
        (a1.abs() <= most1 && a4.abs() <= most4).then_some(cosine * turn)
    };
    let mut speeds = (1..=SPEEDS).map(|k| fastest * k as f64 / SPEEDS as f64);
    speeds.find_map(within)
}
