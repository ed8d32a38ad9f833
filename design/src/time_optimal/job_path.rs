//! The path of a job: runs from rest to rest, as the look-ahead of the controller has them, in double
//! precision.

use super::path::PathPiece;
use fivebar_kinematics::trajectory::{
    Envelope, LookaheadPlanner, PathError, PathSegment, Reference, ToolOutput, TrajectorySegment,
};

/// Capacity of the look-ahead [segments].
const PLANNED: usize = 64;
/// Speeds below this are rest [m/s].
const REST: f64 = 1e-6;

/// A part of one run.
#[derive(Clone, Debug, PartialEq)]
pub struct PathPart {
    /// A part of a shape on which the controller moves the tool.
    pub piece: PathPiece,
    /// The index of its move.
    pub source: usize,
    /// The tool's level.
    pub level: u16,
}

/// The path of a job: moves in, runs from rest to rest out.
#[derive(Debug)]
pub struct JobPath {
    lookahead: Box<LookaheadPlanner<f64, PLANNED>>,
    runs: Vec<Vec<PathPart>>,
    run: Vec<PathPart>,
    waits: bool,
    level: u16,
}

impl JobPath {
    /// An empty path of a tool at level 0. If the tool `waits`, the arm rests where its level changes.
    pub fn new(waits: bool) -> Self {
        Self {
            lookahead: Box::default(),
            runs: Vec::new(),
            run: Vec::new(),
            waits,
            level: 0,
        }
    }

    /// Appends the path of move `source`, with the tool at `level`, within the envelope.
    ///
    /// # Errors
    /// A path that leaves the workspace.
    pub fn push(
        &mut self,
        segment: &PathSegment<f64>,
        source: usize,
        level: u16,
        envelope: &Envelope<f64>,
    ) -> Result<(), PathError<f64>> {
        let limits = envelope.check(segment, envelope.tool_motion.speed)?;
        if self.waits && level != self.level {
            self.end();
        }
        self.level = level;
        while !self.lookahead.has_free_slot() {
            self.take();
        }
        let output = ToolOutput::constant(f64::from(level));
        self.lookahead.set_tool_output(output);
        // The limits are finite, and a slot is free.
        let _ = self
            .lookahead
            .push(segment, limits, source as u32, envelope);
        Ok(())
    }

    /// Takes what is planned since the last call; the motion ends at rest.
    pub fn finish(&mut self) -> Vec<Vec<PathPart>> {
        self.end();
        std::mem::take(&mut self.runs)
    }

    fn end(&mut self) {
        while self.take() {}
        self.end_run();
    }

    fn end_run(&mut self) {
        if !self.run.is_empty() {
            self.runs.push(std::mem::take(&mut self.run));
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

impl PathPart {
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
fn part(segment: &TrajectorySegment<f64>) -> Option<PathPart> {
    let curve = *segment.curve()?;
    let [from, to] = [0.0, segment.duration()].map(|t| segment.path_state(t).s);
    (to > from).then(|| PathPart {
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
