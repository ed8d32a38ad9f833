//! The table of the settings: of each number its keys, its unit, its bounds, its default and its
//! meaning. The controller's check, the sentences of refusals, the robot file, the questions of
//! `fivebar new`, `fivebar settings show` and the table `docs/use/settings.csv` follow from it.
//!
//! The check needs the bounds alone, so the texts are in no image.

use super::row::{Row, advanced, fields};
use super::{AxisSettings, FieldLag, Settings};
use core::f32::consts::TAU;
use fivebar_kinematics::Scalar;
use serde::{Deserialize, Serialize};

/// Counts of a whole turn that `f32` can resolve, with two bits to spare.
const MAX_COUNTS_PER_TURN: f32 = 4_194_304.0;

/// The greatest code of the 12-bit converters.
const FULL_SCALE: f32 = 4095.0;

/// The longest that a stop may take [s]. The planner hands out the path for a stop in advance, and
/// nobody waits longer for an arm to stop.
pub const LONGEST_STOP: f32 = 10.0;

/// The trip point of speed over the greatest speed of the joints.
const SPEED_TRIP: [f32; 2] = [1.0, 100.0];

/// The trip point of current over the greatest peak current of the motors.
const CURRENT_TRIP: [f32; 2] = [1.0, 5.0];

/// Greatest peak current over the stall current at the highest bus voltage. A motor that turns at its no-load
/// speed can be braked with twice the stall current; beyond four times nothing can be measured.
const STALL: f32 = 4.0;

/// The lowest bus voltage over the highest.
const BUS: f32 = 0.02;

/// Greatest part of a frame that a servo's pulse may take.
pub(super) const LONGEST_PULSE: f32 = 0.9;

/// The least number above 0, and the greatest below 1: bounds that a value may not reach.
const ABOVE_0: f32 = f32::from_bits(1);
const BELOW_1: f32 = 1.0 - 0.5 * f32::EPSILON;

