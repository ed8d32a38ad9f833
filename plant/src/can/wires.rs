//! The bus for a CAN controller that sends whenever it likes: what happens on the wires, frame by frame.

use super::bus::bits_on_bus;
use super::plant::{CONTROLLER, CanPlant, SHORTEST_STEP, command};
use fivebar_firmware::drives::can::Frame;
use fivebar_firmware::settings::Share;
use fivebar_kinematics::five_bar::Joint;

/// Bits of a frame up to an error where the wires are shorted: the first dominant bit is not seen.
const SHORTED_BITS: u32 = 1;
/// Somebody else as a sender on the bus.
const STRANGER: usize = 3;
/// Bits behind the place where a receiver acknowledges a frame.
const BEHIND_ACKNOWLEDGEMENT: u32 = 12;

/// What is wrong with the wires.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Wires {
    /// Nothing.
    #[default]
    Whole,
    /// They touch each other: nobody sees a dominant bit.
    Shorted,
}

/// What a CAN controller sees of the bus.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BusEvent {
    /// The frame that it offers is on its way.
    Began,
    /// It has arrived.
    Sent,
    /// An error has ended it. `acknowledged` is false where nobody took it, and nothing else was wrong.
    Failed {
        /// Whether somebody was there.
        acknowledged: bool,
    },
    /// A frame of somebody else.
    Received(Frame),
}

impl CanPlant {
    /// What the controller wants to send next, in the place of what it wanted before and what is not on its way.
    pub fn offer(&mut self, frame: Option<Frame>) {
        self.bus.offer(CONTROLLER, frame);
    }

    /// Somebody else on the bus has a frame to send, which is not meant for the arm.
    pub fn disturb_with(&mut self, frame: Frame) {
        self.bus.put(STRANGER, frame);
    }

    /// Breaks the wires, or repairs them.
    pub fn set_wires(&mut self, wires: Wires) {
        self.wires = wires;
    }

    /// Time until something happens on the bus by itself [s].
    pub fn until_event(&self) -> f64 {
        if self.bus.can_begin() {
            return 0.0;
        }
        let beats = Joint::ALL.map(|j| match self.drives[j].is_silent() {
            true => f64::INFINITY,
            false => self.until_told[j].max(0.0),
        });
        let end = self.bus.time_left().unwrap_or(f64::INFINITY);
        let end = end.min(self.until_late());
        end.min(beats[0]).min(beats[1])
    }

    /// Lets so much time pass [s], or less: up to the next event on the bus. Returns the time, and the event.
    pub fn pass(&mut self, brake: bool, tool: Share, time: f64) -> (f64, Option<BusEvent>) {
        self.follow_faults();
        self.beat(0.0);
        if self.bus.can_begin() {
            self.bus.begin(|| false);
            if let Some(event) = self.began() {
                return (0.0, Some(event));
            }
        }
        let most = time.min(self.until_event());
        let command = command(brake, tool);
        let mut passed = 0.0;
        loop {
            let left = most - passed;
            let (step, ended) = match left > SHORTEST_STEP {
                true => self.slice(&command, left),
                // Too short for the mechanics.
                false => (left, self.bus.pass(left)),
            };
            passed += step;
            self.beat(step);
            if let Some((from, frame)) = ended {
                return (passed, self.ended(from, &frame));
            }
            if left <= SHORTEST_STEP {
                return (most, None);
            }
        }
    }

    /// A frame has begun: whether it will arrive, and what the controller sees of it.
    fn began(&mut self) -> Option<BusEvent> {
        let is_own = self.bus.sender() == Some(CONTROLLER);
        let somebody = !is_own || self.drives.iter().any(|drive| !drive.is_silent());
        self.is_spoilt = self.wires == Wires::Shorted || !somebody;
        if self.wires == Wires::Shorted {
            self.bus.spoil(|_| SHORTED_BITS);
        } else if !somebody {
            self.bus
                .spoil(|frame| bits_on_bus(frame) - BEHIND_ACKNOWLEDGEMENT);
        }
        is_own.then_some(BusEvent::Began)
    }

    /// A frame has ended.
    fn ended(&mut self, from: usize, frame: &Frame) -> Option<BusEvent> {
        if self.is_spoilt {
            let acknowledged = self.wires == Wires::Shorted;
            return (from == CONTROLLER).then_some(BusEvent::Failed { acknowledged });
        }
        if from == CONTROLLER {
            self.arrive(from, frame);
            return Some(BusEvent::Sent);
        }
        Some(BusEvent::Received(*frame))
    }
}
