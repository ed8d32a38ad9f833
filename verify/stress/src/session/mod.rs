//! A session: host, line, controller and arm, one event after the other.

mod events;
mod way_out;

use crate::arm::plant;
use crate::bytes::Bytes;
use crate::kinds::kind_of;
use crate::limits::{Followed, Limits};
use crate::orders;
use crate::report::Report;
use crate::rules::{Rules, Violation};
use crate::samples::Hostile;
use crate::timed::Tool;
use fivebar_firmware::controller::Controller;
use fivebar_firmware::motion::StreamPoint;
use fivebar_firmware::planner::StreamPhase;
use fivebar_firmware::protocol::{
    Board as Kind, CommandError, ControllerMessage, Decoder, HostCommand, HostMessage, Identity,
    Reply, Reset, Sequence, VERSION, encode,
};
use fivebar_firmware::recorder::{Log, Recorder};
use fivebar_firmware::safety::State;
use fivebar_firmware::session;
use fivebar_firmware::session::Board;
use fivebar_firmware::settings::CheckedSettings;
use fivebar_firmware::storage::StorageError;
use fivebar_firmware::{
    ActuatorCommand, MoveKind, Planner, Request, SensorSample, Settings, ToldSample,
};
use fivebar_plant::Plant;

/// Ticks between two requests of the status.
const POLL: u32 = 100;

/// The outputs of a tick, to be compared bit by bit.
pub(crate) type Output = ([u32; 2], bool, State);

/// A board with sensors of its own, whose flash accepts everything.
struct Desk {
    log: Log,
    sample: ToldSample,
}

impl Board for Desk {
    fn save(&mut self, _: &Settings) -> Result<(), StorageError> {
        Ok(())
    }

    fn tick(&mut self, _: &mut Controller, _: &SensorSample) -> Option<(ActuatorCommand, u32)> {
        None
    }

    fn recorder(&self) -> Option<Recorder<'_>> {
        Some(self.log.recorder())
    }

    fn sample(&self) -> Option<ToldSample> {
        Some(self.sample)
    }
}

pub(crate) struct Session<'b> {
    bytes: Bytes<'b>,
    controller: Controller,
    planner: Planner,
    session: session::Session,
    decoder: Decoder<HostMessage>,
    board: Box<Desk>,
    plant: Plant,
    /// No fault has been injected into the plant.
    is_sound: bool,
    flags: u8,
    rules: Rules,
    limits: Option<Limits>,
    next: Sequence,
    last_frame: Vec<u8>,
    corrupt: Option<u8>,
    hostile: Option<(Hostile, u32, u32)>,
    planner_every: u32,
    /// The kind of each move; tags are its indices.
    kinds: Vec<Followed>,
    /// Where the last timed move ends that was accepted, if no other move came after it [m].
    timed_end: Option<Tool>,
    /// The controller's path generation when the planner ran last.
    planned_for: u32,
    outputs: Vec<Output>,
    /// Which of the commands so far were refused.
    refusals: Vec<bool>,
    /// In the second run: which commands to replace.
    replace: Option<Vec<bool>>,
    /// Why the last command was refused, if it was.
    refused: Option<CommandError>,
    report: Report,
}

impl<'b> Session<'b> {
    /// A session after power-up. The commands of `replace` are replaced by requests of the status.
    pub(crate) fn new(bytes: &'b [u8], replace: Option<Vec<bool>>) -> Self {
        let mut bytes = Bytes(bytes);
        let flags = bytes.byte();
        let settings = orders::settings(flags);
        let checked = settings.check().expect("the benchtop arm's are valid");
        let identity = Identity::new(Kind::Desktop, Reset::Power);
        let mut session = Self {
            plant: plant(flags),
            is_sound: true,
            board: Box::new(Desk {
                log: Log::new(),
                sample: ToldSample::default(),
            }),
            flags,
            controller: Controller::new(&checked),
            planner: Planner::new(&checked),
            session: session::Session::new(identity, &checked, flags & 2 == 0),
            decoder: Decoder::new(),
            rules: Rules::default(),
            limits: None,
            next: Sequence(u16::from(bytes.byte()) << 8),
            last_frame: Vec::new(),
            corrupt: None,
            hostile: None,
            planner_every: 1,
            kinds: Vec::new(),
            timed_end: None,
            planned_for: 0,
            outputs: Vec::new(),
            refusals: Vec::new(),
            replace,
            refused: None,
            report: Report::default(),
            bytes,
        };
        session.renew(&checked);
        session
    }

