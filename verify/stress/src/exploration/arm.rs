//! The arm of an exploration: its joints are where the controller wants them, so that a tick takes
//! little time. What disturbs it is chosen by the exploration.

use crate::arm::start;
use crate::orders;
use fivebar_firmware::drives::BrushedSample;
use fivebar_firmware::safety::State;
use fivebar_firmware::settings::AxisSettings;
use fivebar_firmware::{ActuatorCommand, SensorSample, Settings, Status};
use std::f64::consts::TAU;

/// Inertia of a joint that searches its switch or is excited [kg·m²].
const INERTIA: f64 = 1.5e-3;
/// Its viscous friction [N·m·s/rad].
const FRICTION: f64 = 1e-2;
/// Bus voltage [V].
const BUS: f32 = 24.0;
/// Speed at which somebody pushes a joint [rad/s].
const PUSH: f64 = 2.0;

/// The flags of sessions with an arm that crosses and has a tool that is switched.
const CROSSES: u8 = 0xc4;

/// The arm of the sessions that crosses, with a tick rate at which
/// few ticks show what there is to see. Its switches are near the start.
pub(super) fn settings() -> Settings {
    let mut settings = orders::settings(CROSSES);
    for (axis, home) in settings.axes.iter_mut().zip([2.3, 0.5]) {
        axis.home_angle = home;
    }
    (settings.homing.speed, settings.homing.back_off) = (1.0, 0.02);
    let control = &mut settings.control;
    control.tick_rate = 2_000.0;
    control.current_bandwidth = 700.0;
    control.bandwidth = 78.0;
    control.integral_rate = 19.5;
    control.observer_bandwidth = 624.0;
    settings.protection.following_error = 0.05;
    settings
}

/// What disturbs the arm until it ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Disturbance {
    /// The emergency stop is pressed.
    EmergencyStop,
    /// A bridge reports a fault.
    DriverFault,
    /// The bus voltage is too low.
    BusLow,
    /// The bus voltage is too high.
    BusHigh,
    /// A current sensor reads more than the over-current.
    OverCurrent,
    /// A current sensor's zero is wrong by 1.2 A.
    WrongZero,
    /// The counts of joint 1 stop.
    FrozenCounts,
    /// Somebody pushes joint 4.
    Push,
    /// The current sensors show the currents reversed.
    WrongTorque,
    /// The home switches read closed.
    SwitchesClosed,
    /// The home switches read open.
    SwitchesOpen,
    /// The planner does not run.
    LatePlanner,
}

impl Disturbance {
    pub(super) const ALL: [Self; 12] = [
        Self::EmergencyStop,
        Self::DriverFault,
        Self::BusLow,
        Self::BusHigh,
        Self::OverCurrent,
        Self::WrongZero,
        Self::FrozenCounts,
        Self::Push,
        Self::WrongTorque,
        Self::SwitchesClosed,
        Self::SwitchesOpen,
        Self::LatePlanner,
    ];
}

/// The joints and what disturbs them.
#[derive(Clone, Debug)]
pub(super) struct FollowingArm {
    /// θ1, θ4 [rad].
    pub(super) angle: [f64; 2],
    /// [rad/s].
    velocity: [f64; 2],
    /// [A].
    current: [f32; 2],
    /// The duties that act until the next tick.
    acting: [f32; 2],
    /// Counts that an encoder has jumped by.
    jumped: i32,
    /// Micro-steps that steppers have made.
    pub(super) made: [i32; 2],
    /// Joint 1's counts when they stopped.
    frozen: Option<i32>,
    pub(super) disturbance: Option<Disturbance>,
    /// Ticks that the controller missed before the next one.
    pub(super) missed: u32,
}

impl FollowingArm {
    pub(super) fn at_start() -> Self {
        Self {
            angle: start(CROSSES).map(f64::from),
            velocity: [0.0; 2],
            current: [0.0; 2],
            acting: [0.0; 2],
            jumped: 0,
            made: [0; 2],
            frozen: None,
            disturbance: None,
            missed: 0,
        }
    }

    /// Lets this disturbance act from now on, or none.
    pub(super) fn disturb(&mut self, disturbance: Option<Disturbance>, settings: &Settings) {
        self.disturbance = disturbance;
        let freezes = disturbance == Some(Disturbance::FrozenCounts);
        self.frozen = freezes.then(|| self.counts(settings)[0]);
    }

    /// Joint 4's counts jump by a tenth of a turn.
    pub(super) fn jump(&mut self, settings: &Settings) {
        let [_, axis] = &settings.axes;
        self.jumped += (0.1 * per_turn(axis)) as i32;
    }

    fn counts(&self, settings: &Settings) -> [i32; 2] {
        let [axis1, axis4] = &settings.axes;
        let [angle1, angle4] = self.angle;
        let counts = |angle: f64, axis| (angle / TAU * per_turn(axis)).floor() as i32;
        [counts(angle1, axis1), counts(angle4, axis4) + self.jumped]
    }

