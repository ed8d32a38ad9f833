//! Motion for as long as a control is held.
//!
//! It is one move, as far as the arm can go that way, and a stop ends it: the page asks for the stop when the control is
//! released. Of a page that is lost, the controller's command timeout ends it, as every motion.

use super::controller_thread::ControllerThread;
use super::message::DrivenJoint;
use super::requests::Refused;
use fivebar_firmware::{Move, MoveKind};
use std::f32::consts::TAU;

/// The greatest length is halved this often: 0.1 mm of an arm of some metres remain.
const HALVINGS: u32 = 16;
/// A shorter move is none: the arm is as far as it goes [m] or [rad].
const LEAST: f32 = 2e-4;
/// The least share of the joints' greatest speed.
const LEAST_SPEED: f32 = 1e-3;

impl ControllerThread {
    /// Moves the tool with this velocity [m/s] until a stop.
    pub(super) fn hold(&mut self, velocity: [f32; 2]) -> Result<(), Refused> {
        let [x, y] = self.end_of_tool()?;
        let speed = velocity[0].hypot(velocity[1]);
        if !(speed.is_finite() && speed > 0.0) {
            return Err("The speed is no number above 0.".into());
        }
        let along = velocity.map(|part| part / speed);
        let feed = speed.min(self.session.settings.motion.max_speed);
        let kind = |distance: f32| {
            let to = [x + distance * along[0], y + distance * along[1]];
            MoveKind::Line { to, feed }
        };
        let reach = self.session.settings.lengths.iter().sum();
        self.go_as_far_as_possible(reach, kind)
    }

    /// Turns a joint with this velocity [rad/s] until a stop; the other one stays.
    pub(super) fn hold_joint(&mut self, joint: DrivenJoint, rate: f32) -> Result<(), Refused> {
        let angles = self.end_of_joints()?;
        let index = match joint {
            DrivenJoint::Theta1 => 0,
            DrivenJoint::Theta4 => 1,
        };
        let fastest = self.session.settings.axes[index].max_speed;
        if !(rate.is_finite() && rate != 0.0) {
            return Err("The speed is no number but 0.".into());
        }
        let speed = (rate.abs() / fastest).clamp(LEAST_SPEED, 1.0);
        let kind = |distance: f32| {
            let mut to = angles;
            to[index] += distance * rate.signum();
            MoveKind::Joint { to, speed }
        };
        self.go_as_far_as_possible(TAU, kind)
    }

    /// Begins the longest move that the planner takes, of `kind` with at most this length [m] or [rad].
    fn go_as_far_as_possible(
        &mut self,
        most: f32,
        kind: impl Fn(f32) -> MoveKind,
    ) -> Result<(), Refused> {
        let from = self.end_of_tool()?;
        let planner = self
            .preview
            .planner(self.preview.start(&self.session.status));
        let planner = planner.map_err(|error| error.to_string())?;
        let (tag, tool) = (0, 0);
        let [mut low, mut high] = [0.0, most];
        for _ in 0..HALVINGS {
            let distance = 0.5 * (low + high);
            let kind = kind(distance);
            match planner.check(from, &Move { tag, tool, kind }) {
                Ok(_) => low = distance,
                Err(_) => high = distance,
            }
        }
        if low < LEAST {
            return Err("The arm is as far that way as it can go.".into());
        }
        self.feeder.set_target(kind(low));
        Ok(())
    }
}
