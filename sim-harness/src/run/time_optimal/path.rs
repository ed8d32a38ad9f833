//! The path of a job: runs from rest to rest, as the look-ahead has them.

use super::PlannedMove;
use fivebar_design::time_optimal::PathPiece;
use fivebar_kinematics::five_bar::WorkingMode;
use fivebar_kinematics::trajectory::{
    Envelope, LookaheadPlanner, MotionLimits, PathSegment, Reference, ToolOutput, TrajectorySegment,
};

/// Room of the look-ahead.
const PLANNED: usize = 64;
/// Speeds below this are rest [m/s].
const REST: f64 = 1e-6;

/// A part of one run.
pub(super) struct Part {
    pub(super) piece: PathPiece,
    /// The index of its move.
    pub(super) source: usize,
    pub(super) level: u16,
}

/// What becomes of a job: runs to plan, and moves that stay as they are.
pub(super) enum Stage {
    Run(WorkingMode, Vec<Part>),
    Move(PlannedMove),
}

/// The path of a job, from its look-ahead.
pub(super) struct Path {
    lookahead: Box<LookaheadPlanner<f64, PLANNED>>,
    pub(super) stages: Vec<Stage>,
    run: Vec<Part>,
    /// The working mode; it changes between two runs.
    pub(super) mode: WorkingMode,
    waits: bool,
    level: u16,
}

impl Path {
    pub(super) fn new(waits: bool, mode: WorkingMode) -> Self {
        Self {
            lookahead: Box::default(),
            stages: Vec::new(),
            run: Vec::new(),
            mode,
            waits,
            level: 0,
        }
    }

    pub(super) fn push(
        &mut self,
        segment: &PathSegment<f64>,
        limits: MotionLimits<f64>,
        source: usize,
        tool: u16,
        envelope: &Envelope<f64>,
    ) {
        if self.waits && tool != self.level {
            self.finish();
        }
        self.level = tool;
        while !self.lookahead.has_free_slot() {
            self.take();
        }
        let level = ToolOutput::constant(f64::from(tool));
        self.lookahead.set_tool_output(level);
        // The limits are finite, and there is room.
        let _ = self
            .lookahead
            .push(segment, limits, source as u32, envelope);
    }

    /// Takes what is planned; the motion ends at rest.
    pub(super) fn finish(&mut self) {
        while self.take() {}
        self.end_run();
    }

    fn end_run(&mut self) {
        if !self.run.is_empty() {
            let run = std::mem::take(&mut self.run);
            self.stages.push(Stage::Run(self.mode, run));
        }
    }

    /// Takes the next segment; false if there is none.
    fn take(&mut self) -> bool {
        let Some(segment) = self.lookahead.next_segment() else {
            return false;
        };
        let Some(part) = part(&segment) else {
            return true;
        };
        match self.run.last_mut() {
            Some(last) if last.continues_in(&part) => last.lengthen(&part),
            _ => self.run.push(part),
        }
        if at_rest(&segment) {
            self.end_run();
        }
        true
    }
}

impl Part {
    /// Whether another part goes on along the same curve.
    fn continues_in(&self, next: &Self) -> bool {
        match (&self.piece, &next.piece) {
            (PathPiece::Curve { curve, .. }, PathPiece::Curve { curve: other, .. }) => {
                curve == other && (self.source, self.level) == (next.source, next.level)
            }
            _ => false,
        }
    }

    fn lengthen(&mut self, next: &Self) {
        if let PathPiece::Curve { length, .. } = &mut self.piece {
            *length += next.piece.length();
        }
    }
}

/// The part of the path that a segment covers.
fn part(segment: &TrajectorySegment<f64>) -> Option<Part> {
    let curve = *segment.curve()?;
    let [from, to] = [0.0, segment.duration()].map(|t| segment.path_state(t).s);
    (to > from).then(|| Part {
        piece: PathPiece::Curve {
            curve,
            from,
            length: to - from,
        },
        source: segment.tag() as usize,
        level: segment.tool_output().at(0.0) as u16,
    })
}

fn at_rest(segment: &TrajectorySegment<f64>) -> bool {
    match segment.evaluate(segment.duration()) {
        Reference::Tool { velocity, .. } => velocity.norm() < REST,
        Reference::Joint { .. } => true,
    }
}
