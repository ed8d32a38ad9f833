//! Limits of motion, control, supply, protection and homing: each compared with what the joints
//! can do.

use super::{Plausible, reach};
use crate::refusal::Key;
use crate::robot::Robot;
use std::f64::consts::TAU;

/// The speed of C at full reach and the joint's greatest speed, over the tool's greatest speed.
const SPEED: [f64; 2] = [0.1, 2000.0];

/// Greatest acceleration of the tool over that of C at full reach and the joint's greatest.
const ACCELERATION: f64 = 3.0;

/// Torque that a joint's greatest acceleration takes of its own crank and rotor, over the peak torque.
const INERTIA: f64 = 30.0;

/// The greatest jerk over the greatest acceleration [1/s]: it is reached within 0.1 ms to 3 s.
const JERK: [f64; 2] = [1.0 / 3.0, 1e4];

/// A joint's torque limit over the torque of its drive.
const TORQUE: [f64; 2] = [0.01, 300.0];

/// Corner tolerance over the reach.
const CORNER: [f64; 2] = [1e-6, 0.05];

/// Least singularity margin: at 1/500 the forces in the links are 500 times that at the tip.
const MARGIN: [f64; 2] = [0.002, 1.0];

/// Least bandwidth of the position loop [rad/s]: it settles within 2 s.
const BANDWIDTH: f64 = 2.0;

/// Voltage of a bus [V].
const VOLTAGE: [f64; 2] = [2.0, 800.0];

/// The bus voltages that are faults, over the nominal one.
const BUS: [f64; 2] = [0.2, 3.0];

/// The trip points of speed and current over the greatest values of the joints.
const TRIP: [f64; 2] = [1.0, 5.0];

/// The following error [rad]: no arm follows more closely than the least.
const FOLLOWING: [f64; 2] = [5e-4, 1.0];

/// The time without a sign of life of the host [s]: hosts cannot keep less than the least.
const SILENCE: [f64; 2] = [2e-3, 60.0];

/// Longest search over the joint's range [s].
const LONGEST_SEARCH: f64 = 600.0;

/// Angle by which a joint leaves its switch [rad]: beyond the switch's own hysteresis.
const BACK_OFF: [f64; 2] = [5e-4, 1.0];

pub(super) fn rules(robot: &Robot) -> Vec<Plausible> {
    let mut rules = of_motion(robot);
    rules.extend(of_loops(robot));
    for limit in robot.bus_range() {
        rules.push(Plausible::new(
            Key::In("supply", "range"),
            (limit, "V"),
            BUS.map(|share| share * robot.supply.voltage),
            "1/5 to 3 times `voltage`",
        ));
    }
    rules.extend(torques(robot));
    rules.extend(search(robot));
    rules
}

/// The limits of the joints and of the tool.
fn of_motion(robot: &Robot) -> Vec<Plausible> {
    let Robot { limits, motion, .. } = robot;
    let reach = reach(robot);
    let mut rules = Vec::new();
    for (speed, acceleration) in limits.max_speed.into_iter().zip(limits.max_acceleration) {
        rules.extend([
            Plausible::new(
                Key::In("limits", "max_speed"),
                (speed, "rad/s"),
                SPEED.map(|share| share * motion.max_speed / reach),
                "times the reach it is 1/10 to 2000 times the `max_speed` of [motion]",
            )
            .compared_with(Key::In("motion", "max_speed")),
            Plausible::new(
                Key::In("motion", "max_acceleration"),
                (motion.max_acceleration, "m/s²"),
                [0.0, ACCELERATION * acceleration * reach],
                "3 times the reach times the `max_acceleration` of [limits]",
            )
            .compared_with(Key::In("limits", "max_acceleration")),
        ]);
    }
    rules.extend([
        Plausible::new(
            Key::In("motion", "max_jerk"),
            (motion.max_jerk, "m/s³"),
            JERK.map(|rate| rate * motion.max_acceleration),
            "from 0 to `max_acceleration` it takes 1e-4 to 3 s",
        )
        .compared_with(Key::In("motion", "max_acceleration")),
        Plausible::new(
            Key::In("motion", "corner_tolerance"),
            (motion.corner_tolerance, "m"),
            CORNER.map(|share| share * reach),
            "1e-6 to 0.05 of the reach",
        )
        .or_zero(),
        Plausible::new(
            Key::In("limits", "singularity_margin"),
            (limits.singularity_margin, ""),
            MARGIN,
            "it is a sine, and with less the links bear more than 500 times the force at the tip",
        )
        .or_zero(),
    ]);
    rules
}

