//! Mistakes in the wiring, and in what controller and drives are told of each other: what reaches the controller of the
//! sensors, and what reaches the motors of its commands.

mod brushed;
mod steps;

use fivebar_firmware::safety::DriveKind;
use serde::{Deserialize, Serialize};

pub(crate) use steps::StepWires;

/// Wiring mistakes; pairs are of joint 1 and joint 4. The default is none. [`Wiring::keys`] says with which kinds of drive
/// each can be made.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct Wiring {
    /// The motor of joint 1 is on the bridge of joint 4, or on its driver, or the servo on its pulses, and vice versa.
    pub motors_swapped: bool,
    /// The same of the encoders.
    pub encoders_swapped: bool,
    /// The motor's leads are exchanged, or those of one phase; a servo or a drive on a bus turns the other way.
    pub motor_reversed: [bool; 2],
    /// The encoder's channels are exchanged: it counts backwards.
    pub encoder_reversed: [bool; 2],
    /// The current sensor's ends are exchanged.
    pub current_reversed: [bool; 2],
    /// The motor is not connected.
    pub motor_dead: [bool; 2],
    /// The encoder is not connected.
    pub encoder_dead: [bool; 2],
    /// The encoder's index output is not connected: the board's pull-up keeps it high.
    pub index_dead: [bool; 2],
    /// The current sensor is not connected: it reads no current.
    pub current_dead: [bool; 2],
    /// The bridge has no current limit of its own: no resistor at IPROPI, or no reference at VREF.
    pub bridge_limit_missing: [bool; 2],
    /// Excess of the encoder's counts per turn of the joint, as a share: 1 is twice as many.
    pub counts: [f64; 2],
    /// The home switch of joint 1 is on the input of joint 4, and vice versa.
    pub switches_swapped: bool,
    /// The home switch opens where it should close.
    pub switch_inverted: [bool; 2],
    /// The home switch is not connected: its input reads pressed.
    pub switch_dead: [bool; 2],
    /// The enable wire is not connected: the resistor at the bridge or driver keeps it off.
    pub enable_dead: [bool; 2],
    /// The driver has power where it should have none, and none where it should.
    pub enable_inverted: [bool; 2],
    /// One phase of the motor is not connected.
    pub phase_dead: [bool; 2],
    /// One lead of a phase is exchanged with one of the other phase: each phase lies between both bridges of the driver.
    pub phases_crossed: [bool; 2],
    /// The driver's micro-steps in a full step, over those of the robot file: with 2 the motor turns half as far.
    pub microsteps: [f64; 2],
    /// The driver's current over the rated current.
    pub current_share: [f64; 2],
    /// The supply's voltage under load, over that of the robot file.
    pub supply_share: f64,
    /// The pulses do not reach the servo.
    pub signal_dead: [bool; 2],
    /// The drive of joint 1 has the number of that of joint 4 on the bus, and vice versa.
    pub nodes_swapped: bool,
    /// The drive has the number of the other one.
    pub node_of_other: [bool; 2],
    /// The share of the frames to the drive that it does not receive: a termination is missing.
    pub orders_lost: [f64; 2],
    /// The share of the drive's frames that the controller does not receive.
    pub answers_lost: [f64; 2],
    /// Excess of the torque that the drive makes over what it takes it for, as a share: its torque constant is wrong.
    pub torque_constant: [f64; 2],
    /// The angle of the joint by which the zero of a drive that knows its angle is off [rad]: it has lost its offset.
    pub zero_shift: [f64; 2],
    /// The drive is set to another mode of control.
    pub mode_wrong: [bool; 2],
    /// A wire of the bus is not connected to the drive.
    pub bus_dead: [bool; 2],
    /// The drive has no supply.
    pub supply_dead: [bool; 2],
}

impl Default for Wiring {
    fn default() -> Self {
        let (no, none) = ([false; 2], [0.0; 2]);
        Self {
            motors_swapped: false,
            encoders_swapped: false,
            motor_reversed: no,
            encoder_reversed: no,
            current_reversed: no,
            motor_dead: no,
            encoder_dead: no,
            index_dead: no,
            current_dead: no,
            bridge_limit_missing: no,
            counts: none,
            switches_swapped: false,
            switch_inverted: no,
            switch_dead: no,
            enable_dead: no,
            enable_inverted: no,
            phase_dead: no,
            phases_crossed: no,
            microsteps: [1.0; 2],
            current_share: [1.0; 2],
            supply_share: 1.0,
            signal_dead: no,
            nodes_swapped: false,
            node_of_other: no,
            orders_lost: none,
            answers_lost: none,
            torque_constant: none,
            zero_shift: none,
            mode_wrong: no,
            bus_dead: no,
            supply_dead: no,
        }
    }
}

/// A key of [`Wiring`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WiringKey {
    /// Its name.
    pub name: &'static str,
    /// Whether the mistake is made.
    pub is_made: bool,
    /// The kinds of drive with which it can be made.
    pub kinds: &'static [DriveKind],
}

/// Which kinds of drive have the part.
mod kinds {
    use super::DriveKind::{self, Brushed, CanTorque, HobbyServo, Stepper, StepperWithEncoder};

