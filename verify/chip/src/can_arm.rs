//! The simulated arm with drives on a CAN bus, as the pins see it.

use crate::peripherals::adc::SampleWindow;
use crate::peripherals::gpio::Pin;
use crate::time::{MICROSECOND, NEVER, SECOND, Time};
use crate::wiring::{Edges, Outputs, Wiring};
use fivebar_firmware::drives::can::Frame;
use fivebar_kinematics::five_bar::Joint;
use fivebar_plant::{BusEvent, CanPlant};
use std::cell::{RefCell, RefMut};
use std::collections::VecDeque;
use std::rc::Rc;

const STOP: Pin = Pin(1, 12);
const SERIAL_IN: Pin = Pin(1, 7);
const HOME: [Pin; 2] = [Pin(2, 4), Pin(2, 5)];
/// A sample of the switches is not older than this.
const FRESH: Time = 50 * MICROSECOND;

/// A frame that has arrived.
#[derive(Clone, Copy, Debug)]
pub struct Arrived {
    /// The end of the frame.
    pub at: Time,
    /// Whether the chip sent it.
    pub is_own: bool,
    /// The frame.
    pub frame: Frame,
    /// Where the tool was [m].
    pub tool: [f64; 2],
}

/// The arm, its bus and its switches.
pub struct CanArm {
    plant: CanPlant,
    outputs: Outputs,
    at: Time,
    events: VecDeque<BusEvent>,
    home: [bool; 2],
    stop: bool,
    sampled_at: Time,
    /// The emergency stop is pressed; it also takes the drives' supply away.
    stop_pressed: bool,
    /// Every frame that has arrived.
    pub frames: Vec<Arrived>,
    offered: Option<Frame>,
    on_its_way: Option<Frame>,
}

impl CanArm {
    /// An arm at rest.
    pub fn new(plant: CanPlant) -> Self {
        Self {
            plant,
            outputs: Outputs::RELEASED,
            at: 0,
            events: VecDeque::new(),
            home: [false; 2],
            stop: false,
            sampled_at: 0,
            stop_pressed: false,
            frames: Vec::new(),
            offered: None,
            on_its_way: None,
        }
    }

    /// The plant.
    pub fn plant(&self) -> &CanPlant {
        &self.plant
    }

    /// The plant, to disturb it.
    pub fn plant_mut(&mut self) -> &mut CanPlant {
        &mut self.plant
    }

    /// What the chip drives.
    pub fn outputs(&self) -> &Outputs {
        &self.outputs
    }

    /// Presses or releases the emergency stop.
    pub fn press_stop(&mut self, pressed: bool) {
        self.stop_pressed = pressed;
    }

    /// Lets time pass up to `now`.
    pub fn follow(&mut self, now: Time) {
        while self.at < now {
            let brake = self.outputs.brake != Some(true);
            let left = (now - self.at) as f64 / SECOND as f64;
            let (passed, event) = self.plant.pass(brake, 0, left);
            let passed = (passed * SECOND as f64).round() as Time;
            self.at = (self.at + passed).min(now);
            match event {
                Some(event) => self.note(event),
                None if passed == 0 => self.at = now,
                None => {}
            }
        }
    }

    fn note(&mut self, event: BusEvent) {
        match event {
            BusEvent::Began => self.on_its_way = self.offered.take(),
            BusEvent::Sent => {
                let sent = self.on_its_way.take();
                if let Some(frame) = sent {
                    self.arrived(true, frame);
                }
            }
            BusEvent::Received(frame) => self.arrived(false, frame),
            BusEvent::Failed { .. } => {}
        }
        self.events.push_back(event);
    }

    fn arrived(&mut self, is_own: bool, frame: Frame) {
        let (at, tool) = (self.at, self.plant.tool().into());
        self.frames.push(Arrived {
            at,
            is_own,
            frame,
            tool,
        });
    }
}

/// The arm as the chip and a test share it.
#[derive(Clone)]
pub struct SharedCanArm(Rc<RefCell<CanArm>>);

impl SharedCanArm {
    /// Shares an arm.
    pub fn new(arm: CanArm) -> Self {
        Self(Rc::new(RefCell::new(arm)))
    }

    /// The arm, while the chip does not run.
    pub fn get(&self) -> RefMut<'_, CanArm> {
        self.0.borrow_mut()
    }
}

impl Wiring for SharedCanArm {
    fn drive(&mut self, now: Time, outputs: &Outputs) {
        let arm = &mut *self.get();
        arm.follow(now);
        arm.outputs = *outputs;
    }

    fn level(&mut self, now: Time, pin: Pin) -> Option<bool> {
        let arm = &mut *self.get();
        if now >= arm.sampled_at + FRESH || arm.sampled_at == 0 {
            arm.follow(now);
            let sample = arm.plant.sense();
            (arm.home, arm.stop, arm.sampled_at) = (sample.home, sample.emergency_stop, now);
        }
        match pin {
            STOP => Some(arm.stop_pressed || arm.stop),
            SERIAL_IN => Some(true),
            _ => {
                let joint = HOME.iter().position(|&home| home == pin)?;
                Some(arm.home[joint])
            }
        }
    }

    fn encoder(&mut self, _: Time, _: Joint, _: Time) -> i32 {
        0
    }

    fn sample(&mut self, _: &SampleWindow, _: &[Edges; 2]) -> u16 {
        0
    }

    fn offer(&mut self, now: Time, frame: Option<Frame>) {
        let arm = &mut *self.get();
        arm.follow(now);
        arm.offered = frame;
        arm.plant.offer(frame);
    }

    fn bus_event(&mut self) -> Option<BusEvent> {
        self.get().events.pop_front()
    }

    fn due(&self) -> Time {
        let arm = self.0.borrow();
        if !arm.events.is_empty() {
            return arm.at;
        }
        let wait = arm.plant.until_event() * SECOND as f64;
        match wait.is_finite() {
            true => arm.at + (wait.ceil() as Time).max(1),
            false => NEVER,
        }
    }

    fn advance(&mut self, now: Time) {
        self.get().follow(now);
    }
}