// The bounds are wide: within them nothing in the loops overflows or vanishes in `f32`.
fields! {
    /// A field of an axis.
    AxisField of axis: AxisSettings;
    GearRatio {
        "actuator.gear_ratio" as "axes.gear_ratio",
        "Gear ratio, motor turns per joint turn" [""];
        Scalar::abs(axis.gear_ratio) => 0.001 to 10_000, "must be ±0.001 to ±10 000"
    }
    RotorInertia {
        "actuator.rotor_inertia" as "axes.rotor_inertia",
        "Rotor inertia" ["kg·m²", "at the motor's shaft"];
        axis.rotor_inertia => 0 to 1
    }
    TorqueConstant {
        "actuator.torque_constant" as "axes.torque_constant",
        "Torque constant" ["N·m/A"];
        axis.torque_constant => 1e-6 to 1000
    }
    Resistance {
        "actuator.resistance" as "axes.resistance",
        "Winding resistance" ["Ω"];
        axis.resistance => 1e-5 to 1e5
    }
    Inductance {
        "actuator.inductance" as "axes.inductance",
        "Winding inductance" ["H"];
        axis.inductance => 1e-9 to 1000
    }
    ViscousFriction {
        "actuator.viscous_friction" as "axes.viscous_friction",
        "Viscous friction" ["N·m·s/rad", "at the joint"] = 0.0;
        axis.viscous_friction => 0 to 10_000
    }
    CoulombFriction {
        "actuator.coulomb_friction" as "axes.coulomb_friction",
        "Coulomb friction" ["N·m", "at the joint"] = 0.0;
        axis.coulomb_friction => 0 to 10_000
    }
    EncoderCounts {
        "actuator.encoder_counts" as "axes.encoder_counts" axes [GearRatio],
        "Encoder counts per motor turn, after quadrature" ["", "counts per motor turn"];
        axis.encoder_counts as f32 =>
            if axis.encoder_counts > 0 && axis.counts_per_turn() <= MAX_COUNTS_PER_TURN,
            "must be positive, and at most 4 194 304 per turn of the joint"
    }
    EncoderLatency {
        "actuator.encoder_latency" as "axes.encoder_latency",
        "Age of the encoder's angle when it is sampled" ["s"] = 0.0;
        axis.encoder_latency => 0 to 0.1
    }
    // Checked with the table, which is not of the axis.
    EncoderTable {
        "actuator.encoder_error" as "axes.encoder_error",
        "Known error of the encoder" ["rad"];
        0.0 => if true, "must change by less than a third of the shaft's angle"
    }
    HomeAngle {
        "home" as "axes.home_angle",
        "Joint angle at the home switch, the hard stop or the index pulse" ["rad"];
        axis.home_angle => [-TAU, TAU], "must be within ±2π"
    }
    AngleLimits {
        "limits.angle" as "axes.angle_limits",
        "Least and greatest joint angle" ["rad"];
        axis.angle_limits[0] =>
            if rising(axis.angle_limits)
                && axis.angle_limits.iter().all(|&angle| Scalar::abs(angle) <= TAU),
            "must be rising and within ±2π"
    }
    MaxSpeed {
        "limits.max_speed" as "axes.max_speed",
        "Greatest joint speed" ["rad/s"] = 20.0;
        axis.max_speed => 0.001 to 10_000
    }
    MaxAcceleration {
        "limits.max_acceleration" as "axes.max_acceleration" axes [MaxSpeed],
        "Greatest joint acceleration" ["rad/s²"] = 1000.0;
        axis.max_acceleration => 0.001 to 1e7,
            and stops_in_time(axis.max_speed, axis.max_acceleration),
            "stop the joint from `max_speed` within 10 s"
    }
    // The share of the stall current is checked where the bus voltage is known to be valid.
    PeakCurrent {
        "actuator.peak_current" as "axes.peak_current",
        "Peak current" ["A"];
        axis.peak_current => 1e-4 to 1e5, and true,
            "be at most 4 times the stall current, the upper end of `bus_voltage` over `resistance`"
    }
    ContinuousCurrent {
        "actuator.continuous_current" as "axes.continuous_current" axes [PeakCurrent],
        "Continuous current" ["A"];
        axis.continuous_current => [ABOVE_0, axis.peak_current],
            "must be positive and at most `peak_current`"
    }
    // Of the winding of a tiny motor, of a large one with its housing. With a longer one the model
    // of the heat would protect no motor.
    ThermalTimeConstant {
        "actuator.thermal_time_constant" as "axes.thermal_time_constant",
        "Time constant of heating" ["s"];
        axis.thermal_time_constant => 0.1 to 3600
    }
    CurrentPerCode {
        "actuator.current_per_code" as "axes.current_per_code",
        "Motor current per code of the converter" ["A", "per ADC code"];
        axis.current_per_code => 1e-8 to 1000
    }
}

