//! The step that finds the masses from the currents along a motion of both joints, and tries them on
//! a second motion.

use super::super::bench::Bench;
use super::super::finding::StepError;
use super::super::record::Value;
use super::moving::{JointLog, joint_angles, logged, tool};
use super::{Outcome, encoder_errors, geometry, measured};
use fivebar_design::identification::EncoderErrors;
use fivebar_files::robot::Robot;
use fivebar_firmware::recorder::Signals;
use fivebar_firmware::{Move, MoveKind, Planner};
use fivebar_kinematics::five_bar::Joint;
use fivebar_report::study::calibration::propose_poses;
use fivebar_report::study::identification::{
    encoder_errors_of, identify_robot, measured_masses, validate_robot,
};
use std::ops::Range;

/// Rows of the log of a motion per second. The loop's currents follow the encoder's steps up to 1 kHz;
/// with half as many rows their aliases made the unexplained torque three times as great.
const LOG_RATE: f64 = 2000.0;
/// Rounds through the places of the motion from which the masses follow, and of the second one.
const ROUNDS: [Range<usize>; 2] = [0..2, 2..4];

/// Masses from the currents along a motion of both joints.
pub(in super::super) fn dynamics(bench: &mut Bench) -> Result<Outcome, StepError> {
    bench.home()?;
    bench.measure_zeros()?;
    let [first, second] = ROUNDS.map(|rounds| motion(bench, rounds));
    let (rows, other) = (first?, second?);
    let every = every(bench);
    let mut slow = bench.robot.clone();
    slow.control.tick_rate /= f64::from(every);
    let undetermined = |error| {
        StepError::wrong(
            format_args!("the motion does not determine the masses: {error}"),
            "check currents and the robot file's masses, and do the step geometry first",
        )
    };
    let encoders = encoders(bench, &slow, &rows)?;
    let (rows, other) = match &encoders {
        None => (rows, other),
        Some(encoders) => (encoders.correct(&rows), encoders.correct(&other)),
    };
    let found = identify_robot(&slow, &rows).map_err(undetermined)?;
    let mut values = Vec::new();
    let names = fivebar_design::identification::BASE_NAMES;
    for (index, (name, value)) in names.iter().zip(&found.base).enumerate() {
        values.push(
            Value::new(*name, *value, "by a motion of both joints").with_sd(found.base_sd[index]),
        );
    }
    let after = validate_robot(&slow, Some(&found), &other).map_err(undetermined)?;
    let mut text = format!(
        "from {} rows; the torques of a second motion, {:.0} mN·m RMS, are predicted to {:.2} mN·m",
        rows.len(),
        1e3 * after.torque_rms,
        1e3 * after.rms
    );
    let origin = "root mean square along a second motion";
    values.push(Value::new("torque_rms_nm", after.torque_rms, origin));
    values.push(Value::new("torque_error_after_nm", after.rms, origin));
    let mut drawn = bench.drawn.clone();
    drawn.control.tick_rate = slow.control.tick_rate;
    // Without masses in the drawing there is nothing to compare with.
    if let Ok(before) = validate_robot(&drawn, None, &other) {
        text += &format!(", by the drawing to {:.1} mN·m", 1e3 * before.rms);
        values.push(Value::new("torque_error_before_nm", before.rms, origin));
    }
    let mut keys = measured_masses(&bench.robot, &found);
    if let Some(encoders) = encoders.filter(Encoders::has_errors) {
        let again = geometry::again(bench, encoders.before, encoders.errors)?;
        let again = again.unwrap_or_default();
        keys.extend(again.measured);
        values.extend(again.values);
        let Some([before, after]) = encoders.rms else {
            return Ok(Outcome {
                measured: keys,
                ..Outcome::new(text, values)
            });
        };
        keys.extend(Joint::ALL.map(|joint| {
            let text = encoder_errors::text(&encoders.errors, joint);
            measured(encoder_errors::key(joint), text, "by a fast motion".into())
        }));
        text += &format!(
            "; errors of the encoders explain what left {:.1} mN·m: now {:.1} mN·m",
            1e3 * before,
            1e3 * after
        );
    }
    Ok(Outcome {
        measured: keys,
        ..Outcome::new(text, values)
    })
}

/// Errors of the encoders are believed where they leave at most this share of the torque that is not explained: of
/// encoders without errors their eight unknowns take a hundredth of its square.
const BELIEVED: f64 = 0.95;

/// Errors of the encoders on the motors' shafts.
struct Encoders {
    /// What the robot file has.
    before: EncoderErrors,
    errors: EncoderErrors,
    ratios: [f64; 2],
    /// Root mean square of the torque that is not explained, before and after [N·m], if they are new.
    rms: Option<[f64; 2]>,
}

