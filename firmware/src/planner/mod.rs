//! From moves to pieces of path, below the tick.
//!
//! [`Planner::push`] holds a move against the whole envelope and either takes it, in which
//! case it will be followed within tolerance along its whole length, or refuses it with
//! the reason and the place. [`Planner::run`] hands the controller so much of the path as
//! it needs to be able to stop on it, and keeps the rest open to replanning.
//!
//! Both end in bounded time: a push walks its move in at most a fixed number of steps; a
//! run hands out at most [`PIECES_PER_RUN`] pieces, each from at most [`SPANS`] spans. Only
//! where these would end in motion with hardly room for a stop, it goes on until there is.

mod refusal;

use crate::controller::{Controller, PIECES, Stretch, stopping_time};
use crate::motion::{Move, MoveKind};
use crate::safety::{Limits, State};
use crate::settings::{Settings, SettingsError};
use fivebar_kinematics::five_bar::{JointLimits, Side, Workspace};
use fivebar_kinematics::trajectory::{
    Caps, Envelope, LookAhead, Piece, Reference, Segment, SegmentError, Sense, TorqueLimits,
};
use fivebar_kinematics::{Scalar, Vec2};
use rtic_core::Mutex;

use heapless::HistoryBuf;
pub use refusal::{LONGEST, MoveRefusal, Reason};

/// Spans of path that are planned together; a move takes one, and one more for a rounded
/// corner.
pub const SPANS: usize = 32;

/// Pieces that one run hands out, where nothing presses.
pub const PIECES_PER_RUN: u32 = 4;

/// Path that the controller is given beyond what a stop needs [s].
const RESERVE: f32 = 0.03;

/// Share of the asked speed below which a move counts as slowed: rounding is not.
const SLOWED_BELOW: f32 = 0.999;

/// Slowed moves that are remembered: as many as can be on their way.
const SLOWED: usize = SPANS + PIECES;

/// How far an arc's centre may be off by the rounding of its file [m].
const ARC_TOLERANCE: f32 = 1e-4;

/// Share of the peak torque that paths are planned with; feedback and friction have the
/// rest.
const TORQUE_SHARE: f32 = 0.8;

/// The queue of moves and its look-ahead.
pub struct Planner {
    /// What the arm may do; its working mode is the one at the end of the queue.
    envelope: Envelope<f32>,
    assembly: Side,
    look_ahead: LookAhead<f32, SPANS>,
    /// Where the queue ends; none: where the arm is held.
    end: Option<End>,
    /// The controller's count of forgotten paths when the queue was begun.
    epoch: u32,
    /// Time of path that the controller should have [s].
    horizon: f32,
    /// Tags of the latest moves that go slower than they were asked to.
    slowed: HistoryBuf<u32, SLOWED>,
}

/// An end of a move.
#[derive(Clone, Copy)]
struct End {
    /// The tool [m].
    tool: Vec2<f32>,
    /// θ1, θ4 [rad], where they are known better than by the tool.
    joints: Option<[f32; 2]>,
}

/// A segment that keeps the envelope, and how fast it may go.
type Admitted = (Segment<f32>, Caps<f32>);

impl Planner {
    /// A planner for the arm of these settings.
    ///
    /// # Errors
    /// The first setting that is not sound.
    pub fn new(settings: &Settings) -> Result<Self, SettingsError> {
        settings.validate()?;
        let arm = settings.arm()?;
        let motion = &settings.motion;
        let [axis1, axis4] = &settings.axes;
        Ok(Self {
            envelope: Envelope {
                workspace: Workspace {
                    tool: settings.tool(&arm)?,
                    mode: settings.working_mode(),
                    limits: JointLimits::new(axis1.angle_limits, axis4.angle_limits).ok(),
                    margin: motion.singularity_margin,
                },
                joint_speed: settings.axes.map(|axis| axis.max_speed),
                joint_acceleration: settings.axes.map(|axis| axis.max_acceleration),
                torque: Some(TorqueLimits {
                    arm,
                    torque: settings.peak_torque().map(|torque| TORQUE_SHARE * torque),
                }),
                tool_motion: Caps {
                    speed: motion.max_speed,
                    acceleration: motion.max_acceleration,
                    jerk: motion.max_jerk,
                },
                corner_tolerance: motion.corner_tolerance,
            },
            assembly: settings.assembly(),
            look_ahead: LookAhead::new(),
            end: None,
            epoch: 0,
            slowed: HistoryBuf::new(),
            horizon: RESERVE + 0.5 * stopping_time(settings),
        })
    }

