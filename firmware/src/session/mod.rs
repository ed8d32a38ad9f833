//! The session with a host: commands in, replies and telemetry out.
//!
//! It runs below the tick and is the same on every board. The work for one command is bounded,
//! and the controller is locked only for single accesses, so the tick waits a few microseconds at
//! most.

mod board;
mod sampler;
mod start;
mod stream;

use crate::controller::{self, ArmController};
use crate::drives::{BrushedCommand, Drives};
use crate::planner::Planner;
use crate::planner::StreamReason;
use crate::protocol::{
    BoardTest, CommandError, ControllerMessage, Frame, HostCommand, HostMessage, Identity, Reply,
    Sequence, SequenceCheck, StepResult, Telemetry, VERSION, encode,
};
use crate::safety::{Fault, Response, State};
use crate::settings::CheckedSettings;
use crate::{Request, Settings};
pub use board::{Board, SharedController};
use core::mem::MaybeUninit;
use rtic_core::Mutex;
use sampler::Sampler;
use serde::Serialize;
use serde::de::DeserializeOwned;
pub use start::fault_at_start;
use stream::set_fixture;

/// Room for messages that wait for the session, and one: the points of the longest delay may come at once, as from an adapter
/// that collects what a computer sends.
pub const WAITING: usize = 32;

/// Makes a session in its place, where it lasts as long as the program. A call of its own: so the caller's
/// stack holds no copy.
#[inline(never)]
pub fn place(
    place: &'static mut MaybeUninit<Session>,
    identity: Identity,
    settings: &CheckedSettings,
    are_stored: bool,
) -> &'static mut Session {
    place.write(Session::new(identity, settings, are_stored))
}

/// The state of the session with one host.
#[derive(Clone)]
struct Host {
    session: u32,
    /// The number of the command executed or refused last, and the reply to it.
    last: Sequence,
    reply: Frame,
}

/// The controller's side of the sessions with its hosts.
#[derive(Clone)]
pub struct Session {
    identity: Identity,
    host: Option<Host>,
    /// The settings in use were stored or applied: they are not the default settings.
    has_settings: bool,
    /// The settings in use: a copy, so that nobody locks the controller to read them.
    in_use: CheckedSettings,
    draft: Settings,
    sampler: Sampler,
    /// When the state of a stream is due.
    stream_sampler: Sampler,
}

impl Session {
    /// A session without a host. `settings` are those in use; `are_stored` is true if they were
    /// loaded from the board's storage. On default settings the arm does not move until a host
    /// applies its own.
    pub fn new(identity: Identity, settings: &CheckedSettings, are_stored: bool) -> Self {
        Self {
            identity,
            host: None,
            has_settings: are_stored,
            in_use: *settings,
            draft: **settings,
            sampler: Sampler::off(),
            stream_sampler: Sampler::off(),
        }
    }

    /// Executes or refuses a command. Returns the frame of the reply, if the command gets one.
    pub fn answer<D: Drives, S: Copy, C: Serialize + DeserializeOwned>(
        &mut self,
        message: &HostMessage<S>,
        controller: &mut impl SharedController<D>,
        planner: &mut Planner,
        board: &mut impl Board<D, S, C>,
    ) -> Option<Frame> {
        let HostMessage { sequence, command } = *message;
        if !matches!(command, HostCommand::Tick(_)) {
            // Every command except `Tick`, which comes from the plant, is a sign of life of the host.
            controller.lock(ArmController::feed_host_timeout);
        }
        if let HostCommand::Point(point) = &command {
            // It is neither numbered with the commands nor answered.
            if self.host.is_some() {
                planner.take_point(controller, sequence.0, point);
            }
            return None;
        }
        if let HostCommand::Request(Request::EmergencyStop) = command {
            // Executed whatever its sequence number.
            controller.lock(|controller| controller.latch_fault(Fault::EmergencyStop));
        }
        if let HostCommand::Hello { version, session } = command {
            if version != VERSION {
                return reply::<C>(sequence, Reply::Refused(CommandError::Version(VERSION)));
            }
            if self
                .host
                .as_ref()
                .is_none_or(|host| host.session != session)
            {
                self.begin_session(planner);
                return self.store_reply::<C>(session, sequence, Reply::Hello(self.identity));
            }
        }
        let Some(host) = &self.host else {
            return reply::<C>(sequence, Reply::Refused(CommandError::NoSession));
        };
        let session = host.session;
        match sequence.check_after(host.last) {
            SequenceCheck::Next => {
                let answer = self.execute(command, controller, planner, board);
                self.store_reply(session, sequence, answer)
            }
            SequenceCheck::Repeat => Some(host.reply.clone()),
            SequenceCheck::Old => None,
            SequenceCheck::Gap => {
                let next = CommandError::OutOfSequence(host.last.next());
                reply::<C>(sequence, Reply::Refused(next))
            }
        }
    }

