//! The conditions of a run, for its report.

use super::quantity;
use crate::input::scenario::{Mismatch, Scenario};

/// The conditions of the run by name and value, for its report.
pub fn conditions(scenario: &Scenario) -> Vec<(String, String)> {
    let Mismatch {
        link_mass,
        friction,
        payload,
        current_noise,
        current_offset,
    } = scenario.mismatch;
    let broken = scenario
        .broken
        .iter()
        .map(|kind| format!("{kind:?} from power-up"));
    let breaking = scenario
        .faults
        .iter()
        .map(|f| format!("{:?} at {} s", f.kind, f.at));
    let faults: Vec<_> = broken.chain(breaking).collect();
    let control = if scenario.computed_torque {
        "computed torque"
    } else {
        "PD alone"
    };
    let mut conditions = vec![
        ("control", control.into()),
        (
            "link masses and inertias",
            format!("{:+.0} %", 100.0 * link_mass),
        ),
        ("friction", format!("{:+.0} %", 100.0 * friction)),
        ("payload not known of", quantity(payload, "kg")),
        (
            "current noise, offset",
            format!("{current_noise}, {current_offset} ADC codes"),
        ),
        ("from samples to bridges", "one tick".into()),
        ("seed", scenario.seed.to_string()),
    ];
    if !faults.is_empty() {
        conditions.push(("faults", faults.join("; ")));
    }
    conditions
        .into_iter()
        .map(|(name, value)| (name.to_owned(), value))
        .collect()
}
