//! CANSimple, the protocol of ODrive (firmware 0.6).
//!
//! An identifier is 32 times the node, and the number of the message. Numbers are little-endian; positions and torques
//! are of the motor's shaft.

use super::{Frame, Payload};
use crate::settings::BusKind;

/// The greatest node.
pub const MOST_NODE: u8 = BusKind::Odrive.most_node();
/// Time between two heartbeats of a drive [s]: its user sets `heartbeat_msg_rate_ms` to 10, and the rates of all other
/// messages to 0.
pub const PERIOD: f32 = 0.01;
/// The state of an axis that gives no torque.
pub const IDLE: u8 = 1;
/// The state of an axis that makes its torque.
pub const CLOSED_LOOP: u8 = 8;

const HEARTBEAT: u16 = 0x01;
const SET_AXIS_STATE: u16 = 0x07;
const GET_ENCODER_ESTIMATES: u16 = 0x09;
const SET_CONTROLLER_MODE: u16 = 0x0B;
const SET_INPUT_POS: u16 = 0x0C;
const SET_POS_GAIN: u16 = 0x1A;
const CLEAR_ERRORS: u16 = 0x18;
const SET_VEL_GAINS: u16 = 0x1B;

/// Control mode and input mode: position, velocity and torque are what the last message asks for.
const POSITION_CONTROL: u32 = 3;
const PASS_THROUGH: u32 = 1;

/// Velocities [turns/s] and torques [N·m] of [`set_input`] are this many times a whole number, as delivered.
const SCALE: f32 = 0.001;
/// The greatest velocity [turns/s] and torque [N·m] of [`set_input`].
pub const MOST_INPUT: f32 = SCALE * i16::MAX as f32;

const fn id(node: u8, message: u16) -> u16 {
    (node as u16) << 5 | message
}

/// The identifiers of the frames that [`Message`] knows, of this drive.
pub const fn answers(node: u8) -> [u16; 2] {
    [id(node, HEARTBEAT), id(node, GET_ENCODER_ESTIMATES)]
}

/// Two numbers of 32 bits.
const fn pair(first: [u8; 4], second: [u8; 4]) -> Payload {
    let ([a, b, c, d], [e, f, g, h]) = (first, second);
    [a, b, c, d, e, f, g, h]
}

const fn halves(data: Payload) -> ([u8; 4], [u8; 4]) {
    let [a, b, c, d, e, f, g, h] = data;
    ([a, b, c, d], [e, f, g, h])
}

/// Asks for a position [turns] and a velocity [turns/s] of the motor, and for a torque [N·m] besides that of the gains.
pub fn set_input(node: u8, position: f32, velocity: f32, torque: f32) -> Frame {
    let [[a, b], [c, d]] = [velocity, torque].map(|value| scaled(value).to_le_bytes());
    let data = pair(position.to_le_bytes(), [a, b, c, d]);
    Frame::new(id(node, SET_INPUT_POS), data)
}

/// The nearest whole number of scale units, within those of 16 bits.
fn scaled(value: f32) -> i16 {
    let units = value / SCALE;
    // `as` saturates, and cuts towards 0.
    (units + if units < 0.0 { -0.5 } else { 0.5 }) as i16
}

/// The torque that a frame holds of this one [N·m].
pub fn torque_in_frame(torque: f32) -> f32 {
    f32::from(scaled(torque)) * SCALE
}

/// Sets the velocity per position error [1/s].
pub const fn set_position_gain(node: u8, gain: f32) -> Frame {
    let data = pair(gain.to_le_bytes(), [0; 4]);
    Frame::new(id(node, SET_POS_GAIN), data)
}

/// Sets the torque per velocity error [N·m·s/turn], without an integral.
pub const fn set_velocity_gain(node: u8, gain: f32) -> Frame {
    let data = pair(gain.to_le_bytes(), [0; 4]);
    Frame::new(id(node, SET_VEL_GAINS), data)
}

/// Asks for a state of the axis.
pub const fn set_axis_state(node: u8, state: u8) -> Frame {
    let data = pair([state, 0, 0, 0], [0; 4]);
    Frame::new(id(node, SET_AXIS_STATE), data)
}

/// Clears the errors of a drive, which it keeps until then. It gives no torque by that.
pub const fn clear_errors(node: u8) -> Frame {
    Frame::new(id(node, CLEAR_ERRORS), [0; 8])
}

/// Makes the drive follow [`set_input`].
pub const fn set_mode(node: u8) -> Frame {
    let data = pair(POSITION_CONTROL.to_le_bytes(), PASS_THROUGH.to_le_bytes());
    Frame::new(id(node, SET_CONTROLLER_MODE), data)
}

/// Asks where the motor is.
pub const fn ask_for_estimates(node: u8) -> Frame {
    Frame {
        id: id(node, GET_ENCODER_ESTIMATES),
        data: None,
    }
}

/// What a drive tells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Message {
    /// Sent by itself, see [`PERIOD`].
    Heartbeat {
        /// Error flags of the axis, those that are active and the reason of its last end: 0 is none. They stay until
        /// [`clear_errors`].
        error: u32,
        /// Its state.
        state: u8,
    },
    /// Where the motor is.
    Estimates {
        /// [turns].
        position: f32,
        /// [turns/s].
        velocity: f32,
    },
}

impl Message {
    /// What the frame of a drive tells, and the drive's node; none of frames that are not used here.
    pub const fn decode(frame: &Frame) -> Option<(u8, Self)> {
        let Some(data) = frame.data else {
            return None;
        };
        let (first, second) = halves(data);
        let message = match frame.id & 0x1F {
            HEARTBEAT => {
                let [state, ..] = second;
                let error = u32::from_le_bytes(first);
                Self::Heartbeat { error, state }
            }
            GET_ENCODER_ESTIMATES => Self::Estimates {
                position: f32::from_le_bytes(first),
                velocity: f32::from_le_bytes(second),
            },
            _ => return None,
        };
        Some(((frame.id >> 5) as u8, message))
    }
}
