//! The frames of a tick through a CAN controller with a few mailboxes and FIFOs.
//!
//! The mailboxes take fewer frames than a tick has, so the rest waits here until one is free. At the beginning of the next
//! tick what has not begun to go over the bus is dropped: an old torque never arrives late.

use super::{Frame, Frames};

/// Frames that a tick takes over, at most: as many as two FIFOs of three frames hold. So a bus that is full of frames with
/// the drives' identifiers costs a tick no more time.
pub const MOST_RECEIVED: usize = 6;

/// What is needed of a CAN controller.
pub trait CanController {
    /// Takes the oldest frame that one of its FIFOs holds.
    fn take(&mut self) -> Option<Frame>;

    /// Lets a frame wait for the bus, behind those before it; false if no mailbox is free.
    fn put(&mut self, frame: &Frame) -> bool;

    /// Takes back what has not begun to go over the bus.
    fn abort(&mut self);

    /// Whether it takes no part on the bus: after too many errors, or not yet.
    fn is_off(&self) -> bool;
}

/// The frames of the tick that are in no mailbox yet.
#[derive(Clone, Debug, Default)]
pub struct WaitingFrames {
    frames: Frames,
    /// How many of them are in a mailbox.
    put: usize,
}

impl WaitingFrames {
    /// A tick has begun: drops the frames of the one before, and hands over what has arrived.
    #[inline]
    pub fn begin_tick(&mut self, can: &mut impl CanController, mut receive: impl FnMut(&Frame)) {
        self.frames.clear();
        can.abort();
        for _ in 0..MOST_RECEIVED {
            let Some(frame) = can.take() else {
                break;
            };
            receive(&frame);
        }
    }

    /// Sends the frames of the tick that `make` makes in their place, in this order.
    #[inline]
    pub fn send(&mut self, can: &mut impl CanController, make: impl FnOnce(&mut Frames)) {
        make(&mut self.frames);
        self.put = 0;
        self.fill(can);
    }

    /// Gives free mailboxes the next frames. Called whenever one becomes free.
    #[inline]
    pub fn fill(&mut self, can: &mut impl CanController) {
        for frame in self.frames.iter().skip(self.put) {
            if !can.put(frame) {
                break;
            }
            self.put += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use heapless::Vec;

    /// A controller with three mailboxes, the first of which may be on its way.
    #[derive(Default)]
    struct Mailboxes {
        waiting: Vec<u16, 3>,
        is_moving: bool,
        received: usize,
    }

    impl Mailboxes {
        /// The bus takes the first frame, or has taken it.
        fn begins(&mut self) {
            self.is_moving = !self.waiting.is_empty();
        }

        fn ends(&mut self) -> Option<u16> {
            self.is_moving = false;
            (!self.waiting.is_empty()).then(|| self.waiting.remove(0))
        }
    }

    impl CanController for Mailboxes {
        fn take(&mut self) -> Option<Frame> {
            self.received = self.received.checked_sub(1)?;
            Some(frame(0x100))
        }

        fn put(&mut self, frame: &Frame) -> bool {
            self.waiting.push(frame.id).is_ok()
        }

        fn abort(&mut self) {
            self.waiting.truncate(usize::from(self.is_moving));
        }

        fn is_off(&self) -> bool {
            false
        }
    }

    fn frame(id: u16) -> Frame {
        Frame::new(id, [0; 8])
    }

    fn frames(ids: [u16; 4]) -> impl FnOnce(&mut Frames) {
        move |frames| *frames = ids.into_iter().map(frame).collect()
    }

    #[test]
    fn four_frames_go_through_three_mailboxes_in_their_order() {
        let (mut can, mut waiting) = (Mailboxes::default(), WaitingFrames::default());
        waiting.send(&mut can, frames([4, 3, 2, 1]));
        assert_eq!(can.waiting, [4, 3, 2]);
        // Nothing is free.
        waiting.fill(&mut can);
        let mut sent = Vec::<u16, 8>::new();
        for _ in 0..5 {
            can.begins();
            sent.extend(can.ends());
            waiting.fill(&mut can);
        }
        assert_eq!(sent, [4, 3, 2, 1]);
    }

    #[test]
    fn an_old_frame_is_never_sent_in_a_later_tick() {
        let (mut can, mut waiting) = (Mailboxes::default(), WaitingFrames::default());
        waiting.send(&mut can, frames([10, 11, 12, 13]));
        // The bus is busy, then takes one just before the tick ends.
        can.begins();
        waiting.begin_tick(&mut can, |_| ());
        assert_eq!(can.waiting, [10], "what is on its way");
        // It ends before the tick has new frames.
        can.ends();
        waiting.fill(&mut can);
        assert_eq!(can.waiting, [0; 0]);
        waiting.send(&mut can, frames([20, 21, 22, 23]));
        assert_eq!(can.waiting, [20, 21, 22]);
    }

    #[test]
    fn a_tick_takes_no_more_frames_than_two_fifos_hold() {
        let (mut can, mut waiting) = (Mailboxes::default(), WaitingFrames::default());
        can.received = 100;
        let mut taken = 0;
        waiting.begin_tick(&mut can, |_| taken += 1);
        assert_eq!((taken, can.received), (MOST_RECEIVED, 100 - MOST_RECEIVED));
        can.received = 2;
        waiting.begin_tick(&mut can, |_| taken += 1);
        assert_eq!(taken, MOST_RECEIVED + 2);
    }
}