    /// Takes a move behind those taken before, or refuses it whole. The controller is
    /// locked only to be looked at, not while the move is checked.
    ///
    /// # Errors
    /// Why and where. Nothing has changed then; `Full` passes with time.
    pub fn push(
        &mut self,
        controller: &mut impl Mutex<T = Controller>,
        order: &Move,
    ) -> Result<(), MoveRefusal> {
        let (state, held) = controller.lock(|controller| {
            self.follow(controller);
            (controller.state(), held(controller))
        });
        let refuse = |reason| MoveRefusal::new(order.tag, reason);
        let Some(start) = self.end.or(held) else {
            return Err(refuse(Reason::State(state)));
        };
        if !accepts(state) {
            return Err(refuse(Reason::State(state)));
        }
        if self.room() == 0 {
            return Err(refuse(Reason::Full));
        }
        let end = match order.kind {
            MoveKind::Line { to, feed } => {
                let segment = Segment::line(start.tool, vec2(to));
                self.push_segment(order, segment, start, vec2(to), feed)
            }
            MoveKind::Arc {
                to,
                center,
                clockwise,
                feed,
            } => {
                let segment = arc(start.tool, to, center, clockwise);
                self.push_segment(order, segment, start, vec2(to), feed)
            }
            MoveKind::Dwell { duration } => {
                MoveRefusal::unless_in_time(order.tag, duration, 1.0)?;
                self.look_ahead
                    .push_dwell(start.tool, duration, order.tag)
                    .map(|()| start)
                    .map_err(|error| refuse(error.into()))
            }
            MoveKind::Joint { to, speed } => self.push_joint(order.tag, start, to, speed),
        }?;
        self.end = Some(end);
        Ok(())
    }

    /// Holds a move against the envelope as [`Planner::push`] would if the tool stood at
    /// `from` [m] in the working mode, without taking it. Tells where the tool is after
    /// it [m]: so a whole job is checked before anything moves.
    ///
    /// # Errors
    /// Why the move would be refused, and where.
    pub fn check(&self, from: [f32; 2], order: &Move) -> Result<[f32; 2], MoveRefusal> {
        let tool = vec2(from);
        match order.kind {
            MoveKind::Line { to, feed } => {
                self.admit(order.tag, Segment::line(tool, vec2(to)), feed)?;
                Ok(to)
            }
            MoveKind::Arc {
                to,
                center,
                clockwise,
                feed,
            } => {
                self.admit(order.tag, arc(tool, to, center, clockwise), feed)?;
                Ok(to)
            }
            MoveKind::Dwell { duration } => {
                MoveRefusal::unless_in_time(order.tag, duration, 1.0).map(|()| from)
            }
            MoveKind::Joint { to, speed } => {
                let from = self
                    .joints_at(tool)
                    .ok_or(MoveRefusal::new(order.tag, Reason::Unreachable))?;
                let (_, pose) = self
                    .envelope
                    .admit_joint_move(from, to, self.assembly, speed)
                    .map_err(|refusal| MoveRefusal::on_path(order.tag, &refusal))?;
                let end = self.envelope.workspace.tool.point(&pose);
                Ok([end.x, end.y])
            }
        }
    }

    fn push_segment(
        &mut self,
        &Move { tag, .. }: &Move,
        segment: Result<Segment<f32>, SegmentError>,
        start: End,
        to: Vec2<f32>,
        feed: f32,
    ) -> Result<End, MoveRefusal> {
        let Some((segment, caps)) = self.admit(tag, segment, feed)? else {
            return Ok(start);
        };
        if caps.speed < SLOWED_BELOW * feed {
            self.slowed.write(tag);
        }
        self.look_ahead
            .push(&segment, caps, tag, &self.envelope)
            .map_err(|error| MoveRefusal::new(tag, error.into()))?;
        // The end as ordered: the segment's own is rounded, and a full circle is told by
        // its end being its start to the bit.
        Ok(End {
            tool: to,
            joints: None,
        })
    }

    /// The segment, if it keeps the envelope; none if it goes nowhere.
    fn admit(
        &self,
        tag: u32,
        segment: Result<Segment<f32>, SegmentError>,
        feed: f32,
    ) -> Result<Option<Admitted>, MoveRefusal> {
        let segment = match segment {
            Ok(segment) => segment,
            Err(SegmentError::ZeroLength) => return Ok(None),
            Err(error) => return Err(MoveRefusal::new(tag, error.into())),
        };
        if !(feed > 0.0 && feed.is_finite()) {
            return Err(MoveRefusal::new(tag, Reason::Number));
        }
        let caps = self
            .envelope
            .admit(&segment, feed)
            .map_err(|refusal| MoveRefusal::on_path(tag, &refusal))?;
        MoveRefusal::unless_in_time(tag, segment.length(), caps.speed)?;
        Ok(Some((segment, caps)))
    }

