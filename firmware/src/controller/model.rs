//! The constants of the tick, computed once from the settings.

use super::homing_state::HomingConfig;
use crate::drivers::WAKE_UP_TIME;
use crate::safety::Monitor;
use crate::settings::{AxisSettings, CheckedSettings};
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
#[repr(C)]
pub(crate) struct Model {
    pub(crate) axes: [AxisModel; 2],
    pub(crate) observer: VelocityObserver<f32>,
    pub(crate) position_loop: PositionLoop<f32>,
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
    pub(crate) homing_configs: [HomingConfig; 2],
    /// Ticks from switching the bridges on to the first one that drives them.
    pub(crate) wake_up_ticks: u32,
}

/// The constants of one joint.
pub(crate) struct AxisModel {
    pub(crate) current_loop: CurrentLoop<f32>,
    pub(crate) heating: MotorHeating<f32>,
    pub(crate) friction: FrictionCompensation<f32>,
    /// Of the joint [rad].
    pub(crate) radians_per_count: f32,
    /// [A].
    pub(crate) current_per_code: f32,
    /// Current at code 0 [A].
    pub(crate) current_offset: f32,
    /// Motor current per joint torque, 1/(N k) [A/(N·m)].
    pub(crate) current_per_torque: f32,
    /// Greatest torque while homing [N·m].
    pub(crate) homing_torque: f32,
}

impl Model {
    pub(crate) fn new(settings: &CheckedSettings) -> Self {
        let control = &settings.control;
        let period = 1.0 / control.tick_rate;
        Self {
            equations: BaseParameterModel::new(settings.arm()),
            tool: *settings.tool(),
            assembly: settings.assembly(),
            axes: settings.axes.map(|axis| AxisModel::new(&axis, settings)),
            observer: VelocityObserver::new(control.observer_bandwidth, period),
            position_loop: PositionLoop::new(
                control.bandwidth,
                control.damping,
                1.0 / control.current_bandwidth,
                control.integral_rate,
                period,
            ),
            torque_limit: TorqueLimit(settings.peak_torque()),
            nominal_inertia: settings.nominal_inertia(),
            computed_torque: control.computed_torque,
            period,
            bus_voltage_per_code: settings.protection.bus_voltage_per_code,
            monitor: Monitor::new(settings),
            homing_configs: settings
                .axes
                .map(|axis| HomingConfig::new(&axis, &settings.homing)),
            // One more, because a command acts from the next tick on.
            wake_up_ticks: (WAKE_UP_TIME * control.tick_rate) as u32 + 1,
        }
    }
}

impl AxisModel {
    fn new(axis: &AxisSettings, settings: &CheckedSettings) -> Self {
        let control = &settings.control;
        let period = 1.0 / control.tick_rate;
        let counts_per_turn = axis.encoder_counts as f32 * axis.gear_ratio;
        let radians_per_count = TAU / counts_per_turn;
        let torque_per_current = axis.gear_ratio * axis.torque_constant;
        Self {
            current_loop: CurrentLoop::new(
                control.current_bandwidth,
                period,
                axis.resistance,
                axis.inductance,
                torque_per_current,
            ),
            // Each joint's heat is updated in every other tick.
            heating: MotorHeating::new(
                axis.continuous_current,
                axis.thermal_time_constant,
                2.0 * period,
            ),
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
        }
    }
}
