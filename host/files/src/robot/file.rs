//! The robot file: its sections, their keys and their defaults.
//!
//! All values are in SI units and radians. Unknown keys are refused.

use super::actuator::{ActuatorFile, DriveKind};
use super::can_torque::CanTorque;
use super::hobby_servo::HobbyServo;
use super::homing::HomeSearch;
use super::stepper::Stepper;
use super::tool_output::ToolOutputFile;
use fivebar_firmware::settings::{AdvancedSettings, AxisField, Field, Row};
use fivebar_plant::contact::Contact;
use fivebar_plant::{Encoder, EncoderSide, Harmonics, Motor, Transmission};
use serde::Deserialize;
use std::f64::consts::TAU;

/// The default of a setting that has the same one on every arm; of another, not a number.
pub(super) fn default_of(row: &Row) -> f64 {
    row.default.unwrap_or(f64::NAN)
}

/// The whole file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RobotFile {
    pub(super) name: String,
    pub(super) gravity: [f64; 2],
    pub(super) base: f64,
    /// Required if the links have masses.
    pub(super) payload: Option<f64>,
    #[serde(default = "elbows_out")]
    pub(super) working_mode: [String; 2],
    pub(super) home: Option<[f64; 2]>,
    pub(super) link: Vec<LinkFile>,
    #[serde(default)]
    pub(super) actuator: Vec<ActuatorFile>,
    #[serde(default)]
    pub(super) tool: Tool,
    #[serde(default)]
    pub(super) tool_output: ToolOutputFile,
    #[serde(default)]
    pub(super) limits: Limits,
    #[serde(default)]
    pub(super) motion: ToolLimits,
    #[serde(default)]
    pub(super) control: ControlFile,
    #[serde(default)]
    pub(super) supply: Supply,
    #[serde(default)]
    pub(super) protection: Protection,
    #[serde(default)]
    pub(super) homing: HomeSearch,
    #[serde(default)]
    pub(super) tolerance: ToleranceFile,
    #[serde(default)]
    pub(super) contact: Contact,
    #[serde(default)]
    pub(super) crossing: Crossing,
    #[serde(default)]
    pub(super) advanced: AdvancedSettings,
}

fn elbows_out() -> [String; 2] {
    ["right".into(), "left".into()]
}

/// `[[link]]`: the last three keys are given together for every link, or for none.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct LinkFile {
    pub(super) length: f64,
    pub(super) mass: Option<f64>,
    pub(super) com: Option<[f64; 2]>,
    pub(super) inertia: Option<f64>,
}

/// `[[actuator]]`: the motor, gear, encoder and current sensor of one driven joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Actuator {
    /// Motor turns per joint turn, negative if the motor turns against its joint.
    pub gear_ratio: f64,
    /// Rotor inertia at the motor shaft [kg·m²].
    pub rotor_inertia: f64,
    /// Torque constant [N·m/A], equal to the back-EMF constant [V·s/rad].
    pub torque_constant: f64,
    /// Winding resistance [Ω].
    pub resistance: f64,
    /// Winding inductance [H].
    pub inductance: f64,
    /// Viscous friction at the joint [N·m·s/rad].
    pub viscous_friction: f64,
    /// Coulomb friction at the joint [N·m].
    pub coulomb_friction: f64,
    /// Torque of the holding brake at the joint [N·m]; zero without a brake. An upright arm
    /// without brakes falls while it is unpowered.
    pub brake_torque: f64,
    /// Longest time from switching the holding brake off to its full torque [s]; none:
    /// `BRAKE_TIME` with a brake, 0 without one.
    pub brake_engage_time: Option<f64>,
    /// Longest time from switching the holding brake on to a free joint [s]; likewise.
    pub brake_release_time: Option<f64>,
    /// Encoder counts per motor turn, after quadrature. For an encoder at the joint: its
    /// counts per turn over the gear ratio.
    pub encoder_counts: u32,
    /// Peak motor current [A].
    pub peak_current: f64,
    /// Continuous motor current [A].
    pub continuous_current: f64,
    /// Time constant of the motor's heating [s].
    pub thermal_time_constant: f64,
    /// Motor current per ADC code [A]; by default ±2 × `peak_current` fills 12 bits.
    pub current_per_code: Option<f64>,
    /// Stiffness of the gear or belt at the joint [N·m/rad]; none: rigid.
    pub stiffness: Option<f64>,
    /// Damping beside the stiffness, at the joint [N·m·s/rad].
    pub drive_damping: f64,
    /// The shaft that the encoder measures.
    pub encoder_side: EncoderSide,
    /// Age of the encoder's angle when it is sampled [s].
    pub encoder_latency: f64,
    /// The encoder's known error, an angle of the encoder's shaft [rad]: its measured angle is
    /// the true one plus this.
    pub encoder_error: Harmonics,
    /// What it has besides, if it is a stepper. Its holding torque is then that at the peak current, and its counts are
    /// micro-steps.
    pub stepper: Option<Stepper>,
    /// What it has besides, if it is a drive on a bus. Its currents are then its torques over the torque constant, and its
    /// winding has the lag of its current loop.
    pub can: Option<CanTorque>,
    /// What it has besides, if it is a hobby servo. Its currents are then its torques over 1 N·m/A, and its counts the units
    /// of the timer that makes its pulses.
    pub hobby_servo: Option<HobbyServo>,
}

