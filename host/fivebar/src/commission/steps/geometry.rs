//! The step that finds lengths and joint offsets from touched holes.

use super::super::bench::Bench;
use super::super::finding::StepError;
use super::super::operator::Task;
use super::super::record::Value;
use super::encoder_errors::{self, Errors, WithErrors, fit, in_file, ratios, touches};
use super::{Outcome, marks, measured as measured_value};
use fivebar_design::Noise;
use fivebar_design::calibration::{Criterion, Parameters, Unknowns};
use fivebar_design::identification::EncoderErrors;
use fivebar_files::measurements::read_columns;
use fivebar_files::robot::{Measured, Robot};
use fivebar_kinematics::five_bar::Joint;
use fivebar_report::picture::tip_errors;
use fivebar_report::study::calibration::{
    CalibrationStudy, calibrate_robot, measured, propose_poses,
};
use fivebar_report::study::workspace::WorkspaceStudyError;
use std::f64::consts::TAU;

/// Holes that are touched.
const HOLES: usize = 40;
/// Standard deviation of a hole's x and of its y [m].
const SIGMA: f64 = 20e-6;
/// An arm that has turned by more on its way through the holes is brought back [turns].
const FAR: f64 = 0.25;
/// Fewest holes from which errors of the encoders are found.
const FEWEST: usize = 30;
/// The place of the plate in the record.
const PLATE: [&str; 3] = ["plate_x_m", "plate_y_m", "plate_phi_rad"];

pub(in super::super) fn geometry(bench: &mut Bench) -> Result<Outcome, StepError> {
    let rows = match bench.points.clone() {
        Some(points) => {
            read_columns(&points, ["counts1", "counts4", "x", "y"]).map_err(StepError::other)?
        }
        None if bench.counts_by_hand() => touched(bench)?,
        None => marks::marked(bench)?,
    };
    let sigma = sigma(bench);
    let mut study =
        calibrate_robot(&bench.robot, &rows, sigma, Criterion::Huber).map_err(|error| {
            StepError::wrong(
                format_args!("the holes do not determine the arm: {error}"),
                "check the plate's table, counts and gear ratios, and touch the holes again",
            )
        })?;
    bench.keep_holes(&rows)?;
    let errors = errors_by_holes(bench, &rows)?;
    if let Some(errors) = &errors {
        study.calibration.parameters = errors.parameters;
    }
    let mut values = found_values(&study);
    let places = if bench.counts_by_hand() {
        "holes"
    } else {
        "marks"
    };
    let mut text = format!("lengths and offsets from {} {places}", rows.len());
    if let Some(expected) = &study.tip_error {
        values.push(Value::new(
            "tip_error_expected_m",
            expected.rms,
            "over the workspace",
        ));
        text += &format!(", a tip error of {:.1} µm expected", 1e6 * expected.rms);
    }
    let mut keys = Vec::new();
    if let Some(errors) = &errors {
        for joint in Joint::ALL {
            // The angle at the home switch is that of the joint, not of its encoder.
            let ratio = bench.drive(joint)?.gear_ratio;
            let home = bench.robot.home[joint];
            let shown = in_file(bench)?.unwrap_or_default();
            study.calibration.parameters.offsets[joint] +=
                shown.at(joint, home, ratio) - errors.errors.at(joint, home, ratio);
            keys.push(measured_value(
                encoder_errors::key(joint),
                encoder_errors::text(&errors.errors, joint),
                "by touched holes".into(),
            ));
        }
        text += &format!(
            "; errors of the encoders explain what left residuals of {:.0} µm: now {:.0} µm",
            1e6 * study.calibration.residual_rms,
            1e6 * errors.residual
        );
    }
    keys.extend(measured(
        &bench.robot,
        &study.calibration.parameters,
        &study.calibration.covariance,
    ));
    let picture = map(&bench.robot, &study).map_err(StepError::other)?;
    Ok(Outcome {
        measured: keys,
        picture,
        ..Outcome::new(text, values)
    })
}

/// Standard deviation of a place's x and of its y [m].
fn sigma(bench: &Bench) -> f64 {
    match bench.counts_by_hand() {
        true => SIGMA,
        false => marks::SIGMA,
    }
}

