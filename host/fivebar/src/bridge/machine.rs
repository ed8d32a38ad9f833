//! The thread of the controller: it does stops at once, lines in order, and reports.

use super::BridgeOptions;
use super::connection::{Event, Shared};
use super::events::CLEARING;
use super::log::PathLog;
use super::orders::Progress;
use super::protocol::{Engine, Refusal, Response};
use super::sender::Sender;
use fivebar_files::job::{Dialect, JobOptions, Placement};
use fivebar_firmware::planner::{MoveErrorKind, Planner};
use fivebar_firmware::protocol::{CommandError, HostCommand, Reply};
use fivebar_firmware::safety::{Fault, State};
use fivebar_firmware::settings::CheckedSettings;
use fivebar_firmware::{Request, Status};
use fivebar_sim::controller::sentence;
use fivebar_sim::controller::{Connection, Opened, SteppedArm};
use fivebar_sim::held;
use fivebar_sim::link::{Client, LinkError};
use fivebar_sim::path_queue::{PathQueue, way_back};
use fivebar_sim::simulation::fault_name;
use std::sync::Arc;
use std::sync::mpsc::Receiver;
use std::time::{Duration, Instant};

/// Lines that are answered before the controller gets its next sign of life.
const LINES_PER_CYCLE: usize = 64;
/// Longest time for the arm to come to rest when the program ends.
const LONGEST_STOP: Duration = Duration::from_secs(5);

/// What the arm does apart from its path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Phase {
    /// It follows the path.
    Ready,
    /// It searches its home switches.
    Homing,
    /// It comes to rest or rests on the path, which goes on from there.
    Hold { rests: bool },
    /// It comes to rest, and the path is dropped.
    Dropping,
}

/// The controller and the sender in control of it.
pub(crate) struct Machine<'a> {
    pub(crate) client: Client<Box<dyn Connection>>,
    stepped: Option<SteppedArm>,
    pub(crate) settings: CheckedSettings,
    pub(super) planner: Planner,
    pub(super) placement: Placement,
    pub(super) reading: JobOptions,
    pub(super) fixed: Option<Dialect>,
    pub(super) events: Receiver<Event>,
    pub(super) shared: Arc<Shared>,
    pub(super) note: Box<dyn Fn(&str) + Send + 'a>,
    log: Option<PathLog>,
    pub(super) sender: Option<Sender>,
    /// Whether a sender may take control now.
    pub(crate) admits: bool,
    pub(super) path: PathQueue,
    pub(super) phase: Phase,
    pub(super) jogs: bool,
    /// Whether the user has said to go on before the arm rested.
    pub(super) goes_on: bool,
    /// Where the tool was when the stop began [m]. The stop switches the tool off at once, so the
    /// path goes on from there.
    pub(super) held_at: Option<[f32; 2]>,
    pub(crate) status: Status,
    pub(super) room: u8,
    all_room: u8,
    idle_since: Option<u32>,
    pub(super) fault: Option<Fault>,
    /// What users are to know of the senders' address.
    pub(crate) warning: Option<String>,
    /// When the sender in control may clear the fault.
    pub(super) clears_from: Instant,
    /// A tick, the reference in it [m], and the speed up to it [m/s].
    pub(super) speed: (u32, Option<[f32; 2]>, f64),
}

impl<'a> Machine<'a> {
    pub(super) fn new(
        opened: Opened,
        placement: Placement,
        options: &BridgeOptions,
        events: Receiver<Event>,
        shared: Arc<Shared>,
        note: Box<dyn Fn(&str) + Send + 'a>,
        log: Option<PathLog>,
    ) -> Result<Self, LinkError> {
        let Opened {
            mut client,
            stepped,
            settings,
            ..
        } = opened;
        let (status, room) = client.status()?;
        Ok(Self {
            client,
            stepped,
            planner: Planner::new(&settings),
            settings,
            placement,
            reading: options.reading,
            fixed: options.dialect,
            events,
            shared,
            note,
            log,
            sender: None,
            admits: true,
            path: PathQueue::default(),
            phase: Phase::Ready,
            jogs: false,
            goes_on: false,
            held_at: None,
            fault: status.fault,
            warning: None,
            clears_from: Instant::now(),
            speed: (status.tick, None, 0.0),
            status,
            room,
            all_room: room,
            idle_since: None,
        })
    }