    fn push_joint(
        &mut self,
        tag: u32,
        start: End,
        to: [f32; 2],
        share: f32,
    ) -> Result<End, MoveRefusal> {
        if !(share > 0.0 && share <= 1.0) {
            return Err(MoveRefusal::new(tag, Reason::Number));
        }
        let from = match start.joints {
            Some(joints) => joints,
            None => self
                .joints_at(start.tool)
                .ok_or(MoveRefusal::new(tag, Reason::Unreachable))?,
        };
        let (caps, pose) = self
            .envelope
            .admit_joint_move(from, to, self.assembly, share)
            .map_err(|refusal| MoveRefusal::on_path(tag, &refusal))?;
        let turn = (to[0] - from[0]).abs().max((to[1] - from[1]).abs());
        MoveRefusal::unless_in_time(tag, turn, caps.speed)?;
        self.look_ahead
            .push_joint(from, to, caps, tag)
            .map_err(|error| MoveRefusal::new(tag, error.into()))?;
        let tool = &self.envelope.workspace.tool;
        let end = End {
            tool: tool.point(&pose),
            joints: Some(to),
        };
        self.envelope.workspace.mode = tool.working_mode(&pose);
        Ok(end)
    }

    /// θ1, θ4 [rad] with the tool at a point of the workspace [m].
    fn joints_at(&self, tool: Vec2<f32>) -> Option<[f32; 2]> {
        let workspace = &self.envelope.workspace;
        let pose = workspace.tool.inverse(tool, workspace.mode).ok()?;
        let (theta1, theta4) = (pose.u1.angle(), pose.u4.angle());
        workspace.limits?.admit(theta1, theta4).ok()
    }

    /// Hands the controller as much path as it should have. To be called at least every
    /// few milliseconds while the arm moves. The controller is not locked while a piece is
    /// planned.
    pub fn run(&mut self, controller: &mut impl Mutex<T = Controller>) {
        for handed in 0..PIECES as u32 {
            let wants_path = controller.lock(|controller| {
                self.follow(controller);
                controller.wants_path(self.horizon)
                    && (handed < PIECES_PER_RUN || !controller.has_enough_path())
            });
            if !wants_path {
                break;
            }
            let Some(piece) = self.look_ahead.next_piece() else {
                break;
            };
            let slowed = self.slowed.oldest_ordered().any(|&tag| tag == piece.tag());
            let stretch = Stretch {
                piece,
                open: ends_in_motion(&piece),
                limits: Limits::NONE.with(Limits::SPEED, slowed),
            };
            controller.lock(|controller| {
                if self.epoch == controller.forgotten_paths() {
                    // There is room. Only a state that takes no path refuses, and then the
                    // queue is forgotten at the next look.
                    let _ = controller.push(stretch);
                }
            });
        }
    }

    /// How many more moves are sure to find room.
    pub fn room(&self) -> usize {
        self.look_ahead.room()
    }

    /// Whether all moves have been handed to the controller.
    pub fn is_empty(&self) -> bool {
        self.look_ahead.is_empty()
    }

    /// Forgets the queue if the controller has forgotten its path, or takes none.
    fn follow(&mut self, controller: &Controller) {
        if self.epoch != controller.forgotten_paths() || !accepts(controller.state()) {
            self.epoch = controller.forgotten_paths();
            self.look_ahead = LookAhead::new();
            self.end = None;
        }
        if self.end.is_none() {
            self.envelope.workspace.mode = controller.working_mode();
        }
    }
}

fn arc(
    from: Vec2<f32>,
    to: [f32; 2],
    center: [f32; 2],
    clockwise: bool,
) -> Result<Segment<f32>, SegmentError> {
    let sense = if clockwise {
        Sense::Clockwise
    } else {
        Sense::CounterClockwise
    };
    Segment::arc(from, vec2(to), vec2(center), sense, ARC_TOLERANCE)
}

/// Whether the arm follows paths in this state.
fn accepts(state: State) -> bool {
    match state {
        State::Armed | State::Running => true,
        State::Stopped | State::Homing | State::Stopping | State::Fault => false,
    }
}

/// Where the arm is held.
fn held(controller: &Controller) -> Option<End> {
    let (tool, joints) = controller.held()?;
    Some(End {
        tool,
        joints: Some(joints),
    })
}

/// Whether another piece must follow this one: it ends with more than a rounding's speed.
fn ends_in_motion(piece: &Piece<f32>) -> bool {
    match piece.evaluate(piece.duration()) {
        Reference::Tool { velocity, .. } => velocity.norm_squared() > 1e-6,
        Reference::Joint { rates, .. } => rates.iter().any(|&rate| Scalar::abs(rate) > 1e-2),
    }
}

fn vec2([x, y]: [f32; 2]) -> Vec2<f32> {
    Vec2::new(x, y)
}
