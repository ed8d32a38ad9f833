//! Which pins a board gives to the signals of each image.

use super::places::{Peripheral, Pin, analog};

/// The pins of every image.
#[derive(Clone, Copy, Debug)]
pub struct CommonPins {
    /// Releases the brake when high.
    pub brake: Pin,
    /// The tool, TIM3.
    pub tool: Pin,
    /// The serial line, USART1: out, in.
    pub serial: [Pin; 2],
    /// Home switches of joints 1 and 4.
    pub home: [Pin; 2],
    /// The emergency stop; where bridges or drivers have a timer, at TIM1's break input.
    pub stop: Pin,
}

/// The pins for brushed motors.
#[derive(Clone, Copy, Debug)]
pub struct BrushedPins {
    /// IN1 and IN2 of bridge 1, IN1 and IN2 of bridge 4, TIM1.
    pub bridges: [Pin; 4],
    /// Sleep inputs of bridges 1 and 4.
    pub sleep: [Pin; 2],
    /// Fault outputs of bridges 1 and 4.
    pub fault: [Pin; 2],
    /// A and B of joint 1's encoder, TIM5.
    pub encoder1: [Pin; 2],
    /// A and B of joint 4's encoder, TIM2.
    pub encoder4: [Pin; 2],
    /// Index outputs of both encoders.
    pub index: [Pin; 2],
}

/// The pins for steppers.
#[derive(Clone, Copy, Debug)]
pub struct StepperPins {
    /// Steps of motors 1 and 4, TIM1 and TIM8.
    pub step: [Pin; 2],
    /// Their directions.
    pub direction: [Pin; 2],
    /// Enables of drivers 1 and 4.
    pub enable: [Pin; 2],
    /// Fault outputs of drivers 1 and 4.
    pub fault: [Pin; 2],
    /// The emergency stop again, at TIM8's break input.
    pub stop4: Pin,
}

/// The pins for drives on a CAN bus.
#[derive(Clone, Copy, Debug)]
pub struct CanPins {
    /// The bus, CAN1: in, out.
    pub bus: [Pin; 2],
}

/// How a signal uses its pin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Use {
    /// As an input or an output of the program.
    Level,
    /// As a signal of a peripheral.
    Of(Peripheral),
    /// As an input of the converters.
    Analog,
}

/// A signal, its pin, and how it uses it.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    /// What the signal is called.
    pub signal: &'static str,
    /// Its pin.
    pub pin: Pin,
    /// How it uses the pin.
    pub uses: Use,
}

const fn row(signal: &'static str, pin: Pin, uses: Use) -> Row {
    Row { signal, pin, uses }
}

impl CommonPins {
    /// Its signals, with the emergency stop used so.
    pub const fn rows(&self, stop: Use) -> [Row; 7] {
        let ([send, receive], [home1, home4]) = (self.serial, self.home);
        [
            row("brake", self.brake, Use::Level),
            row("tool", self.tool, Use::Of(Peripheral::Tim3)),
            row("serial out", send, Use::Of(Peripheral::Usart1Send)),
            row("serial in", receive, Use::Of(Peripheral::Usart1Receive)),
            row("home 1", home1, Use::Level),
            row("home 4", home4, Use::Level),
            row("emergency stop", self.stop, stop),
        ]
    }
}

impl BrushedPins {
    /// Its signals.
    pub const fn rows(&self) -> [Row; 17] {
        let [in1, in2, in3, in4] = self.bridges;
        let ([a1, b1], [a4, b4]) = (self.encoder1, self.encoder4);
        [
            row("bridge 1 IN1", in1, Use::Of(Peripheral::Tim1(1))),
            row("bridge 1 IN2", in2, Use::Of(Peripheral::Tim1(2))),
            row("bridge 4 IN1", in3, Use::Of(Peripheral::Tim1(3))),
            row("bridge 4 IN2", in4, Use::Of(Peripheral::Tim1(4))),
            row("sleep 1", self.sleep[0], Use::Level),
            row("sleep 4", self.sleep[1], Use::Level),
            row("fault 1", self.fault[0], Use::Level),
            row("fault 4", self.fault[1], Use::Level),
            row("encoder 1 A", a1, Use::Of(Peripheral::Tim5(1))),
            row("encoder 1 B", b1, Use::Of(Peripheral::Tim5(2))),
            row("encoder 4 A", a4, Use::Of(Peripheral::Tim2(1))),
            row("encoder 4 B", b4, Use::Of(Peripheral::Tim2(2))),
            row("index 1", self.index[0], Use::Level),
            row("index 4", self.index[1], Use::Level),
            row("current 1", analog(10), Use::Analog),
            row("current 4", analog(11), Use::Analog),
            row("bus voltage", analog(12), Use::Analog),
        ]
    }
}

impl StepperPins {
    /// Its signals.
    pub const fn rows(&self) -> [Row; 9] {
        [
            row("step 1", self.step[0], Use::Of(Peripheral::Tim1(1))),
            row("step 4", self.step[1], Use::Of(Peripheral::Tim8)),
            row("direction 1", self.direction[0], Use::Level),
            row("direction 4", self.direction[1], Use::Level),
            row("enable 1", self.enable[0], Use::Level),
            row("enable 4", self.enable[1], Use::Level),
            row("fault 1", self.fault[0], Use::Level),
            row("fault 4", self.fault[1], Use::Level),
            row(
                "emergency stop 4",
                self.stop4,
                Use::Of(Peripheral::Tim8Break),
            ),
        ]
    }
}

impl CanPins {
    /// Its signals.
    pub const fn rows(&self) -> [Row; 2] {
        let [receive, send] = self.bus;
        [
            row("CAN in", receive, Use::Of(Peripheral::Can1Receive)),
            row("CAN out", send, Use::Of(Peripheral::Can1Send)),
        ]
    }
}
