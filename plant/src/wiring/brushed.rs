//! The wires of brushed motors and of the sensors on the board's own inputs.
//!
//! A current is measured in the bridge, so it belongs to the bridge wherever the motor is. A motor
//! with exchanged leads turns against its voltage, and its bridge measures its current negated.

use super::{Wiring, exchange};
use fivebar_firmware::drives::{BrushedCommand, BrushedSample};
use fivebar_firmware::{ActuatorCommand, SensorSample};
use fivebar_kinematics::five_bar::Joint;

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
            enable: Joint::ALL.map(|j| enable[j] && !self.motor_dead[j] && !self.enable_dead[j]),
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
        let home = exchange(sample.home, self.switches_swapped);
        let home = Joint::ALL.map(|j| self.switch_dead[j] || home[j] != self.switch_inverted[j]);
        SensorSample {
            counts: exchange(counts, self.encoders_swapped),
            home,
            index: exchange(index, self.encoders_swapped),
            drives: BrushedSample {
                current,
                ..sample.drives
            },
            ..sample
        }
    }
}
