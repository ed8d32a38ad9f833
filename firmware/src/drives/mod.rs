//! What turns the two driven joints, as a plug-in of the controller.
//!
//! [`Drives`] is the contract. The controller above it measures angles, follows paths and works out the torques;
//! what is below it makes torques of them. The controller takes the drives as a type parameter, so only the code of
//! the drives in use is in an image.
//!
//! | | needs | senses | lag | place without power |
//! |---|---|---|---|---|
//! | [`BrushedDrives`]: brushed motors on H-bridges | a torque | ADC codes of currents and bus voltage | of the current loop | kept: the controller counts their encoders |
//! | [`TorqueDrives`]: drives that close their own current loops | a torque | torques, their age, errors | of transmission, a held torque, and the current loop | kept while both answer; with absolute encoders always |
//! | [`StepDrives`]: step and direction for stepper motors; pulses for hobby servos | a motion | the micro-steps that are made | one tick | lost; with encoders kept. A servo knows its angle |

mod brushed;
pub mod can;
mod encoder_tracking;
mod excitation;
mod interface;
mod load_angle;
mod resolution;
mod step;
mod step_loss;
mod stiffness;
mod torque;
pub mod words;

use crate::safety::Fault;
use crate::settings::{CheckedSettings, Settings};
pub use brushed::{BrushedCommand, BrushedDrives, BrushedSample, MOST_DUTY};
pub use excitation::{Excitation, Excited, FARTHEST_EXCITATION, LONGEST_EXCITATION, LONGEST_PULSE};
use fivebar_kinematics::control::ToolFriction;
use fivebar_kinematics::five_bar::Joint;
pub use interface::DriveInterface;
pub use resolution::Resolution;
pub use step::{BlindStepDrives, StepCommand, StepDrives, StepMotors, StepSample};
pub use stiffness::DriveStiffness;
pub use torque::{
    DriveHealth, OLDEST_ANSWER, OLDEST_SAMPLE, TorqueDrives, TorqueSample, TorqueSetPoint,
};
use words::SensedWords;

/// Ticks from one watch of a joint's drive to the next, see [`Drives::watch_heat`].
pub const WATCHED_EVERY: u32 = 16;
/// Ticks from one time at which the arm's inertia is learnt to the next.
pub const LEARNT_EVERY: u32 = WATCHED_EVERY / 2;

/// Speed over which the sign of a tool's friction is smoothed [m/s].
const SLOW_TOOL: f32 = 5e-3;

/// The friction of the tool, if the settings state one.
fn tool_friction(settings: &CheckedSettings) -> Option<ToolFriction<f32>> {
    let force = settings.advanced.pen_friction;
    (force > 0.0).then(|| ToolFriction::new(settings.tool(), force, SLOW_TOOL))
}

/// How far an arm has come to rest: each stage has gains of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// It moves.
    Moves,
    /// It has stopped, and settles.
    Settles,
    /// It rests.
    Rests,
    /// It crosses a singularity.
    Crosses,
}

/// What both joints' drives should do until the next tick.
#[derive(Clone, Copy, Debug)]
pub struct Demand {
    /// τ1, τ4 [N·m].
    pub torque: [f32; 2],
    /// Whether the arm is to keep to its motion: it is not while it homes or crosses a singularity, with limited torques,
    /// nor while a hand leads it or its brakes are tested.
    pub keeps_to_motion: bool,
    /// The joints' measured velocities [rad/s].
    pub velocity: [f32; 2],
    /// θ1, θ4 as counted at this tick's sample [rad].
    pub counted: [f32; 2],
    /// The motion that the torque is for: of drives that take a torque, only while the arm follows its path.
    pub motion: Motion,
}

/// What drives need of a [`Demand`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Needs {
    /// The torques.
    Torque,
    /// The motion, also while the arm homes.
    Motion,
}

/// What shows the place of the joints once their drives have no power.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UnpoweredPlace {
    /// The counts: the controller goes on to count the encoders, or each knows its angle.
    Kept,
    /// Nothing: a motor without an encoder is where its micro-steps have led it only as long as it has current.
    Lost,
    /// Nothing any more: a drive that counts by itself was silent, so it may have restarted with another zero.
    Unconfirmed,
}

/// The motion of both joints when the torque acts.
#[derive(Clone, Copy, Debug)]
pub struct Motion {
    /// cos θ and sin θ of the set-point of each joint.
    pub direction: [[f32; 2]; 2],
    /// ω1d, ω4d [rad/s].
    pub velocity: [f32; 2],
    /// α1d, α4d [rad/s²].
    pub acceleration: [f32; 2],
}

/// What a tick knows of a joint, for the check of its drive.
#[derive(Clone, Copy, Debug)]
pub struct JointState {
    /// The latched counts.
    pub counts: i32,
    /// ω̂ [rad/s].
    pub velocity: f32,
    /// The position error of the tick before [rad].
    pub error: f32,
}

/// What a status and the snapshot of a fault tell of both drives. What a drive does not have is 0.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C)]
pub struct DriveReport {
    /// Measured motor currents [A].
    pub current: [f32; 2],
    /// Their set-points [A].
    pub current_demand: [f32; 2],
    /// Duties in −1…1.
    pub duty: [f32; 2],
    /// Bus voltage [V].
    pub bus_voltage: f32,
}

