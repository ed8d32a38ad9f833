//! HPGL as commands: two letters with numbers behind them.

/// What ends a label unless DT names another character.
const LABEL_END: char = '\u{3}';
const ESCAPE: char = '\u{1B}';
/// Escapes of plotters that have numbers, up to a colon.
const WITH_NUMBERS: &str = "@HIMNPT";

/// A command.
#[derive(Debug, PartialEq)]
pub(super) struct Command {
    /// Two letters, or what stands there in their place.
    pub(super) name: String,
    pub(super) numbers: Vec<f64>,
}

/// The commands of a plot. A label's text is skipped.
pub(super) fn commands(text: &str) -> impl Iterator<Item = Command> {
    let mut rest = text;
    let mut label_end = LABEL_END;
    std::iter::from_fn(move || {
        loop {
            rest = rest.trim_start_matches(|c: char| c == ';' || c == ',' || c.is_whitespace());
            if rest.starts_with("@PJL") {
                rest = rest.split_once('\n').map_or("", |(_, behind)| behind);
                continue;
            }
            match rest.strip_prefix(ESCAPE) {
                Some(behind) => rest = behind_escape(behind),
                None => break,
            }
        }
        if rest.is_empty() {
            return None;
        }
        let name: String = rest.chars().take(2).collect();
        rest = &rest[name.len()..];
        let name = name.to_ascii_uppercase();
        match name.as_str() {
            "LB" => {
                rest = rest.split_once(label_end).map_or("", |(_, behind)| behind);
                return Some(command(name, ""));
            }
            "DT" => {
                label_end = rest
                    .chars()
                    .next()
                    .filter(|&c| c != ';')
                    .unwrap_or(LABEL_END);
                rest = rest.strip_prefix(label_end).unwrap_or(rest);
                return Some(command(name, ""));
            }
            // The encoded lines of PE and the texts of BP and CO hold any character.
            "PE" | "BP" | "CO" => {
                rest = rest.split_once(';').map_or("", |(_, behind)| behind);
                return Some(command(name, ""));
            }
            _ => {}
        }
        let end = rest.find(|c: char| c == ';' || c == ESCAPE || c.is_ascii_alphabetic());
        let (numbers, behind) = rest.split_at(end.unwrap_or(rest.len()));
        rest = behind;
        Some(command(name, numbers))
    })
}

/// A command with its numbers; one that is none becomes a part of the name, so that it is refused.
fn command(name: String, numbers: &str) -> Command {
    let parts = numbers.split(|c: char| c == ',' || c.is_whitespace());
    let mut command = Command {
        name,
        numbers: Vec::new(),
    };
    for part in parts.filter(|part| !part.is_empty()) {
        match part.parse::<f64>() {
            Ok(number) if number.is_finite() => command.numbers.push(number),
            _ => {
                command.name.extend(part.chars().take(20));
                break;
            }
        }
    }
    command
}

/// The text behind an escape: `.I81;;17:`, `.(`, `%0B`, `E`, `%-12345X` before lines of `@PJL`.
fn behind_escape(text: &str) -> &str {
    if let Some(text) = text.strip_prefix('.') {
        let mut characters = text.chars();
        let kind = characters.next();
        let behind = characters.as_str();
        return match kind {
            Some(kind) if WITH_NUMBERS.contains(kind) => {
                behind.split_once(':').map_or("", |(_, behind)| behind)
            }
            _ => behind,
        };
    }
    // Those of PCL end with a capital, `&l1X`.
    let end = text.find(|c: char| c.is_ascii_uppercase());
    end.and_then(|end| text.get(end + 1..)).unwrap_or("")
}
