//! Drives that close their own current loops, and take a torque, as those on a bus do.

use super::encoder_tracking::EncoderTracking;
use super::stiffness::{DriveStiffness, loop_lag};
use super::words::{PEAK_TORQUE, SensedWords};
use super::{
    DriveReport, Drives, Excitation, Excited, JointState, LEARNT_EVERY, Needs, Stage,
    UnpoweredPlace, tool_friction,
};
use crate::drives::Demand;
use crate::safety::Fault;
use crate::settings::{AxisSettings, CheckedSettings, HomingMethod, Settings};
use fivebar_kinematics::PlanarVector;
use fivebar_kinematics::control::{InertiaAdaptation, InertiaExcess, PositionLoop, ToolFriction};
use fivebar_kinematics::five_bar::Joint;
use nalgebra::Vector2;

/// The oldest answer of a drive that is not a fault [ticks]: an answer is one tick old when the tick takes it, and one
/// answer may be missing. The third tick after the last answer finds a silent drive, at any tick rate.
pub const OLDEST_ANSWER: u16 = 2;

/// The time that [`OLDEST_ANSWER`] may take [s], which bounds the tick rate from below. At 1 kHz both drives then give no
/// torque within 4 ms of the last answer of one.
pub const OLDEST_SAMPLE: f32 = 3e-3;

/// Time from the end of a tick until its set-points are at the drives of joint 1 and joint 4 [s], on a bus of 1 Mbit/s.
const ARRIVAL: [f32; 2] = [0.12e-3, 0.25e-3];
/// The mean of both [s], and a reserve.
const TRANSMISSION: f32 = 0.2e-3;

/// What a drive tells of itself.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum DriveHealth {
    /// It gives no torque.
    #[default]
    Off,
    /// It makes its torque.
    Drives,
    /// It has an error, and gives no torque.
    Error,
}

/// What the drives answered last.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TorqueSample {
    /// The torques that they give, at the joints [N·m].
    pub torque: [f32; 2],
    /// Ticks since each answer was sensed; the counts of its encoder are as old.
    pub age: [u16; 2],
    /// What each tells of itself.
    pub health: [DriveHealth; 2],
    /// The controller's part on the bus has met so many errors that it takes part no more.
    pub bus_off: bool,
}

/// What the drives should do until the next tick, at the joints: give a torque, and that of a spring and a damper about a
/// motion, which [`DriveStiffness`] has. Its default gives no torque.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TorqueSetPoint {
    /// τ1, τ4 [N·m].
    pub torque: [f32; 2],
    /// The angles in the middle of the time for which this acts, less those of the sample's counts [rad].
    pub ahead: [f32; 2],
    /// The velocities then [rad/s].
    pub velocity: [f32; 2],
    /// The drives make the spring and the damper. While the arm homes or its brakes are tested the torque is limited, and a
    /// step of a frame's position or velocity must not add one to it.
    pub is_stiff: bool,
    /// The drives clear the errors that they keep, because a host has cleared the fault.
    pub clear_errors: bool,
}

/// Both torque drives. They guard their own motors: heat and over-current are theirs.
///
/// The age of the counts that is usual belongs to the settings, as
/// [`encoder_latency`](crate::settings::AxisSettings::encoder_latency), and so does the lag of a drive's own current loop,
/// as that of a winding: `inductance` over `resistance`. An answer older than [`OLDEST_ANSWER`] is
/// [`Fault::DriveSilent`].
///
/// The drives count their encoders themselves. One that has fallen silent may have lost its supply and restarted, with another
/// zero, so the joints' place is then [`UnpoweredPlace::Unconfirmed`], with power and without. Drives that know their angles,
/// [`HomingMethod::Absolute`], keep it.
#[derive(Clone)]
pub struct TorqueDrives {
    /// Measured at the joints [N·m].
    torque: [f32; 2],
    set_point: TorqueSetPoint,
    /// Of the drives' own encoders.
    tracking: EncoderTracking,
    /// The inertia of the arm beyond that of its model, which stays while the arm is off.
    adaptation: InertiaAdaptation<f32>,
    inertia: InertiaExcess<f32>,
    /// From the moment of the counts to the middle of the time for which a set-point acts [s].
    until_middle: [f32; 2],
    /// What the sample shows by itself.
    fault: Option<Fault>,
    /// Whether one of them gives no torque.
    is_off: bool,
    /// A host has cleared the fault since the last tick; this tick's command says so.
    clear_ordered: bool,
    clears_errors: bool,
    /// The drives know their angles.
    is_absolute: bool,
    /// Motor current per joint torque, 1/(N k) [A/(N·m)].
    current_per_torque: [f32; 2],
    /// The log's words per joint torque [1/(N·m)].
    words_per_torque: [f32; 2],
    tool_friction: Option<ToolFriction<f32>>,
}