/// What the touched holes say of the arm and of the plate.
fn found_values(study: &CalibrationStudy) -> Vec<Value> {
    let p = &study.calibration.parameters;
    let of = |name: &str, value: f64, origin: &str, index: usize| match study.calibration.covariance
        [(index, index)]
        .sqrt()
    {
        0.0 => Value::new(name, value, "held, because both hips turn about one axis"),
        sd => Value::new(name, value, origin).with_sd(sd),
    };
    let names = [
        "l1_m",
        "l2_m",
        "l3_m",
        "l4_m",
        "base_m",
        "offset1_rad",
        "offset4_rad",
    ];
    let found = p.lengths.iter().chain(&p.offsets);
    let mut values: Vec<Value> = (names.iter().zip(found).enumerate())
        .map(|(index, (name, value))| of(name, *value, "by touched holes", index))
        .collect();
    for (index, name) in PLATE.into_iter().enumerate() {
        let placed = [p.origin[0], p.origin[1], p.turn][index];
        values.push(of(
            name,
            placed,
            "of the plate, by touched holes",
            7 + index,
        ));
    }
    values
}

/// The error of the tip over the workspace before and after; none where the arm reaches nothing.
fn map(robot: &Robot, study: &CalibrationStudy) -> Result<Option<String>, WorkspaceStudyError> {
    let (Some(before), Some(after)) = (&study.before, &study.tip_error) else {
        return Ok(None);
    };
    let workspace = robot.workspace(robot.elbows);
    let workspace =
        workspace.map_err(|error| WorkspaceStudyError::Robot(robot.name.clone(), error))?;
    tip_errors(&robot.name, &workspace.tool, before, after).map(Some)
}

/// Decrease of the sum of squared residuals [σ²] from which errors of the encoders are believed: their
/// eight unknowns alone take 8 ± 4 of it.
const SIGNIFICANT: f64 = 40.0;

/// Errors of the encoders, where they explain significantly more than without them.
fn errors_by_holes(bench: &Bench, rows: &[[f64; 4]]) -> Result<Option<WithErrors>, StepError> {
    if !bench.counts_by_hand() {
        return Ok(None);
    }
    // Of all holes: errors of the encoders are no outliers.
    let plain = calibrate_robot(&bench.robot, rows, SIGMA, Criterion::LeastSquares)
        .map_err(StepError::other)?;
    let residual = plain.calibration.residual_rms;
    match in_file(bench)? {
        None => return Ok(None),
        Some(known) if known != EncoderErrors::default() => {
            return refined(
                bench,
                rows,
                &plain.calibration.parameters,
                Errors::Known(known),
            );
        }
        Some(_) if rows.len() < FEWEST => return Ok(None),
        Some(_) => {}
    }
    let found = refined(bench, rows, &plain.calibration.parameters, Errors::Unknown)?;
    let explained = |found: &WithErrors| {
        let squares = residual * residual - found.residual * found.residual;
        squares * (2 * rows.len()) as f64 > SIGNIFICANT * SIGMA * SIGMA
    };
    Ok(found.filter(explained))
}

fn refined(
    bench: &Bench,
    rows: &[[f64; 4]],
    start: &Parameters,
    errors: Errors,
) -> Result<Option<WithErrors>, StepError> {
    let home = bench.robot.home_pose().map_err(StepError::other)?;
    let touches = touches(bench, rows)?;
    Ok(fit(
        start,
        Unknowns::of(bench.robot.geometry.lengths()),
        &touches,
        ratios(bench)?,
        home.assembly(),
        errors,
    ))
}

/// Values that holes tell.
#[derive(Default)]
pub(super) struct OfHoles {
    /// For the robot file.
    pub(super) measured: Vec<Measured>,
    /// For the record.
    pub(super) values: Vec<Value>,
}

/// What the holes tell again, once the errors of the encoders are known better: values of the robot file and of the
/// record. The holes were touched while the robot file had other angles at home: what they tell changes by as much as
/// with the errors of before. None without holes of this run, or if they do not determine the arm.
pub(super) fn again(
    bench: &Bench,
    before: EncoderErrors,
    errors: EncoderErrors,
) -> Result<Option<OfHoles>, StepError> {
    let Some(rows) = bench.holes()? else {
        return Ok(None);
    };
    let plain = calibrate_robot(&bench.robot, &rows, SIGMA, Criterion::Huber)
        .map_err(StepError::other)?
        .calibration;
    let with = |errors| refined(bench, &rows, &plain.parameters, Errors::Known(errors));
    let (Some(before), Some(mut after)) = (with(before)?, with(errors)?) else {
        return Ok(None);
    };
    let ratios = ratios(bench)?;
    let placed = &after.parameters;
    let values = [placed.origin[0], placed.origin[1], placed.turn];
    let values = PLATE.iter().zip(values).map(|(name, value)| {
        Value::new(
            *name,
            value,
            "of the plate, by touched holes with these encoders",
        )
    });
    let values = values.collect();
    for joint in Joint::ALL {
        let at_home = |found: &WithErrors| {
            let shown = found
                .errors
                .at(joint, bench.robot.home[joint], ratios[joint]);
            found.parameters.offsets[joint] - shown
        };
        after.parameters.offsets[joint] = at_home(&after) - at_home(&before);
    }
    Ok(Some(OfHoles {
        measured: measured(&bench.robot, &after.parameters, &plain.covariance),
        values,
    }))
}

