//! What the controller knows of its arm, in SI units and `f32`. [`Settings`] are one flat value
//! that is stored and sent as a whole; [`Settings::check`] makes [`CheckedSettings`] of them, which
//! the controller takes.

mod arm;
mod belt;
mod benchtop;
mod board;
mod bus;
mod check;
mod checked;
mod encoder_table;
mod error;
mod field_lag;
mod homing;
mod row;
mod servo_pulse;
mod table;
mod tool_output;

use serde::{Deserialize, Serialize};

pub use belt::{BeltSettings, MOST_LATE_TICKS};
pub use board::BoardLimits;
pub use bus::BusKind;
pub use checked::CheckedSettings;
pub use encoder_table::{ENCODER_POINTS, ENCODER_UNIT, EncoderTable};
pub use error::SettingsError;
pub use field_lag::FieldLag;
pub(crate) use homing::{CREEP, INDEX_SAMPLES};
pub use homing::{HomeReference, HomingMethod, HomingSettings, INDEX_MARGIN};
pub use row::{Must, Row};
pub use servo_pulse::ServoPulse;
pub use table::{AdvancedSettings, AxisField, Field, LONGEST_STOP, rows};
pub use tool_output::{ALWAYS, Share, ToolOutputSettings};

/// Inertia of one link, see `fivebar_kinematics::dynamics::Link`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LinkSettings {
    /// Mass [kg].
    pub mass: f32,
    /// Centre of mass, along the link and to its left, from A, B, D or E [m].
    pub com: [f32; 2],
    /// Moment of inertia about the centre of mass [kg·m²].
    pub inertia: f32,
}

/// One driven joint: its motor, gear, encoder and limits.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct AxisSettings {
    /// Motor turns per joint turn; negative if the motor turns against its joint.
    pub gear_ratio: f32,
    /// Rotor inertia at the motor shaft [kg·m²].
    pub rotor_inertia: f32,
    /// Torque constant [N·m/A], equal to the back-EMF constant [V·s/rad].
    pub torque_constant: f32,
    /// Winding resistance [Ω].
    pub resistance: f32,
    /// Winding inductance [H].
    pub inductance: f32,
    /// Viscous friction at the joint [N·m·s/rad].
    pub viscous_friction: f32,
    /// Coulomb friction at the joint [N·m].
    pub coulomb_friction: f32,
    /// Encoder counts per motor turn, after quadrature.
    pub encoder_counts: u32,
    /// Encoder counts from one index pulse to the next.
    pub index_counts: u32,
    /// Age of the encoder's angle when it is sampled [s].
    pub encoder_latency: f32,
    /// Joint angle at which the home switch closes, or at the index pulse [rad].
    pub home_angle: f32,
    /// Whether the joint's angle grows towards its switch.
    pub home_forward: bool,
    /// Least and greatest joint angle [rad].
    pub angle_limits: [f32; 2],
    /// Greatest joint speed [rad/s].
    pub max_speed: f32,
    /// Greatest joint acceleration [rad/s²].
    pub max_acceleration: f32,
    /// Peak motor current [A].
    pub peak_current: f32,
    /// Continuous motor current [A].
    pub continuous_current: f32,
    /// Time constant of the motor's heating [s].
    pub thermal_time_constant: f32,
    /// Current per ADC code [A].
    pub current_per_code: f32,
    /// ADC code at zero current.
    pub current_zero_code: u16,
}

/// The control loops.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ControlSettings {
    /// Tick rate [Hz].
    pub tick_rate: f32,
    /// Bandwidth of the position loop [rad/s].
    pub bandwidth: f32,
    /// Its damping ratio, without the integral.
    pub damping: f32,
    /// Rate at which the integral removes a constant error [rad/s]; 0 turns it off.
    pub integral_rate: f32,
    /// Bandwidth of the velocity observer [rad/s].
    pub observer_bandwidth: f32,
    /// Bandwidth of the current loop [rad/s].
    pub current_bandwidth: f32,
    /// Joint speed at which half of the Coulomb friction is compensated [rad/s].
    pub friction_smoothing: f32,
    /// Feed the arm's model forward (computed torque); off: PID at each joint, with
    /// feed-forward of acceleration and friction.
    pub computed_torque: bool,
}

