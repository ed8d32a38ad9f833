//! One driven joint: from sensor samples to its angle, velocity and current, and from a torque
//! to the duty of its bridge.

use super::encoder::Scale;
use super::model::AxisModel;
use super::motor_check::{MotorCheck, MotorSample};
use super::oscillation::Oscillation;
use crate::safety::Fault;
use crate::settings::AxisSettings;
use fivebar_kinematics::Scalar;
use fivebar_kinematics::control::{Bus, CurrentState, Drive, Integral, MotorHeat, ObserverState};

/// The heat of the motors at a start, as a share of their limit. Nothing tells how hot they were when
/// the power went off, or how long ago that was: a motor that was switched off by its heat, and at
/// once on again, must not count as cold. What is left is enough for homing and a first job.
pub(crate) const START_HEAT: f32 = 0.3;

/// The state of one joint from tick to tick, and what this tick measured.
// In the order of `LatchedJoint` first.
#[derive(Clone)]
#[repr(C)]
pub(crate) struct Joint {
    observer: ObserverState<f32>,
    /// Motor current [A].
    pub(crate) current: f32,
    /// Current set-point [A].
    pub(crate) demand: f32,
    /// Counts at the last tick.
    counts: i32,
    /// The counts from which the angle is counted: those of the first tick until homed.
    origin: i32,
    angle_at_origin: f32,
    heat: MotorHeat<f32>,
    current_state: CurrentState<f32>,
    /// Integral of the position loop.
    pub(crate) integral: Integral<f32>,
    /// Duty of the bridge.
    pub(crate) duty: f32,
    motor: MotorCheck,
    oscillation: Oscillation,
}

impl Joint {
    /// A joint at rest. Its motor may have been hot when the power went off, see [`START_HEAT`].
    pub(crate) fn new(axis: &AxisSettings) -> Self {
        Self {
            counts: 0,
            origin: 0,
            angle_at_origin: 0.0,
            observer: ObserverState::at_rest(0.0),
            heat: MotorHeat::at_share(START_HEAT, axis.continuous_current),
            current_state: CurrentState(0.0),
            integral: Integral(0.0),
            current: 0.0,
            demand: 0.0,
            duty: 0.0,
            motor: MotorCheck::new(),
            oscillation: Oscillation::NONE,
        }
    }

