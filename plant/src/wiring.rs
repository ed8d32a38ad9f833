//! Mistakes in the wiring and in what the controller is told of encoders: what reaches the
//! controller of the sensors, and what reaches the motors of its commands.
//!
//! A current is measured in the bridge, so it belongs to the bridge wherever the motor is. A motor
//! with exchanged leads turns against its voltage, and its bridge measures its current negated.

use fivebar_firmware::drives::{BrushedCommand, BrushedSample};
use fivebar_firmware::{ActuatorCommand, SensorSample};
use fivebar_kinematics::five_bar::Joint;
use serde::{Deserialize, Serialize};

/// Wiring mistakes; pairs are of joint 1 and joint 4. The default is none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct Wiring {
    /// The motor of joint 1 is on the bridge of joint 4, and vice versa.
    pub motors_swapped: bool,
    /// The same of the encoders.
    pub encoders_swapped: bool,
    /// The motor's leads are exchanged.
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
}

/// Exchanges both if `swapped`.
fn exchange<T: Copy>([a, b]: [T; 2], swapped: bool) -> [T; 2] {
    if swapped { [b, a] } else { [a, b] }
}

impl Wiring {
    /// What the motors get of a command, in the order of the joints.
    pub(crate) fn driven(&self, command: &ActuatorCommand) -> ActuatorCommand {
        let duty = exchange(command.drives.duty, self.motors_swapped);
        let enable = exchange(command.enable, self.motors_swapped);
        ActuatorCommand {
            drives: BrushedCommand {
                duty: Joint::ALL.map(|j| {
                    if self.motor_reversed[j] {
                        -duty[j]
                    } else {
                        duty[j]
                    }
                }),
            },
            enable: Joint::ALL.map(|j| enable[j] && !self.motor_dead[j]),
            ..*command
        }
    }

    /// What the controller gets of a sample in the order of the joints. `origin` are the counts
    /// from which encoders count, `zero` the codes of no current.
    pub(crate) fn seen(
        &self,
        sample: SensorSample,
        origin: [i32; 2],
        zero: [f64; 2],
    ) -> SensorSample {
        let counts = Joint::ALL.map(|j| {
            let turned = f64::from(sample.counts[j].wrapping_sub(origin[j]));
            let share = 1.0 + self.counts[j];
            let signed = if self.encoder_reversed[j] {
                -share
            } else {
                share
            };
            let kept = if self.encoder_dead[j] { 0.0 } else { signed };
            origin[j].wrapping_add((kept * turned).floor() as i64 as i32)
        });
        // The codes of the motors, then of the bridges.
        let mirrored = |code: u16, zero: f64| (2.0 * zero - f64::from(code)).clamp(0.0, 4095.0);
        let motors = Joint::ALL.map(|j| match self.motor_reversed[j] {
            true => mirrored(sample.drives.current[j], zero[j]) as u16,
            false => sample.drives.current[j],
        });
        let bridges = exchange(motors, self.motors_swapped);
        let current = Joint::ALL.map(|j| match (self.current_dead[j], self.current_reversed[j]) {
            (true, _) => zero[j] as u16,
            (false, true) => mirrored(bridges[j], zero[j]) as u16,
            (false, false) => bridges[j],
        });
        let index =
            Joint::ALL.map(|j| self.index_dead[j] || sample.index[j] && !self.encoder_dead[j]);
        SensorSample {
            counts: exchange(counts, self.encoders_swapped),
            index: exchange(index, self.encoders_swapped),
            drives: BrushedSample {
                current,
                ..sample.drives
            },
            ..sample
        }
    }
}
