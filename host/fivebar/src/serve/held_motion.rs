//! Motion for as long as a control is held.
//!
//! It is one move, as far as the arm can go that way, and a stop ends it: the page asks for the stop when the control is
//! released. A release that the page does not notice must end it, too, so the page renews the motion every 50 ms while
//! the control is held, and the server stops the arm as soon as it misses the renewals for [`LONGEST`]: the control is
//! a dead-man's switch. A renewal names the request that began the motion, so one that comes late renews no other.

use super::controller_thread::ControllerThread;
use super::requests::Refused;
use super::wire::channels::Event;
use super::wire::lease::PageId;
use super::wire::message::DrivenJoint;
use fivebar_firmware::{Move, MoveKind};
use fivebar_sim::link::LinkError;
use std::f32::consts::TAU;
use std::time::{Duration, Instant};

/// Longest time without a renewal: two of three may be lost.
pub(super) const LONGEST: Duration = Duration::from_millis(150);

/// The greatest length is halved this often: 0.1 mm of an arm of some metres remain.
const HALVINGS: u32 = 16;
/// A shorter move is none: the arm is as far as it goes [m] or [rad].
const LEAST: f32 = 2e-4;
/// The least share of the joints' greatest speed.
const LEAST_SPEED: f32 = 1e-3;

/// Who holds the control of a motion.
#[derive(Clone, Copy, Debug)]
pub(super) struct HeldBy {
    page: PageId,
    /// The number of the request that began the motion; none: nothing can renew it.
    number: Option<u64>,
    renewed: Instant,
}

impl HeldBy {
    /// The page of this event holds it, since its request with this number.
    pub(super) fn new(event: &Event, number: Option<u64>) -> Self {
        Self {
            page: event.page.id,
            number,
            renewed: renewed_at(event),
        }
    }
}

/// When the page of this event held its control. Renewals that have waited long for a server without time, such as those
/// that a lost page left behind, count for no later time than the page may have lived.
fn renewed_at(event: &Event) -> Instant {
    event.received.min(event.lived + LONGEST)
}

impl ControllerThread {
    /// The page of this event still holds the control whose motion its request with this number began.
    pub(super) fn renew_held_motion(&mut self, event: &Event, number: u64) {
        if let Some(held) = &mut self.held_by
            && (held.page, held.number) == (event.page.id, Some(number))
        {
            held.renewed = held.renewed.max(renewed_at(event));
        }
    }

    /// Stops a held motion whose page no longer renews it or is lost; returns whether there was one.
    pub(super) fn stop_held_motion(&mut self) -> Result<bool, LinkError> {
        let Some(held) = self.held_by else {
            return Ok(false);
        };
        let is_lost = self.pages.shared.lease.holder() != Some(held.page);
        if is_lost || self.session.clock.since(held.renewed) >= LONGEST {
            self.stop_on_path(held.page)?;
            return Ok(true);
        }
        if self.feeder.has_no_target() {
            // The arm has gone as far as it can.
            self.held_by = None;
        }
        Ok(false)
    }

    /// Moves the tool with this velocity [m/s] while it is held.
    pub(super) fn hold(&mut self, velocity: [f32; 2], by: HeldBy) -> Result<(), Refused> {
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
        self.go_as_far_as_possible(reach, by, kind)
    }

    /// Turns a joint with this velocity [rad/s] while it is held; the other one stays.
    pub(super) fn hold_joint(
        &mut self,
        joint: DrivenJoint,
        rate: f32,
        by: HeldBy,
    ) -> Result<(), Refused> {
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
        self.go_as_far_as_possible(TAU, by, kind)
    }

    /// Begins the longest move that the planner takes, of `kind` with at most this length [m] or [rad].
    fn go_as_far_as_possible(
        &mut self,
        most: f32,
        by: HeldBy,
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
        self.held_by = Some(by);
        Ok(())
    }
}
