//! The arm and its jobs as lines to draw.

use super::strokes::Strokes;
use super::wire::message::{JobMessage, brief};
use fivebar_files::job::{Action, Job};
use fivebar_files::scenario::place_in_job;
use fivebar_firmware::planner::Planner;
use fivebar_firmware::settings::{CheckedSettings, SettingsError};
use fivebar_firmware::{Move, MoveKind, Settings, Status};
use fivebar_kinematics::five_bar::{Pose, Side, Tool, WorkingMode};
use fivebar_sim::measured_pose::measured_pose;
use fivebar_sim::planned_time::PlanStart;
use fivebar_sim::segment::segment;
use nalgebra::Vector2;

/// Most notes on a job that pages show.
const MOST_NOTES: usize = 20;

/// The poses that the arm reaches without a stretched leg or a crossing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Branch {
    pub(super) elbows: [Side; 2],
    pub(super) assembly: Side,
}

impl Branch {
    pub(super) fn mode(&self) -> WorkingMode {
        let [elbow1, elbow4] = self.elbows;
        WorkingMode::new(elbow1, elbow4)
    }
}

/// Where a job begins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct JobStart {
    /// The tool's position [m]; none if it is unknown.
    tool: Option<[f32; 2]>,
    /// The arm's branch; none until the arm is homed.
    pub(super) branch: Option<Branch>,
}

impl JobStart {
    /// An arm on this branch, with its tool anywhere.
    pub(super) fn on(branch: Branch) -> Self {
        Self {
            tool: None,
            branch: Some(branch),
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

    /// The same arm behind the lines of a job before `line`.
    pub(super) fn behind(mut self, job: &Job, line: u32) -> Self {
        for step in job.steps.iter().filter(|step| step.line < line) {
            if let Some(branch) = &mut self.branch {
                match step.action {
                    Action::ChangeMode(mode) => branch.elbows = [mode.elbow1, mode.elbow4],
                    Action::Cross { .. } => branch.assembly = branch.assembly.opposite(),
                    _ => {}
                }
            }
        }
        self
    }

    /// Why an arm that begins `now` is not on this branch, as the end of a sentence; none if it is.
    pub(super) fn differs(&self, now: Self) -> Option<&'static str> {
        let (there, here) = (self.branch?, now.branch?);
        if there.assembly != here.assembly {
            return Some("in the other assembly mode, which only a crossing reaches: run a job.");
        }
        (there.elbows != here.elbows).then_some("in another working mode: change to it first.")
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
    settings: Settings,
}

impl Preview {
    pub(super) fn new(settings: &CheckedSettings) -> Self {
        Self {
            tool: *settings.tool(),
            settings: **settings,
        }
    }

    /// The pose that the controller measures; none until the arm is homed.
    pub(super) fn pose(&self, status: &Status) -> Option<Pose<f32>> {
        measured_pose(&self.tool, status)
    }

    /// The branch of a pose.
    pub(super) fn branch(&self, pose: &Pose<f32>) -> Branch {
        let mode = self.tool.working_mode(pose);
        Branch {
            elbows: [mode.elbow1, mode.elbow4],
            assembly: pose.assembly(),
        }
    }

    /// The tool's position [m] at θ1, θ4 [rad]; none if no pose has these angles.
    pub(super) fn tool_at(&self, [theta1, theta4]: [f32; 2], assembly: Side) -> Option<[f32; 2]> {
        let geometry = self.tool.geometry();
        let pose = geometry.forward(theta1, theta4, assembly).ok()?;
        let tool = self.tool.point(&pose);
        Some([tool.x, tool.y])
    }

    /// θ1, θ4 [rad] with the tool at `point` [m] on a branch. None if the point is out
    /// of reach, or belongs to the other assembly mode: no path reaches that mode without a
    /// singularity of type 2.
    pub(super) fn joints(&self, point: [f32; 2], branch: Branch) -> Option<[f32; 2]> {
        let pose = self
            .tool
            .inverse(Vector2::from(point), branch.mode())
            .ok()?;
        let [theta1, _, _, theta4] = pose.angles();
        (pose.assembly() == branch.assembly).then_some([theta1, theta4])
    }

    /// Where a job would begin now.
    pub(super) fn start(&self, status: &Status) -> JobStart {
        JobStart {
            tool: status.reference.or(status.tool),
            branch: self.pose(status).map(|pose| self.branch(&pose)),
        }
    }

    /// Where the controller's planner would begin a job; none if the arm's position is unknown.
    pub(super) fn plan_start(&self, start: JobStart) -> Option<PlanStart> {
        let (tool, branch) = start.tool.zip(start.branch)?;
        Some(PlanStart {
            tool,
            mode: branch.mode(),
            assembly: branch.assembly,
        })
    }

    /// The controller's settings.
    pub(super) fn settings(&self) -> &Settings {
        &self.settings
    }

    /// The path of a job, checked as a whole, as the controller would check it.
    pub(super) fn job(&self, name: &str, job: &Job, moves: &[Move], start: JobStart) -> JobMessage {
        let mut message = JobMessage {
            name: name.into(),
            // Without the approach, which is the program's own and has no line.
            moves: moves.iter().filter(|next| next.tag > 0).count(),
            notes: job
                .warnings
                .iter()
                .take(MOST_NOTES)
                .map(|note| brief(note.to_string()))
                .collect(),
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
                let mut lines = moves.iter().map(|next| next.tag);
                let first = lines.find(|&line| line > 0).unwrap_or_default();
                let place = |line| place_in_job(job.is_drawing, line);
                let mut sentence = match refusal.tag {
                    0 => format!("on the way to {}: {refusal}.", place(first)),
                    line => format!("{}: {refusal}.", place(line)),
                };
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

    /// A planner like the controller's, on the arm's branch.
    pub(super) fn planner(&self, start: JobStart) -> Result<Planner, SettingsError> {
        let planner = Planner::new(&self.settings.check()?);
        Ok(match start.branch {
            None => planner,
            Some(branch) => planner.in_mode(branch.mode()).in_assembly(branch.assembly),
        })
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

#[cfg(test)]
mod tests {
    use super::*;
    use fivebar_files::job::Placement;

    #[test]
    fn a_line_belongs_to_the_branch_that_the_lines_before_it_lead_to() {
        let home = Placement {
            origin: [0.0; 2],
            scale: 1.0,
            turn: 0.0,
            home: [0.0; 2],
        };
        let job = Job::parse("G0 X9\nM780 I1 J-1\nG0 X8\nM781 X9 Y9 P1\nG0 X9\n", &home).unwrap();
        let start = JobStart::on(Branch {
            elbows: [Side::Right, Side::Left],
            assembly: Side::Left,
        });
        let differs = |line| start.behind(&job, line).differs(start);
        assert_eq!((differs(1), differs(2)), (None, None));
        for line in [3, 4] {
            assert!(
                differs(line)
                    .unwrap()
                    .starts_with("in another working mode")
            );
        }
        let crossed = differs(5).unwrap();
        assert!(crossed.starts_with("in the other assembly mode"));
    }
}
