//! Things that go wrong on a real arm, at a chosen time.

/// What goes wrong. `joint` is an index, 0 for joint 1 (at A) and 1 for joint 4 (at E).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FaultKind {
    /// The encoder's counts stop.
    EncoderDead {
        /// 0 or 1.
        joint: usize,
    },
    /// The encoder's counts jump once.
    EncoderJump {
        /// 0 or 1.
        joint: usize,
        /// By how much.
        counts: i32,
    },
    /// The home switch no longer follows the joint.
    SwitchStuck {
        /// 0 or 1.
        joint: usize,
        /// What it says.
        pressed: bool,
    },
    /// The motor's lead breaks.
    MotorDisconnected {
        /// 0 or 1.
        joint: usize,
    },
    /// The joint jams.
    MotorStalled {
        /// 0 or 1.
        joint: usize,
    },
    /// The current sensor's zero shifts.
    CurrentOffset {
        /// 0 or 1.
        joint: usize,
        /// By how much [A].
        amperes: f64,
    },
    /// The bus voltage changes: sags, or is pumped up.
    BusVoltage {
        /// To this [V].
        volts: f64,
    },
    /// A bridge raises its fault output and turns itself off.
    DriverFault {
        /// 0 or 1.
        joint: usize,
    },
    /// Somebody presses the emergency stop.
    EmergencyStop,
    /// The controller is late once: the arm goes on with its last command meanwhile.
    TicksMissed {
        /// By how many ticks.
        ticks: u32,
    },
}

/// A fault and its time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlantFault {
    /// When [s].
    pub at: f64,
    /// What.
    pub kind: FaultKind,
}
