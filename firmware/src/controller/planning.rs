//! The controller's interface to the planner: one snapshot of everything that planning depends
//! on, and the path that the planner appends.

use super::{ArmController, QueuedSegment};
use crate::drives::Drives;
use crate::safety::State;
use fivebar_kinematics::PlanarVector;
use fivebar_kinematics::five_bar::{Side, Tool, WorkingMode};
use nalgebra::Vector2;

/// What the planner needs to know of the controller, all at one instant.
#[derive(Clone, Copy, Debug)]
pub struct PlanningSnapshot {
    /// What the controller is doing.
    pub state: State,
    /// Goes up whenever the controller drops its path; what was planned to follow the dropped
    /// path is then out of date.
    pub path_generation: u32,
    /// The working mode that the arm is in.
    pub working_mode: WorkingMode,
    /// The assembly mode that it is in.
    pub assembly: Side,
    /// Where the arm is held; none in every other state.
    pub hold: Option<Hold>,
    /// Time of the path that was handed over and is still ahead [s].
    pub path_left: f32,
    /// The segments for which the queue has room.
    pub path_free: usize,
    /// What was handed over ends at rest, or fills the queue, or lasts some hundredths of a
    /// second longer than a stop takes.
    pub path_is_enough: bool,
}

/// A position held by both driven joints. The reader solves it, so that the controller is
/// locked only while it is copied.
#[derive(Clone, Copy, Debug)]
pub struct Hold {
    /// u(θ1d), u(θ4d): the set-point.
    direction: [Vector2<f32>; 2],
    /// θ̂1, θ̂4 [rad].
    measured: [f32; 2],
}

impl Hold {
    /// θ1d, θ4d [rad], in the turn of the measured joints.
    pub fn joints(&self) -> [f32; 2] {
        let ([d1, d4], [theta1, theta4]) = (self.direction, self.measured);
        let at = |direction: Vector2<f32>, measured: f32| {
            let u = Vector2::unit(measured);
            measured + Vector2::new(u.dot(&direction), u.cross_z(direction)).polar_angle()
        };
        [at(d1, theta1), at(d4, theta4)]
    }

    /// The tool [m] on this assembly branch; none where the links do not meet.
    pub fn tool(&self, tool: &Tool<f32>, assembly: Side) -> Option<Vector2<f32>> {
        let [d1, d4] = self.direction;
        let geometry = tool.geometry();
        let pose = geometry.forward_from_directions(d1, d4, assembly).ok()?;
        Some(tool.point(&pose))
    }
}

impl<D: Drives> ArmController<D> {
    /// Everything that planning depends on.
    pub fn planning_snapshot(&self) -> PlanningSnapshot {
        PlanningSnapshot {
            state: self.state,
            path_generation: self.path_generation,
            working_mode: self.mode,
            assembly: self.model.assembly,
            hold: (self.state == State::Armed && !self.brake.is_ending()).then(|| Hold {
                direction: self.setpoint.direction,
                measured: self.angles(),
            }),
            path_left: self.path.left(),
            path_free: self.path.free(),
            path_is_enough: self.path.is_enough(),
        }
    }

    /// Appends a segment to the path's end, or starts a path where the arm is held. The segment
    /// is dropped if it was planned to follow a path that has been dropped since, if the queue
    /// is full, or if the arm follows no path in this state; the next snapshot shows each of
    /// these.
    pub fn extend_path(&mut self, path_generation: u32, queued: &QueuedSegment) {
        let follows = self.state.follows_paths() && !self.brake.is_ending();
        if follows && path_generation == self.path_generation {
            self.path.push(queued);
        }
    }

    /// The tool [m] and θ1, θ4 [rad] where the arm is held; none in every other state.
    pub fn hold_position(&self) -> Option<(Vector2<f32>, [f32; 2])> {
        let hold = self.planning_snapshot().hold?;
        let tool = hold.tool(&self.model.tool, self.model.assembly)?;
        Some((tool, hold.joints()))
    }
}