    /// Runs until `ends` returns true. It then brings the arm to rest and disarms it.
    pub(super) fn run(&mut self, ends: &dyn Fn() -> bool) -> Result<(), LinkError> {
        while !ends() {
            self.cycle()?;
        }
        self.stop_arm()
    }

    /// Brings the arm to rest and switches the bridges off.
    pub(crate) fn stop_arm(&mut self) -> Result<(), LinkError> {
        let deadline = Instant::now() + LONGEST_STOP;
        // Refused if a fault is latched: then the controller itself brings the arm to rest.
        let _ = self.request(Request::Stop)?;
        loop {
            (self.status, _) = self.client.status()?;
            if !held::moves(&self.status) || Instant::now() > deadline {
                break;
            }
            self.pass_time()?;
        }
        if self.request(Request::Disarm)?.is_ok() {
            self.wait_until_off()?;
        }
        // A fault may hold the arm with the bridges on.
        if held::ends_by_emergency_stop(&self.client.status()?.0) {
            let _ = self.request(Request::EmergencyStop)?;
        }
        Ok(())
    }

    /// Waits until an accepted request has switched the bridges off: holding brakes engage before. If they do
    /// not hold, the arm stays held under a fault.
    pub(super) fn wait_until_off(&mut self) -> Result<(), LinkError> {
        let deadline = Instant::now() + LONGEST_STOP;
        loop {
            (self.status, _) = self.client.status()?;
            let failed = self.status.fault == Some(Fault::BrakeFailed);
            if self.status.state == State::Stopped || failed || Instant::now() > deadline {
                return Ok(());
            }
            self.pass_time()?;
        }
    }

    fn cycle(&mut self) -> Result<(), LinkError> {
        self.serve_sender()?;
        self.pass_time()
    }

    /// Does what the sender asks for, without passing time.
    pub(super) fn serve_sender(&mut self) -> Result<(), LinkError> {
        self.stop_if_asked()?;
        self.take_events()?;
        self.update()?;
        for _ in 0..LINES_PER_CYCLE {
            self.stop_if_asked()?;
            self.feed()?;
            if !self.advance()? {
                break;
            }
        }
        self.stop_if_asked()?;
        self.release_lost_sender();
        Ok(())
    }

    pub(crate) fn pass_time(&mut self) -> Result<(), LinkError> {
        match &mut self.stepped {
            Some(arm) => arm.step(&mut self.client),
            None => self.client.poll(),
        }
    }

    pub(super) fn request(&mut self, request: Request) -> Result<Result<(), String>, LinkError> {
        let answer = self.client.command(HostCommand::Request(request))?;
        Ok(answer.map_err(|refusal| sentence(&refusal)))
    }

    /// Reads the status, which is also the sign of life, and notes which moves are done. During a
    /// stop on the path none is: the path goes on from the place where the stop began.
    pub(super) fn read_status(&mut self) -> Result<(), LinkError> {
        (self.status, self.room) = self.client.status()?;
        if let (Some(tag), Phase::Ready) = (self.status.tag, self.phase) {
            self.path.progress(tag);
        }
        Ok(())
    }

