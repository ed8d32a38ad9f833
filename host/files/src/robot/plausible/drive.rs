//! Motors, gears, brakes and encoders, and the monitors that protect them.

use super::Plausible;
use crate::refusal::Key;
use crate::robot::{Actuator, CanTorque, Drive, HobbyServo, Robot};
use fivebar_firmware::drives::can::Protocol;
use fivebar_firmware::settings::AxisField;
use fivebar_kinematics::five_bar::Joint;
use fivebar_plant::Harmonic;
use std::f64::consts::TAU;

/// A winding's time constant L/R [s]; real ones have 20 µs to 20 ms.
const WINDING: [f64; 2] = [1e-5, 0.05];

/// The mechanical time constant J R/k² [s]; real ones have 0.5 ms to 100 ms.
const MECHANICAL: [f64; 2] = [5e-5, 1.0];

/// The natural frequency of a stepper's rotor without a load, from the highest on [Hz]; NEMA 8 to 34 have 80 to 500.
const NATURAL: [f64; 2] = [2000.0, 20.0];

/// The acceleration of the rotor of a drive on a bus by its peak torque, from the highest on [rad/s²].
const ROTOR: [f64; 2] = [1e6, 300.0];

/// The speed without load of a drive on a bus over its greatest speed, from the highest on.
const NO_LOAD: [f64; 2] = [500.0, 0.2];

/// The greatest speed of a drive on a bus over the one that its joint needs.
const SPEED: [f64; 2] = [1.0, 100.0];

/// Steps of an MIT-type drive's frames, of a position and of a velocity or torque.
const POSITION_STEPS: f64 = 65_535.0;
const OTHER_STEPS: f64 = 4095.0;

/// The greatest step of a position over the following error, and that of a velocity or torque over the drive's greatest.
const POSITION_STEP: f64 = 0.1;
const OTHER_STEP: f64 = 0.01;

/// Voltages of hobby servos, whose electronics are rated for 4.8 to 6 V, and to 8.4 V for two cells of lithium [V].
const SERVO_SUPPLY: [f64; 2] = [4.0, 8.5];

/// Stall torques of hobby servos [N·m].
const STALL: [f64; 2] = [0.005, 15.0];

/// The peak current as a multiple of the stall current V/R. At twice the stall current the motor brakes
/// from its no-load speed.
const PEAK: [f64; 2] = [1.0 / 500.0, 2.0];

/// The continuous current as a share of the peak current.
const CONTINUOUS: [f64; 2] = [0.02, 1.0];

/// Codes of the current sensor for the peak current, at least.
const CODES: f64 = 40.0;

/// Time constant of a motor's heating [s]: the controller's bounds.
const HEATING: [f64; 2] = AxisField::ThermalTimeConstant.row().range;

/// Holding torque of a brake over the motor's peak torque at the joint.
const BRAKE: [f64; 2] = [0.01, 100.0];

/// Time in which a brake engages or releases [s].
const BRAKE_TIMES: [f64; 2] = [1e-3, 1.0];

/// Greatest angle by which the peak torque twists gear or belt [rad].
const TWIST: f64 = 0.2;

/// Damping of gear or belt over the critical damping of the rotor on it. Belts have 0.01.
const DAMPING: f64 = 4.0;

/// Age of an encoder's angle [s].
const LATENCY: f64 = 0.01;

/// Counts per turn of the joint, and counts in the greatest following error, at least.
const COUNTS: f64 = 500.0;
const COUNTS_OF_ERROR: f64 = 4.0;

pub(super) fn rules(robot: &Robot) -> Vec<Plausible> {
    let actuators = Joint::ALL.into_iter().zip(robot.actuators.iter().flatten());
    actuators
        .flat_map(|(joint, actuator)| joint_rules(robot, joint, actuator))
        .collect()
}

