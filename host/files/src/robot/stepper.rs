//! Stepper motors: their torque against speed, and their checks.
//!
//! A stepper loses steps where its load exceeds its pull-out torque, which falls with the speed. Motions take a share of
//! it. A time-optimal plan takes that share at each speed, by a straight line below the curve; motions at feed rates take
//! the share at the joint's greatest speed, which is the least.

use super::Robot;
use super::actuator::{Actuator, Drive, Stepper};
use super::value::single;
use crate::refusal::{Key, Refusal, Refusals};
use fivebar_design::time_optimal::FallingTorque;
use fivebar_firmware::settings::{BeltSettings, FieldLag};
use fivebar_kinematics::five_bar::Joint;
use fivebar_plant::{DriverMode, Stepper as Motor};
use std::f64::consts::TAU;

/// The fewest and most full steps per turn.
const STEPS_PER_TURN: [u32; 2] = [20, 1000];
/// The most micro-steps per full step: those of TMC drivers.
const MICROSTEPS: u32 = 256;
/// The detent torque over the holding torque; motors have 0.02 to 0.1.
const DETENT: [f64; 2] = [0.002, 0.5];
/// The fewest encoder counts in a full step: fewer do not show within half of one that steps are lost.
const COUNTS_PER_STEP: u32 = 8;
/// The most micro-steps in a second of one motor.
pub(super) const STEP_RATE: f64 = 200e3;

impl Stepper {
    /// If the file has none.
    pub(super) const STEPS_PER_TURN: u32 = 200;
    /// If the file has none.
    pub(super) const TORQUE_SHARE: f64 = 0.6;
    /// No model of heat guards a stepper, whose driver limits its current: the time of a NEMA 17 with its mount [s].
    pub(super) const HEATING: f64 = 600.0;
}

impl Robot {
    /// Its steppers, for the simulated arm.
    pub fn steppers(&self) -> Option<[Motor; 2]> {
        let [first, second] = self.actuators.as_ref()?;
        Some([first.stepper()?.motor, second.stepper()?.motor])
    }

    /// The controller's settings of the fields of steppers; none of other motors.
    pub(super) fn field_settings(&self) -> Option<[BeltSettings; 2]> {
        let motors = self.steppers()?;
        Some(motors.map(|motor| BeltSettings::spring(single(motor.stiffness()))))
    }

    /// By how much the rotors of steppers lag behind their fields on this supply, for the controller; none of other motors.
    pub(super) fn field_lags(&self) -> [FieldLag; 2] {
        let motors = self.steppers();
        motors.map_or([FieldLag::NONE; 2], |motors| {
            motors.map(|motor| motor.field_lag(self.supply.voltage))
        })
    }

    /// The inertias at the motors of an arm at home, rotors included [kg·m²]; none without steppers.
    fn inertia_at_motors(&self) -> Option<[f64; 2]> {
        let motors = self.steppers()?;
        let home = self.home_pose().ok()?;
        let mass = self.arm?.mass_matrix(&home).ok()?;
        Some(Joint::ALL.map(|joint| {
            let j = joint.index();
            mass[(j, j)] / motors[joint].gear_ratio.powi(2)
        }))
    }

    /// The longest period in which a stepper swings about a step with the arm at home [s]; none without steppers. An
    /// acceleration that takes that long to change leaves little swing behind.
    pub fn swing_period(&self) -> Option<f64> {
        let (motors, inertia) = (self.steppers()?, self.inertia_at_motors()?);
        let periods = Joint::ALL.map(|j| 1.0 / motors[j].natural_frequency(inertia[j]));
        Some(periods[0].max(periods[1]))
    }

    /// The joints' speeds up to which the field's lead for steppers is known [rad/s]; none of other motors.
    pub fn led_speed(&self) -> Option<[f64; 2]> {
        let motors = self.steppers()?;
        Some(motors.map(|motor| motor.led_speed(self.supply.voltage) / motor.gear_ratio.abs()))
    }

    /// The torques at the joints that a time-optimal plan may take of steppers at each speed, also on a supply that is 15 % too
    /// low; none of other motors.
    pub fn falling_torque(&self) -> Option<[FallingTorque; 2]> {
        let actuators = self.actuators.as_ref()?;
        let [first, second] = Joint::ALL.map(|joint| {
            let Stepper {
                motor,
                torque_share,
            } = actuators[joint].stepper()?;
            let (ratio, supply) = (motor.gear_ratio.abs(), self.supply.voltage);
            let fastest = (self.limits.max_speed[joint] * ratio).min(motor.led_speed(supply));
            let [standing, slope] = motor.pull_out_line(fastest, LOW_SUPPLY * supply);
            Some(FallingTorque {
                standing: torque_share * ratio * standing,
                slope: torque_share * ratio * ratio * slope,
            })
        });
        Some([first?, second?])
    }

