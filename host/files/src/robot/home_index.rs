//! `method = "index"` of `[homing]`: the encoders' index pulses after the home switches.

use super::{Actuator, HomeMethod, Robot};
use crate::refusal::{Key, Refusal};
use fivebar_firmware::settings::{HomingSettings, INDEX_MARGIN};
use fivebar_kinematics::five_bar::Joint;
use fivebar_plant::EncoderSide;
use std::f64::consts::TAU;

impl Actuator {
    /// Encoder counts from one index pulse to the next: in a turn of the encoder's shaft.
    pub(super) fn index_counts(&self) -> u32 {
        match self.encoder_side {
            EncoderSide::Motor => self.encoder_counts,
            // `as` saturates.
            EncoderSide::Joint => self.counts_per_turn().round() as u32,
        }
    }

    /// Encoder counts in a turn of the joint, whatever their sign.
    fn counts_per_turn(&self) -> f64 {
        f64::from(self.encoder_counts) * self.gear_ratio.abs()
    }

    /// The joint's angle from one index pulse to the next [rad].
    fn index_turn(&self) -> f64 {
        TAU * f64::from(self.index_counts()) / self.counts_per_turn()
    }
}

impl Robot {
    /// Where the switches close [rad], if that is not at home.
    pub(super) fn switches(&self, drives: &[Actuator; 2]) -> Option<[f64; 2]> {
        (self.homing.method == HomeMethod::Index).then(|| {
            self.homing.switch.unwrap_or(Joint::ALL.map(|joint| {
                let behind = 0.5 * drives[joint].index_turn();
                self.home[joint] + self.towards(joint) * behind
            }))
        })
    }

    /// 1 where a joint approaches its switch with a growing angle, else −1.
    fn towards(&self, joint: Joint) -> f64 {
        if self.homes_forward(joint) { 1.0 } else { -1.0 }
    }
}

/// A pulse must last long enough while a joint creeps, and be the first one after the switch for certain.
pub(super) fn check_index(robot: &Robot) -> Result<(), Refusal> {
    let Some(actuators) = &robot.actuators else {
        let reason = "needs both [[actuator]]: their encoders have the index pulses";
        return Err(Key::In("homing", "method").refused(reason));
    };
    let rate = robot.control.tick_rate;
    let fastest = actuators.each_ref().map(|actuator| {
        let counts = actuator.counts_per_turn() as f32;
        f64::from(HomingSettings::fastest_to_index(counts, rate as f32))
    });
    let fastest = fastest[0].min(fastest[1]);
    if robot.homing_speed() > fastest {
        let reason = format!(
            "must be at most {fastest:.3} rad/s for index pulses: at an eighth of it a pulse of one count \
             lasts four ticks"
        );
        return Err(Key::In("homing", "speed").refused(reason));
    }
    let switches = robot.switches(actuators).unwrap_or(robot.home);
    let key = Key::In("homing", "switch");
    for joint in Joint::ALL {
        let switch = switches[joint];
        let [low, high] = robot.limits.angle[joint];
        if !(low..=high).contains(&switch) {
            let reason = format!(
                "of {joint} is at {switch:.4} rad, outside limits.angle {low:?} to {high:?}: a switch \
                 beyond them is not reached (without the key it is half a turn of the encoder behind home)"
            );
            return Err(key.refused(reason));
        }
        let turn = actuators[joint].index_turn();
        let angle = robot.towards(joint) * (switch - robot.home[joint]);
        let share = angle / turn;
        let margin = f64::from(INDEX_MARGIN);
        if !(margin..=1.0 - margin).contains(&share) {
            let reason = format!(
                "of {joint} closes {share:.3} turns of the encoder behind its index pulse, home: it \
                 tells the pulse from the next one only between {margin} and {} turns, {:.4} to {:.4} rad; best in \
                 the middle",
                1.0 - margin,
                margin * turn,
                (1.0 - margin) * turn
            );
            return Err(key.refused(reason));
        }
    }
    Ok(())
}
