//! The words of RepRap: line numbers, checksums, reports.

use super::engine::{Engine, Order, Refusal, Response, View};
use super::splitter::{at_once, command, is};
use fivebar_files::job::Dialect;

pub(super) fn greeting() -> String {
    format!("start\necho:Fivebar {}\n", env!("CARGO_PKG_VERSION"))
}

/// A line's number and its text without number and checksum, or why it must be sent again.
fn numbered(text: &str) -> Result<(Option<i64>, &str), &'static str> {
    let Some(rest) = text.strip_prefix(['N', 'n']) else {
        return Ok((None, text));
    };
    let digits = rest
        .find(|c: char| !(c.is_ascii_digit() || c == '-'))
        .unwrap_or(rest.len());
    // Of 32 bits, so that there is always a next number.
    let number: i32 = rest[..digits].parse().map_err(|_| "no line number")?;
    let Some((summed, stated)) = text.rsplit_once('*') else {
        return Err("No Checksum with line number");
    };
    let found = summed.bytes().fold(0, |sum: u8, byte| sum ^ byte);
    if stated.trim().parse() != Ok(found) {
        return Err("checksum mismatch");
    }
    Ok((Some(number.into()), summed[1 + digits..].trim()))
}

/// The line without a feed rate of zero, which senders write where they know none: it changes
/// nothing.
fn without_zero_feed(text: &str) -> String {
    let is_zero = |word: &&str| {
        let rate = word.strip_prefix(['F', 'f']).map(str::parse::<f64>);
        matches!(rate, Some(Ok(0.0)))
    };
    let words: Vec<&str> = text.split(' ').filter(|word| !is_zero(word)).collect();
    words.join(" ")
}

/// The number after a letter, of 32 bits.
fn value(text: &str, letter: char) -> Option<i64> {
    let upper = text.to_uppercase();
    let (_, after) = upper.split_once(letter)?;
    let end = after.find(|c: char| !(c.is_ascii_digit() || c == '-'));
    let number: i32 = after[..end.unwrap_or(after.len())].parse().ok()?;
    Some(number.into())
}

impl Engine {
    pub(super) fn reprap(&mut self, text: &str, view: &View) -> Result<Response, Refusal> {
        let (number, text) = match numbered(text) {
            Ok(numbered) => numbered,
            Err(why) => return Ok(self.again(why)),
        };
        let words = command(text);
        let is = |name| is(&words, name);
        if is("M110") {
            self.last_line = value(&words[4..], 'N').or(number).or(Some(0));
            return Ok(Response::new(String::new(), Vec::new()));
        }
        if let Some(number) = number {
            if self.last_line.is_some_and(|last| number != last + 1) {
                return Ok(self.again("Line Number is not Last Line Number+1"));
            }
            self.last_line = Some(number);
        }
        let done = |text: &str, orders| Ok(Response::new(text.into(), orders));
        match words.as_str() {
            "" => done("", Vec::new()),
            _ if is("M105") => Ok(Response {
                ok: "ok T:0.0 /0.0 B:0.0 /0.0\n".into(),
                ..Response::new(String::new(), Vec::new())
            }),
            _ if is("M114") => done(&self.position_text(view), Vec::new()),
            _ if is("M115") => done(
                &format!(
                    "FIRMWARE_NAME:Fivebar {} SOURCE_CODE_URL:none PROTOCOL_VERSION:1.0 \
                     MACHINE_TYPE:five-bar EXTRUDER_COUNT:1\nCap:EMERGENCY_PARSER:1\n",
                    env!("CARGO_PKG_VERSION")
                ),
                Vec::new(),
            ),
            _ if is("M220") && !words.contains('S') => done(
                &format!("FR:{:.0}%\n", 100.0 * view.shares.feed),
                Vec::new(),
            ),
            // They have taken effect when they were received.
            _ if at_once(&words).is_some() => done("", Vec::new()),
            _ if is("M400") => done("", vec![Order::Finish]),
            _ if is("M999") => done("", vec![Order::Unlock]),
            _ if is("M18") || is("M84") => done("", vec![Order::Finish, Order::Disarm]),
            _ if is("M17") => done("", Vec::new()),
            _ => self.gcode(Dialect::RepRap, &without_zero_feed(text), view),
        }
    }

    /// The request to send the lines after the last good one again.
    fn again(&self, why: &str) -> Response {
        let last = self.last_line.unwrap_or(0);
        let text = format!("Error:{why}, Last Line: {last}\nResend: {}\n", last + 1);
        Response::new(text, Vec::new())
    }

    /// The answer to M114 [mm].
    fn position_text(&self, view: &View) -> String {
        let [x, y] = view.tool.unwrap_or(self.home);
        let from =
            |[x0, y0]: [f64; 2]| [x - x0, y - y0].map(|value| (value * 1e5).round() / 1e2 + 0.0);
        let [job_x, job_y] = from(self.stream.zero());
        let [machine_x, machine_y] = from(self.home);
        format!(
            "X:{job_x:.2} Y:{job_y:.2} Z:0.00 E:0.00 Count X:{machine_x:.2} Y:{machine_y:.2} Z:0\n"
        )
    }
}
