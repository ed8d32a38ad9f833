//! An arm on one of the images, connected: armed, moved, and what must be true when it is off.

use super::images::{Arm, Description, OfImages, Signal, Unit};
use fivebar_chip::time::{MICROSECOND, MILLISECOND, Time};
use fivebar_chip::{HostLine, Pulses};
use fivebar_firmware::protocol::{
    CommandError, HostCommand, HostMessage, Reply, Reset, Sequence, encode,
};
use fivebar_firmware::safety::{Fault, State};
use fivebar_firmware::{FULL_TOOL, Move, MoveKind, Request, Settings, Status};
use fivebar_kinematics::five_bar::Joint;
use fivebar_sim::link::Client;
use std::sync::{Mutex, OnceLock};

/// How far each joint moves [rad].
pub(crate) const BY: [f32; 2] = [-0.2, 0.2];
/// A brake that the program engages, or the reset behind it.
const BRAKE_WITHIN: Time = 4 * MILLISECOND;

/// Connected, with its settings stored and in use.
pub(crate) struct Connected {
    pub(crate) unit: Unit,
    pub(crate) client: Client<HostLine>,
    pub(crate) settings: Settings,
}

/// The contents of flash with an image's settings, stored by the image itself once.
pub(crate) fn stored(image: &'static Description) -> Vec<u8> {
    static STORED: OfImages<Vec<u8>> = OnceLock::new();
    let mut all = STORED
        .get_or_init(Mutex::default)
        .lock()
        .unwrap_or_else(|it| it.into_inner());
    if let Some((_, bytes)) = all.iter().find(|it| it.0 == image.file) {
        return bytes.clone();
    }
    let unit = image.unit(Vec::new());
    let (mut client, _) = unit.open();
    let applied = client.write_settings(&image.settings()).expect("a line");
    applied.expect("the settings are applied");
    let reply = client.call(HostCommand::SaveSettings).expect("a line");
    assert_eq!(reply, Reply::Done);
    let bytes = unit.chip().settings().to_vec();
    all.push((image.file, bytes.clone()));
    bytes
}

impl Connected {
    pub(crate) fn new(image: &'static Description) -> Self {
        let mut connected = Self::to(image.unit(stored(image)));
        // Both drives on a bus have sent a heartbeat by then.
        connected.run(20 * MILLISECOND);
        assert_eq!(connected.status().fault, None);
        connected
    }

    /// The same of a unit that has power, in whatever state it is.
    pub(crate) fn to(unit: Unit) -> Self {
        let (client, identity) = unit.open();
        assert_eq!(identity.reset, Reset::Power);
        let settings = unit.image.settings();
        Self {
            unit,
            client,
            settings,
        }
    }

    /// Armed, with its brake released.
    pub(crate) fn armed(image: &'static Description) -> Self {
        let mut connected = Self::new(image);
        connected.arm();
        connected
    }

    /// On its way, with its tool on.
    pub(crate) fn moving(image: &'static Description) -> Self {
        let mut connected = Self::armed(image);
        connected.go(BY, image.speed);
        connected.run(60 * MILLISECOND);
        assert_eq!(connected.status().state, State::Running);
        assert_eq!(connected.unit.is_powered(), [true; 2]);
        assert_eq!(connected.unit.outputs().brake, Some(true));
        assert_eq!(connected.unit.outputs().tool, Pulses::Level(true));
        connected
    }

    pub(crate) fn run(&self, time: Time) {
        self.unit.run(time);
    }

    pub(crate) fn status(&mut self) -> Status {
        self.client.status().expect("the controller answers").0
    }

    pub(crate) fn ask(&mut self, request: Request) -> Result<(), CommandError> {
        let command = HostCommand::Request(request);
        self.client.command(command).expect("an answer")
    }

    pub(crate) fn request(&mut self, request: Request) {
        let answer = self.ask(request);
        answer.unwrap_or_else(|error| panic!("{request:?}: {error:?}"));
    }

    /// Where the joints are [rad]; those of steppers, from where they were told to be at the start.
    pub(crate) fn angles(&self) -> [f32; 2] {
        match &self.unit.arm {
            Arm::Brushed(arm) => Joint::ALL.map(|joint| arm.get().plant().angle(joint) as f32),
            Arm::Bus(arm) => Joint::ALL.map(|joint| arm.get().plant().angle(joint) as f32),
            Arm::Steppers => self.settings.axes.each_ref().map(|axis| axis.home_angle),
        }
    }

    /// Tells where the arm is, and arms it.
    pub(crate) fn arm(&mut self) {
        let angles = self.angles();
        self.request(Request::SetAngles(angles));
        self.request(Request::Arm);
        self.run(self.unit.image.wake + 60 * MILLISECOND);
        let status = self.status();
        assert_eq!((status.state, status.fault), (State::Armed, None));
    }

