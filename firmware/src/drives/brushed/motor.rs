//! One brushed motor: its current, its heat, and the duty of its bridge.

use super::motor_check::{MotorCheck, MotorLimits, MotorSample};
use super::oscillation::{self, Oscillation};
use super::{MOST_DUTY, bandwidth_share};
use crate::drives::{JointState, Stage, WATCHED_EVERY};
use crate::safety::Fault;
use crate::settings::{AxisSettings, ControlSettings, Settings};
use fivebar_kinematics::Scalar;
use fivebar_kinematics::control::{Bus, CurrentLoop, CurrentState, Drive, MotorHeat, MotorHeating};

/// The heat of the motors at a start, as a share of their limit. Nothing tells how hot they were when
/// the power went off, or how long ago that was: a motor that was switched off by its heat, and at
/// once on again, must not count as cold. What is left is enough for homing and a first job.
const START_HEAT: f32 = 0.3;

/// A motor from tick to tick.
#[derive(Clone)]
#[repr(C)]
pub(super) struct Motor {
    /// Motor current [A].
    pub(super) current: f32,
    /// Current set-point [A].
    pub(super) demand: f32,
    /// Duty of the bridge.
    pub(super) duty: f32,
    loop_state: CurrentState<f32>,
    heat: MotorHeat<f32>,
    check: MotorCheck,
    oscillation: Oscillation,
}

/// The constants of one motor.
#[derive(Clone)]
pub(super) struct MotorModel {
    /// The current loop in use: a copy, because the tick reads it with few instructions.
    current_loop: CurrentLoop<f32>,
    /// [A].
    current_per_code: f32,
    /// Current at code 0 [A].
    current_offset: f32,
    /// Motor current per joint torque, 1/(N k) [A/(N·m)].
    current_per_torque: f32,
    limits: MotorLimits,
    heating: MotorHeating<f32>,
    /// Greatest mean change of the current set-point [A].
    oscillation_limit: f32,
    /// The current loops of an arm that moves, settles and rests.
    current_loops: [CurrentLoop<f32>; 3],
}

impl MotorModel {
    pub(super) fn new(axis: &AxisSettings, settings: &Settings) -> Self {
        let control = &settings.control;
        let current_loops = [
            current_loop(axis, control, Stage::Moves),
            current_loop(axis, control, Stage::Settles),
            current_loop(axis, control, Stage::Rests),
        ];
        let [moving, ..] = current_loops;
        Self {
            current_loop: moving,
            current_per_code: axis.current_per_code,
            current_offset: -axis.current_per_code * f32::from(axis.current_zero_code),
            current_per_torque: 1.0 / (axis.gear_ratio * axis.torque_constant),
            limits: MotorLimits::new(axis, settings),
            heating: MotorHeating::new(
                axis.continuous_current,
                axis.thermal_time_constant,
                WATCHED_EVERY as f32 * (1.0 / control.tick_rate),
            ),
            oscillation_limit: oscillation::limit(axis),
            current_loops,
        }
    }

    /// Gives the motor the current loop of this stage.
    pub(super) fn select(&mut self, stage: Stage) {
        let [moving, settling, resting] = &self.current_loops;
        self.current_loop = *match stage {
            Stage::Moves | Stage::Crosses => moving,
            Stage::Settles => settling,
            Stage::Rests => resting,
        };
    }

    /// Takes this code as the zero of the current sensor.
    pub(super) fn set_zero(&mut self, code: f32) {
        self.current_offset = -self.current_per_code * code;
    }

    /// The joint's torque [N·m] at this motor current [A].
    pub(super) fn torque(&self, current: f32) -> f32 {
        current / self.current_per_torque
    }

    #[cfg(test)]
    pub(super) fn spoil(&mut self) {
        self.current_offset = f32::NAN;
    }
}

fn current_loop(axis: &AxisSettings, control: &ControlSettings, stage: Stage) -> CurrentLoop<f32> {
    CurrentLoop::new(
        bandwidth_share(stage) * control.current_bandwidth,
        1.0 / control.tick_rate,
        axis.resistance,
        axis.inductance,
        axis.gear_ratio * axis.torque_constant,
    )
}

impl Motor {
    /// A motor without current. It may have been hot when the power went off, see [`START_HEAT`].
    pub(super) fn new(axis: &AxisSettings) -> Self {
        Self {
            current: 0.0,
            demand: 0.0,
            duty: 0.0,
            loop_state: CurrentState(0.0),
            heat: MotorHeat::at_share(START_HEAT, axis.continuous_current),
            check: MotorCheck::new(),
            oscillation: Oscillation::NONE,
        }
    }

    /// Takes the heat over from the motor before new settings: all of it if the motor has the
    /// same ratings, else its share of the limit, and at least that of a start.
    pub(super) fn keep_heat(&mut self, axis: &AxisSettings, before: &Self, old: &AxisSettings) {
        if axis.continuous_current == old.continuous_current
            && axis.thermal_time_constant == old.thermal_time_constant
        {
            self.heat = before.heat;
            return;
        }
        let share = before.heat.share(old.continuous_current);
        if share > START_HEAT {
            self.heat = MotorHeat::at_share(share, axis.continuous_current);
        }
    }

    /// Takes the code of the current sensor over.
    #[inline(always)]
    pub(super) fn sense(&mut self, model: &MotorModel, code: u16) {
        self.current = model.current_offset + model.current_per_code * f32::from(code);
    }

