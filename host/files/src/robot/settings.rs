//! The controller's settings for a robot.

use super::belts::belt_settings;
use super::sections::default_of;
use super::value::single;
use super::{Actuator, Control, HomeMethod, MissingMasses, Robot, home_method};
use fivebar_design::servo::BeltTuning;
use fivebar_firmware::Settings;
use fivebar_firmware::settings::{
    AdvancedSettings, AxisSettings, BrakeSettings, ControlSettings, EncoderTable, Field,
    HomingSettings, LinkSettings, MotionSettings, ProtectionSettings,
};
use fivebar_kinematics::dynamics::Arm;
use fivebar_kinematics::five_bar::{Joint, Side};
use fivebar_plant::{EncoderSide, Harmonics, Parameters};

/// Codes of the 12-bit converters.
pub(super) const ADC_CODES: f64 = 4096.0;
/// The code of zero current, in the middle of the range.
const ZERO_CODE: u16 = 2048;

impl Robot {
    /// The controller's settings for this robot: SI units, `f32`.
    ///
    /// # Errors
    /// The robot has lengths only, no masses.
    pub fn settings(&self) -> Result<Settings, MissingMasses> {
        self.settings_with(&self.control, self.belts.as_ref())
    }

    /// The controller's settings of a PID at each joint, which knows neither masses nor belts.
    ///
    /// # Errors
    /// The robot has lengths only, no masses.
    pub fn pid_settings(&self) -> Result<Settings, MissingMasses> {
        let mut settings = self.settings_with(&self.rigid_control, None)?;
        settings.control.computed_torque = false;
        Ok(settings)
    }

    fn settings_with(
        &self,
        control: &Control,
        belts: Option<&[BeltTuning; 2]>,
    ) -> Result<Settings, MissingMasses> {
        let arm = self.arm()?;
        let actuators = self.drives()?;
        let gravity = arm.gravity();
        let mode = self.working_mode();
        let Self {
            motion, protection, ..
        } = self;
        let mut settings = Settings {
            lengths: self.geometry.lengths().map(single),
            links: arm.links().map(|link| LinkSettings {
                mass: single(link.mass),
                com: [single(link.com.x), single(link.com.y)],
                inertia: single(link.inertia),
            }),
            payload: single(arm.payload()),
            gravity: [single(gravity.x), single(gravity.y)],
            tool_offset: self.tool.offset.map(single),
            elbows_left: [mode.elbow1, mode.elbow4].map(|side| side == Side::Left),
            assembly_left: self
                .home_pose()
                .is_ok_and(|home| home.assembly() == Side::Left),
            axes: Joint::ALL.map(|joint| self.axis(joint, &actuators)),
            control: ControlSettings {
                tick_rate: single(control.tick_rate),
                bandwidth: single(control.bandwidth),
                damping: single(control.damping),
                integral_rate: single(control.integral_rate),
                observer_bandwidth: single(control.observer_bandwidth),
                current_bandwidth: single(control.current_bandwidth),
                friction_smoothing: 0.02,
                computed_torque: true,
            },
            homing: HomingSettings {
                speed: single(self.homing_speed()),
                back_off: single(self.back_off()),
                current: single(self.homing_current(arm, &actuators)),
            },
            home_reference: home_method::reference(&self.homing, control.tick_rate),
            motion: MotionSettings {
                max_speed: single(motion.max_speed),
                max_acceleration: single(motion.max_acceleration),
                max_jerk: single(motion.max_jerk),
                corner_tolerance: single(motion.corner_tolerance),
                singularity_margin: single(self.limits.singularity_margin),
            },
            protection: ProtectionSettings {
                following_error: single(protection.following_error),
                over_speed: single(protection.over_speed * largest(self.limits.max_speed)),
                over_current: single(self.over_current(&actuators)),
                bus_voltage: self.bus_range().map(single),
                bus_voltage_per_code: single(self.voltage_per_code()),
                command_timeout: single(protection.command_timeout),
            },
            tool_output: self.tool_output,
            crossing_allowed: self.crossing.allowed,
            advanced: AdvancedSettings {
                motion_torque: self.advanced.motion_torque * single(self.torque_at_speed()),
                ..self.advanced
            },
            brake: brakes(&actuators),
            belts: self
                .field_settings()
                .unwrap_or_else(|| belt_settings(belts, &actuators)),
            field_lags: self.field_lags(),
            encoder_tables: actuators.map(|actuator| encoder_table(&actuator)),
        };
        if let Some(setup) = self.bus_setup() {
            setup.put(&mut settings);
        }
        self.put_pulses(&mut settings);
        Ok(settings)
    }

