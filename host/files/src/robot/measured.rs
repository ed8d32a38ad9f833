//! A robot file with measured values in place of the drawing's, each with its origin.

use super::Robot;
use crate::refusal::Key;
use crate::source::{FileError, Source};
use fivebar_kinematics::five_bar::Joint;
use std::time::{SystemTime, UNIX_EPOCH};

/// A value of a robot file that can be measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MeasuredKey {
    /// `base`.
    Base,
    /// `payload`.
    Payload,
    /// `home`.
    Home,
    /// A key of the n-th `[[link]]`, from 0.
    Link(usize, &'static str),
    /// A key of `[tool_output]`.
    ToolOutput(&'static str),
    /// A key of the `[[actuator]]` of a joint.
    Actuator(Joint, &'static str),
}

impl MeasuredKey {
    fn key(self) -> Key {
        match self {
            Self::Base => Key::Top("base"),
            Self::Payload => Key::Top("payload"),
            Self::Home => Key::Top("home"),
            Self::Link(index, name) => Key::Of("link", index, name),
            Self::ToolOutput(name) => Key::In("tool_output", name),
            Self::Actuator(joint, name) => Key::Of("actuator", joint.index(), name),
        }
    }

    fn name(self) -> &'static str {
        match self.key() {
            Key::Top(name) | Key::In(_, name) | Key::Of(_, _, name) => name,
        }
    }
}

/// A measured value.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    /// Its key.
    pub key: MeasuredKey,
    /// As it stands in a TOML file.
    pub value: String,
    /// Where it comes from, such as "± 6 µm".
    pub origin: String,
}

/// The text of a robot file with these values. A line above each says that it was measured today,
/// how well, and what stood there before.
///
/// # Errors
/// The new file is not valid: the values do not make a robot.
pub fn measured_text(file: &str, text: &str, values: &[Measured]) -> Result<String, FileError> {
    let source = Source::new(file, text);
    let date = today();
    // (place, removed bytes, inserted text), from the end of the file to its beginning.
    let mut changes = Vec::new();
    for measured in values {
        let Measured { key, value, origin } = measured;
        if let Some(span) = source.span_of(key.key()) {
            let line = text[..span.start].rfind('\n').map_or(0, |end| end + 1);
            let before = text[span.clone()]
                .split_whitespace()
                .collect::<Vec<_>>()
                .join(" ");
            let name = key.name();
            let comment = format!("# {name}: measured {date}, {origin}; before: {before}\n");
            changes.push((span.start, span.len(), value.clone()));
            changes.push((line, 0, comment));
        } else {
            // A key that the file leaves out: above a line of its table that every file has.
            let beside = match *key {
                MeasuredKey::Actuator(joint, _) => {
                    // Without an encoder it has a kind.
                    let [counts, kind] = ["encoder_counts", "kind"]
                        .map(|name| Key::Of("actuator", joint.index(), name));
                    source.span_of(counts).map_or(kind, |_| counts)
                }
                MeasuredKey::Link(index, _) => Key::Of("link", index, "length"),
                _ => Key::Top("base"),
            };
            let base = source.span_of(beside).map_or(0, |span| span.start);
            let line = text[..base].rfind('\n').map_or(0, |end| end + 1);
            let name = key.name();
            let added = format!("# {name}: measured {date}, {origin}\n{name} = {value}\n");
            changes.push((line, 0, added));
        }
    }
    changes.sort_by_key(|change| std::cmp::Reverse(change.0));
    let mut new = text.to_owned();
    for (place, length, inserted) in changes {
        new.replace_range(place..place + length, &inserted);
    }
    Robot::parse(file, &new)?;
    Ok(new)
}

/// The date of today (UTC), as 2026-11-22.
pub fn today() -> String {
    let seconds = SystemTime::now().duration_since(UNIX_EPOCH);
    date(seconds.map_or(0, |time| time.as_secs() / 86_400))
}

/// The date of a day, counted from 1970-01-01.
fn date(mut day: u64) -> String {
    let is_leap = |year: u64| {
        year.is_multiple_of(4) && (!year.is_multiple_of(100) || year.is_multiple_of(400))
    };
    let mut year = 1970;
    while day >= 365 + u64::from(is_leap(year)) {
        day -= 365 + u64::from(is_leap(year));
        year += 1;
    }
    let february = 28 + u64::from(is_leap(year));
    let lengths = [31, february, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31];
    let mut month = 1;
    for length in lengths {
        if day < length {
            break;
        }
        day -= length;
        month += 1;
    }
    format!("{year}-{month:02}-{:02}", day + 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::BuiltIn;

    #[test]
    fn days_have_their_dates() {
        for (day, wanted) in [
            (0, "1970-01-01"),
            (58, "1970-02-28"),
            (11_016, "2000-02-29"),
            (20_788, "2026-12-01"),
        ] {
            assert_eq!(date(day), wanted);
        }
    }

    #[test]
    fn values_are_replaced_with_their_origin_and_the_rest_stays() {
        let text = BuiltIn::find("benchtop").unwrap().text;
        let measured = |key, value: &str| Measured {
            key,
            value: value.into(),
            origin: "± 6 µm".into(),
        };
        let values = [
            measured(MeasuredKey::Link(2, "length"), "0.1603"),
            measured(MeasuredKey::Base, "0.0802"),
            measured(MeasuredKey::Home, "[2.8, 0.35]"),
        ];
        let new = measured_text("benchtop", text, &values).unwrap();
        let robot = Robot::parse("new", &new).unwrap();
        assert_eq!(robot.geometry.lengths(), [0.10, 0.16, 0.1603, 0.10, 0.0802]);
        assert_eq!(robot.home, [2.8, 0.35]);
        assert!(
            new.contains(", ± 6 µm; before: 0.16\nlength = 0.1603\n"),
            "{new}"
        );
        // Without `home` it is added.
        let shorter: String = text
            .lines()
            .filter(|line| !line.starts_with("home"))
            .map(|line| format!("{line}\n"))
            .collect();
        let new = measured_text("benchtop", &shorter, &values).unwrap();
        assert_eq!(Robot::parse("new", &new).unwrap().home, [2.8, 0.35]);
        // A key that an actuator leaves out is added to it.
        let error = "[{ harmonic = 1, amplitude = 1e-3, phase = 0.5 }]";
        let values = [measured(
            MeasuredKey::Actuator(Joint::Joint4, "encoder_error"),
            error,
        )];
        let new = measured_text("benchtop", text, &values).unwrap();
        let actuators = Robot::parse("new", &new).unwrap().actuators.unwrap();
        assert!(actuators[0].encoder_error.is_zero());
        assert_eq!(actuators[1].encoder_error.terms()[0].phase, 0.5);
        // Also to one without encoder counts.
        let stepper = BuiltIn::find("benchtop_stepper").unwrap().text;
        let without = stepper.replace("torque_share = 0.6\n", "");
        let key = MeasuredKey::Actuator(Joint::Joint4, "torque_share");
        let new = measured_text("stepper", &without, &[measured(key, "0.72")]).unwrap();
        let actuators = Robot::parse("new", &new).unwrap().actuators.unwrap();
        let shares = actuators.map(|one| one.stepper().unwrap().torque_share);
        assert_eq!(shares, [0.6, 0.72]);
        // A value that makes no robot is refused.
        let wrong = [measured(MeasuredKey::Base, "-1.0")];
        assert!(measured_text("benchtop", text, &wrong).is_err());
    }
}
