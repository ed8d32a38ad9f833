//! Hobby servos: what is known of them, and their checks.
//!
//! A servo knows its angle and closes a loop of its own. It tells nothing, so motions keep well below what it can: a share
//! of its speed, and a share of the torque that it has at the joint's greatest speed.

use super::actuator::{Actuator, HobbyServo};
use super::value::{positive, single};
use super::{HomeMethod, Robot};
use crate::refusal::{Key, Refusal, Refusals};
use fivebar_firmware::settings::{ServoPulse, Settings};
use fivebar_kinematics::five_bar::Joint;
use fivebar_plant::HobbyServo as Simulated;

/// Pulses in a second that every servo takes [Hz].
pub(super) const FRAME_RATE: f64 = 50.0;
/// If the file has none.
pub(super) const TORQUE_SHARE: f64 = 0.5;
/// The share of its greatest speed that a motion may take: with the rest the servo catches up.
pub(super) const SPEED_SHARE: f64 = 0.8;
/// Time constant of a small brushed motor behind its gear, without load [s].
const MECHANICAL: f64 = 0.02;
/// The least difference of both widths [s].
const LEAST_SPAN: f64 = 0.2e-3;
/// Angles between both widths [rad].
const TRAVELS: [f64; 2] = [0.5, 7.0];
/// Dead bands [s]; data sheets have 0.4 µs to 20 µs.
const DEAD_BANDS: [f64; 2] = [0.2e-6, 50e-6];

impl HobbyServo {
    /// The inertia of motor and gears at the shaft, typical for this torque and speed [kg·m²].
    pub(super) fn typical_inertia(&self) -> f64 {
        MECHANICAL * self.stall_torque / self.max_speed
    }

    /// The torque at the shaft's speed [rad/s], over the stall torque.
    pub(super) fn torque_at_speed(&self, speed: f64) -> f64 {
        (1.0 - speed / self.max_speed).max(0.0)
    }

    /// Units of the timer that makes the pulses in a turn of the shaft.
    pub(super) fn units_per_turn(&self) -> u32 {
        // `as` saturates; what is out of range is refused.
        self.simulated(1.0, 0.0, 0.0).units_per_turn() as u32
    }

    /// With this gear ratio, this inertia [kg·m²], and with home so far from the angle at the middle of the widths [rad].
    fn simulated(&self, gear_ratio: f64, rotor_inertia: f64, home: f64) -> Simulated {
        let [one, other] = self.pulse_range;
        let per_angle = (other - one) / self.travel;
        Simulated {
            gear_ratio,
            rotor_inertia,
            pulse_range: self.pulse_range,
            travel: self.travel,
            home_width: 0.5 * (one + other) + gear_ratio * home * per_angle,
            dead_band: self.dead_band,
            frame_rate: self.frame_rate,
            max_speed: self.max_speed,
            stall_torque: self.stall_torque,
        }
    }

    /// The joint's angle at the middle of the widths [rad].
    fn middle(&self, [least, greatest]: [f64; 2]) -> f64 {
        self.middle_angle.unwrap_or(0.5 * (least + greatest))
    }
}

impl Robot {
    /// The joints' angles at the middle of the servos' widths [rad]; none if its joints are turned by others.
    pub fn middle_angles(&self) -> Option<[f64; 2]> {
        let actuators = self.actuators.as_ref()?;
        let middle = |j: Joint| {
            let servo = actuators[j].hobby_servo()?;
            Some(servo.middle(self.limits.angle[j]))
        };
        Some([middle(Joint::Joint1)?, middle(Joint::Joint4)?])
    }

    /// Writes the pulses of its hobby servos into the controller's settings; of other motors it writes nothing.
    pub(super) fn put_pulses(&self, settings: &mut Settings) {
        let servos = self.hobby_servos().into_iter().flatten();
        for (servo, axis) in servos.zip(&mut settings.axes) {
            let pulse = ServoPulse {
                home_width: single(servo.home_width),
                frame_rate: single(servo.frame_rate),
            };
            pulse.put(axis);
        }
    }

    /// Its hobby servos, for the simulated arm; none if its joints are turned by others.
    pub fn hobby_servos(&self) -> Option<[Simulated; 2]> {
        let servo = |j: Joint| {
            let actuator = self.actuators?[j];
            let servo = actuator.hobby_servo()?;
            let home = self.home[j] - servo.middle(self.limits.angle[j]);
            Some(servo.simulated(actuator.gear_ratio, actuator.rotor_inertia, home))
        };
        Some([servo(Joint::Joint1)?, servo(Joint::Joint4)?])
    }
}