    /// The drives of the joints: those of the file, or ideal torque sources.
    ///
    /// # Errors
    /// The robot has lengths only, no masses.
    pub fn drives(&self) -> Result<[Actuator; 2], MissingMasses> {
        let arm = self.arm()?;
        let drives = self.actuators.unwrap_or_else(|| {
            Joint::ALL.map(|joint| {
                let torque = self
                    .limits
                    .max_torque
                    .map_or_else(|| self.ideal_torque(arm), |torque| torque[joint]);
                ideal_torque_source(torque, self.limits.max_speed[joint], self.supply.voltage)
            })
        });
        Ok(Joint::ALL.map(|joint| self.limited(joint, drives[joint])))
    }

    /// Torque of an ideal drive [N·m], more than any motion within the limits needs: for twice the whole
    /// mass at the end of a straight leg, against gravity and with the greatest acceleration of the tool.
    pub(super) fn ideal_torque(&self, arm: &Arm<f64>) -> f64 {
        let [l1, l2, l3, l4, _] = arm.geometry().lengths();
        let mass = arm.payload() + arm.links().iter().map(|link| link.mass).sum::<f64>();
        let acceleration = arm.gravity().norm() + self.motion.max_acceleration;
        2.0 * mass * (l1 + l2).max(l3 + l4) * acceleration
    }

    /// The arm for the simulated plant.
    ///
    /// # Errors
    /// The robot has lengths only, no masses.
    pub fn plant_parameters(&self) -> Result<Parameters, MissingMasses> {
        let drives = self.drives()?;
        Ok(Parameters {
            arm: *self.arm()?,
            tool_offset: self.tool.offset,
            motors: drives.map(|drive| drive.motor()),
            transmissions: drives.map(|drive| drive.transmission()),
            encoders: drives.map(|drive| drive.encoder()),
            brake_torque: drives.map(|drive| drive.brake_torque),
            brake_times: drives.map(|drive| drive.brake_times()),
            bus_voltage: self.supply.voltage,
            volts_per_code: self.voltage_per_code(),
            switches: self.switches(&drives),
            settings: self.settings()?,
        })
    }

    /// Whether a joint approaches its switch with a growing angle.
    pub(super) fn homes_forward(&self, joint: Joint) -> bool {
        let [low, high] = self.limits.angle[joint];
        match self.homing.forward {
            Some(forward) => forward[joint],
            None => self.home[joint] > 0.5 * (low + high),
        }
    }

    /// The joint's angle at its home switch, or at its hard stop: that lies the back-off behind home, so
    /// that the joint ends at home.
    fn reference_angle(&self, joint: Joint) -> f64 {
        let towards = if self.homes_forward(joint) { 1.0 } else { -1.0 };
        match self.homing.method {
            HomeMethod::HardStop => self.home[joint] + towards * self.back_off(),
            HomeMethod::Switch | HomeMethod::Index | HomeMethod::Absolute | HomeMethod::Given => {
                self.home[joint]
            }
        }
    }

    /// Speed of the first approach to a switch [rad/s].
    pub(super) fn homing_speed(&self) -> f64 {
        let slow = 0.02 * least(self.limits.max_speed);
        self.homing.speed.unwrap_or(slow)
    }

    /// Angle by which a joint backs off from its closed switch [rad].
    pub(super) fn back_off(&self) -> f64 {
        let usual = default_of(&Field::HomingBackOff.row());
        self.homing.back_off.unwrap_or(usual)
    }

    /// Greatest current while homing [A], if the file has none: the current that holds the arm's weight at home, and
    /// 0.3 of the peak current to move it. So little bends no part if a switch is missed.
    fn homing_current(&self, arm: &Arm<f64>, actuators: &[Actuator; 2]) -> f64 {
        if let Some(current) = self.homing.current {
            return current;
        }
        let weight = self.home_pose().ok();
        let weight = weight.and_then(|home| arm.gravity_torque(&home).ok());
        let held = actuators.iter().zip(weight.unwrap_or([0.0; 2]));
        let held = held.map(|(motor, torque)| torque.abs() / motor.torque_per_ampere());
        let peak = least(actuators.map(|a| a.peak_current));
        (0.3 * peak + held.fold(0.0, f64::max)).min(peak)
    }

    /// A drive whose currents are limited to the joint's greatest torque; a stepper's also to its share of the holding
    /// torque.
    pub(super) fn limited(&self, joint: Joint, drive: Actuator) -> Actuator {
        let share = drive.torque_share();
        let drive = Actuator {
            peak_current: share * drive.peak_current,
            continuous_current: share * drive.continuous_current,
            ..drive
        };
        let Some(torque) = self.limits.max_torque else {
            return drive;
        };
        let current = torque[joint] / drive.torque_per_ampere();
        Actuator {
            peak_current: drive.peak_current.min(current),
            continuous_current: drive.continuous_current.min(current),
            ..drive
        }
    }

    /// Bus voltage below and above which the arm stops [V].
    pub(super) fn bus_range(&self) -> [f64; 2] {
        let nominal = self.supply.voltage;
        self.supply.range.unwrap_or([0.7 * nominal, 1.3 * nominal])
    }

