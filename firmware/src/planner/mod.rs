//! The planner: from moves to trajectory segments, below the tick.
//!
//! [`Planner::push`] checks a move against the whole envelope. It either accepts the move, which
//! is then followed within tolerance along its whole length, or refuses it with the reason and
//! the point. [`Planner::run`] hands the controller as much of the path as it needs for a stop;
//! the rest can still be replanned.
//!
//! Both take bounded time. A push checks its move in a bounded number of steps. A run hands out
//! at most [`SEGMENTS_PER_RUN`] trajectory segments, each planned over at most
//! [`PLANNED_SEGMENTS`] planned segments. It hands out more only if these would end in motion too
//! near the end of the path for a stop. While the arm moves there, it does not search for a better plan: a search over a
//! full queue takes milliseconds, in which the arm would use up the path.

mod check;
mod crossing;
mod crossing_evidence;
mod crossing_pieces;
mod error;
mod line_merging;
mod segment_feed;
mod stream;
mod timed;

use crate::controller::{
    ArmController, PlanningSnapshot, QUEUED_SEGMENTS, least_rest, stopping_time,
};
use crate::drives::Drives;
use crate::motion::{FIXTURES, Fixture, Move, MoveKind};
use crate::safety::State;
use crate::settings::{CheckedSettings, Settings, ToolOutputSettings};
use check::CheckedMove;
use crossing_evidence::Evidence;
use fivebar_kinematics::control::FrictionCompensation;
use fivebar_kinematics::five_bar::{JointLimits, Side, Tool, WorkingMode, Workspace};
use fivebar_kinematics::trajectory::{
    Envelope, LookaheadPlanner, MotionLimits, ToolOutput, TorqueLimits,
};
use heapless::HistoryBuf;
use line_merging::Waiting;
use nalgebra::Vector2;
use rtic_core::Mutex;
use stream::Stream;
use timed::ToolMotion;

pub use error::{LONGEST, MoveError, MoveErrorKind};
pub use segment_feed::SEGMENTS_PER_RUN;
pub use stream::{StreamError, StreamPhase, StreamProgress, StreamReason};

/// Planned segments in the look-ahead. A move takes one, and two more for a rounded corner.
pub const PLANNED_SEGMENTS: usize = 96;

/// Time of path that the controller gets beyond what a stop needs [s].
const RESERVE: f32 = 0.03;

/// Share of the requested speed below which a move counts as slowed; above it, the difference is
/// rounding.
const SLOWED_BELOW: f32 = 0.999;

/// Number of slowed moves that are remembered: as many as can be queued.
const SLOWED: usize = PLANNED_SEGMENTS + QUEUED_SEGMENTS;

/// The queue of moves and its look-ahead.
///
/// ```
/// use fivebar_firmware::controller::Request;
/// use fivebar_firmware::planner::MoveErrorKind;
/// use fivebar_firmware::{Controller, Move, MoveKind, Planner, Settings};
///
/// let settings = Settings::BENCHTOP.check()?;
/// let (mut controller, mut planner) = (Controller::new(&settings), Planner::new(&settings));
/// controller.request(Request::SetAngles([2.2, 0.9]))?; // rad
/// controller.request(Request::Arm)?;
///
/// let line = |to| Move { tag: 1, tool: 0, kind: MoveKind::Line { to, feed: 0.1 } }; // m, m/s
/// planner.push(&mut controller, &line([0.05, 0.19]))?;
/// // On the way to a point out of reach, leg 1 becomes too straight.
/// let refused = planner.push(&mut controller, &line([0.05, 0.50])).unwrap_err();
/// assert_eq!(refused.kind, MoveErrorKind::LegSingularity(1));
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
#[derive(Clone)]
pub struct Planner {
    /// The envelope of the arm, with the working mode at the end of the queue.
    envelope: Envelope<f32>,
    assembly: Side,
    lookahead: LookaheadPlanner<f32, PLANNED_SEGMENTS>,
    /// The latest line, not yet in the look-ahead.
    waiting: Option<Waiting>,
    /// The settings' corner tolerance [m].
    deviation: f32,
    /// What the last line in the look-ahead uses of it [m].
    used_before: f32,
    /// The end of the queue; none if it is empty and the arm is held.
    end: Option<End>,
    /// The motion at the end of the queue, if that is a timed move that ends in motion.
    in_motion: Option<ToolMotion>,
    /// The joints' friction, as fed forward.
    friction: [FrictionCompensation<f32>; 2],
    /// The joints' greatest torques [N·m].
    peak_torque: [f32; 2],
    crossing_allowed: bool,
    /// Of the crossing in progress.
    evidence: Evidence,
    /// [Hz].
    tick_rate: f32,
    /// The latest stream of set-points.
    stream: Option<Stream>,
    /// Walls and guides of the next stream with an impedance.
    fixtures: [Option<Fixture>; FIXTURES],
    /// The controller's path generation when the queue was begun.
    path_generation: u32,
    tool_output: ToolOutputSettings,
    /// The shortest rest where the tool's output changes [s].
    least_rest: f32,
    /// The tool's level at the end of the queue.
    level: u16,
    /// Time of path that the controller should have queued [s].
    horizon: f32,
    /// Tags of the latest moves that go slower than requested.
    slowed: HistoryBuf<u32, SLOWED>,
}

