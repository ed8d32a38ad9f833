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
    // A key that neither this list nor the one above has does not compile.
    let Mismatch {
        link_mass: _,
        friction: _,
        payload: _,
        current_noise: _,
        current_offset: _,
        link_length,
        base_length,
        home_error,
        torque_constant,
        torque_ripple,
        cogging,
        stiffness,
        drive_damping,
        backlash,
        pulley_run_out,
        tooth_mesh,
        stiction,
        encoder_error,
        encoder_latency,
        supply_resistance,
        pen_friction,
        paper_growth,
    } = mismatch;
    let stiffness = stiffness.unwrap_or_default();
    let harmonics = encoder_error.map(|error| {
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
        ("link lengths", each(link_length, "m")),
        ("base length", each(&[*base_length], "m")),
        ("home switches", each(home_error, "rad")),
        ("torque constants", percent(torque_constant)),
        ("torque ripple", percent(torque_ripple)),
        ("cogging", each(cogging, "N·m")),
        ("drive stiffness", each(&stiffness, "N·m/rad")),
        ("drive damping", each(drive_damping, "N·m·s/rad")),
        ("backlash", each(backlash, "rad")),
        ("pulley run-out", each(pulley_run_out, "rad")),
        ("tooth mesh", each(tooth_mesh, "rad")),
        ("stiction", percent(stiction)),
        ("encoder error", encoder_error),
        ("encoder latency", each(encoder_latency, "s")),
        ("supply resistance", each(&[*supply_resistance], "Ω")),
        ("friction of the pen", each(&[*pen_friction], "N")),
        ("growth of the paper", percent(paper_growth)),
    ];
    let on = all.into_iter();
    on.filter_map(|(name, value)| Some((name, value?)))
        .collect()
}