    /// All events until the bytes end.
    pub(crate) fn run(&mut self, longest: u32) -> Result<(), Violation> {
        self.command(HostCommand::Hello {
            version: VERSION,
            session: 1,
        })?;
        self.tick()?;
        let start = self.bytes.byte();
        if start & 1 == 1 {
            // Refused where no arm has such angles: the joints stay unknown.
            let angles = self.bytes.pair(-4.0, 4.0);
            self.command(HostCommand::Request(Request::SetAngles(angles)))?;
        }
        if start < 220 {
            self.declare_angles()?;
            self.command(HostCommand::Request(Request::Arm))?;
        }
        while !self.bytes.is_empty() && self.report.ticks < longest {
            let tool = self.tool();
            let settings = self.controller.settings();
            let event = orders::next(&mut self.bytes, tool, self.flags, settings);
            self.event(event)?;
        }
        // What was accepted is carried out.
        self.wait((longest / 10) as u16, true)?;
        self.report.faults = u32::from(self.controller.fault().is_some());
        if self.replace.is_none() {
            self.find_way_out()?;
        }
        Ok(())
    }

    pub(crate) fn finish(self) -> (Report, Vec<Output>, Vec<bool>) {
        (self.report, self.outputs, self.refusals)
    }

    /// Where the reference of the tool is now [m].
    fn tool(&self) -> Tool {
        let status = self.controller.status();
        status.reference.or(status.tool).unwrap_or([0.04, 0.2])
    }

    /// Sends a command with the next number.
    fn command(&mut self, command: HostCommand) -> Result<(), Violation> {
        let number = self.refusals.len();
        let replace = self.replace.as_ref();
        let command = match replace.and_then(|replace| replace.get(number)) {
            // A host's tick is no sign of life, so a status cannot stand for it.
            Some(true) if !matches!(command, HostCommand::Tick(_)) => HostCommand::Status,
            _ => command,
        };
        self.refusals.push(false);
        let sequence = self.next;
        let message = HostMessage { sequence, command };
        let mut frame = encode(&message).expect("every command fits a frame");
        self.last_frame = frame.to_vec();
        if let Some(place) = self.corrupt.take() {
            let place = usize::from(place) % frame.len();
            frame[place] ^= 0x55;
        }
        self.receive(&frame)
    }

    /// Sends a point of a stream; in the second run a status takes its place, because that is a sign of life, too.
    fn point(&mut self, n: u16, point: &StreamPoint) -> Result<(), Violation> {
        let (sequence, command) = (Sequence(n), HostCommand::Point(*point));
        self.report.kinds[kind_of(&command)] += 1;
        let message: HostMessage = HostMessage { sequence, command };
        let frame = encode(&message).expect("every command fits a frame");
        self.receive(&frame)
    }

    /// Bytes arrive at the controller.
    fn receive(&mut self, bytes: &[u8]) -> Result<(), Violation> {
        for &byte in bytes {
            if let Some(Ok(message)) = self.decoder.feed(byte) {
                self.answer(&message)?;
            }
        }
        Ok(())
    }

    fn answer(&mut self, message: &HostMessage) -> Result<(), Violation> {
        let before = self.trace();
        self.rules.silence = 0;
        let answer = self.session.answer(
            message,
            &mut self.controller,
            &mut self.planner,
            &mut *self.board,
        );
        let stop = message.command == HostCommand::Request(Request::EmergencyStop);
        if stop {
            // Executed whatever its number.
            self.rules.permitted = false;
        }
        let reply = answer.as_ref().and_then(|frame| {
            let mut decoder = Decoder::new();
            frame.iter().find_map(|&byte| decoder.feed(byte))
        });
        let Some(Ok(ControllerMessage::Reply { sequence, reply })) = reply else {
            return Ok(());
        };
        // A frame that was sent again gets the stored reply and is not executed again.
        let is_new = sequence == self.next;
        if let Reply::Refused(error) = reply {
            let after = self.trace();
            if before != after && !stop {
                let found = format_args!("{error:?} to {message:?}: {before} became {after}");
                let rule = "a refused order changes nothing";
                return Err(Violation::new(self.report.ticks, rule, found));
            }
        }
        if is_new {
            self.next = self.next.next();
            self.count(&message.command, &reply, stop);
        }
        Ok(())
    }