/// Limits of the tool's motion.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct MotionSettings {
    /// Greatest speed along the path [m/s].
    pub max_speed: f32,
    /// Greatest acceleration of the tool [m/s²].
    pub max_acceleration: f32,
    /// Greatest jerk of the tool [m/s³].
    pub max_jerk: f32,
    /// Corner tolerance: greatest distance of a rounded corner from the path [m]; with 0 the tool
    /// stops at corners.
    pub corner_tolerance: f32,
    /// Least |sin| of the angle at an elbow or at C on planned paths. At half of it, the arm has
    /// left its envelope, which is a fault.
    pub singularity_margin: f32,
}

/// The trip points of the monitor.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ProtectionSettings {
    /// Greatest joint position error [rad].
    pub following_error: f32,
    /// Joint speed that is a fault [rad/s].
    pub over_speed: f32,
    /// Motor current that is a fault [A].
    pub over_current: f32,
    /// Least and greatest bus voltage [V].
    pub bus_voltage: [f32; 2],
    /// Bus voltage per ADC code [V].
    pub bus_voltage_per_code: f32,
    /// Silence of the host that is a fault while the arm moves [s].
    pub command_timeout: f32,
}

/// The holding brakes, which engage without power. Without brakes both times are 0.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct BrakeSettings {
    /// Longest time from switching a brake off to its full torque [s].
    pub engage_time: f32,
    /// Longest time from switching a brake on to a free joint [s].
    pub release_time: f32,
}

impl BrakeSettings {
    /// No brakes.
    pub const NONE: Self = Self {
        engage_time: 0.0,
        release_time: 0.0,
    };
}

/// The controller's whole configuration, not checked yet. Index 0 of a pair is joint 1, index 1
/// joint 4.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Settings {
    /// l1…l4 and the base [m].
    pub lengths: [f32; 5],
    /// Inertia of links 1 to 4.
    pub links: [LinkSettings; 4],
    /// Point mass at C [kg].
    pub payload: f32,
    /// In-plane gravity [m/s²].
    pub gravity: [f32; 2],
    /// The tool's position from C, along link 2 and to its left [m].
    pub tool_offset: [f32; 2],
    /// Whether each elbow turns left at home, leg 1 being A–B–tool: the working mode.
    pub elbows_left: [bool; 2],
    /// Whether C lies left of the ray B→D: the assembly mode.
    pub assembly_left: bool,
    /// The driven joints.
    pub axes: [AxisSettings; 2],
    /// Their encoders' known errors.
    pub encoder_tables: [EncoderTable; 2],
    /// The loops.
    pub control: ControlSettings,
    /// The search for the home switches.
    pub homing: HomingSettings,
    /// The source of the joints' angles.
    pub home_reference: HomeReference,
    /// The tool's limits.
    pub motion: MotionSettings,
    /// The trip points.
    pub protection: ProtectionSettings,
    /// The output for a tool.
    pub tool_output: ToolOutputSettings,
    /// Whether the links clear each other where B, C and D are in line, or B meets D, so that the arm
    /// may cross this singularity.
    pub crossing_allowed: bool,
    /// The holding brakes.
    pub brake: BrakeSettings,
    /// Numbers that fit most arms.
    #[serde(default)]
    pub advanced: AdvancedSettings,
    /// What stretches between the motors and their joints.
    #[serde(default)]
    pub belts: [BeltSettings; 2],
    /// Of the rotors of steppers behind their fields.
    #[serde(default)]
    pub field_lags: [FieldLag; 2],
}
