//! Drives that close their own current loops, and take a torque: an ideal one, as what a drive on a bus is measured
//! with.

use super::{DriveReport, Drives, Excitation, Excited, JointState, Needs, Stage};
use crate::drives::Demand;
use crate::safety::Fault;
use crate::settings::{CheckedSettings, ControlSettings, Settings};
use fivebar_kinematics::five_bar::Joint;

/// The oldest answer of a drive that is not a fault [ticks].
pub const OLDEST_SAMPLE: u16 = 30;

/// What the drives answered last.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TorqueSample {
    /// The torques that they give, at the joints [N·m].
    pub torque: [f32; 2],
    /// Ticks since each answer was sensed; the counts of its encoder are as old.
    pub age: [u16; 2],
}

/// The torques that the drives should give until the next tick, at the joints [N·m].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TorqueSetPoint {
    /// τ1, τ4.
    pub torque: [f32; 2],
}

/// Both torque drives. They guard their own motors: heat and over-current are theirs.
///
/// The age of the counts that is usual belongs to the settings, as
/// [`encoder_latency`](crate::settings::AxisSettings::encoder_latency); an answer older than [`OLDEST_SAMPLE`] is
/// [`Fault::DriverFault`].
#[derive(Clone)]
pub struct TorqueDrives {
    /// Measured at the joints [N·m].
    torque: [f32; 2],
    /// [N·m].
    set_point: [f32; 2],
    is_old: bool,
    /// Motor current per joint torque, 1/(N k) [A/(N·m)].
    current_per_torque: [f32; 2],
}

impl Drives for TorqueDrives {
    type Sample = TorqueSample;
    type Command = TorqueSetPoint;

    const NEEDS: Needs = Needs::Torque;
    /// They drive at once.
    const WAKE_UP_TIME: f32 = 0.0;

    fn new(settings: &CheckedSettings) -> Self {
        let [axis1, axis4] = &settings.axes;
        Self {
            torque: [0.0; 2],
            set_point: [0.0; 2],
            is_old: false,
            current_per_torque: [axis1, axis4]
                .map(|axis| 1.0 / (axis.gear_ratio * axis.torque_constant)),
        }
    }

    /// A set-point acts from the next tick on.
    fn lag(control: &ControlSettings, _: Stage) -> f32 {
        1.0 / control.tick_rate
    }

    fn keep_heat(&mut self, _: &Settings, _: &Self, _: &Settings) {}

    fn select(&mut self, _: Joint, _: Stage) {}

    #[inline(always)]
    fn sense(&mut self, sample: &TorqueSample) {
        let [age1, age4] = sample.age;
        self.torque = sample.torque;
        self.is_old = age1 > OLDEST_SAMPLE || age4 > OLDEST_SAMPLE;
    }

    /// A drive that is silent.
    #[inline(always)]
    fn drive_fault(&self) -> Option<Fault> {
        self.is_old.then_some(Fault::DriverFault)
    }

    fn supply_fault(&self) -> Option<Fault> {
        None
    }

    fn contradiction(&mut self, _: [JointState; 2]) -> Option<Fault> {
        None
    }

    #[inline(always)]
    fn drive(&mut self, demand: &Demand) -> bool {
        self.set_point = demand.torque;
        false
    }

    #[inline(always)]
    fn command(&self) -> TorqueSetPoint {
        TorqueSetPoint {
            torque: self.set_point,
        }
    }

    #[inline(always)]
    fn is_finite(&self) -> bool {
        let [torque1, torque4] = self.set_point;
        torque1.is_finite() && torque4.is_finite()
    }

    fn rest(&mut self, _: &TorqueSample) {}

    fn wake(&mut self) {}

    fn is_ready(&self) -> bool {
        true
    }

    #[inline(always)]
    fn release(&mut self) {
        self.set_point = [0.0; 2];
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
            current_demand: currents(self.set_point),
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
