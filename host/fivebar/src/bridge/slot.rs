//! The sender slot: the thread of the controller does stops at once, lines in order, and reports.

use super::connection::Connections;
use super::log::PathLog;
use super::options::Reading;
use super::orders::Progress;
use super::path_state::PathState;
use super::protocol::{Engine, Refusal, Response};
use super::sender::Sender;
use super::view::ToolSpeed;
use fivebar_files::job::Dialect;
use fivebar_firmware::Status;
use fivebar_firmware::planner::{MoveErrorKind, Planner};
use fivebar_firmware::protocol::{CommandError, HostCommand, Reply};
use fivebar_firmware::safety::{Fault, State};
use fivebar_sim::controller::{Session, sentence};
use fivebar_sim::link::LinkError;
use fivebar_sim::path_queue::way_back;
use fivebar_sim::simulation::fault_name;
use std::time::{Duration, Instant};

/// Lines that are answered before the controller gets its next sign of life.
const LINES_PER_CYCLE: usize = 64;
/// A sender clears a fault this long after both the fault and its own connection, so that nothing
/// that a program sends by itself clears one. Programs wait up to two seconds before their first
/// line.
pub(super) const CLEARING: Duration = Duration::from_secs(3);

/// What the arm does apart from its path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Phase {
    /// It follows the path.
    Ready,
    /// It searches its home switches.
    Homing,
    /// It comes to rest on the path.
    Holding {
        /// Where the tool was when the stop began [m]. The stop switches the tool off at once, so the
        /// path goes on from there.
        from: Option<[f32; 2]>,
        /// Whether the user has said to go on before the arm rested.
        goes_on: bool,
    },
    /// It rests on the path, which goes on from there.
    Held,
    /// It comes to rest, and the path is dropped.
    Dropping,
}

/// The fault that the sender knows of.
pub(super) struct KnownFault {
    pub(super) latched: Option<Fault>,
    /// When the sender in control may clear it.
    pub(super) clears_from: Instant,
}

/// The place of the one sender that is in control of the arm of a session, and its path.
pub(super) struct SenderSlot<'a> {
    pub(super) planner: Planner,
    pub(super) reading: Reading,
    pub(super) connections: Connections,
    pub(super) note: Box<dyn Fn(&str) + Send + 'a>,
    log: Option<PathLog>,
    pub(super) sender: Option<Sender>,
    /// Whether a sender may take control now.
    pub(super) admits: bool,
    pub(super) path: PathState,
    pub(super) phase: Phase,
    pub(super) fault: KnownFault,
    pub(super) speed: ToolSpeed,
}

impl<'a> SenderSlot<'a> {
    /// A slot without a sender.
    pub(super) fn new(
        session: &mut Session,
        reading: Reading,
        connections: Connections,
        note: Box<dyn Fn(&str) + Send + 'a>,
        log: Option<PathLog>,
    ) -> Result<Self, LinkError> {
        let free = session.read_status()?;
        Ok(Self {
            planner: Planner::new(&session.settings),
            reading,
            connections,
            note,
            log,
            sender: None,
            admits: true,
            path: PathState::new(free),
            phase: Phase::Ready,
            fault: KnownFault {
                latched: session.status.fault,
                clears_from: session.clock.now(),
            },
            speed: ToolSpeed::from(session.status.tick),
        })
    }

    /// Runs until `ends` returns true or a reply fails. It then brings the arm to rest and disarms it.
    pub(super) fn run(
        &mut self,
        session: &mut Session,
        ends: &dyn Fn() -> bool,
    ) -> Result<(), LinkError> {
        let mut served = Ok(());
        while served.is_ok() && !ends() {
            served = self
                .serve_sender(session)
                .and_then(|()| session.pass_time());
        }
        session.stop_after(served)
    }

    /// Does what the sender asks for, without passing time.
    pub(super) fn serve_sender(&mut self, session: &mut Session) -> Result<(), LinkError> {
        self.stop_if_asked(session)?;
        self.take_events(session)?;
        self.update(session)?;
        for _ in 0..LINES_PER_CYCLE {
            self.stop_if_asked(session)?;
            self.feed(session)?;
            if !self.advance(session)? {
                break;
            }
        }
        self.stop_if_asked(session)?;
        self.release_lost_sender(session);
        Ok(())
    }

    /// Reads the status, which is also the sign of life, and notes which moves are done. During a
    /// stop on the path none is: the path goes on from the place where the stop began.
    pub(super) fn read_status(&mut self, session: &mut Session) -> Result<(), LinkError> {
        self.path.free = session.read_status()?;
        if let (Some(tag), Phase::Ready) = (session.status.tag, self.phase) {
            self.path.queue.progress(tag);
        }
        Ok(())
    }