    /// Asks for a move by these angles, with the tool on.
    pub(crate) fn go(&mut self, [by1, by4]: [f32; 2], speed: f32) {
        let [one, four] = self.status().angle;
        let kind = MoveKind::Joint {
            to: [one + by1, four + by4],
            speed,
        };
        let next = Move {
            tag: 1,
            tool: FULL_TOOL,
            kind,
        };
        let reply = self.client.call(HostCommand::Move(next));
        assert!(matches!(reply, Ok(Reply::Taken { .. })), "{reply:?}");
    }

    /// Lets the arm come to rest.
    pub(crate) fn finish(&mut self) {
        for _ in 0..200 {
            self.run(20 * MILLISECOND);
            let status = self.status();
            assert_eq!(status.fault, None);
            if status.state == State::Armed && status.tag.is_none() {
                return;
            }
        }
        panic!("the arm does not come to rest");
    }

    /// The host sends a request without waiting for an answer: when its last byte has arrived.
    pub(crate) fn send(&self, request: Request) -> Time {
        let message: HostMessage = HostMessage {
            sequence: Sequence(900),
            command: HostCommand::Request(request),
        };
        let frame = encode(&message).expect("a frame");
        self.unit.chip().send(&frame);
        // A byte takes 10 bits of 1 µs, and the line is idle for one more before the program looks.
        self.unit.now() + (frame.len() as Time + 2) * 10 * MICROSECOND
    }

    /// Until `within` from now no joint has power any more; then, for 20 ms, nothing reaches a joint, and from some
    /// milliseconds on the brake is engaged and the tool off.
    #[track_caller]
    pub(crate) fn is_off_after(&self, within: Time) {
        let unit = &self.unit;
        self.run(within);
        assert_eq!(unit.is_powered(), [false; 2], "power after {within} fs");
        let from = unit.now();
        for part in 0..200 {
            self.run(100 * MICROSECOND);
            assert_eq!(unit.is_powered(), [false; 2], "power again");
            if unit.now() < from + BRAKE_WITHIN {
                continue;
            }
            let outputs = unit.outputs();
            assert_ne!(outputs.brake, Some(true), "the brake is released, {part}");
            let tool = outputs.tool;
            let is_off = matches!(tool, Pulses::Released | Pulses::Level(false));
            assert!(is_off, "the tool is on, {part}: {tool:?}");
        }
        self.nothing_reaches_a_joint_from(from);
        assert_eq!(unit.brake(from + BRAKE_WITHIN), [], "the brake changes");
    }

    #[track_caller]
    pub(crate) fn nothing_reaches_a_joint_from(&self, from: Time) {
        let mut events = self.unit.events(from);
        events.retain(|(_, _, signal)| {
            !matches!(signal, Signal::Power(false)) && *signal != Signal::Push(0.0)
        });
        assert_eq!(events, [], "from {from} fs on");
    }

    /// The program has restarted for this reason, and latched this fault; nothing moves until it is cleared, and then the
    /// arm must be homed again before it is armed.
    #[track_caller]
    pub(crate) fn has_restarted(&mut self, reason: Reset, fault: Fault) {
        let from = self.unit.now();
        let (client, identity) = self.unit.open();
        self.client = client;
        assert_eq!(identity.reset, reason);
        assert_eq!(self.status().fault, Some(fault));
        assert!(self.ask(Request::Arm).is_err(), "armed with a fault");
        self.request(Request::ClearFault);
        assert!(self.ask(Request::Arm).is_err(), "armed without angles");
        self.run(5 * MILLISECOND);
        self.nothing_reaches_a_joint_from(from);
        assert_eq!(self.unit.brake(from), []);
    }

    /// This fault is latched and ends nothing else: cleared, the arm is armed and moves again.
    #[track_caller]
    pub(crate) fn works_again_after(&mut self, fault: Fault) {
        let from = self.unit.now();
        assert_eq!(self.status().fault, Some(fault));
        assert!(self.ask(Request::Arm).is_err(), "armed with a fault");
        self.request(Request::ClearFault);
        self.run(5 * MILLISECOND);
        self.nothing_reaches_a_joint_from(from);
        self.arm();
        let from = self.unit.now();
        self.go(BY.map(|by| -0.1 * by), self.unit.image.speed);
        self.run(100 * MILLISECOND);
        assert_eq!(self.status().fault, None);
        self.is_pushed_from(from);
    }

    /// Both joints are pushed after this time.
    #[track_caller]
    pub(crate) fn is_pushed_from(&self, from: Time) {
        let events = self.unit.events(from);
        for joint in 0..2 {
            let pushes = events.iter().filter(|event| {
                event.1 == joint && matches!(event.2, Signal::Push(push) if push != 0.0)
            });
            assert!(pushes.count() > 3, "joint {joint} is pushed");
        }
    }
}
