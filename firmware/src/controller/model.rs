//! The constants of the tick, computed once from the settings.

use super::homing_state::HomingConfig;
use super::motor_check::MotorLimits;
use super::oscillation;
use super::rest::Stage;
use super::turns::TURNS;
use crate::drivers::WAKE_UP_TIME;
use crate::safety::Monitor;
use crate::settings::{AxisSettings, CheckedSettings, ControlSettings};
use core::f32::consts::TAU;
use fivebar_kinematics::Scalar;
use fivebar_kinematics::control::{
    CurrentLoop, FrictionCompensation, MotorHeating, PositionLoop, TorqueLimit, VelocityObserver,
};
use fivebar_kinematics::dynamics::BaseParameterModel;
use fivebar_kinematics::five_bar::{Side, Tool};

/// Greatest duty: the bridges' high sides and the sampling of the currents need the rest of each
/// PWM period.
pub(crate) const DUTY_LIMIT: f32 = 0.95;

/// The constants of the tick. What every tick needs comes first, see [`Controller`].
///
/// [`Controller`]: super::Controller
#[derive(Clone)]
#[repr(C)]
pub(crate) struct Model {
    pub(crate) axes: [AxisModel; 2],
    pub(crate) torque_limit: TorqueLimit<f32>,
    pub(crate) monitor: Monitor,
    pub(crate) equations: BaseParameterModel<f32>,
    /// The arm's lengths and the tool's position on link 2.
    pub(crate) tool: Tool<f32>,
    pub(crate) bus_voltage_per_code: f32,
    pub(crate) assembly: Side,
    pub(crate) computed_torque: bool,
    /// Each joint's inertia [kg·m²] for the loops that assume a constant one.
    pub(crate) nominal_inertia: [f32; 2],
    /// T [s].
    pub(crate) period: f32,
    /// Ticks after which an arm rests.
    pub(crate) rest_ticks: u32,
    /// 1/`rest_ticks`.
    pub(crate) per_rest_tick: f32,
    /// The lag of the current loop, 1/ωc [s]: the set-point leads by it.
    pub(crate) lag: f32,
    pub(crate) homing_configs: [HomingConfig; 2],
    /// Ticks from switching the bridges on to the first one that drives them.
    pub(crate) wake_up_ticks: u32,
}

/// The loops of one joint.
#[derive(Clone, Copy)]
pub(crate) struct Servo {
    pub(crate) current_loop: CurrentLoop<f32>,
    pub(crate) observer: VelocityObserver<f32>,
    pub(crate) position_loop: PositionLoop<f32>,
}

/// The bandwidths of an arm that moves, that settles and that rests, as shares: of the position loop
/// with its observer, and of the current loop. An arm at rest need not follow, and a count of its
/// encoders and the noise of its current sensors then give little torque. The gains of a moving arm
/// can keep it in a limit cycle of a count, whose velocity would carry an arm at rest away by many:
/// between them, it settles.
const STAGES: [[f32; 2]; 3] = [[1.0, 1.0], [0.36, 0.4], [0.126, 0.12]];
/// The shares of an arm that crosses a singularity: of the position loop, its observer, and the current
/// loop. A count of its encoders then gives little torque where nothing but its momentum carries it on.
const CROSSING: [f32; 3] = [0.36, 0.15, 1.0];
/// The lag of a crossing's torques behind its laws [s]. Its set-point leads by it, too.
pub(crate) const CROSSING_LAG: f32 = 1.2e-3;
/// Time for which the reference must rest, and the joints be near it, in each stage [s].
const REST_TIME: f32 = 0.15;
/// Greatest error of a joint that comes to rest or rests [counts].
const REST_COUNTS: f32 = 5.0;

/// The constants of one joint.
#[derive(Clone)]
pub(crate) struct AxisModel {
    /// The servo in use: a copy, because the tick reads it with few instructions.
    pub(crate) servo: Servo,
    /// The servo of each stage.
    servos: [Servo; STAGES.len()],
    /// The stage whose servo is in use.
    pub(crate) stage: Stage,
    /// Greatest error of a joint that comes to rest or rests [rad].
    pub(crate) rest_error: f32,
    pub(crate) heating: MotorHeating<f32>,
    pub(super) motor_limits: MotorLimits,
    pub(crate) friction: FrictionCompensation<f32>,
    /// Of the joint [rad]; changes with the correction of its encoder's error.
    pub(crate) radians_per_count: f32,
    /// [A].
    pub(crate) current_per_code: f32,
    /// Current at code 0 [A].
    pub(crate) current_offset: f32,
    /// Motor current per joint torque, 1/(N k) [A/(N·m)].
    pub(crate) current_per_torque: f32,
    /// Greatest torque while homing [N·m].
    pub(crate) homing_torque: f32,
    /// Greatest mean change of the current set-point [A].
    pub(crate) oscillation_limit: f32,
}

impl Model {
    pub(crate) fn new(settings: &CheckedSettings) -> Self {
        let control = &settings.control;
        let period = 1.0 / control.tick_rate;
        // By reference: copies of both would take stack.
        let [axis1, axis4] = &settings.axes;
        let rest_ticks = ((REST_TIME * control.tick_rate) as u32).max(1);
        Self {
            equations: BaseParameterModel::new(settings.arm()),
            tool: *settings.tool(),
            assembly: settings.assembly(),
            axes: [
                AxisModel::new(axis1, settings),
                AxisModel::new(axis4, settings),
            ],
            torque_limit: TorqueLimit(settings.peak_torque()),
            nominal_inertia: settings.nominal_inertia(),
            computed_torque: control.computed_torque,
            period,
            rest_ticks,
            per_rest_tick: 1.0 / rest_ticks as f32,
            lag: 1.0 / control.current_bandwidth,
            bus_voltage_per_code: settings.protection.bus_voltage_per_code,
            monitor: Monitor::new(settings),
            homing_configs: [
                HomingConfig::new(axis1, settings),
                HomingConfig::new(axis4, settings),
            ],
            wake_up_ticks: wake_up_ticks(settings),
        }
    }
}

