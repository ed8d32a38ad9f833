//! The arm and its jobs as lines to draw.

use super::message::{JobNews, Stroke};
use crate::input::job::Job;
use fivebar_firmware::planner::{MoveRefusal, Planner};
use fivebar_firmware::settings::SettingsError;
use fivebar_firmware::{Move, MoveKind, Settings, Status};
use fivebar_kinematics::five_bar::{Pose, Side, Tool, WorkingMode};
use fivebar_kinematics::trajectory::{PathSegment, Sense};
use nalgebra::Vector2;

/// Longest straight piece of a drawn arc [m].
const CHORD: f32 = 1e-3;
/// How far an arc's centre may be off in a drawing [m].
const ARC_TOLERANCE: f32 = 1e-4;

/// The arm of a controller's settings.
pub(super) struct Preview {
    tool: Tool<f32>,
    assembly: Side,
    settings: Settings,
}

impl Preview {
    pub(super) fn new(settings: &Settings) -> Result<Self, SettingsError> {
        Ok(Self {
            tool: settings.tool(&settings.arm()?)?,
            assembly: settings.assembly(),
            settings: *settings,
        })
    }

    /// The arm as the controller believes it to stand; none until it is homed.
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

    /// The tool at θ1, θ4 [rad], in metres; none where they close no arm.
    pub(super) fn tool_at(&self, [theta1, theta4]: [f32; 2]) -> Option<[f32; 2]> {
        let geometry = self.tool.geometry();
        let pose = geometry.forward(theta1, theta4, self.assembly).ok()?;
        let tool = self.tool.point(&pose);
        Some([tool.x, tool.y])
    }

    /// θ1, θ4 [rad] that hold the tool at `point` [m] with these elbows. None out of reach,
    /// or where only another assembly branch has it, which no motion that keeps clear of
    /// type 2 leads to.
    pub(super) fn joints(&self, point: [f32; 2], [elbow1, elbow4]: [Side; 2]) -> Option<[f32; 2]> {
        let mode = WorkingMode::new(elbow1, elbow4);
        let pose = self.tool.inverse(vec2(point), mode).ok()?;
        let [theta1, _, _, theta4] = pose.angles();
        (pose.assembly() == self.assembly).then_some([theta1, theta4])
    }

    /// A job to be drawn, held as a whole against what the controller would take from where
    /// the tool stands.
    pub(super) fn job(&self, name: &str, job: &Job, moves: &[Move], status: &Status) -> JobNews {
        let mut news = JobNews {
            name: name.into(),
            moves: moves.len(),
            ..JobNews::default()
        };
        let Some(mut from) = status.reference.or(status.tool) else {
            news.refusal = Some("The way to its start is not known yet: home first.".into());
            return news;
        };
        let checked = self
            .planner(status)
            .map(|planner| check(&planner, from, moves));
        match checked {
            Ok(Ok(())) => {}
            Ok(Err(refusal)) => {
                news.refusal = Some(format!("Line {}: {refusal}.", refusal.tag));
                news.at = refusal.point;
            }
            Err(error) => news.refusal = Some(format!("The settings: {error}.")),
        }
        for (step, order) in job.steps.iter().zip(moves) {
            let (start, points) = (from, points(from, &order.kind));
            from = *points.last().unwrap_or(&from);
            match news.strokes.last_mut() {
                Some(stroke) if stroke.down == step.pen_down => stroke.points.extend(points),
                _ => news.strokes.push(Stroke {
                    down: step.pen_down,
                    points: std::iter::once(start).chain(points).collect(),
                }),
            }
        }
        news
    }

    /// A planner like the controller's, in the working mode that the arm stands in.
    fn planner(&self, status: &Status) -> Result<Planner, SettingsError> {
        let mut settings = self.settings;
        if let Some(pose) = self.pose(status) {
            settings.elbows_left = self.elbows(&pose).map(|side| side == Side::Left);
        }
        Planner::new(&settings)
    }
}

fn check(planner: &Planner, mut from: [f32; 2], moves: &[Move]) -> Result<(), MoveRefusal> {
    for order in moves {
        from = planner.check(from, order)?;
    }
    Ok(())
}

/// Points of a move after its start [m].
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

/// `angle` [rad] by whole turns, nearest to `to`.
pub(super) fn nearest(angle: f32, to: f32) -> f32 {
    use std::f32::consts::TAU;
    angle + TAU * ((to - angle) / TAU).round()
}

fn vec2([x, y]: [f32; 2]) -> Vector2<f32> {
    Vector2::new(x, y)
}
