//! The results of a run, with the keys of its JSON.

use super::{CauseError, ServoLimits, TipError, Verdict};
use serde::Serialize;

/// The errors of one of the runs of a job that is repeated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct RunErrors {
    /// Whether the job was drawn within the tolerance.
    pub drawn: bool,
    /// RMS tip error, as the arm truly went [m].
    pub rms_m: f64,
    /// Greatest tip error, as the arm truly went [m].
    pub max_m: f64,
    /// What is left of it after the best shift and turn of the whole drawing.
    pub placed: TipError,
    /// As the sensors see it.
    pub sensed: TipError,
}

/// What was learnt from the runs of a job.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct LearningSummary {
    /// Where the filter's gain is a half [Hz].
    pub band_hz: f64,
    /// The greatest factor by which an error shrinks from run to run, from the loop's frequency response.
    pub contraction: f64,
    /// Greatest shift of the way in the best run [m].
    pub shift_max_m: f64,
    /// The last run that was better than the one before by a share worth naming, from 1.
    pub settled: Option<usize>,
    /// Why learning ended before the last run, and its last shift was undone.
    pub undone: Option<String>,
    /// Why what was learnt before was not used.
    pub forgotten: Option<String>,
}

/// The figures of a run: `summary.json`, and the last line with `--json`.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Summary {
    /// The robot's name.
    pub robot: String,
    /// The scenario's or the job's name.
    pub scenario: String,
    /// Whether the job was drawn.
    #[serde(flatten)]
    pub verdict: Verdict,
    /// Simulated time [s].
    pub simulated_s: f64,
    /// Time of the job itself, without homing and pauses around it [s].
    #[serde(skip)]
    pub job_s: Option<f64>,
    /// Real time of the run [s].
    pub wall_s: f64,
    /// Ticks of the controller.
    pub ticks: u64,
    /// The tip error.
    pub tip_error: TipError,
    /// What is left of it after the best shift and turn of the whole drawing, over the trace's samples.
    pub tip_error_placed: TipError,
    /// The tip error of the same run with PID at each joint, if it was made.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pid_tip_error: Option<TipError>,
    /// Greatest torque of each motor, at its joint [N·m].
    pub peak_torque_nm: [f64; 2],
    /// Greatest torque of a motor during the job, as a share of what limits it at its speed: the torque at which a stepper
    /// loses steps, the stall torque of a servo, or the peak torque. None without a job.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub torque_share: Option<f64>,
    /// Ticks in which a torque was limited.
    pub saturated_ticks: u64,
    /// Faults raised, by name.
    pub faults: Vec<String>,
    /// Full steps that each stepper has lost, of the simulated motors themselves; none on an arm without steppers.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lost_steps: Option<[i64; 2]>,
    /// What the servos leave of any drawing; none on an arm without hobby servos.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub hobby_servos: Option<ServoLimits>,
    /// The errors with each mismatch alone, if those runs were made.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub by_cause: Vec<CauseError>,
    /// The runs of a job that is repeated; the rest of the summary is of the best one.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub runs: Vec<RunErrors>,
    /// The same runs with PID at each joint.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub pid_runs: Vec<RunErrors>,
    /// Whether those runs were learnt from.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub pid_learns: bool,
    /// RMS of the part of the sensed error that was the same in all runs, and of the rest [m]; of runs without learning.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub repeats_m: Option<[f64; 2]>,
    /// What was learnt from them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub learning: Option<LearningSummary>,
    /// The folder with the report.
    pub out_dir: String,
}

impl Summary {
    /// Simulated time per real time, to two digits or more.
    pub fn speed(&self) -> String {
        let speed = self.simulated_s / self.wall_s;
        let decimals = if speed < 10.0 { 2 } else { 0 };
        format!("{speed:.decimals$}")
    }

    /// Ratio of the RMS tip error with PID at each joint to this one; none if a fault ended the run
    /// early, because the runs are then not comparable.
    pub fn ratio_to(&self, pid: TipError) -> Option<f64> {
        let is_whole = self.faults.is_empty() && self.tip_error.rms_m > 0.0;
        is_whole.then(|| pid.rms_m / self.tip_error.rms_m)
    }
}