/// Time in which a holding brake of this size engages or releases, if the file has none [s]: data
/// sheets of spring-applied brakes have 0.02 to 0.05 s.
pub(super) const BRAKE_TIME: f64 = 0.05;

impl Actuator {
    /// What it is.
    pub fn kind(&self) -> DriveKind {
        match (&self.stepper, &self.can, &self.hobby_servo) {
            (Some(_), ..) => DriveKind::Stepper,
            (_, Some(_), _) => DriveKind::CanTorque,
            (.., Some(_)) => DriveKind::Servo,
            (None, None, None) => DriveKind::Brushed,
        }
    }

    /// The motor with its gear ratio and the friction at its joint.
    pub fn motor(&self) -> Motor {
        Motor {
            gear_ratio: self.gear_ratio,
            rotor_inertia: self.rotor_inertia,
            torque_constant: self.torque_constant,
            resistance: self.resistance,
            inductance: self.inductance,
            viscous_friction: self.viscous_friction,
            coulomb_friction: self.coulomb_friction,
        }
    }

    /// The gear or belt.
    pub fn transmission(&self) -> Transmission {
        Transmission {
            stiffness: self.stiffness,
            damping: self.drive_damping,
        }
    }

    /// The encoder, without its counts.
    pub fn encoder(&self) -> Encoder {
        Encoder {
            side: self.encoder_side,
            latency: self.encoder_latency,
            error: self.encoder_error,
        }
    }

    /// Longest times in which the holding brake engages and releases [s].
    pub fn brake_times(&self) -> [f64; 2] {
        let usual = if self.brake_torque > 0.0 {
            BRAKE_TIME
        } else {
            0.0
        };
        [self.brake_engage_time, self.brake_release_time].map(|time| time.unwrap_or(usual))
    }

    /// Torque at the joint at peak current [N·m].
    pub fn peak_torque(&self) -> f64 {
        self.peak_current * self.torque_per_ampere()
    }

    /// Torque at the joint per current, without sign [N·m/A].
    pub(super) fn torque_per_ampere(&self) -> f64 {
        self.torque_constant * self.gear_ratio.abs()
    }
}

/// `[tool]`: the tool, rigid on link 2.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Tool {
    /// Offset of the tool from C, along link 2 and to its left [m].
    pub offset: [f64; 2],
}

/// `[limits]` of the driven joints, and the singularity margin.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Limits {
    /// Least and greatest θ1, then θ4 [rad].
    pub angle: [[f64; 2]; 2],
    /// Greatest speed of each driven joint [rad/s].
    pub max_speed: [f64; 2],
    /// Greatest acceleration of each driven joint [rad/s²].
    pub max_acceleration: [f64; 2],
    /// Greatest torque at each driven joint [N·m], if it is less than the motor's.
    pub max_torque: Option<[f64; 2]>,
    /// Least allowed |sin| of the angles at the elbows and at C.
    pub singularity_margin: f64,
}

impl Default for Limits {
    /// One turn in both directions, speeds of small gearmotors, a margin of 0.1.
    fn default() -> Self {
        Self {
            angle: [[-TAU, TAU]; 2],
            max_speed: [default_of(&AxisField::MaxSpeed.row()); 2],
            max_acceleration: [default_of(&AxisField::MaxAcceleration.row()); 2],
            max_torque: None,
            singularity_margin: default_of(&Field::SingularityMargin.row()),
        }
    }
}

impl Limits {
    /// Whether θ1 and θ4 [rad] are both within their limits.
    pub fn contain(&self, angles: [f64; 2]) -> bool {
        let within =
            |(angle, [least, greatest]): (f64, [f64; 2])| least <= angle && angle <= greatest;
        angles.into_iter().zip(self.angle).all(within)
    }
}