    pub(super) const OWN_OUTPUTS: &[DriveKind] =
        &[Brushed, Stepper, StepperWithEncoder, HobbyServo];
    pub(super) const ALL: &[DriveKind] = &DriveKind::ALL;
    pub(super) const ENCODERS: &[DriveKind] = &[Brushed, StepperWithEncoder];
    pub(super) const BRUSHED: &[DriveKind] = &[Brushed];
    pub(super) const MOTORS: &[DriveKind] = &[Brushed, Stepper, StepperWithEncoder, CanTorque];
    pub(super) const ENABLES: &[DriveKind] = &[Brushed, Stepper, StepperWithEncoder];
    pub(super) const STEPPERS: &[DriveKind] = &[Stepper, StepperWithEncoder];
    pub(super) const WEAK: &[DriveKind] = &[Stepper, StepperWithEncoder, HobbyServo];
    pub(super) const SERVOS: &[DriveKind] = &[HobbyServo];
    pub(super) const BUS: &[DriveKind] = &[CanTorque];
}

impl Wiring {
    /// The number of keys.
    pub const KEYS: usize = 31;

    /// Every key. A field without a line here does not compile.
    pub fn keys(&self) -> [WiringKey; Self::KEYS] {
        use kinds::{
            ALL, BRUSHED, BUS, ENABLES, ENCODERS, MOTORS, OWN_OUTPUTS, SERVOS, STEPPERS, WEAK,
        };
        let Self {
            motors_swapped,
            encoders_swapped,
            motor_reversed,
            encoder_reversed,
            current_reversed,
            motor_dead,
            encoder_dead,
            index_dead,
            current_dead,
            bridge_limit_missing,
            counts,
            switches_swapped,
            switch_inverted,
            switch_dead,
            enable_dead,
            enable_inverted,
            phase_dead,
            phases_crossed,
            microsteps,
            current_share,
            supply_share,
            signal_dead,
            nodes_swapped,
            node_of_other,
            orders_lost,
            answers_lost,
            torque_constant,
            zero_shift,
            mode_wrong,
            bus_dead,
            supply_dead,
        } = *self;
        let key = |name, is_made, kinds| WiringKey {
            name,
            is_made,
            kinds,
        };
        let any = |pair: [bool; 2]| pair != [false; 2];
        let off = |pair: [f64; 2], right: f64| pair != [right; 2];
        [
            key("motors_swapped", motors_swapped, OWN_OUTPUTS),
            key("encoders_swapped", encoders_swapped, ENCODERS),
            key("motor_reversed", any(motor_reversed), ALL),
            key("encoder_reversed", any(encoder_reversed), ENCODERS),
            key("current_reversed", any(current_reversed), BRUSHED),
            key("motor_dead", any(motor_dead), MOTORS),
            key("encoder_dead", any(encoder_dead), ENCODERS),
            key("index_dead", any(index_dead), ENCODERS),
            key("current_dead", any(current_dead), BRUSHED),
            key("bridge_limit_missing", any(bridge_limit_missing), BRUSHED),
            key("counts", off(counts, 0.0), ENCODERS),
            key("switches_swapped", switches_swapped, MOTORS),
            key("switch_inverted", any(switch_inverted), MOTORS),
            key("switch_dead", any(switch_dead), MOTORS),
            key("enable_dead", any(enable_dead), ENABLES),
            key("enable_inverted", any(enable_inverted), STEPPERS),
            key("phase_dead", any(phase_dead), STEPPERS),
            key("phases_crossed", any(phases_crossed), STEPPERS),
            key("microsteps", off(microsteps, 1.0), STEPPERS),
            key("current_share", off(current_share, 1.0), STEPPERS),
            key("supply_share", supply_share != 1.0, WEAK),
            key("signal_dead", any(signal_dead), SERVOS),
            key("nodes_swapped", nodes_swapped, BUS),
            key("node_of_other", any(node_of_other), BUS),
            key("orders_lost", off(orders_lost, 0.0), BUS),
            key("answers_lost", off(answers_lost, 0.0), BUS),
            key("torque_constant", off(torque_constant, 0.0), BUS),
            key("zero_shift", off(zero_shift, 0.0), BUS),
            key("mode_wrong", any(mode_wrong), BUS),
            key("bus_dead", any(bus_dead), BUS),
            key("supply_dead", any(supply_dead), BUS),
        ]
    }

    /// Checks the numbers.
    ///
    /// # Errors
    /// The first key whose value is not valid, and why.
    pub fn check(&self) -> Result<(), (&'static str, String)> {
        // A count of −1 would be an encoder that is not connected, which has a key of its own.
        if !self
            .counts
            .iter()
            .all(|&share| share > -1.0 && share.is_finite())
        {
            return Err(("counts", "must be above -1, and finite".into()));
        }
        for (name, values, [least, most], unit) in [
            ("microsteps", &self.microsteps[..], [1.0 / 256.0, 256.0], ""),
            ("current_share", &self.current_share, [0.0, 2.0], ""),
            ("supply_share", &[self.supply_share], [0.0, 2.0], ""),
            ("orders_lost", &self.orders_lost, [0.0, 1.0], ""),
            ("answers_lost", &self.answers_lost, [0.0, 1.0], ""),
            ("torque_constant", &self.torque_constant, [-0.9, 9.0], ""),
            ("zero_shift", &self.zero_shift, [-3.2, 3.2], " rad"),
        ] {
            for value in values {
                if !(least <= *value && *value <= most) {
                    let reason = format!("is {least:?} to {most:?}{unit}, not {value:?}");
                    return Err((name, reason));
                }
            }
        }
        Ok(())
    }
}

/// Exchanges both if `swapped`.
fn exchange<T: Copy>([a, b]: [T; 2], swapped: bool) -> [T; 2] {
    if swapped { [b, a] } else { [a, b] }
}