fields! {
    /// A field outside the axes.
    Field of all: Settings;
    ToolOffset {
        "tool.offset" as "tool_offset",
        "Position of the tool from C, along link 2 and to its left" ["m"];
        all.tool_offset[0] =>
            if all.tool_offset.iter().all(|length| length.is_finite()), "must be finite"
    }
    TickRate {
        "control.tick_rate" as "control.tick_rate",
        "Ticks per second" ["Hz"] = 10_000.0;
        all.control.tick_rate => 100 to 50000
    }
    CurrentBandwidth {
        "control.current_bandwidth" as "control.current_bandwidth" beside [TickRate],
        "Bandwidth of the current loop" ["rad/s"] = 3000.0;
        all.control.current_bandwidth => [ABOVE_0, 0.35 * all.control.tick_rate],
            "must be positive and at most 0.35 times `tick_rate`"
    }
    Bandwidth {
        "control.bandwidth" as "control.bandwidth" beside [CurrentBandwidth],
        "Bandwidth of the position loop" ["rad/s"] = 200.0;
        all.control.bandwidth => [ABOVE_0, 0.25 * all.control.current_bandwidth],
            "must be positive and at most a quarter of `current_bandwidth`"
    }
    Damping {
        "control.damping" as "control.damping",
        "Damping ratio of the position loop, without the integral" [""] = 1.0;
        all.control.damping => 0.2 to 2
    }
    IntegralRate {
        "control.integral_rate" as "control.integral_rate" beside [Bandwidth],
        "Rate at which the integral removes a constant error; 0: no integral" ["rad/s"] = 20.0;
        all.control.integral_rate => [0.0, 0.25 * all.control.bandwidth],
            "must lie between 0 and a quarter of `bandwidth`"
    }
    ObserverBandwidth {
        "control.observer_bandwidth" as "control.observer_bandwidth" beside [Bandwidth, TickRate],
        "Bandwidth of the velocity observer" ["rad/s"] = 1500.0;
        all.control.observer_bandwidth => [2.0 * all.control.bandwidth, all.control.tick_rate],
            "must lie between twice `bandwidth` and `tick_rate`"
    }
    FrictionSmoothing {
        "" as "control.friction_smoothing",
        "Joint speed at which half of the Coulomb friction is compensated" ["rad/s"];
        all.control.friction_smoothing => [ABOVE_0, f32::MAX], "must be positive"
    }
    HomingSpeed {
        "homing.speed" as "homing.speed" axes [MaxSpeed],
        "Speed of the first approach" ["rad/s"];
        all.homing.speed => [ABOVE_0, all.least(|axis| axis.max_speed)],
            "must be positive and at most the least `max_speed`"
    }
    HomingBackOff {
        "homing.back_off" as "homing.back_off",
        "Angle by which a joint leaves its switch or stop" ["rad"] = 0.05;
        all.homing.back_off => [ABOVE_0, BELOW_1], "must be positive and under 1 rad"
    }
    HomingCurrent {
        "homing.current" as "homing.current" axes [PeakCurrent],
        "Greatest motor current while homing" ["A", "of the motor"];
        all.homing.current => [ABOVE_0, all.least(|axis| axis.peak_current)],
            "must be positive and at most the least `peak_current`"
    }
    HomingSamples {
        "homing.samples" as "home_reference.samples",
        "Equal samples after which a switch or a stop is believed" ["", "in a row"];
        f32::from(all.home_reference.samples) =>
            if all.home_reference.samples > 0, "must be 1 to 255"
    }
    HomingMethod {
        "homing.method" as "home_reference.method"
            beside [TickRate, HomingSpeed, HomingBackOff, HomingCurrent, HomingSamples]
            axes [EncoderCounts, HomeAngle, AngleLimits, ContinuousCurrent],
        "Source of the joints' angles" [""];
        0.0 =>
            if all.homing_method_fits(),
            "index pulses need `index_counts` and a `homing.speed` at which no pulse is missed; hard \
             stops need the continuous current at most, samples before half of \
             `following_error`, and `angle_limits` that end at most `back_off` before the stop; \
             absolute encoders need `angle_limits` of a turn at most"
    }
    MaxSpeed {
        "motion.max_speed" as "motion.max_speed",
        "Greatest speed along the path" ["m/s"] = 0.3;
        all.motion.max_speed => [ABOVE_0, f32::MAX], "must be positive"
    }
    MaxAcceleration {
        "motion.max_acceleration" as "motion.max_acceleration" beside [MaxSpeed],
        "Greatest acceleration of the tool" ["m/s²"] = 3.0;
        all.motion.max_acceleration =>
            if positive(all.motion.max_acceleration)
                && stops_in_time(all.motion.max_speed, all.motion.max_acceleration),
            "must be positive, and stop the tool from `max_speed` within 10 s"
    }
    MaxJerk {
        "motion.max_jerk" as "motion.max_jerk" beside [MaxSpeed],
        "Greatest jerk of the tool" ["m/s³"] = 150.0;
        all.motion.max_jerk =>
            if positive(all.motion.max_jerk)
                && 6.0 * all.motion.max_speed
                    <= LONGEST_STOP * LONGEST_STOP * all.motion.max_jerk,
            "must be positive, and stop the tool from `max_speed` within 10 s"
    }
    CornerTolerance {
        "motion.corner_tolerance" as "motion.corner_tolerance",
        "Greatest distance of a rounded corner from the path; 0: the tool stops at corners" ["m"]
            = 5e-5;
        all.motion.corner_tolerance => [0.0, f32::MAX], "must not be negative"
    }
    SingularityMargin {
        "limits.singularity_margin" as "motion.singularity_margin",
        "Least |sin| of the angle at an elbow and at C" [""] = 0.1;
        all.motion.singularity_margin => [ABOVE_0, BELOW_1], "must be more than 0 and less than 1"
    }
    FollowingError {
        "protection.following_error" as "protection.following_error",
        "Greatest joint position error" ["rad"] = 0.1;
        all.protection.following_error => [ABOVE_0, BELOW_1],
            "must be more than 0 and less than 1 rad"
    }
    OverSpeed {
        "protection.over_speed" as "protection.over_speed" axes [MaxSpeed],
        "Joint speed that is a fault; in a robot file, times `max_speed`" ["rad/s"];
        all.protection.over_speed =>
            SPEED_TRIP.map(|share| share * all.greatest(|axis| axis.max_speed)),
            "must be 1 to 100 times the greatest `max_speed`"
    }
    OverCurrent {
        "protection.over_current" as "protection.over_current" axes [PeakCurrent, CurrentPerCode],
        "Motor current that is a fault; in a robot file, times `peak_current`" ["A"];
        all.protection.over_current => all.over_currents(),
            "must be 1 to 5 times the greatest `peak_current`, and within what the converters show"
    }
    BusVoltage {
        "supply.range" as "protection.bus_voltage",
        "Least and greatest bus voltage" ["V"];
        all.protection.bus_voltage[0] =>
            if all.protection.bus_voltage[0] > 0.0
                && all.protection.bus_voltage[0] >= BUS * all.protection.bus_voltage[1]
                && rising(all.protection.bus_voltage),
            "must be positive and rising, and begin at a fiftieth of its end or above"
    }
    BusVoltagePerCode {
        "supply.voltage_per_code" as "protection.bus_voltage_per_code" beside [BusVoltage],
        "Bus voltage per code of the converter" ["V", "per ADC code"];
        all.protection.bus_voltage_per_code =>
            if positive(all.protection.bus_voltage_per_code)
                && all.protection.bus_voltage[1]
                    <= (FULL_SCALE - 1.0) * all.protection.bus_voltage_per_code,
            "must be positive, and the converter must show more than the upper end of `bus_voltage`"
    }
    CommandTimeout {
        "protection.command_timeout" as "protection.command_timeout" beside [TickRate],
        "Silence of the host that is a fault while the arm moves" ["s"] = 0.1;
        all.protection.command_timeout =>
            if all.protection.command_timeout * all.control.tick_rate >= 1.0
                && all.protection.command_timeout <= 60.0,
            "must last at least one tick and at most 60 s"
    }
    BrakeEngageTime {
        "actuator.brake_engage_time" as "brake.engage_time",
        "Longest time from switching a brake off to its full torque" ["s", "to full torque; 0 without brakes"];
        all.brake.engage_time => 0 to 1
    }
    BrakeReleaseTime {
        "actuator.brake_release_time" as "brake.release_time",
        "Longest time from switching a brake on to a free joint" ["s", "to a free joint; 0 without brakes"];
        all.brake.release_time => 0 to 1
    }
    ToolFrameRate {
        "tool_output.frame_rate" as "tool_output.frame_rate",
        "Pulses of a servo per second" ["Hz"] = 50.0;
        each all.tool_output.frame_rate() => 40 to 400
    }
    ToolPulseWidth {
        "tool_output.up_width" as "tool_output: up_width and down_width" beside [ToolFrameRate],
        "Pulse widths of a servo with the tool up and down" ["s"];
        each all.tool_output.pulse_widths() => 0.0001 to 0.005,
            and all.tool_output.pulses_fit(),
            "differ and take 90 % of a frame at most"
    }
    ToolSettleTime {
        "tool_output.down_time" as "tool_output: down_time and up_time",
        "Times for which the arm waits while the tool comes down and lifts" ["s"];
        each all.tool_output.settle_times() => 0 to 10
    }
    ToolFrequency {
        "tool_output.frequency" as "tool_output.frequency",
        "Frequency of a power's PWM" ["Hz"];
        each all.tool_output.frequency() => 10 to 100_000
    }
    Belts {
        "" as "belts",
        "What stretches between the motors and their joints" [""];
        0.0 => if all.belts_are_sound(),
            "must have positive stiffness at both joints or none: of steppers nothing else; of belts positive bandwidth and damping ratio, rotors with inertia, and encoders at most 7 ticks late"
    }
    FieldLags {
        "" as "field_lags",
        "Lags of the rotors of steppers behind their fields" [""];
        0.0 => if all.field_lags.iter().all(FieldLag::is_sound),
            "must have no number below 0 or above 1000000"
    }
    DisarmTimeout {
        "advanced.disarm_timeout" as "advanced.disarm_timeout",
        "Silence of the host after which an arm that is powered, at rest or held, is switched off"
            ["s"] = 60.0;
        all.advanced.disarm_timeout => 1 to 86_400
    }
    MotionTorque {
        "advanced.motion_torque" as "advanced.motion_torque",
        "Share of the peak torque that motions at feed rates may take; the rest is for feedback and friction"
            [""] = 0.8;
        all.advanced.motion_torque => 0.01 to 1
    }
    PenFriction {
        "advanced.pen_friction" as "advanced.pen_friction",
        "Force by which a tool that is on is held back while it slides, fed forward" ["N"] = 0.0;
        all.advanced.pen_friction => 0 to 10
    }
}

