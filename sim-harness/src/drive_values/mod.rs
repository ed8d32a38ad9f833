//! What a drive does by itself, as pages show it beside the joints: values with names and units, by the kind of the drive.
//!
//! They follow from a status of the controller and the robot's file. A stepper's load angle δ: sin δ = τ/(G T), of the
//! torque τ that the joint's motion needs by the arm's model, the gear ratio G and the holding torque T.

mod load;

use fivebar_files::robot::{DriveKind, Robot};
use fivebar_firmware::Status;
use fivebar_firmware::settings::CheckedSettings;
use fivebar_kinematics::five_bar::Joint;
use fivebar_plant::{HobbyServo, Stepper};
use load::Load;
use serde::Serialize;
use std::f64::consts::TAU;

/// What both joints' drives tell or are told.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct DriveValue {
    /// Its name.
    pub name: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// Decimals to show.
    pub digits: u8,
}

/// Both joints' drives, as far as their values need them.
#[derive(Clone, Debug)]
pub struct DriveValues(Kind);

#[derive(Clone, Debug)]
enum Kind {
    Brushed,
    Steppers {
        motors: [Stepper; 2],
        load: Load,
    },
    Bus {
        /// Torque at each joint by the current of the status [N·m/A].
        torque_per_current: [f64; 2],
        /// Whether the robot file states the motors' torque constants, so that the currents are those of the motors.
        knows_current: bool,
    },
    Servos {
        servos: [HobbyServo; 2],
        /// The joints' home angles [rad].
        home: [f64; 2],
        load: Load,
    },
}

const CURRENT: DriveValue = DriveValue {
    name: "current",
    unit: "A",
    digits: 2,
};
const BRUSHED: &[DriveValue] = &[
    CURRENT,
    DriveValue {
        name: "duty of the bridge",
        unit: "%",
        digits: 1,
    },
];
const LOAD: DriveValue = DriveValue {
    name: "torque by the arm's model, at the joint",
    unit: "N·m",
    digits: 3,
};
const STEPPERS: &[DriveValue] = &[
    LOAD,
    DriveValue {
        name: "micro-steps told",
        unit: "1/s",
        digits: 0,
    },
    DriveValue {
        name: "load angle by the arm's model",
        unit: "° electrical",
        digits: 1,
    },
];
const WITH_ENCODERS: &[DriveValue] = &[
    STEPPERS[0],
    STEPPERS[1],
    STEPPERS[2],
    DriveValue {
        name: "behind its set-point by the encoder",
        unit: "full steps",
        digits: 2,
    },
];
const BUS: &[DriveValue] = &[
    DriveValue {
        name: "torque told by the drive, at the joint",
        unit: "N·m",
        digits: 3,
    },
    CURRENT,
];
const SERVOS: &[DriveValue] = &[
    LOAD,
    DriveValue {
        name: "width of the pulse",
        unit: "µs",
        digits: 1,
    },
];

impl DriveValues {
    /// Those of this robot with its settings. A robot without drives has ideal ones, which the controller takes for brushed
    /// motors.
    pub fn of(robot: &Robot, settings: &CheckedSettings) -> Self {
        let load = Load::new(settings);
        if let Some(motors) = robot.steppers() {
            return Self(Kind::Steppers { motors, load });
        }
        if let Some(servos) = robot.hobby_servos() {
            let home = Joint::ALL.map(|joint| robot.home[joint]);
            return Self(Kind::Servos { servos, home, load });
        }
        Self(match (&robot.actuators, robot.drive_kind()) {
            (Some(actuators), DriveKind::CanTorque) => Kind::Bus {
                torque_per_current: actuators.map(|drive| drive.torque_constant * drive.gear_ratio),
                knows_current: (actuators.iter())
                    .all(|drive| drive.stated_torque_constant().is_some()),
            },
            _ => Kind::Brushed,
        })
    }