    /// The fault that the motor's equation shows in a tick with power, after [`Motor::sense`].
    #[inline(always)]
    pub(super) fn contradiction(
        &mut self,
        model: &MotorModel,
        joint: &JointState,
        bus_voltage: f32,
    ) -> Option<Fault> {
        let sample = MotorSample {
            counts: joint.counts,
            velocity: joint.velocity,
            error: joint.error,
            current: self.current,
            demand: self.demand,
            duty: self.duty,
            bus_voltage,
        };
        self.check.fault(&model.limits, &sample)
    }

    /// Sets the duty that gives the current which `torque` [N·m] needs at this joint velocity [rad/s]; true if the
    /// bus voltage limits it.
    #[inline(always)]
    pub(super) fn drive(
        &mut self,
        model: &MotorModel,
        torque: f32,
        velocity: f32,
        bus: &Bus<f32>,
    ) -> bool {
        self.demand = torque * model.current_per_torque;
        let state = &mut self.loop_state;
        let Drive { duty, limited } =
            model
                .current_loop
                .update(state, self.demand, self.current, velocity, bus);
        self.duty = duty;
        limited
    }

    /// Sets the duty that gives this voltage [V]. What is not a number stays so.
    pub(super) fn set_voltage(&mut self, voltage: f32, bus_voltage: f32) {
        let duty = voltage / bus_voltage;
        self.duty = if Scalar::abs(duty) > MOST_DUTY {
            MOST_DUTY.copysign(duty)
        } else {
            duty
        };
    }

    /// Advances the heat by [`WATCHED_EVERY`] ticks at the motor's current; true while it is too hot. A
    /// sensor that shows less than the least current that the motor's equation admits is not believed.
    #[inline(always)]
    pub(super) fn warm(&mut self, model: &MotorModel) -> bool {
        let (measured, least) = (Scalar::abs(self.current), self.check.least_current());
        let current = if measured > least { measured } else { least };
        model.heating.update(&mut self.heat, current)
    }

    /// Half of the ticks before [`Motor::oscillates`].
    #[inline(always)]
    pub(super) fn expect_oscillation(&mut self) {
        self.oscillation.begin(self.demand);
    }

    /// Whether the joint's loop oscillates, once in [`WATCHED_EVERY`] ticks.
    #[inline(always)]
    pub(super) fn oscillates(&mut self, model: &MotorModel) -> bool {
        self.oscillation
            .exceeds(self.demand, model.oscillation_limit)
    }

    /// Clears the loop and its output: the bridge is off.
    #[inline(always)]
    pub(super) fn release(&mut self) {
        self.loop_state = CurrentState(0.0);
        self.demand = 0.0;
        self.duty = 0.0;
        self.check.release();
        self.oscillation = Oscillation::NONE;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bridge_that_was_off_begins_without_the_integral_of_its_current_loop() {
        let settings = Settings::BENCHTOP;
        let [axis, _] = &settings.axes;
        let model = MotorModel::new(axis, &settings);
        let bus = Bus::new(24.0, 0.95);
        let mut fresh = Motor::new(axis);
        fresh.drive(&model, 0.05, 0.0, &bus);
        let mut used = Motor::new(axis);
        for _ in 0..20 {
            used.drive(&model, 0.05, 0.0, &bus);
        }
        assert!(used.duty > 1.5 * fresh.duty, "the integral grows");
        used.release();
        used.drive(&model, 0.05, 0.0, &bus);
        assert_eq!(used.duty, fresh.duty);
    }

    #[test]
    fn a_reversed_gear_gives_the_opposite_torque_at_the_same_current() {
        let settings = Settings::BENCHTOP;
        let [axis, _] = settings.axes;
        let reversed = AxisSettings {
            gear_ratio: -axis.gear_ratio,
            ..axis
        };
        let torque = |axis: &AxisSettings| MotorModel::new(axis, &settings).torque(1.5);
        assert_eq!(torque(&reversed), -torque(&axis));
        let expected = 1.5 * axis.gear_ratio * axis.torque_constant;
        assert!((torque(&axis) - expected).abs() < 1e-6 * expected.abs());
    }

    /// The share of the heat's limit after new settings, from this share before: with this change of
    /// the motor's ratings.
    fn kept(share: f32, change: impl FnOnce(&mut AxisSettings)) -> f32 {
        let [old, _] = Settings::BENCHTOP.axes;
        let mut new = old;
        change(&mut new);
        let (mut before, mut motor) = (Motor::new(&old), Motor::new(&new));
        before.heat = MotorHeat::at_share(share, old.continuous_current);
        motor.keep_heat(&new, &before, &old);
        motor.heat.share(new.continuous_current)
    }

    #[test]
    fn the_same_motor_keeps_its_heat_and_another_one_its_share_and_that_of_a_start() {
        let stronger = |axis: &mut AxisSettings| axis.continuous_current *= 2.0;
        let slower = |axis: &mut AxisSettings| axis.thermal_time_constant *= 2.0;
        for share in [0.05, 0.6, 0.95] {
            let near = |kept: f32, wanted: f32| (kept - wanted).abs() < 1e-5;
            assert!(near(kept(share, |_| ()), share));
            assert!(near(kept(share, stronger), share.max(START_HEAT)));
            assert!(near(kept(share, slower), share.max(START_HEAT)));
        }
    }
}
