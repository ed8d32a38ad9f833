//! Brushed motors on H-bridges: from ADC codes to currents, and from a torque to the duty of each bridge.

mod current_zeros;
mod motor;
mod motor_check;
mod oscillation;

use super::words::SensedWords;
use super::{
    DriveReport, Drives, Excitation, Excited, JointState, Needs, Stage, UnpoweredPlace,
    tool_friction,
};
use crate::drives::Demand;
use crate::safety::Fault;
use crate::settings::{CheckedSettings, Settings};
use current_zeros::CurrentZeros;
use fivebar_kinematics::Scalar;
use fivebar_kinematics::control::{Bus, ToolFriction};
use fivebar_kinematics::five_bar::Joint;
use motor::{Motor, MotorModel};
use serde::{Deserialize, Serialize};

/// Greatest duty: the bridges' high sides and the sampling of the currents need the rest of each
/// PWM period.
pub const MOST_DUTY: f32 = 0.95;

/// The bandwidth of the current loop in each [`Stage`], as a share. The noise of the current sensors gives an arm at
/// rest little torque then.
fn bandwidth_share(stage: Stage) -> f32 {
    match stage {
        Stage::Moves | Stage::Crosses => 1.0,
        Stage::Settles => 0.4,
        Stage::Rests => 0.12,
    }
}

/// What the current sensors and the bus sensor show in a tick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct BrushedSample {
    /// Phase currents [ADC codes].
    pub current: [u16; 2],
    /// Bus voltage [ADC codes].
    pub bus_voltage: u16,
}

impl From<BrushedSample> for SensedWords {
    #[inline(always)]
    fn from(sample: BrushedSample) -> Self {
        Self {
            joints: sample.current,
            both: sample.bus_voltage,
        }
    }
}

/// What the bridges do until the next tick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct BrushedCommand {
    /// Duty of each bridge in −1…1: the mean voltage as a share of the bus voltage.
    pub duty: [f32; 2],
}

/// Both motors with their current loops. What every tick needs comes first, see
/// [`Controller`](crate::Controller).
#[derive(Clone)]
#[repr(C)]
pub struct BrushedDrives {
    motors: [Motor; 2],
    /// [V].
    bus_voltage: f32,
    /// [V].
    bus_voltage_per_code: f32,
    /// The range of the bus voltage [V].
    bus_range: [f32; 2],
    /// [A].
    over_current: f32,
    models: [MotorModel; 2],
    zeros: CurrentZeros,
    tool_friction: Option<ToolFriction<f32>>,
}

impl Drives for BrushedDrives {
    type Sample = BrushedSample;
    type Command = BrushedCommand;

    const NEEDS: Needs = Needs::Torque;

    #[inline(always)]
    fn sensed_words(&self, sample: &BrushedSample) -> SensedWords {
        (*sample).into()
    }

    #[inline(always)]
    fn told_words(&self, command: &BrushedCommand) -> [u16; 2] {
        command.duty.map(|duty| (duty * 32_767.0) as i16 as u16)
    }

    const WAKE_UP_TIME: f32 = crate::drivers::WAKE_UP_TIME;

    fn new(settings: &CheckedSettings) -> Self {
        // By reference: copies of both would take stack.
        let [axis1, axis4] = &settings.axes;
        let protection = &settings.protection;
        Self {
            motors: [Motor::new(axis1), Motor::new(axis4)],
            bus_voltage: 0.0,
            bus_voltage_per_code: protection.bus_voltage_per_code,
            bus_range: protection.bus_voltage,
            over_current: protection.over_current,
            models: [
                MotorModel::new(axis1, settings),
                MotorModel::new(axis4, settings),
            ],
            zeros: CurrentZeros::new(settings),
            tool_friction: tool_friction(settings),
        }
    }

    #[inline(always)]
    fn tool_friction(&self) -> Option<&ToolFriction<f32>> {
        self.tool_friction.as_ref()
    }

    /// The lag of the current loop, 1/ωc.
    fn lag(settings: &Settings, stage: Stage) -> f32 {
        1.0 / (bandwidth_share(stage) * settings.control.current_bandwidth)
    }

