//! A CAN bus of 1 Mbit/s: one frame at a time, the least identifier first, each with all its bits.

use fivebar_firmware::drives::can::{BIT_RATE, Frame};
use std::collections::VecDeque;

/// The bits of a frame on the bus, as ISO 11898-1 has them: with those that are stuffed, and the pause of three behind.
pub fn bits_on_bus(frame: &Frame) -> u32 {
    let mut bits = vec![false];
    let mut push = |value: u32, count: u32| {
        bits.extend((0..count).rev().map(|bit| value >> bit & 1 == 1));
    };
    push(frame.id.into(), 11);
    // Remote request, standard identifier, reserved, and the length.
    push(u32::from(frame.data.is_none()), 1);
    push(0, 2);
    push(8, 4);
    for byte in frame.data.into_iter().flatten() {
        push(byte.into(), 8);
    }
    let mut check = 0_u32;
    for &bit in &bits {
        let turned = bit != (check >> 14 & 1 == 1);
        check = check << 1 & 0x7FFF;
        if turned {
            check ^= 0x4599;
        }
    }
    bits.extend((0..15).rev().map(|bit| check >> bit & 1 == 1));
    let (mut last, mut equal, mut stuffed) = (true, 0, 0);
    for &bit in &bits {
        equal = if bit == last { equal + 1 } else { 1 };
        last = bit;
        if equal == 5 {
            stuffed += 1;
            (last, equal) = (!bit, 1);
        }
    }
    // Delimiter of the check, acknowledgement with its delimiter, end of the frame, pause.
    bits.len() as u32 + stuffed + 1 + 2 + 7 + 3
}

/// Bits until the bus is free again after a frame that an error has hit: its own, and those of the error.
const ERROR_BITS: u32 = 23;

/// Who has a frame to send: the controller, the drive of a joint, or somebody else.
const SENDERS: usize = 4;

/// The bus with the frames that wait for it.
#[derive(Clone, Debug, Default)]
pub(super) struct Bus {
    waiting: [VecDeque<Frame>; SENDERS],
    /// The frame that is on its way, who sends it, and the time until its end [s].
    moving: Option<(usize, Frame, f64)>,
}

impl Bus {
    /// Puts a frame behind those of its sender.
    pub(super) fn put(&mut self, sender: usize, frame: Frame) {
        self.waiting[sender].push_back(frame);
    }

    /// Drops what a sender has not sent.
    pub(super) fn forget(&mut self, sender: usize) {
        self.waiting[sender].clear();
        self.moving.take_if(|(of, ..)| *of == sender);
    }

    /// Begins the next frame, if the bus is free: of those at the head the one with the least identifier. `is_hit` tells
    /// whether an error hits it; it is then sent again.
    pub(super) fn begin(&mut self, is_hit: impl FnOnce() -> bool) {
        if self.moving.is_some() {
            return;
        }
        let heads = self.waiting.iter().enumerate();
        let heads = heads.filter_map(|(sender, frames)| Some((sender, frames.front()?.id)));
        let Some((sender, _)) = heads.min_by_key(|&(_, id)| id) else {
            return;
        };
        if let Some(frame) = self.waiting[sender].pop_front() {
            let bits = bits_on_bus(&frame);
            let again = if is_hit() { bits + ERROR_BITS } else { 0 };
            let time = f64::from(bits + again) / f64::from(BIT_RATE);
            self.moving = Some((sender, frame, time));
        }
    }

    /// What a sender wants to send next, in the place of all that it wanted before.
    pub(super) fn offer(&mut self, sender: usize, frame: Option<Frame>) {
        self.waiting[sender].clear();
        self.waiting[sender].extend(frame);
    }

    /// Whether somebody has a frame to send on a free bus.
    pub(super) fn can_begin(&self) -> bool {
        self.moving.is_none() && self.waiting.iter().any(|frames| !frames.is_empty())
    }

    /// Who sends the frame that is on its way.
    pub(super) fn sender(&self) -> Option<usize> {
        self.moving.map(|(sender, ..)| sender)
    }

    /// An error ends the frame that is on its way after so many bits.
    pub(super) fn spoil(&mut self, bits: impl FnOnce(&Frame) -> u32) {
        if let Some((_, frame, time)) = &mut self.moving {
            *time = f64::from(bits(frame) + ERROR_BITS) / f64::from(BIT_RATE);
        }
    }

    /// The time until the frame on its way ends [s]; none if the bus is free.
    pub(super) fn time_left(&self) -> Option<f64> {
        self.moving.map(|(.., time)| time)
    }

    /// Lets this time pass [s], at most the time left. A frame that ends, and who sent it.
    pub(super) fn pass(&mut self, time: f64) -> Option<(usize, Frame)> {
        if let Some((.., left)) = &mut self.moving {
            *left -= time;
        }
        let ended = self.moving.take_if(|(.., left)| *left <= 0.0);
        ended.map(|(sender, frame, _)| (sender, frame))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame(id: u16) -> Frame {
        Frame::new(id, [0x55; 8])
    }

    #[test]
    fn the_least_identifier_goes_first_and_each_sender_keeps_its_order() {
        let mut bus = Bus::default();
        for (sender, id) in [(0, 9), (0, 2), (1, 5), (2, 7)] {
            bus.put(sender, frame(id));
        }
        let mut order = Vec::new();
        let mut time = 0.0;
        loop {
            bus.begin(|| false);
            let Some(left) = bus.time_left() else {
                break;
            };
            time += left;
            order.extend(bus.pass(left).map(|(_, frame)| frame.id));
        }
        assert_eq!(order, [5, 7, 9, 2]);
        let bits: u32 = [5, 7, 9, 2].map(|id| bits_on_bus(&frame(id))).iter().sum();
        assert!((time - f64::from(bits) * 1e-6).abs() < 1e-12);
    }

    #[test]
    fn a_frame_that_is_hit_is_sent_again() {
        let mut bus = Bus::default();
        bus.put(0, frame(1));
        bus.begin(|| true);
        let bits = 2 * bits_on_bus(&frame(1)) + ERROR_BITS;
        let left = bus.time_left().expect("on its way");
        assert!((left - f64::from(bits) * 1e-6).abs() < 1e-12);
    }
}
