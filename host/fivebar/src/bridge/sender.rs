//! The sender in control: its lines and the answers to them.

use super::connection::Outlet;
use super::protocol::{Engine, Line, Refusal, Response, View};
use fivebar_files::job::Dialect;
use std::collections::VecDeque;
use std::time::{Duration, Instant};

/// Bytes of lines that may wait; a sender that waits for its answers has far fewer.
const WAITING: usize = 1 << 16;
/// Time between two signs to a RepRap sender that its line is still in progress.
const BUSY_EVERY: Duration = Duration::from_secs(2);

/// The sender in control.
pub(super) struct Sender {
    pub(super) outlet: Outlet,
    pub(super) engine: Engine,
    pub(super) dialect: Dialect,
    pub(super) lines: VecDeque<Line>,
    pub(super) waiting: usize,
    /// The line in progress.
    pub(super) current: Option<(Dialect, Response)>,
    busy_since: Instant,
    pub(super) lost: Option<String>,
}

impl Sender {
    pub(super) fn new(outlet: Outlet, engine: Engine, dialect: Dialect) -> Self {
        let busy_since = outlet.presence.clock.now();
        Self {
            outlet,
            engine,
            dialect,
            lines: VecDeque::new(),
            waiting: 0,
            current: None,
            busy_since,
            lost: None,
        }
    }

    /// Adds a line to those that wait. A sender of far too many is disconnected; returns whether this
    /// line is the one too many.
    pub(super) fn push(&mut self, line: Line) -> bool {
        let had_room = self.waiting <= WAITING;
        self.dialect = line.dialect;
        self.waiting += line.length;
        self.lines.push_back(line);
        let is_one_too_many = had_room && self.waiting > WAITING;
        if is_one_too_many {
            self.outlet.close();
        }
        is_one_too_many
    }

    /// Whether no line waits or is in progress.
    pub(super) fn has_no_lines(&self) -> bool {
        self.lines.is_empty() && self.current.is_none()
    }

    pub(super) fn drop_lines(&mut self) {
        self.lines.clear();
        self.waiting = 0;
        self.current = None;
    }

    /// Takes the next line; returns whether there was one.
    pub(super) fn next(&mut self, view: &View) -> bool {
        let Some(line) = self.lines.pop_front() else {
            return false;
        };
        self.waiting = self.waiting.saturating_sub(line.length);
        self.busy_since = self.outlet.presence.clock.now();
        match self.engine.line(&line, view) {
            Ok(response) => {
                self.outlet.send(&response.text);
                self.current = Some((line.dialect, response));
            }
            Err(refusal) => {
                let answer = self.engine.refuse(line.dialect, &refusal);
                self.outlet.send(&answer);
            }
        }
        true
    }

    pub(super) fn accept(&mut self) {
        if let Some((_, response)) = self.current.take() {
            self.outlet.send(&response.ok);
        }
    }

    pub(super) fn refuse(&mut self, refusal: &Refusal) {
        if let Some((dialect, _)) = self.current.take() {
            let answer = self.engine.refuse(dialect, refusal);
            self.outlet.send(&answer);
        }
    }

    /// RepRap senders give up on a line without a sign of life.
    pub(super) fn show_that_it_is_busy(&mut self) {
        let clock = &self.outlet.presence.clock;
        if self.dialect == Dialect::RepRap && clock.since(self.busy_since) > BUSY_EVERY {
            self.busy_since = clock.now();
            self.outlet.send("echo:busy: processing\n");
        }
    }
}
