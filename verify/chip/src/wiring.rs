//! What is wired to the chip's pins.

use crate::peripherals::adc::SampleWindow;
use crate::peripherals::gpio::Pin;
use crate::peripherals::pwm_timer::Pulses;
use crate::peripherals::tim1::Output;
use crate::time::{NEVER, Time};
use fivebar_firmware::drives::can::Frame;
use fivebar_kinematics::five_bar::Joint;
use fivebar_plant::BusEvent;

/// What the chip drives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Outputs {
    /// TIM1's channels on PA8 to PA11.
    pub pwm: [Output; 4],
    /// PB14 and PB15: the bridges' sleep inputs, or the steppers' enables; none where the chip does not drive the pin.
    pub sleep: [Option<bool>; 2],
    /// PA8 and PC8: the steps of motors 1 and 4, where steppers are simulated.
    pub steps: [Option<bool>; 2],
    /// PA9 and PC9: their directions.
    pub direction: [Option<bool>; 2],
    /// PC6: releases the brake.
    pub brake: Option<bool>,
    /// PC7: the tool.
    pub tool: Pulses,
}

impl Outputs {
    /// All pins released, as in reset.
    pub const RELEASED: Self = Self {
        pwm: [Output::Released; 4],
        sleep: [None; 2],
        steps: [None; 2],
        direction: [None; 2],
        brake: None,
        tool: Pulses::Released,
    };
}

/// How long before the end of a sample's window the inputs of a bridge switched, the last edges only.
pub type Edges = [Option<Time>; 4];

/// The world around the chip.
pub trait Wiring {
    /// What the chip drives has changed.
    fn drive(&mut self, now: Time, outputs: &Outputs);

    /// The level of a pin; none if nothing outside drives it.
    fn level(&mut self, now: Time, pin: Pin) -> Option<bool>;

    /// The counts of a joint's encoder; `filter` is how long a level must last to count.
    fn encoder(&mut self, now: Time, joint: Joint, filter: Time) -> i32;

    /// The code of a sample. `edges` are those at the inputs of both bridges.
    fn sample(&mut self, window: &SampleWindow, edges: &[Edges; 2]) -> u16;

    /// The frame that CAN1 sends next, if it has one that is not on its way.
    fn offer(&mut self, _now: Time, _frame: Option<Frame>) {}

    /// What has happened on the bus, one by one.
    fn bus_event(&mut self) -> Option<BusEvent> {
        None
    }

    /// When something changes by itself.
    fn due(&self) -> Time {
        NEVER
    }

    /// Lets change what is due.
    fn advance(&mut self, _now: Time) {}
}

/// Nothing wired.
#[derive(Clone, Copy, Debug, Default)]
pub struct Unwired;

impl Wiring for Unwired {
    fn drive(&mut self, _: Time, _: &Outputs) {}

    fn level(&mut self, _: Time, _: Pin) -> Option<bool> {
        None
    }

    fn encoder(&mut self, _: Time, _: Joint, _: Time) -> i32 {
        0
    }

    fn sample(&mut self, _: &SampleWindow, _: &[Edges; 2]) -> u16 {
        0
    }
}