/// Ticks from switching the bridges on to the first one that drives them: one more than they need, because a
/// command acts from the next tick on.
pub(crate) fn wake_up_ticks(settings: &CheckedSettings) -> u32 {
    (WAKE_UP_TIME * settings.control.tick_rate) as u32 + 1
}

impl Servo {
    /// The servo with these shares of the bandwidths: of the position loop, its observer, and the
    /// current loop.
    fn new(
        axis: &AxisSettings,
        control: &ControlSettings,
        [share, of_observer, of_current]: [f32; 3],
        lag: f32,
    ) -> Self {
        let period = 1.0 / control.tick_rate;
        let current_bandwidth = of_current * control.current_bandwidth;
        Self {
            current_loop: CurrentLoop::new(
                current_bandwidth,
                period,
                axis.resistance,
                axis.inductance,
                axis.gear_ratio * axis.torque_constant,
            ),
            observer: VelocityObserver::new(of_observer * control.observer_bandwidth, period),
            // The prediction bridges the encoder's latency, too.
            position_loop: PositionLoop::new(
                share * control.bandwidth,
                control.damping,
                1.0 / current_bandwidth + axis.encoder_latency + lag,
                share * control.integral_rate,
                period,
            ),
        }
    }
}

impl AxisModel {
    /// Gives the joint the servo of this stage.
    #[cold]
    #[inline(never)]
    pub(crate) fn select_servo(&mut self, stage: Stage) {
        let [moving, settling, resting] = &self.servos;
        let servo = match stage {
            // Of a crossing there is none: it begins with its own.
            Stage::Moves | Stage::Crosses => moving,
            Stage::Settles => settling,
            Stage::Rests => resting,
        };
        self.servo = *servo;
        self.stage = stage;
    }

    /// Gives the joint the servo of an arm that crosses a singularity.
    pub(crate) fn cross(&mut self, axis: &AxisSettings, control: &ControlSettings) {
        self.servo = Servo::new(axis, control, CROSSING, CROSSING_LAG);
        self.stage = Stage::Crosses;
    }

    /// The joint's torque [N·m] at this motor current [A].
    pub(crate) fn torque(&self, current: f32) -> f32 {
        current / self.current_per_torque
    }

    #[inline(always)]
    fn new(axis: &AxisSettings, settings: &CheckedSettings) -> Self {
        let control = &settings.control;
        let period = 1.0 / control.tick_rate;
        let counts_per_turn = axis.encoder_counts as f32 * axis.gear_ratio;
        let radians_per_count = TAU / counts_per_turn;
        let torque_per_current = axis.gear_ratio * axis.torque_constant;
        let [moving, settling, resting] =
            STAGES.map(|[share, of_current]| [share, share, of_current]);
        let servos = [
            Servo::new(axis, control, moving, 0.0),
            Servo::new(axis, control, settling, 0.0),
            Servo::new(axis, control, resting, 0.0),
        ];
        Self {
            servo: servos[0],
            servos,
            stage: Stage::Moves,
            rest_error: REST_COUNTS * Scalar::abs(radians_per_count),
            // Each joint's heat is updated once in all turns.
            heating: MotorHeating::new(
                axis.continuous_current,
                axis.thermal_time_constant,
                TURNS as f32 * period,
            ),
            motor_limits: MotorLimits::new(axis, settings),
            friction: FrictionCompensation::new(
                axis.viscous_friction,
                axis.coulomb_friction,
                control.friction_smoothing,
            ),
            radians_per_count,
            current_per_code: axis.current_per_code,
            current_offset: -axis.current_per_code * f32::from(axis.current_zero_code),
            current_per_torque: 1.0 / torque_per_current,
            homing_torque: Scalar::abs(torque_per_current) * settings.homing.current,
            oscillation_limit: oscillation::limit(axis),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::settings::Settings;

    /// The model of an arm with this change of joint 4.
    fn model(change: impl FnOnce(&mut AxisSettings)) -> Model {
        let mut settings = Settings::BENCHTOP;
        change(&mut settings.axes[1]);
        Model::new(&settings.check().unwrap())
    }

    #[test]
    fn the_limits_of_a_reversed_gear_are_those_of_the_same_gear_forward() {
        let forward = model(|_| ());
        let reversed = model(|axis| axis.gear_ratio = -axis.gear_ratio);
        let ([_, forward4], [_, reversed4]) = (&forward.axes, &reversed.axes);
        assert_eq!(reversed4.current_per_torque, -forward4.current_per_torque);
        assert_eq!(reversed4.rest_error, forward4.rest_error);
        assert_eq!(reversed4.homing_torque, forward4.homing_torque);
        assert_eq!(reversed.torque_limit.0, forward.torque_limit.0);
        assert!(reversed4.homing_torque > 0.0);
    }

    #[test]
    fn a_joint_is_predicted_by_the_lag_of_its_current_loop_and_the_age_of_its_angle() {
        let model = model(|axis| axis.encoder_latency = 1e-3);
        let lags = model.axes.each_ref().map(|axis| {
            let (angle, _) = axis.servo.position_loop.predict(0.0, 1.0, 0.0);
            angle
        });
        for (lag, wanted) in lags.into_iter().zip([1.0 / 3500.0, 1.0 / 3500.0 + 1e-3]) {
            assert!((lag - wanted).abs() < 1e-9, "{lag} s");
        }
    }
}
