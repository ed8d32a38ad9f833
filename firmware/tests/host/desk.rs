//! A session and its controller; frames go in and out.

use crate::rig;
use fivebar_firmware::controller::Controller;
use fivebar_firmware::protocol::{Board as Kind, Reset};
use fivebar_firmware::protocol::{
    ControllerMessage, Decoder, Frame, HostCommand, HostMessage, Identity, Reply, Sequence, VERSION,
};
use fivebar_firmware::recorder::{Log, Recorder};
use fivebar_firmware::session::Board;
use fivebar_firmware::session::Session;
use fivebar_firmware::settings::{BoardLimits, CheckedSettings};
use fivebar_firmware::storage::StorageError;
use fivebar_firmware::{ActuatorCommand, Planner, Request, SensorSample, Settings, ToldSample};

/// A board in memory, whose plant is frames.
pub(crate) struct Memory {
    pub(crate) saved: Vec<Settings>,
    pub(crate) flash: Result<(), StorageError>,
    pub(crate) limits: Option<BoardLimits>,
    pub(crate) log: Box<Log>,
    /// How often it was given settings.
    pub(crate) used: u32,
    /// What its own sensors show, if it has some.
    pub(crate) sample: Option<ToldSample>,
}

impl Board for Memory {
    fn save(&mut self, settings: &Settings) -> Result<(), StorageError> {
        self.flash?;
        self.saved.push(*settings);
        Ok(())
    }

    fn use_settings(&mut self, _: &CheckedSettings) {
        self.used += 1;
    }

    fn limits(&self) -> Option<BoardLimits> {
        self.limits
    }

    fn tick(
        &mut self,
        controller: &mut Controller,
        sample: &SensorSample,
    ) -> Option<(ActuatorCommand, u32)> {
        let command = controller.tick(sample);
        let log = self.log.recorder();
        log.record(controller.drives(), sample, &command, controller.ticks());
        Some((command, 0))
    }

    fn recorder(&self) -> Option<Recorder<'_>> {
        Some(self.log.recorder())
    }

    fn sample(&self) -> Option<ToldSample> {
        self.sample
    }
}

/// Both ends of a line without faults.
pub(crate) struct Desk {
    pub(crate) session: Session,
    pub(crate) controller: Controller,
    pub(crate) planner: Planner,
    pub(crate) board: Memory,
    pub(crate) bench: rig::Bench,
    pub(crate) last: Sequence,
    /// The tool when it was armed [m].
    pub(crate) start: [f32; 2],
}

pub(crate) const HELLO: HostCommand = HostCommand::Hello {
    version: VERSION,
    session: 1,
};

impl Desk {
    /// Before the `Hello`.
    pub(crate) fn new() -> Self {
        let settings = rig::settings().check().unwrap();
        let identity = Identity::new(Kind::Desktop, Reset::Power);
        Self {
            session: Session::new(identity, &settings, true),
            controller: Controller::new(&settings),
            planner: Planner::new(&settings),
            board: Memory {
                saved: Vec::new(),
                flash: Ok(()),
                limits: None,
                log: Box::default(),
                used: 0,
                sample: None,
            },
            bench: rig::Bench::new(&settings),
            last: Sequence(0xfffe),
            start: [0.0; 2],
        }
    }

    /// After the `Hello`.
    pub(crate) fn greeted() -> Self {
        let mut desk = Self::new();
        assert!(matches!(desk.ask(HELLO), Reply::Hello(_)));
        desk
    }

    /// After the `Hello`, without settings from a host or from flash.
    pub(crate) fn without_settings() -> Self {
        let mut desk = Self::new();
        let identity = Identity::new(Kind::Desktop, Reset::Power);
        desk.session = Session::new(identity, &rig::settings().check().unwrap(), false);
        assert!(matches!(desk.ask(HELLO), Reply::Hello(_)));
        desk
    }

    /// Homed by declaring the angles, and armed.
    pub(crate) fn armed() -> Self {
        let mut desk = Self::greeted();
        desk.tick();
        assert_eq!(
            desk.ask(HostCommand::Request(Request::SetAngles(rig::START))),
            Reply::Done
        );
        assert_eq!(desk.ask(HostCommand::Request(Request::Arm)), Reply::Done);
        let (tool, _) = desk.controller.hold_position().expect("held");
        desk.start = [tool.x, tool.y];
        desk
    }

    /// The frame that answers a command of this number.
    pub(crate) fn send(&mut self, sequence: Sequence, command: HostCommand) -> Option<Frame> {
        self.session.answer(
            &HostMessage { sequence, command },
            &mut self.controller,
            &mut self.planner,
            &mut self.board,
        )
    }

    /// The reply to a command of this number.
    pub(crate) fn reply_to(&mut self, sequence: Sequence, command: HostCommand) -> Option<Reply> {
        let frame = self.send(sequence, command)?;
        match read(&frame) {
            ControllerMessage::Reply {
                sequence: of,
                reply,
            } => {
                assert_eq!(of, sequence);
                Some(reply)
            }
            other => panic!("{other:?}"),
        }
    }

    /// The reply to the next command.
    pub(crate) fn ask(&mut self, command: HostCommand) -> Reply {
        self.last = self.last.next();
        self.reply_to(self.last, command).expect("an answer")
    }

    /// One tick in lockstep.
    pub(crate) fn tick(&mut self) {
        let sample = self.bench.sense();
        match self.ask(HostCommand::Tick(sample)) {
            Reply::StepResult(result) => self.bench.step(&result.command),
            other => panic!("{other:?}"),
        }
    }
}

/// The message in a frame.
pub(crate) fn read(frame: &Frame) -> ControllerMessage {
    let mut decoder = Decoder::new();
    let mut decoded = frame.iter().filter_map(|&byte| decoder.feed(byte));
    decoded.next().expect("a whole frame").expect("a message")
}
