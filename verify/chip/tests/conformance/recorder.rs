//! What the chip drives, noted change by change, and levels of its inputs that a test sets.

use fivebar_chip::time::Time;
use fivebar_chip::{Edges, Outputs, Pin, SampleWindow, Wiring};
use fivebar_firmware::drives::can::Frame;
use fivebar_kinematics::five_bar::Joint;
use fivebar_plant::BusEvent;
use std::cell::{RefCell, RefMut};
use std::rc::Rc;

/// The changes so far, and the levels that the test sets.
#[derive(Default)]
pub(crate) struct Record {
    /// What the chip drives from each time on.
    pub(crate) changes: Vec<(Time, Outputs)>,
    /// Pins with the level that the test gives them; none: the wire is broken.
    pub(crate) forced: Vec<(Pin, Option<bool>)>,
}

/// A record that the chip and the test share.
#[derive(Clone, Default)]
pub(crate) struct SharedRecord(Rc<RefCell<Record>>);

impl SharedRecord {
    pub(crate) fn get(&self) -> RefMut<'_, Record> {
        self.0.borrow_mut()
    }

    /// Gives a pin this level from now on; none: breaks its wire.
    pub(crate) fn force(&self, pin: Pin, level: Option<bool>) {
        self.release(pin);
        self.get().forced.push((pin, level));
    }

    /// Leaves a pin to what is wired to it.
    pub(crate) fn release(&self, pin: Pin) {
        self.get().forced.retain(|(forced, _)| *forced != pin);
    }
}

/// An arm's wiring behind the record.
pub(crate) struct Recorder {
    pub(crate) record: SharedRecord,
    pub(crate) inner: Box<dyn Wiring>,
}

impl Wiring for Recorder {
    fn drive(&mut self, now: Time, outputs: &Outputs) {
        self.record.get().changes.push((now, *outputs));
        self.inner.drive(now, outputs);
    }

    fn level(&mut self, now: Time, pin: Pin) -> Option<bool> {
        let forced = self
            .record
            .get()
            .forced
            .iter()
            .find(|it| it.0 == pin)
            .copied();
        match forced {
            Some((_, level)) => level,
            None => self.inner.level(now, pin),
        }
    }

    fn encoder(&mut self, now: Time, joint: Joint, filter: Time) -> i32 {
        self.inner.encoder(now, joint, filter)
    }

    fn sample(&mut self, window: &SampleWindow, edges: &[Edges; 2]) -> u16 {
        self.inner.sample(window, edges)
    }

    fn offer(&mut self, now: Time, frame: Option<Frame>) {
        self.inner.offer(now, frame);
    }

    fn bus_event(&mut self) -> Option<BusEvent> {
        self.inner.bus_event()
    }

    fn due(&self) -> Time {
        self.inner.due()
    }

    fn advance(&mut self, now: Time) {
        self.inner.advance(now);
    }
}

/// Two step drivers without motors: switches closed, no faults.
pub(crate) struct StepDrivers;

impl Wiring for StepDrivers {
    fn drive(&mut self, _: Time, _: &Outputs) {}

    fn level(&mut self, _: Time, pin: Pin) -> Option<bool> {
        match pin {
            // Both break inputs, and the home switches.
            Pin(1, 12) | Pin(0, 6) | Pin(2, 4 | 5) => Some(false),
            // Fault outputs and the serial line.
            Pin(1, 0 | 1 | 7) => Some(true),
            _ => None,
        }
    }

    fn encoder(&mut self, _: Time, _: Joint, _: Time) -> i32 {
        0
    }

    fn sample(&mut self, _: &SampleWindow, _: &[Edges; 2]) -> u16 {
        0
    }
}
