//! Which assembly mode an arm is in behind a singularity of type 2.
//!
//! θ1 and θ4 are the same in both modes, and so is their motion. The torques that this motion needs are not,
//! because the masses beyond the cranks move otherwise. So the planner compares, in windows of some milliseconds
//! from the singularity to the end of the plan, the torques of the measured currents with those that the arm's
//! equations need in either mode for the measured motion of the cranks.

use super::Planner;
use super::crossing::GAP;
use super::crossing_pieces::ArmOn;
use crate::controller::{ArmController, CrossingSample};
use crate::drives::Drives;
use fivebar_kinematics::Scalar;
use fivebar_kinematics::five_bar::{PoseError, Side};
use nalgebra::Vector2;
use rtic_core::Mutex;

/// The time of a window [s]: in a shorter one the counts of the encoders hide the acceleration.
const WINDOW: f32 = 6e-3;
/// The plan's mode is confirmed if it leaves less than this share of what the other leaves unexplained.
const SHARE: f32 = 0.5;

/// The evidence of a crossing so far.
#[derive(Clone, Copy)]
pub(super) struct Evidence {
    window: Option<Window>,
    /// Sums of squares of the torques that the equations do not explain, each with |sin(θ3−θ2)| as its
    /// weight [(N·m)²]: in the plan's mode, and in the other one.
    unexplained: [f32; 2],
}

/// The window in progress.
#[derive(Clone, Copy)]
struct Window {
    begin: CrossingSample,
    /// The tick of the last sample.
    last: u32,
    /// The sum of the torques over the ticks [N·m].
    torques: Vector2<f32>,
}

/// The motion of the cranks, at one time: angles [rad], speeds [rad/s] and accelerations [rad/s²].
pub(super) struct CrankMotion {
    pub(super) angle: Vector2<f32>,
    pub(super) velocity: Vector2<f32>,
    pub(super) acceleration: Vector2<f32>,
}

impl Evidence {
    pub(super) const NONE: Self = Self {
        window: None,
        unexplained: [0.0; 2],
    };

    /// Takes a sample. Where it ends a window: the motion in its middle, and its mean torques [N·m].
    fn take(&mut self, sample: &CrossingSample, rate: f32) -> Option<(CrankMotion, Vector2<f32>)> {
        let window = self.window.get_or_insert(Window {
            begin: *sample,
            last: sample.tick,
            torques: Vector2::zeros(),
        });
        let CrossingSample {
            tick,
            angle,
            velocity,
            torque,
            ..
        } = *sample;
        window.torques += torque * tick.wrapping_sub(window.last) as f32;
        window.last = tick;
        let begin = window.begin;
        let ticks = tick.wrapping_sub(begin.tick) as f32;
        let (time, torque) = (ticks / rate, window.torques / ticks);
        if time < WINDOW {
            return None;
        }
        self.window = None;
        let change = velocity - begin.velocity;
        let motion = CrankMotion {
            angle: (angle + begin.angle) * 0.5 - change * (0.125 * time),
            velocity: (velocity + begin.velocity) * 0.5,
            acceleration: change / time,
        };
        Some((motion, torque))
    }

    /// Whether it is the plan's mode that explains the torques.
    fn confirms(&self) -> bool {
        let [plan, other] = self.unexplained;
        plan < SHARE * other
    }
}

impl Planner {
    /// Of the last crossing: the sums of squares of the torques that the arm's equations do not explain
    /// [(N·m)²], in the plan's assembly mode and in the other one.
    pub fn crossing_evidence(&self) -> [f32; 2] {
        self.evidence.unexplained
    }

    /// Takes what the cranks do now as evidence, and ends a crossing that is over.
    pub(super) fn judge_crossing(
        &mut self,
        controller: &mut impl Mutex<T = ArmController<impl Drives>>,
    ) {
        let sample = controller.lock(|controller| controller.crossing_sample());
        if sample.is_behind
            && let Some((motion, torque)) = self.evidence.take(&sample, self.tick_rate)
        {
            self.weigh(&motion, torque);
        }
        if sample.is_over {
            let confirmed = self.evidence.confirms();
            controller.lock(|controller| controller.end_crossing(confirmed));
        }
    }

    /// Adds what the equations of both modes do not explain of torques [N·m].
    fn weigh(&mut self, motion: &CrankMotion, torque: Vector2<f32>) {
        let [friction1, friction4] = &self.friction;
        let [omega1, omega4] = motion.velocity.into();
        let friction = Vector2::new(friction1.torque(omega1), friction4.torque(omega4));
        let needed =
            [self.assembly, self.assembly.opposite()].map(|side| self.needed_in(side, motion));
        let [Ok((sine, plan)), Ok((_, other))] = needed else {
            return;
        };
        if sine >= GAP {
            let rests = [plan, other].map(|needed| (torque - friction - needed) * sine);
            for (sum, rest) in self.evidence.unexplained.iter_mut().zip(rests) {
                *sum += rest.norm_squared();
            }
        }
    }

    /// |sin(θ3−θ2)|, and the torques without friction that a motion of the cranks needs in an assembly mode [N·m].
    #[inline(never)]
    pub(super) fn needed_in(
        &self,
        side: Side,
        motion: &CrankMotion,
    ) -> Result<(f32, Vector2<f32>), PoseError> {
        let geometry = self.envelope.workspace.tool.geometry();
        let pose = geometry.forward(motion.angle.x, motion.angle.y, side)?;
        let velocities =
            geometry.forward_velocities(&pose, motion.velocity.x, motion.velocity.y)?;
        let [alpha1, alpha4] = motion.acceleration.into();
        let accelerations = geometry.forward_accelerations(&pose, &velocities, alpha1, alpha4)?;
        let arm = ArmOn {
            pose,
            velocities,
            accelerations,
        };
        Ok((Scalar::abs(arm.pose.sin32()), self.torque_of(&arm)?))
    }
}
