//! What the steps that move the homed arm with a log have in common.

use super::super::bench::Bench;
use super::super::finding::StepError;
use super::super::log::LogRows;
use fivebar_files::robot::Robot;
use fivebar_firmware::Move;
use fivebar_firmware::recorder::{LogConfig, Signals};
use fivebar_kinematics::five_bar::Joint;
use fivebar_sim::drive::Drive;
use nalgebra::Vector2;
use std::f64::consts::TAU;

/// The angle [rad] and the current [A] of both joints, each positive as the joint counts, row by row.
pub(super) struct JointLog {
    /// Between two rows [s].
    pub(super) period: f64,
    pub(super) angle: [Vec<f64>; 2],
    pub(super) current: [Vec<f64>; 2],
}

/// Does the moves with a log of a row every `every` ticks.
pub(super) fn logged(
    bench: &mut Bench,
    moves: &[Move],
    signals: Signals,
    every: u16,
) -> Result<JointLog, StepError> {
    let config = LogConfig {
        signals: signals.bits(),
        every,
        powered: true,
    };
    let start = bench.pause(0.3)?.angle;
    bench.begin_log(config)?;
    follow(bench, moves)?;
    let rows = bench.read_log(&config)?;
    let mut log = JointLog {
        period: f64::from(every) / bench.robot.control.tick_rate,
        angle: [Vec::new(), Vec::new()],
        current: [Vec::new(), Vec::new()],
    };
    for (joint, start) in Joint::ALL.into_iter().zip(start) {
        log.angle[joint] = angles(bench, joint, f64::from(start), &rows)?;
        log.current[joint] = currents(bench, joint, &rows)?;
    }
    Ok(log)
}

/// Does the moves.
pub(super) fn follow(bench: &mut Bench, moves: &[Move]) -> Result<(), StepError> {
    let settings = bench.settings;
    Drive::new(&mut bench.client, &|| false).follow(moves, &settings, &mut |_, _| ())?;
    Ok(())
}

pub(super) fn angles(
    bench: &Bench,
    joint: Joint,
    start: f64,
    rows: &LogRows,
) -> Result<Vec<f64>, StepError> {
    let per_count = TAU / bench.counts_per_turn(joint)?;
    let counts = rows.counts(joint);
    Ok(counts.iter().map(|c| start + c * per_count).collect())
}

pub(super) fn currents(bench: &Bench, joint: Joint, rows: &LogRows) -> Result<Vec<f64>, StepError> {
    let sign = bench.drive(joint)?.gear_ratio.signum();
    let per_code = sign * f64::from(bench.settings.axes[joint].current_per_code);
    let zero = bench.zeros[joint];
    let codes = rows.current_codes(joint);
    Ok(codes.iter().map(|code| (code - zero) * per_code).collect())
}

/// What the homed joints' counts are at the angle 0 [rad].
pub(super) fn origins(bench: &mut Bench) -> Result<[f64; 2], StepError> {
    let status = bench.pause(0.3)?;
    let counts = bench.sample()?.counts;
    let mut origins = [0.0; 2];
    for joint in Joint::ALL {
        let per_count = TAU / bench.counts_per_turn(joint)?;
        origins[joint] = f64::from(counts[joint]) * per_count - f64::from(status.angle[joint]);
    }
    Ok(origins)
}

/// The tool's place [m].
pub(super) fn tool(bench: &mut Bench) -> Result<[f32; 2], StepError> {
    let tool = bench.client.status()?.0.tool;
    tool.ok_or_else(|| StepError::other("the controller is homed and knows no place of its tool"))
}

/// θ1, θ4 in the middle of the workspace [rad].
pub(super) fn middle(bench: &Bench) -> Result<[f64; 2], StepError> {
    let best = bench.robot.best_point().map_err(StepError::other)?;
    joint_angles(&bench.robot, best.into()).ok_or_else(|| {
        StepError::other("the middle of the workspace is outside limits.angle of the robot file")
    })
}

/// θ1, θ4 [rad] with C at a place [m], within the limits of the angles; none if there are none.
pub(super) fn joint_angles(robot: &Robot, place: Vector2<f64>) -> Option<[f64; 2]> {
    let angles = robot.geometry.inverse(place, robot.elbows).ok()?.angles();
    let within = |joint: Joint| {
        let [least, greatest] = robot.limits.angle[joint];
        let turns = [0.0, TAU, -TAU].map(|turn| angles[3 * joint.index()] + turn);
        let inside = |angle: &f64| (least..=greatest).contains(angle);
        turns.into_iter().find(inside)
    };
    Some([within(Joint::Joint1)?, within(Joint::Joint4)?])
}
