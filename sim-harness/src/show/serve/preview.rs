//! The arm and its jobs as lines to draw.

use super::message::{JobMessage, brief};
use super::strokes::Strokes;
use crate::input::job::Job;
use crate::input::scenario::place_in_job;
use crate::run::segment::segment;
use fivebar_firmware::planner::Planner;
use fivebar_firmware::settings::{CheckedSettings, SettingsError};
use fivebar_firmware::{Move, MoveKind, Settings, Status};
use fivebar_kinematics::five_bar::{Pose, Side, Tool, WorkingMode};
use nalgebra::Vector2;

/// Where a job begins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct JobStart {
    /// The tool's position [m]; none if it is unknown.
    tool: Option<[f32; 2]>,
    /// The arm's working mode; none until the arm is homed.
    pub(super) elbows: Option<[Side; 2]>,
}

impl JobStart {
    /// An arm in this working mode, with its tool anywhere.
    pub(super) fn in_mode(elbows: [Side; 2]) -> Self {
        Self {
            tool: None,
            elbows: Some(elbows),
        }
    }

    /// Whether the tool's position is known.
    pub(super) fn is_known(&self) -> bool {
        self.tool.is_some()
    }

    /// The tool's position [m]; none if it is unknown.
    pub(super) fn tool(&self) -> Option<[f32; 2]> {
        self.tool
    }

    /// The arm's working mode; none until the arm is homed.
    pub(super) fn mode(&self) -> Option<WorkingMode> {
        let [elbow1, elbow4] = self.elbows?;
        Some(WorkingMode::new(elbow1, elbow4))
    }

    /// The same arm with its tool at another place [m].
    pub(super) fn at(self, place: [f32; 2]) -> Self {
        Self {
            tool: Some(place),
            ..self
        }
    }
}

/// Draws the arm of a controller's settings, and checks its jobs.
#[derive(Clone)]
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

    /// Where a job would begin now.
    pub(super) fn start(&self, status: &Status) -> JobStart {
        JobStart {
            tool: status.reference.or(status.tool),
            elbows: self.pose(status).map(|pose| self.elbows(&pose)),
        }
    }

    /// The path of a job, checked as a whole, as the controller would check it.
    pub(super) fn job(&self, name: &str, job: &Job, moves: &[Move], start: JobStart) -> JobMessage {
        let mut message = JobMessage {
            name: name.into(),
            // Without the approach, which is the program's own and has no line.
            moves: moves.iter().filter(|next| next.tag > 0).count(),
            ..JobMessage::default()
        };
        let Some(mut from) = start.tool else {
            message.refusal =
                Some("The arm's position is unknown: home it, then the job is checked.".into());
            return message;
        };
        let checked = self
            .planner(start)
            .map(|mut planner| planner.check_all(from, moves));
        match checked {
            Ok(Ok(())) => {}
            Ok(Err(refusal)) => {
                // The way to the job belongs to the first line that moves.
                let mut lines = job.steps.iter().map(|step| step.line);
                let first = lines.find(|&line| line > 0).unwrap_or_default();
                let line = if refusal.tag == 0 { first } else { refusal.tag };
                let place = place_in_job(job.is_drawing, line);
                let mut sentence = format!("{place}: {refusal}.");
                sentence[..1].make_ascii_uppercase();
                message.refusal = Some(brief(sentence));
                message.at = refusal.point;
            }
            Err(error) => message.refusal = Some(format!("The settings: {error}.")),
        }
        let mut strokes = Strokes::default();
        for next in moves {
            strokes.pen(next.tool > 0, from);
            from = draw(&mut strokes, from, &next.kind);
        }
        message.strokes = strokes.finish();
        message
    }

    /// A planner like the controller's, in the arm's working mode.
    pub(super) fn planner(&self, start: JobStart) -> Result<Planner, SettingsError> {
        let mut settings = self.settings;
        if let Some(elbows) = start.elbows {
            settings.elbows_left = elbows.map(|side| side == Side::Left);
        }
        Ok(Planner::new(&settings.check()?))
    }
}

/// Draws a move and returns its end [m].
fn draw(strokes: &mut Strokes, from: [f32; 2], kind: &MoveKind) -> [f32; 2] {
    match *kind {
        MoveKind::Line { to, .. } => {
            strokes.push(to);
            to
        }
        MoveKind::Arc { to, .. } => {
            let Some(Ok(arc)) = segment::<f32>(kind, from) else {
                strokes.push(to);
                return to;
            };
            let count = (arc.length() / strokes.chord()).ceil().max(1.0) as u32;
            let at = |index: u32| arc.at(arc.length() * index as f32 / count as f32).position;
            for point in (1..=count).map(at) {
                strokes.push([point.x, point.y]);
            }
            let end = at(count);
            [end.x, end.y]
        }
        MoveKind::Timed(timed) => {
            strokes.push(timed.end());
            timed.end()
        }
        MoveKind::Crossing(plan) => {
            strokes.push(plan.to);
            plan.to
        }
        MoveKind::Dwell { .. } | MoveKind::Joint { .. } => from,
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
