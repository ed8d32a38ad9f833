//! Keeps web browsers out.
//!
//! A page of any site can have a browser send bytes to a TCP port of this computer. The page
//! chooses most of them, but not the first line: that is a request of HTTP, or the beginning of an
//! encrypted connection. So nothing of a connection takes effect before its first line is known,
//! and the connection ends at the first line that no sender sends.

use super::splitter::{Input, RealTime, Splitter};
use fivebar_files::job::Dialect;

/// Real-time commands that may wait for the first line; a sender sends few before it.
const MOST_HELD: usize = 64;

/// Divides a sender's bytes, and ends a connection of others.
#[derive(Debug)]
pub(in crate::bridge) struct Gate {
    splitter: Splitter,
    is_guarded: bool,
    /// Whether a line has come that is a sender's.
    is_known: bool,
    /// What waits for that line.
    held: Vec<Input>,
}

impl Gate {
    /// A gate that passes on whatever comes.
    pub(in crate::bridge) fn open(dialect: Option<Dialect>) -> Self {
        Self {
            splitter: Splitter::new(dialect),
            is_guarded: false,
            is_known: true,
            held: Vec::new(),
        }
    }

    /// A gate that only senders pass.
    pub(in crate::bridge) fn guarded(dialect: Option<Dialect>) -> Self {
        Self {
            is_guarded: true,
            is_known: false,
            ..Self::open(dialect)
        }
    }

    /// Takes a byte; returns what takes effect now.
    ///
    /// # Errors
    /// Why the connection is to end. What is held is dropped with it.
    pub(in crate::bridge) fn feed(&mut self, byte: u8) -> Result<Vec<Input>, &'static str> {
        let inputs: Vec<Input> = self.splitter.feed(byte).collect();
        if !self.is_guarded {
            return Ok(inputs);
        }
        if byte.is_ascii_control() && !matches!(byte, b'\t' | b'\n' | b'\r' | 0x18) {
            return Err("it sends control characters, as encrypted connections have");
        }
        if self.splitter.is_too_long() {
            return Err("it sends a line of more than 1,023 characters");
        }
        let mut passed = Vec::new();
        for input in inputs {
            match &input {
                Input::Line(line) if is_foreign(&line.text) => {
                    return Err(
                        "it sends a line that begins with a word or speaks of HTTP, \
                                as a web browser does",
                    );
                }
                // These move nothing, and a sender may ask and stop before it sends a line.
                Input::RealTime(RealTime::Report) => {
                    passed.push(input);
                    continue;
                }
                Input::Line(line) if line.text.is_empty() => {
                    passed.push(input);
                    continue;
                }
                Input::RealTime(RealTime::Reset | RealTime::Emergency) => {
                    self.held.clear();
                    passed.push(input);
                    continue;
                }
                Input::Line(_) => self.is_known = true,
                Input::RealTime(_) => {}
            }
            self.held.push(input);
        }
        if self.is_known {
            passed.append(&mut self.held);
        } else if self.held.len() > MOST_HELD {
            return Err("it sends real-time commands without a line");
        }
        Ok(passed)
    }
}

/// Whether a line is no sender's: it begins with a word of letters, as the methods and headers of
/// HTTP do, or names that protocol. G-code has a number after each letter.
fn is_foreign(text: &str) -> bool {
    let letters = text.bytes().take_while(u8::is_ascii_alphabetic).count();
    letters > 1 || text.to_ascii_lowercase().contains("http/")
}

#[cfg(test)]
mod tests {
    use super::Gate;
    use crate::bridge::protocol::Input;

    /// What takes effect of these bytes, and whether the connection ends.
    fn passed(bytes: &[u8]) -> (Vec<String>, bool) {
        let mut gate = Gate::guarded(None);
        let mut all = Vec::new();
        for &byte in bytes {
            let Ok(inputs) = gate.feed(byte) else {
                return (all, true);
            };
            all.extend(inputs.into_iter().map(|input| match input {
                Input::Line(line) => line.text,
                Input::RealTime(command) => format!("{command:?}"),
            }));
        }
        (all, false)
    }

    #[test]
    fn nothing_of_a_browsers_request_takes_effect() {
        let body = "\r\n\r\n$X\n$H\nG1 X10 F600\n~\n";
        let long = "a".repeat(1100);
        let requests = [
            "POST / HTTP/1.1\r\nHost: 127.0.0.1:8106".to_owned(),
            format!("POST /{long} HTTP/1.1\r\nHost: 127.0.0.1"),
            "POST /~!\u{85}~ HTTP/1.1".into(),
            "GET / http/1.1".into(),
            "GET /\tHTTP/1.1".into(),
            "\tGET / HTTP/1.1".into(),
            "  POST /".into(),
            "\r\n\r\nPOST / HTTP/1.1".into(),
            "PRI * HTTP/2.0".into(),
            "$X9 / HTTP/1.1".into(),
            "Host: 127.0.0.1".into(),
            "Origin: null".into(),
            "P~O~S~T / x".into(),
            "~".repeat(100),
            "\u{16}\u{3}\u{1}".into(),
            "\0\u{1}".into(),
        ];
        for request in requests {
            let (all, ends) = passed(format!("{request}{body}").as_bytes());
            assert!(ends, "{request:?}");
            let does_nothing = all
                .iter()
                .all(|input| input.is_empty() || input == "Report");
            assert!(does_nothing, "{request:?} does {all:?}");
        }
    }

    #[test]
    fn a_sender_whose_later_lines_are_a_browsers_is_disconnected_there() {
        let (all, ends) = passed(b"$I\nG21\nOrigin: http://example.org\n$H\n");
        assert_eq!((all, ends), (vec!["$I".into(), "G21".into()], true));
        let (all, ends) = passed(&[b"$I\n".as_slice(), &[b'0'; 2000]].concat());
        assert_eq!((all, ends), (vec!["$I".into()], true));
    }

    #[test]
    fn a_sender_asks_and_stops_before_its_first_line() {
        let (all, ends) = passed(b"?\x18~!?\r\n$I\nG1 X1\n");
        let expected = [
            "Report", "Reset", "Report", "", "Resume", "Hold", "$I", "G1 X1",
        ];
        assert_eq!(all, expected);
        assert!(!ends);
        let (all, _) = passed(b"~G1 X1\x18$X\n");
        assert_eq!(all, ["Reset", "$X"], "a reset drops what was before it");
    }

    #[test]
    fn the_first_lines_of_senders_pass() {
        for line in [
            "$$",
            "$I",
            "$X",
            "$H",
            "M105",
            "N0 M110 N0*125",
            "G21",
            "(a job)",
            "; a job",
            "%",
            "[ESP800]",
            "$J=G91 X1 F600",
            "M117 Hello",
            "g1x10f600",
        ] {
            let (all, ends) = passed(format!("{line}\n").as_bytes());
            assert_eq!((all, ends), (vec![line.to_owned()], false), "{line}");
        }
    }
}
