//! The constants of the tick, computed once from the settings.

use super::homing_state::HomingConfig;
use super::setpoint_history::Age;
use crate::drives::{Drives, Needs, Stage};
use crate::safety::Monitor;
use crate::settings::{AxisSettings, BeltSettings, CheckedSettings, ControlSettings};
use core::f32::consts::TAU;
use fivebar_kinematics::Scalar;
use fivebar_kinematics::control::{
    BeltLaw, FrictionCompensation, PositionLoop, TorqueLimit, VelocityObserver,
};
use fivebar_kinematics::dynamics::BaseParameterModel;
use fivebar_kinematics::five_bar::{Side, Tool};

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
    pub(crate) assembly: Side,
    pub(crate) computed_torque: bool,
    /// Whether the joints are behind belts, and the loops know it.
    pub(crate) on_belts: bool,
    /// Jr at each joint [kg·m²].
    pub(crate) rotor_inertia: [f32; 2],
    /// The encoders' latency of joints behind belts [ticks].
    pub(crate) late_ticks: usize,
    /// Each joint's inertia [kg·m²] for the loops that assume a constant one.
    pub(crate) nominal_inertia: [f32; 2],
    /// The torques that hold the arm at its home angles against gravity [N·m].
    pub(crate) home_gravity: [f32; 2],
    /// The greatest position error of each joint while homing [rad].
    pub(crate) homing_error: [f32; 2],
    /// T [s].
    pub(crate) period: f32,
    /// Ticks after which an arm rests.
    pub(crate) rest_ticks: u32,
    /// 1/`rest_ticks`.
    pub(crate) per_rest_tick: f32,
    /// The lag of the drives [s]: the set-point leads by it.
    pub(crate) lag: f32,
    pub(crate) homing_configs: [HomingConfig; 2],
    /// Ticks from switching the drives on to the first one that drives.
    pub(crate) wake_up_ticks: u32,
}

/// The loops of one joint.
#[derive(Clone, Copy)]
pub(crate) struct Servo {
    pub(crate) observer: VelocityObserver<f32>,
    pub(crate) position_loop: PositionLoop<f32>,
    /// Of the set-point that belongs to a sample.
    pub(crate) age: Age,
}

/// The bandwidths of the position loop with its observer, as shares, of an arm that moves, that settles and
/// that rests. An arm at rest need not follow, and a count of its encoders then gives little torque. The gains of a
/// moving arm can keep it in a limit cycle of a count, whose velocity would carry an arm at rest away by many:
/// between them, it settles.
const SHARES: [f32; 3] = [1.0, 0.36, 0.126];
/// The shares of an arm that crosses a singularity: of the position loop, and of its observer. A count of its
/// encoders then gives little torque where nothing but its momentum carries it on.
const CROSSING: [f32; 2] = [0.36, 0.15];
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
    servos: [Servo; SHARES.len()],
    /// The servo of an arm that crosses a singularity.
    crossing: Servo,
    /// The law of each stage of a joint behind a belt.
    belts: [BeltLaw<f32>; SHARES.len()],
    /// The stage whose servo is in use.
    pub(crate) stage: Stage,
    /// Greatest error of a joint that comes to rest or rests [rad].
    pub(crate) rest_error: f32,
    pub(crate) friction: FrictionCompensation<f32>,
    /// Of the joint [rad]; changes with the correction of its encoder's error.
    pub(crate) radians_per_count: f32,
    /// Greatest torque while homing [N·m].
    pub(crate) homing_torque: f32,
}

impl Model {
    pub(crate) fn new<D: Drives>(settings: &CheckedSettings) -> Self {
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
                AxisModel::new::<D>(axis1, &settings.belts[0], settings),
                AxisModel::new::<D>(axis4, &settings.belts[1], settings),
            ],
            torque_limit: TorqueLimit(settings.peak_torque()),
            nominal_inertia: settings.nominal_inertia(),
            home_gravity: home_gravity(settings),
            homing_error: homing_error::<D>(settings),
            computed_torque: control.computed_torque,
            on_belts: control.computed_torque && settings.is_on_belts(),
            rotor_inertia: settings.arm().rotor_inertia(),
            late_ticks: late_ticks(settings),
            period,
            rest_ticks,
            per_rest_tick: 1.0 / rest_ticks as f32,
            lag: D::lag(settings, Stage::Moves),
            monitor: Monitor::new(settings),
            homing_configs: [
                HomingConfig::new(axis1, settings),
                HomingConfig::new(axis4, settings),
            ],
            wake_up_ticks: wake_up_ticks::<D>(settings),
        }
    }
}

/// The torques that hold the arm at its home angles [N·m]; none where no pose has these angles, and homing fails there.
fn home_gravity(settings: &CheckedSettings) -> [f32; 2] {
    let [home1, home4] = settings.axes.each_ref().map(|axis| axis.home_angle);
    let arm = settings.arm();
    let pose = arm.geometry().forward(home1, home4, settings.assembly());
    pose.and_then(|pose| arm.gravity_torque(&pose))
        .unwrap_or_default()
}

