//! The pins: what is wired to them, and the pulses of servos and of steps.

/// The pins of the pulses of joints 1 and 4, and of the emergency stop, the brake, and what stepper drivers have besides.
pub const PULSES: [u32; 2] = [2, 3];
pub(crate) const STOP: u32 = 5;
pub(crate) const BRAKE: u32 = 6;
pub(crate) const DIRECTION: [u32; 2] = [7, 8];
pub(crate) const ENABLE: [u32; 2] = [9, 10];
const HOME: [u32; 2] = [11, 12];
const FAULT: [u32; 2] = [13, 14];
/// Pins to which something with a level of its own is wired: a resistor at each driver pulls its enable up.
pub(crate) const WIRED: u32 = ENABLES | 1 << STOP | 0b1111 << HOME[0];
const ENABLES: u32 = 1 << ENABLE[0] | 1 << ENABLE[1];

/// A pulse of a servo, or a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pulse {
    /// The cycle of its rising edge.
    pub from: u64,
    /// Its length [cycles].
    pub cycles: u64,
    /// Its joint, 0 or 1.
    pub joint: usize,
    /// The level of its joint's direction pin.
    pub forwards: bool,
}

/// What is wired to the pins.
#[derive(Default)]
pub struct Wires {
    /// The emergency stop is pressed.
    pub stop: bool,
    /// The home switches are pressed.
    pub home: [bool; 2],
    /// The stepper drivers report a fault.
    pub fault: [bool; 2],
    /// The pulses that have ended.
    pub pulses: Vec<Pulse>,
    /// The changes of the pins of directions: the cycle and the joint.
    pub turns: Vec<(u64, usize)>,
    /// Rising edges of the pulses that no arm has taken: forwards less backwards.
    pub edges: [i32; 2],
    /// The stepper drivers have power.
    pub powered: [bool; 2],
    /// The last change of a pulse's pin [cycle].
    pub last_edge: u64,
    /// The cycle in which the pulse that lasts began.
    began: [Option<u64>; 2],
    forwards: [bool; 2],
    /// The levels of all pins in the last cycle.
    levels: u32,
}

impl Wires {
    /// Whether a pulse lasts.
    pub fn pulse_lasts(&self, joint: usize) -> bool {
        self.began[joint].is_some()
    }

    /// The cycle in which the pulse that lasts began.
    pub fn pulse_began(&self, joint: usize) -> Option<u64> {
        self.began[joint]
    }

    /// The levels of the pins that something wired drives.
    pub(crate) fn wired(&self) -> u32 {
        let bit = |pin: u32, high: bool| u32::from(high) << pin;
        let [home1, home4] = self.home;
        let [fault1, fault4] = self.fault;
        ENABLES
            | bit(STOP, self.stop)
            | bit(HOME[0], home1)
            | bit(HOME[1], home4)
            | bit(FAULT[0], fault1)
            | bit(FAULT[1], fault4)
    }

    /// Takes the levels of all pins in a cycle.
    pub(crate) fn drive(&mut self, now: u64, levels: u32) {
        if levels == self.levels {
            return;
        }
        self.levels = levels;
        let high = |pin: u32| levels >> pin & 1 != 0;
        self.powered = ENABLE.map(|pin| !high(pin));
        for joint in 0..2 {
            let forwards = high(DIRECTION[joint]);
            if forwards != self.forwards[joint] {
                self.turns.push((now, joint));
                self.forwards[joint] = forwards;
            }
            match (self.began[joint], high(PULSES[joint])) {
                (None, true) => {
                    self.began[joint] = Some(now);
                    self.last_edge = now;
                    self.edges[joint] += if forwards { 1 } else { -1 };
                }
                (Some(from), false) => {
                    self.began[joint] = None;
                    self.last_edge = now;
                    self.pulses.push(Pulse {
                        from,
                        cycles: now - from,
                        joint,
                        forwards,
                    });
                }
                _ => {}
            }
        }
    }
}
