//! The check of settings, field by field.

use super::range;
use super::{AxisField, AxisSettings, CheckedSettings, Field, Settings, SettingsError};
use core::f32::consts::TAU;
use fivebar_kinematics::Scalar;

/// Counts of a whole turn that `f32` can resolve, with two bits to spare.
const MAX_COUNTS_PER_TURN: f32 = 4_194_304.0;

/// The greatest code of the 12-bit converters.
const FULL_SCALE: f32 = 4095.0;

// Called in many places, not time-critical: not inlined, to save flash.
#[inline(never)]
fn positive(value: f32) -> bool {
    value > 0.0 && value.is_finite()
}

#[inline(never)]
fn not_negative(value: f32) -> bool {
    value >= 0.0 && value.is_finite()
}

#[inline(never)]
fn within([least, greatest]: [f32; 2], value: f32) -> bool {
    least <= value && value <= greatest
}

/// Whether a trip point is above what both joints reach, and near enough to protect them.
#[inline(never)]
fn trips(range: [f32; 2], [a, b]: [f32; 2], trip: f32) -> bool {
    within(range.map(|share| share * a.max(b)), trip)
}

fn rising([low, high]: [f32; 2]) -> bool {
    low < high && low.is_finite() && high.is_finite()
}

/// The field of the first rule that is broken.
fn first_broken<F: Copy>(rules: &[(bool, F)]) -> Option<F> {
    rules
        .iter()
        .find_map(|&(holds, field)| if holds { None } else { Some(field) })
}

/// The longest that a stop may take [s]. The planner hands out the path for a stop in advance, and
/// nobody waits longer for an arm to stop.
const LONGEST_STOP: f32 = 10.0;

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

    fn broken_field(&self) -> Option<AxisField> {
        let counts = self.encoder_counts as f32 * Scalar::abs(self.gear_ratio);
        first_broken(&[
            (
                within(range::GEAR_RATIO, Scalar::abs(self.gear_ratio)),
                AxisField::GearRatio,
            ),
            (
                within(range::ROTOR_INERTIA, self.rotor_inertia),
                AxisField::RotorInertia,
            ),
            (
                within(range::TORQUE_CONSTANT, self.torque_constant),
                AxisField::TorqueConstant,
            ),
            (
                within(range::RESISTANCE, self.resistance),
                AxisField::Resistance,
            ),
            (
                within(range::INDUCTANCE, self.inductance),
                AxisField::Inductance,
            ),
            (
                within(range::FRICTION, self.viscous_friction),
                AxisField::ViscousFriction,
            ),
            (
                within(range::FRICTION, self.coulomb_friction),
                AxisField::CoulombFriction,
            ),
            (
                self.encoder_counts > 0 && counts <= MAX_COUNTS_PER_TURN,
                AxisField::EncoderCounts,
            ),
            (
                within(range::LATENCY, self.encoder_latency),
                AxisField::EncoderLatency,
            ),
            (Scalar::abs(self.home_angle) <= TAU, AxisField::HomeAngle),
            (
                rising(self.angle_limits)
                    && self.angle_limits.iter().all(|&a| Scalar::abs(a) <= TAU),
                AxisField::AngleLimits,
            ),
            (within(range::SPEED, self.max_speed), AxisField::MaxSpeed),
            (
                within(range::ACCELERATION, self.max_acceleration)
                    && stops_in_time(self.max_speed, self.max_acceleration),
                AxisField::MaxAcceleration,
            ),
            (
                within(range::CURRENT, self.peak_current),
                AxisField::PeakCurrent,
            ),
            (
                positive(self.continuous_current) && self.continuous_current <= self.peak_current,
                AxisField::ContinuousCurrent,
            ),
            (
                within(range::HEATING, self.thermal_time_constant),
                AxisField::ThermalTimeConstant,
            ),
            (
                within(range::CURRENT_PER_CODE, self.current_per_code),
                AxisField::CurrentPerCode,
            ),
        ])
    }
}

