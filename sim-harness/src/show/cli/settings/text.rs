//! A controller's settings as TOML, with the unit of each value.

use fivebar_firmware::Settings;

/// The unit of each key, by the table that it stands in; "" for numbers without a unit.
const UNITS: &[(&str, &[(&str, &str)])] = &[
    (
        "",
        &[
            ("lengths", "m: l1, l2, l3, l4, base"),
            ("payload", "kg"),
            ("gravity", "m/s²"),
            ("tool_offset", "m"),
            ("elbows_left", ""),
            ("assembly_left", ""),
            ("crossing_allowed", ""),
            ("tool_output", ""),
        ],
    ),
    (
        "links",
        &[
            ("mass", "kg"),
            ("com", "m"),
            ("inertia", "kg·m², about the centre of mass"),
        ],
    ),
    (
        "axes",
        &[
            ("gear_ratio", ""),
            ("rotor_inertia", "kg·m², at the motor's shaft"),
            ("torque_constant", "N·m/A"),
            ("resistance", "Ω"),
            ("inductance", "H"),
            ("viscous_friction", "N·m·s/rad, at the joint"),
            ("coulomb_friction", "N·m, at the joint"),
            ("encoder_counts", "counts per motor turn"),
            ("index_counts", "counts from one index pulse to the next"),
            ("encoder_latency", "s"),
            ("home_angle", "rad"),
            ("home_forward", ""),
            ("angle_limits", "rad"),
            ("max_speed", "rad/s"),
            ("max_acceleration", "rad/s²"),
            ("peak_current", "A"),
            ("continuous_current", "A"),
            ("thermal_time_constant", "s"),
            ("current_per_code", "A per ADC code"),
            ("current_zero_code", "ADC code"),
        ],
    ),
    (
        "encoder_tables",
        &[
            ("shaft_ratio", "turns of the encoder per turn of the joint"),
            ("points", "error of the shaft, in 1/32768 rad"),
        ],
    ),
    (
        "control",
        &[
            ("tick_rate", "Hz"),
            ("bandwidth", "rad/s"),
            ("damping", ""),
            ("integral_rate", "rad/s"),
            ("observer_bandwidth", "rad/s"),
            ("current_bandwidth", "rad/s"),
            ("friction_smoothing", "rad/s"),
            ("computed_torque", ""),
        ],
    ),
    (
        "brake",
        &[
            ("engage_time", "s, to full torque; 0 without brakes"),
            ("release_time", "s, to a free joint; 0 without brakes"),
        ],
    ),
    (
        "homing",
        &[
            ("speed", "rad/s"),
            ("back_off", "rad"),
            ("current", "A, of the motor"),
        ],
    ),
    ("home_reference", &[("method", ""), ("samples", "in a row")]),
    (
        "motion",
        &[
            ("max_speed", "m/s"),
            ("max_acceleration", "m/s²"),
            ("max_jerk", "m/s³"),
            ("corner_tolerance", "m"),
            ("singularity_margin", ""),
        ],
    ),
    (
        "protection",
        &[
            ("following_error", "rad"),
            ("over_speed", "rad/s"),
            ("over_current", "A"),
            ("bus_voltage", "V"),
            ("bus_voltage_per_code", "V per ADC code"),
            ("command_timeout", "s"),
        ],
    ),
    (
        "tool_output.Servo",
        &[
            ("up_width", "s"),
            ("down_width", "s"),
            ("frame_rate", "Hz"),
            ("down_time", "s"),
            ("up_time", "s"),
        ],
    ),
    (
        "tool_output.Switch",
        &[("active_low", ""), ("down_time", "s"), ("up_time", "s")],
    ),
    (
        "tool_output.Power",
        &[("frequency", "Hz"), ("scale_with_speed", "")],
    ),
];

fn unit(table: &str, key: &str) -> Option<&'static str> {
    let (_, keys) = UNITS.iter().find(|(name, _)| *name == table)?;
    keys.iter()
        .find(|(name, _)| *name == key)
        .map(|(_, unit)| *unit)
}

/// Settings as TOML, which [`parse`] reads back, each number with its unit as a comment.
///
/// # Errors
/// A value that TOML does not have.
pub(super) fn write(settings: &Settings) -> Result<String, toml::ser::Error> {
    let mut table = "";
    let mut lines = String::new();
    let text = toml::to_string(settings)?;
    for line in text.lines() {
        lines += line;
        if line.starts_with('[') {
            table = line.trim_matches(['[', ']']);
        } else if let Some((key, _)) = line.split_once(" = ")
            && let Some(unit) = unit(table, key)
            && !unit.is_empty()
        {
            lines += "  # ";
            lines += unit;
        }
        lines += "\n";
    }
    Ok(lines)
}

/// Reads settings that [`write`] has written.
///
/// # Errors
/// Text that is not TOML, an unknown kind of value, a missing key.
pub(super) fn parse(text: &str) -> Result<Settings, toml::de::Error> {
    toml::from_str(text)
}

#[cfg(test)]
mod tests {
    use super::*;
    use fivebar_firmware::settings::ToolOutputSettings;

    /// Settings with each kind of output.
    fn all() -> Vec<Settings> {
        let outputs = [
            ToolOutputSettings::None,
            ToolOutputSettings::Servo {
                up_width: 1e-3,
                down_width: 1.5e-3,
                frame_rate: 50.0,
                down_time: 0.1,
                up_time: 0.1,
            },
            ToolOutputSettings::Switch {
                active_low: true,
                down_time: 0.1,
                up_time: 0.1,
            },
            ToolOutputSettings::Power {
                frequency: 1e3,
                scale_with_speed: true,
            },
        ];
        let with = |tool_output| Settings {
            tool_output,
            ..Settings::BENCHTOP
        };
        outputs.map(with).to_vec()
    }

    #[test]
    fn what_is_written_is_read_back_bit_for_bit() {
        for settings in all() {
            let text = write(&settings).unwrap();
            assert_eq!(parse(&text).unwrap(), settings, "{text}");
        }
        let mut settings = Settings::BENCHTOP;
        settings.axes[1].inductance = 1.234_567_9e-4;
        settings.links[3].inertia = f32::MIN_POSITIVE;
        assert_eq!(parse(&write(&settings).unwrap()).unwrap(), settings);
    }

    #[test]
    fn every_key_has_its_unit_or_is_known_to_have_none() {
        let mut table = String::new();
        let mut keys = 0;
        for settings in all() {
            for line in write(&settings).unwrap().lines() {
                if line.starts_with('[') {
                    table = line.trim_matches(['[', ']']).into();
                } else if let Some((key, _)) = line.split_once(" = ") {
                    assert!(unit(&table, key).is_some(), "[{table}] {key}");
                    keys += 1;
                }
            }
            table.clear();
        }
        assert!(keys > 200, "{keys} keys");
    }

    #[test]
    fn a_missing_key_and_a_word_for_a_number_are_refused() {
        let text = write(&Settings::BENCHTOP).unwrap();
        let without: String = text
            .lines()
            .filter(|line| !line.starts_with("payload"))
            .map(|line| format!("{line}\n"))
            .collect();
        assert!(parse(&without).unwrap_err().message().contains("payload"));
        let word = text.replace("tick_rate = 10000.0", "tick_rate = \"fast\"");
        assert_ne!(word, text);
        assert!(parse(&word).is_err());
    }
}
