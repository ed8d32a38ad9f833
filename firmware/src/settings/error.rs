//! Why settings are invalid, by field.

use core::fmt;
use fivebar_kinematics::dynamics::ModelError;
use fivebar_kinematics::five_bar::GeometryError;

/// A field of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(
    missing_docs,
    reason = "each is the field of AxisSettings of this name, or the encoder's table"
)]
#[non_exhaustive]
pub enum AxisField {
    GearRatio,
    RotorInertia,
    TorqueConstant,
    Resistance,
    Inductance,
    ViscousFriction,
    CoulombFriction,
    EncoderCounts,
    EncoderLatency,
    EncoderTable,
    HomeAngle,
    AngleLimits,
    MaxSpeed,
    MaxAcceleration,
    PeakCurrent,
    ContinuousCurrent,
    ThermalTimeConstant,
    CurrentPerCode,
}

/// A field outside the axes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "each is the field of Settings of this name")]
#[non_exhaustive]
pub enum Field {
    ToolOffset,
    TickRate,
    Bandwidth,
    Damping,
    IntegralRate,
    ObserverBandwidth,
    CurrentBandwidth,
    FrictionSmoothing,
    HomingSpeed,
    HomingBackOff,
    HomingSamples,
    HomingMethod,
    HomingCurrent,
    MaxSpeed,
    MaxAcceleration,
    MaxJerk,
    CornerTolerance,
    SingularityMargin,
    FollowingError,
    OverSpeed,
    OverCurrent,
    BusVoltage,
    BusVoltagePerCode,
    CommandTimeout,
    BrakeEngageTime,
    BrakeReleaseTime,
    ToolPulseWidth,
    ToolFrameRate,
    ToolSettleTime,
    ToolFrequency,
}

/// Why settings are refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum SettingsError {
    /// The lengths are not those of a five-bar.
    Geometry(GeometryError),
    /// A mass or an inertia is invalid.
    Inertia(ModelError),
    /// A field of joint 1 or 4.
    Axis(u8, AxisField),
    /// Another field.
    Field(Field),
    /// The board has this one tick rate [Hz].
    BoardTickRate(u32),
    /// The filters at the board's encoder inputs pass so many counts per second.
    BoardCountRate(u32),
    /// The board's bridges stand this current [A].
    BoardCurrent(u32),
    /// The board's bridges stand this bus voltage [V].
    BoardVoltage(u32),
    /// The board's counters start at 0, so its encoders are not absolute.
    BoardEncoders,
    /// No pose within the joint limits is on the branch and keeps the singularity margin.
    NoPose,
}

impl AxisField {
    /// The field's name and what it must be.
    fn rule(self) -> (&'static str, &'static str) {
        match self {
            Self::GearRatio => ("gear_ratio", "must be ±0.001 to ±10 000"),
            Self::RotorInertia => ("rotor_inertia", "must lie in 0 to 1 kg·m²"),
            Self::TorqueConstant => ("torque_constant", "must lie in 1e-6 to 1000 N·m/A"),
            Self::Resistance => ("resistance", "must lie in 1e-5 to 1e5 Ω"),
            Self::Inductance => ("inductance", "must lie in 1e-9 to 1000 H"),
            Self::ViscousFriction => ("viscous_friction", "must lie in 0 to 10 000 N·m·s/rad"),
            Self::CoulombFriction => ("coulomb_friction", "must lie in 0 to 10 000 N·m"),
            Self::EncoderCounts => (
                "encoder_counts",
                "must be positive, and at most 4 194 304 per turn of the joint",
            ),
            Self::EncoderLatency => ("encoder_latency", "must lie in 0 to 0.1 s"),
            Self::EncoderTable => (
                "encoder_error",
                "must change by less than a third of the shaft's angle",
            ),
            Self::HomeAngle => ("home_angle", "must be within ±2π [rad]"),
            Self::AngleLimits => ("angle_limits", "must be rising and within ±2π [rad]"),
            Self::MaxSpeed => ("max_speed", "must lie in 0.001 to 10 000 rad/s"),
            Self::MaxAcceleration => (
                "max_acceleration",
                "must lie in 0.001 to 1e7 rad/s², and stop the joint from max_speed within 10 s",
            ),
            Self::PeakCurrent => (
                "peak_current",
                "must lie in 1e-4 to 1e5 A, and be at most 4 times the stall current, the upper end of \
                 bus_voltage over resistance",
            ),
            Self::ContinuousCurrent => (
                "continuous_current",
                "must be positive and at most the peak current [A]",
            ),
            Self::ThermalTimeConstant => ("thermal_time_constant", "must lie in 0.1 to 3600 s"),
            Self::CurrentPerCode => ("current_per_code", "must lie in 1e-8 to 1000 A"),
        }
    }
}

