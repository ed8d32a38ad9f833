//! The simulated arm with steppers on the chip's pins: its drivers count the edges of their step inputs.

use crate::peripherals::adc::SampleWindow;
use crate::peripherals::gpio::Pin;
use crate::time::{MICROSECOND, SECOND, Time};
use crate::wiring::{Edges, Outputs, Wiring};
use fivebar_firmware::drives::{StepCommand, StepSample};
use fivebar_firmware::{ArmCommand, ArmSample};
use fivebar_kinematics::five_bar::Joint;
use fivebar_plant::StepperPlant;
use std::cell::{RefCell, RefMut};
use std::rc::Rc;

/// S1a, at the break inputs of both timers.
const STOP: [Pin; 2] = [Pin(1, 12), Pin(0, 6)];
const HOME: [Pin; 2] = [Pin(2, 4), Pin(2, 5)];
const DRIVER_FAULT: [Pin; 2] = [Pin(1, 0), Pin(1, 1)];
/// The serial line's input idles high.
const SERIAL_IN: Pin = Pin(1, 7);
/// The plant advances by this: a tick of the controller. It spreads the edges of each evenly.
const PERIOD: Time = 100 * MICROSECOND;

/// The arm and its drivers.
pub struct StepperArm {
    plant: StepperPlant,
    outputs: Outputs,
    /// Up to here the plant has advanced.
    at: Time,
    /// Edges since then, forwards minus backwards.
    edges: [i32; 2],
    sample: ArmSample<StepSample>,
    stop_pressed: bool,
}

impl StepperArm {
    /// The arm at rest, before the chip starts.
    pub fn new(mut plant: StepperPlant) -> Self {
        let sample = plant.sense();
        Self {
            plant,
            outputs: Outputs::RELEASED,
            at: 0,
            edges: [0; 2],
            sample,
            stop_pressed: false,
        }
    }

    /// The plant itself.
    pub fn plant(&self) -> &StepperPlant {
        &self.plant
    }

    /// Presses or releases the emergency stop, which also takes the drivers' supply away.
    pub fn press_stop(&mut self, pressed: bool) {
        self.stop_pressed = pressed;
    }

    fn advance(&mut self, now: Time) {
        while now >= self.at + PERIOD {
            // The enables are low for power; resistors at the drivers pull them high.
            let enable = self
                .outputs
                .sleep
                .map(|level| level == Some(false) && !self.stop_pressed);
            let command = ArmCommand {
                drives: StepCommand {
                    steps: std::mem::take(&mut self.edges),
                },
                enable,
                brake: self.outputs.brake != Some(true),
                tool: 0,
            };
            self.plant.step(&command, PERIOD as f64 / SECOND as f64);
            self.sample = self.plant.sense();
            self.at += PERIOD;
        }
    }

    fn drive(&mut self, now: Time, outputs: &Outputs) {
        self.advance(now);
        for joint in 0..2 {
            let rises =
                self.outputs.steps[joint] == Some(false) && outputs.steps[joint] == Some(true);
            if rises {
                let forwards = outputs.direction[joint] == Some(true);
                self.edges[joint] += if forwards { 1 } else { -1 };
            }
        }
        self.outputs = *outputs;
    }
}

/// The arm as the chip and a test share it.
#[derive(Clone)]
pub struct SharedStepperArm(Rc<RefCell<StepperArm>>);

impl SharedStepperArm {
    /// Shares an arm.
    pub fn new(arm: StepperArm) -> Self {
        Self(Rc::new(RefCell::new(arm)))
    }

    /// The arm, while the chip does not run.
    pub fn get(&self) -> RefMut<'_, StepperArm> {
        self.0.borrow_mut()
    }
}

impl Wiring for SharedStepperArm {
    fn drive(&mut self, now: Time, outputs: &Outputs) {
        self.get().drive(now, outputs);
    }

    fn level(&mut self, now: Time, pin: Pin) -> Option<bool> {
        let mut arm = self.get();
        arm.advance(now);
        if STOP.contains(&pin) {
            return Some(arm.stop_pressed || arm.sample.emergency_stop);
        }
        for joint in Joint::ALL {
            if pin == HOME[joint] {
                return Some(arm.sample.home[joint]);
            }
            if pin == DRIVER_FAULT[joint] {
                return Some(!arm.sample.driver_fault[joint]);
            }
        }
        (pin == SERIAL_IN).then_some(true)
    }

    fn encoder(&mut self, _: Time, _: Joint, _: Time) -> i32 {
        0
    }

    fn sample(&mut self, _: &SampleWindow, _: &[Edges; 2]) -> u16 {
        0
    }
}