    /// The state of a stream or the sample of telemetry that is due, if one is. To be called when it can be sent.
    pub fn telemetry(
        &mut self,
        controller: &mut impl Mutex<T = ArmController<impl Drives>>,
        planner: &Planner,
    ) -> Option<Frame> {
        let state = self.stream_state(controller, planner);
        if state.is_some() {
            return state;
        }
        let tick = controller.lock(|controller| controller.ticks());
        let number = self.sampler.due(tick)?;
        let sample = controller.lock(|controller| controller.status_sample());
        let status = sample.solve(&self.in_use, self.in_use.tool());
        let telemetry = Telemetry { number, status };
        encode(&ControllerMessage::<BrushedCommand>::Telemetry(telemetry))
    }

    /// Clears the draft and the telemetry of the session before, and ends its stream.
    fn begin_session(&mut self, planner: &mut Planner) {
        planner.end_stream(StreamReason::Stopped);
        planner.clear_fixtures();
        self.stream_sampler = Sampler::off();
        self.draft = *self.in_use;
        self.sampler = Sampler::off();
    }

    fn store_reply<C: Serialize + DeserializeOwned>(
        &mut self,
        session: u32,
        last: Sequence,
        answer: Reply<C>,
    ) -> Option<Frame> {
        let frame = reply(last, answer)?;
        self.host = Some(Host {
            session,
            last,
            reply: frame.clone(),
        });
        Some(frame)
    }

    fn execute<D: Drives, S, C>(
        &mut self,
        command: HostCommand<S>,
        controller: &mut impl SharedController<D>,
        planner: &mut Planner,
        board: &mut impl Board<D, S, C>,
    ) -> Reply<C> {
        let outcome = match command {
            HostCommand::Hello { .. } => {
                self.begin_session(planner);
                Ok(Reply::Hello(self.identity))
            }
            HostCommand::Status => Ok(Reply::Status {
                status: controller
                    .lock(|controller| controller.status_sample())
                    .solve(&self.in_use, self.in_use.tool()),
                free: free_slots(planner),
            }),
            HostCommand::Snapshot => Ok(Reply::Snapshot(
                controller.lock(|controller| controller.fault()),
            )),
            HostCommand::Request(request) => self.request(request, controller),
            HostCommand::Move(a_move) => planner
                .push(controller, &a_move)
                .map(|()| Reply::Taken {
                    free: free_slots(planner),
                })
                .map_err(CommandError::Move),
            HostCommand::GetSection(key) => key
                .of(&self.in_use)
                .map(Reply::Section)
                .ok_or(CommandError::NoSection),
            HostCommand::SetSection(section) => section
                .put(&mut self.draft)
                .map(|()| Reply::Done)
                .ok_or(CommandError::NoSection),
            HostCommand::ApplySettings => self.apply_settings(controller, planner, board),
            HostCommand::SaveSettings => self.save_settings(controller, board),
            HostCommand::Telemetry { every } => {
                let tick = controller.lock(|controller| controller.ticks());
                self.sampler.begin(every, tick);
                Ok(Reply::Done)
            }
            // A refused command changes nothing, so it does not let the planner run, either.
            HostCommand::Tick(_) if board.sample().is_some() => Err(CommandError::Unsupported),
            HostCommand::Tick(sample) => {
                planner.run(controller);
                controller
                    .lock(|controller| {
                        let (outputs, instructions) = board.tick(controller, &sample)?;
                        Some(StepResult::new(outputs, &controller.status(), instructions))
                    })
                    .map(Reply::StepResult)
                    .ok_or(CommandError::Unsupported)
            }
            HostCommand::Stack => board
                .stack()
                .map(Reply::Stack)
                .ok_or(CommandError::Unsupported),
            HostCommand::Sample => board
                .sample()
                .map(Reply::Sample)
                .ok_or(CommandError::Unsupported),
            HostCommand::BeginLog(config) => match board.recorder() {
                Some(log) => log
                    .begin(&config)
                    .map(|()| Reply::Done)
                    .map_err(|_| CommandError::Log),
                None => Err(CommandError::Unsupported),
            },
            HostCommand::ReadLog { from } => board
                .recorder()
                .map(|log| Reply::Log(log.page(from)))
                .ok_or(CommandError::Unsupported),
            HostCommand::ExcitationEnd => Ok(Reply::ExcitationEnd(
                controller.lock(|controller| controller.excitation_end()),
            )),
            HostCommand::BoardTest(test) => test_board(test, controller, board),
            HostCommand::BeginStream(config) => self.begin_stream(controller, planner, &config),
            // It was taken before.
            HostCommand::Point(_) => Err(CommandError::Unsupported),
            HostCommand::EndStream => {
                planner.end_stream(StreamReason::Asked);
                Ok(Reply::Done)
            }
            HostCommand::SetFixture { place, fixture } => set_fixture(planner, place, fixture),
        };
        outcome.unwrap_or_else(Reply::Refused)
    }