    /// Notes what an executed or refused command means for the rules.
    fn count(&mut self, command: &HostCommand, reply: &Reply, stop: bool) {
        self.refused = match reply {
            Reply::Refused(error) => Some(*error),
            _ => None,
        };
        let refused = self.refused.is_some();
        if refused
            && !stop
            && let Some(last) = self.refusals.last_mut()
        {
            *last = true;
        }
        let column = usize::from(refused);
        self.report.commands[column] += 1;
        self.report.kinds[kind_of(command)] += 1;
        match command {
            HostCommand::Move(next) => {
                self.report.moves[column] += 1;
                if let MoveKind::Timed(_) = next.kind {
                    self.report.timed[column] += 1;
                }
            }
            HostCommand::ApplySettings => self.report.settings[column] += 1,
            _ => {}
        }
        if refused {
            return;
        }
        match command {
            HostCommand::Request(Request::Arm | Request::Home | Request::Excite(_)) => {
                self.rules.permitted = true;
            }
            HostCommand::Request(Request::EmergencyStop) => self.rules.permitted = false,
            HostCommand::Request(Request::ClearFault) => self.rules.cleared = true,
            HostCommand::ApplySettings => {
                let settings = self.controller.settings().check();
                self.renew(&settings.expect("settings in use are valid"));
            }
            _ => {}
        }
    }

    /// A new controller is in use.
    fn renew(&mut self, settings: &CheckedSettings) {
        self.limits = Limits::new(settings);
        let protection = &settings.protection;
        self.rules.permitted = false;
        self.rules.renewed = true;
        self.rules.tool_off = settings.tool_output.off();
        self.rules.timeout = (protection.command_timeout * settings.control.tick_rate) as u32;
    }

    /// All that an order could change, as text: `Debug` writes every bit of a number.
    fn trace(&self) -> String {
        let snapshot = self.controller.planning_snapshot();
        let is_current =
            self.planner_is_current() && matches!(snapshot.state, State::Armed | State::Running);
        let queue = is_current.then(|| (self.planner.free_slots(), self.planner.is_empty()));
        let log = self.board.log.recorder().page(0);
        format!(
            "{:?} {snapshot:?} {queue:?} {:?} {}",
            self.controller.status(),
            log.state,
            log.words
        )
    }

    /// Whether the planner knows of the path that the controller follows: of a dropped one it learns
    /// when it runs or gets a move.
    fn planner_is_current(&self) -> bool {
        self.controller.planning_snapshot().path_generation == self.planned_for
    }

    fn tick(&mut self) -> Result<(), Violation> {
        let tick = self.report.ticks;
        if tick.is_multiple_of(self.planner_every) {
            self.planner.run(&mut self.controller);
            self.planned_for = self.controller.planning_snapshot().path_generation;
        }
        let mut sample = self.plant.sense();
        if let Some((hostile, n, end)) = &mut self.hostile {
            sample = hostile.apply(sample, *n);
            *n += 1;
            if n == end {
                self.hostile = None;
            }
        }
        self.board.sample = sample.with_drives(sample.drives.into());
        let command = self.controller.tick(&sample);
        self.board.log.recorder().record(
            self.controller.drives(),
            &sample,
            &command,
            self.controller.ticks(),
        );
        let status = self.controller.status();
        self.rules.check(tick, &sample, &command, &status)?;
        let followed = match self.planner.stream() {
            Some(stream) if stream.phase != StreamPhase::Ended => {
                self.report.streamed += u32::from(status.state == State::Running);
                Some(Followed::Timed)
            }
            _ => status
                .tag
                .and_then(|tag| self.kinds.get(tag as usize))
                .copied(),
        };
        let planning = self.controller.planning_snapshot();
        if let Some(limits) = &mut self.limits {
            let reached = limits
                .check(
                    &status,
                    followed,
                    planning.path_generation,
                    planning.assembly,
                )
                .map_err(|found| {
                    let found = format_args!(
                        "{found}; move {:?}, {:?}",
                        status.tag, status.joint_reference
                    );
                    Violation::new(tick, "an accepted path keeps its limits", found)
                })?;
            self.report.reached = self.report.reached.max(reached);
        }
        let rate = f64::from(self.controller.settings().control.tick_rate);
        self.plant.step(&command, 1.0 / rate);
        let _ = self.session.telemetry(&mut self.controller, &self.planner);
        self.report.ticks += 1;
        self.report.powered += u32::from(command.enable[0]);
        self.outputs.push((
            command.drives.duty.map(f32::to_bits),
            command.enable[0],
            status.state,
        ));
        Ok(())
    }
}