    /// Reads the status and draws the consequences.
    fn update(&mut self, session: &mut Session) -> Result<(), LinkError> {
        self.read_status(session)?;
        self.speed
            .measure(&session.status, session.settings.control.tick_rate);
        if let Some(log) = &mut self.log
            && let Err(error) = log.add(&session.status)
        {
            (self.note)(&format!("the log ends: {error}"));
            self.log = None;
        }
        if session.status.fault != self.fault.latched {
            self.fault.latched = session.status.fault;
            if let Some(fault) = self.fault.latched {
                self.report_fault(session, fault);
            }
        }
        let rests = matches!(
            session.status.state,
            State::Armed | State::Stopped | State::Fault
        );
        let is_idle = self.path.is_idle(&session.status);
        match self.phase {
            Phase::Holding { from, goes_on } if rests => {
                if let (Some(begun), Some(rest)) = (from, session.status.reference) {
                    let speed = session.settings.motion.max_speed;
                    self.path
                        .queue
                        .resume_from(begun, way_back(rest, begun, speed));
                }
                self.phase = match goes_on {
                    true => Phase::Ready,
                    false => Phase::Held,
                };
            }
            Phase::Dropping if rests => {
                self.phase = Phase::Ready;
                self.drop_path(session);
            }
            Phase::Ready if is_idle => self.path.finish(),
            Phase::Ready
            | Phase::Homing
            | Phase::Holding { .. }
            | Phase::Held
            | Phase::Dropping => {}
        }
        Ok(())
    }

    fn report_fault(&mut self, session: &Session, fault: Fault) {
        self.fault.clears_from = session.clock.now() + CLEARING;
        self.drop_path(session);
        self.phase = Phase::Ready;
        let why = format!("fault {}, {}", fault.number(), fault_name(fault));
        (self.note)(&why);
        if let Some(sender) = &mut self.sender {
            sender.outlet.send(&Engine::alarm(sender.dialect, &why));
        }
    }

    /// Drops the path; the next line begins where the arm is.
    pub(super) fn drop_path(&mut self, session: &Session) {
        self.path.drop_moves();
        let tool = tool(&session.status);
        if let (Some(sender), Some(tool)) = (&mut self.sender, tool) {
            sender.engine.set_position(tool);
        }
    }

    /// Gives the controller the moves that wait.
    fn feed(&mut self, session: &mut Session) -> Result<(), LinkError> {
        while self.phase == Phase::Ready
            && self.path.free > 0
            && let Some(next) = self.path.queue.next()
        {
            match session.client.call(HostCommand::Move(next))? {
                Reply::Taken { free } => self.path.accept(free),
                Reply::Refused(CommandError::Move(error)) if error.kind == MoveErrorKind::Full => {
                    return Ok(());
                }
                reply => {
                    let why = match reply {
                        Reply::Refused(refusal) => sentence(&refusal),
                        other => format!("unexpected reply to a move: {other:?}"),
                    };
                    self.path.queue.drop_waiting();
                    if let Some(sender) = &mut self.sender {
                        if sender.current.is_some() {
                            sender.refuse(&Refusal::new(15, why));
                        } else {
                            sender.outlet.send(&Engine::note(sender.dialect, &why));
                        }
                    }
                    return Ok(());
                }
            }
        }
        Ok(())
    }

    /// Does what the present line still asks for, or takes the next one. Returns whether there
    /// is more to do at once.
    fn advance(&mut self, session: &mut Session) -> Result<bool, LinkError> {
        let view = self.view(session);
        let Some(sender) = &mut self.sender else {
            return Ok(false);
        };
        let Some((_, response)) = &sender.current else {
            // With the bridges off, nothing holds the arm: it may have moved since the last line.
            if let (State::Stopped, true, Some(tool)) =
                (session.status.state, view.homed, view.tool)
            {
                sender.engine.set_position(tool);
            }
            return Ok(sender.next(&view));
        };
        let Some(order) = response.orders.first().cloned() else {
            sender.accept();
            return Ok(true);
        };
        match self.execute(session, order)? {
            Progress::Done => {
                if let Some((_, response)) = self.current() {
                    response.orders.remove(0);
                }
                Ok(true)
            }
            Progress::Begun(rest) => {
                if let Some((_, response)) = self.current() {
                    response.orders[0] = rest;
                }
                Ok(true)
            }
            Progress::Waits => {
                if let Some(sender) = &mut self.sender {
                    sender.show_that_it_is_busy();
                }
                Ok(false)
            }
            Progress::Refused(refusal) => {
                if let Some(sender) = &mut self.sender {
                    sender.refuse(&refusal);
                }
                Ok(true)
            }
        }
    }

    fn current(&mut self) -> Option<&mut (Dialect, Response)> {
        self.sender.as_mut()?.current.as_mut()
    }
}

/// Whether the arm moves.
pub(super) fn moves(status: &Status) -> bool {
    matches!(
        status.state,
        State::Running
            | State::Stopping
            | State::Crossing
            | State::Compliant
            | State::Homing
            | State::Exciting
    )
}

/// The position where the next move begins [m].
pub(super) fn tool(status: &Status) -> Option<[f64; 2]> {
    let tool = status.reference.or(status.tool)?;
    Some(tool.map(f64::from))
}
