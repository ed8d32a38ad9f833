//! The runs of a job that is repeated, with learning or without.

use super::LearningError;
use super::contraction::{Filter, Response};
use super::follower::{Followed, Follower, Tick};
use super::memory::{Digest, Memory};
use super::sensors::Sensors;
use super::shift::{Errors, Learnt};
use super::timed_path::{Shown, TimedPath};
use crate::simulation::{Record, RunError, RunErrors, Simulate, Summary, TipError, Verdict};
use fivebar_files::job::Job;
use fivebar_files::scenario::Scenario;
use fivebar_firmware::Move;
use fivebar_firmware::safety::Fault;
use nalgebra::Vector2;

/// A run whose RMS error is this many times the least one diverges.
const WORSE: f64 = 1.1;
/// A run whose error exceeds the first run's greatest one so many times is stopped.
const STOPPED: f64 = 2.0;
/// The greatest shift, as a share of the distance at the crank's end at which the following error is a fault.
const BOUND: f64 = 0.25;
/// A run that takes less than this share of the error gains nothing.
const GAIN: f64 = 0.05;

/// How learning ended before the last run.
#[derive(Clone, Debug, PartialEq)]
pub enum Ended {
    /// A run was worse than the best one, or was stopped: its shift is undone.
    Diverged,
    /// The controller refused the shifted path.
    Refused(String),
    /// A fault stopped a run.
    Fault(Fault),
}

/// What the runs of a job showed.
pub struct Repetition {
    /// The runs in their order.
    pub runs: Vec<RunErrors>,
    /// Summary and record of the best run; without learning of the last one.
    pub last: (Summary, Record),
    /// RMS of the part of the sensed error that was the same in all runs, and of the rest [m]; of runs without
    /// learning.
    pub repeats: Option<[f64; 2]>,
    /// The filter of the learning.
    pub filter: Option<Filter>,
    /// The number of the last run that took a share of the error worth naming, from 1; none if none did.
    pub settled: Option<usize>,
    /// Why learning ended early.
    pub ended: Option<Ended>,
    /// The first run that did not draw the job, from 1: of all runs without learning; with it only a run that ended in a
    /// fault, because the shift of a worse run is undone.
    pub failed: Option<(usize, Verdict)>,
    /// What was learnt.
    pub memory: Option<Memory>,
}

/// What a run left behind.
pub(super) struct Run {
    pub(super) summary: Summary,
    pub(super) record: Record,
    pub(super) ticks: Vec<Tick>,
    /// It was stopped because of its error.
    pub(super) stopped: bool,
    pub(super) errors: RunErrors,
}

/// An arm that does the job again and again.
pub(super) trait Repeats {
    /// Does the job, with the shift that was learnt. `greatest` is the error at which the run is stopped [m].
    fn run(&mut self, learnt: Option<&Learnt>, greatest: f64) -> Result<Run, LearningError>;

    /// The path that a run without a shift has shown. Its ticks then have their places on it.
    fn path(&self, run: &mut Run) -> Result<TimedPath, LearningError>;
}

