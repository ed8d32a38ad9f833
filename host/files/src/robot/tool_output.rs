//! `[tool_output]`: the output for a tool.

use super::Robot;
use crate::job::ToolLevels;
use crate::refusal::{Key, Refusal};
use fivebar_firmware::settings::{Field, ToolOutputSettings};
use serde::Deserialize;

const SECTION: &str = "tool_output";

/// Greatest part of a frame that a pulse may take.
const LONGEST_PULSE: f64 = 0.9;

/// The section as written. Which keys it needs depends on its `kind`.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(super) struct ToolOutputFile {
    kind: Option<String>,
    up_width: Option<f64>,
    down_width: Option<f64>,
    frame_rate: Option<f64>,
    down_time: Option<f64>,
    up_time: Option<f64>,
    active_low: Option<bool>,
    frequency: Option<f64>,
    scale_with_speed: Option<bool>,
    down_s: Option<f64>,
    up_s: Option<f64>,
}

/// The keys of each kind.
const KINDS: [(&str, &[&str]); 3] = [
    (
        "servo",
        &[
            "up_width",
            "down_width",
            "frame_rate",
            "down_time",
            "up_time",
            "down_s",
            "up_s",
        ],
    ),
    (
        "switch",
        &["active_low", "down_time", "up_time", "down_s", "up_s"],
    ),
    ("power", &["frequency", "scale_with_speed"]),
];

impl ToolOutputFile {
    /// The names of the keys that are given.
    fn given(&self) -> impl Iterator<Item = &'static str> {
        [
            ("up_width", self.up_width.is_some()),
            ("down_width", self.down_width.is_some()),
            ("frame_rate", self.frame_rate.is_some()),
            ("down_time", self.down_time.is_some()),
            ("up_time", self.up_time.is_some()),
            ("active_low", self.active_low.is_some()),
            ("frequency", self.frequency.is_some()),
            ("scale_with_speed", self.scale_with_speed.is_some()),
            ("down_s", self.down_s.is_some()),
            ("up_s", self.up_s.is_some()),
        ]
        .into_iter()
        .filter_map(|(name, is_given)| is_given.then_some(name))
    }
}

impl Robot {
    /// The levels of the tool, for the S of jobs.
    pub fn tool_levels(&self) -> ToolLevels {
        match self.tool_output {
            ToolOutputSettings::Servo { .. } | ToolOutputSettings::Switch { .. } => {
                ToolLevels::TwoStates(self.tool_speeds)
            }
            ToolOutputSettings::None | ToolOutputSettings::Power { .. } => ToolLevels::Shares,
        }
    }
}

/// Checks the section. Also gives S of M3 and M4 with the tool down and up, if they are stated.
pub(super) fn read_tool_output(
    file: &ToolOutputFile,
) -> Result<(ToolOutputSettings, Option<[f64; 2]>), Refusal> {
    Ok((output(file)?, speeds(file)?))
}

fn speeds(file: &ToolOutputFile) -> Result<Option<[f64; 2]>, Refusal> {
    let refuse = |name, reason: String| Err(Key::In(SECTION, name).refused(reason));
    let both = match (file.down_s, file.up_s) {
        (None, None) => return Ok(None),
        (Some(down), Some(up)) => [("down_s", down), ("up_s", up)],
        (None, Some(_)) => return refuse("down_s", "is missing beside `up_s`".into()),
        (Some(_), None) => return refuse("up_s", "is missing beside `down_s`".into()),
    };
    for (name, value) in both {
        if !(value >= 0.0 && value.is_finite()) {
            return refuse(name, format!("must be 0 or above, not {value:?}"));
        }
    }
    let [(_, down), (_, up)] = both;
    if down == up {
        return refuse("down_s", "must not be the same as `up_s`".into());
    }
    Ok(Some([down, up]))
}

fn output(file: &ToolOutputFile) -> Result<ToolOutputSettings, Refusal> {
    let refuse = |name, reason: String| Err(Key::In(SECTION, name).refused(reason));
    let Some(kind) = file.kind.as_deref() else {
        return match file.given().next() {
            None => Ok(ToolOutputSettings::None),
            Some(_) => refuse(
                "kind",
                "is missing: \"servo\", \"switch\" or \"power\"".into(),
            ),
        };
    };
    let Some((_, keys)) = KINDS.iter().find(|(name, _)| *name == kind) else {
        let reason = format!("must be \"servo\", \"switch\" or \"power\", not \"{kind}\"");
        return refuse("kind", reason);
    };
    if let Some(stray) = file.given().find(|name| !keys.contains(name)) {
        let reason = format!(
            "is no key of kind \"{kind}\", which has {}",
            keys.join(", ")
        );
        return refuse(stray, reason);
    }
    let number = |name, value: Option<f64>, field: Field| {
        let row = field.row();
        let Some(value) = value.or(row.default) else {
            let reason = format!("is missing: kind \"{kind}\" needs it");
            return Err(Key::In(SECTION, name).refused(reason));
        };
        // As the controller compares them, in single precision.
        let [least, greatest] = row.range.map(|bound| bound as f32);
        if (least..=greatest).contains(&(value as f32)) {
            return Ok(value as f32);
        }
        let unit = row.unit;
        let reason = format!("must be {least:?} to {greatest:?} {unit}, not {value:?}");
        Err(Key::In(SECTION, name).refused(reason))
    };
    let settle = |name, value| number(name, value, Field::ToolSettleTime);
    Ok(match kind {
        "servo" => {
            let frame_rate = number("frame_rate", file.frame_rate, Field::ToolFrameRate)?;
            let width = |name, value| {
                let width = number(name, value, Field::ToolPulseWidth)?;
                let longest = LONGEST_PULSE / f64::from(frame_rate);
                if f64::from(width) > longest * (1.0 - 1e-6) {
                    let reason =
                        format!("must be at most {longest:.2e} s, 90 % of a frame, not {width:?}");
                    return Err(Key::In(SECTION, name).refused(reason));
                }
                Ok(width)
            };
            let up_width = width("up_width", file.up_width)?;
            let down_width = width("down_width", file.down_width)?;
            if up_width == down_width {
                return refuse("down_width", "must not be the same as `up_width`".into());
            }
            ToolOutputSettings::Servo {
                up_width,
                down_width,
                frame_rate,
                down_time: settle("down_time", file.down_time)?,
                up_time: settle("up_time", file.up_time)?,
            }
        }
        "switch" => ToolOutputSettings::Switch {
            active_low: file.active_low.unwrap_or(false),
            down_time: settle("down_time", file.down_time)?,
            up_time: settle("up_time", file.up_time)?,
        },
        _ => ToolOutputSettings::Power {
            frequency: number("frequency", file.frequency, Field::ToolFrequency)?,
            scale_with_speed: file.scale_with_speed.unwrap_or(false),
        },
    })
}

