//! The step that finds friction by a sweep of constant speeds.
//!
//! One joint turns by whole turns of its motor at a constant speed and back over the same stretch; the
//! other one is held. Torques of gravity and of products of velocities, cogging and the sensor's zero
//! are the same in both directions, so half the difference is the friction c + b |ω|.

use super::super::bench::Bench;
use super::super::finding::StepError;
use super::super::record::Value;
use super::fit::least_squares;
use super::moving::{JointLog, follow, logged, middle, tool};
use super::{Outcome, measured};
use fivebar_files::robot::MeasuredKey;
use fivebar_firmware::recorder::{LOG_WORDS, Signals};
use fivebar_firmware::{Move, MoveKind, Planner};
use fivebar_kinematics::five_bar::Joint;
use std::f64::consts::TAU;

/// Speeds of the sweep [rad/s]: above those at which stiction shows.
const SPEEDS: [f64; 5] = [1.0, 1.6, 2.5, 4.0, 6.0];
/// The greatest of them, as a share of the joint's limit.
const FASTEST: f64 = 0.3;
/// The angle in which a joint reaches its speed, and in which it comes to rest [rad], and the time in
/// which the loop then settles [s].
const RUN_UP: f64 = 0.04;
const SETTLING: f64 = 0.05;
/// The longest stretch at constant speed [rad].
const LONGEST: f64 = 0.8;
/// Greatest difference of the speed in both halves of the stretch, as a share.
const STEADY: f64 = 0.01;

/// Friction of both joints.
pub(in super::super) fn friction(bench: &mut Bench) -> Result<Outcome, StepError> {
    bench.home()?;
    bench.measure_zeros()?;
    let (mut values, mut keys, mut texts) = (Vec::new(), Vec::new(), Vec::new());
    for joint in Joint::ALL {
        let this = joint.number();
        let points = sweep(bench, joint)?;
        let line = Line::through(&points).ok_or_else(|| {
            StepError::wrong(
                format_args!("{joint} reached hardly any constant speed"),
                "check limits.max_speed and max_acceleration of the robot file, and that the joint \
                 turns freely around the middle of the workspace",
            )
        })?;
        texts.push(format!(
            "{joint}: {:.2} mN·m and {:.3} mN·m·s/rad",
            1e3 * line.coulomb[0],
            1e3 * line.viscous[0]
        ));
        for (key, unit, [value, sd]) in [
            ("coulomb_friction", "nm", line.coulomb),
            ("viscous_friction", "nms", line.viscous),
        ] {
            let origin = "by a sweep of speeds";
            values.push(Value::new(format!("{key}{this}_{unit}"), value, origin).with_sd(sd));
            keys.push(measured(
                MeasuredKey::Actuator(joint, key),
                format!("{:.6e}", value.max(0.0)),
                format!("± {sd:.1e} {origin}"),
            ));
        }
    }
    Ok(Outcome {
        measured: keys,
        ..Outcome::new(texts.join("; "), values)
    })
}

/// Speeds [rad/s] and friction torques [N·m] of a joint.
fn sweep(bench: &mut Bench, joint: Joint) -> Result<Vec<[f64; 2]>, StepError> {
    let middle = middle(bench)?;
    let drive = bench.drive(joint)?;
    let turn = TAU / drive.gear_ratio.abs();
    let whole = (LONGEST / turn).floor();
    // Less than a turn of the motor only where a whole one is too long.
    let stretch = if whole >= 1.0 { whole * turn } else { LONGEST };
    let highest = FASTEST * bench.robot.limits.max_speed[joint];
    let mut points = Vec::new();
    for speed in SPEEDS {
        let speed = speed * (highest / SPEEDS[SPEEDS.len() - 1]).min(1.0);
        let half = 0.5 * stretch + RUN_UP + SETTLING * speed;
        let ends = [middle[joint] - half, middle[joint] + half];
        let to_start = joint_moves(bench, joint, middle, &ends[..1], 0.1)?;
        follow(bench, &to_start)?;
        let share = speed / bench.robot.limits.max_speed[joint];
        let moves = joint_moves(bench, joint, middle, &[ends[1], ends[0]], share)?;
        // Two words a row, over both directions and the rests at their ends; the planner may slow the joint.
        let time = 8.0 * half / speed + 0.3;
        let every = (2.0 * time * bench.robot.control.tick_rate / LOG_WORDS as f64).ceil();
        let signals = [
            Signals::COUNTS_1 | Signals::SENSED_1,
            Signals::COUNTS_4 | Signals::SENSED_4,
        ][joint];
        let log = logged(bench, &moves, signals, every as u16)?;
        let constant = drive.gear_ratio.abs() * drive.torque_constant;
        points.extend(half_difference(
            &log,
            joint,
            middle[joint],
            stretch,
            constant,
        ));
    }
    // From there the switches are found.
    let to_middle = joint_moves(bench, joint, middle, &[middle[joint]], 0.1)?;
    follow(bench, &to_middle)?;
    Ok(points)
}

