//! One line of G-code as codes and words, by the crate `gcode`.
//!
//! The crate gets one line at a time, without comments, because an open parenthesis would
//! make it skip the rest of the job. It keeps numbers as `f32`, so this module reads the
//! values again, as `f64`, from the text at the positions that the crate gives.

use super::GcodeError;
use super::error::quoted;

/// The M code that changes the working mode.
const CHANGE_MODE: u32 = 780;
/// The M code that crosses to the other assembly mode.
const CROSS: u32 = 781;

/// Most digits of a number: those of any length in a file are fewer.
const MOST_DIGITS: usize = 40;

/// A code by letter, number and decimal: G91.1 is `('G', 91, 1)`.
pub(super) type Code = (char, u32, u32);

/// The content of a line.
#[derive(Debug, Default)]
pub(super) struct Line {
    /// The G codes, in order.
    pub(super) general: Vec<Code>,
    /// The M and T codes, in order, each with its S if it has one.
    pub(super) miscellaneous: Vec<(Code, Option<f64>)>,
    /// The comment of a line that stops.
    pub(super) comment: Option<String>,
    /// Whether it begins with a slash, by which a machine can be set to skip it.
    pub(super) is_deletable: bool,
    /// Whether a number has blanks in it.
    pub(super) has_blanks: bool,
    /// Whether the line has a checksum.
    pub(super) has_checksum: bool,
    /// A setting or a command of Grbl, such as `$H`, or a command of a printer, such as `G29`, which is skipped.
    pub(super) system_command: Option<String>,
    /// The sides of M780, by I and J.
    pub(super) elbows: Option<[Option<f64>; 2]>,
    /// The end and the time of M781, by X, Y and P.
    pub(super) crossing: Option<[Option<f64>; 3]>,
    /// The words of the G codes, and the words without a code.
    words: Vec<(char, f64)>,
}

impl Line {
    /// Reads a line.
    pub(super) fn read(text: &str) -> Result<Self, GcodeError> {
        let summed = without_checksum(text)?;
        let has_checksum = summed.len() < text.len();
        let text = without_comments(summed)?;
        let kept = text.trim_start().strip_prefix('/');
        let is_deletable = kept.is_some();
        let text = kept.map_or(text.clone(), str::to_owned);
        if let Some(command) = text.trim().strip_prefix('$') {
            return Self::system_command(command);
        }
        if let Some(command) = of_printer(&text) {
            return Ok(Self {
                system_command: Some(quoted(&command)),
                has_checksum,
                ..Self::default()
            });
        }
        if let Some(homing) = Self::homing(&text) {
            return Ok(Self {
                has_checksum,
                ..homing
            });
        }
        let line = match (Self::words(&text), unknown_m_code(&text)) {
            // The text after an unknown M code belongs to the code and may be anything. After
            // M117 and M118 it is a message, even if it looks like words.
            (_, Some(number @ (117 | 118))) | (Err(_), Some(number)) => Self {
                miscellaneous: vec![(('M', number, 0), None)],
                ..Self::default()
            },
            // Grbl and LinuxCNC skip all blanks.
            (Err(refusal), None) => {
                let line = without_blanks(&text).map(|text| Self::words(&text));
                Self {
                    has_blanks: true,
                    ..line.unwrap_or(Err(refusal))?
                }
            }
            (line, _) => line?,
        };
        let comment = match line.stops() {
            true => comment(summed),
            false => None,
        };
        Ok(Self {
            comment,
            is_deletable,
            has_checksum,
            ..line
        })
    }

    /// Whether it has M0, M1, M6 or T.
    fn stops(&self) -> bool {
        let mut codes = self.miscellaneous.iter();
        codes.any(|(code, _)| matches!(code, ('M', 0 | 1 | 6, 0) | ('T', ..)))
    }

    /// A line that begins with `$`, as Grbl has it. Jogs are refused, because they would move the
    /// tool.
    fn system_command(command: &str) -> Result<Self, GcodeError> {
        let command = command.trim().to_ascii_uppercase();
        if command.starts_with('J') {
            return Err(GcodeError::Syntax(
                "a jog of Grbl; write G91 and G1 in place of $J=".into(),
            ));
        }
        Ok(Self {
            system_command: Some(format!("${}", quoted(&command))),
            ..Self::default()
        })
    }

    /// G28 with axes that have no number, as RepRap has it: `G28 X Y`. None: another line.
    fn homing(text: &str) -> Option<Self> {
        let mut words = text.split_whitespace();
        let mut first = words.next()?.to_ascii_uppercase();
        if first.starts_with('N') {
            first = words.next()?.to_ascii_uppercase();
        }
        let axes: Vec<&str> = words.collect();
        let is_axis =
            |axis: &&str| matches!(axis.to_ascii_uppercase().as_str(), "X" | "Y" | "Z" | "W");
        if first != "G28" || axes.is_empty() || !axes.iter().all(is_axis) {
            return None;
        }
        let mut line = Self::default();
        line.general.push(('G', 28, 0));
        // W leaves out the levelling of the bed, which this arm does not have.
        for axis in axes.iter().flat_map(|axis| axis.chars()) {
            if !matches!(axis, 'W' | 'w') {
                line.push(axis, 0.0).ok()?;
            }
        }
        Some(line)
    }

