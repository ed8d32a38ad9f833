//! One line of G-code as codes and words, by the crate `gcode`.
//!
//! The crate gets one line at a time, without comments, because an open parenthesis would
//! make it skip the rest of the job. It keeps numbers as `f32`, so this module reads the
//! values again, as `f64`, from the text at the positions that the crate gives.

use super::GcodeError;
use super::error::quoted;

/// A code by letter, number and decimal: G91.1 is `('G', 91, 1)`.
pub(super) type Code = (char, u32, u32);

/// The content of a line.
#[derive(Debug, Default)]
pub(super) struct Line {
    /// The G codes, in order.
    pub(super) general: Vec<Code>,
    /// The M and T codes, in order, each with its S if it has one.
    pub(super) miscellaneous: Vec<(Code, Option<f64>)>,
    /// The words of the G codes, and the words without a code.
    words: Vec<(char, f64)>,
}

impl Line {
    /// Reads a line.
    pub(super) fn read(text: &str) -> Result<Self, GcodeError> {
        let text = without_comments(without_checksum(text)?)?;
        match (Self::words(&text), unknown_m_code(&text)) {
            // The text after an unknown M code belongs to the code and may be anything. After
            // M117 and M118 it is a message, even if it looks like words.
            (_, Some(number @ (117 | 118))) | (Err(_), Some(number)) => Ok(Self {
                miscellaneous: vec![(('M', number, 0), None)],
                ..Self::default()
            }),
            (line, _) => line,
        }
    }

    /// Reads a line of words.
    fn words(text: &str) -> Result<Self, GcodeError> {
        if has_overlong_code(text) {
            return Err(GcodeError::Syntax("no code has that many digits".into()));
        }
        let program = gcode::parse(text).map_err(|diagnostics| {
            let first = diagnostics.iter().next();
            GcodeError::Syntax(first.map_or_else(String::new, |found| explain(&found.kind)))
        })?;
        let value_at = |span: gcode::core::Span| {
            let word = text.get(span.start + 1..span.end()).unwrap_or_default();
            let number: String = word.split_whitespace().collect();
            let value = number.parse::<f64>().ok().filter(|value| value.is_finite());
            value.ok_or_else(|| GcodeError::Syntax(format!("\"{}\" is not a number", quoted(word))))
        };
        let mut line = Self::default();
        for block in program.blocks {
            for code in block.codes {
                match code {
                    gcode::Code::General(general) => {
                        line.general.push(named('G', general.number));
                        for word in general.args {
                            line.push(word.letter, value_at(word.span)?)?;
                        }
                    }
                    gcode::Code::Miscellaneous(code) => {
                        let speed = code
                            .args
                            .iter()
                            .find(|word| word.letter.eq_ignore_ascii_case(&'S'));
                        let speed = speed.map(|word| value_at(word.span)).transpose()?;
                        line.miscellaneous.push((named('M', code.number), speed));
                        // Coordinates after an M code belong to the line.
                        for word in code.args {
                            if "XYZIJRF".contains(word.letter.to_ascii_uppercase()) {
                                line.push(word.letter, value_at(word.span)?)?;
                            }
                        }
                    }
                    gcode::Code::ToolChange(code) => {
                        line.miscellaneous.push((named('T', code.number), None));
                    }
                    other => return Err(GcodeError::Syntax(format!("{other} is not supported"))),
                }
            }
            for word in block.word_addresses {
                line.push(word.letter, value_at(word.span)?)?;
            }
        }
        Ok(line)
    }

    fn push(&mut self, letter: char, value: f64) -> Result<(), GcodeError> {
        let letter = letter.to_ascii_uppercase();
        if self.words.iter().any(|&(other, _)| other == letter) {
            return Err(GcodeError::Repeated(letter));
        }
        self.words.push((letter, value));
        Ok(())
    }

    /// Takes the value of a word from the line.
    pub(super) fn take(&mut self, letter: char) -> Option<f64> {
        let index = self.words.iter().position(|&(other, _)| other == letter)?;
        Some(self.words.swap_remove(index).1)
    }

    /// A word that has not been taken.
    pub(super) fn left_over(&self) -> Option<char> {
        self.words.first().map(|&(letter, _)| letter)
    }
}

fn named(letter: char, number: gcode::core::Number) -> Code {
    let minor = number.minor().map_or(0, std::num::NonZero::get);
    (letter, number.major(), minor)
}

/// The code as one writes it.
pub(super) fn spelled((letter, major, minor): Code) -> String {
    match minor {
        0 => format!("{letter}{major}"),
        _ => format!("{letter}{major}.{minor}"),
    }
}

/// A line without its checksum. Hosts add one to numbered lines: `N10 G1 X1*82` ends with
/// the exclusive or of all bytes before the star.
fn without_checksum(text: &str) -> Result<&str, GcodeError> {
    let line = text.trim_start();
    let code = line.split(';').next().unwrap_or_default();
    let Some((summed, checksum)) = code.rsplit_once('*') else {
        return Ok(text);
    };
    let is_comment = summed.rfind('(') > summed.rfind(')');
    let Ok(stated) = checksum.trim().parse() else {
        return Ok(text);
    };
    if is_comment || !line.starts_with(['N', 'n']) {
        return Ok(text);
    }
    let found = summed.bytes().fold(0, |sum: u8, byte| sum ^ byte);
    if found == stated {
        Ok(summed)
    } else {
        Err(GcodeError::Checksum { stated, found })
    }
}

/// The text before a semicolon and outside parentheses, which do not nest.
fn without_comments(text: &str) -> Result<String, GcodeError> {
    let mut kept = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(start) = rest.find(['(', ';']) {
        kept.push_str(&rest[..start]);
        kept.push(' ');
        if rest[start..].starts_with(';') {
            return Ok(kept);
        }
        let end = rest[start..].find(')').ok_or(GcodeError::OpenComment)?;
        rest = &rest[start + end + 1..];
    }
    kept.push_str(rest);
    Ok(kept)
}

/// The number of the M code with which a line begins, after its line number, if this code is
/// not supported.
fn unknown_m_code(text: &str) -> Option<u32> {
    let digits = |text: &str| text.bytes().take_while(u8::is_ascii_digit).count();
    let mut text = text.trim_start();
    if let Some(rest) = text.strip_prefix(['N', 'n']) {
        text = rest.get(digits(rest)..)?.trim_start();
    }
    let code = text.strip_prefix(['M', 'm'])?;
    let number = code.get(..digits(code))?.parse().ok()?;
    (!matches!(number, 2..=5 | 30 | 300)).then_some(number)
}

/// Whether a code has more than eight digits: the crate's arithmetic would overflow.
fn has_overlong_code(text: &str) -> bool {
    text.split(['G', 'g', 'M', 'm', 'T', 't'])
        .skip(1)
        .any(|after| {
            let digits = after.trim_start().bytes().take_while(u8::is_ascii_digit);
            digits.count() > 8
        })
}

fn explain(kind: &gcode::DiagnosticKind) -> String {
    match kind {
        gcode::DiagnosticKind::UnknownContent { text } => {
            format!("\"{}\" is not G-code", quoted(text))
        }
        gcode::DiagnosticKind::Unexpected { actual, .. } if actual.trim().is_empty() => {
            "the line ends where a number should be".into()
        }
        gcode::DiagnosticKind::Unexpected { actual, .. } => {
            format!(
                "\"{}\" is not a letter with its number; write words such as X12.5",
                quoted(actual)
            )
        }
        other => other.to_string(),
    }
}