/// Moves of one joint through these angles [rad], with the other one where it is in the middle, at a
/// share of the greatest speed.
fn joint_moves(
    bench: &mut Bench,
    joint: Joint,
    middle: [f64; 2],
    through: &[f64],
    share: f64,
) -> Result<Vec<Move>, StepError> {
    let settings = bench.settings.check().map_err(StepError::other)?;
    let planner = Planner::new(&settings);
    let mut tool = tool(bench)?;
    let mut moves = Vec::new();
    for &angle in through {
        let mut to = middle.map(|angle| angle as f32);
        to[joint] = angle as f32;
        let kind = MoveKind::Joint {
            to,
            speed: share as f32,
        };
        let next = Move {
            tag: moves.len() as u32,
            tool: 0,
            kind,
        };
        tool = planner.check(tool, &next).map_err(|error| {
            StepError::wrong(
                format_args!("{joint} cannot turn around the middle of the workspace: {error}"),
                "check limits.angle and singularity_margin of the robot file",
            )
        })?;
        moves.push(next);
    }
    Ok(moves)
}

/// The speed [rad/s] and half the difference of the torques there and back [N·m]; none if the speed
/// was not constant.
fn half_difference(
    log: &JointLog,
    joint: Joint,
    middle: f64,
    stretch: f64,
    constant: f64,
) -> Option<[f64; 2]> {
    let (angle, current) = (&log.angle[joint], &log.current[joint]);
    let turning = (0..angle.len()).max_by(|&a, &b| angle[a].total_cmp(&angle[b]))?;
    let pass = |rows: std::ops::Range<usize>| -> Option<[f64; 2]> {
        let inside = |row: &usize| (angle[*row] - middle).abs() <= 0.5 * stretch;
        let rows: Vec<usize> = rows.filter(inside).collect();
        let speed = |rows: &[usize]| -> Option<f64> {
            let (first, last) = (*rows.first()?, *rows.last()?);
            let time = (last - first) as f64 * log.period;
            (time > 0.0).then(|| (angle[last] - angle[first]) / time)
        };
        let (before, behind) = rows.split_at(rows.len() / 2);
        let (whole, before, behind) = (speed(&rows)?, speed(before)?, speed(behind)?);
        if (before - behind).abs() > STEADY * whole.abs() {
            return None;
        }
        let sum: f64 = rows.iter().map(|&row| current[row]).sum();
        Some([whole, constant * sum / rows.len() as f64])
    };
    let [there, torque_there] = pass(0..turning)?;
    let [back, torque_back] = pass(turning..angle.len())?;
    Some([0.5 * (there - back), 0.5 * (torque_there - torque_back)])
}

/// Coulomb [N·m] and viscous friction [N·m·s/rad], each with its deviation.
struct Line {
    coulomb: [f64; 2],
    viscous: [f64; 2],
}

impl Line {
    /// The line of least squares through points (ω, τ); none for fewer than four.
    fn through(points: &[[f64; 2]]) -> Option<Self> {
        // About the mean speed, where slope and height are independent.
        let mean = points.iter().map(|[omega, _]| omega).sum::<f64>() / points.len() as f64;
        let rows: Vec<_> = points
            .iter()
            .map(|[omega, _]| vec![omega - mean, 1.0])
            .collect();
        let torques: Vec<_> = points.iter().map(|&[_, torque]| torque).collect();
        let fit = least_squares(&rows, &torques, 2)?;
        let (slope, slope_sd) = (fit.values[0], fit.deviations[0]);
        Some(Self {
            coulomb: [
                fit.values[1] - slope * mean,
                fit.deviations[1].hypot(slope_sd * mean),
            ],
            viscous: [slope, slope_sd],
        })
    }
}

#[cfg(test)]
mod tests {
    use super::Line;

    #[test]
    fn a_line_is_found_with_its_deviations() {
        let points = |wrong: f64| {
            [1.0, 2.0, 4.0, 8.0].map(|omega| {
                let sign = if omega == 2.0 || omega == 8.0 {
                    1.0
                } else {
                    -1.0
                };
                [omega, 0.012 + 0.002 * omega + sign * wrong]
            })
        };
        let exact = Line::through(&points(0.0)).unwrap();
        assert!((exact.coulomb[0] - 0.012).abs() < 1e-15);
        assert!((exact.viscous[0] - 0.002).abs() < 1e-15);
        assert!(exact.coulomb[1] < 1e-15 && exact.viscous[1] < 1e-15);
        let noisy = Line::through(&points(1e-5)).unwrap();
        assert!((noisy.coulomb[0] - 0.012).abs() < 2.0 * noisy.coulomb[1]);
        assert!(Line::through(&points(0.0)[..3]).is_none());
        assert!(Line::through(&[[1.0, 1.0]; 4]).is_none());
    }
}
