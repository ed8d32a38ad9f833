//! The conversation with a host: orders in, replies and telemetry out.
//!
//! It runs below the tick, on every board the same. Its work per order is bounded by what
//! the order asks for, and it holds the controller only for single requests, so the tick
//! waits for it a few microseconds at most.

mod sampler;
mod start;

use crate::controller::{self, Controller};
use crate::planner::Planner;
use crate::protocol::{
    ControllerMessage, Frame, HostMessage, Identity, Order, Refusal, Reply, Sequence, StackUse,
    Telemetry, Ticked, Turn, VERSION, encode,
};
use crate::safety::State;
use crate::storage::StorageError;
use crate::{Command, Request, Sensed, Settings};
use rtic_core::Mutex;
use sampler::Sampler;
pub use start::fault_at_start;

/// What the session needs of the board it runs on.
pub trait Board {
    /// Stores settings for the next start.
    ///
    /// # Errors
    /// Why they are not stored.
    fn save(&mut self, settings: &Settings) -> Result<(), StorageError>;

    /// The only tick rate that the board has [Hz]; `None` where the host makes the ticks.
    fn tick_rate(&self) -> Option<f32> {
        None
    }

    /// Makes one tick with samples from the host, and counts its instructions where that
    /// is possible. `None` on a board whose sensors are its own.
    fn tick(&mut self, controller: &mut Controller, sensed: &Sensed) -> Option<(Command, u32)>;

    /// How much of the stack has been used; `None` where that is not measured.
    fn stack(&self) -> Option<StackUse> {
        None
    }
}

/// What a session knows of its host.
struct Host {
    session: u32,
    /// The order obeyed or refused last, and the reply to it.
    last: Sequence,
    reply: Frame,
}

/// One controller's side of the conversation.
pub struct Session {
    identity: Identity,
    host: Option<Host>,
    /// The settings in use were stored or applied, not made up.
    has_settings: bool,
    draft: Settings,
    sampler: Sampler,
}

impl Session {
    /// A session without a host. `settings` are those in use; `are_stored` tells that they
    /// were loaded, not made up: until some are applied, nothing moves on made-up ones.
    pub fn new(identity: Identity, settings: &Settings, are_stored: bool) -> Self {
        Self {
            identity,
            host: None,
            has_settings: are_stored,
            draft: *settings,
            sampler: Sampler::off(),
        }
    }

    /// Obeys or refuses an order; the frame that answers it, if it needs an answer.
    pub fn answer(
        &mut self,
        message: &HostMessage,
        controller: &mut impl Mutex<T = Controller>,
        planner: &mut Planner,
        board: &mut impl Board,
    ) -> Option<Frame> {
        let HostMessage { sequence, order } = *message;
        if !matches!(order, Order::Tick(_)) {
            // Samples are the plant's; all else is a sign of life of the host.
            controller.lock(Controller::feed_host_timeout);
        }
        if let Order::Request(Request::EmergencyStop) = order {
            // Obeyed before anything is asked about its number.
            let _ = controller.lock(|controller| controller.request(Request::EmergencyStop));
        }
        if let Order::Hello { version, session } = order {
            if version != VERSION {
                return reply(sequence, Reply::Refused(Refusal::Version(VERSION)));
            }
            if self
                .host
                .as_ref()
                .is_none_or(|host| host.session != session)
            {
                self.greet(controller);
                return self.keep(session, sequence, Reply::Hello(self.identity));
            }
        }
        let Some(host) = &self.host else {
            return reply(sequence, Reply::Refused(Refusal::NoSession));
        };
        let session = host.session;
        match sequence.turn_after(host.last) {
            Turn::Next => {
                let answer = self.obey(order, controller, planner, board);
                self.keep(session, sequence, answer)
            }
            Turn::Again => Some(host.reply.clone()),
            Turn::Past => None,
            Turn::Ahead => {
                let next = Refusal::OutOfSequence(host.last.next());
                reply(sequence, Reply::Refused(next))
            }
        }
    }

    /// The sample that is due, if one is; to be asked for when it can be sent.
    pub fn telemetry(&mut self, controller: &mut impl Mutex<T = Controller>) -> Option<Frame> {
        let tick = controller.lock(|controller| controller.ticks());
        let number = self.sampler.due(tick)?;
        let status = controller.lock(|controller| controller.status());
        encode(&ControllerMessage::Telemetry(Telemetry { number, status }))
    }

    /// Forgets what the host before left behind.
    fn greet(&mut self, controller: &mut impl Mutex<T = Controller>) {
        self.draft = controller.lock(|controller| *controller.settings());
        self.sampler = Sampler::off();
    }

