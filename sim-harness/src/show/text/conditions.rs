//! The conditions of a run, as its report lists them.

use super::quantity;
use crate::input::scenario::Scenario;
use fivebar_plant::Mismatch;

/// The conditions of a run: pairs of name and value.
pub fn conditions(scenario: &Scenario) -> Vec<(String, String)> {
    let Mismatch {
        link_mass,
        friction,
        payload,
        current_noise,
        current_offset,
    } = scenario.mismatch;
    let initial = scenario
        .initial_faults
        .iter()
        .map(|kind| format!("{kind:?} from power-up"));
    let later = scenario
        .faults
        .iter()
        .map(|f| format!("{:?} at {} s", f.kind, f.at));
    let faults: Vec<_> = initial.chain(later).collect();
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
        ("payload above the model's", quantity(payload, "kg")),
        (
            "current noise, offset",
            format!("{current_noise}, {current_offset} ADC codes"),
        ),
        ("delay from samples to bridges", "one tick".into()),
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
