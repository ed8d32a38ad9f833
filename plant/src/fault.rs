//! Injected faults of the simulated arm.

use fivebar_kinematics::five_bar::Joint;

/// A fault to inject.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FaultKind {
    /// The encoder's counts stop.
    EncoderDead {
        /// The joint.
        joint: Joint,
    },
    /// The encoder's counts jump once.
    EncoderJump {
        /// The joint.
        joint: Joint,
        /// The change of the counts.
        counts: i32,
    },
    /// The encoder counts this many times as much from now on: −1 backwards, 0.5 half.
    EncoderGain {
        /// The joint.
        joint: Joint,
        /// The factor.
        gain: f64,
    },
    /// The encoder's counts stop for this many ticks, and are that late from then on.
    EncoderLate {
        /// The joint.
        joint: Joint,
        /// The number of ticks.
        ticks: u32,
    },
    /// One of the encoder's two channels stops: the counts go up and down by 1.
    EncoderChannelStuck {
        /// The joint.
        joint: Joint,
    },
    /// Noise on the encoder's counts.
    EncoderNoise {
        /// The joint.
        joint: Joint,
        /// The greatest error of the counts.
        counts: i32,
    },
    /// The encoder's index output no longer follows its disc.
    IndexStuck {
        /// The joint.
        joint: Joint,
        /// Whether it stays high.
        high: bool,
    },
    /// The home switch no longer follows the joint.
    SwitchStuck {
        /// The joint.
        joint: Joint,
        /// Whether it stays pressed.
        pressed: bool,
    },
    /// The motor's lead breaks.
    MotorDisconnected {
        /// The joint.
        joint: Joint,
    },
    /// Half of the motor's turns are shorted: they brake, the others drive.
    WindingShorted {
        /// The joint.
        joint: Joint,
    },
    /// The joint jams.
    MotorStalled {
        /// The joint.
        joint: Joint,
    },
    /// The current sensor's zero shifts.
    CurrentOffset {
        /// The joint.
        joint: Joint,
        /// The shift [A].
        amperes: f64,
    },
    /// The current sensor shows no current.
    CurrentDead {
        /// The joint.
        joint: Joint,
    },
    /// The current sensor shows this many times the current: −1 reversed, 0.5 half.
    CurrentGain {
        /// The joint.
        joint: Joint,
        /// The factor.
        gain: f64,
    },
    /// The current sensor's output stays where it is for this current.
    CurrentStuck {
        /// The joint.
        joint: Joint,
        /// The current [A].
        amperes: f64,
    },
    /// The current sensor's output is late from now on.
    CurrentLate {
        /// The joint.
        joint: Joint,
        /// The number of ticks.
        ticks: u32,
    },
    /// The bus voltage changes: it sags or rises.
    BusVoltage {
        /// The new voltage [V].
        volts: f64,
    },
    /// The bus voltage's sensor stays at its present reading.
    BusSensorStuck,
    /// The bus voltage's sensor shows this many times the voltage.
    BusSensorGain {
        /// The factor.
        gain: f64,
    },
    /// A bridge drives its motor in the direction of positive duties only.
    BridgeOneDirection {
        /// The joint.
        joint: Joint,
    },
    /// A bridge's transistor is shorted: while it is on, its motor gets the whole bus voltage.
    BridgeShorted {
        /// The joint.
        joint: Joint,
    },
    /// A bridge keeps its present duty.
    DutyStuck {
        /// The joint.
        joint: Joint,
    },
    /// A bridge raises its fault output and turns itself off.
    DriverFault {
        /// The joint.
        joint: Joint,
    },
    /// The fault output's wire is shorted to ground: a fault is reported, and the bridge works.
    DriverFaultStuck {
        /// The joint.
        joint: Joint,
    },
    /// The wire of a bridge's fault output breaks: it reads as a fault, and the bridge goes on.
    DriverFaultOpen {
        /// The joint.
        joint: Joint,
    },
    /// The emergency stop is pressed.
    EmergencyStop,
    /// The emergency stop's contact is welded: pressing it has no effect.
    EmergencyStopWelded,
    /// The contactor's contact is welded: the emergency stop does not take the bridges' supply away.
    ContactorWelded,
    /// A brake stays engaged.
    BrakeStuck {
        /// The joint.
        joint: Joint,
    },
    /// A brake engages so much later than before.
    BrakeLate {
        /// The joint.
        joint: Joint,
        /// The additional time [s].
        seconds: f64,
    },
    /// A brake loses its torque.
    BrakeFails {
        /// The joint.
        joint: Joint,
    },
    /// The coupling between motor and joint slips from now on: the joint turns less than the motor.
    CouplingSlips {
        /// The joint.
        joint: Joint,
        /// The share of the motor's motion that is lost, 0 to 1.
        share: f64,
    },
    /// The belt of a drive that has a stiffness breaks.
    BeltBreaks {
        /// The joint.
        joint: Joint,
    },
    /// A stepper's driver misses the next pulses, of this many full steps.
    StepLost {
        /// The joint.
        joint: Joint,
        /// The full steps.
        steps: u32,
    },
    /// One phase of a stepper is open: it has no current.
    PhaseOpen {
        /// The joint.
        joint: Joint,
    },
    /// A drive on a bus takes no part on it any more: it neither answers nor hears.
    CanSilent {
        /// The joint.
        joint: Joint,
    },
    /// A drive on a bus resets.
    CanReset {
        /// The joint.
        joint: Joint,
    },
    /// The controller has left the bus after too many errors.
    CanBusOff,
    /// The payload gets heavier, or lighter.
    PayloadChanges {
        /// The change of its mass [kg].
        kilograms: f64,
    },
    /// The tool is caught: it stays where it is.
    ToolCaught,
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