/// `[motion]`: limits of the tool's motion.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ToolLimits {
    /// Greatest speed along the path [m/s].
    pub max_speed: f64,
    /// Greatest acceleration of the tool [m/s²].
    pub max_acceleration: f64,
    /// Greatest jerk of the tool [m/s³].
    pub max_jerk: f64,
    /// Greatest distance of a rounded corner from the path [m]; with 0 the tool stops at
    /// corners.
    pub corner_tolerance: f64,
}

impl Default for ToolLimits {
    fn default() -> Self {
        Self {
            max_speed: default_of(&Field::MaxSpeed.row()),
            max_acceleration: default_of(&Field::MaxAcceleration.row()),
            max_jerk: default_of(&Field::MaxJerk.row()),
            corner_tolerance: default_of(&Field::CornerTolerance.row()),
        }
    }
}

/// `[control]`: what the file gives. The rest follows from the arm.
#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(super) struct ControlFile {
    pub(super) tick_rate: Option<f64>,
    pub(super) bandwidth: Option<f64>,
    pub(super) damping: Option<f64>,
    pub(super) integral_rate: Option<f64>,
    pub(super) observer_bandwidth: Option<f64>,
    pub(super) current_bandwidth: Option<f64>,
}

/// Tick rate and bandwidths of the control loops.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Control {
    /// Tick rate [Hz].
    pub tick_rate: f64,
    /// Bandwidth of the position loop [rad/s].
    pub bandwidth: f64,
    /// Damping ratio of the position loop.
    pub damping: f64,
    /// Rate at which the integral action removes a steady error [rad/s]; 0: no integral.
    pub integral_rate: f64,
    /// Bandwidth of the velocity observer [rad/s].
    pub observer_bandwidth: f64,
    /// Bandwidth of the current loop [rad/s].
    pub current_bandwidth: f64,
}

impl Default for Control {
    /// For an arm whose masses are not known: each inner loop is much faster than the loop around
    /// it; all are much slower than the tick of 10 kHz.
    fn default() -> Self {
        Self {
            tick_rate: default_of(&Field::TickRate.row()),
            bandwidth: default_of(&Field::Bandwidth.row()),
            damping: default_of(&Field::Damping.row()),
            integral_rate: default_of(&Field::IntegralRate.row()),
            observer_bandwidth: default_of(&Field::ObserverBandwidth.row()),
            current_bandwidth: default_of(&Field::CurrentBandwidth.row()),
        }
    }
}

/// `[supply]`: the bus that powers the bridges.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Supply {
    /// Nominal bus voltage [V].
    pub voltage: f64,
    /// Bus voltage below and above which the arm stops [V]; by default nominal ∓30 %.
    pub range: Option<[f64; 2]>,
    /// Bus voltage per ADC code [V]; by default twice the nominal voltage fills 12 bits.
    pub voltage_per_code: Option<f64>,
}

impl Default for Supply {
    fn default() -> Self {
        Self {
            voltage: 24.0,
            range: None,
            voltage_per_code: None,
        }
    }
}

/// `[protection]`: the trip points of the other monitors.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Protection {
    /// Greatest joint position error [rad].
    pub following_error: f64,
    /// Greatest joint speed, as a multiple of `limits.max_speed`.
    pub over_speed: f64,
    /// Greatest motor current, as a multiple of the peak current.
    pub over_current: f64,
    /// Longest time without a sign of life of the host while the arm moves [s].
    pub command_timeout: f64,
}

impl Default for Protection {
    fn default() -> Self {
        Self {
            following_error: default_of(&Field::FollowingError.row()),
            over_speed: 1.5,
            over_current: 1.5,
            command_timeout: default_of(&Field::CommandTimeout.row()),
        }
    }
}

/// `[crossing]`: whether the arm may cross singularities of type 2 by momentum.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Crossing {
    /// Whether the links clear each other where B, C and D are in line or B meets D.
    pub allowed: bool,
    /// Drag at the tip that a crossing must overcome [N].
    pub drag: f64,
}

/// `[tolerance]` as written: each key has one number for all, or a list.
#[derive(Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(super) struct ToleranceFile {
    pub(super) length_sd: OneOrEach,
    pub(super) input_sd: OneOrEach,
    pub(super) input_max: OneOrEach,
    pub(super) clearance_radius: OneOrEach,
}

/// One number for all, or a list with one number for each.
#[derive(Clone, Debug, Deserialize)]
#[serde(untagged, expecting = "expected a number or a list of numbers")]
pub(super) enum OneOrEach {
    One(f64),
    Each(Vec<f64>),
}

impl Default for OneOrEach {
    fn default() -> Self {
        Self::One(0.0)
    }
}