fn joint_rules(robot: &Robot, joint: Joint, motor: &Actuator) -> Vec<Plausible> {
    let key = |name| Key::Of("actuator", joint.index(), name);
    let voltage = robot.supply.voltage;
    let peak_torque = motor.peak_torque();
    let stall = voltage / motor.resistance;
    let mut rules = match &motor.drive {
        Drive::CanTorque(drive) => torque_drive(robot, joint, motor, drive),
        Drive::HobbyServo(servo) => hobby_servo(robot, joint, motor, servo),
        Drive::Brushed | Drive::Stepper(_) => electrics(robot, joint, motor, stall),
    };
    rules.push(rotor(joint, motor));
    rules.extend([
        Plausible::new(
            key("viscous_friction"),
            (motor.viscous_friction, "N·m·s/rad"),
            [0.0, peak_torque / robot.limits.max_speed[joint]],
            "at `max_speed` of [limits] it takes the motor's peak torque",
        ),
        Plausible::new(
            key("coulomb_friction"),
            (motor.coulomb_friction, "N·m"),
            [0.0, peak_torque],
            "with more than the motor's peak torque the joint cannot turn",
        ),
        Plausible::new(
            key("brake_torque"),
            (motor.brake_torque, "N·m"),
            BRAKE.map(|share| share * peak_torque),
            "1/100 to 100 times the motor's peak torque at the joint",
        )
        .or_zero(),
    ]);
    for (name, time) in [
        ("brake_engage_time", motor.brake_engage_time),
        ("brake_release_time", motor.brake_release_time),
    ] {
        if let Some(time) = time {
            let time = (time, "s");
            let reason = "no brake moves in less, and power must hold the arm until it does";
            rules.push(Plausible::new(key(name), time, BRAKE_TIMES, reason).or_zero());
        }
    }
    rules.extend(belt(joint, motor, peak_torque));
    rules.extend(encoder(joint, motor));
    let per_turn = motor.gear_ratio.abs();
    let counts = COUNTS.max(COUNTS_OF_ERROR * TAU / robot.protection.following_error);
    rules.push(Plausible::new(
        key("encoder_counts"),
        (f64::from(motor.encoder_counts), ""),
        [counts / per_turn, f64::MAX],
        "500 per turn of the joint, and 4 in the `following_error` of [protection]",
    ));
    rules
}

/// Gear or belt, if it stretches.
fn belt(joint: Joint, motor: &Actuator, peak_torque: f64) -> Vec<Plausible> {
    let key = |name| Key::Of("actuator", joint.index(), name);
    let Some(stiffness) = motor.stiffness else {
        return Vec::new();
    };
    let critical = 2.0 * (stiffness * motor.motor().reflected_inertia()).sqrt();
    vec![
        Plausible::new(
            key("stiffness"),
            (stiffness, "N·m/rad"),
            [peak_torque / TWIST, f64::MAX],
            "the motor's peak torque would twist gear or belt by more than 0.2 rad",
        ),
        Plausible::new(
            key("drive_damping"),
            (motor.drive_damping, "N·m·s/rad"),
            [0.0, DAMPING * critical],
            "4 times the critical damping of the rotor on its `stiffness`",
        ),
    ]
}

/// What is known of the encoder's errors.
fn encoder(joint: Joint, motor: &Actuator) -> impl Iterator<Item = Plausible> {
    let latency = Plausible::new(
        Key::Of("actuator", joint.index(), "encoder_latency"),
        (motor.encoder_latency, "s"),
        [0.0, LATENCY],
        "encoders are read within less",
    );
    let phase = move |term: &Harmonic| {
        Plausible::new(
            Key::Of("actuator", joint.index(), "encoder_error"),
            (term.phase, "rad"),
            [0.0, TAU],
            "its `phase` is an angle within a turn",
        )
    };
    let phases: Vec<_> = motor.encoder_error.terms().iter().map(phase).collect();
    std::iter::once(latency).chain(phases)
}

/// What a drive on a bus can.
fn torque_drive(
    robot: &Robot,
    joint: Joint,
    motor: &Actuator,
    drive: &CanTorque,
) -> Vec<Plausible> {
    let key = |name| Key::Of("actuator", joint.index(), name);
    let needed = robot.limits.max_speed[joint] * motor.gear_ratio.abs();
    let mut rules = Vec::new();
    if let Some(constant) = motor.stated_torque_constant() {
        rules.push(Plausible::new(
            key("torque_constant"),
            (constant, "N·m/A"),
            NO_LOAD.map(|share| robot.supply.voltage / (share * drive.max_speed)),
            "without load the supply's voltage turns the motor at 1/5 to 500 times its `max_speed`",
        ));
    }
    if let Protocol::Mit(ranges) = drive.protocol {
        let error = robot.protection.following_error * motor.gear_ratio.abs();
        rules.extend([
            Plausible::new(
                key("position_range"),
                (ranges.position.into(), "rad"),
                [0.0, 0.5 * POSITION_STEPS * POSITION_STEP * error],
                "a frame holds 65536 positions, and a step must be 1/10 of the `following_error` of [protection] at most",
            ),
            Plausible::new(
                key("velocity_range"),
                (ranges.velocity.into(), "rad/s"),
                [0.0, 0.5 * OTHER_STEPS * OTHER_STEP * drive.max_speed],
                "a frame holds 4096 velocities, and a step must be 1/100 of the drive's `max_speed` at most",
            ),
            Plausible::new(
                key("torque_range"),
                (ranges.torque.into(), "N·m"),
                [0.0, 0.5 * OTHER_STEPS * OTHER_STEP * drive.peak_torque],
                "a frame holds 4096 torques, and a step must be 1/100 of the drive's `peak_torque` at most",
            ),
        ]);
    }
    rules.extend([
        Plausible::new(
            key("continuous_torque"),
            (drive.continuous_torque, "N·m"),
            CONTINUOUS.map(|share| share * drive.peak_torque),
            "1/50 of `peak_torque`, to all of it",
        ),
        Plausible::new(
            key("max_speed"),
            (drive.max_speed, "rad/s"),
            SPEED.map(|share| share * needed),
            "1 to 100 times what the joint's `max_speed` of [limits] needs",
        ),
    ]);
    rules
}

