//! The robot file as written: its sections, their keys and their defaults.
//!
//! SI units and radians throughout. Keys that are not named here are refused.

use super::Contact;
use serde::Deserialize;
use std::f64::consts::TAU;

/// The whole file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RobotFile {
    pub(super) name: String,
    pub(super) gravity: [f64; 2],
    pub(super) base: f64,
    /// May be left out where the links have no masses.
    pub(super) payload: Option<f64>,
    #[serde(default = "elbows_out")]
    pub(super) working_mode: [String; 2],
    pub(super) home: Option<[f64; 2]>,
    pub(super) link: Vec<LinkFile>,
    #[serde(default)]
    pub(super) actuator: Vec<Actuator>,
    #[serde(default)]
    pub(super) tool: Tool,
    #[serde(default)]
    pub(super) limits: Limits,
    #[serde(default)]
    pub(super) motion: Motion,
    #[serde(default)]
    pub(super) control: Control,
    #[serde(default)]
    pub(super) supply: Supply,
    #[serde(default)]
    pub(super) protection: Protection,
    #[serde(default)]
    pub(super) tolerance: ToleranceFile,
    #[serde(default)]
    pub(super) contact: Contact,
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
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Actuator {
    /// Motor turns per joint turn, below zero where the motor turns against its joint.
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
    #[serde(default)]
    pub viscous_friction: f64,
    /// Coulomb friction at the joint [N·m].
    #[serde(default)]
    pub coulomb_friction: f64,
    /// Torque of the holding brake at the joint [N·m]; zero where none is fitted. An arm
    /// that gravity pulls needs one: it falls while unpowered else.
    #[serde(default)]
    pub brake_torque: f64,
    /// Encoder counts per motor turn, after quadrature.
    pub encoder_counts: u32,
    /// Peak motor current [A].
    pub peak_current: f64,
    /// Current the motor bears for ever [A].
    pub continuous_current: f64,
    /// Time constant of the motor's heating [s].
    pub thermal_time_constant: f64,
    /// Motor current per ADC code [A]; without it ±2 × `peak_current` fills 12 bits.
    pub current_per_code: Option<f64>,
}

impl Actuator {
    /// What it gives its joint at peak current [N·m].
    pub fn peak_torque(&self) -> f64 {
        self.peak_current * self.torque_per_ampere()
    }

    /// What an ampere gives its joint, either way [N·m/A].
    pub(super) fn torque_per_ampere(&self) -> f64 {
        self.torque_constant * self.gear_ratio.abs()
    }
}

/// `[tool]`: the tool, rigid on link 2.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Tool {
    /// The tool from C, along link 2 and to its left [m].
    pub offset: [f64; 2],
}

/// `[limits]` of the driven joints, and the distance kept from singularities.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Limits {
    /// Least and greatest θ1, then θ4 [rad].
    pub angle: [[f64; 2]; 2],
    /// Greatest speed of each driven joint [rad/s].
    pub max_speed: [f64; 2],
    /// Greatest acceleration of each driven joint [rad/s²].
    pub max_acceleration: [f64; 2],
    /// Greatest torque at each driven joint [N·m], where less than the motor's own.
    pub max_torque: Option<[f64; 2]>,
    /// Least |sin| of the angle at an elbow or at C.
    pub singularity_margin: f64,
}

impl Default for Limits {
    /// A turn either way, the speeds of small gearmotors, 0.1 of a right angle's sine.
    fn default() -> Self {
        Self {
            angle: [[-TAU, TAU]; 2],
            max_speed: [20.0; 2],
            max_acceleration: [1000.0; 2],
            max_torque: None,
            singularity_margin: 0.1,
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
pub struct Motion {
    /// Greatest speed along the path [m/s].
    pub max_speed: f64,
    /// Greatest acceleration of the tool [m/s²].
    pub max_acceleration: f64,
    /// Greatest jerk of the tool [m/s³].
    pub max_jerk: f64,
    /// How far a rounded corner may leave the path [m]; 0 stops at corners.
    pub corner_tolerance: f64,
}

impl Default for Motion {
    fn default() -> Self {
        Self {
            max_speed: 0.3,
            max_acceleration: 3.0,
            max_jerk: 150.0,
            corner_tolerance: 5e-5,
        }
    }
}

/// `[control]`: how the loops are closed.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Control {
    /// Tick rate [Hz].
    pub tick_rate: f64,
    /// Bandwidth of the position loop [rad/s].
    pub bandwidth: f64,
    /// Its damping ratio.
    pub damping: f64,
    /// Rate at which the integral action takes up a steady error [rad/s]; 0: none.
    pub integral_rate: f64,
    /// Bandwidth of the velocity observer [rad/s].
    pub observer_bandwidth: f64,
    /// Bandwidth of the current loop [rad/s].
    pub current_bandwidth: f64,
}

impl Default for Control {
    /// Each inner loop well above the one around it, all well below a 10 kHz tick.
    fn default() -> Self {
        Self {
            tick_rate: 10_000.0,
            bandwidth: 200.0,
            damping: 1.0,
            integral_rate: 20.0,
            observer_bandwidth: 1500.0,
            current_bandwidth: 3000.0,
        }
    }
}

/// `[supply]`: the bus that feeds the bridges.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Supply {
    /// Nominal bus voltage [V].
    pub voltage: f64,
    /// Bus voltage below and above which the arm stops [V]; else ∓30 % of nominal.
    pub range: Option<[f64; 2]>,
    /// Bus voltage per ADC code [V]; else 12 bits hold twice the nominal.
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

/// `[protection]`: the other trip points.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Protection {
    /// Greatest joint position error [rad].
    pub following_error: f64,
    /// Joint speed that is a fault, as a multiple of `limits.max_speed`.
    pub over_speed: f64,
    /// Motor current that is a fault, as a multiple of its peak.
    pub over_current: f64,
    /// Silence of the host that is a fault while moving [s].
    pub command_timeout: f64,
}

impl Default for Protection {
    fn default() -> Self {
        Self {
            following_error: 0.1,
            over_speed: 1.5,
            over_current: 1.5,
            command_timeout: 0.1,
        }
    }
}

/// `[tolerance]` as written: each key one number for all, or one for each.
#[derive(Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(super) struct ToleranceFile {
    pub(super) length_sd: OneOrEach,
    pub(super) input_sd: OneOrEach,
    pub(super) input_max: OneOrEach,
    pub(super) clearance_radius: OneOrEach,
}

/// One number for all, or one for each.
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