    pub(super) fn sense(&mut self, settings: &Settings) -> SensorSample {
        let is = |disturbance| self.disturbance == Some(disturbance);
        let [count1, count4] = self.counts(settings);
        let mut current = self.current;
        if is(Disturbance::WrongTorque) {
            current = current.map(|current| -current);
        }
        let [current1, _] = &mut current;
        *current1 += match self.disturbance {
            Some(Disturbance::OverCurrent) => 7.0,
            Some(Disturbance::WrongZero) => 1.2,
            _ => 0.0,
        };
        let code = |(amperes, axis): (f32, &AxisSettings)| {
            (f32::from(axis.current_zero_code) + amperes / axis.current_per_code).round() as u16
        };
        let [current1, current4] = current;
        let [axis1, axis4] = &settings.axes;
        let bus = match self.disturbance {
            Some(Disturbance::BusLow) => 0.5 * BUS,
            Some(Disturbance::BusHigh) => 1.5 * BUS,
            _ => BUS,
        };
        let home = [0, 1].map(|joint| {
            let axis = &settings.axes[joint];
            let beyond = self.angle[joint] - f64::from(axis.home_angle);
            let closed = (beyond > 0.0) == axis.home_forward;
            closed && !is(Disturbance::SwitchesOpen) || is(Disturbance::SwitchesClosed)
        });
        SensorSample {
            counts: [self.frozen.unwrap_or(count1), count4],
            drives: BrushedSample {
                current: [code((current1, axis1)), code((current4, axis4))],
                bus_voltage: (bus / settings.protection.bus_voltage_per_code) as u16,
            },
            home,
            index: [false; 2],
            emergency_stop: is(Disturbance::EmergencyStop),
            driver_fault: [false, is(Disturbance::DriverFault)],
            missed_ticks: std::mem::take(&mut self.missed),
        }
    }

    /// A tick's motion under this command.
    pub(super) fn step(&mut self, command: &ActuatorCommand, status: &Status, settings: &Settings) {
        let period = 1.0 / f64::from(settings.control.tick_rate);
        let powered = command.enable == [true; 2];
        match (status.state, status.joint_reference) {
            _ if !powered => self.velocity = [0.0; 2],
            (State::Homing | State::Exciting, _) => self.turn_freely(settings, period),
            (_, Some(joints)) => {
                self.velocity = joints.velocity.map(f64::from);
                for (angle, reference) in self.angle.iter_mut().zip(joints.angle) {
                    let away = f64::from(reference) - *angle;
                    *angle += away - TAU * (away / TAU).round();
                }
                self.turn(period);
            }
            (_, None) => {}
        }
        if self.disturbance == Some(Disturbance::Push) {
            self.angle[1] += PUSH * period;
        }
        self.drive(command, powered, settings);
    }

    /// A tick's micro-steps, each of which the joints follow.
    pub(super) fn make_steps(&mut self, steps: [i32; 2], settings: &Settings) {
        for (j, steps) in steps.into_iter().enumerate() {
            self.made[j] = self.made[j].wrapping_add(steps);
            self.angle[j] += f64::from(steps) * TAU / per_turn(&settings.axes[j]);
        }
        if self.disturbance == Some(Disturbance::Push) {
            self.angle[1] += PUSH / f64::from(settings.control.tick_rate);
        }
    }

    /// The currents that the duties drive in this tick; those of the command act in the next one.
    fn drive(&mut self, command: &ActuatorCommand, powered: bool, settings: &Settings) {
        let period = 1.0 / settings.control.tick_rate;
        let acting = std::mem::replace(&mut self.acting, command.drives.duty);
        for (joint, axis) in settings.axes.iter().enumerate() {
            let kept = (-axis.resistance * period / axis.inductance).exp();
            let back_emf = axis.gear_ratio * axis.torque_constant * self.velocity[joint] as f32;
            let through = (acting[joint] * BUS - back_emf) / axis.resistance;
            let current = &mut self.current[joint];
            *current = if powered {
                kept * *current + (1.0 - kept) * through
            } else {
                0.0
            };
        }
    }

    fn turn(&mut self, period: f64) {
        for (angle, velocity) in self.angle.iter_mut().zip(self.velocity) {
            *angle += velocity * period;
        }
    }

    /// Each joint by itself, under its motor's current.
    fn turn_freely(&mut self, settings: &Settings, period: f64) {
        for (joint, axis) in settings.axes.iter().enumerate() {
            let torque = f64::from(axis.torque_constant * axis.gear_ratio * self.current[joint]);
            let velocity = &mut self.velocity[joint];
            *velocity += (torque - FRICTION * *velocity) / INERTIA * period;
        }
        self.turn(period);
    }
}

fn per_turn(axis: &AxisSettings) -> f64 {
    f64::from(axis.encoder_counts) * f64::from(axis.gear_ratio)
}