    fn keep(&mut self, session: u32, last: Sequence, answer: Reply) -> Option<Frame> {
        let frame = reply(last, answer)?;
        self.host = Some(Host {
            session,
            last,
            reply: frame.clone(),
        });
        Some(frame)
    }

    fn obey(
        &mut self,
        order: Order,
        controller: &mut impl Mutex<T = Controller>,
        planner: &mut Planner,
        board: &mut impl Board,
    ) -> Reply {
        let outcome = match order {
            Order::Hello { .. } => {
                self.greet(controller);
                Ok(Reply::Hello(self.identity))
            }
            Order::Status => Ok(Reply::Status {
                status: controller.lock(|controller| controller.status()),
                room: free_slots(planner),
            }),
            Order::Snapshot => Ok(Reply::Snapshot(
                controller.lock(|controller| controller.fault().copied()),
            )),
            Order::Request(request) => self.request(request, controller),
            Order::Move(a_move) => planner
                .push(controller, &a_move)
                .map(|()| Reply::Taken {
                    room: free_slots(planner),
                })
                .map_err(Refusal::Move),
            Order::GetSection(key) => {
                let settings = controller.lock(|controller| *controller.settings());
                key.of(&settings)
                    .map(Reply::Section)
                    .ok_or(Refusal::NoSection)
            }
            Order::SetSection(section) => section
                .put(&mut self.draft)
                .map(|()| Reply::Done)
                .ok_or(Refusal::NoSection),
            Order::ApplySettings => self.apply(controller, planner, board),
            Order::SaveSettings => self.save(controller, board),
            Order::Telemetry { every } => {
                let tick = controller.lock(|controller| controller.ticks());
                self.sampler.begin(every, tick);
                Ok(Reply::Done)
            }
            Order::Tick(sensed) => {
                planner.run(controller);
                controller
                    .lock(|controller| {
                        let (command, instructions) = board.tick(controller, &sensed)?;
                        Some(Ticked::new(command, &controller.status(), instructions))
                    })
                    .map(Reply::Ticked)
                    .ok_or(Refusal::Unsupported)
            }
            Order::Stack => board.stack().map(Reply::Stack).ok_or(Refusal::Unsupported),
        };
        outcome.unwrap_or_else(Reply::Refused)
    }

    fn request(
        &mut self,
        request: Request,
        controller: &mut impl Mutex<T = Controller>,
    ) -> Result<Reply, Refusal> {
        let powers = matches!(request, Request::Arm | Request::Home);
        if powers && !self.has_settings {
            return Err(Refusal::NoSettings);
        }
        controller
            .lock(|controller| controller.request(request))
            .map(|()| Reply::Done)
            .map_err(Refusal::Request)
    }

    /// Puts the draft to use: a new controller, which has to be homed.
    fn apply(
        &mut self,
        controller: &mut impl Mutex<T = Controller>,
        planner: &mut Planner,
        board: &mut impl Board,
    ) -> Result<Reply, Refusal> {
        let rate = board.tick_rate();
        if rate.is_some_and(|rate| rate != self.draft.control.tick_rate) {
            return Err(Refusal::Settings);
        }
        let new_planner = Planner::new(&self.draft).map_err(|_| Refusal::Settings)?;
        let new_controller = Controller::new(&self.draft).map_err(|_| Refusal::Settings)?;
        controller.lock(|controller| {
            only_stopped(controller)?;
            *controller = new_controller;
            Ok(())
        })?;
        *planner = new_planner;
        self.has_settings = true;
        self.sampler.restart_ticks();
        Ok(Reply::Done)
    }

    /// Stores the settings in use, with the bridges off: it may stall the core for seconds.
    fn save(
        &mut self,
        controller: &mut impl Mutex<T = Controller>,
        board: &mut impl Board,
    ) -> Result<Reply, Refusal> {
        let settings = controller.lock(|controller| {
            only_stopped(controller)?;
            Ok(*controller.settings())
        })?;
        if !self.has_settings {
            return Err(Refusal::NoSettings);
        }
        board
            .save(&settings)
            .map(|()| Reply::Done)
            .map_err(Refusal::Storage)
    }
}

fn only_stopped(controller: &Controller) -> Result<(), Refusal> {
    match controller.state() {
        State::Stopped => Ok(()),
        state => Err(Refusal::Request(controller::Refusal::State(state))),
    }
}

fn free_slots(planner: &Planner) -> u8 {
    u8::try_from(planner.free_slots()).unwrap_or(u8::MAX)
}

fn reply(sequence: Sequence, reply: Reply) -> Option<Frame> {
    encode(&ControllerMessage::Reply { sequence, reply })
}
