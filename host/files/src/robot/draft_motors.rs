//! The motors of a new arm. Both joints have the same motor; its fields are keys of `[[actuator]]`.

use super::draft::tidy;
use super::hobby_servo::SPEED_SHARE;
use super::stepper::STEP_RATE;
use crate::refusal::Key;
use fivebar_plant::{DriverMode, Stepper};
use std::f64::consts::{PI, TAU};

/// The speeds at which a stepper's torque is looked at.
const SPEEDS: u32 = 1000;

/// What turns the joints of a new arm.
#[derive(Clone, Debug, PartialEq)]
pub enum Motors {
    /// Ideal torque sources.
    Ideal,
    /// Brushed motors with encoders.
    Brushed(Motor),
    /// Steppers without encoders.
    Steppers(StepperMotor),
    /// Torque drives on a CAN bus.
    CanDrives(CanMotor),
    /// Hobby servos.
    HobbyServos(ServoMotor),
}

/// A brushed motor with its gear and encoder.
#[derive(Clone, Debug, PartialEq)]
pub struct Motor {
    /// Motor turns per joint turn.
    pub gear_ratio: f64,
    /// Rotor inertia at the motor shaft [kg·m²].
    pub rotor_inertia: f64,
    /// Torque constant [N·m/A].
    pub torque_constant: f64,
    /// Winding resistance [Ω].
    pub resistance: f64,
    /// Winding inductance [H].
    pub inductance: f64,
    /// Encoder counts per motor turn, after quadrature.
    pub encoder_counts: u32,
    /// Peak current [A].
    pub peak_current: f64,
    /// Continuous current [A].
    pub continuous_current: f64,
    /// Time constant of the motor's heating [s].
    pub thermal_time_constant: f64,
}

/// A stepper with its gear and the micro-steps of its driver.
#[derive(Clone, Debug, PartialEq)]
pub struct StepperMotor {
    /// Motor turns per joint turn.
    pub gear_ratio: f64,
    /// Rotor inertia at the motor shaft [kg·m²].
    pub rotor_inertia: f64,
    /// Full steps in a turn of the motor.
    pub steps_per_turn: u32,
    /// Micro-steps in a full step.
    pub microsteps: u32,
    /// Torque at the rated current, at the motor shaft [N·m].
    pub holding_torque: f64,
    /// At the peak of a winding [A].
    pub rated_current: f64,
    /// Winding resistance [Ω].
    pub resistance: f64,
    /// Winding inductance [H].
    pub inductance: f64,
    /// What its driver gives the windings.
    pub driver: DriverMode,
    /// Counts of its encoder in a turn of the motor, if it has one.
    pub encoder_counts: Option<u32>,
}

/// A torque drive on a CAN bus, with its motor and gear. Torques and speeds are of the drive's shaft.
#[derive(Clone, Debug, PartialEq)]
pub struct CanMotor {
    /// What it speaks.
    pub protocol: CanProtocol,
    /// The numbers of both drives on the bus.
    pub nodes: [u8; 2],
    /// Turns of the drive's shaft per joint turn.
    pub gear_ratio: f64,
    /// Rotor inertia at that shaft [kg·m²].
    pub rotor_inertia: f64,
    /// [N·m].
    pub peak_torque: f64,
    /// [N·m].
    pub continuous_torque: f64,
    /// [rad/s].
    pub max_speed: f64,
}

/// A hobby servo. Torque and speed are of its shaft, which turns the joint itself.
#[derive(Clone, Debug, PartialEq)]
pub struct ServoMotor {
    /// Two widths of its pulse [s].
    pub pulse_range: [f64; 2],
    /// The angle by which it turns between them [rad].
    pub travel: f64,
    /// [rad/s].
    pub max_speed: f64,
    /// [N·m].
    pub stall_torque: f64,
    /// Change of the width up to which it does not react [s].
    pub dead_band: f64,
    /// Pulses in a second [Hz].
    pub frame_rate: f64,
}

/// What a drive on a CAN bus speaks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CanProtocol {
    /// ODrive's CANSimple.
    Odrive,
    /// The eight bytes of MIT-type drives, with the ranges of their numbers.
    Mit {
        /// ± [rad].
        position_range: f64,
        /// ± [rad/s].
        velocity_range: f64,
        /// ± [N·m].
        torque_range: f64,
    },
}

impl Motor {
    /// A 24 V, 20 W coreless motor with a belt, the benchtop arm's.
    pub const TYPICAL: Self = Self {
        gear_ratio: 8.0,
        rotor_inertia: 1.0e-6,
        torque_constant: 0.0234,
        resistance: 2.3,
        inductance: 0.24e-3,
        encoder_counts: 16384,
        peak_current: 4.0,
        continuous_current: 1.3,
        thermal_time_constant: 12.0,
    };
}