    /// Takes the motor's heat over from the joint before new settings: all of it if the motor has the
    /// same ratings, else its share of the limit, and at least that of a start.
    pub(crate) fn keep_heat(&mut self, axis: &AxisSettings, before: &Self, old: &AxisSettings) {
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

    /// θ̂ [rad], absolute only when homed.
    #[inline(always)]
    pub(crate) fn angle(&self) -> f32 {
        self.observer.angle
    }

    /// ω̂ [rad/s].
    #[inline(always)]
    pub(crate) fn velocity(&self) -> f32 {
        self.observer.velocity
    }

    /// Updates the joint from one tick's samples; `alpha` is the desired acceleration [rad/s²]
    /// of the tick before. Returns the innovation, measured less predicted angle [rad].
    #[inline(always)]
    pub(crate) fn measure(
        &mut self,
        model: &AxisModel,
        counts: i32,
        current: u16,
        alpha: f32,
    ) -> f32 {
        self.counts = counts;
        self.current = model.current_offset + model.current_per_code * f32::from(current);
        let counted = self.counted(model);
        model
            .servo
            .observer
            .update(&mut self.observer, counted, alpha)
    }

    /// Checks the motor after [`Joint::measure`] in a tick with power: the fault that its equation shows.
    /// `error` is the position error of the tick before [rad].
    #[inline(always)]
    pub(crate) fn motor_fault(
        &mut self,
        model: &AxisModel,
        error: f32,
        bus_voltage: f32,
    ) -> Option<Fault> {
        let sample = MotorSample {
            counts: self.counts,
            velocity: self.observer.velocity,
            error,
            current: self.current,
            demand: self.demand,
            duty: self.duty,
            bus_voltage,
        };
        self.motor.fault(&model.motor_limits, &sample)
    }

    /// Advances the motor's heat by all turns at its current; true while it is too hot. A sensor that
    /// shows less than the least current that the motor's equation admits is not believed.
    #[inline(always)]
    pub(crate) fn warm(&mut self, model: &AxisModel) -> bool {
        let (measured, least) = (Scalar::abs(self.current), self.motor.least_current());
        let current = if measured > least { measured } else { least };
        model.heating.update(&mut self.heat, current)
    }

    /// Half of the turns before [`Joint::oscillates`].
    #[inline(always)]
    pub(crate) fn expect_oscillation(&mut self) {
        self.oscillation.begin(self.demand);
    }

    /// Whether the joint's loop oscillates; once in all turns.
    #[inline(always)]
    pub(crate) fn oscillates(&mut self, model: &AxisModel) -> bool {
        self.oscillation
            .exceeds(self.demand, model.oscillation_limit)
    }

    /// Takes the counts of the first tick as the origin until homed. A counter may start at any
    /// value, and `f32` angles far from 0 would lose resolution.
    #[cold]
    pub(crate) fn begin(&mut self, model: &AxisModel, counts: i32) {
        self.origin = counts;
        self.settle(model);
    }

    /// Sets the duty that gives the current which `torque` [N·m] needs; true if the bus voltage
    /// limits it.
    #[inline(always)]
    pub(crate) fn drive(&mut self, model: &AxisModel, torque: f32, bus: &Bus<f32>) -> bool {
        self.demand = torque * model.current_per_torque;
        let Drive { duty, limited } = model.servo.current_loop.update(
            &mut self.current_state,
            self.demand,
            self.current,
            self.observer.velocity,
            bus,
        );
        self.duty = duty;
        limited
    }

    /// The counted angle [rad]. Counts wrap; their wrapping difference from the origin is right.
    #[inline(always)]
    fn counted(&self, model: &AxisModel) -> f32 {
        self.angle_at_origin + model.radians_per_count * self.turned() as f32
    }

    /// The latched counts.
    pub(crate) fn counts(&self) -> i32 {
        self.counts
    }

    /// Counts from the origin.
    #[inline(always)]
    pub(crate) fn turned(&self) -> i32 {
        self.counts.wrapping_sub(self.origin)
    }

    /// Changes the angle over the counts.
    #[inline(always)]
    pub(crate) fn set_scale(&mut self, model: &mut AxisModel, scale: Scale) {
        self.angle_at_origin = scale.at_origin;
        model.radians_per_count = scale.per_count;
    }

    /// Changes the angle over the counts of an arm that is not driven. The velocity stays.
    pub(crate) fn shift_to_scale(&mut self, model: &mut AxisModel, scale: Scale) {
        let before = self.counted(model);
        self.set_scale(model, scale);
        self.observer.angle += self.counted(model) - before;
    }

    /// Sets the origin: the joint's angle is `angle` [rad] at `counts`. The velocity stays.
    pub(crate) fn set_origin(&mut self, model: &AxisModel, counts: i32, angle: f32) {
        let before = self.counted(model);
        self.origin = counts;
        self.angle_at_origin = angle;
        self.observer.angle += self.counted(model) - before;
    }

    /// Clears the loops' integrals and outputs: the bridge is off.
    pub(crate) fn release(&mut self) {
        self.current_state = CurrentState(0.0);
        self.integral = Integral(0.0);
        self.demand = 0.0;
        self.duty = 0.0;
        self.motor.release();
        self.oscillation = Oscillation::NONE;
    }

    /// Clears all motion; keeps the counts and the origin.
    pub(crate) fn settle(&mut self, model: &AxisModel) {
        self.release();
        self.observer = ObserverState::at_rest(self.counted(model));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::controller::model::Model;
    use crate::settings::Settings;

    #[test]
    fn a_bridge_that_was_off_begins_without_the_integral_of_its_current_loop() {
        let model = Model::new(&Settings::BENCHTOP.check().unwrap());
        let [axis, _] = &model.axes;
        let bus = Bus::new(24.0, 0.95);
        let mut fresh = Joint::new(&Settings::BENCHTOP.axes[0]);
        fresh.drive(axis, 0.05, &bus);
        let mut used = Joint::new(&Settings::BENCHTOP.axes[0]);
        for _ in 0..20 {
            used.drive(axis, 0.05, &bus);
        }
        assert!(used.duty > 1.5 * fresh.duty, "the integral grows");
        used.release();
        used.drive(axis, 0.05, &bus);
        assert_eq!(used.duty, fresh.duty);
    }

    /// The share of the heat's limit after new settings, from this share before: with this change of
    /// the motor's ratings.
    fn kept(share: f32, change: impl FnOnce(&mut AxisSettings)) -> f32 {
        let [old, _] = Settings::BENCHTOP.axes;
        let mut new = old;
        change(&mut new);
        let (mut before, mut joint) = (Joint::new(&old), Joint::new(&new));
        before.heat = MotorHeat::at_share(share, old.continuous_current);
        joint.keep_heat(&new, &before, &old);
        joint.heat.share(new.continuous_current)
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
