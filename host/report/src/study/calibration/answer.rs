//! Calibrations and proposed poses as JSON.

use super::{CalibrationStudy, ProposalStudy, known, micrometres, turned_plate, worse_or_better};
use fivebar_design::calibration::Criterion;
use fivebar_files::robot::Robot;
use serde_json::{Value, json};

/// A calibration as JSON; rows are counted from 1.
pub fn answer(robot: &Robot, study: &CalibrationStudy) -> Value {
    let found = &study.calibration;
    let p = &found.parameters;
    let sd = |index: usize| found.covariance[(index, index)].sqrt();
    let rejected: Vec<usize> = found.rejected.iter().map(|index| index + 1).collect();
    json!({
        "robot": robot.name,
        "rows": found.residuals.len(),
        "link_lengths": p.lengths,
        "link_lengths_sd": [sd(0), sd(1), sd(2), sd(3), sd(4)],
        "joint_offsets": p.offsets,
        "joint_offsets_sd": [sd(5), sd(6)],
        "placement": { "x": p.origin[0], "y": p.origin[1], "phi": p.turn },
        "placement_sd": { "x": sd(7), "y": sd(8), "phi": sd(9) },
        "residual_rms_m": found.residual_rms,
        "leave_out_rms_m": found.leave_out_rms,
        "rejected": rejected,
        "sigma_scale": found.sigma_scale,
        "degrees_of_freedom": known(found.freedom),
        "coverage_factor_95": found.coverage_factor,
        "rank": found.rank,
        "condition": found.condition,
        "nominal_rms_m": found.nominal_rms,
        "tip_error_before_rms_m": study.before.as_ref().map(|error| error.rms),
        "tip_error_rms_m": study.tip_error.as_ref().map(|error| error.rms),
        "tip_error_worst_m": study.tip_error.as_ref().map(|error| error.worst),
        "warnings": warnings(robot, study),
    })
}

/// What a user should look at, as sentences.
pub fn warnings(robot: &Robot, study: &CalibrationStudy) -> Vec<String> {
    let found = &study.calibration;
    let rows = |indices: &[usize]| {
        let numbers: Vec<String> = indices
            .iter()
            .map(|index| (index + 1).to_string())
            .collect();
        numbers.join(", ")
    };
    let mut warnings = Vec::new();
    if !found.rejected.is_empty() {
        let rows = rows(&found.rejected);
        warnings.push(match study.criterion {
            Criterion::Huber => format!(
                "rows {rows} are left out: the others contradict them (of sound plates, one in a hundred loses \
                 a row); check these holes"
            ),
            Criterion::LeastSquares => format!(
                "rows {rows} are farther than {} (4 σ) from the fit, and used: check these holes",
                micrometres(4.0 * study.sigma)
            ),
        });
    }
    warnings.extend(worse_or_better(
        "plate",
        study.sigma,
        found.sigma_scale,
        study.criterion,
    ));
    if !found.other_elbows.is_empty() {
        warnings.push(format!(
            "rows {} were measured with other elbows than the rest",
            rows(&found.other_elbows)
        ));
    }
    if 2 * (found.residuals.len() - found.rejected.len()) < 14 {
        warnings.push("fewer than 7 points: the residuals tell little about their errors".into());
    }
    let lengths = found.parameters.lengths.iter();
    for (index, (found, nominal)) in lengths.zip(robot.geometry.lengths()).enumerate() {
        if (found - nominal).abs() > 0.05 * nominal {
            let part = ["l1", "l2", "l3", "l4", "the base"][index];
            warnings.push(format!(
                "{part} is {} in place of {}: are the points of this arm?",
                micrometres(*found),
                micrometres(nominal)
            ));
        }
    }
    warnings.extend(turned_plate(robot, &found.parameters));
    if robot.tool.offset != [0.0; 2] {
        warnings.push(
            "the robot file has a [tool] offset: the points must be those of C, the joint of links \
             2 and 3"
                .into(),
        );
    }
    warnings
}

/// Proposed poses as JSON.
pub fn proposal_answer(robot: &Robot, study: &ProposalStudy) -> Value {
    let places = study.proposal.points.iter();
    let poses: Vec<[f64; 2]> = places.map(|place| [place.x, place.y]).collect();
    json!({
        "robot": robot.name,
        "poses": poses,
        "observability_o1": study.proposal.observability,
        "tip_error_rms_m": study.tip_error.as_ref().map(|error| error.rms),
        "tip_error_worst_m": study.tip_error.as_ref().map(|error| error.worst),
        "sigma_m": study.sigma,
    })
}