    /// Reads a line of words.
    fn words(text: &str) -> Result<Self, GcodeError> {
        check_numbers(text)?;
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
        // Words after an M code that is not supported are its own: `M201 X500` moves nothing.
        let mut is_unknown = false;
        for block in program.blocks {
            for code in block.codes {
                match code {
                    gcode::Code::General(general) => {
                        is_unknown = false;
                        line.general.push(named('G', general.number));
                        for word in general.args {
                            line.push(word.letter, value_at(word.span)?)?;
                        }
                    }
                    gcode::Code::Miscellaneous(code) if code.number.major() == CHANGE_MODE => {
                        is_unknown = false;
                        let mut sides = [None; 2];
                        for word in code.args {
                            set_own(&mut sides, "IJ", word.letter, value_at(word.span)?)?;
                        }
                        line.elbows = Some(sides);
                    }
                    gcode::Code::Miscellaneous(code) if code.number.major() == CROSS => {
                        is_unknown = false;
                        let mut values = [None; 3];
                        for word in code.args {
                            set_own(&mut values, "XYP", word.letter, value_at(word.span)?)?;
                        }
                        if line.crossing.replace(values).is_some() {
                            return Err(conflict(('M', CROSS, 0)));
                        }
                    }
                    gcode::Code::Miscellaneous(code) => {
                        is_unknown = !is_supported(code.number.major());
                        let speed = code
                            .args
                            .iter()
                            .find(|word| word.letter.eq_ignore_ascii_case(&'S'));
                        let speed = speed.map(|word| value_at(word.span)).transpose()?;
                        let sets_power = [3, 4, 106].contains(&code.number.major());
                        if sets_power && speed.is_some_and(|speed| speed < 0.0) {
                            return Err(GcodeError::Power);
                        }
                        line.miscellaneous.push((named('M', code.number), speed));
                        // Coordinates after an M code belong to the line.
                        for word in code.args {
                            let letter = word.letter.to_ascii_uppercase();
                            if !is_unknown && "XYZIJREF".contains(letter) {
                                line.push(letter, value_at(word.span)?)?;
                            }
                        }
                    }
                    gcode::Code::ToolChange(code) if !is_unknown => {
                        line.miscellaneous.push((named('T', code.number), None));
                    }
                    gcode::Code::ToolChange(_) => {}
                    other => return Err(GcodeError::Syntax(format!("{other} is not supported"))),
                }
            }
            for word in block.word_addresses {
                line.push(word.letter, value_at(word.span)?)?;
            }
        }
        line.crosses_alone()?;
        Ok(line)
    }

    /// Checks that M781 has its line for itself.
    fn crosses_alone(&self) -> Result<(), GcodeError> {
        if self.crossing.is_none() {
            return Ok(());
        }
        let elbows = self.elbows.map(|_| ('M', CHANGE_MODE, 0));
        let miscellaneous = self.miscellaneous.iter().map(|&(code, _)| code);
        let mut others = self.general.iter().copied().chain(miscellaneous);
        if let Some(other) = others.next().or(elbows) {
            return Err(conflict(other));
        }
        let stray = self.words.first();
        stray.map_or(Ok(()), |&(letter, _)| Err(GcodeError::StrayWord(letter)))
    }

    fn push(&mut self, letter: char, value: f64) -> Result<(), GcodeError> {
        let letter = letter.to_ascii_uppercase();
        if self.words.iter().any(|&(other, _)| other == letter) {
            return Err(GcodeError::Repeated(letter));
        }
        self.words.push((letter, value));
        Ok(())
    }

    /// Whether the line has a word of this letter.
    pub(super) fn has(&self, letter: char) -> bool {
        self.words.iter().any(|&(other, _)| other == letter)
    }

    /// Whether the line ends the job.
    pub(super) fn ends(&self) -> bool {
        let mut codes = self.miscellaneous.iter().map(|&(code, _)| code);
        codes.any(|code| matches!(code, ('M', 2 | 30, 0)))
    }
}

/// The command of a line that has a meaning for printers only: G29, G32 and G34 level a bed, G10 and G11
/// alone pull filament back, and Klipper has commands in words, such as `START_PRINT BED_TEMP=60`.
fn of_printer(text: &str) -> Option<String> {
    let is_number = |word: &&str| {
        let digits = word.strip_prefix(['N', 'n']);
        digits.is_some_and(|digits| digits.bytes().all(|byte| byte.is_ascii_digit()))
    };
    let mut words = text.split_whitespace().skip_while(is_number);
    let first = words.next()?.to_ascii_uppercase();
    let mut rest = words.peekable();
    let is_alone = rest.peek().is_none();
    let is_name = first.len() > 3
        && first
            .bytes()
            .all(|byte| byte.is_ascii_alphanumeric() || byte == b'_')
        && !first.bytes().take(3).any(|byte| byte.is_ascii_digit());
    let has_values = first.contains('_') || rest.any(|word| word.contains('='));
    let is_printers = match first.as_str() {
        "G29" | "G32" | "G34" => true,
        "G10" | "G11" => is_alone,
        _ => is_name && has_values,
    };
    is_printers.then_some(first)
}