/// Counts of both joints and the place of each hole.
fn touched(bench: &mut Bench) -> Result<Vec<[f64; 4]>, StepError> {
    let proposal = propose_poses(&bench.robot, HOLES, SIGMA).map_err(StepError::other)?;
    bench.home()?;
    bench.report("The holes of the plate, in the arm's own frame: fivebar calibrate --propose 40 --plate FILE.svg")?;
    if bench.robot.geometry.lengths()[4] == 0.0 {
        bench.report(
            "Both hips turn about one axis: the plate's x axis is the arm's, so lay it along",
        )?;
    }
    let homed = bench.client.status()?.0.angle.map(f64::from);
    let simulated = bench.operator.actions().is_some();
    let mut noise = Noise::new(7);
    let mut rows = Vec::new();
    let mut first = None;
    for (index, place) in proposal.proposal.points.iter().enumerate() {
        let stated = [place.x, place.y];
        // A simulated plate has its holes where a drill has put them.
        let true_place = match simulated {
            true => stated.map(|x| x + SIGMA * noise.normal()),
            false => stated,
        };
        bench.ask(Task::Hole(index, true_place))?;
        let counts = bench.sample()?.counts;
        // The first hole's angle as the encoders show it, from what the controller knows; the others follow by counts.
        let (start, angle) = match first {
            Some(first) => first,
            None => {
                let angle = bench.client.status()?.0.angle.map(f64::from);
                *first.insert((counts, encoder_errors::shown(bench, angle)?))
            }
        };
        let mut row = [0.0, 0.0, stated[0], stated[1]];
        for joint in Joint::ALL {
            let per_radian = bench.counts_per_turn(joint)? / TAU;
            let turned = f64::from(counts[joint].wrapping_sub(start[joint]));
            row[joint.index()] = angle[joint] * per_radian - 0.5 + turned;
        }
        rows.push(row);
    }
    let [first, second] = Joint::ALL;
    let per_turn = [
        bench.counts_per_turn(first)?,
        bench.counts_per_turn(second)?,
    ];
    if is_far(homed, &rows, per_turn) {
        bench.ask(Task::Place(homed))?;
    }
    bench.ask(Task::LetGo)?;
    Ok(rows)
}

/// Whether a joint has turned by more than [`FAR`] from home [rad] to the last hole, by counts: from there the arm may meet
/// its own links on its way home.
fn is_far(homed: [f64; 2], rows: &[[f64; 4]], per_turn: [f64; 2]) -> bool {
    let Some(last) = rows.last() else {
        return false;
    };
    Joint::ALL.into_iter().any(|joint| {
        let turned = last[joint.index()] / per_turn[joint] - homed[joint] / TAU;
        turned.abs() > FAR
    })
}

#[cfg(test)]
mod tests {
    use super::is_far;
    use std::f64::consts::TAU;

    /// 1000 counts a turn, against the joint in joint 4, and half a turn from zero to home.
    #[test]
    fn what_counts_is_the_turn_from_home_to_the_last_hole_not_that_from_the_first_one() {
        let (homed, per_turn) = ([0.5 * TAU, 0.0], [1000.0, -1000.0]);
        let hole = |turns: [f64; 2]| [1000.0 * turns[0], -1000.0 * turns[1], 0.0, 0.0];
        let (near, far) = (hole([0.6, -0.1]), hole([0.8, 0.0]));
        let others = [hole([0.5, -0.3]), hole([0.2, 0.0])];
        for first in [near, far] {
            assert!(!is_far(homed, &[first, near], per_turn), "{first:?}");
            for last in [far].into_iter().chain(others) {
                assert!(
                    is_far(homed, &[first, last], per_turn),
                    "{first:?}, {last:?}"
                );
            }
        }
        assert!(!is_far(homed, &[], per_turn));
    }
}