impl StepperMotor {
    /// A NEMA 17 of 48 mm with a belt: the one of docs/use/parts.md.
    pub const TYPICAL: Self = Self {
        gear_ratio: 4.0,
        rotor_inertia: 8.2e-6,
        steps_per_turn: 200,
        microsteps: 16,
        holding_torque: 0.59,
        rated_current: 2.0,
        resistance: 1.4,
        inductance: 3.0e-3,
        driver: DriverMode::Current,
        encoder_counts: None,
    };
    /// Coulomb friction of motor, bearings and belt over the holding torque.
    const COULOMB: f64 = 0.0125;
    /// Their viscous friction at the motor shaft [N·m·s/rad].
    const VISCOUS: f64 = 1.25e-4;
}

impl CanMotor {
    /// An ODrive S1 or its like with a brushless motor of 52 mm and a belt, the leg's.
    pub const TYPICAL: Self = Self {
        protocol: CanProtocol::Odrive,
        nodes: [1, 2],
        gear_ratio: 3.0,
        rotor_inertia: 3e-5,
        peak_torque: 0.97,
        continuous_torque: 0.39,
        max_speed: 600.0,
    };
    /// A Damiao DM-J4310 or its like, with its own gear; the inertia is typical of its class.
    pub const TYPICAL_MIT: Self = Self {
        protocol: CanProtocol::Mit {
            position_range: 12.5,
            velocity_range: 30.0,
            torque_range: 10.0,
        },
        nodes: [1, 2],
        gear_ratio: 1.0,
        rotor_inertia: 2e-3,
        peak_torque: 7.0,
        continuous_torque: 3.0,
        max_speed: 20.0,
    };
    /// Coulomb friction of motor, bearings and gear over the peak torque.
    const COULOMB: f64 = 0.007;
    /// Their viscous friction at the drive's shaft [N·m·s/rad].
    const VISCOUS: f64 = 2.2e-4;
}

impl ServoMotor {
    /// An MG90S, classroom_servo's.
    pub const TYPICAL: Self = Self {
        pulse_range: [0.5e-3, 2.5e-3],
        travel: PI,
        max_speed: 10.5,
        stall_torque: 0.177,
        dead_band: 5e-6,
        frame_rate: 50.0,
    };
    /// The share of its travel that is used.
    const USED: f64 = 0.95;
    /// Coulomb friction of its gears over the stall torque.
    const COULOMB: f64 = 0.03;
    /// Speed [m/s], acceleration [m/s²] and jerk [m/s³] of the tool: slow, because servos follow late.
    const MOTION: [f64; 3] = [0.03, 0.3, 5.0];
}

impl Motors {
    /// The greatest speed of a joint that they allow on this supply [V], if they say [rad/s].
    pub(super) fn max_speed(&self, voltage: f64) -> Option<f64> {
        match self {
            Self::Ideal | Self::Brushed(_) => None,
            Self::Steppers(motor) => Some(motor.max_speed(voltage)),
            Self::CanDrives(motor) => Some(motor.max_speed / motor.gear_ratio.abs()),
            Self::HobbyServos(motor) => Some(SPEED_SHARE * motor.max_speed),
        }
    }

    /// The keys of the n-th `[[actuator]]`, from 0, with their values.
    pub(super) fn values(&self, index: usize) -> Vec<(&'static str, String)> {
        match self {
            Self::Ideal => Vec::new(),
            Self::Brushed(motor) => motor.values(),
            Self::Steppers(motor) => motor.values(),
            Self::CanDrives(motor) => motor.values(index),
            Self::HobbyServos(motor) => motor.values(),
        }
    }

    /// Keys of other sections that follow from them, with their values.
    pub(super) fn limits(&self) -> Vec<(Key, String)> {
        match self {
            Self::HobbyServos(_) => ServoMotor::limits(),
            _ => Vec::new(),
        }
    }
}

impl Motor {
    fn values(&self) -> Vec<(&'static str, String)> {
        vec![
            number("gear_ratio", self.gear_ratio),
            number("rotor_inertia", self.rotor_inertia),
            number("torque_constant", self.torque_constant),
            number("resistance", self.resistance),
            number("inductance", self.inductance),
            ("encoder_counts", self.encoder_counts.to_string()),
            number("peak_current", self.peak_current),
            number("continuous_current", self.continuous_current),
            number("thermal_time_constant", self.thermal_time_constant),
        ]
    }
}

