//! Torque drives on a CAN bus: the frames of two protocols, the time that they take, and the link that makes a tick's
//! sample of the drives' answers.
//!
//! In each tick the [`Link`] sends one command to each drive, and each drive answers once. So the bus carries the same
//! frames in every tick, and a drive that does not answer is noticed; one late answer is tolerated.

mod bus_drives;
mod link;
pub mod mit;
pub mod odrive;
mod setup;
mod waiting;

use crate::safety::TOLERATED_TICKS;
pub use bus_drives::{BusCommand, BusDrives, BusSample, UNKNOWN};
pub use link::{Frames, Link, MOST_FRAMES, Protocol};
use serde::{Deserialize, Serialize};
pub use setup::BusSetup;
pub use waiting::{CanController, MOST_RECEIVED, WaitingFrames};

/// Bits in a second: both protocols' fastest.
pub const BIT_RATE: f32 = 1e6;

/// The greatest share of the busiest tick that frames may take. In a tick without heartbeats the rest has room for
/// frames that are sent again after an error.
pub const MOST_LOAD: f32 = 0.95;

/// Ticks without a command after which a drive's own watchdog ends its torque: those that the controller may miss, the one
/// that is due, and one because a frame may come early in one tick and late in another.
pub const WATCHDOG_TICKS: u32 = TOLERATED_TICKS + 2;

/// The time that the drives' own watchdogs are set to [s], with so many ticks in a second.
///
/// ```
/// assert_eq!(fivebar_firmware::drives::can::watchdog(1000.0), 4e-3);
/// ```
pub fn watchdog(tick_rate: f32) -> f32 {
    WATCHDOG_TICKS as f32 / tick_rate
}

/// Data of a frame.
pub type Payload = [u8; 8];

/// A frame with an identifier of 11 bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Frame {
    /// The identifier.
    pub id: u16,
    /// Eight bytes, of a shorter frame filled up with 0; none: it asks for the frame with this identifier.
    pub data: Option<Payload>,
}

impl Frame {
    /// A frame with data.
    pub const fn new(id: u16, data: Payload) -> Self {
        let data = Some(data);
        Self { id, data }
    }

    /// The most bits on the bus, with the pause behind it and the most stuffed bits.
    pub const fn most_bits(&self) -> u32 {
        most_bits(match self.data {
            Some(_) => 8,
            None => 0,
        })
    }
}

/// The most bits of a frame with so many bytes of data and an identifier of 11 bits: 34 bits and the data can be
/// stuffed, one behind each four after the first five; 13 cannot, with the pause of three behind the frame.
const fn most_bits(bytes: u32) -> u32 {
    let stuffable = 34 + 8 * bytes;
    stuffable + 13 + (stuffable - 1) / 4
}

/// The share of the busiest tick that the frames of two drives take on the bus, at most, with so many ticks in a second:
/// a command and an answer of each drive, with ODrive also a request, and the heartbeats of both.
///
/// ```
/// use fivebar_firmware::drives::can::{Protocol, most_load};
///
/// let load = most_load(&Protocol::Odrive, 1000.0);
/// assert!((load - 0.92).abs() < 1e-3);
/// ```
pub fn most_load(protocol: &Protocol, tick_rate: f32) -> f32 {
    let (data, request) = (most_bits(8), most_bits(0));
    let of_each = match protocol {
        Protocol::Odrive => 3 * data + request,
        Protocol::Mit(_) => 2 * data,
    };
    (2 * of_each) as f32 * tick_rate / BIT_RATE
}

/// The bits of a frame with so many bytes, usually: with half of those that can be stuffed.
const fn usual_bits(bytes: u32) -> f32 {
    let least = 34 + 8 * bytes + 13;
    0.5 * (least + most_bits(bytes)) as f32
}

/// Time from the end of a tick until the drives of joint 1 and joint 4 sense their motors for the answer of that
/// tick [s], with frames of usual length. The frame with the least identifier goes first.
pub fn sensed_after(protocol: &Protocol, [node1, node4]: [u8; 2]) -> [f32; 2] {
    let (data, request) = (usual_bits(8), usual_bits(0));
    let bits = match protocol {
        // Both commands, then the requests; the first drive's answer may go before the second request.
        Protocol::Odrive if node1 < node4 => [2.0 * data + request, 3.0 * data + 2.0 * request],
        Protocol::Odrive => [2.0 * data + request, 2.0 * data + 2.0 * request],
        // An answer goes before the next command.
        Protocol::Mit(_) => [data, 3.0 * data],
    };
    bits.map(|bits| bits / BIT_RATE)
}

/// Time from the end of a tick until that tick's commands are at the drives of joint 1 and joint 4 [s], with frames of usual
/// length.
pub fn told_after(protocol: &Protocol) -> [f32; 2] {
    let data = usual_bits(8);
    let bits = match protocol {
        Protocol::Odrive => [data, 2.0 * data],
        // The first drive's answer goes before the second command.
        Protocol::Mit(_) => [data, 3.0 * data],
    };
    bits.map(|bits| bits / BIT_RATE)
}
