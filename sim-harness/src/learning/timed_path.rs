//! The path of a job: where the tool should be at each time, in motions from rest to rest, and the same with a shift
//! as moves whose time law the host gives.
//!
//! The path is that of the controller's own plan, as the first run shows it. The moves keep its times, so that a place
//! on the path is the same place in every run.

use super::spline::{LEAST, Spline};
use super::{KNOT, LearningError};
use fivebar_files::robot::Robot;
use fivebar_firmware::settings::ToolOutputSettings;
use fivebar_firmware::{Move, MoveKind, TimedCurve, TimedMove};
use nalgebra::Vector2;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::ops::Range;

/// A rest that parts two motions lasts longer [s]. At a shorter one, such as a corner, a motion goes on.
const REST: f64 = 0.02;
/// A tool that is slower than this may be taken for one at rest [m/s].
const SLOW: f64 = 1.2e-3;
/// An acceleration that one at rest does not have [m/s²].
const STEADY: f64 = 0.5;

/// What a run shows of the reference in one tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Shown {
    /// Where the tool should be [m].
    pub(super) reference: [f64; 2],
    /// Whether the reference moves.
    pub(super) moves: bool,
    /// Tag of the move.
    pub(super) tag: u32,
}

/// The move that a motion follows from a tick on.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Mark {
    /// Ticks since the beginning of the motion.
    tick: usize,
    tag: u32,
    /// Level of the tool.
    tool: u16,
}

/// A motion from rest to rest.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Motion {
    /// Rest before it [s].
    pub(super) rest: f64,
    /// Where the tool should be.
    pub(super) wanted: Spline,
    pub(super) marks: Vec<Mark>,
}

/// The path of a job.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct TimedPath {
    /// Moves of the joints before the first motion.
    pub(super) lead: Vec<Move>,
    pub(super) motions: Vec<Motion>,
    /// Ticks between two knots.
    pub(super) knot_ticks: usize,
    /// Period of the tick [s].
    period: f64,
    /// Greatest speed on the path to the first motion [m/s].
    approach: f32,
    tool_output: ToolOutputSettings,
}

impl TimedPath {
    /// The path that a run of these moves has shown, tick by tick from its beginning, with the ticks of each
    /// motion among those: the first is the last one at rest.
    ///
    /// # Errors
    /// What of the job is not learnt.
    pub(super) fn shown(
        shown: &[Shown],
        moves: &[Move],
        robot: &Robot,
    ) -> Result<(Self, Vec<Range<usize>>), LearningError> {
        let lead = lead(moves)?;
        let levels = levels(moves)?;
        if let ToolOutputSettings::Power {
            scale_with_speed: true,
            ..
        } = robot.tool_output
        {
            return Err(LearningError::PowerBySpeed);
        }
        let period = 1.0 / robot.control.tick_rate;
        let knot_ticks = (KNOT / period).round().max(1.0) as usize;
        let leads = |tag: u32| lead.iter().any(|next| next.tag == tag);
        let begun = (shown.iter())
            .position(|tick| lead.is_empty() || !(leads(tick.tag) || tick.tag == 0))
            .unwrap_or(shown.len());
        let ranges = ranges(shown, begun, (REST / period) as usize);
        if ranges.is_empty() {
            return Err(LearningError::NoMotion);
        }
        let mut end = None;
        let motion = |range: &Range<usize>| {
            let ticks = &shown[range.clone()];
            let last = ticks.len() - 1;
            let pieces = last.div_ceil(knot_ticks).max(LEAST);
            let knot = |k: usize| Vector2::from(ticks[(k * knot_ticks).min(last)].reference);
            let mut marks: Vec<Mark> = Vec::new();
            for (tick, now) in ticks.iter().enumerate().skip(1) {
                if marks.last().is_none_or(|mark| mark.tag != now.tag) {
                    marks.push(Mark {
                        tick: if marks.is_empty() { 0 } else { tick },
                        tag: now.tag,
                        tool: levels.get(&now.tag).copied().unwrap_or(0),
                    });
                }
            }
            let before = end.replace(range.start + pieces * knot_ticks);
            let before = before.unwrap_or(range.start);
            Motion {
                rest: range.start.saturating_sub(before) as f64 * period,
                wanted: Spline::through((0..=pieces).map(knot).collect()),
                marks,
            }
        };
        let motions = ranges.iter().map(motion).collect();
        Ok((Self::new(robot, lead, motions, knot_ticks), ranges))
    }

    pub(super) fn new(
        robot: &Robot,
        lead: Vec<Move>,
        motions: Vec<Motion>,
        knot_ticks: usize,
    ) -> Self {
        Self {
            lead,
            motions,
            knot_ticks,
            period: 1.0 / robot.control.tick_rate,
            approach: robot.motion.max_speed as f32,
            tool_output: robot.tool_output,
        }
    }

    /// Period of the tick [s].
    pub(super) fn period(&self) -> f64 {
        self.period
    }

    /// Where the tool should be at a tick of a motion [m].
    pub(super) fn at(&self, spline: &Spline, tick: usize) -> Vector2<f64> {
        spline.at(tick as f64 / self.knot_ticks as f64)
    }

    /// The knots' distances along the path, from its beginning [m].
    pub(super) fn places(&self) -> Vec<Vec<f64>> {
        let mut place = 0.0;
        let mut last: Option<Vector2<f64>> = None;
        let mut of = |knot: &Vector2<f64>| {
            place += last.replace(*knot).map_or(0.0, |last| (knot - last).norm());
            place
        };
        let motions = self.motions.iter();
        motions
            .map(|motion| motion.wanted.knots().iter().map(&mut of).collect())
            .collect()
    }