impl Field {
    /// The field's name and what it must be.
    fn rule(self) -> (&'static str, &'static str) {
        match self {
            Self::ToolOffset => ("tool_offset", "must be finite [m]"),
            Self::TickRate => ("control.tick_rate", "must lie in 100 to 50 000 Hz"),
            Self::Bandwidth => (
                "control.bandwidth",
                "must be positive and at most a quarter of current_bandwidth [rad/s]",
            ),
            Self::Damping => ("control.damping", "must lie in 0.2 to 2"),
            Self::IntegralRate => (
                "control.integral_rate",
                "must lie between 0 and a quarter of bandwidth [rad/s]",
            ),
            Self::ObserverBandwidth => (
                "control.observer_bandwidth",
                "must lie between twice bandwidth and the tick rate [rad/s]",
            ),
            Self::CurrentBandwidth => (
                "control.current_bandwidth",
                "must be positive and at most 0.35 times the tick rate [rad/s]",
            ),
            Self::FrictionSmoothing => ("control.friction_smoothing", "must be positive [rad/s]"),
            Self::HomingSpeed => (
                "homing.speed",
                "must be positive and at most the least max_speed [rad/s]",
            ),
            Self::HomingBackOff => ("homing.back_off", "must be positive and under 1 rad"),
            Self::HomingSamples => ("home_reference.samples", "must be 1 to 255"),
            Self::HomingMethod => (
                "home_reference.method",
                "index pulses need index_counts and a homing.speed at which no pulse is missed; hard \
                 stops need the continuous current at most, samples before half of \
                 following_error, and angle_limits that end at most back_off before the stop; \
                 absolute encoders need angle_limits of a turn at most",
            ),
            Self::HomingCurrent => (
                "homing.current",
                "must be positive and at most the least peak_current [A]",
            ),
            Self::MaxSpeed => ("motion.max_speed", "must be positive [m/s]"),
            Self::MaxAcceleration => (
                "motion.max_acceleration",
                "must be positive, and stop the tool from max_speed within 10 s [m/s²]",
            ),
            Self::MaxJerk => (
                "motion.max_jerk",
                "must be positive, and stop the tool from max_speed within 10 s [m/s³]",
            ),
            Self::CornerTolerance => ("motion.corner_tolerance", "must not be negative [m]"),
            Self::SingularityMargin => ("motion.singularity_margin", "must lie within 0 and 1"),
            Self::FollowingError => ("protection.following_error", "must lie within 0 and 1 rad"),
            Self::OverSpeed => (
                "protection.over_speed",
                "must be 1 to 100 times the greatest max_speed [rad/s]",
            ),
            Self::OverCurrent => (
                "protection.over_current",
                "must be 1 to 5 times the greatest peak_current, and within what the converters show [A]",
            ),
            Self::BusVoltage => (
                "protection.bus_voltage",
                "must be positive and rising, and begin at a fiftieth of its end or above [V]",
            ),
            Self::BusVoltagePerCode => (
                "protection.bus_voltage_per_code",
                "must be positive, and the converter must show more than bus_voltage's upper end [V]",
            ),
            Self::CommandTimeout => (
                "protection.command_timeout",
                "must last at least one tick and at most 60 s",
            ),
            Self::BrakeEngageTime => ("brake.engage_time", "must lie in 0 to 1 s"),
            Self::BrakeReleaseTime => ("brake.release_time", "must lie in 0 to 1 s"),
            Self::ToolPulseWidth => (
                "tool_output: up_width and down_width",
                "must differ, lie in 0.0001 to 0.005 s, and take 90 % of a frame at most",
            ),
            Self::ToolFrameRate => ("tool_output.frame_rate", "must lie in 40 to 400 Hz"),
            Self::ToolSettleTime => (
                "tool_output: down_time and up_time",
                "must lie in 0 to 10 s",
            ),
            Self::ToolFrequency => ("tool_output.frequency", "must lie in 10 to 100 000 Hz"),
        }
    }
}

impl fmt::Display for SettingsError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Geometry(error) => error.fmt(f),
            Self::Inertia(error) => error.fmt(f),
            Self::Axis(joint, field) => {
                let (name, rule) = field.rule();
                write!(f, "joint {joint}: {name} {rule}")
            }
            Self::Field(field) => {
                let (name, rule) = field.rule();
                write!(f, "{name} {rule}")
            }
            Self::BoardTickRate(rate) => {
                write!(f, "control.tick_rate must be {rate} Hz, the board's")
            }
            Self::BoardCountRate(rate) => write!(
                f,
                "protection.over_speed must give at most {rate} encoder counts/s, which the \
                 board's input filters pass"
            ),
            Self::BoardCurrent(greatest) => write!(
                f,
                "protection.over_current must be at most {greatest} A, which the board's bridges \
                 stand"
            ),
            Self::BoardVoltage(greatest) => write!(
                f,
                "protection.bus_voltage must end at {greatest} V or below, which the board's \
                 bridges stand"
            ),
            Self::BoardEncoders => f.write_str(
                "home_reference.method must not be absolute: the board's counters start at 0 with \
                 the power, wherever the arm stands; use switch, hard-stop or given",
            ),
            Self::NoPose => f.write_str(
                "no pose within angle_limits is on the branch of elbows_left and assembly_left \
                 and keeps singularity_margin",
            ),
        }
    }
}

impl core::error::Error for SettingsError {}