// What a new number of the controller needs is a row above and a line here. Lines are added at the
// end and stay: the stored settings of an older firmware end before them.
advanced! {
    disarm_timeout: DisarmTimeout,
    motion_torque: MotionTorque,
    pen_friction: PenFriction,
}

/// Numbers that other fields are checked with, or that every value fits.
const OTHERS: &[Row] = &[
    Row::explained(
        "lengths",
        "m: l1, l2, l3, l4, base",
        "",
        "Lengths of links 1 to 4 and of the base",
    ),
    Row::explained("payload", "kg", "", "Point mass at C"),
    Row::explained("gravity", "m/s²", "", "In-plane gravity"),
    Row::explained("links.mass", "kg", "", "Mass"),
    Row::explained(
        "links.com",
        "m",
        "",
        "Centre of mass, along the link and to its left",
    ),
    Row::explained(
        "links.inertia",
        "kg·m²",
        "about the centre of mass",
        "Moment of inertia",
    ),
    Row::explained(
        "axes.index_counts",
        "",
        "counts from one index pulse to the next",
        "Index counts",
    ),
    Row::explained(
        "axes.current_zero_code",
        "",
        "ADC code",
        "Code of the converter at zero current",
    ),
    Row::explained(
        "encoder_tables.shaft_ratio",
        "",
        "turns of the encoder per turn of the joint",
        "Ratio of the encoder's shaft",
    ),
    Row::explained(
        "encoder_tables.points",
        "",
        "error of the shaft, in 1/32768 rad",
        "The encoder's known error",
    ),
    Row::explained(
        "belts.stiffness",
        "N·m/rad",
        "at the joint; 0: rigid",
        "Stiffness of the belt",
    ),
    Row::explained(
        "belts.damping",
        "N·m·s/rad",
        "at the joint",
        "Damping of the belt",
    ),
    Row::explained(
        "belts.encoder_at_joint",
        "",
        "",
        "Whether the encoder is at the joint",
    ),
    Row::explained(
        "belts.bandwidth",
        "rad/s",
        "",
        "Bandwidth of the feedback from the links",
    ),
    Row::explained("belts.damping_ratio", "", "", "Its damping ratio"),
    Row::explained(
        "belts.rotor_damping",
        "N·m·s/rad",
        "at the joint",
        "Torque against the rotor's velocity",
    ),
    Row::explained(
        "belts.observer",
        "",
        "1, 1/s, 1, N·m·s/rad, N·m/rad",
        "Gains of the observer of both sides",
    ),
    Row::explained(
        "field_lags.from",
        "rad/s",
        "of the joint",
        "Speed from which on a stepper's rotor lags behind its field",
    ),
    Row::explained(
        "field_lags.slope",
        "rad/(rad/s)",
        "of the field, of the joint",
        "By how much the lag grows with the speed there",
    ),
    Row::explained(
        "field_lags.bend",
        "rad/(rad/s)²",
        "of the field, of the joint",
        "By how much that falls with the speed",
    ),
    Row::explained(
        "tool_output.up_width",
        "s",
        "",
        "Pulse width with the tool up",
    ),
    Row::explained(
        "tool_output.down_width",
        "s",
        "",
        "Pulse width with the tool down",
    ),
    Row::explained(
        "tool_output.down_time",
        "s",
        "",
        "Time that the tool takes to come down",
    ),
    Row::explained(
        "tool_output.up_time",
        "s",
        "",
        "Time that the tool takes to lift",
    ),
];

