//! The pins: what is wired to them, and the pulses of the servos.

/// The pins of the servos of joints 1 and 4, of the emergency stop and of the brake.
pub const SERVO: [u32; 2] = [2, 3];
pub(crate) const STOP: u32 = 5;
pub(crate) const BRAKE: u32 = 6;

/// A pulse of a servo: its first cycle, its length [cycles], and its joint, 0 or 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pulse {
    /// The cycle of its rising edge.
    pub from: u64,
    /// Its length [cycles].
    pub cycles: u64,
    /// Its joint.
    pub joint: usize,
}

/// What is wired to the pins.
#[derive(Default)]
pub struct Wires {
    /// The emergency stop is pressed.
    pub stop: bool,
    /// The pulses that have ended.
    pub pulses: Vec<Pulse>,
    /// The last change of a servo's pin [cycle].
    pub last_edge: u64,
    /// The cycle in which the pulse that lasts began.
    began: [Option<u64>; 2],
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

    /// Takes the levels of both pins in a cycle.
    pub(crate) fn drive(&mut self, now: u64, levels: [bool; 2]) {
        for (joint, high) in levels.into_iter().enumerate() {
            match (self.began[joint], high) {
                (None, true) => {
                    self.began[joint] = Some(now);
                    self.last_edge = now;
                }
                (Some(from), false) => {
                    self.began[joint] = None;
                    self.last_edge = now;
                    let cycles = now - from;
                    self.pulses.push(Pulse {
                        from,
                        cycles,
                        joint,
                    });
                }
                _ => {}
            }
        }
    }
}
