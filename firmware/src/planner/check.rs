//! The check of a whole move against the envelope, before the move is accepted.

use super::{End, MoveError, MoveErrorKind, Planner};
use crate::motion::{ARC_TOLERANCE, Move, MoveKind};
use core::f32::consts::TAU;
use fivebar_kinematics::PlanarVector;
use fivebar_kinematics::five_bar::{Side, WorkingMode, Workspace};
use fivebar_kinematics::trajectory::{
    MotionLimits, PathSegment, PathSegmentError, Sense, ToolOutput,
};
use nalgebra::Vector2;

/// A move that keeps the envelope along its whole length.
#[derive(Clone)]
pub(super) enum CheckedMove {
    /// The tool along a line or an arc.
    Path {
        segment: PathSegment<f32>,
        /// How fast it may go.
        motion_limits: MotionLimits<f32>,
        /// The requested speed [m/s].
        feed: f32,
    },
    /// A line of length zero.
    Nowhere,
    /// A dwell.
    Dwell {
        /// [s].
        duration: f32,
    },
    /// A joint move.
    Joint {
        /// θ1, θ4 [rad].
        from: [f32; 2],
        /// θ1, θ4 [rad].
        to: [f32; 2],
        /// How fast it may go.
        motion_limits: MotionLimits<f32>,
        /// The working mode at its end.
        mode: WorkingMode,
    },
    /// A timed move.
    Timed,
    /// A crossing.
    Crossing,
}

impl CheckedMove {
    /// Whether its numbers are those of a motion. A queue that refused it later would have taken the
    /// change of the tool before it.
    fn is_valid(&self) -> bool {
        match self {
            Self::Nowhere | Self::Timed | Self::Crossing => true,
            Self::Dwell { duration } => *duration >= 0.0 && duration.is_finite(),
            Self::Path { motion_limits, .. } | Self::Joint { motion_limits, .. } => {
                motion_limits.are_valid()
            }
        }
    }
}

impl Planner {
    /// Checks a move as [`Planner::push`] would with the tool at `from` [m] in the working mode,
    /// without accepting it. Returns the tool's position after it [m]. A whole job can be
    /// checked in this way before anything moves.
    ///
    /// # Errors
    /// Why the move would be refused, and at which point.
    pub fn check(&self, from: [f32; 2], next: &Move) -> Result<[f32; 2], MoveError> {
        let start = End {
            tool: vec2(from),
            joints: None,
            turns: None,
        };
        let (_, end) = self.check_move(start, next)?;
        Ok([end.tool.x, end.tool.y])
    }