impl TorqueDrives {
    /// The demanded motion leads by the mean lag of both current loops, which the springs do not need, and by that of the
    /// transmission, which is each drive's own.
    fn tracking(settings: &Settings) -> EncoderTracking {
        let [lag1, lag4] = [&settings.axes[0], &settings.axes[1]].map(loop_lag);
        let ago = TRANSMISSION + 0.5 * (lag1 + lag4);
        let period = 1.0 / settings.control.tick_rate;
        EncoderTracking::new([lag1, lag4], ARRIVAL.map(|arrival| ago - arrival), period)
    }

    /// [`Drives::lag`] at this tick rate [Hz] with drives whose current loops have this lag [s].
    pub fn lag_of(tick_rate: f32, loop_lag: f32) -> f32 {
        TRANSMISSION + 0.5 / tick_rate + loop_lag
    }

    /// What holds each joint, per its inertia [1/s²]: its drive's spring and the loop of the controller.
    fn held_by(settings: &CheckedSettings) -> [f32; 2] {
        let (control, [axis1, axis4]) = (&settings.control, &settings.axes);
        let lag = Self::lag(settings, Stage::Moves);
        let of = |axis: &AxisSettings, spring: DriveStiffness, inertia: f32| {
            let lag = lag + axis.encoder_latency;
            let period = 1.0 / control.tick_rate;
            let position = PositionLoop::new(control.bandwidth, control.damping, lag, 0.0, period);
            spring.stiffness / inertia + position.kp()
        };
        let ([spring1, spring4], [inertia1, inertia4]) =
            (DriveStiffness::of(settings), settings.nominal_inertia());
        [of(axis1, spring1, inertia1), of(axis4, spring4, inertia4)]
    }

    /// The log's words of the joints' torques [N·m], the nearest ones.
    #[inline(always)]
    fn torque_words(&self, [torque1, torque4]: [f32; 2]) -> [u16; 2] {
        let [per1, per4] = self.words_per_torque;
        // `as` saturates, and cuts towards 0.
        [torque1 * per1, torque4 * per4]
            .map(|word| (word + if word < 0.0 { -0.5 } else { 0.5 }) as i16 as u16)
    }
}

impl Drives for TorqueDrives {
    type Sample = TorqueSample;
    type Command = TorqueSetPoint;

    const NEEDS: Needs = Needs::Torque;
    /// From the order to give torque until a drive does, and tells it.
    const WAKE_UP_TIME: f32 = 0.05;

    fn new(settings: &CheckedSettings) -> Self {
        let [axis1, axis4] = &settings.axes;
        Self {
            torque: [0.0; 2],
            set_point: TorqueSetPoint::default(),
            tracking: Self::tracking(settings),
            adaptation: InertiaAdaptation::new(
                Self::held_by(settings),
                1.0 / settings.control.tick_rate,
                LEARNT_EVERY,
            ),
            inertia: InertiaExcess::NONE,
            until_middle: [axis1, axis4]
                .map(|axis| axis.encoder_latency + TRANSMISSION + 0.5 / settings.control.tick_rate),
            fault: None,
            is_off: true,
            clear_ordered: false,
            clears_errors: false,
            is_absolute: settings.home_reference.method == HomingMethod::Absolute,
            current_per_torque: [axis1, axis4]
                .map(|axis| 1.0 / (axis.gear_ratio * axis.torque_constant)),
            words_per_torque: settings.peak_torque().map(|peak| PEAK_TORQUE / peak),
            tool_friction: tool_friction(settings),
        }
    }

    /// A set-point travels to its drive, acts for a tick, in its mean half a tick later, and through the drive's loop.
    fn lag(settings: &Settings, _: Stage) -> f32 {
        let [axis1, axis4] = &settings.axes;
        let [loop1, loop4] = [axis1, axis4].map(loop_lag);
        Self::lag_of(settings.control.tick_rate, 0.5 * (loop1 + loop4))
    }

    fn keep_heat(&mut self, _: &Settings, _: &Self, _: &Settings) {}

    fn select(&mut self, _: Joint, _: Stage) {}

    #[inline(always)]
    fn sense(&mut self, sample: &TorqueSample) {
        let [age1, age4] = sample.age;
        let [health1, health4] = sample.health;
        self.clears_errors = core::mem::take(&mut self.clear_ordered);
        self.torque = sample.torque;
        self.is_off = health1 != DriveHealth::Drives || health4 != DriveHealth::Drives;
        self.fault = if sample.bus_off {
            Some(Fault::BusOff)
        } else if age1 > OLDEST_ANSWER || age4 > OLDEST_ANSWER {
            Some(Fault::DriveSilent)
        } else if health1 == DriveHealth::Error || health4 == DriveHealth::Error {
            Some(Fault::DriveError)
        } else {
            None
        };
    }

    #[inline(always)]
    fn tell_counts(&self) -> bool {
        !matches!(self.fault, Some(Fault::DriveSilent | Fault::BusOff))
    }

    /// A drive that is silent, or tells an error; or the bus.
    #[inline(always)]
    fn drive_fault(&self) -> Option<Fault> {
        self.fault
    }

    fn supply_fault(&self) -> Option<Fault> {
        None
    }

