//! The runs of the study.

use super::Prediction;
use crate::study::accuracy::AccuracyStudyError;
use fivebar_files::job::Job;
use fivebar_files::robot::Robot;
use fivebar_files::scenario::Scenario;
use fivebar_sim::simulation::{Record, RunError, Sample, Simulate, Summary, TipError, Trace};
use rayon::prelude::*;

/// The run of one arm, with its prediction.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// Radial clearance of the joints A to E [m].
    pub clearance: [f64; 5],
    /// The figures of the run.
    pub summary: Summary,
    /// The record of the run.
    pub record: Record,
    /// The error that the clearance adds on the job's path: the distance between this arm's
    /// error vector and the new arm's at the same time of the job.
    pub added: TipError,
    /// The part of it due to the pins: the distance of the tool from its position in an ideal
    /// arm with the same angles of the driven links.
    pub by_pins: TipError,
    /// The prediction of the models without contact.
    pub prediction: Prediction,
}

impl Outcome {
    /// The greatest clearance of the joints [m].
    pub fn largest_clearance(&self) -> f64 {
        self.clearance.iter().copied().fold(0.0, f64::max)
    }

    /// The share of the job that each joint spends without contact; 0 for a joint that is not
    /// worn.
    pub fn flight_share(&self) -> [f64; 5] {
        let joints = &self.record.joints;
        joints
            .total
            .map(|joint| joint.flight_time / joints.duration.max(f64::MIN_POSITIVE))
    }
}

/// The runs with their names.
#[derive(Clone, Debug)]
pub struct ClearanceStudy {
    /// The robot's name.
    pub robot: String,
    /// The scenario's name.
    pub scenario: String,
    /// The runs: the new arm first, then the worn ones.
    pub outcomes: Vec<Outcome>,
}

/// Why a study of wear has no result.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ClearanceStudyError {
    /// The run with these clearances was refused or ended early.
    #[error("with clearances of {clearance:?} m: {error}")]
    Run {
        /// Radial clearances of the joints A to E [m].
        clearance: [f64; 5],
        /// The reason.
        error: Box<RunError>,
    },
    /// The models without contact cannot analyse the job.
    #[error(transparent)]
    Prediction(#[from] AccuracyStudyError),
}

/// Runs a scenario with ideal joints and with each of these clearances [m], on all cores.
/// Calls `done` after each run.
///
/// # Errors
/// The run that failed and the reason. Faults are part of the outcome.
pub fn study(
    scenario: &Scenario,
    job: &Job,
    clearances: &[[f64; 5]],
    done: &(dyn Fn() + Sync),
) -> Result<ClearanceStudy, ClearanceStudyError> {
    let runs: Vec<[f64; 5]> = std::iter::once([0.0; 5])
        .chain(clearances.iter().copied())
        .collect();
    let outcomes: Result<Vec<Outcome>, ClearanceStudyError> = runs
        .into_par_iter()
        .map(|clearance| {
            let outcome = run(scenario, job, clearance);
            done();
            outcome
        })
        .collect();
    let mut outcomes = outcomes?;
    if let Some((new, worn)) = outcomes.split_first_mut() {
        for outcome in worn {
            outcome.added = added(&new.record.trace, on_path(&outcome.record.trace, job));
        }
    }
    Ok(ClearanceStudy {
        robot: scenario.robot.name.clone(),
        scenario: scenario.name.clone(),
        outcomes,
    })
}

fn run(
    scenario: &Scenario,
    job: &Job,
    clearance: [f64; 5],
) -> Result<Outcome, ClearanceStudyError> {
    let worn = Scenario {
        clearance: Some(clearance),
        ..scenario.clone()
    };
    let refused = |error| ClearanceStudyError::Run {
        clearance,
        error: Box::new(error),
    };
    let (summary, record) = worn.simulate(job, &mut |_| ()).map_err(refused)?;
    Ok(Outcome {
        clearance,
        summary,
        added: TipError::default(),
        by_pins: by_pins(&scenario.robot, on_path(&record.trace, job)),
        record,
        prediction: Prediction::of(&scenario.robot, job, clearance)?,
    })
}

/// The tool's error vector [m].
fn error(sample: &Sample) -> [f64; 2] {
    [0, 1].map(|axis| sample.tool[axis] - sample.reference[axis])
}

/// Root mean square and greatest of these distances [m].
fn over(distances: impl Iterator<Item = f64>) -> TipError {
    let (mut squares, mut count, mut most) = (0.0, 0_u32, 0.0_f64);
    for distance in distances {
        squares += distance * distance;
        count += 1;
        most = most.max(distance);
    }
    TipError {
        rms_m: (squares / f64::from(count.max(1))).sqrt(),
        max_m: most,
    }
}

/// The samples on the job's path, without the motion from home to its beginning, which the
/// predictions leave out too.
fn on_path<'a>(trace: &'a Trace, job: &Job) -> impl Iterator<Item = &'a Sample> {
    let beginning = job.steps.first().map_or(0, |step| step.line);
    trace
        .samples()
        .iter()
        .filter(move |sample| sample.line > beginning)
}

/// The distances between the error vectors of two runs at the same times.
fn added<'a>(new: &Trace, worn: impl Iterator<Item = &'a Sample>) -> TipError {
    over(worn.filter_map(|sample| {
        let after = new.samples().partition_point(|s| s.time < sample.time);
        let (ours, theirs) = (error(sample), error(new.samples().get(after)?));
        Some((ours[0] - theirs[0]).hypot(ours[1] - theirs[1]))
    }))
}

/// The distances of the tool from its position in an ideal arm with the same driven angles.
fn by_pins<'a>(robot: &Robot, samples: impl Iterator<Item = &'a Sample>) -> TipError {
    let Ok(home) = robot.home_pose() else {
        return TipError::default();
    };
    over(samples.filter_map(|sample| {
        let [theta1, theta4] = sample.angle;
        let pose = robot.geometry.forward(theta1, theta4, home.assembly());
        let [x, y] = robot.tool_at(&pose.ok()?);
        Some((sample.tool[0] - x).hypot(sample.tool[1] - y))
    }))
}
