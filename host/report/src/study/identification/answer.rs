//! Identifications and proposed excitations as JSON.

use super::Validations;
use fivebar_design::identification::{BASE_NAMES, Identification, Payload, ProposedExcitation};
use fivebar_files::robot::Robot;
use serde_json::{Map, Value, json};

/// An identification as JSON. The base parameters have the rotors within them.
pub fn answer(robot: &Robot, rows: usize, found: &Identification) -> Value {
    let named = |values: &[f64]| -> Value {
        let pairs = BASE_NAMES.iter().zip(values);
        let map: Map<String, Value> = pairs
            .map(|(name, value)| ((*name).to_owned(), json!(value)))
            .collect();
        Value::Object(map)
    };
    json!({
        "robot": robot.name,
        "rows": rows,
        "base_parameters": named(&found.base),
        "base_parameters_sd": named(&found.base_sd),
        "viscous": found.viscous,
        "viscous_sd": found.viscous_sd,
        "coulomb": found.coulomb,
        "coulomb_sd": found.coulomb_sd,
        "offset_nm": found.offset,
        "offset_nm_sd": found.offset_sd,
        "condition": found.condition,
        "torque_residual_rms_nm": found.residual_rms,
        "unexplained_share": found.residual_share,
        "coverage_factor_95": found.coverage_factor,
        "left_out_share": found.left_out,
    })
}

/// How well a second log's torques are predicted, as JSON.
pub fn validation_answer(found: Validations) -> Value {
    let Validations { before, after } = found;
    json!({
        "torque_rms_nm": after.torque_rms,
        "error_rms_nm": after.rms,
        "error_share": after.rms / after.torque_rms,
        "error_of_the_file_rms_nm": before.map(|before| before.rms),
        "error_of_the_file_share": before.map(|before| before.rms / before.torque_rms),
    })
}

/// A payload as JSON.
pub fn payload_answer(robot: &Robot, rows: usize, found: &Payload) -> Value {
    json!({
        "robot": robot.name,
        "rows": rows,
        "payload_kg": found.mass,
        "payload_kg_sd": found.sd,
        "torque_residual_rms_nm": found.residual_rms,
    })
}

/// Excitations as JSON, in the form of the reference's files.
pub fn proposal_answer(robot: &Robot, found: &[ProposedExcitation; 2]) -> Value {
    let [first, second] = found.map(|proposed| proposed.excitation.coefficients.to_vec());
    json!({
        "robot": robot.name,
        "note": "2 trajectories (identification, validation), each 2 joints x (q0, a1..a5, \
                 b1..b5), q = q0 + sum a_k/(k wf) sin(k wf t) - b_k/(k wf) cos(k wf t)",
        "period_s": found[0].excitation.period,
        "x": [first, second],
        "cost": found.map(|proposed| proposed.condition.log10()),
        "condition": found.map(|proposed| proposed.condition),
    })
}