impl Encoders {
    fn has_errors(&self) -> bool {
        self.errors != EncoderErrors::default()
    }

    /// Rows with the joints' angles in place of those that the encoders show.
    fn correct(&self, rows: &[[f64; 5]]) -> Vec<[f64; 5]> {
        let angle =
            |joint: Joint, shown: f64| self.errors.corrected(joint, shown, self.ratios[joint]);
        let row = |&[time, shown1, shown4, current1, current4]: &[f64; 5]| {
            let [theta1, theta4] = [angle(Joint::Joint1, shown1), angle(Joint::Joint4, shown4)];
            [time, theta1, theta4, current1, current4]
        };
        rows.iter().map(row).collect()
    }
}

/// The errors of the encoders that a motion tells; none where they are not on the motors' shafts.
fn encoders(bench: &Bench, slow: &Robot, rows: &[[f64; 5]]) -> Result<Option<Encoders>, StepError> {
    let Some(before) = encoder_errors::in_file(bench)? else {
        return Ok(None);
    };
    let found = encoder_errors_of(slow, rows, before).ok();
    let better = found.filter(|found| found.rms[1] < BELIEVED * found.rms[0]);
    Ok(Some(Encoders {
        before,
        errors: better.map_or(before, |found| found.errors),
        ratios: encoder_errors::ratios(bench)?,
        rms: better.map(|found| found.rms),
    }))
}

/// Ticks between rows of the log.
fn every(bench: &Bench) -> u16 {
    (bench.robot.control.tick_rate / LOG_RATE).round().max(1.0) as u16
}

/// Rows of time, θ1, θ4 and the currents of joints 1 and 4 along some rounds.
fn motion(bench: &mut Bench, rounds: Range<usize>) -> Result<Vec<[f64; 5]>, StepError> {
    let moves = excitation(bench, rounds)?;
    let signals = Signals::COUNTS_1 | Signals::COUNTS_4 | Signals::SENSED_1 | Signals::SENSED_4;
    let every = every(bench);
    let JointLog {
        period,
        angle,
        current,
    } = logged(bench, &moves, signals, every)?;
    // The log begins where the controller knows the joints; their encoders show their errors as well.
    let start = [angle[0][0], angle[1][0]];
    let shown = encoder_errors::shown(bench, start)?;
    // The mean of both ends of a row: the current that acted within it.
    let acted = |joint: Joint, k: usize| 0.5 * (current[joint][k] + current[joint][k - 1]);
    let rows = (1..angle[0].len()).map(|k| {
        let time = k as f64 * period;
        let [acted1, acted4] = Joint::ALL.map(|joint| acted(joint, k));
        [
            time,
            angle[0][k] + shown[0] - start[0],
            angle[1][k] + shown[1] - start[1],
            acted1,
            acted4,
        ]
    });
    Ok(rows.collect())
}

/// Fast moves of both joints between places all over the workspace, at last to a place from which the
/// switches are found.
fn excitation(bench: &mut Bench, rounds: Range<usize>) -> Result<Vec<Move>, StepError> {
    let proposed = propose_poses(&bench.robot, 12, 20e-6).map_err(StepError::other)?;
    let places = proposed.proposal.points;
    let settings = bench.settings.check().map_err(StepError::other)?;
    let planner = Planner::new(&settings);
    let mut tool = tool(bench)?;
    let robot = &bench.robot;
    let best = robot.best_point().map_err(StepError::other)?;
    let count = places.len();
    // Each round visits them in another order.
    let visited = rounds.flat_map(|round| {
        let stride = [5, 7, 11, 1][round % 4];
        let places = &places;
        (0..count).map(move |step| places[(step * stride + round) % count])
    });
    let mut moves = Vec::new();
    for place in visited.chain([best.into()]) {
        let Some(to) = joint_angles(robot, place) else {
            continue;
        };
        let to = to.map(|angle| angle as f32);
        let moved = [0.6, 0.3].into_iter().find_map(|speed| {
            let next = Move {
                tag: moves.len() as u32,
                tool: 0,
                kind: MoveKind::Joint { to, speed },
            };
            Some((planner.check(tool, &next).ok()?, next))
        });
        if let Some((end, next)) = moved {
            tool = end;
            moves.push(next);
        }
    }
    if moves.len() < 12 {
        return Err(StepError::wrong(
            "hardly any move between places of the workspace is possible",
            "check limits.angle and singularity_margin of the robot file",
        ));
    }
    Ok(moves)
}
