//! The messages of the host.

use super::board_test::BoardTest;
use super::frame::{Message, Sender};
use super::section::{Section, SectionKey};
use super::sequence::Sequence;
use crate::drives::BrushedSample;
use crate::motion::{Fixture, StreamConfig, StreamPoint};
use crate::recorder::LogConfig;
use crate::{ArmSample, Move, Request};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

/// One host command with its number.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct HostMessage<S = BrushedSample> {
    /// One more than the last command's number, or the same if its reply did not come; that of a
    /// [`HostCommand::Point`] is one more than that of the point before.
    pub sequence: Sequence,
    /// The command.
    pub command: HostCommand<S>,
}

impl<S: Serialize + DeserializeOwned> Message for HostMessage<S> {
    const SENDER: Sender = Sender::Host;
}

/// What a host can command the controller to do.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum HostCommand<S = BrushedSample> {
    /// Begins a session: commands are counted from this one's number on. The controller forgets
    /// the session before, and telemetry stops.
    Hello {
        /// The host's [`VERSION`](super::VERSION).
        version: u16,
        /// A number that the host did not use recently. It distinguishes a repeated hello from a
        /// new one.
        session: u32,
    },
    /// Report the status.
    Status,
    /// Report the measured values of the tick that raised the latched fault.
    Snapshot,
    /// Arm, home, stop and so on. An emergency stop is executed whatever its number, also
    /// without a hello.
    Request(Request),
    /// Add a move to the queue.
    Move(Move),
    /// Report a section of the settings in use.
    GetSection(SectionKey),
    /// Change a section of the draft, which starts as a copy of the settings in use.
    SetSection(Section),
    /// Use the draft, if it is valid as a whole and the arm is stopped.
    ApplySettings,
    /// Store the settings in use, so that they survive a reset.
    SaveSettings,
    /// Send telemetry every so many ticks; 0 stops it.
    Telemetry {
        /// Ticks from one sample to the next.
        every: u16,
    },
    /// Emulated boards only: run the next tick on this sample.
    Tick(ArmSample<S>),
    /// Report how much of the stack has been used since the reset.
    Stack,
    /// Report the sensor sample of the last tick, in any state.
    Sample,
    /// Drop what the log holds and begin it anew.
    BeginLog(LogConfig),
    /// Report a page of the log.
    ReadLog {
        /// The first word of the page.
        from: u16,
    },
    /// Report what ended the last excitation.
    ExcitationEnd,
    /// A step of the test of a bare board; not on emulated boards.
    BoardTest(BoardTest),
    /// Begin a stream of set-points, where the arm is held.
    BeginStream(StreamConfig),
    /// A set-point of the stream. The message's number is that of the point: it is not compared with those of commands, and there
    /// is no reply.
    Point(StreamPoint),
    /// Take no more points, and bring the arm to rest behind the last one.
    EndStream,
    /// Change a wall or a guide of the next stream with an impedance. Those stay until a session begins.
    SetFixture {
        /// Which one, less than [`FIXTURES`](crate::motion::FIXTURES).
        place: u8,
        /// None: there is none.
        fixture: Option<Fixture>,
    },
}