    /// What they are.
    pub fn names(&self) -> &'static [DriveValue] {
        match &self.0 {
            Kind::Brushed => BRUSHED,
            Kind::Steppers { motors, .. } if motors.iter().all(|motor| motor.encoder) => {
                WITH_ENCODERS
            }
            Kind::Steppers { .. } => STEPPERS,
            Kind::Bus {
                knows_current: true,
                ..
            } => BUS,
            Kind::Bus { .. } => &BUS[..1],
            Kind::Servos { .. } => SERVOS,
        }
    }

    /// Whether the currents of a status are those of the motors.
    pub fn knows_current(&self) -> bool {
        self.names().contains(&CURRENT)
    }

    /// Their values by a status, in the order of [`Self::names`], for joint 1 and joint 4. What drives are told is none while
    /// they have no power.
    pub fn at(&self, status: &Status) -> Vec<Option<[f64; 2]>> {
        let current = status.current.map(f64::from);
        let torque = |load: &Load| load.torques(status.joint_reference.as_ref()?);
        let mut values = match &self.0 {
            Kind::Brushed => {
                let duty = status.duty.map(|duty| 100.0 * f64::from(duty));
                vec![Some(current), Some(duty)]
            }
            Kind::Steppers { motors, load } => {
                let torque = torque(load);
                let [told, behind] = micro_steps(motors, status);
                let load_angle = torque.map(|torque| load_angles(motors, torque));
                vec![torque, told, load_angle, behind]
            }
            Kind::Bus {
                torque_per_current, ..
            } => {
                let torque = Joint::ALL.map(|joint| torque_per_current[joint] * current[joint]);
                vec![Some(torque), Some(current)]
            }
            Kind::Servos { servos, home, load } => {
                let widths = status
                    .joint_reference
                    .map(|_| pulses(servos, *home, status));
                vec![torque(load), widths]
            }
        };
        values.truncate(self.names().len());
        values
    }
}

/// Micro-steps told in a second, and how far each motor is behind its set-point [full steps].
fn micro_steps(motors: &[Stepper; 2], status: &Status) -> [Option<[f64; 2]>; 2] {
    let Some(reference) = status.joint_reference else {
        return [None, None];
    };
    let full_steps = |motor: &Stepper, turned: f64| {
        turned * motor.gear_ratio * f64::from(motor.steps_per_turn) / TAU
    };
    let told = Joint::ALL.map(|joint| {
        let motor = &motors[joint];
        f64::from(motor.microsteps) * full_steps(motor, reference.velocity[joint].into())
    });
    let behind = Joint::ALL.map(|joint| {
        let gap = f64::from(reference.angle[joint]) - f64::from(status.angle[joint]);
        full_steps(&motors[joint], wrapped(gap))
    });
    [Some(told), Some(behind)]
}

/// Of these torques at the joints [° of the field's period].
fn load_angles(motors: &[Stepper; 2], torque: [f64; 2]) -> [f64; 2] {
    Joint::ALL.map(|joint| {
        let motor = &motors[joint];
        let share = torque[joint] / (motor.gear_ratio * motor.holding_torque);
        share.clamp(-1.0, 1.0).asin().to_degrees()
    })
}

/// The widths of the pulses by which servos are told these angles [µs].
fn pulses(servos: &[HobbyServo; 2], home: [f64; 2], status: &Status) -> [f64; 2] {
    Joint::ALL.map(|joint| {
        let servo = &servos[joint];
        let turned = wrapped(f64::from(status.angle[joint]) - home[joint]);
        let beyond_home = servo.gear_ratio * turned / servo.angle_per_width();
        1e6 * (servo.home_width + beyond_home)
    })
}

/// An angle within half a turn of 0 [rad].
fn wrapped(angle: f64) -> f64 {
    angle - TAU * (angle / TAU).round()
}

/// What the tip error that a status shows is of, as a caption.
pub fn tip_error_of(robot: &Robot) -> &'static str {
    match robot.drive_kind() {
        DriveKind::Brushed => "Tip error from the encoders",
        DriveKind::CanTorque => "Tip error from the drives' encoders",
        DriveKind::Stepper if robot.has_steppers_with_encoders() => "Tip error from the encoders",
        DriveKind::Stepper => {
            "Tip error of the micro-steps made: nothing measures the arm, and lost steps do not show"
        }
        DriveKind::Servo => {
            "Tip error of the pulses made: nothing measures the arm, and what the servos do does not show"
        }
    }
}