impl StepperMotor {
    /// The greatest joint speed at which it has half its torque and its driver takes the steps [rad/s].
    fn max_speed(&self, voltage: f64) -> f64 {
        let motor = Stepper {
            steps_per_turn: self.steps_per_turn,
            microsteps: self.microsteps,
            gear_ratio: self.gear_ratio,
            rotor_inertia: self.rotor_inertia,
            holding_torque: self.holding_torque,
            rated_current: self.rated_current,
            resistance: self.resistance,
            inductance: self.inductance,
            detent_torque: 0.0,
            encoder: false,
            driver: self.driver,
        };
        let of_driver =
            TAU * STEP_RATE / (f64::from(self.steps_per_turn) * f64::from(self.microsteps));
        let half = 0.5 * self.holding_torque;
        let speeds = (1..=SPEEDS).map(|n| of_driver * f64::from(n) / f64::from(SPEEDS));
        let strong = speeds.take_while(|&speed| motor.pull_out_torque(speed, voltage) >= half);
        strong.last().unwrap_or_default() / self.gear_ratio.abs()
    }

    fn values(&self) -> Vec<(&'static str, String)> {
        let gear = self.gear_ratio.abs();
        let mut values = vec![
            word("kind", "stepper"),
            number("gear_ratio", self.gear_ratio),
            number("rotor_inertia", self.rotor_inertia),
            ("steps_per_turn", self.steps_per_turn.to_string()),
            ("microsteps", self.microsteps.to_string()),
            number("holding_torque", self.holding_torque),
            number("rated_current", self.rated_current),
            number("resistance", self.resistance),
            number("inductance", self.inductance),
            word("driver", &self.driver.to_string()),
            // A stepper swings about its field, and only friction ends that: typical values, as none is asked.
            number(
                "coulomb_friction",
                tidy(Self::COULOMB * self.holding_torque * gear),
            ),
            number("viscous_friction", tidy(Self::VISCOUS * gear * gear)),
        ];
        let counts = self.encoder_counts;
        values.extend(counts.map(|counts| ("encoder_counts", counts.to_string())));
        values
    }
}

impl CanMotor {
    fn values(&self, index: usize) -> Vec<(&'static str, String)> {
        let gear = self.gear_ratio.abs();
        let mut values = vec![
            word("kind", "can-torque"),
            ("node", self.nodes[index].to_string()),
            number("gear_ratio", self.gear_ratio),
            number("rotor_inertia", self.rotor_inertia),
            number("peak_torque", self.peak_torque),
            number("continuous_torque", self.continuous_torque),
            number("max_speed", self.max_speed),
            // Typical values, as none is asked.
            number(
                "coulomb_friction",
                tidy(Self::COULOMB * self.peak_torque * gear),
            ),
            number("viscous_friction", tidy(Self::VISCOUS * gear * gear)),
        ];
        match self.protocol {
            CanProtocol::Odrive => values.push(word("protocol", "odrive")),
            CanProtocol::Mit {
                position_range,
                velocity_range,
                torque_range,
            } => values.extend([
                word("protocol", "mit"),
                number("position_range", position_range),
                number("velocity_range", velocity_range),
                number("torque_range", torque_range),
            ]),
        }
        values
    }
}

impl ServoMotor {
    fn values(&self) -> Vec<(&'static str, String)> {
        vec![
            word("kind", "servo"),
            ("pulse_range", format!("{:?}", self.pulse_range)),
            number("travel", self.travel),
            number("max_speed", self.max_speed),
            number("stall_torque", self.stall_torque),
            number("dead_band", self.dead_band),
            number("frame_rate", self.frame_rate),
            number("coulomb_friction", tidy(Self::COULOMB * self.stall_torque)),
        ]
    }

    /// As much of these angles of the joints [rad] as its travel covers, with home.
    pub(super) fn within_travel(&self, limits: [[f64; 2]; 2], home: [f64; 2]) -> [[f64; 2]; 2] {
        let half = 0.5 * Self::USED * self.travel;
        let cut = |[least, greatest]: [f64; 2], home: f64| {
            // The middle of the angles, unless home is near the end of the travel then.
            let middle = (0.5 * (least + greatest)).clamp(home - 0.5 * half, home + 0.5 * half);
            [least.max(middle - half), greatest.min(middle + half)].map(tidy)
        };
        [cut(limits[0], home[0]), cut(limits[1], home[1])]
    }

    /// A slow tool.
    fn limits() -> Vec<(Key, String)> {
        let [speed, acceleration, jerk] = Self::MOTION.map(|value| format!("{value:?}"));
        vec![
            (Key::In("motion", "max_speed"), speed),
            (Key::In("motion", "max_acceleration"), acceleration),
            (Key::In("motion", "max_jerk"), jerk),
        ]
    }
}

fn number(key: &'static str, value: f64) -> (&'static str, String) {
    (key, format!("{value:?}"))
}

fn word(key: &'static str, value: &str) -> (&'static str, String) {
    (key, format!("{value:?}"))
}