/// Runs a job so many times, at least once, each from power-up; every run has its own noise. With `learn`, each run is
/// shifted by what those before it have shown, and the first one by `memory`.
///
/// # Errors
/// The first run is refused, or the job or the arm cannot be learnt.
pub fn repeat(
    scenario: &Scenario,
    job: &Job,
    runs: usize,
    learn: bool,
    memory: Option<Memory>,
    progress: &mut dyn FnMut(f64),
) -> Result<Repetition, LearningError> {
    let robot = &scenario.robot;
    if robot.has_steppers() {
        return Err(LearningError::NoEncoders("a stepper"));
    }
    if robot.hobby_servos().is_some() {
        return Err(LearningError::NoEncoders("a hobby servo"));
    }
    let plain = scenario.run_moves(job)?;
    let digest = Digest::new(scenario, &plain)?;
    let filter = match learn {
        true => Some(Response::new(robot, scenario.control_law)?.filter()?),
        false => None,
    };
    let [l1, _, _, l4, _] = robot.geometry.lengths();
    let bound = BOUND * robot.protection.following_error * l1.min(l4);
    let mut arm = SimulatedRuns {
        scenario,
        plain,
        learns: learn,
        count: 0,
        progress,
    };
    let learnt = memory.filter(|_| learn).map(|memory| memory.learnt);
    let found = runs_of(&mut arm, runs, filter.as_ref(), bound, learnt)?;
    Ok(Repetition {
        repeats: filter.is_none().then(|| repeating(&found.seen)),
        settled: settled(&found.all),
        runs: found.all,
        last: (found.best.summary, found.best.record),
        filter,
        ended: found.ended,
        failed: found.failed,
        memory: found
            .followed
            .filter(|_| filter.is_some())
            .map(|learnt| Memory { digest, learnt }),
    })
}

/// What all runs have shown.
pub(super) struct Found {
    pub(super) all: Vec<RunErrors>,
    seen: Vec<Errors>,
    best: Run,
    /// What the best run followed: a shift that was never tried is not kept.
    pub(super) followed: Option<Learnt>,
    pub(super) ended: Option<Ended>,
    /// The first run that did not draw the job: see [`Repetition`].
    pub(super) failed: Option<(usize, Verdict)>,
}

/// Runs and, with a filter, learns from run to run until one diverges.
pub(super) fn runs_of(
    arm: &mut impl Repeats,
    runs: usize,
    filter: Option<&Filter>,
    bound: f64,
    mut learnt: Option<Learnt>,
) -> Result<Found, LearningError> {
    let (mut all, mut seen) = (Vec::<RunErrors>::new(), Vec::new());
    let mut best: Option<(Run, Option<Learnt>)> = None;
    let (mut ended, mut failed) = (None, None);
    for _ in 0..runs.max(1) {
        let first = all.first().filter(|_| filter.is_some());
        let greatest = first.map_or(f64::INFINITY, |first| STOPPED * first.sensed.max_m);
        let mut run = match arm.run(learnt.as_ref(), greatest) {
            Ok(run) => run,
            Err(LearningError::Run(refused @ RunError::Target(_))) if best.is_some() => {
                ended = Some(Ended::Refused(refused.to_string()));
                break;
            }
            Err(error) => return Err(error),
        };
        all.push(run.errors);
        let least = best.as_ref().map(|(best, _)| best.errors.sensed.rms_m);
        let rms = run.errors.sensed.rms_m;
        let worse = filter.is_some() && least.is_some_and(|least| rms > WORSE * least);
        let fault = run.record.faults.first().map(|&(_, fault)| fault);
        let verdict = &run.summary.verdict;
        if failed.is_none() && !verdict.drawn && (filter.is_none() || fault.is_some()) {
            failed = Some((all.len(), verdict.clone()));
        }
        if fault.is_some() || run.stopped || worse {
            ended = Some(fault.map_or(Ended::Diverged, Ended::Fault));
            if best.is_none() {
                best = Some((run, None));
            }
            break;
        }
        let followed = match learnt.take() {
            Some(followed) => followed,
            None => Learnt::nothing(arm.path(&mut run)?),
        };
        let errors = followed.errors(&run.ticks);
        learnt = Some(match filter {
            Some(filter) => followed.next(&errors, filter, bound),
            None => followed.clone(),
        });
        seen.push(errors);
        if filter.is_none() || least.is_none_or(|least| rms < least) {
            best = Some((run, Some(followed)));
        }
    }
    let (best, followed) = best.ok_or(LearningError::NoMotion)?;
    Ok(Found {
        all,
        seen,
        best,
        followed,
        ended,
        failed,
    })
}