/// Control, supply, protection and homing.
fn of_loops(robot: &Robot) -> [Plausible; 7] {
    let Robot {
        control,
        supply,
        protection,
        ..
    } = robot;
    [
        Plausible::new(
            Key::In("control", "bandwidth"),
            (control.bandwidth, "rad/s"),
            [BANDWIDTH, f64::MAX],
            "with less the position loop does not settle within 2 s",
        ),
        Plausible::new(
            Key::In("supply", "voltage"),
            (supply.voltage, "V"),
            VOLTAGE,
            "from small cells to a rectified mains supply",
        ),
        Plausible::new(
            Key::In("protection", "over_speed"),
            (protection.over_speed, ""),
            TRIP,
            "a multiple of `max_speed` of [limits]",
        ),
        Plausible::new(
            Key::In("protection", "over_current"),
            (protection.over_current, ""),
            TRIP,
            "a multiple of `peak_current`",
        ),
        Plausible::new(
            Key::In("protection", "following_error"),
            (protection.following_error, "rad"),
            FOLLOWING,
            "no arm follows more closely",
        ),
        Plausible::new(
            Key::In("protection", "command_timeout"),
            (protection.command_timeout, "s"),
            SILENCE,
            "hosts cannot give signs of life more often",
        ),
        Plausible::new(
            Key::In("homing", "back_off"),
            (robot.back_off(), "rad"),
            BACK_OFF,
            "a joint must leave the hysteresis of its switch",
        ),
    ]
}

/// The joints' accelerations and torques against their drives.
fn torques(robot: &Robot) -> Vec<Plausible> {
    let (Ok(arm), Ok(drives)) = (robot.arm(), robot.drives()) else {
        return Vec::new();
    };
    let limits = &robot.limits;
    let mut rules = Vec::new();
    for (joint, drive) in drives.iter().enumerate() {
        let crank = &arm.links()[3 * joint];
        let inertia = crank.inertia
            + crank.mass * crank.com.norm_squared()
            + drive.motor().reflected_inertia();
        let acceleration = Plausible::new(
            Key::In("limits", "max_acceleration"),
            (limits.max_acceleration[joint], "rad/s²"),
            [0.0, INERTIA * drive.peak_torque() / inertia],
            "with more the crank and the rotor alone take over 30 times the peak torque of the drive",
        );
        rules.push(acceleration.compared_with(Key::Of("link", 3 * joint, "inertia")));
    }
    let Some(torque) = limits.max_torque else {
        return rules;
    };
    let weighed = robot.ideal_torque(arm);
    for (joint, torque) in torque.into_iter().enumerate() {
        let (unlimited, friction) = match &robot.actuators {
            Some(motors) => (motors[joint].peak_torque(), motors[joint].coulomb_friction),
            None => (weighed, 0.0),
        };
        let [least, greatest] = TORQUE.map(|share| share * unlimited);
        rules.push(Plausible::new(
            Key::In("limits", "max_torque"),
            (torque, "N·m"),
            [least.max(friction), greatest],
            "above the friction, and 1/100 to 300 times the torque of the drive, or that an ideal \
             drive needs",
        ));
    }
    rules
}

/// The search for switches or stops, which must end and move the joint.
fn search(robot: &Robot) -> Vec<Plausible> {
    let mut rules = Vec::new();
    for (joint, [low, high]) in robot.limits.angle.into_iter().enumerate() {
        rules.push(Plausible::new(
            Key::In("homing", "speed"),
            (robot.homing_speed(), "rad/s"),
            [(high - low).min(TAU) / LONGEST_SEARCH, f64::MAX],
            "slower, a search over the joint's range takes more than 600 s",
        ));
        if let (Some(current), Some(motors)) = (robot.homing.current, &robot.actuators) {
            let motor = &motors[joint];
            let friction = motor.coulomb_friction / motor.torque_per_ampere();
            rules.push(Plausible::new(
                Key::In("homing", "current"),
                (current, "A"),
                [friction.max(0.01 * motor.peak_current), f64::MAX],
                "what overcomes the `coulomb_friction`, and 1/100 of `peak_current`",
            ));
        }
    }
    rules
}