    /// Checks moves one behind the other, as [`Planner::check`] does with the first. Joint moves may
    /// change the working mode, crossings the assembly mode; those behind them are checked in the new one.
    ///
    /// # Errors
    /// Why the first move that would be refused is refused, and at which point.
    pub fn check_all<'a>(
        &mut self,
        from: [f32; 2],
        moves: impl IntoIterator<Item = &'a Move>,
    ) -> Result<(), MoveError> {
        self.check_all_from(from, None, moves)
    }

    /// As [`Planner::check_all`], from the joint angles θ1, θ4 [rad] on: where the joint limits are wider than a turn, they tell
    /// in which turn each joint begins. Without them it is the first that the limits allow.
    ///
    /// # Errors
    /// As [`Planner::check_all`].
    pub fn check_all_from<'a>(
        &mut self,
        from: [f32; 2],
        joints: Option<[f32; 2]>,
        moves: impl IntoIterator<Item = &'a Move>,
    ) -> Result<(), MoveError> {
        let (mode, assembly) = (self.envelope.workspace.mode, self.assembly);
        let mut start = End {
            tool: vec2(from),
            joints: None,
            turns: joints,
        };
        let checked = moves.into_iter().try_for_each(|next| {
            let (checked, end) = self.check_move(start, next)?;
            match checked {
                CheckedMove::Joint { mode, .. } => self.envelope.workspace.mode = mode,
                CheckedMove::Crossing => self.assembly = self.assembly.opposite(),
                _ => {}
            }
            start = end;
            Ok(())
        });
        (self.envelope.workspace.mode, self.assembly) = (mode, assembly);
        checked
    }

    /// Checks a straight move of the joints from θ1, θ4 [rad] on, without accepting it.
    ///
    /// # Errors
    /// Why it would be refused, and at which point.
    pub fn check_joints(&self, from: [f32; 2], to: [f32; 2], speed: f32) -> Result<(), MoveError> {
        let start = End {
            tool: Vector2::zeros(),
            joints: Some(from),
            turns: Some(from),
        };
        self.check_joint_move(0, start, to, speed).map(|_| ())
    }

    /// The arm and its limits, in the working mode at the end of the queue.
    pub fn workspace(&self) -> &Workspace<f32> {
        &self.envelope.workspace
    }

    /// The assembly mode.
    pub fn assembly(&self) -> Side {
        self.assembly
    }

    /// The same planner of an arm in another working mode.
    #[must_use]
    pub fn in_mode(mut self, mode: WorkingMode) -> Self {
        self.envelope.workspace.mode = mode;
        self
    }

    /// The same planner of an arm in this assembly mode.
    #[must_use]
    pub fn in_assembly(mut self, assembly: Side) -> Self {
        self.assembly = assembly;
        self
    }

    /// The move, if it keeps the envelope from `start` on, and its end. The queue takes it then, if it
    /// has room.
    pub(super) fn check_move(
        &self,
        start: End,
        next: &Move,
    ) -> Result<(CheckedMove, End), MoveError> {
        let tag = next.tag;
        let (checked, end) = match next.kind {
            MoveKind::Line { to, feed } => {
                let segment = PathSegment::line(start.tool, vec2(to));
                self.check_path(tag, segment, start, to, feed)
            }
            MoveKind::Arc {
                to,
                center,
                clockwise,
                feed,
            } => {
                let segment = arc(start.tool, to, center, clockwise);
                self.check_path(tag, segment, start, to, feed)
            }
            MoveKind::Dwell { duration } => {
                MoveError::unless_in_time(tag, duration, 1.0)?;
                Ok((CheckedMove::Dwell { duration }, start))
            }
            MoveKind::Joint { to, speed } => self.check_joint_move(tag, start, to, speed),
            MoveKind::Timed(timed) => {
                let output = ToolOutput::constant(0.0);
                let (_, [tool, ..], turns) = self.check_timed(tag, &timed, output, start.turns)?;
                let joints = None;
                Ok((
                    CheckedMove::Timed,
                    End {
                        tool,
                        joints,
                        turns,
                    },
                ))
            }
            MoveKind::Crossing(plan) => {
                self.check_crossing(tag, start.tool, &plan)?;
                let tool = vec2(plan.to);
                let end = End {
                    tool,
                    joints: None,
                    turns: None,
                };
                Ok((CheckedMove::Crossing, end))
            }
        }?;
        if checked.is_valid() {
            Ok((checked, end))
        } else {
            Err(MoveError::new(tag, MoveErrorKind::Number))
        }
    }

    fn check_path(
        &self,
        tag: u32,
        segment: Result<PathSegment<f32>, PathSegmentError>,
        start: End,
        to: [f32; 2],
        feed: f32,
    ) -> Result<(CheckedMove, End), MoveError> {
        let segment = match segment {
            Ok(segment) => segment,
            Err(PathSegmentError::ZeroLength) => return Ok((CheckedMove::Nowhere, start)),
            Err(error) => return Err(MoveError::new(tag, error.into())),
        };
        if !(feed > 0.0 && feed.is_finite()) {
            return Err(MoveError::new(tag, MoveErrorKind::Number));
        }
        let (motion_limits, turns) = self
            .envelope
            .check_from(&segment, feed, start.turns)
            .map_err(|error| MoveError::on_path(tag, &error))?;
        MoveError::unless_in_time(tag, segment.length(), motion_limits.speed)?;
        // The end as requested: the segment's own end is rounded, and a full circle is
        // recognised by an end with the same bits as its start.
        let end = End {
            tool: vec2(to),
            joints: None,
            turns,
        };
        let checked = CheckedMove::Path {
            segment,
            motion_limits,
            feed,
        };
        Ok((checked, end))
    }

    fn check_joint_move(
        &self,
        tag: u32,
        start: End,
        to: [f32; 2],
        share: f32,
    ) -> Result<(CheckedMove, End), MoveError> {
        if !(share > 0.0 && share <= 1.0) {
            return Err(MoveError::new(tag, MoveErrorKind::Number));
        }
        let from = match start.joints {
            Some(joints) => joints,
            None => self
                .joints_at(&start)
                .ok_or(MoveError::new(tag, MoveErrorKind::Unreachable))?,
        };
        let (motion_limits, pose) = self
            .envelope
            .check_joint_move(from, to, self.assembly, share)
            .map_err(|error| MoveError::on_path(tag, &error))?;
        let turn = (to[0] - from[0]).abs().max((to[1] - from[1]).abs());
        MoveError::unless_in_time(tag, turn, motion_limits.speed)?;
        let tool = &self.envelope.workspace.tool;
        let end = End {
            tool: tool.point(&pose),
            joints: Some(to),
            turns: Some(to),
        };
        let mode = tool.working_mode(&pose);
        let checked = CheckedMove::Joint {
            from,
            to,
            motion_limits,
            mode,
        };
        Ok((checked, end))
    }

    /// θ1, θ4 [rad] with the tool at a point of the workspace [m].
    fn joints_at(&self, end: &End) -> Option<[f32; 2]> {
        let workspace = &self.envelope.workspace;
        let pose = workspace.tool.inverse(end.tool, workspace.mode).ok()?;
        let [theta1, theta4] = [pose.u1.polar_angle(), pose.u4.polar_angle()];
        match end.turns {
            Some([near1, near4]) => Some([near(theta1, near1), near(theta4, near4)]),
            None => workspace.limits?.angles_within(theta1, theta4).ok(),
        }
    }
}

/// An angle in the turn in which it is nearest to another [rad].
pub(super) fn near(angle: f32, other: f32) -> f32 {
    let turns = (other - angle) * (1.0 / TAU);
    // `as` cuts.
    let whole = (turns + if turns < 0.0 { -0.5 } else { 0.5 }) as i32;
    angle + TAU * whole as f32
}

fn arc(
    from: Vector2<f32>,
    to: [f32; 2],
    center: [f32; 2],
    clockwise: bool,
) -> Result<PathSegment<f32>, PathSegmentError> {
    let sense = if clockwise {
        Sense::Clockwise
    } else {
        Sense::CounterClockwise
    };
    PathSegment::arc(from, vec2(to), vec2(center), sense, ARC_TOLERANCE)
}

fn vec2([x, y]: [f32; 2]) -> Vector2<f32> {
    Vector2::new(x, y)
}