/// Why a code is not on a line of M781.
fn conflict(other: Code) -> GcodeError {
    GcodeError::Conflict(spelled(other), spelled(('M', CROSS, 0)))
}

/// Sets the value of a code's own letter.
fn set_own(
    values: &mut [Option<f64>],
    letters: &str,
    letter: char,
    value: f64,
) -> Result<(), GcodeError> {
    let letter = letter.to_ascii_uppercase();
    let place = letters.find(letter).and_then(|place| values.get_mut(place));
    match place.ok_or(GcodeError::StrayWord(letter))?.replace(value) {
        None => Ok(()),
        Some(_) => Err(GcodeError::Repeated(letter)),
    }
}

/// The words of a line, each of which is taken once.
#[derive(Debug)]
pub(super) struct Words(Vec<(char, f64)>);

impl Words {
    pub(super) fn of(line: &Line) -> Self {
        Self(line.words.clone())
    }

    /// Takes the value of a word from the line.
    pub(super) fn take(&mut self, letter: char) -> Option<f64> {
        let index = self.0.iter().position(|&(other, _)| other == letter)?;
        Some(self.0.swap_remove(index).1)
    }

    /// A word that has not been taken.
    pub(super) fn left_over(&self) -> Option<char> {
        self.0.first().map(|&(letter, _)| letter)
    }
}

/// Whether the interpreter knows an M code. Motion words may follow it on its line.
fn is_supported(number: u32) -> bool {
    matches!(
        number,
        0..=9 | 30 | 106 | 107 | 280 | 300 | CHANGE_MODE | CROSS
    )
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

/// The text without the blanks in its numbers; none if it has no such blanks.
fn without_blanks(text: &str) -> Option<String> {
    let is_part = |c: char| c.is_ascii_digit() || c == '.';
    let mut joined = String::with_capacity(text.len());
    for part in text.split_whitespace() {
        if !(joined.ends_with(is_part) && part.starts_with(is_part)) {
            joined.push(' ');
        }
        joined.push_str(part);
    }
    let count = |text: &str| text.split_whitespace().count();
    (count(&joined) < count(text)).then_some(joined)
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

/// The text of the first comment, if it has some.
fn comment(text: &str) -> Option<String> {
    let comment = text[text.find(['(', ';'])?..]
        .split([')', '\r', '\n'])
        .next()?;
    let comment = comment.trim_start_matches(['(', ';']).trim();
    (!comment.is_empty()).then(|| quoted(comment))
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
    (!is_supported(number)).then_some(number)
}

/// Refuses numbers that take long to read, and those with an exponent.
fn check_numbers(text: &str) -> Result<(), GcodeError> {
    if has_overlong_code(text) {
        return Err(GcodeError::Syntax("no code has that many digits".into()));
    }
    if let Some(digits) = overlong_number(text) {
        let why = format!("a number has {digits} digits, more than {MOST_DIGITS}: round it");
        return Err(GcodeError::Syntax(why));
    }
    if has_exponent(text) {
        return Err(GcodeError::Exponent);
    }
    Ok(())
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

/// The digits of the longest number, if it is too long.
fn overlong_number(text: &str) -> Option<usize> {
    let numbers = text.split(|c: char| !c.is_ascii_digit() && c != '.');
    let longest = numbers.map(str::len).max()?;
    Some(longest).filter(|&digits| digits > MOST_DIGITS)
}

/// Whether a number has an exponent, which G-code does not know: `X1e-5`. An E right after a number
/// is an extruder's word only if it is upper case with a decimal point in its number: `X10.5E0.2`.
fn has_exponent(text: &str) -> bool {
    text.bytes().enumerate().any(|(index, byte)| {
        let follows =
            |from: usize, length: usize| text.get(from..from + length).unwrap_or_default();
        let before = index.checked_sub(1).map(|index| text.as_bytes()[index]);
        if !before.is_some_and(|before| before.is_ascii_digit() || before == b'.') {
            return false;
        }
        if !matches!(byte, b'e' | b'E') {
            return false;
        }
        let sign = usize::from(matches!(follows(index + 1, 1), "+" | "-"));
        let number = text.get(index + 1 + sign..).unwrap_or_default();
        let digits = number.bytes().take_while(u8::is_ascii_digit).count();
        match byte {
            b'e' => digits > 0,
            b'E' => digits > 0 && number.as_bytes().get(digits) != Some(&b'.'),
            _ => false,
        }
    })
}

fn explain(kind: &gcode::DiagnosticKind) -> String {
    match kind {
        gcode::DiagnosticKind::UnknownContent { text } if text.trim_start().starts_with('#') => {
            "parameters (#) are not read; let the program write plain numbers".into()
        }
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