/// The end of a move.
#[derive(Clone, Copy)]
struct End {
    /// The tool [m].
    tool: Vector2<f32>,
    /// θ1, θ4 [rad], if they are known more exactly than from the tool.
    joints: Option<[f32; 2]>,
    /// θ1, θ4 there [rad], as far as they tell in which turn each joint is.
    turns: Option<[f32; 2]>,
}

impl Planner {
    /// A planner without an arm: a constant, of which [`Planner::reset`] makes one in its place.
    pub const NONE: Self = Self {
        envelope: Envelope {
            workspace: Workspace {
                tool: Tool::<f32>::NONE,
                mode: WorkingMode::ALL[0],
                limits: None,
                margin: 0.0,
            },
            joint_speed: [0.0; 2],
            joint_acceleration: [0.0; 2],
            torque: None,
            tool_motion: MotionLimits {
                speed: 0.0,
                acceleration: 0.0,
                jerk: 0.0,
            },
            corner_tolerance: 0.0,
        },
        assembly: Side::Left,
        lookahead: LookaheadPlanner::new(),
        waiting: None,
        deviation: 0.0,
        used_before: 0.0,
        end: None,
        in_motion: None,
        friction: [FrictionCompensation::new(0.0, 0.0, 0.0); 2],
        peak_torque: [0.0; 2],
        crossing_allowed: false,
        evidence: Evidence::NONE,
        tick_rate: 0.0,
        stream: None,
        fixtures: [None; FIXTURES],
        path_generation: 0,
        tool_output: Settings::BENCHTOP.tool_output,
        least_rest: 0.0,
        level: 0,
        horizon: 0.0,
        slowed: HistoryBuf::new(),
    };

    /// A planner for the arm of these settings.
    pub fn new(settings: &CheckedSettings) -> Self {
        let mut planner = Self::NONE;
        planner.reset(settings);
        planner
    }

