//! From a sender's bytes to lines and real-time commands.

use fivebar_files::job::Dialect;

/// Bytes of the longest line that is read. Of a longer one, the beginning is kept, and it is refused.
pub(super) const LONGEST_LINE: usize = 1024;

/// A command that waits for no line before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::bridge) enum RealTime {
    /// `?`: report the state.
    Report,
    /// `!` or 0x84: stop on the path.
    Hold,
    /// `~` or M108: go on.
    Resume,
    /// ^X: bridges off at once.
    Reset,
    /// M112: the same, and latched also if the bridges are off already.
    Emergency,
    /// 0x85: stop jogging.
    CancelJog,
    /// 0x90 to 0x94: another share of the feed rate.
    Feed(ShareChange),
    /// 0x95 to 0x97: another share of the speed of G0 [%].
    Rapid(i32),
    /// 0x99 to 0x9D: another share of the tool's power.
    Power(ShareChange),
    /// M220: another share of all speeds [%].
    Speed(i32),
}

/// A change of a share [%].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::bridge) enum ShareChange {
    To(i32),
    By(i32),
}

/// A line, without its end.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(in crate::bridge) struct Line {
    pub(in crate::bridge) dialect: Dialect,
    pub(in crate::bridge) text: String,
    /// The bytes that it took of the sender's count of characters.
    pub(in crate::bridge) length: usize,
}

/// What a sender has sent.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(in crate::bridge) enum Input {
    Line(Line),
    RealTime(RealTime),
}

/// Divides a sender's bytes. The dialect is Grbl's until a line has a checksum or one of M105,
/// M110 and M115, unless it is fixed.
#[derive(Debug)]
pub(in crate::bridge) struct Splitter {
    dialect: Dialect,
    is_fixed: bool,
    line: Vec<u8>,
    length: usize,
    after_return: bool,
}

impl Splitter {
    pub(in crate::bridge) fn new(fixed: Option<Dialect>) -> Self {
        Self {
            dialect: fixed.unwrap_or(Dialect::Grbl),
            is_fixed: fixed.is_some(),
            line: Vec::new(),
            length: 0,
            after_return: false,
        }
    }

    /// Takes a byte; returns what it completes.
    pub(in crate::bridge) fn feed(&mut self, byte: u8) -> impl Iterator<Item = Input> {
        let is_grbl = self.dialect == Dialect::Grbl;
        let second_of_pair = byte == b'\n' && std::mem::take(&mut self.after_return);
        let at_once = match byte {
            0x18 => Some(RealTime::Reset),
            b'?' if is_grbl => Some(RealTime::Report),
            // 0x84: the safety door is open.
            b'!' | 0x84 if is_grbl => Some(RealTime::Hold),
            b'~' if is_grbl => Some(RealTime::Resume),
            0x85 if is_grbl => Some(RealTime::CancelJog),
            0x90 if is_grbl => Some(RealTime::Feed(ShareChange::To(100))),
            0x91 if is_grbl => Some(RealTime::Feed(ShareChange::By(10))),
            0x92 if is_grbl => Some(RealTime::Feed(ShareChange::By(-10))),
            0x93 if is_grbl => Some(RealTime::Feed(ShareChange::By(1))),
            0x94 if is_grbl => Some(RealTime::Feed(ShareChange::By(-1))),
            0x95 if is_grbl => Some(RealTime::Rapid(100)),
            0x96 if is_grbl => Some(RealTime::Rapid(50)),
            0x97 if is_grbl => Some(RealTime::Rapid(25)),
            0x99 if is_grbl => Some(RealTime::Power(ShareChange::To(100))),
            0x9A if is_grbl => Some(RealTime::Power(ShareChange::By(10))),
            0x9B if is_grbl => Some(RealTime::Power(ShareChange::By(-10))),
            0x9C if is_grbl => Some(RealTime::Power(ShareChange::By(1))),
            0x9D if is_grbl => Some(RealTime::Power(ShareChange::By(-1))),
            _ => None,
        };
        if at_once == Some(RealTime::Reset) {
            self.line.clear();
            self.length = 0;
        }
        let (mut first, mut second) = (at_once.map(Input::RealTime), None);
        match byte {
            _ if first.is_some() || second_of_pair => {}
            b'\r' | b'\n' => {
                self.after_return = byte == b'\r';
                (first, second) = self.end();
            }
            // Grbl's other real-time commands: coolant, and the spindle's stop during a
            // hold, in which the tool is off in any case.
            0x80.. if is_grbl => {}
            _ => {
                self.length += 1;
                if self.line.len() < LONGEST_LINE {
                    self.line.push(byte);
                }
            }
        }
        first.into_iter().chain(second)
    }

    /// Whether the present line is longer than the longest that is read.
    pub(super) fn is_too_long(&self) -> bool {
        self.length >= LONGEST_LINE
    }

