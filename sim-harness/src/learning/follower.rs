//! A run as the host follows it: at which place of the path the arm is, where the tool should be without the shift, and
//! what the sensors see of the error.

use super::sensors::Sensors;
use super::shift::Learnt;
use super::spline::Spline;
use super::timed_path::Shown;
use crate::simulation::{Seen, Watch};
use fivebar_firmware::Status;
use nalgebra::Vector2;
use std::collections::VecDeque;

/// Ticks around the expected place among which the true one is searched.
const AROUND: usize = 400;
/// A reference farther than this from its expected place is elsewhere [m]: at a tenth of the greatest speed, a tick or
/// two.
const OFF: f64 = 2e-6;
/// A reference at rest this near to the end of a motion is there [m].
const AT_REST: f64 = 1e-6;
/// The path begins where the reference moves within this distance of its beginning [m].
const NEAR: f64 = 1e-4;

/// What is followed.
#[derive(Clone, Debug)]
pub(super) struct Followed {
    /// Where the reference will be, tick by tick of each motion [m].
    streamed: Vec<Vec<Vector2<f64>>>,
    /// What of it is the shift [m].
    shift: Vec<Vec<Vector2<f64>>>,
}

impl Followed {
    pub(super) fn new(learnt: &Learnt) -> Self {
        let path = &learnt.path;
        let ticks = |spline: &Spline| -> Vec<Vector2<f64>> {
            let count = spline.pieces() * path.knot_ticks;
            (0..=count).map(|tick| path.at(spline, tick)).collect()
        };
        Self {
            streamed: learnt.streamed().iter().map(ticks).collect(),
            shift: learnt.shifts.iter().map(ticks).collect(),
        }
    }
}

/// What the sensors saw in a tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Tick {
    pub(super) shown: Shown,
    /// Where the tool should be less where the sensors see it [m].
    pub(super) error: Option<Vector2<f64>>,
    /// Motion and tick of the path; none before it, between motions, and without a path.
    pub(super) place: Option<(usize, usize)>,
}

/// Follows a run.
pub(super) struct Follower {
    sensors: Sensors,
    followed: Option<Followed>,
    place: Option<(usize, usize)>,
    /// Where the tool should have been in the last ticks [m], the newest first.
    wanted: VecDeque<Vector2<f64>>,
    /// An error at which the run is stopped [m].
    greatest: f64,
    pub(super) ticks: Vec<Tick>,
    /// The run was stopped.
    pub(super) stopped: bool,
}

impl Follower {
    /// Without a path, it shows the one of the run.
    pub(super) fn new(sensors: Sensors, followed: Option<Followed>, greatest: f64) -> Self {
        Self {
            sensors,
            followed,
            place: None,
            wanted: VecDeque::new(),
            greatest,
            ticks: Vec::new(),
            stopped: false,
        }
    }

    /// The place in this tick. A motion goes on by a tick in each tick; where the reference is elsewhere, because it
    /// began a little later than its first motion or is slowed, the place is searched around.
    fn find(&self, reference: Vector2<f64>, moves: bool) -> Option<(usize, usize)> {
        let streamed = &self.followed.as_ref()?.streamed;
        let Some((motion, tick)) = self.place else {
            let start = streamed.first()?.first()?;
            return (moves && (reference - start).norm() < NEAR).then_some((0, 0));
        };
        let ticks = streamed.get(motion)?;
        let distance = |ticks: &[Vector2<f64>], tick: usize| (ticks[tick] - reference).norm();
        let last = ticks.len() - 1;
        if !moves {
            let at_end = 2 * tick > last && distance(ticks, last) < AT_REST;
            return Some((motion, if at_end { last } else { tick }));
        }
        let (motion, expected) = match tick == last && motion + 1 < streamed.len() {
            true => (motion + 1, 1),
            false => (motion, (tick + 1).min(last)),
        };
        let ticks = streamed.get(motion)?;
        if distance(ticks, expected) < OFF {
            return Some((motion, expected));
        }
        let around = expected.saturating_sub(AROUND)..ticks.len().min(expected + AROUND);
        let nearest = around.min_by(|&a, &b| distance(ticks, a).total_cmp(&distance(ticks, b)));
        Some((motion, nearest.unwrap_or(expected)))
    }

    /// Where the tool was to be at the moment that this tick's sample shows [m].
    fn wanted_then(&self) -> Option<Vector2<f64>> {
        let latency = self.sensors.latency();
        let whole = latency as usize;
        let newer = self.wanted.get(whole).or(self.wanted.back())?;
        let older = self.wanted.get(whole + 1).or(self.wanted.back())?;
        Some(newer + (older - newer) * (latency - whole as f64))
    }
}

impl Watch for Follower {
    fn watch(&mut self, status: &Status) -> Seen {
        let measured = self.sensors.tool(status);
        let (Some(reference), Some(joints)) = (status.reference, status.joint_reference) else {
            return Seen::default();
        };
        let reference = reference.map(f64::from);
        let shown = Shown {
            reference,
            moves: joints.velocity != [0.0; 2],
            tag: status.tag.unwrap_or_default(),
        };
        let reference = Vector2::from(reference);
        self.place = self.find(reference, shown.moves);
        let shift = self.followed.as_ref().zip(self.place);
        let shift = shift
            .and_then(|(followed, (motion, tick))| followed.shift.get(motion)?.get(tick).copied());
        let wanted = reference - shift.unwrap_or_default();
        self.wanted.push_front(wanted);
        self.wanted.truncate(self.sensors.latency() as usize + 2);
        let error = self
            .wanted_then()
            .zip(measured)
            .map(|(wanted, tool)| wanted - tool);
        self.stopped |= error.is_some_and(|error| error.norm() > self.greatest);
        self.ticks.push(Tick {
            shown,
            error,
            place: self.place,
        });
        Seen {
            wanted: Some(wanted.into()),
            stop: self.stopped,
        }
    }
}