    /// Becomes a planner for the arm of these settings, in its place.
    pub fn reset(&mut self, settings: &CheckedSettings) {
        let motion = &settings.motion;
        let [axis1, axis4] = &settings.axes;
        // Every field by its name: none is forgotten.
        let Self {
            envelope,
            assembly,
            lookahead,
            waiting,
            deviation,
            used_before,
            end,
            in_motion,
            friction,
            peak_torque,
            crossing_allowed,
            evidence,
            tick_rate,
            stream,
            fixtures,
            path_generation,
            tool_output,
            least_rest: least,
            level,
            horizon,
            slowed,
        } = self;
        let share = settings.advanced.motion_torque;
        *envelope = Envelope {
            workspace: Workspace {
                tool: *settings.tool(),
                mode: settings.working_mode(),
                limits: JointLimits::new(axis1.angle_limits, axis4.angle_limits).ok(),
                margin: motion.singularity_margin,
            },
            joint_speed: settings.axes.map(|axis| axis.max_speed),
            joint_acceleration: settings.axes.map(|axis| axis.max_acceleration),
            torque: Some(TorqueLimits {
                arm: *settings.arm(),
                torque: settings.peak_torque().map(|torque| share * torque),
            }),
            tool_motion: MotionLimits {
                speed: motion.max_speed,
                acceleration: motion.max_acceleration,
                jerk: motion.max_jerk,
            },
            corner_tolerance: motion.corner_tolerance,
        };
        *assembly = settings.assembly();
        lookahead.clear();
        *waiting = None;
        *deviation = motion.corner_tolerance;
        *used_before = 0.0;
        *end = None;
        *in_motion = None;
        *friction = settings.axes.map(|axis| {
            let smoothing = settings.control.friction_smoothing;
            FrictionCompensation::new(axis.viscous_friction, axis.coulomb_friction, smoothing)
        });
        *peak_torque = settings.peak_torque();
        *crossing_allowed = settings.crossing_allowed;
        *evidence = Evidence::NONE;
        *tick_rate = settings.control.tick_rate;
        *stream = None;
        *fixtures = [None; FIXTURES];
        *path_generation = 0;
        *tool_output = settings.tool_output;
        *least = least_rest(settings);
        *level = 0;
        *horizon = RESERVE + 0.5 * stopping_time(settings);
        slowed.clear();
    }

    /// Accepts a move behind those accepted before, or refuses it as a whole. The controller is
    /// locked only for its snapshot, and unlocked while the move is checked.
    ///
    /// # Errors
    /// Why the move is refused, and at which point; nothing has changed then. `Full` passes with
    /// time.
    // A call of its own: its stack is not that of the checks of settings.
    #[inline(never)]
    pub fn push(
        &mut self,
        controller: &mut impl Mutex<T = ArmController<impl Drives>>,
        next: &Move,
    ) -> Result<(), MoveError> {
        let snapshot = controller.lock(|controller| controller.planning_snapshot());
        self.follow(&snapshot);
        let refuse = |kind| MoveError::new(next.tag, kind);
        let start = match self.end.or_else(|| self.hold_position(&snapshot)) {
            Some(start) if snapshot.state.follows_paths() => start,
            _ if snapshot.state == State::Crossing => return Err(refuse(MoveErrorKind::Full)),
            _ => return Err(refuse(MoveErrorKind::State(snapshot.state))),
        };
        if self.is_streaming() {
            return Err(refuse(MoveErrorKind::Streaming));
        }
        if let MoveKind::Timed(timed) = &next.kind {
            return self.push_timed(controller, &snapshot, start, next, timed);
        }
        if self.in_motion.is_some() {
            return Err(refuse(MoveErrorKind::Discontinuous));
        }
        if let MoveKind::Crossing(plan) = &next.kind {
            return self.push_crossing(controller, &snapshot, start, next, plan);
        }
        if let Some(end) = self.join(next) {
            self.end = Some(end);
            return Ok(());
        }
        if self.free_slots() == 0 {
            return Err(refuse(MoveErrorKind::Full));
        }
        let (checked, end) = self.check_move(start, next)?;
        self.append_waiting()?;
        match Waiting::new(next, checked, start) {
            Ok(waiting) => self.waiting = Some(waiting),
            Err(checked) => {
                self.used_before = 0.0;
                self.envelope.corner_tolerance = self.deviation;
                self.append(next, &checked, start)?;
            }
        }
        self.end = Some(end);
        Ok(())
    }

