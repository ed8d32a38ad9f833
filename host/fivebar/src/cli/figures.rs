//! A JSON object as text: one figure per line, with its unit.

use fivebar_report::text::quantity;
use serde_json::Value;
use std::fmt::Write as _;

/// Endings of keys, longer ones first, with their units.
const UNITS: [(&str, &str); 14] = [
    ("_rad_s2", "rad/s²"),
    ("_rad_s", "rad/s"),
    ("_rad", "rad"),
    ("_m_s2", "m/s²"),
    ("_m_s", "m/s"),
    ("_m2", "m²"),
    ("_nm", "N·m"),
    ("_n", "N"),
    ("_m", "m"),
    ("_s", "s"),
    ("position_covariance", "m²"),
    ("share", "%"),
    ("share_x", "%"),
    ("share_y", "%"),
];

/// Less than this is rounding, in any unit.
const NOTHING: f64 = 1e-15;

/// Most objects of a list that is shown; of a longer list only the length is shown.
const LISTED: usize = 12;

/// The figures of an object, one per line; the names come first.
pub(super) fn figures(answer: &Value) -> String {
    let mut text = String::new();
    if let Value::Object(fields) = answer {
        let named = |(_, value): &(&String, &Value)| value.is_string();
        let (names, others): (Vec<_>, Vec<_>) = fields.iter().partition(named);
        block(&mut text, names, 0, "");
        block(&mut text, others, 0, "");
    }
    text
}

/// Writes fields. `unit` is that of the key above; fields whose keys are names use it.
fn block<'a>(
    text: &mut String,
    fields: impl IntoIterator<Item = (&'a String, &'a Value)>,
    depth: usize,
    unit: &str,
) {
    for (key, value) in fields {
        if is_zero(value) {
            continue;
        }
        let (label, own) = label_and_unit(key);
        let unit = if own.is_empty() { unit } else { own };
        let _ = write!(text, "{:1$}{label}:", "", 2 * depth);
        match value {
            Value::Object(inner) => {
                text.push('\n');
                block(text, inner, depth + 1, unit);
            }
            Value::Array(items) if items.iter().any(Value::is_object) && items.len() > LISTED => {
                let _ = writeln!(text, " {} entries (printed with --json)", items.len());
            }
            Value::Array(items) if items.iter().any(Value::is_object) => {
                text.push('\n');
                for item in items {
                    let _ = writeln!(text, "{:1$}{2}", "", 2 * depth + 2, row(item));
                }
            }
            other => {
                let _ = writeln!(text, " {}", plain(other, unit));
            }
        }
    }
}

/// Whether a value holds measured figures only, and all are 0: what was not asked for.
fn is_zero(value: &Value) -> bool {
    match value {
        Value::Number(number) => {
            number.is_f64() && number.as_f64().is_some_and(|value| value.abs() < NOTHING)
        }
        Value::Array(items) => !items.is_empty() && items.iter().all(is_zero),
        Value::Object(fields) => !fields.is_empty() && fields.values().all(is_zero),
        Value::Null | Value::Bool(_) | Value::String(_) => false,
    }
}

/// The fields of an object on one line, its name first. The field `sd` is left out, because
/// its unit depends on the name.
fn row(item: &Value) -> String {
    let name = item.get("name").and_then(Value::as_str);
    let fields = item.as_object().into_iter().flatten();
    let rest = fields.filter(|(key, _)| !["name", "sd"].contains(&key.as_str()));
    let rest = rest.map(|(key, value)| {
        let (label, unit) = label_and_unit(key);
        format!("{label} {}", plain(value, unit))
    });
    let rest: Vec<String> = rest.collect();
    match name {
        Some(name) => format!("{name}: {}", rest.join(", ")),
        None => rest.join(", "),
    }
}

/// The label of a key, and the unit at its end.
fn label_and_unit(key: &str) -> (String, &'static str) {
    let found = UNITS.iter().find(|(ending, _)| key.ends_with(ending));
    let (label, unit) = match found {
        // An ending without underscore is part of the label.
        Some((ending, unit)) if ending.starts_with('_') => {
            (key.strip_suffix(ending).unwrap_or(key), *unit)
        }
        Some((_, unit)) => (key, *unit),
        None => (key, ""),
    };
    (label.replace('_', " "), unit)
}

fn plain(value: &Value, unit: &str) -> String {
    match value {
        Value::Number(number) if number.is_f64() => {
            measured(number.as_f64().unwrap_or(f64::NAN), unit)
        }
        Value::Number(count) => count.to_string(),
        Value::String(text) => text.clone(),
        Value::Bool(true) => "yes".into(),
        Value::Bool(false) => "no".into(),
        Value::Null => "not known".into(),
        Value::Array(items) => {
            let nested = items.iter().any(Value::is_array);
            let items: Vec<String> = items.iter().map(|item| plain(item, unit)).collect();
            items.join(if nested { "; " } else { ", " })
        }
        Value::Object(_) => row(value),
    }
}

fn measured(value: f64, unit: &str) -> String {
    match unit {
        "" if value == 0.0 || (1e-3..1e5).contains(&value.abs()) => format!("{value:.4}"),
        "" => format!("{value:.3e}"),
        "%" => format!("{:.1} %", 100.0 * value),
        // A prefix would be squared with the unit.
        "m²" => format!("{value:.3e} m²"),
        _ => quantity(value, unit),
    }
}

#[cfg(test)]
mod tests {
    use super::figures;
    use serde_json::json;

    #[test]
    fn every_figure_is_on_a_line_with_its_unit() {
        let text = figures(&json!({
            "robot": "benchtop",
            "position_sd_m": [2.2979e-5, 0.5],
            "position_covariance": [[5.28e-10, 0.0], [0.0, 4.45e-10]],
            "contributors": [{ "name": "θ1", "sd": 5e-5, "share": 0.0255, "share_x": 0.5 }],
            "monte_carlo": { "samples": 100, "torque_sd_nm": null, "reaction_sd_n": { "a": [1.5, 0.0] } },
            "settled": true,
            "places": vec![json!({ "at_m": 1.0 }); 13],
        }));
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(
            lines,
            [
                "robot: benchtop",
                "contributors:",
                "  θ1: share 2.5 %, share x 50.0 %",
                "monte carlo:",
                "  reaction sd:",
                "    a: 1.50 N, 0 N",
                "  samples: 100",
                "  torque sd: not known",
                "places: 13 entries (printed with --json)",
                "position covariance: 5.280e-10 m², 0.000e0 m²; 0.000e0 m², 4.450e-10 m²",
                "position sd: 23.0 µm, 500 mm",
                "settled: yes",
            ]
        );
    }
}