    /// The moves that lead the tool along these splines, each that of a motion.
    pub(super) fn moves(&self, splines: &[Spline]) -> Vec<Move> {
        let mut moves = self.lead.clone();
        let single = |v: Vector2<f64>| [v.x as f32, v.y as f32];
        // An arm is never held quite where the first motion begins.
        let start = splines.first().and_then(|spline| spline.knots().first());
        moves.extend(start.map(|&start| Move {
            tag: 0,
            tool: 0,
            kind: MoveKind::Line {
                to: single(start),
                feed: self.approach,
            },
        }));
        let mut level = 0;
        for (motion, spline) in self.motions.iter().zip(splines) {
            let Some(first) = motion.marks.first() else {
                continue;
            };
            // The controller itself waits for a tool that changes its level.
            let waits = match first.tool != level && self.tool_output.waits() {
                true => f64::from(self.tool_output.settle_time(level, first.tool)),
                false => 0.0,
            };
            let duration = (motion.rest - waits) as f32;
            if duration > 0.0 {
                moves.push(Move {
                    tag: first.tag,
                    tool: level,
                    kind: MoveKind::Dwell { duration },
                });
            }
            self.pieces(motion, spline, &mut moves);
            level = motion.marks.last().map_or(level, |mark| mark.tool);
        }
        moves
    }

    /// The timed moves of one motion: pieces between knots, cut where the tool's level changes.
    fn pieces(&self, motion: &Motion, spline: &Spline, moves: &mut Vec<Move>) {
        let knot_time = self.knot_ticks as f64 * self.period;
        // s rises evenly with time, faster than the tool.
        let speed = 2.0 * self.fastest(spline);
        // The controller takes a piece that ends slowly as one that ends at rest.
        let turns = |velocity: Vector2<f64>, acceleration: Vector2<f64>| {
            velocity.norm() < SLOW * knot_time
                && acceleration.norm() > STEADY * knot_time * knot_time
        };
        for span in spline.spans(turns) {
            let ticks = (span.knots * self.knot_ticks) as f64;
            let begin = span.begin * self.knot_ticks;
            let mut cuts = vec![0.0];
            for pair in motion.marks.windows(2) {
                let [before, mark] = [pair[0], pair[1]];
                let inside = mark.tick > begin && ((mark.tick - begin) as f64) < ticks;
                if before.tool == mark.tool || !inside {
                    continue;
                }
                let turns_at = |cut: &f64| {
                    let [velocity, acceleration] = span.motion(*cut);
                    turns(velocity, acceleration)
                };
                let from = mark.tick - begin;
                let cut = (from..ticks as usize).map(|tick| tick as f64 / ticks);
                cuts.extend(cut.into_iter().find(|cut| !turns_at(cut)));
            }
            cuts.push(1.0);
            for pair in cuts.windows(2) {
                let [from, to] = [pair[0], pair[1]];
                let duration = (to - from) * ticks * self.period;
                let at = begin as f64 + from * ticks + 0.5;
                let mark = motion
                    .marks
                    .iter()
                    .rev()
                    .find(|mark| mark.tick as f64 <= at);
                let coefficients = span.part(from, to);
                moves.push(Move {
                    tag: mark.map_or(0, |mark| mark.tag),
                    tool: mark.map_or(0, |mark| mark.tool),
                    kind: MoveKind::Timed(TimedMove {
                        curve: TimedCurve::Blend {
                            coefficients: coefficients.map(|c| [c.x as f32, c.y as f32]),
                            inverse_length: (1.0 / (speed * duration)) as f32,
                        },
                        law: [0.0, speed as f32, 0.0, 0.0],
                        duration: duration as f32,
                    }),
                });
            }
        }
    }

    /// The greatest speed along a spline, at knots and between them, and some more where it hardly moves [m/s].
    fn fastest(&self, spline: &Spline) -> f64 {
        let time = self.knot_ticks as f64 * self.period;
        let steps = spline
            .knots()
            .windows(2)
            .map(|knots| (knots[1] - knots[0]).norm());
        1e-3 + steps.fold(0.0, f64::max) / time
    }
}

/// The moves of the joints with which a job begins, if others follow as lines and arcs only.
fn lead(moves: &[Move]) -> Result<Vec<Move>, LearningError> {
    let is_lead = |next: &Move| matches!(next.kind, MoveKind::Joint { .. });
    let first = moves
        .iter()
        .take_while(|next| is_lead(next) || matches!(next.kind, MoveKind::Dwell { .. }));
    let count = match first.clone().any(is_lead) {
        true => first.count(),
        false => 0,
    };
    let (lead, rest) = moves.split_at(count);
    let of_joints = |next: &&Move| is_lead(next) || matches!(next.kind, MoveKind::Crossing(_));
    match rest.iter().find(of_joints) {
        Some(next) => Err(LearningError::JointMove(next.tag)),
        None => Ok(lead.to_vec()),
    }
}

/// The tool's level of each tag.
fn levels(moves: &[Move]) -> Result<BTreeMap<u32, u16>, LearningError> {
    let mut levels = BTreeMap::new();
    for next in moves {
        if levels.insert(next.tag, next.tool).unwrap_or(next.tool) != next.tool {
            return Err(LearningError::TwoLevels(next.tag));
        }
    }
    Ok(levels)
}

/// The motions parted by at least `rest` ticks at rest. Each begins with the tick before it.
fn ranges(shown: &[Shown], begun: usize, rest: usize) -> Vec<Range<usize>> {
    let mut ranges: Vec<Range<usize>> = Vec::new();
    for (tick, now) in shown.iter().enumerate().skip(begun) {
        if !now.moves {
            continue;
        }
        match ranges.last_mut() {
            Some(last) if tick - last.end <= rest => last.end = tick + 1,
            _ => ranges.push(tick.saturating_sub(1)..tick + 1),
        }
    }
    ranges
}