    fn keep_heat(&mut self, settings: &Settings, before: &Self, old: &Settings) {
        let axes = settings.axes.iter().zip(&old.axes);
        let motors = self.motors.iter_mut().zip(&before.motors);
        for ((motor, before), (axis, old)) in motors.zip(axes) {
            motor.keep_heat(axis, before, old);
        }
    }

    #[cold]
    fn select(&mut self, joint: Joint, stage: Stage) {
        if let Some(model) = self.models.get_mut(joint.index()) {
            model.select(stage);
        }
    }

    #[inline(always)]
    fn sense(&mut self, sample: &BrushedSample) {
        self.bus_voltage = f32::from(sample.bus_voltage) * self.bus_voltage_per_code;
        let ([motor1, motor4], [model1, model4]) = (&mut self.motors, &self.models);
        let [current1, current4] = sample.current;
        motor1.sense(model1, current1);
        motor4.sense(model4, current4);
    }

    /// Over-current.
    #[inline(always)]
    fn drive_fault(&self) -> Option<Fault> {
        let [motor1, motor4] = &self.motors;
        let most = self.over_current;
        let over = Scalar::abs(motor1.current) > most || Scalar::abs(motor4.current) > most;
        over.then_some(Fault::OverCurrent)
    }

    #[inline(always)]
    fn supply_fault(&self) -> Option<Fault> {
        let ([low, high], voltage) = (self.bus_range, self.bus_voltage);
        if low <= voltage && voltage <= high {
            None
        } else if voltage < low {
            Some(Fault::UnderVoltage)
        } else {
            Some(Fault::OverVoltage)
        }
    }

    /// The fault that a motor's equation shows.
    #[inline(always)]
    fn contradiction(&mut self, [joint1, joint4]: [JointState; 2]) -> Option<Fault> {
        let ([motor1, motor4], [model1, model4]) = (&mut self.motors, &self.models);
        let fault1 = motor1.contradiction(model1, &joint1, self.bus_voltage);
        let fault4 = motor4.contradiction(model4, &joint4, self.bus_voltage);
        fault1.or(fault4)
    }

    /// Runs the current loops.
    #[inline(always)]
    fn drive(&mut self, demand: &Demand) -> bool {
        let bus = Bus::new(self.bus_voltage, MOST_DUTY);
        let ([motor1, motor4], [model1, model4]) = (&mut self.motors, &self.models);
        let ([torque1, torque4], [omega1, omega4]) = (demand.torque, demand.velocity);
        let limited1 = motor1.drive(model1, torque1, omega1, &bus);
        let limited4 = motor4.drive(model4, torque4, omega4, &bus);
        limited1 || limited4
    }

    #[inline(always)]
    fn command(&self) -> BrushedCommand {
        let [motor1, motor4] = &self.motors;
        BrushedCommand {
            duty: [motor1.duty, motor4.duty],
        }
    }

    #[inline(always)]
    fn is_finite(&self) -> bool {
        // Each duty is within ±1 or not a number, so one look at their sum checks both.
        let [motor1, motor4] = &self.motors;
        (motor1.duty + motor4.duty).is_finite()
    }

    /// Measures the zeros of the current sensors.
    fn rest(&mut self, sample: &BrushedSample) {
        self.measure_zeros(sample.current);
    }

    fn wake(&mut self, _: [i32; 2]) {
        self.zeros.restart();
    }

    /// The controller counts the encoders, which the board feeds.
    #[inline(always)]
    fn unpowered_place(&self) -> UnpoweredPlace {
        UnpoweredPlace::Kept
    }

    fn is_ready(&self) -> bool {
        self.zeros.are_plausible()
    }

    #[inline(always)]
    fn release(&mut self) {
        for motor in &mut self.motors {
            motor.release();
        }
    }

    #[inline(always)]
    fn watch_heat(&mut self, joint: Joint) -> Option<Fault> {
        let motor = self.motors.get_mut(joint.index())?;
        let model = self.models.get(joint.index())?;
        motor.warm(model).then_some(Fault::OverTemperature)
    }