impl Settings {
    /// Checks every field, and that the arm which they describe can take a pose.
    ///
    /// # Errors
    /// The first field that is invalid, by name.
    #[inline(never)]
    pub fn check(&self) -> Result<CheckedSettings, SettingsError> {
        for (joint, axis) in [1, 4].into_iter().zip(&self.axes) {
            if let Some(field) = axis.broken_field() {
                return Err(SettingsError::Axis(joint, field));
            }
        }
        for (joint, table) in [1, 4].into_iter().zip(&self.encoder_tables) {
            if !table.is_sound() {
                return Err(SettingsError::Axis(joint, AxisField::EncoderTable));
            }
        }
        if let Some(field) = self.broken_field() {
            return Err(SettingsError::Field(field));
        }
        let [_, bus] = self.protection.bus_voltage;
        for (joint, axis) in [1, 4].into_iter().zip(&self.axes) {
            if axis.peak_current * axis.resistance > range::STALL * bus {
                return Err(SettingsError::Axis(joint, AxisField::PeakCurrent));
            }
        }
        if let Some(field) = self.tool_output.broken_field() {
            return Err(SettingsError::Field(field));
        }
        let arm = self.arm()?;
        let tool = self.tool(&arm)?;
        Ok(CheckedSettings {
            nominal_inertia: self.nominal_inertia(&arm, &tool)?,
            settings: *self,
            arm,
            tool,
        })
    }

    fn broken_field(&self) -> Option<Field> {
        let [axis1, axis4] = &self.axes;
        let control = &self.control;
        let motion = &self.motion;
        let protection = &self.protection;
        let homing = &self.homing;
        let [low, high] = protection.bus_voltage;
        first_broken(&[
            (
                self.tool_offset.iter().all(|x| x.is_finite()),
                Field::ToolOffset,
            ),
            (
                (100.0..=50_000.0).contains(&control.tick_rate),
                Field::TickRate,
            ),
            (
                positive(control.current_bandwidth)
                    && control.current_bandwidth <= 0.35 * control.tick_rate,
                Field::CurrentBandwidth,
            ),
            (
                positive(control.bandwidth)
                    && control.bandwidth <= 0.25 * control.current_bandwidth,
                Field::Bandwidth,
            ),
            ((0.2..=2.0).contains(&control.damping), Field::Damping),
            (
                (0.0..=0.25 * control.bandwidth).contains(&control.integral_rate),
                Field::IntegralRate,
            ),
            (
                (2.0 * control.bandwidth..=control.tick_rate).contains(&control.observer_bandwidth),
                Field::ObserverBandwidth,
            ),
            (
                positive(control.friction_smoothing),
                Field::FrictionSmoothing,
            ),
            (
                positive(homing.speed)
                    && homing.speed <= axis1.max_speed
                    && homing.speed <= axis4.max_speed,
                Field::HomingSpeed,
            ),
            (
                positive(homing.back_off) && homing.back_off < 1.0,
                Field::HomingBackOff,
            ),
            (
                positive(homing.current)
                    && homing.current <= axis1.peak_current
                    && homing.current <= axis4.peak_current,
                Field::HomingCurrent,
            ),
            (self.home_reference.samples > 0, Field::HomingSamples),
            (self.homing_method_fits(), Field::HomingMethod),
            (positive(motion.max_speed), Field::MaxSpeed),
            (
                positive(motion.max_acceleration)
                    && stops_in_time(motion.max_speed, motion.max_acceleration),
                Field::MaxAcceleration,
            ),
            (
                positive(motion.max_jerk)
                    && 6.0 * motion.max_speed <= LONGEST_STOP * LONGEST_STOP * motion.max_jerk,
                Field::MaxJerk,
            ),
            (
                not_negative(motion.corner_tolerance),
                Field::CornerTolerance,
            ),
            (
                positive(motion.singularity_margin) && motion.singularity_margin < 1.0,
                Field::SingularityMargin,
            ),
            (
                positive(protection.following_error) && protection.following_error < 1.0,
                Field::FollowingError,
            ),
            (
                trips(
                    range::SPEED_TRIP,
                    [axis1, axis4].map(|axis| axis.max_speed),
                    protection.over_speed,
                ),
                Field::OverSpeed,
            ),
            (
                trips(
                    range::CURRENT_TRIP,
                    [axis1, axis4].map(|axis| axis.peak_current),
                    protection.over_current,
                ) && protection.over_current <= axis1.greatest_current()
                    && protection.over_current <= axis4.greatest_current(),
                Field::OverCurrent,
            ),
            (
                low > 0.0 && low >= range::BUS * high && rising(protection.bus_voltage),
                Field::BusVoltage,
            ),
            (
                positive(protection.bus_voltage_per_code)
                    && high <= (FULL_SCALE - 1.0) * protection.bus_voltage_per_code,
                Field::BusVoltagePerCode,
            ),
            (
                protection.command_timeout * control.tick_rate >= 1.0
                    && protection.command_timeout <= 60.0,
                Field::CommandTimeout,
            ),
            (
                within(range::BRAKE_TIME, self.brake.engage_time),
                Field::BrakeEngageTime,
            ),
            (
                within(range::BRAKE_TIME, self.brake.release_time),
                Field::BrakeReleaseTime,
            ),
        ])
    }
}