    /// Reads the status and draws the consequences.
    fn update(&mut self) -> Result<(), LinkError> {
        self.read_status()?;
        self.all_room = self.all_room.max(self.room);
        self.measure_speed();
        if let Some(log) = &mut self.log
            && let Err(error) = log.add(&self.status)
        {
            (self.note)(&format!("the log ends: {error}"));
            self.log = None;
        }
        if self.status.fault != self.fault {
            self.fault = self.status.fault;
            if let Some(fault) = self.fault {
                self.report_fault(fault);
            }
        }
        let rests = matches!(
            self.status.state,
            State::Armed | State::Stopped | State::Fault
        );
        let is_idle = self.is_idle();
        match self.phase {
            Phase::Hold { rests: false } if rests => {
                if let (Some(begun), Some(rest)) = (self.held_at.take(), self.status.reference) {
                    let speed = self.settings.motion.max_speed;
                    self.path.resume_from(begun, way_back(rest, begun, speed));
                }
                self.phase = Phase::Hold { rests: true };
                if self.goes_on {
                    self.phase = Phase::Ready;
                }
            }
            Phase::Dropping if rests => {
                self.phase = Phase::Ready;
                self.drop_path();
            }
            Phase::Ready if is_idle => {
                self.path.finish();
                self.jogs &= !self.path.is_accepted();
            }
            Phase::Ready | Phase::Homing | Phase::Hold { .. } | Phase::Dropping => {}
        }
        Ok(())
    }

    /// Whether the controller has done all its moves. Between two ticks its queue may be empty
    /// although its last segment has not begun, so this must hold in two different ticks.
    fn is_idle(&mut self) -> bool {
        if self.status.state != State::Armed || self.room != self.all_room {
            self.idle_since = None;
            return false;
        }
        *self.idle_since.get_or_insert(self.status.tick) != self.status.tick
    }

    fn report_fault(&mut self, fault: Fault) {
        self.clears_from = Instant::now() + CLEARING;
        self.drop_path();
        self.phase = Phase::Ready;
        let why = format!("fault {}, {}", fault.number(), fault_name(fault));
        (self.note)(&why);
        if let Some(sender) = &mut self.sender {
            sender.outlet.send(&Engine::alarm(sender.dialect, &why));
        }
    }

    /// Drops the path; the next line begins where the arm is.
    pub(super) fn drop_path(&mut self) {
        self.path.clear();
        self.jogs = false;
        self.idle_since = None;
        let tool = self.tool();
        if let (Some(sender), Some(tool)) = (&mut self.sender, tool) {
            sender.engine.set_position(tool);
        }
    }

    /// Gives the controller the moves that wait.
    fn feed(&mut self) -> Result<(), LinkError> {
        while self.phase == Phase::Ready
            && self.room > 0
            && let Some(next) = self.path.next()
        {
            match self.client.call(HostCommand::Move(next))? {
                Reply::Taken { room } => {
                    self.room = room;
                    self.idle_since = None;
                    self.path.accept();
                }
                Reply::Refused(CommandError::Move(error)) if error.kind == MoveErrorKind::Full => {
                    return Ok(());
                }
                reply => {
                    let why = match reply {
                        Reply::Refused(refusal) => sentence(&refusal),
                        other => format!("unexpected reply to a move: {other:?}"),
                    };
                    self.path.drop_waiting();
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
    fn advance(&mut self) -> Result<bool, LinkError> {
        let view = self.view();
        let Some(sender) = &mut self.sender else {
            return Ok(false);
        };
        let Some((_, response)) = &sender.current else {
            // With the bridges off, nothing holds the arm: it may have moved since the last line.
            if let (State::Stopped, true, Some(tool)) = (self.status.state, view.homed, view.tool) {
                sender.engine.set_position(tool);
            }
            return Ok(sender.next(&view));
        };
        let Some(order) = response.orders.first().cloned() else {
            sender.accept();
            return Ok(true);
        };
        match self.execute(order)? {
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

    /// Whether the arm moves.
    pub(super) fn moves(&self) -> bool {
        matches!(
            self.status.state,
            State::Running | State::Stopping | State::Crossing | State::Homing | State::Exciting
        )
    }

    /// The position where the next move begins [m].
    pub(super) fn tool(&self) -> Option<[f64; 2]> {
        let tool = self.status.reference.or(self.status.tool)?;
        Some(tool.map(f64::from))
    }
}
