//! The protocol of the MIT Mini Cheetah's drives, which T-Motor, CubeMars and Damiao use.
//!
//! A command has eight bytes: position (16 bits), velocity, stiffness, damping and torque (12 bits each), each a share
//! of its own range. The identifier is the drive's node; the answer names the node in its first byte. Positions and
//! torques are of the drive's output, behind its gear.
//!
//! The scaling is that of two independent programs: `canmotorlib.py` of
//! github.com/dfki-ric-underactuated-lab/mini-cheetah-tmotor-python-can for T-Motor's drives, and
//! github.com/jia-xie/python-damiao-driver for Damiao's. Only Damiao's tell their state.

use super::{Frame, Payload};
use crate::settings::BusKind;

/// The greatest node.
pub const MOST_NODE: u8 = BusKind::Mit.most_node();

/// The identifier of answers: that of the controller.
pub const ANSWER: u16 = 0;

/// The greatest stiffness [N·m/rad] of a command.
pub const STIFFNESS: f32 = 500.0;
/// The greatest damping [N·m·s/rad] of a command.
pub const DAMPING: f32 = 5.0;

/// The state of a drive that makes its torque; one without this has 0.
const ENABLED: u8 = 1;
/// The first of the states that are errors: voltage, current, heat, lost messages, overload.
const FIRST_ERROR: u8 = 8;

/// What makes a drive give torque.
const ENTER: Payload = [0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFC];
/// What makes it give none.
const LEAVE: Payload = [0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFD];
/// What makes a drive that tells an error clear it. Others would take it for a command of the greatest values.
const CLEAR: Payload = [0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFB];

/// The ranges of a drive, which differ from one to another: from minus this to this.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ranges {
    /// [rad].
    pub position: f32,
    /// [rad/s].
    pub velocity: f32,
    /// [N·m].
    pub torque: f32,
}

/// A command: the drive makes τ = stiffness · Δposition + damping · Δvelocity + torque.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Command {
    /// [rad].
    pub position: f32,
    /// [rad/s].
    pub velocity: f32,
    /// [N·m/rad].
    pub stiffness: f32,
    /// [N·m·s/rad].
    pub damping: f32,
    /// [N·m].
    pub torque: f32,
}

impl Command {
    /// The command in the drive's ranges, and limited to them. Fractions are cut off, as drives' makers do.
    pub fn encode(&self, ranges: &Ranges) -> Payload {
        let position = share(self.position, -ranges.position, ranges.position, 16);
        let velocity = share(self.velocity, -ranges.velocity, ranges.velocity, 12);
        let stiffness = share(self.stiffness, 0.0, STIFFNESS, 12);
        let damping = share(self.damping, 0.0, DAMPING, 12);
        let torque = share(self.torque, -ranges.torque, ranges.torque, 12);
        let bits = position << 48 | velocity << 36 | stiffness << 24 | damping << 12 | torque;
        bits.to_be_bytes()
    }
}

/// The torque that a frame holds of this one [N·m].
pub fn torque_in_frame(torque: f32, ranges: &Ranges) -> f32 {
    value(
        share(torque, -ranges.torque, ranges.torque, 12),
        ranges.torque,
        12,
    )
}

/// A drive's answer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reply {
    /// The drive.
    pub node: u8,
    /// Its state; drives that tell none have 0.
    state: u8,
    /// [rad].
    pub position: f32,
    /// [rad/s].
    pub velocity: f32,
    /// [N·m].
    pub torque: f32,
}

impl Reply {
    /// The answer with these data.
    pub fn decode(data: &Payload, ranges: &Ranges) -> Self {
        let [first, p1, p2, v1, both, t2, _, _] = data.map(u64::from);
        let position = p1 << 8 | p2;
        let velocity = v1 << 4 | both >> 4;
        let torque = (both & 0xF) << 8 | t2;
        Self {
            node: first as u8 & 0xF,
            state: first as u8 >> 4,
            position: value(position, ranges.position, 16),
            velocity: value(velocity, ranges.velocity, 12),
            torque: value(torque, ranges.torque, 12),
        }
    }

    /// Whether the drive tells an error.
    pub fn is_error(&self) -> bool {
        self.state >= FIRST_ERROR
    }

    /// Whether the drive tells that it gives torque.
    pub fn is_enabled(&self) -> bool {
        self.state == ENABLED
    }
}

/// Makes the drive give torque, or none. It answers.
pub const fn enable(node: u8, on: bool) -> Frame {
    Frame::new(node as u16, if on { ENTER } else { LEAVE })
}

/// Clears the error of a drive, which must have told one: only those that tell their state know this frame.
pub const fn clear_error(node: u8) -> Frame {
    Frame::new(node as u16, CLEAR)
}

/// A value within a range as a share of 2ⁿ − 1. Of what is not a number, the least.
fn share(value: f32, least: f32, most: f32, bits: u32) -> u64 {
    // Comparisons, because `max` and `min` are calls on the microcontroller.
    let within = if value > least { value } else { least };
    let within = if within < most { within } else { most };
    // `as` cuts.
    ((within - least) * full(bits) / (most - least)) as u64
}

/// The value of a share of a range from −`limit` to `limit`.
fn value(share: u64, limit: f32, bits: u32) -> f32 {
    share as f32 * (2.0 * limit) / full(bits) - limit
}

fn full(bits: u32) -> f32 {
    ((1_u32 << bits) - 1) as f32
}
