//! Calibration of a robot from measurements of several kinds.

use super::{
    StudyError, bare_workspace, counts_per_turn, encoder_angle, known, micrometres, turned_plate,
    worse_or_better,
};
use fivebar_design::calibration::{
    Bar, Criterion, Deviations, HoleTouch, Measurements, MixedCalibration, PhotoPoint, TipError,
    Touch, calibrate_mixed, tip_error, tip_error_before, tip_error_best_placed,
};
use fivebar_files::robot::Robot;
use nalgebra::Vector2;
use serde_json::{Value, json};

/// Rows of tables of measurements, in counts, metres and pixels.
#[derive(Clone, Debug, Default)]
pub struct Rows {
    /// counts1, counts4, x, y of known holes.
    pub plate: Vec<[f64; 4]>,
    /// counts1 and counts4 of one pose, of another, and their distance.
    pub bars: Vec<[f64; 5]>,
    /// hole, counts1, counts4.
    pub holes: Vec<[f64; 3]>,
    /// counts1, counts4, u, v of each photograph.
    pub photos: Vec<Vec<[f64; 4]>>,
}

/// A robot calibrated from measurements of several kinds.
#[derive(Debug)]
pub struct MixedStudy {
    /// The result.
    pub calibration: MixedCalibration,
    /// The error of the nominal arm over the workspace, after its best placement.
    pub before: Option<TipError>,
    /// The expected error of the tip over the workspace; without a plate after the best placement.
    pub tip_error: Option<TipError>,
    deviations: Deviations,
    criterion: Criterion,
}

/// Calibrates a robot.
///
/// # Errors
/// The robot has no counts or no pose at home, or the measurements are refused.
pub fn calibrate_robot_mixed(
    robot: &Robot,
    rows: &Rows,
    deviations: Deviations,
    criterion: Criterion,
) -> Result<MixedStudy, StudyError> {
    let per_turn = counts_per_turn(robot)?;
    let encoder = |counts1, counts4| {
        [
            encoder_angle(counts1, per_turn[0]),
            encoder_angle(counts4, per_turn[1]),
        ]
    };
    let home = robot.home_pose()?;
    let touch = |&[counts1, counts4, x, y]: &[f64; 4]| Touch {
        encoder: encoder(counts1, counts4),
        hole: Vector2::new(x, y),
    };
    let bar = |&[a1, a4, b1, b4, length]: &[f64; 5]| Bar {
        encoders: [encoder(a1, a4), encoder(b1, b4)],
        length,
    };
    let hole = |&[hole, counts1, counts4]: &[f64; 3]| HoleTouch {
        hole: hole as i64,
        encoder: encoder(counts1, counts4),
    };
    let point = |&[counts1, counts4, u, v]: &[f64; 4]| PhotoPoint {
        encoder: encoder(counts1, counts4),
        pixel: Vector2::new(u, v),
    };
    let photo = |rows: &Vec<[f64; 4]>| rows.iter().map(point).collect();
    let broken = rows.holes.iter().position(|row| row[0].fract() != 0.0);
    if let Some(index) = broken {
        return Err(StudyError::HoleNumber(index + 1, rows.holes[index][0]));
    }
    let measured = Measurements {
        plate: rows.plate.iter().map(touch).collect(),
        bars: rows.bars.iter().map(bar).collect(),
        holes: rows.holes.iter().map(hole).collect(),
        photos: rows.photos.iter().map(photo).collect(),
        assembly: home.assembly(),
        deviations,
        criterion,
    };
    let calibration = calibrate_mixed(&measured, robot.geometry.lengths())?;
    let p = &calibration.parameters;
    let workspace = bare_workspace(robot, p.lengths)?;
    let error_of = if calibration.placed {
        tip_error
    } else {
        tip_error_best_placed
    };
    Ok(MixedStudy {
        tip_error: error_of(p, &calibration.covariance, &workspace, &home),
        before: tip_error_before(p, &bare_workspace(robot, robot.geometry.lengths())?, &home),
        calibration,
        deviations,
        criterion,
    })
}

/// A calibration from several kinds as JSON; rows are counted from 1.
pub fn mixed_answer(robot: &Robot, study: &MixedStudy) -> Value {
    let found = &study.calibration;
    let p = &found.parameters;
    let sd = |index: usize| found.covariance[(index, index)].sqrt();
    let kinds = found.kinds.iter().map(|kind| {
        let rejected: Vec<usize> = kind.rejected.iter().map(|index| index + 1).collect();
        json!({
            "name": kind.kind,
            "rows": kind.distances.len(),
            "sigma_m": sigma_of(study, &kind.kind),
            "residual_rms_m": kind.residual_rms,
            "rejected": rejected,
            "sigma_scale": kind.sigma_scale,
            "degrees_of_freedom": known(kind.freedom),
        })
    });
    let placed = |value: Value| if found.placed { value } else { Value::Null };
    json!({
        "robot": robot.name,
        "link_lengths": p.lengths,
        "link_lengths_sd": [sd(0), sd(1), sd(2), sd(3), sd(4)],
        "joint_offsets": p.offsets,
        "joint_offsets_sd": [sd(5), sd(6)],
        "placement": placed(json!({ "x": p.origin[0], "y": p.origin[1], "phi": p.turn })),
        "placement_sd": placed(json!({ "x": sd(7), "y": sd(8), "phi": sd(9) })),
        "kinds": kinds.collect::<Vec<_>>(),
        "coverage_factor_95": found.coverage_factor,
        "rank": found.rank,
        "condition": found.condition,
        "tip_error_before_rms_m": study.before.as_ref().map(|error| error.rms),
        "tip_error_rms_m": study.tip_error.as_ref().map(|error| error.rms),
        "tip_error_worst_m": study.tip_error.as_ref().map(|error| error.worst),
        "warnings": mixed_warnings(robot, study),
    })
}

fn sigma_of(study: &MixedStudy, kind: &str) -> f64 {
    match kind {
        "plate" => study.deviations.plate,
        "bars" => study.deviations.bar,
        "holes" => study.deviations.hole,
        _ => study.deviations.photo,
    }
}

/// What a user should look at, as sentences.
pub fn mixed_warnings(robot: &Robot, study: &MixedStudy) -> Vec<String> {
    let mut warnings = Vec::new();
    if study.calibration.placed {
        warnings.extend(turned_plate(robot, &study.calibration.parameters));
    }
    let excess = study.calibration.excess;
    if excess < 5 {
        warnings.push(format!(
            "only {excess} more measurements than unknowns: nothing checks them, so the residuals tell \
             little; measure more"
        ));
    }
    for kind in &study.calibration.kinds {
        let (name, sigma) = (&kind.kind, sigma_of(study, &kind.kind));
        if !kind.rejected.is_empty() {
            let rows = kind.rejected.iter().map(|index| (index + 1).to_string());
            let rows = rows.collect::<Vec<_>>().join(", ");
            warnings.push(match study.criterion {
                Criterion::Huber => {
                    format!("{name}: rows {rows} are left out, because the others contradict them")
                }
                Criterion::LeastSquares => format!(
                    "{name}: rows {rows} are farther than {} (4 σ) from the fit, and used",
                    micrometres(4.0 * sigma)
                ),
            });
        }
        warnings.extend(worse_or_better(
            name,
            sigma,
            kind.sigma_scale,
            study.criterion,
        ));
    }
    warnings
}