/// The drives of both joints. Index 0 of a pair is joint 1 (at A), index 1 is joint 4 (at E).
///
/// One tick calls [`Drives::sense`] first. With power it then looks for faults, and calls [`Drives::drive`]; without
/// power it calls [`Drives::rest`]. All work is bounded and allocates nothing.
pub trait Drives: Clone + Send {
    /// What the drives sense in a tick, besides the counts of the encoders and the fault outputs, which every arm has.
    type Sample: Copy + Default + PartialEq + core::fmt::Debug + Send;
    /// What the drives do until the next tick, besides their enable. Its default is the safe state: no torque.
    type Command: Copy + Default + PartialEq + core::fmt::Debug + Send;

    /// What they need.
    const NEEDS: Needs;

    /// What the log and the last sample tell of what the drives sense.
    #[inline(always)]
    fn sensed_words(&self, _: &Self::Sample) -> SensedWords {
        SensedWords::default()
    }

    /// What the log tells of what the drive of each joint is told.
    #[inline(always)]
    fn told_words(&self, _: &Self::Command) -> [u16; 2] {
        [0; 2]
    }

    /// How long the drives take from their enable until they drive [s].
    const WAKE_UP_TIME: f32;

    /// The drives of an arm of these settings, without power.
    fn new(settings: &CheckedSettings) -> Self;

    /// The time from the end of a tick until its torque acts on a motor in this stage [s]: the set-point and the
    /// prediction of the joints lead by it.
    fn lag(settings: &Settings, stage: Stage) -> f32;

    /// Takes the motors' heat over from drives with other settings: new settings cool no motor.
    fn keep_heat(&mut self, settings: &Settings, before: &Self, old: &Settings);

    /// Gives a joint's drive the gains of this stage.
    fn select(&mut self, joint: Joint, stage: Stage);

    /// Takes over a tick's sample.
    fn sense(&mut self, sample: &Self::Sample);

    /// The counts that the joints' angles follow from, of those of a sample.
    #[inline(always)]
    fn counts(&self, counts: [i32; 2]) -> [i32; 2] {
        counts
    }

    /// Whether this tick's sample has counts: drives on a bus have told none before their first answer.
    #[inline(always)]
    fn tell_counts(&self) -> bool {
        true
    }

    /// The fault that the sample of a drive shows by itself.
    fn drive_fault(&self) -> Option<Fault>;

    /// The fault of the supply.
    fn supply_fault(&self) -> Option<Fault>;

    /// The fault that what is sensed, what was demanded and the joints' motion show together.
    fn contradiction(&mut self, joints: [JointState; 2]) -> Option<Fault>;

    /// By which share the arm's inertia is more than that of the model, as far as the drives know: accelerations are demanded
    /// as many times more.
    #[inline(always)]
    fn inertia_excess(&self) -> f32 {
        0.0
    }

    /// Takes the demanded accelerations of a tick of an arm that follows its path [rad/s²].
    #[inline(always)]
    fn follow_motion(&mut self, _: [f32; 2]) {}

    /// Learns the arm's inertia by the position errors of this tick [rad], once in [`LEARNT_EVERY`] ticks, unless its torques
    /// are limited.
    #[inline(always)]
    fn learn_inertia(&mut self, _: [f32; 2]) {}

    /// The friction of a tool that slides while it is on; none where the settings have none, and of drives that take no torque.
    #[inline(always)]
    fn tool_friction(&self) -> Option<&ToolFriction<f32>> {
        None
    }

    /// Makes the demanded torques; true if a limit of the drives clips one.
    fn drive(&mut self, demand: &Demand) -> bool;

    /// What the drives do until the next tick.
    fn command(&self) -> Self::Command;

    /// What the drives do until the next tick while they give no torque.
    #[inline(always)]
    fn unpowered(&self) -> Self::Command {
        Self::Command::default()
    }

    /// A host has cleared the fault: drives that keep errors of their own clear them in the next tick.
    fn clear_errors(&mut self) {}

    /// Whether every output is a number.
    fn is_finite(&self) -> bool;

    /// One tick without power.
    fn rest(&mut self, sample: &Self::Sample);

    /// One tick in which the drives wake up, with the latched counts.
    fn wake(&mut self, counts: [i32; 2]);

    /// What shows the joints' place from a tick without power on, as far as this tick's sample tells.
    fn unpowered_place(&self) -> UnpoweredPlace;

    /// Whether what was sensed without power allows power.
    fn is_ready(&self) -> bool;

    /// Clears the loops: the drives give no torque.
    fn release(&mut self);

    /// A motor that is too hot: once in [`WATCHED_EVERY`] ticks for each joint, with and without power.
    fn watch_heat(&mut self, joint: Joint) -> Option<Fault>;

    /// A loop that oscillates: once in [`WATCHED_EVERY`] ticks with power for each joint, the other joint's turn half of
    /// them later.
    fn watch_loop(&mut self, joint: Joint) -> Option<Fault>;

    /// What the drives measure and do.
    fn report(&self) -> DriveReport;

    /// The joints' torques [N·m] at these motor currents [A].
    fn torque(&self, current: [f32; 2]) -> [f32; 2];

    /// Whether the drives can give this excitation to an arm of these settings.
    fn admits(settings: &Settings, excitation: &Excitation) -> bool;

    /// Sets the voltage [V] or the current [A] of one motor at this joint velocity [rad/s].
    fn excite(&mut self, joint: Joint, of: Excited, value: f32, velocity: f32);
}
