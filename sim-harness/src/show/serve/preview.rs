//! The arm and its jobs as lines to draw.

use super::message::{JobMessage, Stroke};
use crate::input::job::Job;
use fivebar_firmware::planner::{MoveError, Planner};
use fivebar_firmware::settings::{CheckedSettings, SettingsError};
use fivebar_firmware::{Move, MoveKind, Settings, Status};
use fivebar_kinematics::five_bar::{Pose, Side, Tool, WorkingMode};
use fivebar_kinematics::trajectory::{PathSegment, Sense};
use nalgebra::Vector2;

/// Greatest length of the chords of a drawn arc [m].
const CHORD: f32 = 1e-3;
/// Greatest error of an arc's centre in a drawing [m].
const ARC_TOLERANCE: f32 = 1e-4;

/// Draws the arm of a controller's settings, and checks its jobs.
pub(super) struct Preview {
    tool: Tool<f32>,
    assembly: Side,
    settings: Settings,
}

impl Preview {
    pub(super) fn new(settings: &CheckedSettings) -> Self {
        Self {
            tool: *settings.tool(),
            assembly: settings.assembly(),
            settings: **settings,
        }
    }

    /// The pose that the controller measures; none until the arm is homed.
    pub(super) fn pose(&self, status: &Status) -> Option<Pose<f32>> {
        let [theta1, theta4] = status.angle;
        let geometry = self.tool.geometry();
        let pose = geometry.forward(theta1, theta4, self.assembly).ok()?;
        status.homed.then_some(pose)
    }

    /// The working mode of a pose, by its elbows.
    pub(super) fn elbows(&self, pose: &Pose<f32>) -> [Side; 2] {
        let mode = self.tool.working_mode(pose);
        [mode.elbow1, mode.elbow4]
    }

    /// The tool's position [m] at θ1, θ4 [rad]; none if no pose has these angles.
    pub(super) fn tool_at(&self, [theta1, theta4]: [f32; 2]) -> Option<[f32; 2]> {
        let geometry = self.tool.geometry();
        let pose = geometry.forward(theta1, theta4, self.assembly).ok()?;
        let tool = self.tool.point(&pose);
        Some([tool.x, tool.y])
    }

    /// θ1, θ4 [rad] with the tool at `point` [m] and these elbows. None if the point is out
    /// of reach, or belongs to the other assembly mode: no path reaches that mode without a
    /// singularity of type 2.
    pub(super) fn joints(&self, point: [f32; 2], [elbow1, elbow4]: [Side; 2]) -> Option<[f32; 2]> {
        let mode = WorkingMode::new(elbow1, elbow4);
        let pose = self.tool.inverse(vec2(point), mode).ok()?;
        let [theta1, _, _, theta4] = pose.angles();
        (pose.assembly() == self.assembly).then_some([theta1, theta4])
    }

    /// The path of a job, checked as a whole from the tool's present position, as the
    /// controller would check it.
    pub(super) fn job(&self, name: &str, job: &Job, moves: &[Move], status: &Status) -> JobMessage {
        let mut message = JobMessage {
            name: name.into(),
            moves: moves.len(),
            ..JobMessage::default()
        };
        let Some(mut from) = status.reference.or(status.tool) else {
            message.refusal =
                Some("The arm's position is unknown: home it, then the job is checked.".into());
            return message;
        };
        let checked = self
            .planner(status)
            .map(|planner| check(&planner, from, moves));
        match checked {
            Ok(Ok(())) => {}
            Ok(Err(refusal)) => {
                message.refusal = Some(format!("Line {}: {refusal}.", refusal.tag));
                message.at = refusal.point;
            }
            Err(error) => message.refusal = Some(format!("The settings: {error}.")),
        }
        for (step, next) in job.steps.iter().zip(moves) {
            let (start, points) = (from, points(from, &next.kind));
            from = *points.last().unwrap_or(&from);
            match message.strokes.last_mut() {
                Some(stroke) if stroke.down == step.pen_down => stroke.points.extend(points),
                _ => message.strokes.push(Stroke {
                    down: step.pen_down,
                    points: std::iter::once(start).chain(points).collect(),
                }),
            }
        }
        message
    }

    /// A planner like the controller's, in the arm's present working mode.
    fn planner(&self, status: &Status) -> Result<Planner, SettingsError> {
        let mut settings = self.settings;
        if let Some(pose) = self.pose(status) {
            settings.elbows_left = self.elbows(&pose).map(|side| side == Side::Left);
        }
        Ok(Planner::new(&settings.check()?))
    }
}

fn check(planner: &Planner, mut from: [f32; 2], moves: &[Move]) -> Result<(), MoveError> {
    for next in moves {
        from = planner.check(from, next)?;
    }
    Ok(())
}

/// The points of a move after its start [m].
fn points(from: [f32; 2], kind: &MoveKind) -> Vec<[f32; 2]> {
    match *kind {
        MoveKind::Line { to, .. } => vec![to],
        MoveKind::Arc {
            to,
            center,
            clockwise,
            ..
        } => {
            let sense = if clockwise {
                Sense::Clockwise
            } else {
                Sense::CounterClockwise
            };
            let arc = PathSegment::arc(vec2(from), vec2(to), vec2(center), sense, ARC_TOLERANCE);
            let Ok(arc) = arc else { return vec![to] };
            let count = (arc.length() / CHORD).ceil().max(1.0) as u32;
            let at = |index: u32| arc.at(arc.length() * index as f32 / count as f32).position;
            (1..=count)
                .map(at)
                .map(|point| [point.x, point.y])
                .collect()
        }
        MoveKind::Dwell { .. } | MoveKind::Joint { .. } => Vec::new(),
    }
}

/// `angle` plus whole turns, as near to `to` as possible [rad].
pub(super) fn nearest(angle: f32, to: f32) -> f32 {
    use std::f32::consts::TAU;
    angle + TAU * ((to - angle) / TAU).round()
}

fn vec2([x, y]: [f32; 2]) -> Vector2<f32> {
    Vector2::new(x, y)
}
