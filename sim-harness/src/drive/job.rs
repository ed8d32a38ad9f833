//! The moves of a job from where the arm is.

use super::DriveError;
use crate::time_optimal::JobPlanner;
use fivebar_files::job::{Job, Pause};
use fivebar_files::scenario::Scenario;
use fivebar_firmware::{Move, Planner};

/// The job's moves with a tool that is here [m], and the pauses between them; of a scenario that asks for it, planned
/// time-optimally.
///
/// # Errors
/// A change of the working mode that cannot be done, or a job that cannot be planned time-optimally.
pub fn job_moves(
    scenario: &Scenario,
    job: &Job,
    tool: [f32; 2],
    planner: &mut Planner,
) -> Result<(Vec<Move>, Vec<Pause>), DriveError> {
    let (mode, assembly) = (planner.workspace().mode, planner.assembly());
    let (moves, mut pauses) = job.with_pauses(&scenario.moves_in(mode, Some(assembly), job)?);
    let Some(share) = scenario.time_optimal else {
        return Ok((moves, pauses));
    };
    let job = JobPlanner::new(&scenario.robot, share)?;
    let planned = job.plan(tool, &moves, planner)?;
    for pause in &mut pauses {
        pause.before =
            planned.partition_point(|piece| piece.source.is_none_or(|it| it < pause.before));
    }
    Ok((planned.iter().map(|piece| piece.next).collect(), pauses))
}
