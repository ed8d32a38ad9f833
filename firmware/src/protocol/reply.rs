//! What the controller says.

use super::VERSION;
use super::frame::{Message, Sender};
use super::section::Section;
use super::sequence::Sequence;
use crate::Command;
use serde::{Deserialize, Serialize};

/// An answer, or a sample nobody asked for.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum ControllerMessage {
    /// The answer to an order.
    Reply {
        /// The order's number.
        sequence: Sequence,
        /// The answer.
        reply: Reply,
    },
    /// A sample.
    Telemetry(Telemetry),
}

impl Message for ControllerMessage {
    const SENDER: Sender = Sender::Controller;
}

/// The answer to an order.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Reply {
    /// The order was not obeyed, and nothing changed.
    Refused(Refusal),
    /// Done, or begun where it takes time: the state shows when it ends.
    Done,
    /// To a hello.
    Hello(Identity),
    /// To [`Order::State`](super::Order::State).
    State(State),
    /// To a move: it was checked along its whole way and taken.
    Taken {
        /// How many more the queue holds now.
        room: u8,
    },
    /// To [`Order::GetSection`](super::Order::GetSection).
    Section(Section),
    /// To [`Order::Tick`](super::Order::Tick).
    Ticked(Ticked),
}

/// Why an order was not obeyed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Refusal {
    /// The host speaks another version than this.
    Version(u16),
    /// There was no hello since the reset.
    NoSession,
    /// The order is not the next one; this number is.
    OutOfSequence(Sequence),
    /// This board cannot do that.
    Unsupported,
    /// The mode forbids it.
    Mode(Mode),
    /// Where the arm is has not been established by homing.
    NotHomed,
    /// The move queue is full: ask again when the state shows room.
    QueueFull,
    /// No such section of the settings.
    NoSection,
    /// The settings make no sense as a whole.
    Settings,
    /// The settings could not be stored.
    Storage,
}

/// Who answers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Identity {
    /// The controller's [`VERSION`].
    pub version: u16,
    /// What it runs on.
    pub board: Board,
    /// The firmware's version: major, minor, patch.
    pub firmware: [u8; 3],
    /// Why it started last.
    pub reset: Reset,
}

/// What a controller runs on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Board {
    /// In the host's own process.
    Desktop,
    /// An emulated Cortex-M4F whose sensors and bridges are frames.
    Emulated,
    /// An STM32F405 that drives motors.
    Stm32f405,
}

/// Why a controller started.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Reset {
    /// Power came on, or the reset pin was pulled.
    Power,
    /// A debugger or the program itself asked for it.
    Software,
    /// The watchdog was not fed in time.
    Watchdog,
    /// The program panicked.
    Panic,
    /// The processor met an instruction or address it could not bear.
    HardFault,
    /// The supply sagged.
    BrownOut,
}

/// The states of the controller.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Mode {
    /// Bridges unpowered.
    Stopped,
    /// Looking for the home switches.
    Homing,
    /// Holding still.
    Armed,
    /// Moving along the queue.
    Running,
    /// Coming to rest.
    Stopping,
    /// A fault is latched; bridges unpowered.
    Fault,
}

/// Everything about the controller at one tick.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct State {
    /// Ticks since the reset.
    pub tick: u32,
    /// What it is doing.
    pub mode: Mode,
    /// The latched fault's number, 0 for none.
    pub fault: u8,
    /// The limits clipping now, one bit each.
    pub limits: u16,
    /// Whether the joint angles are known.
    pub homed: bool,
    /// θ1, θ4 [rad].
    pub angle: [f32; 2],
    /// ω1, ω4 [rad/s].
    pub velocity: [f32; 2],
    /// The tool [m].
    pub tool: [f32; 2],
    /// Where the tool should be [m].
    pub reference: [f32; 2],
    /// τ1, τ4 [N·m].
    pub torque: [f32; 2],
    /// Current set-points [A].
    pub current: [f32; 2],
    /// Bus voltage [V].
    pub bus_voltage: f32,
    /// Tag of the move in progress.
    pub tag: Option<u32>,
    /// How many more moves the queue holds.
    pub room: u8,
}

/// A tick of the emulated board: what the bridges are told, and the bits behind it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Ticked {
    /// What the bridges are told.
    pub command: Command,
    /// Ticks since the reset.
    pub tick: u32,
    /// The mode after the tick.
    pub mode: Mode,
    /// The latched fault's number, 0 for none.
    pub fault: u8,
    /// θ1, θ4 [rad].
    pub angle: [f32; 2],
    /// ω1, ω4 [rad/s].
    pub velocity: [f32; 2],
    /// The tool [m].
    pub tool: [f32; 2],
    /// Current set-points [A].
    pub current: [f32; 2],
    /// Instructions the tick took, 0 where they cannot be counted.
    pub instructions: u32,
}

/// A sample of the state.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Telemetry {
    /// Counts the samples due since telemetry began, sent or not: a gap is a loss.
    pub number: u32,
    /// The sample.
    pub state: State,
}

impl Identity {
    /// A controller of this library's version.
    pub const fn new(board: Board, reset: Reset) -> Self {
        Self {
            version: VERSION,
            board,
            firmware: FIRMWARE,
            reset,
        }
    }
}

/// This library's version: major, minor, patch.
const FIRMWARE: [u8; 3] = [
    number(env!("CARGO_PKG_VERSION_MAJOR")),
    number(env!("CARGO_PKG_VERSION_MINOR")),
    number(env!("CARGO_PKG_VERSION_PATCH")),
];

/// The number these digits write.
const fn number(digits: &str) -> u8 {
    match u8::from_str_radix(digits, 10) {
        Ok(number) => number,
        Err(_) => panic!("a part of the version is not below 256"),
    }
}
