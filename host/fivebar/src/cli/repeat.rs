//! `fivebar sim --repeat`: a job run several times, with learning or without.

use super::failure::{Failure, refused};
use super::output::Folders;
use super::say::{say, warn};
use super::sim::refusal;
use fivebar_files::job::Job;
use fivebar_files::scenario::{ControlLaw, Scenario};
use fivebar_report::text::quantity;
use fivebar_sim::learning::{Ended, LearningError, Memory, Repetition, repeat};
use fivebar_sim::simulation::{
    LearningSummary, Record, RunErrors, Simulate, Summary, TipError, Verdict, fault_name,
};
use std::fs;

/// What a run with its comparison gives.
pub(super) struct Compared {
    pub(super) summary: Summary,
    pub(super) record: Record,
    /// The same with PID at each joint.
    pub(super) pid: Option<(Summary, Record)>,
}

/// How often a job is run.
#[derive(clap::Args, Default)]
pub(super) struct RepeatArgs {
    /// Run the job so many times, each from power-up and with noise of its own, and show which part of the error
    /// repeats.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(2..=100))]
    repeat: Option<u16>,
    /// Let each run learn from those before it: the path is shifted against the error that the encoders saw. What was
    /// learnt is kept in DIR/learnt.json and used by the next command with the same --out, until the robot, its
    /// payload, its settings or the job change.
    #[arg(long, requires = "repeat")]
    learn: bool,
}

/// The file of what was learnt, in the folder of the results.
const FILE: &str = "learnt.json";

impl RepeatArgs {
    pub(super) fn runs(&self) -> Option<usize> {
        self.repeat.map(usize::from)
    }

    /// Runs a job so many times, and under PID as many.
    pub(super) fn run(
        &self,
        scenario: &Scenario,
        job: &Job,
        folders: &Folders,
        progress: &mut (dyn FnMut(f64) + Send),
    ) -> Result<Compared, Failure> {
        let runs = self.runs().unwrap_or(1);
        let (memory, forgotten) = match self.learn {
            true => kept(scenario, job, folders)?,
            false => (None, None),
        };
        if let Some(reason) = &forgotten {
            warn(format_args!(
                "what was learnt before, in {}, is forgotten: {reason}",
                folders.out.path().join(FILE).display()
            ));
        }
        let (ours, pid) = rayon::join(
            || repeat(scenario, job, runs, self.learn, memory, progress),
            || {
                let pid = Scenario {
                    control_law: ControlLaw::Pid,
                    ..scenario.clone()
                };
                let compared = scenario.control_law != ControlLaw::Pid;
                let runs = |learn| repeat(&pid, job, runs, learn, None, &mut |_| ());
                // Learning may not converge with it.
                compared.then(|| runs(self.learn).or_else(|_| runs(false)))
            },
        );
        let ours = ours.map_err(|error| match error {
            LearningError::Run(error) => refusal(scenario, &error),
            other => refused(other),
        })?;
        // PID may fail where computed torque does not; then there is no comparison.
        let pid = pid.and_then(Result::ok);
        if let Some(memory) = &ours.memory {
            let text = memory.to_json().map_err(refused)?;
            folders.out.write(&[(FILE, &text)]).map_err(refused)?;
        }
        let learning = learning(&ours, forgotten);
        let (summary, record) = ours.last;
        let verdict = match ours.failed {
            Some((run, verdict)) => Verdict {
                why: verdict.why.map(|why| format!("run {run}: {why}")),
                ..verdict
            },
            None => summary.verdict,
        };
        let summary = Summary {
            verdict,
            runs: ours.runs,
            pid_runs: pid.as_ref().map_or_else(Vec::new, |pid| pid.runs.clone()),
            pid_learns: pid.as_ref().is_some_and(|pid| pid.filter.is_some()),
            repeats_m: ours.repeats,
            learning,
            ..summary
        };
        Ok(Compared {
            summary,
            record,
            pid: pid.map(|pid| pid.last),
        })
    }
}

/// What was learnt before, or why it is forgotten.
fn kept(
    scenario: &Scenario,
    job: &Job,
    folders: &Folders,
) -> Result<(Option<Memory>, Option<String>), Failure> {
    let Ok(text) = fs::read_to_string(folders.out.path().join(FILE)) else {
        return Ok((None, None));
    };
    let moves = scenario
        .run_moves(job)
        .map_err(|error| refusal(scenario, &error))?;
    Ok(match Memory::of(&text, scenario, &moves) {
        Ok(memory) => (Some(memory), None),
        Err(reason) => (None, Some(reason.to_string())),
    })
}

fn learning(repetition: &Repetition, forgotten: Option<String>) -> Option<LearningSummary> {
    let filter = repetition.filter?;
    let undone = repetition.ended.as_ref().map(|ended| match ended {
        Ended::Diverged => "it was worse than the best run".into(),
        Ended::Refused(reason) => format!("the controller refused the shifted path: {reason}"),
        Ended::Fault(fault) => format!("it ended in a fault: {}", fault_name(*fault)),
    });
    Some(LearningSummary {
        band_hz: filter.half,
        contraction: filter.contraction,
        shift_max_m: repetition.memory.as_ref().map_or(0.0, Memory::greatest),
        settled: repetition.settled,
        undone,
        forgotten,
    })
}

/// Says what each run gave.
pub(super) fn print(summary: &Summary) -> Result<(), Failure> {
    if summary.runs.is_empty() {
        return Ok(());
    }
    let figures = |error: TipError| {
        let [rms, max] = [error.rms_m, error.max_m].map(|error| quantity(error, "m"));
        format!("{rms} RMS, {max} max")
    };
    let table = |title: &str, runs: &[RunErrors]| -> Result<(), Failure> {
        say(format_args!("  {title}"))?;
        for (run, errors) in (1..).zip(runs) {
            let true_error = TipError {
                rms_m: errors.rms_m,
                max_m: errors.max_m,
            };
            say(format_args!(
                "    run {run:<3}  by the sensors {}; true {}; placed {}",
                figures(errors.sensed),
                figures(true_error),
                figures(errors.placed)
            ))?;
        }
        Ok(())
    };
    table("runs", &summary.runs)?;
    if !summary.pid_runs.is_empty() {
        let title = match (&summary.learning, summary.pid_learns) {
            (Some(_), false) => {
                "runs with joint PID, without learning: it may not converge over the workspace"
            }
            _ => "runs with joint PID",
        };
        table(title, &summary.pid_runs)?;
    }
    if let Some([same, rest]) = summary.repeats_m {
        let [same, rest] = [same, rest].map(|error| quantity(error, "m"));
        say(format_args!(
            "  repeats     {same} RMS of what the sensors see is the same in all runs, {rest} is not; --learn takes the former"
        ))?;
    }
    let Some(learning) = &summary.learning else {
        return Ok(());
    };
    say(format_args!(
        "  learning    shifts of up to {} below {:.0} Hz; at every frequency at most {:.0} % of an error is left by a run",
        quantity(learning.shift_max_m, "m"),
        learning.band_hz,
        100.0 * learning.contraction
    ))?;
    if let Some(undone) = &learning.undone {
        say(format_args!(
            "  undone      run {}: {undone}; the best run's shift is kept",
            summary.runs.len()
        ))?;
    } else if let Some(settled) = learning.settled.filter(|&run| run < summary.runs.len()) {
        say(format_args!(
            "  settled     with run {settled}: what is left does not repeat, or is faster than that band"
        ))?;
    }
    say(
        "  not learnt  errors that the encoders do not show: lengths, home angles, the encoders' own; calibration takes those",
    )
}
