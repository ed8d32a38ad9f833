//! A bare board on the chip's pins: no bridges, no motors, and the wires of `fivebar board-test`.

use crate::peripherals::adc::SampleWindow;
use crate::peripherals::gpio::Pin;
use crate::peripherals::pwm_timer::Pulses;
use crate::time::Time;
use crate::wiring::{Edges, Outputs, Wiring};
use fivebar_kinematics::five_bar::Joint;
use std::cell::RefCell;
use std::rc::Rc;

const STOP: Pin = Pin(1, 12);
/// The serial line's input idles high.
const SERIAL_IN: Pin = Pin(1, 7);
const BRIDGE_FAULT: [Pin; 2] = [Pin(1, 0), Pin(1, 1)];
/// A and B of both encoders.
const ENCODER: [[Pin; 2]; 2] = [[Pin(0, 0), Pin(0, 1)], [Pin(0, 15), Pin(1, 3)]];
/// The first of the converters' inputs on PC0, PC1, PC2.
const FIRST_CHANNEL: u8 = 10;
/// The code of 1.65 V, and the noise of a sample [codes].
const MIDDLE: f64 = 2048.0;
const NOISE: f64 = 1.2;

/// A mistake of a board.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BoardMistake {
    /// The wires of both currents' inputs are exchanged.
    AnalogExchanged,
    /// The converters' reference is a tenth too low.
    LowReference,
    /// The converters' inputs have no filters.
    NoisyAnalog,
    /// A and B of joint 1's encoder are exchanged.
    PhasesExchanged,
    /// The encoders of both joints are exchanged.
    EncodersExchanged,
    /// B of joint 4's encoder does not reach the chip.
    DeadPhase,
    /// The emergency stop's input is shorted to ground.
    StopStuck,
}

/// A bare board.
#[derive(Clone, Debug)]
pub struct BareBoard {
    mistake: Option<BoardMistake>,
    /// The first task's wires are there.
    wired: bool,
    /// The converter's input that is at ground.
    grounded: Option<u8>,
    /// Where the wire from PC7 ends.
    pulse_to: Option<Pin>,
    stop_open: bool,
    tool: Pulses,
    tool_since: Time,
    random: u64,
}

impl BareBoard {
    /// A board without wires.
    pub fn new(mistake: Option<BoardMistake>) -> Self {
        Self {
            mistake,
            wired: false,
            grounded: None,
            pulse_to: None,
            stop_open: false,
            tool: Pulses::Released,
            tool_since: 0,
            random: 1,
        }
    }

    fn has(&self, mistake: BoardMistake) -> bool {
        self.mistake == Some(mistake)
    }

    /// Does a task of `fivebar board-test`, in its words; false if it is none of them.
    pub fn execute(&mut self, task: &str) -> bool {
        let pin = |text: &str| text.split_whitespace().next_back().and_then(pin_of);
        if task.starts_with("Take the motors off") {
            self.wired = true;
        } else if task.ends_with("from 1.65 V to ground") {
            let number = task
                .split("PC")
                .nth(1)
                .and_then(|rest| rest.get(..1)?.parse().ok());
            self.grounded = number.map(|number: u8| FIRST_CHANNEL + number);
        } else if task.ends_with("back to 1.65 V") {
            self.grounded = None;
        } else if task.contains("Connect PC7") {
            self.pulse_to = pin(task);
        } else if task.starts_with("Take the wire off PB12") {
            self.stop_open = true;
        } else if task.starts_with("Connect PB12") {
            self.stop_open = false;
        } else {
            return false;
        }
        true
    }

    /// Noise of a sample, about normal.
    fn noise(&mut self) -> f64 {
        let uniform = (0..4).map(|_| {
            self.random = self
                .random
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            (self.random >> 33) as f64 / f64::from(u32::MAX >> 1) - 0.5
        });
        let size = if self.mistake == Some(BoardMistake::NoisyAnalog) {
            12.0
        } else {
            1.0
        };
        3.0_f64.sqrt() * NOISE * size * uniform.sum::<f64>()
    }

    fn pulse(&self, now: Time) -> bool {
        match self.tool {
            Pulses::Released => true,
            Pulses::Level(level) => level,
            Pulses::Frames { high, frame } => (now - self.tool_since) % frame < high,
        }
    }

    /// The level of an encoder's input: its pull-up, or the wire from PC7.
    fn encoder_input(&self, now: Time, pin: Pin) -> bool {
        let dead = self.has(BoardMistake::DeadPhase) && pin == ENCODER[1][1];
        dead || self.pulse_to != Some(pin) || self.pulse(now)
    }
}

/// A pin by its name, such as PA15.
fn pin_of(name: &str) -> Option<Pin> {
    let port = name.strip_prefix('P')?.bytes().next()?.checked_sub(b'A')?;
    Some(Pin(port, name.get(2..)?.parse().ok()?))
}

/// A bare board as the chip and a test share it.
#[derive(Clone, Debug)]
pub struct SharedBareBoard(Rc<RefCell<BareBoard>>);

impl SharedBareBoard {
    /// Shares a board.
    pub fn new(board: BareBoard) -> Self {
        Self(Rc::new(RefCell::new(board)))
    }

    /// Does a task of `fivebar board-test`; false if it is none.
    pub fn execute(&self, task: &str) -> bool {
        self.0.borrow_mut().execute(task)
    }
}

impl Wiring for SharedBareBoard {
    fn drive(&mut self, now: Time, outputs: &Outputs) {
        let mut board = self.0.borrow_mut();
        if board.tool != outputs.tool {
            board.tool = outputs.tool;
            board.tool_since = now;
        }
    }

    fn level(&mut self, _: Time, pin: Pin) -> Option<bool> {
        let board = self.0.borrow();
        if pin == STOP {
            let stuck = board.has(BoardMistake::StopStuck);
            return (stuck || board.wired && !board.stop_open).then_some(false);
        }
        if BRIDGE_FAULT.contains(&pin) {
            return board.wired.then_some(true);
        }
        (pin == SERIAL_IN).then_some(true)
    }

    fn encoder(&mut self, now: Time, joint: Joint, _: Time) -> i32 {
        let board = self.0.borrow();
        let joint = usize::from(joint == Joint::Joint4);
        let crossed = board.has(BoardMistake::EncodersExchanged);
        let pins = ENCODER[if crossed { 1 - joint } else { joint }];
        let [mut a, mut b] = pins.map(|pin| board.encoder_input(now, pin));
        if joint == 0 && board.has(BoardMistake::PhasesExchanged) {
            (a, b) = (b, a);
        }
        // The place in a period of four counts.
        match (a, b) {
            (false, false) => 0,
            (true, false) => 1,
            (true, true) => 2,
            (false, true) => 3,
        }
    }

    fn sample(&mut self, window: &SampleWindow, _: &[Edges; 2]) -> u16 {
        let mut board = self.0.borrow_mut();
        let exchanged = board.has(BoardMistake::AnalogExchanged);
        let channel = match window.channel {
            channel @ 10..12 if exchanged => 21 - channel,
            channel => channel,
        };
        if !board.wired || board.grounded == Some(channel) {
            return 0;
        }
        let reference = if board.has(BoardMistake::LowReference) {
            0.9
        } else {
            1.0
        };
        let code = MIDDLE / reference + board.noise();
        code.round().clamp(0.0, 4095.0) as u16
    }
}