    /// The torque of a stepper or of a hobby servo at its joint's greatest speed, over that at rest, the lesser of both
    /// joints; 1 of other motors.
    pub(super) fn torque_at_speed(&self) -> f64 {
        let Some(actuators) = &self.actuators else {
            return 1.0;
        };
        let shares = Joint::ALL.map(|joint| {
            let Actuator {
                gear_ratio, drive, ..
            } = &actuators[joint];
            let speed = self.limits.max_speed[joint] * gear_ratio.abs();
            match drive {
                Drive::Stepper(Stepper { motor, .. }) => {
                    motor.pull_out_torque(speed, self.supply.voltage) / motor.holding_torque
                }
                Drive::HobbyServo(servo) => servo.torque_at_speed(speed),
                _ => 1.0,
            }
        });
        shares[0].min(shares[1])
    }

    /// The greater of both ratios of the links' inertia at a stepper to its rotor's, with the arm at home; none without
    /// steppers.
    pub fn inertia_ratio(&self) -> Option<f64> {
        let (motors, inertia) = (self.steppers()?, self.inertia_at_motors()?);
        let ratios = Joint::ALL.map(|j| inertia[j] / motors[j].rotor_inertia - 1.0);
        Some(ratios[0].max(ratios[1]))
    }

    /// Whether it has steppers, both with encoders.
    pub fn has_steppers_with_encoders(&self) -> bool {
        let motors = self.steppers();
        motors.is_some_and(|motors| motors.iter().all(|motor| motor.encoder))
    }

    /// What is to be known before a run whose steppers have drivers that give a voltage; none of other arms.
    pub fn voltage_driver_warning(&self) -> Option<&'static str> {
        let motors = self.steppers()?;
        let gives_voltage = |motor: &Motor| motor.driver == DriverMode::Voltage;
        motors.iter().any(gives_voltage).then_some(
            "`driver = \"voltage\"`: on such drivers steppers are late, and from about 20 to 120 rad/s of the motor they may \
             lose steps by themselves; a TMC2209 gives a current once its pin SPREAD is tied to VIO",
        )
    }

    /// Whether its joints are turned by steppers.
    pub fn has_steppers(&self) -> bool {
        self.actuators
            .is_some_and(|actuators| actuators.iter().all(|it| it.stepper().is_some()))
    }
}

impl Actuator {
    /// The share of the holding torque of a stepper, or of the stall torque of a hobby servo, that motions may take near
    /// rest; 1 of other motors.
    pub(super) fn torque_share(&self) -> f64 {
        match &self.drive {
            Drive::Stepper(stepper) => stepper.torque_share,
            Drive::HobbyServo(servo) => servo.torque_share,
            _ => 1.0,
        }
    }
}

/// Checks each stepper by itself.
pub(super) fn check_stepper(index: usize, actuator: &Actuator, refusals: &mut Refusals) {
    let Some(stepper) = actuator.stepper() else {
        return;
    };
    let motor = &stepper.motor;
    let key = |name| Key::Of("actuator", index, name);
    let [least, greatest] = STEPS_PER_TURN;
    if !(least..=greatest).contains(&motor.steps_per_turn)
        || !motor.steps_per_turn.is_multiple_of(4)
    {
        let reason = format!(
            "must be a multiple of 4 from {least} to {greatest}, not {}: 200 of 1.8°, 400 of 0.9°",
            motor.steps_per_turn
        );
        refusals.add(key("steps_per_turn"), reason);
    }
    if !(1..=MICROSTEPS).contains(&motor.microsteps) {
        let reason = format!(
            "must be 1 to {MICROSTEPS} per full step, not {}",
            motor.microsteps
        );
        refusals.add(key("microsteps"), reason);
    }
    let fewest = COUNTS_PER_STEP.saturating_mul(motor.steps_per_turn);
    if motor.encoder && actuator.encoder_counts < fewest {
        let reason = format!(
            "must be {fewest} per motor turn at least, {COUNTS_PER_STEP} a full step, not {}: lost steps do not show; \
             leave it out if the stepper has no encoder",
            actuator.encoder_counts
        );
        refusals.add(key("encoder_counts"), reason);
    }
    for (name, value) in [
        ("holding_torque", motor.holding_torque),
        ("rated_current", motor.rated_current),
        ("rotor_inertia", actuator.rotor_inertia),
    ] {
        refusals.note(super::value::positive(key(name), value));
    }
    let detent = motor.detent_torque;
    let [least, greatest] = DETENT.map(|share| share * motor.holding_torque);
    if detent != 0.0 && !(least..=greatest).contains(&detent) {
        let reason = format!(
            "must be 0, or 1/500 to 1/2 of `holding_torque`, in N·m at the motor, not {detent:?} N·m"
        );
        refusals.add(key("detent_torque"), reason);
    }
    // Above 1 the motor is overloaded on purpose: to see the simulated arm lose steps.
    if !(0.05..=2.0).contains(&stepper.torque_share) {
        let reason = format!(
            "must be 0.05 to 2 of the pull-out torque, not {:?}; 0.6 leaves room for what is not known",
            stepper.torque_share
        );
        refusals.add(key("torque_share"), reason);
    }
}

