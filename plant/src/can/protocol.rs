//! The drives' side of both protocols: what a frame of the controller asks for, and the frames that a drive sends.
//! Written from the protocols, without the controller's code.

use fivebar_firmware::drives::can::mit::Ranges;
use fivebar_firmware::drives::can::{Frame, Protocol};
use std::f64::consts::TAU;

/// What the controller asks of a drive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Order {
    /// Give torque.
    Start,
    /// Give none.
    Stop,
    /// Clear the errors.
    Clear,
    /// Follow positions, velocities and torques.
    Follow,
    /// These, at the drive's shaft.
    Input(Input),
    /// The velocity per position error [1/s], or the torque per velocity error [N·m·s/rad].
    PositionGain(f64),
    VelocityGain(f64),
    /// Tell where the motor is.
    Tell,
}

/// What a drive is to follow at its shaft.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Input {
    /// [rad].
    pub(super) position: f64,
    /// [rad/s].
    pub(super) velocity: f64,
    /// Besides that of the gains [N·m].
    pub(super) torque: f64,
    /// [N·m/rad] and [N·m·s/rad]; none: those of the gains.
    pub(super) stiffness: Option<[f64; 2]>,
}

/// What a drive tells.
#[derive(Clone, Copy, Debug)]
pub(super) struct Answer {
    pub(super) node: u8,
    /// Turns of its shaft.
    pub(super) turns: f64,
    /// [turns/s].
    pub(super) speed: f64,
    /// [N·m].
    pub(super) torque: f64,
    pub(super) drives: bool,
    pub(super) error: bool,
}

/// What a frame asks of the drive with this node, in the order in which it is done.
pub(super) fn orders(protocol: &Protocol, frame: &Frame, node: u8) -> Vec<Order> {
    match protocol {
        Protocol::Odrive if frame.id >> 5 == u16::from(node) => of_odrive(frame),
        Protocol::Mit(ranges) if frame.id == u16::from(node) => match frame.data {
            Some([.., 0xFC]) if is_special(frame) => vec![Order::Start, Order::Tell],
            Some([.., 0xFB]) if is_special(frame) => vec![Order::Clear, Order::Tell],
            Some([.., 0xFD]) if is_special(frame) => vec![Order::Stop, Order::Tell],
            Some(data) => vec![Order::Input(input(data, ranges)), Order::Tell],
            None => Vec::new(),
        },
        _ => Vec::new(),
    }
}

/// Whether the first seven bytes are those of an order.
fn is_special(frame: &Frame) -> bool {
    frame.data.is_some_and(|data| data[..7] == [0xFF; 7])
}

/// The input of an MIT-type frame.
fn input(data: [u8; 8], ranges: &Ranges) -> Input {
    let [p1, p2, v1, v2k1, k2, d1, d2t1, t2] = data.map(f64::from);
    let upper = |byte: f64| (byte / 16.0).floor();
    let lower = |byte: f64| byte - 16.0 * upper(byte);
    let within = |share: f64, full: f64, limit: f32| (2.0 * share / full - 1.0) * f64::from(limit);
    let stiffness = (256.0 * lower(v2k1) + k2) / 4095.0 * 500.0;
    let damping = (16.0 * d1 + upper(d2t1)) / 4095.0 * 5.0;
    Input {
        position: within(256.0 * p1 + p2, 65535.0, ranges.position),
        velocity: within(16.0 * v1 + upper(v2k1), 4095.0, ranges.velocity),
        torque: within(256.0 * lower(d2t1) + t2, 4095.0, ranges.torque),
        stiffness: Some([stiffness, damping]),
    }
}

fn of_odrive(frame: &Frame) -> Vec<Order> {
    let Some([a, b, c, d, e, f, g, h]) = frame.data else {
        return match frame.id & 0x1F {
            0x09 => vec![Order::Tell],
            _ => Vec::new(),
        };
    };
    let first = [a, b, c, d];
    let whole = |bytes| u32::from_le_bytes(bytes);
    let single = f64::from(f32::from_le_bytes(first));
    let thousandths = |bytes| f64::from(i16::from_le_bytes(bytes)) / 1000.0;
    match (frame.id & 0x1F, whole(first), whole([e, f, g, h])) {
        (0x07, 8, _) => vec![Order::Start],
        (0x07, 1, _) => vec![Order::Stop],
        (0x0B, 3, 1) => vec![Order::Follow],
        (0x0C, ..) => vec![Order::Input(Input {
            position: TAU * single,
            velocity: TAU * thousandths([e, f]),
            torque: thousandths([g, h]),
            stiffness: None,
        })],
        (0x18, ..) => vec![Order::Clear],
        (0x1A, ..) => vec![Order::PositionGain(single)],
        (0x1B, ..) => vec![Order::VelocityGain(single / TAU)],
        _ => Vec::new(),
    }
}

/// The frame that answers [`Order::Tell`].
pub(super) fn answer(protocol: &Protocol, told: &Answer) -> Frame {
    let single = |value: f64| (value as f32).to_le_bytes();
    match protocol {
        Protocol::Odrive => odrive(told.node, 0x09, single(told.turns), single(told.speed)),
        // Of the controller, which is node 0.
        Protocol::Mit(ranges) => Frame::new(0, reply(told, ranges)),
    }
}

/// The frame that a drive sends by itself.
pub(super) fn by_itself(protocol: &Protocol, told: &Answer) -> Option<Frame> {
    match protocol {
        Protocol::Odrive => {
            // `active_errors | disarm_reason`: WATCHDOG_TIMER_EXPIRED.
            let error: u32 = if told.error { 0x0100_0000 } else { 0 };
            let state = if told.drives { 8 } else { 1 };
            Some(odrive(
                told.node,
                0x01,
                error.to_le_bytes(),
                [state, 0, 0, 0],
            ))
        }
        Protocol::Mit(_) => None,
    }
}

fn odrive(node: u8, message: u16, [a, b, c, d]: [u8; 4], [e, f, g, h]: [u8; 4]) -> Frame {
    Frame::new(32 * u16::from(node) + message, [a, b, c, d, e, f, g, h])
}

fn reply(told: &Answer, ranges: &Ranges) -> [u8; 8] {
    let share = |value: f64, limit: f32, full: f64| {
        let limit = f64::from(limit);
        ((value.clamp(-limit, limit) + limit) / (2.0 * limit) * full) as u16
    };
    let [p1, p2] = share(TAU * told.turns, ranges.position, 65535.0).to_be_bytes();
    let velocity = share(TAU * told.speed, ranges.velocity, 4095.0);
    let torque = share(told.torque, ranges.torque, 4095.0);
    let state = match (told.error, told.drives) {
        // Lost messages.
        (true, _) => 0xD,
        (false, drives) => u8::from(drives),
    };
    let both = ((velocity & 0xF) << 4 | torque >> 8) as u8;
    let heat = [30, 30];
    [
        state << 4 | told.node,
        p1,
        p2,
        (velocity >> 4) as u8,
        both,
        torque as u8,
        heat[0],
        heat[1],
    ]
}