    /// Appends a checked move to the queue.
    fn append(&mut self, next: &Move, checked: &CheckedMove, start: End) -> Result<(), MoveError> {
        let tag = next.tag;
        self.set_tool_level(next, checked, start)?;
        let appended = match checked {
            CheckedMove::Nowhere => Ok(()),
            CheckedMove::Path {
                segment,
                motion_limits,
                feed,
            } => {
                if motion_limits.speed < SLOWED_BELOW * feed {
                    self.slowed.write(tag);
                }
                self.lookahead
                    .push(segment, *motion_limits, tag, &self.envelope)
            }
            CheckedMove::Dwell { duration } => {
                self.lookahead.push_dwell(start.tool, *duration, tag)
            }
            CheckedMove::Joint {
                from,
                to,
                motion_limits,
                ..
            } => self.lookahead.push_joint(*from, *to, *motion_limits, tag),
            // They pass no look-ahead.
            CheckedMove::Timed | CheckedMove::Crossing => Ok(()),
        };
        appended.map_err(|error| MoveError::new(tag, error.into()))?;
        if let CheckedMove::Joint { mode, .. } = checked {
            self.envelope.workspace.mode = *mode;
        }
        Ok(())
    }

    /// Sets the tool's output for the next move. Where a servo or a switch changes, the arm rests
    /// until it has settled. Together with the rest, no move takes more room than a move with a
    /// rounded corner.
    fn set_tool_level(
        &mut self,
        next: &Move,
        checked: &CheckedMove,
        start: End,
    ) -> Result<(), MoveError> {
        let output_at = |level| {
            let speed = match checked {
                CheckedMove::Path { feed, .. } => *feed,
                CheckedMove::Joint { motion_limits, .. } => motion_limits.speed,
                CheckedMove::Nowhere
                | CheckedMove::Dwell { .. }
                | CheckedMove::Timed
                | CheckedMove::Crossing => 1.0,
            };
            self.tool_output.output(level, speed)
        };
        let output = output_at(next.tool);
        let changes = output != output_at(self.level);
        self.lookahead.set_tool_output(output);
        if changes && self.tool_output.waits() {
            self.rest_for_tool(next.tool, output, start, next.tag)?;
        }
        self.level = next.tool;
        Ok(())
    }

    /// Appends the rest in which the tool goes to `level`, with its new output.
    fn rest_for_tool(
        &mut self,
        level: u16,
        output: ToolOutput<f32>,
        start: End,
        tag: u32,
    ) -> Result<(), MoveError> {
        let time = self.tool_output.settle_time(self.level, level);
        self.lookahead.set_tool_output(output);
        self.lookahead
            .push_dwell(start.tool, time.max(self.least_rest), tag)
            .map_err(|error| MoveError::new(tag, error.into()))?;
        self.level = level;
        Ok(())
    }

    /// The envelope for timed moves: with all of the torque, because the host keeps a share for
    /// feedback.
    fn envelope_of_timed(&self) -> Envelope<f32> {
        let mut envelope = self.envelope;
        if let Some(limits) = &mut envelope.torque {
            limits.torque = self.peak_torque;
        }
        envelope
    }

    /// The number of further moves for which there is room.
    pub fn free_slots(&self) -> usize {
        let waiting = usize::from(self.waiting.is_some());
        self.lookahead.free_slots().saturating_sub(waiting)
    }

    /// Whether all moves have been handed to the controller.
    pub fn is_empty(&self) -> bool {
        self.waiting.is_none() && self.lookahead.is_empty()
    }

    /// Clears the queue if the controller has dropped its path or follows none in its state.
    fn follow(&mut self, snapshot: &PlanningSnapshot) {
        if self.path_generation != snapshot.path_generation || !snapshot.state.follows_paths() {
            self.path_generation = snapshot.path_generation;
            self.lookahead.clear();
            self.waiting = None;
            self.used_before = 0.0;
            self.end = None;
            self.in_motion = None;
            // The controller has switched the tool off.
            self.level = 0;
        }
        if self.end.is_none() {
            self.envelope.workspace.mode = snapshot.working_mode;
            self.assembly = snapshot.assembly;
        }
    }

    /// Where the arm is held.
    fn hold_position(&self, snapshot: &PlanningSnapshot) -> Option<End> {
        let hold = snapshot.hold?;
        let tool = &self.envelope.workspace.tool;
        let joints = Some(hold.joints());
        Some(End {
            tool: hold.tool(tool, self.assembly)?,
            joints,
            turns: joints,
        })
    }
}