/// Every row of the table.
pub fn rows() -> impl Iterator<Item = Row> {
    let axes = AxisField::ALL.iter().map(|field| field.row());
    let others = Field::ALL.iter().map(|field| field.row());
    axes.chain(others).chain(OTHERS.iter().copied())
}

// Called in many places, not time-critical: not inlined, to save flash.
#[inline(never)]
fn positive(value: f32) -> bool {
    value > 0.0 && value.is_finite()
}

fn rising([low, high]: [f32; 2]) -> bool {
    low < high && low.is_finite() && high.is_finite()
}

/// Whether a stop from `speed` at no more than `acceleration` takes at most [`LONGEST_STOP`].
fn stops_in_time(speed: f32, acceleration: f32) -> bool {
    1.5 * speed <= LONGEST_STOP * acceleration
}

impl AxisSettings {
    /// The greatest current [A] that the converter can tell from its full scale, in either
    /// direction.
    fn greatest_current(&self) -> f32 {
        let zero = f32::from(self.current_zero_code);
        (zero.min(FULL_SCALE - zero) - 1.0) * self.current_per_code
    }
}

impl Settings {
    fn least(&self, of: impl Fn(&AxisSettings) -> f32) -> f32 {
        let [axis1, axis4] = &self.axes;
        of(axis1).min(of(axis4))
    }

    fn greatest(&self, of: impl Fn(&AxisSettings) -> f32) -> f32 {
        let [axis1, axis4] = &self.axes;
        of(axis1).max(of(axis4))
    }

    /// Bounds of the current that is a fault: near enough to what both motors reach to protect
    /// them, and within what the converters show [A].
    fn over_currents(&self) -> [f32; 2] {
        let peak = self.greatest(|axis| axis.peak_current);
        let [least, greatest] = CURRENT_TRIP.map(|share| share * peak);
        [
            least,
            greatest.min(self.least(AxisSettings::greatest_current)),
        ]
    }

    /// Whether a joint's peak current exceeds what its motor can take at the highest bus voltage.
    pub(super) fn is_overloaded(&self, axis: &AxisSettings) -> bool {
        let [_, bus] = self.protection.bus_voltage;
        axis.peak_current * axis.resistance > STALL * bus
    }
}