/// Checks the steppers of a robot with its supply, its speeds and its weight.
pub(super) fn steppers_fit(robot: &Robot, greatest_weights: [f64; 2], refusals: &mut Refusals) {
    let Some(actuators) = &robot.actuators else {
        return;
    };
    if robot.has_steppers() && robot.advanced.pen_friction > 0.0 {
        let reason = "is for drives that take a torque: the step of a stepper does not lead by it; leave it out";
        refusals.add(Key::In("advanced", "pen_friction"), reason);
    }
    let voltage = robot.supply.voltage;
    let home = robot.home_pose().ok();
    let weight = home
        .zip(robot.arm)
        .and_then(|(home, arm)| arm.gravity_torque(&home).ok());
    for joint in Joint::ALL {
        let actuator = &actuators[joint];
        let Some(stepper) = actuator.stepper() else {
            return;
        };
        let motor = &stepper.motor;
        let key = |name| Key::Of("actuator", joint.index(), name);
        let max_speed = robot.limits.max_speed[joint];
        let turns = max_speed * actuator.gear_ratio.abs() / TAU;
        let rate = turns * f64::from(motor.steps_per_turn) * f64::from(motor.microsteps);
        if rate > STEP_RATE {
            let reason = format!(
                "of {joint} needs {rate:.0} micro-steps/s, and a driver takes {STEP_RATE:.0}: lower it, or the \
                 `microsteps` of [[actuator]], to {:.3} rad/s",
                max_speed * STEP_RATE / rate
            );
            refusals.add(Key::In("limits", "max_speed"), reason);
        }
        if actuator.resistance * motor.rated_current > voltage {
            let reason = format!(
                "needs {:.1} V over `resistance`, and [supply] has {voltage:?} V",
                actuator.resistance * motor.rated_current
            );
            refusals.add(key("rated_current"), reason);
        }
        let at_speed = motor.pull_out_torque(max_speed * actuator.gear_ratio, voltage);
        if at_speed < LEAST_SHARE * motor.holding_torque {
            let reason = format!(
                "of {joint} is too fast: at {:.0} rad/s the motor has {:.3} N·m of its {:?} N·m; lower it, or give \
                 the motor more voltage",
                max_speed * actuator.gear_ratio.abs(),
                at_speed,
                motor.holding_torque
            );
            refusals.add(Key::In("limits", "max_speed"), reason);
            continue;
        }
        let most = stepper.torque_share * at_speed * actuator.gear_ratio.abs();
        let weight = weight.map_or(0.0, |torques| torques[joint.index()].abs());
        if weight > most {
            let reason = format!(
                "cannot hold {joint} against gravity: at home it needs {weight:.3} N·m at the joint, and {most:.3} N·m \
                 are {:?} of the pull-out torque at `max_speed`",
                stepper.torque_share
            );
            refusals.add(key("holding_torque"), reason);
        }
        refusals.note(has_room_to_swing(robot, joint, actuator));
        let friction = actuator.coulomb_friction + motor.detent_torque * actuator.gear_ratio.abs();
        let weight = greatest_weights[joint.index()];
        if weight > friction && !motor.encoder {
            let reason = format!(
                "must be given, because the arm hangs: in some pose its weight needs {weight:.3} N·m at {joint}, and without \
                 power friction and `detent_torque` hold {friction:.3} N·m. Without encoders nothing shows whether the brakes \
                 hold it. Give the steppers encoders, or let the arm lie flat, with `gravity` perpendicular to its plane"
            );
            refusals.add(key("encoder_counts"), reason);
        }
    }
}

/// Checks that a rotor with an encoder may swing when its current comes, without a following error.
fn has_room_to_swing(robot: &Robot, joint: Joint, actuator: &Actuator) -> Result<(), Refusal> {
    let Some(Stepper { motor, .. }) = actuator.stepper() else {
        return Ok(());
    };
    let steps = f64::from(motor.steps_per_turn) * actuator.gear_ratio.abs();
    let swing = LEAST_ERROR * TAU / steps;
    if !motor.encoder || robot.protection.following_error >= swing {
        return Ok(());
    }
    let reason = format!(
        "must be {swing:.3} rad at least, {LEAST_ERROR} full steps of {joint}: a rotor swings by four when its current comes"
    );
    Err(Key::In("protection", "following_error").refused(reason))
}

/// The supply on which the torque of a time-optimal plan is there, of the file's: at speed a motor has less torque on a low one.
const LOW_SUPPLY: f64 = 0.85;
/// The least following error of a motor with an encoder [full steps].
const LEAST_ERROR: f64 = 5.0;
/// The least pull-out torque at the greatest speed, over the holding torque.
const LEAST_SHARE: f64 = 0.1;
