//! The board on the line, in the words of the test.

use super::row::Verdict;
use crate::link::{Client, LinkError};
use fivebar_firmware::protocol::{
    BoardFacts, BoardReport, BoardTest, CommandError, FlashTime, HostCommand, Identity, Reply,
    TimedSpan, Timing, VERSION,
};
use fivebar_firmware::recorder::{LogConfig, LogPage, Signals};
use fivebar_firmware::{Request, Status, ToldSample};
use std::io::{Read, Write};

/// Who connects wires, and reads what happens.
pub trait Hands {
    /// Does a task; false if the wire stays off.
    fn connect(&mut self, task: &str) -> bool;

    /// Reads a finished row or what is being measured.
    fn report(&mut self, line: &str);
}

/// Ticks of a second.
pub(super) const SECOND: u32 = 10_000;
/// Looks at the status while ticks pass, before the controller counts as one without ticks.
const LOOKS: u32 = 400;

/// A board.
pub(super) struct Bench<'a, L> {
    pub(super) client: &'a mut Client<L>,
    pub(super) hands: &'a mut dyn Hands,
}

impl<L: Read + Write> Bench<'_, L> {
    fn step(&mut self, test: BoardTest) -> Result<Result<BoardReport, CommandError>, LinkError> {
        let command = HostCommand::BoardTest(test);
        match self.client.call(command)? {
            Reply::Board(report) => Ok(Ok(report)),
            Reply::Refused(error) => Ok(Err(error)),
            other => Err(unexpected(command, other)),
        }
    }

    /// What the board knows of itself; none if it has no test.
    pub(super) fn facts(&mut self) -> Result<Option<BoardFacts>, LinkError> {
        match self.step(BoardTest::Facts)? {
            Ok(BoardReport::Facts(facts)) => Ok(Some(facts)),
            _ => Ok(None),
        }
    }

    pub(super) fn begin_timing(&mut self) -> Result<(), LinkError> {
        let command = HostCommand::BoardTest(BoardTest::BeginTiming);
        self.client.command(command).map(|_| ())
    }

    pub(super) fn timing(&mut self, span: TimedSpan) -> Result<Timing, LinkError> {
        match self.step(BoardTest::Timing(span))? {
            Ok(BoardReport::Timing(timing)) => Ok(timing),
            _ => Ok(Timing::NONE),
        }
    }

    pub(super) fn flash(
        &mut self,
        step: BoardTest,
    ) -> Result<Result<FlashTime, Verdict>, LinkError> {
        Ok(match self.step(step)? {
            Ok(BoardReport::Flash(time)) => Ok(time),
            Ok(_) => Err(Verdict::failed("the board reports something else", LATER)),
            Err(error) => Err(Verdict::failed(error.to_string(), LATER)),
        })
    }

    pub(super) fn status(&mut self) -> Result<Status, LinkError> {
        Ok(self.client.status()?.0)
    }

    pub(super) fn sample(&mut self) -> Result<ToldSample, LinkError> {
        Ok(self.client.sample()?.unwrap_or_default())
    }

    pub(super) fn request(
        &mut self,
        request: Request,
    ) -> Result<Result<(), CommandError>, LinkError> {
        self.client.command(HostCommand::Request(request))
    }

    /// Lets so many ticks pass; false if they do not.
    pub(super) fn pass(&mut self, ticks: u32) -> Result<bool, LinkError> {
        let begin = self.status()?.tick;
        let mut last = (begin, 0);
        while last.1 < LOOKS {
            self.client.poll()?;
            let tick = self.status()?.tick;
            if tick.wrapping_sub(begin) >= ticks {
                return Ok(true);
            }
            last = if tick == last.0 {
                (tick, last.1 + 1)
            } else {
                (tick, 0)
            };
        }
        Ok(false)
    }

    /// Rows of these signals, one every so many ticks.
    pub(super) fn record(
        &mut self,
        signals: Signals,
        every: u16,
        rows: usize,
    ) -> Result<Vec<Vec<u16>>, LinkError> {
        let width = signals.bits().count_ones() as usize;
        let config = LogConfig {
            signals: signals.bits(),
            every,
            powered: false,
        };
        let begun = self.client.command(HostCommand::BeginLog(config))?;
        if begun.is_err() || !self.pass(rows as u32 * u32::from(every) + 20)? {
            return Ok(Vec::new());
        }
        let mut words = Vec::new();
        while words.len() < rows * width {
            let command = HostCommand::ReadLog {
                from: words.len() as u16,
            };
            let LogPage { page, .. } = match self.client.call(command)? {
                Reply::Log(page) => page,
                other => return Err(unexpected(command, other)),
            };
            words.extend(page.into_iter().flatten());
        }
        Ok(words
            .chunks_exact(width)
            .take(rows)
            .map(<[u16]>::to_vec)
            .collect())
    }

    /// Hangs the controller until its watchdog resets it: its identity afterwards.
    pub(super) fn hang(&mut self) -> Result<Result<Identity, CommandError>, LinkError> {
        match self.client.call(HostCommand::BoardTest(BoardTest::Hang))? {
            // The controller that has started anew knows no session.
            Reply::Refused(CommandError::NoSession) => {}
            Reply::Refused(error) => return Ok(Err(error)),
            other => return Err(unexpected(HostCommand::BoardTest(BoardTest::Hang), other)),
        }
        let hello = HostCommand::Hello {
            version: VERSION,
            session: 0x7e57,
        };
        match self.client.call(hello)? {
            Reply::Hello(identity) => Ok(Ok(identity)),
            other => Err(unexpected(hello, other)),
        }
    }
}

/// What to do where nothing better is known.
pub(super) const LATER: &str = "reset the board and run the test again";

fn unexpected(command: HostCommand, reply: Reply) -> LinkError {
    LinkError::UnexpectedReply {
        command: format!("{command:?}"),
        reply: format!("{reply:?}"),
    }
}
