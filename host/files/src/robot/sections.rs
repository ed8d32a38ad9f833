//! The sections of the robot file with keys of their own, and their defaults.
//!
//! All values are in SI units and radians. Unknown keys are refused.

use fivebar_firmware::settings::{AxisField, Field, Row};
use serde::Deserialize;
use std::f64::consts::TAU;

/// The default of a setting that has the same one on every arm; of another, not a number.
pub(super) fn default_of(row: &Row) -> f64 {
    row.default.unwrap_or(f64::NAN)
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