#[cfg(test)]
mod tests {
    use crate::robot::{BuiltIn, Robot};
    use fivebar_firmware::settings::ToolOutputSettings;

    const SERVO: &str =
        "kind = \"servo\"\nup_width = 1e-3\ndown_width = 2e-3\ndown_time = 0.1\nup_time = 0.05\n";

    fn read(section: &str) -> Result<ToolOutputSettings, String> {
        let text = BuiltIn::find(BuiltIn::DEFAULT).unwrap().text;
        let robot = Robot::parse("arm.toml", &format!("{text}\n[tool_output]\n{section}"));
        let robot = robot.map_err(|error| error.to_string())?;
        let settings = robot.settings().unwrap().check().unwrap();
        assert_eq!(settings.tool_output, robot.tool_output);
        Ok(robot.tool_output)
    }

    #[test]
    fn each_kind_is_read_with_its_keys_and_defaults() {
        assert_eq!(read(""), Ok(ToolOutputSettings::None));
        let servo = ToolOutputSettings::Servo {
            up_width: 1e-3,
            down_width: 2e-3,
            frame_rate: 50.0,
            down_time: 0.1,
            up_time: 0.05,
        };
        assert_eq!(read(SERVO), Ok(servo));
        let switch = ToolOutputSettings::Switch {
            active_low: false,
            down_time: 0.0,
            up_time: 10.0,
        };
        let text = "kind = \"switch\"\ndown_time = 0.0\nup_time = 10.0\n";
        assert_eq!(read(text), Ok(switch));
        let power = ToolOutputSettings::Power {
            frequency: 1e5,
            scale_with_speed: true,
        };
        let text = "kind = \"power\"\nfrequency = 1e5\nscale_with_speed = true\n";
        assert_eq!(read(text), Ok(power));
    }

    #[test]
    fn what_is_not_valid_is_refused_with_file_key_and_reason() {
        let with = |from: &str, to: &str| SERVO.replace(from, to);
        for (text, key, reason) in [
            (with("servo", "pen"), "kind", "not \"pen\""),
            (with("kind = \"servo\"", ""), "kind", "is missing"),
            (with("up_width = 1e-3", ""), "up_width", "is missing"),
            (with("1e-3", "nan"), "up_width", "must be 0.0001 to 0.005 s"),
            (with("1e-3", "1.0"), "up_width", "must be 0.0001 to 0.005 s"),
            (with("2e-3", "1e-3"), "down_width", "the same as `up_width`"),
            (with("0.05", "-0.1"), "up_time", "must be 0.0 to 10.0 s"),
            (
                format!("{SERVO}frame_rate = 500.0\n"),
                "frame_rate",
                "must be 40.0 to 400.0 Hz",
            ),
            (
                format!("{}frame_rate = 300.0\n", with("2e-3", "4e-3")),
                "down_width",
                "90 % of a frame",
            ),
            (
                format!("{SERVO}frequency = 50.0\n"),
                "frequency",
                "is no key of kind \"servo\"",
            ),
            (
                "kind = \"power\"\nfrequency = 1.0\n".into(),
                "frequency",
                "must be 10.0",
            ),
            (format!("{SERVO}down_s = 90\n"), "up_s", "beside `down_s`"),
            (format!("{SERVO}up_s = 30\n"), "down_s", "beside `up_s`"),
            (
                format!("{SERVO}up_s = 30\ndown_s = 30.0\n"),
                "down_s",
                "the same as `up_s`",
            ),
            (
                format!("{SERVO}up_s = -1\ndown_s = 30.0\n"),
                "up_s",
                "must be 0 or above",
            ),
            (format!("{SERVO}colour = 1\n"), "colour", "unknown field"),
        ] {
            let refused = read(&text).unwrap_err();
            assert!(refused.starts_with("arm.toml, line "), "{refused}");
            assert!(refused.contains(&format!("`{key}`")), "{key}: {refused}");
            assert!(refused.contains(reason), "{reason}: {refused}");
        }
    }
}
