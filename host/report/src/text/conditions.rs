//! The conditions of a run, as its report lists them.

use super::quantity;
use fivebar_files::scenario::Scenario;
use fivebar_plant::Mismatch;

/// The conditions of a run: pairs of name and value.
pub fn conditions(scenario: &Scenario) -> Vec<(String, String)> {
    let mismatch = &scenario.mismatch;
    let initial = scenario
        .initial_faults
        .iter()
        .map(|kind| format!("{kind:?} from power-up"));
    let later = scenario
        .faults
        .iter()
        .map(|f| format!("{:?} at {} s", f.kind, f.at));
    let faults: Vec<_> = initial.chain(later).collect();
    let mut conditions = vec![
        ("control", scenario.control_law.to_string()),
        (
            "link masses and inertias",
            format!("{:+.0} %", 100.0 * mismatch.link_mass),
        ),
        ("friction", format!("{:+.0} %", 100.0 * mismatch.friction)),
        (
            "payload above the model's",
            quantity(mismatch.payload, "kg"),
        ),
        (
            "current noise, offset",
            format!(
                "{}, {} ADC codes",
                mismatch.current_noise, mismatch.current_offset
            ),
        ),
        ("delay from samples to bridges", "one tick".into()),
        ("seed", scenario.seed.to_string()),
    ];
    conditions.extend(effects(mismatch));
    if !faults.is_empty() {
        conditions.push(("faults", faults.join("; ")));
    }
    conditions
        .into_iter()
        .map(|(name, value)| (name.to_owned(), value))
        .collect()
}

/// The effects of parts that are not ideal, as far as they are on.
fn effects(mismatch: &Mismatch) -> Vec<(&'static str, String)> {
    let each = |values: &[f64], unit: &str| {
        let on = values.iter().any(|&value| value != 0.0);
        on.then(|| {
            let values = values.iter().map(|value| quantity(*value, unit));
            values.collect::<Vec<_>>().join(", ")
        })
    };
    let percent = |values: &[f64]| {
        let on = values.iter().any(|&value| value != 0.0);
        on.then(|| {
            let values = values.iter().map(|value| format!("{:.3} %", 100.0 * value));
            values.collect::<Vec<_>>().join(", ")
        })
    };
    let stiffness = mismatch.stiffness.unwrap_or_default();
    let harmonics = mismatch.encoder_error.map(|error| {
        let terms = error.terms().iter().map(|term| {
            let size = quantity(term.amplitude, "rad");
            format!("{size} at harmonic {}", term.harmonic)
        });
        terms.collect::<Vec<_>>().join(" + ")
    });
    let encoder_error = harmonics
        .iter()
        .any(|text| !text.is_empty())
        .then(|| harmonics.join("; "));
    let all = [
        ("link lengths", each(&mismatch.link_length, "m")),
        ("base length", each(&[mismatch.base_length], "m")),
        ("home switches", each(&mismatch.home_error, "rad")),
        ("torque constants", percent(&mismatch.torque_constant)),
        ("torque ripple", percent(&mismatch.torque_ripple)),
        ("cogging", each(&mismatch.cogging, "N·m")),
        ("drive stiffness", each(&stiffness, "N·m/rad")),
        ("drive damping", each(&mismatch.drive_damping, "N·m·s/rad")),
        ("backlash", each(&mismatch.backlash, "rad")),
        ("stiction", percent(&mismatch.stiction)),
        ("encoder error", encoder_error),
        ("encoder latency", each(&mismatch.encoder_latency, "s")),
        (
            "supply resistance",
            each(&[mismatch.supply_resistance], "Ω"),
        ),
    ];
    let on = all.into_iter();
    on.filter_map(|(name, value)| Some((name, value?)))
        .collect()
}
