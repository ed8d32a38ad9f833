//! Whether an arm can draw a job where it is tried.
//!
//! A fit tries one job at hundreds of places, scales and turns. Where it is refused, a few of its moves are to blame,
//! most often those at its corners. So each trial begins with the moves that were refused before, and checks the whole
//! job only if the planner accepts these.

use super::Scenario;
use crate::job::{Action, Job, Step};
use fivebar_firmware::Planner;
use fivebar_firmware::planner::MoveErrorKind;
use std::f32::consts::TAU;

/// Refused moves that are kept.
const MOST_KEPT: usize = 16;

/// The planner of an arm, and the moves of one job that it has refused.
pub(super) struct Trials {
    pub(super) planner: Planner,
    /// Indices of the refused steps, the last refused one first.
    refused: Vec<usize>,
    /// How many of them are kept.
    most_kept: usize,
    /// How often the whole job was checked.
    #[cfg(test)]
    pub(super) whole_checks: usize,
}

/// A refusal, and the index of the step if it belongs to one.
struct Refused {
    step: Option<usize>,
}

impl Trials {
    pub(super) fn new(planner: Planner) -> Self {
        Self {
            planner,
            refused: Vec::new(),
            most_kept: MOST_KEPT,
            #[cfg(test)]
            whole_checks: 0,
        }
    }

    /// One that checks the whole job in each trial.
    #[cfg(test)]
    pub(super) fn without_memory(planner: Planner) -> Self {
        Self {
            most_kept: 0,
            ..Self::new(planner)
        }
    }

    /// Whether the job of `scenario` can be drawn with its (0, 0) at `origin` [m], with or without the travel after its
    /// last stroke. `job` has it at 0; every call takes the same steps up to that stroke.
    pub(super) fn accept(&mut self, scenario: &Scenario, job: &Job, origin: [f64; 2]) -> bool {
        let is_refused = |&step: &usize| self.refuses_step(scenario, job, origin, step);
        if let Some(place) = self.refused.iter().position(is_refused) {
            self.refused[..=place].rotate_right(1);
            return false;
        }
        let Some(job) = scenario.moved(job, scenario, origin) else {
            return false;
        };
        scenario.has_margin(&job) && self.accept_whole(scenario, &job)
    }

    fn accept_whole(&mut self, scenario: &Scenario, job: &Job) -> bool {
        let Err(Refused { step }) = self.check(scenario, job) else {
            return true;
        };
        let last_stroke = job.steps.iter().rposition(Step::draws);
        if step.is_none() || step > last_stroke {
            // The travel after the last stroke may be to blame.
            let drawn = job.without_parking();
            return drawn.is_some_and(|drawn| self.check(scenario, &drawn).is_ok());
        }
        if let Some(step) = step {
            self.refused.insert(0, step);
            self.refused.truncate(self.most_kept);
        }
        false
    }

    fn check(&mut self, scenario: &Scenario, job: &Job) -> Result<(), Refused> {
        #[cfg(test)]
        {
            self.whole_checks += 1;
        }
        let Some(tool) = scenario.home_point() else {
            return Ok(());
        };
        let moves = scenario.moves_from_home(&self.planner, job);
        let moves = moves.map_err(|_| Refused { step: None })?;
        let joints = scenario.robot.home.map(|angle| angle as f32);
        let mut begun = 0;
        let counted = moves.iter().inspect(|_| begun += 1);
        let checked = self.planner.check_all_from(tool, Some(joints), counted);
        checked.map_err(|_| {
            // Without a change of mode each step is one move.
            let is_step = job.first_change_of_mode().is_none() && begun <= job.steps.len();
            Refused {
                step: is_step.then_some(begun - 1),
            }
        })
    }

    /// Whether this step alone, from the end of the one before it, is refused there. A limit of a joint tells nothing if
    /// the joint can begin in one of several turns.
    fn refuses_step(&self, scenario: &Scenario, job: &Job, origin: [f64; 2], step: usize) -> bool {
        // A job that depends on home has another shape at each place: only the whole is read again.
        if job.depends_on_home {
            return false;
        }
        let before = job.steps.get(..step).unwrap_or_default();
        let from = before.iter().rev().find_map(|step| step.action.end());
        let (Some(to), Some(step)) = (from, job.steps.get(step)) else {
            return false;
        };
        let start = Step {
            action: Action::Line { to, feed: None },
            ..*step
        };
        let piece = Job {
            steps: vec![start, *step],
            stops: Vec::new(),
            warnings: Vec::new(),
            ..*job
        };
        let Some(piece) = scenario.moved(&piece, scenario, origin) else {
            return false;
        };
        let Some([x, y]) = piece.steps[0].action.end() else {
            return false;
        };
        let moves = piece.moves(scenario.robot.motion.max_speed);
        moves.skip(1).any(|next| {
            let checked = self.planner.check([x as f32, y as f32], &next);
            checked.is_err_and(|error| {
                !matches!(error.kind, MoveErrorKind::JointLimit(_)) || self.has_one_turn()
            })
        })
    }

    /// Whether the limits allow each angle of a joint in one turn only.
    fn has_one_turn(&self) -> bool {
        let limits = self.planner.workspace().limits;
        limits.is_none_or(|limits| limits.ranges().iter().all(|[low, high]| high - low < TAU))
    }
}