    fn end(&mut self) -> (Option<Input>, Option<Input>) {
        let bytes = std::mem::take(&mut self.line);
        let length = std::mem::take(&mut self.length) + 1;
        let text = String::from_utf8_lossy(&bytes).trim().to_owned();
        let command = command(&text);
        let is = |name| is(&command, name);
        let is_numbered = text.starts_with(['N', 'n']) && text.contains('*');
        if !self.is_fixed && (is_numbered || ["M105", "M110", "M115"].into_iter().any(is)) {
            self.dialect = Dialect::RepRap;
        }
        let at_once = at_once(&command);
        let line = Input::Line(Line {
            dialect: self.dialect,
            text,
            length,
        });
        match at_once {
            Some(command) => (Some(Input::RealTime(command)), Some(line)),
            None => (Some(line), None),
        }
    }
}

/// What a command in words asks for at once; none if it waits for the lines before it.
pub(super) fn at_once(command: &str) -> Option<RealTime> {
    match command {
        _ if is(command, "M112") => Some(RealTime::Emergency),
        _ if is(command, "M108") => Some(RealTime::Resume),
        _ if is(command, "M220") => value(command, 'S').map(RealTime::Speed),
        _ => None,
    }
}

/// Whether a command is this M code.
pub(super) fn is(command: &str, name: &str) -> bool {
    let rest = command.strip_prefix(name);
    rest.is_some_and(|rest| !rest.starts_with(|c: char| c.is_ascii_digit()))
}

/// The whole number after a letter, without what follows it.
fn value(command: &str, letter: char) -> Option<i32> {
    let (_, after) = command.split_once(letter)?;
    let end = after.find(|c: char| !c.is_ascii_digit());
    after[..end.unwrap_or(after.len())].parse().ok()
}

/// A line's text in capitals without its number and its spaces.
pub(super) fn command(text: &str) -> String {
    let text = text.trim_start();
    let numbered = text.strip_prefix(['N', 'n']);
    let text = numbered.map_or(text, |rest| {
        rest.trim_start_matches(|c: char| c.is_ascii_digit() || c == '-')
    });
    text.split_whitespace().collect::<String>().to_uppercase()
}

#[cfg(test)]
mod tests {
    use super::{Input, Splitter};
    use fivebar_files::job::Dialect;

    fn inputs(splitter: &mut Splitter, bytes: &[u8]) -> Vec<String> {
        let all = bytes
            .iter()
            .flat_map(|&byte| splitter.feed(byte).collect::<Vec<_>>());
        all.map(|input| match input {
            Input::Line(line) => format!("{:?} {}", line.dialect, line.text),
            Input::RealTime(command) => format!("{command:?}"),
        })
        .collect()
    }

    #[test]
    fn real_time_commands_are_taken_out_of_a_line() {
        let mut splitter = Splitter::new(None);
        let found = inputs(&mut splitter, b"G1 X?1\x850!\r\nG0~\x84\n");
        let expected = [
            "Report",
            "CancelJog",
            "Hold",
            "Grbl G1 X10",
            "Resume",
            "Hold",
            "Grbl G0",
        ];
        assert_eq!(found, expected);
    }

    #[test]
    fn shares_of_speed_and_power_change_at_once() {
        let mut splitter = Splitter::new(None);
        let found = inputs(&mut splitter, b"G1\x90\x91 X\x941\x96\x9B\x9E\nM220 S50\n");
        let expected = [
            "Feed(To(100))",
            "Feed(By(10))",
            "Feed(By(-1))",
            "Rapid(50)",
            "Power(By(-10))",
            "Grbl G1 X1",
            "Speed(50)",
            "Grbl M220 S50",
        ];
        assert_eq!(found, expected);
    }

    #[test]
    fn an_emergency_stop_drops_the_begun_line() {
        let mut splitter = Splitter::new(None);
        assert_eq!(
            inputs(&mut splitter, b"G1 X1\x18$X\n"),
            ["Reset", "Grbl $X"]
        );
    }

    #[test]
    fn a_checksum_switches_to_reprap_where_a_question_is_text() {
        let mut splitter = Splitter::new(None);
        let found = inputs(&mut splitter, b"N0 M110 N0*125\nM117 done?\nM112\nM108\n");
        let expected = [
            "RepRap N0 M110 N0*125",
            "RepRap M117 done?",
            "Emergency",
            "RepRap M112",
            "Resume",
            "RepRap M108",
        ];
        assert_eq!(found, expected);
        assert_eq!(inputs(&mut Splitter::new(None), b"M105\n"), ["RepRap M105"]);
        assert_eq!(inputs(&mut Splitter::new(None), b"M1050\n"), ["Grbl M1050"]);
    }

    #[test]
    fn a_fixed_dialect_stays() {
        let mut splitter = Splitter::new(Some(Dialect::Grbl));
        assert_eq!(inputs(&mut splitter, b"M105\n?"), ["Grbl M105", "Report"]);
    }

    #[test]
    fn the_length_of_a_line_counts_its_end_and_no_real_time_command() {
        let mut splitter = Splitter::new(None);
        let all = b"G1 X1?\n"
            .iter()
            .flat_map(|&byte| splitter.feed(byte).collect::<Vec<_>>());
        let Some(Input::Line(line)) = all.last() else {
            panic!("no line");
        };
        assert_eq!(line.length, 6);
    }
}
