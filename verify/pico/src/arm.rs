//! The simulated arm behind the pins.

use crate::pins::Wires;
use fivebar_firmware::ArmCommand;
use fivebar_firmware::drives::StepCommand;
use fivebar_plant::{HobbyServoPlant, StepperPlant};

/// Cycles after which the arm advances: a tick of the controller [s].
pub(crate) const PERIOD: u64 = 15_000;
const SECONDS: f64 = 1e-4;

/// An arm.
pub trait Arm {
    /// Advances the arm by 100 µs with what the pins did, and sets what is wired to them.
    fn advance(&mut self, wires: &mut Wires, brake_is_released: bool);
}

/// An arm with stepper drivers, which count the edges of their steps.
pub struct StepperArm {
    /// The arm.
    pub plant: StepperPlant,
}

impl StepperArm {
    /// An arm at rest.
    pub fn new(plant: StepperPlant) -> Self {
        Self { plant }
    }
}

impl Arm for StepperArm {
    fn advance(&mut self, wires: &mut Wires, brake_is_released: bool) {
        let command = ArmCommand {
            drives: StepCommand {
                steps: std::mem::take(&mut wires.edges),
            },
            enable: wires.powered.map(|powered| powered && !wires.stop),
            brake: !brake_is_released,
            tool: 0,
        };
        self.plant.step(&command, SECONDS);
        let sample = self.plant.sense();
        wires.home = sample.home;
        wires.fault = sample.driver_fault;
    }
}

/// An arm with hobby servos, which turn to the lengths of their pulses. A servo has its length when it ends; this one has it a
/// little later, and then in frames of its own, as long as those of the pulses.
pub struct ServoArm {
    /// The arm.
    pub plant: HobbyServoPlant,
    home: [f64; 2],
    unit: f64,
    /// Pulses that have been read.
    read: usize,
    axes: [Servo; 2],
}

/// What a servo gets.
#[derive(Clone, Copy, Default)]
struct Servo {
    /// Units of the last pulse, and those that the plant has.
    last: i32,
    has: i32,
    /// Ticks since it ended.
    since: u32,
    /// It has pulses.
    on: bool,
}

/// Ticks behind the end of a pulse in which its length may change in the plant: less than a frame, and more than a pulse
/// changes its length.
const LATE: u32 = 20;
/// Ticks without a pulse behind which a servo has none.
const SILENT: u32 = 300;

impl ServoArm {
    /// An arm at rest, with these lengths at home and this unit [cycles].
    pub fn new(plant: HobbyServoPlant, home: [f64; 2], unit: f64) -> Self {
        Self {
            plant,
            home,
            unit,
            read: 0,
            axes: [Servo::default(); 2],
        }
    }
}

impl Arm for ServoArm {
    fn advance(&mut self, wires: &mut Wires, brake_is_released: bool) {
        for axis in &mut self.axes {
            axis.since += 1;
            axis.on &= axis.since < SILENT;
        }
        self.read = self.read.min(wires.pulses.len());
        for pulse in &wires.pulses[self.read..] {
            let units = (pulse.cycles as f64 - self.home[pulse.joint]) / self.unit;
            let axis = &mut self.axes[pulse.joint];
            (axis.last, axis.since) = (units.round() as i32, 0);
        }
        self.read = wires.pulses.len();
        let mut steps = [0; 2];
        for (axis, steps) in self.axes.iter_mut().zip(&mut steps) {
            if axis.since == LATE {
                *steps = axis.last - axis.has;
                (axis.has, axis.on) = (axis.last, true);
            }
        }
        let enable = self.axes.map(|axis| axis.on);
        let command = ArmCommand {
            drives: StepCommand { steps },
            enable,
            brake: !brake_is_released,
            tool: 0,
        };
        self.plant.step(&command, SECONDS);
    }
}