    fn request<D: Drives, C>(
        &mut self,
        request: Request,
        controller: &mut impl SharedController<D>,
    ) -> Result<Reply<C>, CommandError> {
        let (powers, posture) =
            controller.lock(|controller| (controller.powers(request), controller.posture(request)));
        if powers && !self.has_settings {
            return Err(CommandError::NoSettings);
        }
        let stance = posture.map(|posture| posture.stance(&self.in_use, self.in_use.tool()));
        controller
            .lock(|controller| controller.execute(request, stance))
            .map(|()| Reply::Done)
            .map_err(CommandError::Request)
    }

    /// Checks the draft and puts it to use in a new controller, which must be homed.
    // A call of its own: no other command takes its stack.
    #[inline(never)]
    fn apply_settings<D: Drives, S, C>(
        &mut self,
        controller: &mut impl SharedController<D>,
        planner: &mut Planner,
        board: &mut impl Board<D, S, C>,
    ) -> Result<Reply<C>, CommandError> {
        // By reference: copies of settings would take stack.
        let (true, Ok(settings)) = (fits(board, &self.draft), &self.draft.check()) else {
            return Err(CommandError::Settings);
        };
        controller.renew(settings).map_err(state_error)?;
        board.use_settings(settings);
        planner.reset(settings);
        self.in_use.clone_from(settings);
        self.has_settings = true;
        self.sampler.restart_ticks();
        self.stream_sampler = Sampler::off();
        Ok(Reply::Done)
    }

    /// Stores the settings in use, only with the bridges off: it may stall the core for seconds.
    fn save_settings<D: Drives, S, C>(
        &mut self,
        controller: &mut impl SharedController<D>,
        board: &mut impl Board<D, S, C>,
    ) -> Result<Reply<C>, CommandError> {
        match controller.lock(|controller| controller.state()) {
            State::Stopped => {}
            state => return Err(state_error(state)),
        }
        if !self.has_settings {
            return Err(CommandError::NoSettings);
        }
        board
            .save(&self.in_use)
            .map(|()| Reply::Done)
            .map_err(CommandError::Storage)
    }
}

/// Whether the board takes these settings.
#[inline(never)]
fn fits<D: Drives, S, C>(board: &impl Board<D, S, C>, settings: &Settings) -> bool {
    let limits = board.limits();
    limits.is_none_or(|limits| limits.check(settings).is_ok())
}

fn state_error(state: State) -> CommandError {
    CommandError::Request(controller::RequestError::State(state))
}

/// A step of the board's test. Those that stall the core or end in a reset need the bridges off; without
/// an emergency stop at its pin, a bare board has latched a fault.
fn test_board<D: Drives, S, C>(
    test: BoardTest,
    controller: &mut impl SharedController<D>,
    board: &mut impl Board<D, S, C>,
) -> Result<Reply<C>, CommandError> {
    let (tick, state, fault) = controller.lock(|controller| {
        let fault = controller.fault().map(|snapshot| snapshot.fault);
        (controller.ticks(), controller.state(), fault)
    });
    let is_off = state == State::Stopped
        || fault.is_some_and(|fault| fault.response() == Response::PowerOff);
    match test {
        BoardTest::Facts | BoardTest::BeginTiming | BoardTest::Timing(_) => {}
        BoardTest::EraseFlash | BoardTest::ProgramFlash | BoardTest::Hang if is_off => {}
        BoardTest::EraseFlash | BoardTest::ProgramFlash | BoardTest::Hang => {
            let error = controller::RequestError::State(state);
            return Err(CommandError::Request(error));
        }
    }
    let report = board.test(test, tick)?;
    Ok(report.map_or(Reply::Done, Reply::Board))
}

fn free_slots(planner: &Planner) -> u8 {
    u8::try_from(planner.free_slots()).unwrap_or(u8::MAX)
}

fn reply<C: Serialize + DeserializeOwned>(sequence: Sequence, reply: Reply<C>) -> Option<Frame> {
    encode(&ControllerMessage::Reply { sequence, reply })
}
