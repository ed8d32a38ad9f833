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
    /// Follow torques.
    FollowTorques,
    /// This torque at the drive's shaft [N·m].
    Torque(f64),
    /// Tell where the motor is.
    Tell,
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
            Some([.., 0xFD]) if is_special(frame) => vec![Order::Stop, Order::Tell],
            Some([.., high, low]) => {
                let share = u16::from(high & 0xF) << 8 | u16::from(low);
                let limit = f64::from(ranges.torque);
                let torque = 2.0 * limit * f64::from(share) / 4095.0 - limit;
                vec![Order::Torque(torque), Order::Tell]
            }
            None => Vec::new(),
        },
        _ => Vec::new(),
    }
}

/// Whether the first seven bytes are those of an order.
fn is_special(frame: &Frame) -> bool {
    frame.data.is_some_and(|data| data[..7] == [0xFF; 7])
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
    match (frame.id & 0x1F, whole(first), whole([e, f, g, h])) {
        (0x07, 8, _) => vec![Order::Start],
        (0x07, 1, _) => vec![Order::Stop],
        (0x0B, 1, 1) => vec![Order::FollowTorques],
        (0x0E, ..) => vec![Order::Torque(f32::from_le_bytes(first).into())],
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
            // WATCHDOG_TIMER_EXPIRED.
            let error: u32 = if told.error { 0x0100_0000 } else { 0 };
            let state = if told.drives { 8 } else { 1 };
            Some(odrive(told.node, 0x01, error.to_le_bytes(), [state, 0, 0, 0]))
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