/// Checks each servo by itself.
pub(super) fn check_servo(index: usize, actuator: &Actuator, refusals: &mut Refusals) {
    let Some(servo) = actuator.hobby_servo() else {
        return;
    };
    let key = |name| Key::Of("actuator", index, name);
    for (name, value) in [
        ("max_speed", servo.max_speed),
        ("stall_torque", servo.stall_torque),
    ] {
        refusals.note(positive(key(name), value));
    }
    let [one, other] = servo.pulse_range;
    let [least, greatest] = ServoPulse::WIDTHS.map(|width| f64::from(width) / 1e6);
    let is_width = |width: f64| (least..=greatest).contains(&width);
    if !is_width(one) || !is_width(other) || other - one < LEAST_SPAN {
        let reason = format!(
            "must be two widths from {least:?} to {greatest:?} s, the second {LEAST_SPAN:?} s longer at least, not \
             [{one:?}, {other:?}]: [0.0005, 0.0025] is usual; a servo that turns against its joint has a negative \
             `gear_ratio`"
        );
        refusals.add(key("pulse_range"), reason);
    }
    for (name, value, [least, greatest], unit, of) in [
        (
            "travel",
            servo.travel,
            TRAVELS,
            "rad",
            "the angle between both widths of `pulse_range`",
        ),
        (
            "frame_rate",
            servo.frame_rate,
            ServoPulse::FRAME_RATES.map(f64::from),
            "Hz",
            "every servo takes 50 Hz, digital ones more",
        ),
        (
            "dead_band",
            servo.dead_band,
            DEAD_BANDS,
            "s",
            "data sheets have 1e-6 to 10e-6 s",
        ),
        (
            "torque_share",
            servo.torque_share,
            [0.05, 2.0],
            "of the torque",
            "0.5 leaves room for what is not known",
        ),
    ] {
        if !(least..=greatest).contains(&value) {
            let reason = format!("must be {least:?} to {greatest:?} {unit}, not {value:?}: {of}");
            refusals.add(key(name), reason);
        }
    }
}

/// Checks the servos of a robot with its angles, its speeds and its weight.
pub(super) fn servos_fit(robot: &Robot, weights: [f64; 2], refusals: &mut Refusals) {
    let (Some(actuators), Some(_)) = (&robot.actuators, robot.hobby_servos()) else {
        return;
    };
    if robot.homing.method != HomeMethod::Absolute {
        let reason = "is for motors that search for their angles, and a hobby servo knows its own: leave it out";
        refusals.add(Key::In("homing", "method"), reason);
    }
    if robot.crossing.allowed {
        let reason = "is for brushed motors: with hobby servos leave it out";
        refusals.add(Key::In("crossing", "allowed"), reason);
    }
    if robot.advanced.pen_friction > 0.0 {
        let reason = "is for drives that take a torque: a hobby servo takes an angle; leave it out";
        refusals.add(Key::In("advanced", "pen_friction"), reason);
    }
    for joint in Joint::ALL {
        let (actuator, weight) = (&actuators[joint], weights[joint.index()]);
        let Some(servo) = actuator.hobby_servo() else {
            return;
        };
        refusals.note(covers(robot, joint, actuator, servo));
        let gear = actuator.gear_ratio.abs();
        let max_speed = robot.limits.max_speed[joint];
        let fastest = SPEED_SHARE * servo.max_speed / gear;
        if max_speed > fastest {
            let reason = format!(
                "of {joint} is {max_speed:?} rad/s, and motions may take {SPEED_SHARE:?} of what its servo can, so that \
                 the servo can catch up: lower it to {fastest:.3} rad/s"
            );
            refusals.add(Key::In("limits", "max_speed"), reason);
            continue;
        }
        let at_speed = servo.stall_torque * servo.torque_at_speed(max_speed * gear);
        let most = servo.torque_share * at_speed * gear;
        if weight > most {
            let reason = format!(
                "cannot hold {joint} against gravity: in some pose it needs {weight:.3} N·m at the joint, and {most:.3} N·m \
                 are {:?} of what the servo has at `max_speed` of [limits]: take a stronger one",
                servo.torque_share
            );
            refusals.add(Key::Of("actuator", joint.index(), "stall_torque"), reason);
        }
    }
}

/// Whether a servo's travel covers its joint's angles.
fn covers(
    robot: &Robot,
    joint: Joint,
    actuator: &Actuator,
    servo: &HobbyServo,
) -> Result<(), Refusal> {
    let limits = robot.limits.angle[joint];
    let middle = servo.middle(limits);
    let half = 0.5 * servo.travel / actuator.gear_ratio.abs();
    // A file's decimals are no exact thirds of a turn.
    let rounding = 1e-9;
    if limits
        .iter()
        .all(|angle| (angle - middle).abs() <= half + rounding)
    {
        return Ok(());
    }
    let reason = format!(
        "turns {joint} from {:.3} to {:.3} rad, and its `angle` of [limits] is {limits:?} rad: narrow that, or set \
         `middle_angle`, the joint's angle at the middle of `pulse_range`",
        middle - half,
        middle + half
    );
    Err(Key::Of("actuator", joint.index(), "travel").refused(reason))
}
