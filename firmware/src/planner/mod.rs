//! From moves to segments of path, below the tick.
//!
//! [`Planner::push`] holds a move against the whole envelope and either takes it, in which
//! case it will be followed within tolerance along its whole length, or refuses it with
//! the reason and the place. [`Planner::run`] hands the controller so much of the path as
//! it needs to be able to stop on it, and keeps the rest open to replanning.
//!
//! Both end in bounded time: a push walks its move in at most a fixed number of steps; a
//! run hands out at most [`SEGMENTS_PER_RUN`] segments, each from at most [`PLANNED_SEGMENTS`] spans. Only
//! where these would end in motion with hardly room for a stop, it goes on until there is.

mod check;
mod refusal;
mod supply;

use crate::controller::{Controller, PlanningSnapshot, QUEUED_SEGMENTS, stopping_time};
use crate::motion::Move;
use crate::safety::State;
use crate::settings::{Settings, SettingsError};
use check::CheckedMove;
use fivebar_kinematics::five_bar::{JointLimits, Side, Workspace};
use fivebar_kinematics::trajectory::{Envelope, LookaheadPlanner, MotionLimits, TorqueLimits};
use heapless::HistoryBuf;
use nalgebra::Vector2;
use rtic_core::Mutex;

pub use refusal::{LONGEST, MoveRefusal, Reason};
pub use supply::SEGMENTS_PER_RUN;

/// Spans of path that are planned together; a move takes one, and one more for a rounded
/// corner.
pub const PLANNED_SEGMENTS: usize = 32;

/// Path that the controller is given beyond what a stop needs [s].
const RESERVE: f32 = 0.03;

/// Share of the asked speed below which a move counts as slowed: rounding is not.
const SLOWED_BELOW: f32 = 0.999;

/// Slowed moves that are remembered: as many as can be on their way.
const SLOWED: usize = PLANNED_SEGMENTS + QUEUED_SEGMENTS;

/// Share of the peak torque that paths are planned with; feedback and friction have the
/// rest.
const TORQUE_SHARE: f32 = 0.8;

/// The queue of moves and its look-ahead.
pub struct Planner {
    /// What the arm may do; its working mode is the one at the end of the queue.
    envelope: Envelope<f32>,
    assembly: Side,
    lookahead: LookaheadPlanner<f32, PLANNED_SEGMENTS>,
    /// Where the queue ends; none: where the arm is held.
    end: Option<End>,
    /// The controller's path generation when the queue was begun.
    path_generation: u32,
    /// Time of path that the controller should have [s].
    horizon: f32,
    /// Tags of the latest moves that go slower than they were asked to.
    slowed: HistoryBuf<u32, SLOWED>,
}

/// An end of a move.
#[derive(Clone, Copy)]
struct End {
    /// The tool [m].
    tool: Vector2<f32>,
    /// θ1, θ4 [rad], where they are known better than by the tool.
    joints: Option<[f32; 2]>,
}

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
                tool_motion: MotionLimits {
                    speed: motion.max_speed,
                    acceleration: motion.max_acceleration,
                    jerk: motion.max_jerk,
                },
                corner_tolerance: motion.corner_tolerance,
            },
            assembly: settings.assembly(),
            lookahead: LookaheadPlanner::new(),
            end: None,
            path_generation: 0,
            slowed: HistoryBuf::new(),
            horizon: RESERVE + 0.5 * stopping_time(settings),
        })
    }

    /// Takes a move behind those taken before, or refuses it whole. The controller is
    /// locked only for its snapshot, not while the move is checked.
    ///
    /// # Errors
    /// Why and where. Nothing has changed then; `Full` passes with time.
    pub fn push(
        &mut self,
        controller: &mut impl Mutex<T = Controller>,
        order: &Move,
    ) -> Result<(), MoveRefusal> {
        let snapshot = controller.lock(|controller| controller.planning_snapshot());
        self.follow(&snapshot);
        let refuse = |reason| MoveRefusal::new(order.tag, reason);
        let start = match self.end.or_else(|| self.hold_position(&snapshot)) {
            Some(start) if accepts(snapshot.state) => start,
            _ => return Err(refuse(Reason::State(snapshot.state))),
        };
        if self.free_slots() == 0 {
            return Err(refuse(Reason::Full));
        }
        let (checked, end) = self.check_move(start, order)?;
        self.append(order.tag, &checked, start)?;
        self.end = Some(end);
        Ok(())
    }

    /// Appends a checked move to the queue.
    fn append(&mut self, tag: u32, checked: &CheckedMove, start: End) -> Result<(), MoveRefusal> {
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
        };
        appended.map_err(|error| MoveRefusal::new(tag, error.into()))?;
        if let CheckedMove::Joint { mode, .. } = checked {
            self.envelope.workspace.mode = *mode;
        }
        Ok(())
    }

    /// How many more moves are sure to find room.
    pub fn free_slots(&self) -> usize {
        self.lookahead.free_slots()
    }

    /// Whether all moves have been handed to the controller.
    pub fn is_empty(&self) -> bool {
        self.lookahead.is_empty()
    }

    /// Forgets the queue if the controller has forgotten its path, or takes none.
    fn follow(&mut self, snapshot: &PlanningSnapshot) {
        if self.path_generation != snapshot.path_generation || !accepts(snapshot.state) {
            self.path_generation = snapshot.path_generation;
            self.lookahead = LookaheadPlanner::new();
            self.end = None;
        }
        if self.end.is_none() {
            self.envelope.workspace.mode = snapshot.working_mode;
        }
    }

    /// Where the arm is held.
    fn hold_position(&self, snapshot: &PlanningSnapshot) -> Option<End> {
        let hold = snapshot.hold?;
        let tool = &self.envelope.workspace.tool;
        Some(End {
            tool: hold.tool(tool, self.assembly)?,
            joints: Some(hold.joints()),
        })
    }
}

/// Whether the arm follows paths in this state.
fn accepts(state: State) -> bool {
    match state {
        State::Armed | State::Running => true,
        State::Stopped | State::Homing | State::Stopping | State::Fault => false,
    }
}