    /// A drive that should give torque and tells that it gives none.
    fn contradiction(&mut self, _: [JointState; 2]) -> Option<Fault> {
        self.is_off.then_some(Fault::DriveError)
    }

    #[inline(always)]
    fn inertia_excess(&self) -> f32 {
        self.inertia.share()
    }

    #[inline(always)]
    fn follow_motion(&mut self, alpha: [f32; 2]) {
        self.adaptation.follow(&mut self.inertia, alpha);
    }

    #[inline(always)]
    fn learn_inertia(&mut self, error: [f32; 2]) {
        self.adaptation.learn(&mut self.inertia, error);
    }

    #[inline(always)]
    fn tool_friction(&self) -> Option<&ToolFriction<f32>> {
        self.tool_friction.as_ref()
    }

    #[inline(always)]
    fn drive(&mut self, demand: &Demand) -> bool {
        let (ahead, velocity) = if demand.keeps_to_motion {
            let ([omega1, omega4], [alpha1, alpha4]) =
                (demand.motion.velocity, demand.motion.acceleration);
            let [u1, u4] = Vector2::units(demand.counted);
            let [d1, d4] = demand.motion.direction.map(Vector2::from);
            let [told1, told4] = self
                .tracking
                .follow([(u1, d1, omega1, alpha1), (u4, d4, omega4, alpha4)]);
            ([told1.ahead, told4.ahead], [told1.velocity, told4.velocity])
        } else {
            self.tracking.restart();
            let ([omega1, omega4], [until1, until4]) = (demand.velocity, self.until_middle);
            // Where the joint will be, as it moves: without force.
            ([until1 * omega1, until4 * omega4], demand.velocity)
        };
        self.set_point = TorqueSetPoint {
            torque: demand.torque,
            ahead,
            velocity,
            is_stiff: demand.keeps_to_motion,
            clear_errors: false,
        };
        false
    }

    #[inline(always)]
    fn sensed_words(&self, sample: &TorqueSample) -> SensedWords {
        let [age1, age4] = sample.age.map(|age| age.min(255));
        SensedWords {
            joints: self.torque_words(sample.torque),
            both: age1 | age4 << 8,
        }
    }

    #[inline(always)]
    fn told_words(&self, command: &TorqueSetPoint) -> [u16; 2] {
        self.torque_words(command.torque)
    }

    #[inline(always)]
    fn command(&self) -> TorqueSetPoint {
        self.set_point
    }

    #[inline(always)]
    fn unpowered(&self) -> TorqueSetPoint {
        TorqueSetPoint {
            clear_errors: self.clears_errors,
            ..TorqueSetPoint::default()
        }
    }

    fn clear_errors(&mut self) {
        self.clear_ordered = true;
    }

    #[inline(always)]
    fn is_finite(&self) -> bool {
        let TorqueSetPoint {
            torque: [torque1, torque4],
            ahead: [ahead1, ahead4],
            velocity: [omega1, omega4],
            ..
        } = self.set_point;
        let joint1 = torque1.is_finite() && ahead1.is_finite() && omega1.is_finite();
        joint1 && torque4.is_finite() && ahead4.is_finite() && omega4.is_finite()
    }

    fn rest(&mut self, _: &TorqueSample) {}

    fn wake(&mut self, _: [i32; 2]) {}

    /// A controller that has left the bus hears no answer, either.
    #[inline(always)]
    fn unpowered_place(&self) -> UnpoweredPlace {
        match self.fault {
            Some(Fault::DriveSilent | Fault::BusOff) if !self.is_absolute => {
                UnpoweredPlace::Unconfirmed
            }
            _ => UnpoweredPlace::Kept,
        }
    }

    fn is_ready(&self) -> bool {
        true
    }

    #[inline(always)]
    fn release(&mut self) {
        self.set_point = TorqueSetPoint::default();
        self.inertia.rest();
    }

    fn watch_heat(&mut self, _: Joint) -> Option<Fault> {
        None
    }

    fn watch_loop(&mut self, _: Joint) -> Option<Fault> {
        None
    }

    /// The currents are those of the settings' torque constants; of duties and bus voltage nothing is known.
    fn report(&self) -> DriveReport {
        let [per1, per4] = self.current_per_torque;
        let currents = |[torque1, torque4]: [f32; 2]| [torque1 * per1, torque4 * per4];
        DriveReport {
            current: currents(self.torque),
            current_demand: currents(self.set_point.torque),
            ..DriveReport::default()
        }
    }

    fn torque(&self, [current1, current4]: [f32; 2]) -> [f32; 2] {
        let [per1, per4] = self.current_per_torque;
        [current1 / per1, current4 / per4]
    }

    /// Only the drives themselves reach their motors' windings.
    fn admits(_: &Settings, _: &Excitation) -> bool {
        false
    }

    fn excite(&mut self, _: Joint, _: Excited, _: f32, _: f32) {}
}

/// A small angle from its sine.
#[inline(always)]
pub(super) fn small_angle(sine: f32) -> f32 {
    sine + sine * sine * sine * (1.0 / 6.0)
}