/// The simulated arm.
struct SimulatedRuns<'a> {
    scenario: &'a Scenario,
    /// The job's own moves.
    plain: Vec<Move>,
    /// Whether a shift is followed.
    learns: bool,
    /// Runs so far.
    count: u64,
    progress: &'a mut dyn FnMut(f64),
}

impl Repeats for SimulatedRuns<'_> {
    fn run(&mut self, learnt: Option<&Learnt>, greatest: f64) -> Result<Run, LearningError> {
        let moves = match learnt {
            Some(learnt) if self.learns => learnt.path.moves(&learnt.streamed()),
            _ => self.plain.clone(),
        };
        let scenario = Scenario {
            seed: self.scenario.seed.wrapping_add(self.count),
            ..self.scenario.clone()
        };
        self.count += 1;
        let sensors = Sensors::new(&scenario.robot)?;
        let mut follower = Follower::new(sensors, learnt.map(Followed::new), greatest);
        let (summary, record) = scenario.run_watched(&moves, &mut follower, self.progress)?;
        Ok(Run {
            errors: RunErrors {
                drawn: summary.verdict.drawn,
                rms_m: summary.tip_error.rms_m,
                max_m: summary.tip_error.max_m,
                placed: summary.tip_error_placed,
                sensed: sensed(&follower.ticks),
            },
            summary,
            record,
            ticks: follower.ticks,
            stopped: follower.stopped,
        })
    }

    fn path(&self, run: &mut Run) -> Result<TimedPath, LearningError> {
        let shown: Vec<Shown> = run.ticks.iter().map(|tick| tick.shown).collect();
        let (path, ranges) = TimedPath::shown(&shown, &self.plain, &self.scenario.robot)?;
        for (motion, range) in ranges.into_iter().enumerate() {
            for (at, tick) in run.ticks[range].iter_mut().enumerate() {
                tick.place = Some((motion, at));
            }
        }
        Ok(path)
    }
}

/// The errors that the sensors saw in a run.
pub(super) fn sensed(ticks: &[Tick]) -> TipError {
    let errors = ticks.iter().filter_map(|tick| Some(tick.error?.norm()));
    let (mut count, mut squares, mut max_m) = (0.0, 0.0, 0.0_f64);
    for error in errors {
        count += 1.0;
        squares += error * error;
        max_m = max_m.max(error);
    }
    TipError {
        rms_m: (squares / f64::max(count, 1.0)).sqrt(),
        max_m,
    }
}

/// The last run that was better than all before it by a share worth naming.
fn settled(runs: &[RunErrors]) -> Option<usize> {
    let rms = |run: &RunErrors| run.sensed.rms_m;
    let better = |&at: &usize| {
        let least = runs[..at].iter().map(rms).fold(f64::INFINITY, f64::min);
        rms(&runs[at]) < (1.0 - GAIN) * least
    };
    (1..runs.len()).rfind(better).map(|at| at + 1)
}

/// RMS of what all runs share, and of what each has besides [m].
fn repeating(runs: &[Errors]) -> [f64; 2] {
    let count = runs.len() as f64;
    let (mut mean_squares, mut rest_squares, mut places) = (0.0, 0.0, 0.0);
    let Some(first) = runs.first() else {
        return [0.0; 2];
    };
    for (motion, ticks) in first.iter().enumerate() {
        for tick in 0..ticks.len() {
            let at = |run: &Errors| run[motion][tick];
            let mean = runs.iter().map(at).sum::<Vector2<f64>>() / count;
            mean_squares += mean.norm_squared();
            let rest = runs.iter().map(|run| (at(run) - mean).norm_squared());
            rest_squares += rest.sum::<f64>() / (count - 1.0).max(1.0);
            places += 1.0;
        }
    }
    [mean_squares, rest_squares].map(|squares| (squares / f64::max(places, 1.0)).sqrt())
}

#[cfg(test)]
#[path = "repeat_tests.rs"]
mod tests;