    /// Each joint's turn begins the other one's.
    #[inline(always)]
    fn watch_loop(&mut self, joint: Joint) -> Option<Fault> {
        let other = self.motors.get_mut(joint.other().index())?;
        other.expect_oscillation();
        let motor = self.motors.get_mut(joint.index())?;
        let model = self.models.get(joint.index())?;
        motor.oscillates(model).then_some(Fault::Oscillation)
    }

    #[inline(always)]
    fn report(&self) -> DriveReport {
        let [motor1, motor4] = &self.motors;
        DriveReport {
            current: [motor1.current, motor4.current],
            current_demand: [motor1.demand, motor4.demand],
            duty: [motor1.duty, motor4.duty],
            bus_voltage: self.bus_voltage,
        }
    }

    fn torque(&self, [current1, current4]: [f32; 2]) -> [f32; 2] {
        let [model1, model4] = &self.models;
        [model1.torque(current1), model4.torque(current4)]
    }

    fn admits(settings: &Settings, excitation: &Excitation) -> bool {
        excitation.is_bounded(settings)
    }

    /// The other motor is shorted by its bridge.
    fn excite(&mut self, joint: Joint, of: Excited, value: f32, velocity: f32) {
        let (Some(motor), Some(model)) = (
            self.motors.get_mut(joint.index()),
            self.models.get(joint.index()),
        ) else {
            return;
        };
        match of {
            Excited::Voltage => motor.set_voltage(value, self.bus_voltage),
            Excited::Current => {
                let bus = Bus::new(self.bus_voltage, MOST_DUTY);
                motor.drive(model, model.torque(value), velocity, &bus);
            }
        }
    }
}

#[cfg(test)]
impl BrushedDrives {
    /// A current sensor that shows no number.
    pub(crate) fn spoil(&mut self, joint: Joint) {
        self.models[joint].spoil();
    }

    /// The current set-point of a motor [A].
    pub(crate) fn demand_mut(&mut self, joint: fivebar_kinematics::five_bar::Joint) -> &mut f32 {
        &mut self.motors[joint].demand
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drives() -> BrushedDrives {
        BrushedDrives::new(&Settings::BENCHTOP.check().expect("valid settings"))
    }

    #[test]
    fn the_current_of_either_motor_trips_above_its_limit() {
        let limit = Settings::BENCHTOP.protection.over_current;
        let fault = |currents: [f32; 2]| {
            let mut drives = drives();
            for (motor, current) in drives.motors.iter_mut().zip(currents) {
                motor.current = current;
            }
            drives.drive_fault()
        };
        for sign in [1.0, -1.0] {
            let (at, beyond) = (sign * limit, sign * limit.next_up());
            assert_eq!(fault([at, at]), None, "both at {at}");
            for currents in [[beyond, 0.0], [0.0, beyond], [2.0 * beyond, -2.0 * beyond]] {
                assert_eq!(fault(currents), Some(Fault::OverCurrent), "{currents:?}");
            }
        }
        // It is found in the duties.
        assert_eq!(fault([f32::NAN; 2]), None);
    }

    #[test]
    fn a_bus_voltage_outside_its_range_is_a_fault_by_its_side() {
        let mut drives = drives();
        let mut fault = |voltage: f32| {
            drives.bus_voltage = voltage;
            drives.supply_fault()
        };
        let [low, high] = Settings::BENCHTOP.protection.bus_voltage;
        for inside in [low, 24.0, high] {
            assert_eq!(fault(inside), None, "{inside} V");
        }
        for (voltage, expected) in [
            (low.next_down(), Fault::UnderVoltage),
            (0.0, Fault::UnderVoltage),
            (high.next_up(), Fault::OverVoltage),
            (1000.0, Fault::OverVoltage),
            (f32::INFINITY, Fault::OverVoltage),
        ] {
            assert_eq!(fault(voltage), Some(expected), "{voltage} V");
        }
    }
}