/// The greatest position error of each joint while homing [rad]: that of `[protection]`, or what gravity may take before the
/// loop of torques holds it, if that is more. Where an arm begins its torque may be the opposite of that at home, so twice
/// as much is unknown, and the loop overshoots by half of it.
fn homing_error<D: Drives>(settings: &CheckedSettings) -> [f32; 2] {
    let allowed = settings.protection.following_error;
    if let Needs::Motion = D::NEEDS {
        return [allowed; 2];
    }
    let ([axis1, axis4], [torque1, torque4], [inertia1, inertia4]) = (
        &settings.axes,
        home_gravity(settings),
        settings.nominal_inertia(),
    );
    let most = |axis: &AxisSettings, torque, inertia| {
        let lag = D::lag(settings, Stage::Moves) + axis.encoder_latency;
        let [moving, ..] = SHARES;
        let stiffness = inertia
            * Servo::new(&settings.control, [moving; 2], lag)
                .position_loop
                .kp();
        allowed.max(3.0 * Scalar::abs(torque) / stiffness)
    };
    [
        most(axis1, torque1, inertia1),
        most(axis4, torque4, inertia4),
    ]
}

/// Ticks from switching the drives on to the first one that drives: one more than they need, because a
/// command acts from the next tick on.
pub(crate) fn wake_up_ticks<D: Drives>(settings: &CheckedSettings) -> u32 {
    (D::WAKE_UP_TIME * settings.control.tick_rate) as u32 + 1
}

/// The longer latency of both encoders, in whole ticks.
fn late_ticks(settings: &CheckedSettings) -> usize {
    let [axis1, axis4] = &settings.axes;
    let late = axis1.encoder_latency.max(axis4.encoder_latency);
    (late * settings.control.tick_rate + 0.5) as usize
}

impl Servo {
    /// The servo with these shares of the bandwidths, of the position loop and its observer, for drives with this
    /// lag [s].
    fn new(control: &ControlSettings, [share, of_observer]: [f32; 2], lag: f32) -> Self {
        let period = 1.0 / control.tick_rate;
        Self {
            observer: VelocityObserver::new(of_observer * control.observer_bandwidth, period),
            position_loop: PositionLoop::new(
                share * control.bandwidth,
                control.damping,
                lag,
                share * control.integral_rate,
                period,
            ),
            age: Age::new(lag, period),
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

    /// The law of a joint behind a belt in this stage.
    #[inline(always)]
    pub(crate) fn belt(&self) -> &BeltLaw<f32> {
        let [moving, settling, resting] = &self.belts;
        match self.stage {
            Stage::Moves | Stage::Crosses => moving,
            Stage::Settles => settling,
            Stage::Rests => resting,
        }
    }

    /// Gives the joint the servo of an arm that crosses a singularity.
    pub(crate) fn cross(&mut self) {
        self.servo = self.crossing;
        self.stage = Stage::Crosses;
    }

    #[inline(always)]
    fn new<D: Drives>(
        axis: &AxisSettings,
        belt: &BeltSettings,
        settings: &CheckedSettings,
    ) -> Self {
        let control = &settings.control;
        let counts_per_turn = axis.encoder_counts as f32 * axis.gear_ratio;
        let radians_per_count = TAU / counts_per_turn;
        let torque_per_current = axis.gear_ratio * axis.torque_constant;
        // The prediction bridges the encoder's latency, too.
        let servo = |share: f32, stage: Stage| {
            let lag = D::lag(settings, stage) + axis.encoder_latency;
            Servo::new(control, [share, share], lag)
        };
        let belt = |share: f32, stage: Stage| {
            let lag = D::lag(settings, stage);
            let lags = [lag, lag + axis.encoder_latency];
            belt.law(axis, share, lags, 1.0 / control.tick_rate)
        };
        let [moving, settling, resting] = SHARES;
        let servos = [
            servo(moving, Stage::Moves),
            servo(settling, Stage::Settles),
            servo(resting, Stage::Rests),
        ];
        let belts = [
            belt(moving, Stage::Moves),
            belt(settling, Stage::Settles),
            belt(resting, Stage::Rests),
        ];
        Self {
            servo: servos[0],
            servos,
            crossing: Servo {
                age: Age::NEWEST,
                ..Servo::new(
                    control,
                    CROSSING,
                    D::lag(settings, Stage::Crosses) + axis.encoder_latency + CROSSING_LAG,
                )
            },
            belts,
            stage: Stage::Moves,
            rest_error: REST_COUNTS * Scalar::abs(radians_per_count),
            friction: FrictionCompensation::new(
                axis.viscous_friction,
                axis.coulomb_friction,
                control.friction_smoothing,
            ),
            radians_per_count,
            homing_torque: Scalar::abs(torque_per_current) * settings.homing.current,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drives::BrushedDrives;
    use crate::settings::Settings;

    /// The model of an arm with this change of joint 4.
    fn model(change: impl FnOnce(&mut AxisSettings)) -> Model {
        let mut settings = Settings::BENCHTOP;
        change(&mut settings.axes[1]);
        Model::new::<BrushedDrives>(&settings.check().unwrap())
    }

    #[test]
    fn the_limits_of_a_reversed_gear_are_those_of_the_same_gear_forward() {
        let forward = model(|_| ());
        let reversed = model(|axis| axis.gear_ratio = -axis.gear_ratio);
        let ([_, forward4], [_, reversed4]) = (&forward.axes, &reversed.axes);
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
