//! The study as JSON.

use super::{ClearanceStudy, NAMES};
use serde_json::{Value, json};

/// All figures; the run of the new arm is first.
pub fn answer(study: &ClearanceStudy) -> Value {
    let runs: Vec<Value> = study
        .outcomes
        .iter()
        .map(|outcome| {
            let joints = &outcome.record.joints.total;
            json!({
                "clearance_m": outcome.clearance,
                "tip_error": outcome.summary.tip_error,
                "added_error": outcome.added,
                "pin_error": outcome.by_pins,
                "peak_torque_nm": outcome.summary.peak_torque_nm,
                "peak_reaction_n": joints.map(|joint| joint.peak_force),
                "impacts": joints.map(|joint| joint.impacts),
                "fastest_impact_m_s": joints.map(|joint| joint.fastest_impact),
                "flights": joints.map(|joint| joint.flights),
                "flight_share": outcome.flight_share(),
                "saturated_ticks": outcome.summary.saturated_ticks,
                "faults": outcome.summary.faults,
                "predicted": {
                    "seated_m": outcome.prediction.seated,
                    "worst_m": outcome.prediction.worst,
                    "peak_reaction_n": outcome.prediction.reaction,
                },
                "simulated_s": outcome.summary.simulated_s,
                "wall_s": outcome.summary.wall_s,
            })
        })
        .collect();
    json!({
        "robot": study.robot,
        "scenario": study.scenario,
        "joints": NAMES,
        "runs": runs,
    })
}