    /// Bus voltage per ADC code [V].
    pub fn voltage_per_code(&self) -> f64 {
        let ample = 2.0 * self.supply.voltage / ADC_CODES;
        self.supply.voltage_per_code.unwrap_or(ample)
    }

    /// The current [A] that is a fault, of either motor.
    pub(super) fn over_current(&self, actuators: &[Actuator; 2]) -> f64 {
        self.protection.over_current * largest(actuators.map(|a| a.peak_current))
    }

    /// A range of the current sensors [A] that shows the over-current well: twice the peak
    /// current, or more.
    fn ample_current(&self, actuators: &[Actuator; 2]) -> f64 {
        let peak = largest(actuators.map(|a| a.peak_current));
        (4.0 / 3.0 * self.protection.over_current).max(2.0) * peak
    }

    fn axis(&self, joint: Joint, actuators: &[Actuator; 2]) -> AxisSettings {
        let actuator = &actuators[joint];
        let ample = 2.0 * self.ample_current(actuators) / ADC_CODES;
        AxisSettings {
            gear_ratio: single(actuator.gear_ratio),
            rotor_inertia: single(actuator.rotor_inertia),
            torque_constant: single(actuator.torque_constant),
            resistance: single(actuator.resistance),
            inductance: single(actuator.inductance),
            viscous_friction: single(actuator.viscous_friction),
            coulomb_friction: single(actuator.coulomb_friction),
            encoder_counts: actuator.encoder_counts,
            index_counts: actuator.index_counts(),
            encoder_latency: single(actuator.encoder_latency),
            home_angle: single(self.reference_angle(joint)),
            home_forward: self.homes_forward(joint),
            angle_limits: self.limits.angle[joint].map(single),
            max_speed: single(self.limits.max_speed[joint]),
            max_acceleration: single(self.limits.max_acceleration[joint]),
            peak_current: single(actuator.peak_current),
            continuous_current: single(actuator.continuous_current),
            thermal_time_constant: single(actuator.thermal_time_constant),
            current_per_code: single(actuator.current_per_code.unwrap_or(ample)),
            current_zero_code: ZERO_CODE,
        }
    }
}

/// The brakes of both joints, which have one output: the longer times of the two.
fn brakes(actuators: &[Actuator; 2]) -> BrakeSettings {
    let [[engage1, release1], [engage4, release4]] =
        actuators.each_ref().map(Actuator::brake_times);
    BrakeSettings {
        engage_time: single(engage1.max(engage4)),
        release_time: single(release1.max(release4)),
    }
}

/// The correction of an encoder's known error.
fn encoder_table(actuator: &Actuator) -> EncoderTable {
    let error = actuator.encoder_error;
    if error.is_zero() {
        return EncoderTable::NONE;
    }
    let ratio = match actuator.encoder_side {
        EncoderSide::Motor => actuator.gear_ratio,
        EncoderSide::Joint => 1.0,
    };
    // Measured = true + error(true): the true angle by repeated insertion.
    EncoderTable::new(single(ratio), |measured| {
        let shaft = (0..100).fold(measured, |shaft, _| measured - error.at(shaft));
        measured - shaft
    })
}

/// A drive close to an ideal torque source: a frictionless direct drive without inertia that
/// always has enough voltage. A quarter of the bus voltage V equals the back-EMF at full
/// speed, k ω = V/4, and a quarter drives the peak current, R i = V/4; the rest changes the
/// current, with L/R = 1 ms. The encoder has 2²⁰ counts per turn; the brake holds the torque
/// of the motor, and acts at once.
fn ideal_torque_source(torque: f64, max_speed: f64, voltage: f64) -> Actuator {
    let torque_constant = 0.25 * voltage / max_speed;
    let peak_current = torque / torque_constant;
    let resistance = 0.25 * voltage / peak_current;
    Actuator {
        gear_ratio: 1.0,
        rotor_inertia: 0.0,
        torque_constant,
        resistance,
        inductance: 1e-3 * resistance,
        viscous_friction: 0.0,
        coulomb_friction: 0.0,
        brake_torque: torque,
        brake_engage_time: Some(0.0),
        brake_release_time: Some(0.0),
        encoder_counts: 1 << 20,
        peak_current,
        continuous_current: peak_current,
        thermal_time_constant: 60.0,
        current_per_code: None,
        stiffness: None,
        drive_damping: 0.0,
        encoder_side: EncoderSide::Motor,
        encoder_latency: 0.0,
        encoder_error: Harmonics::NONE,
        drive: super::Drive::Brushed,
    }
}

fn largest([a, b]: [f64; 2]) -> f64 {
    a.max(b)
}

fn least([a, b]: [f64; 2]) -> f64 {
    a.min(b)
}
