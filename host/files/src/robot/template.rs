//! The template of a robot file. It explains every key with the words of docs/use/robot-file.md,
//! which shows the same text.

use crate::refusal::Key;

const TEMPLATE: &str = include_str!("template.toml");

/// The section of a line.
#[derive(Clone, Copy)]
enum Section {
    Top,
    One(&'static str),
    /// The n-th of several, from 0.
    Of(&'static str, usize),
}

impl Section {
    fn key(self, name: &'static str) -> Key {
        match self {
            Self::Top => Key::Top(name),
            Self::One(section) => Key::In(section, name),
            Self::Of(section, index) => Key::Of(section, index, name),
        }
    }
}

/// The template's robot with these values. Keys without a value are optional; they are
/// commented out and show their defaults. The second of two sections names only the keys that it has.
pub(super) fn filled(values: &[(Key, String)]) -> String {
    let mut left: Vec<&(Key, String)> = values.iter().collect();
    let is_given = |section: &str, index: usize| {
        let within = |key: Key| matches!(key, Key::Of(s, i, _) if s == section && i == index);
        values.iter().any(|(key, _)| within(*key))
    };
    let mut section = Section::Top;
    let mut text = String::new();
    for line in TEMPLATE.lines() {
        // The template has some keys as comments: those of the rarer motors and tools.
        let key_line = line.strip_prefix("# ").unwrap_or(line);
        let filled = if let Some(name) = between(line, "[[", "]]") {
            let index = match section {
                Section::Of(last, index) if last == name => index + 1,
                _ => 0,
            };
            section = Section::Of(name, index);
            is_given(name, index).then(|| line.to_owned())
        } else if let Some(name) = between(line, "[", "]") {
            section = Section::One(name);
            Some(line.to_owned())
        } else if let Some((name, _)) = key_line.split_once(" = ")
            && !name.contains(['#', ' '])
        {
            let given = left.iter().position(|(key, _)| *key == section.key(name));
            let given = given.map(|found| with_value(line, name, &left.remove(found).1));
            given.or_else(|| line.starts_with('#').then(|| line.to_owned()))
        } else {
            if line.is_empty() {
                for (key, value) in left.extract_if(.., |(key, _)| section.key(key.name()) == *key)
                {
                    text += &format!("{} = {value}\n", key.name());
                }
            }
            Some(line.to_owned())
        };
        text += &filled.unwrap_or_else(|| format!("# {line}"));
        text.push('\n');
    }
    text
}

fn between(line: &'static str, open: &str, close: &str) -> Option<&'static str> {
    Some(line.strip_prefix(open)?.split_once(close)?.0)
}

/// The line, or the line that is a comment, with another value; its comment stays in the same column if there is room.
fn with_value(line: &str, name: &str, value: &str) -> String {
    let filled = format!("{name} = {value}");
    match line.rsplit_once(" # ") {
        None => filled,
        Some((before, comment)) => {
            let width = before.chars().count().saturating_sub(1);
            format!("{filled:<width$}  # {comment}")
        }
    }
}

#[cfg(test)]
mod tests {
    use super::filled;
    use crate::refusal::Key;

    #[test]
    fn given_keys_are_filled_in_and_the_others_are_comments() {
        let text = filled(&[
            (Key::Top("base"), "0.123".into()),
            (Key::Of("link", 1, "mass"), "7.0".into()),
            (
                Key::In("supply", "voltage"),
                "12345678901234567890123456789012345.0".into(),
            ),
        ]);
        let lines: Vec<&str> = text.lines().collect();
        let line = |wanted: &str| *lines.iter().find(|line| line.contains(wanted)).unwrap();
        assert_eq!(
            line("base = "),
            "base = 0.123                      # A to E [m]; 0.0 for coaxial cranks"
        );
        assert_eq!(
            line("voltage = 1"),
            "voltage = 12345678901234567890123456789012345.0  # [V]"
        );
        let active = lines
            .iter()
            .filter(|line| line.contains(" = ") && !line.starts_with('#'));
        assert_eq!(active.count(), 3);
        // Only the second link is active, and every section that occurs once.
        let heads = |head: &str| lines.iter().filter(|line| line.starts_with(head)).count();
        assert_eq!((heads("[[link]]"), heads("# [[link]]")), (1, 3));
        assert_eq!((heads("[[actuator]]"), heads("# [[actuator]]")), (0, 2));
        assert_eq!((heads("[limits]"), heads("# [limits]")), (1, 0));
    }
}
