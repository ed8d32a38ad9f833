//! Injected faults of the simulated arm.

/// A fault to inject. `joint` is an index, 0 for joint 1 (at A) and 1 for joint 4 (at E).
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
        /// The change of the counts.
        counts: i32,
    },
    /// The home switch no longer follows the joint.
    SwitchStuck {
        /// 0 or 1.
        joint: usize,
        /// Whether it stays pressed.
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
        /// The shift [A].
        amperes: f64,
    },
    /// The bus voltage changes: it sags or rises.
    BusVoltage {
        /// The new voltage [V].
        volts: f64,
    },
    /// A bridge raises its fault output and turns itself off.
    DriverFault {
        /// 0 or 1.
        joint: usize,
    },
    /// The emergency stop is pressed.
    EmergencyStop,
    /// The controller misses ticks once; the arm moves on with the last outputs.
    TicksMissed {
        /// The number of ticks.
        ticks: u32,
    },
}

/// A fault and its time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlantFault {
    /// The time [s].
    pub at: f64,
    /// The fault.
    pub kind: FaultKind,
}
