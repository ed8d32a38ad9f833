//! A controller's settings as TOML, with the unit of each value.

use fivebar_firmware::Settings;
use fivebar_firmware::settings::{Row, rows};

/// The unit of a key of a table, and what it refers to; none for what is no number.
fn unit(table: &str, key: &str) -> Option<String> {
    // The kinds of output for a tool have one table each.
    let table = table.split('.').next().unwrap_or_default();
    let path = [table, key].join(".");
    let path = path.trim_start_matches('.');
    let Row { unit, note, .. } = rows().find(|row| row.path == path)?;
    let between = match (unit, note) {
        ("", _) | (_, "") => "",
        _ if note.starts_with("per ") => " ",
        _ => ", ",
    };
    Some([unit, between, note].concat())
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
            lines += &unit;
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
    fn every_number_has_a_row_in_the_table_of_settings() {
        let mut table = String::new();
        let mut keys = 0;
        for settings in all() {
            for line in write(&settings).unwrap().lines() {
                if line.starts_with('[') {
                    table = line.trim_matches(['[', ']']).into();
                } else if let Some((key, value)) = line.split_once(" = ")
                    && value.contains(|letter: char| letter.is_ascii_digit())
                {
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
