//! The results of a run, with the keys of its JSON.

use super::CauseError;
use fivebar_firmware::safety::Fault;
use serde::Serialize;

/// The tip error over all ticks of the job.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct TipError {
    /// Root mean square [m].
    pub rms_m: f64,
    /// Greatest value [m].
    pub max_m: f64,
}

/// The figures of a run: `summary.json`, and the last line with `--json`.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Summary {
    /// The robot's name.
    pub robot: String,
    /// The scenario's or the job's name.
    pub scenario: String,
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
    /// The tip error of the same run with PID at each joint, if it was made.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pid_tip_error: Option<TipError>,
    /// Greatest torque of each motor, at its joint [N·m].
    pub peak_torque_nm: [f64; 2],
    /// Ticks in which a torque was limited.
    pub saturated_ticks: u64,
    /// Faults raised, by name.
    pub faults: Vec<String>,
    /// The errors with each mismatch alone, if those runs were made.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub by_cause: Vec<CauseError>,
    /// The folder with the report.
    pub out_dir: String,
}

/// A fault's name in words: "encoder jump".
pub fn fault_name(fault: Fault) -> String {
    let mut name = String::new();
    for letter in format!("{fault:?}").chars() {
        if letter.is_uppercase() && !name.is_empty() {
            name.push(' ');
        }
        name.extend(letter.to_lowercase());
    }
    name
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