/// The inertia of a rotor; a robot without `[[actuator]]` has none.
fn rotor(joint: Joint, motor: &Actuator) -> Plausible {
    let (range, meaning) = match &motor.drive {
        Drive::Brushed => {
            let braking = motor.torque_constant.powi(2) / motor.resistance;
            (
                MECHANICAL.map(|seconds| seconds * braking),
                "the mechanical time constant, times `resistance` over the square of `torque_constant`, is \
                 5e-5 to 1 s",
            )
        }
        Drive::Stepper(stepper) => (
            NATURAL.map(|hertz| stepper.motor.inertia_at(hertz)),
            "the rotor alone swings at 20 to 2000 Hz about a step of the `holding_torque`",
        ),
        Drive::CanTorque(CanTorque { peak_torque, .. }) => (
            ROTOR.map(|acceleration| peak_torque / acceleration),
            "the `peak_torque` accelerates the rotor alone by 300 to 1e6 rad/s²",
        ),
        Drive::HobbyServo(servo) => (
            MECHANICAL.map(|seconds| seconds * servo.stall_torque / servo.max_speed),
            "the mechanical time constant, times `max_speed` over `stall_torque`, is 5e-5 to 1 s",
        ),
    };
    let key = Key::Of("actuator", joint.index(), "rotor_inertia");
    let rule = Plausible::new(key, (motor.rotor_inertia, "kg·m²"), range, meaning);
    match &motor.drive {
        Drive::Brushed | Drive::CanTorque(_) => rule.or_zero(),
        Drive::Stepper(_) | Drive::HobbyServo(_) => rule,
    }
}

/// What a hobby servo can.
fn hobby_servo(
    robot: &Robot,
    joint: Joint,
    motor: &Actuator,
    servo: &HobbyServo,
) -> Vec<Plausible> {
    let key = |name| Key::Of("actuator", joint.index(), name);
    let needed = robot.limits.max_speed[joint] * motor.gear_ratio.abs();
    vec![
        Plausible::new(
            key("max_speed"),
            (servo.max_speed, "rad/s"),
            SPEED.map(|share| share * needed),
            "1 to 100 times what the joint's `max_speed` of [limits] needs",
        ),
        Plausible::new(
            key("stall_torque"),
            (servo.stall_torque, "N·m"),
            STALL,
            "from the smallest servo, of 2 g, to a large one; 1 kgf·cm is 0.098 N·m",
        ),
        Plausible::new(
            Key::In("supply", "voltage"),
            (robot.supply.voltage, "V"),
            SERVO_SUPPLY,
            "the electronics in a hobby servo are rated for 4.8 to 8.4 V",
        ),
    ]
}

fn electrics(robot: &Robot, joint: Joint, motor: &Actuator, stall: f64) -> Vec<Plausible> {
    let key = |name| Key::Of("actuator", joint.index(), name);
    let mut rules = vec![
        Plausible::new(
            key("inductance"),
            (motor.inductance, "H"),
            WINDING.map(|seconds| seconds * motor.resistance),
            "over `resistance` it is the winding's time constant, 1e-5 to 0.05 s",
        ),
        Plausible::new(
            key("peak_current"),
            (motor.peak_current, "A"),
            PEAK.map(|share| share * stall),
            "1/500 to 2 times the stall current, `voltage` of [supply] over `resistance`",
        ),
        Plausible::new(
            key("continuous_current"),
            (motor.continuous_current, "A"),
            CONTINUOUS.map(|share| share * motor.peak_current),
            "1/50 of `peak_current`, to all of it",
        ),
        Plausible::new(
            key("thermal_time_constant"),
            (motor.thermal_time_constant, "s"),
            HEATING,
            "from the winding of a tiny motor to a large motor with its housing",
        ),
    ];
    if let Some(per_code) = motor.current_per_code {
        rules.push(Plausible::new(
            key("current_per_code"),
            (per_code, "A"),
            [0.0, robot.limited(joint, *motor).peak_current / CODES],
            "the peak current needs 40 codes",
        ));
    }
    rules
}
