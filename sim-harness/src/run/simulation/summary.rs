//! What a run comes to, in the words of its JSON.

use fivebar_firmware::safety::Fault;
use serde::Serialize;

/// How far the tool was from its reference, over all ticks of the job.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct TipError {
    /// Root of the mean square [m].
    pub rms_m: f64,
    /// Greatest [m].
    pub max_m: f64,
}

/// A run in figures: `summary.json`, and the last line of `--json`.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Summary {
    /// The robot's name.
    pub robot: String,
    /// The scenario's or the job's name.
    pub scenario: String,
    /// Simulated time [s].
    pub simulated_s: f64,
    /// Time the run took [s].
    pub wall_s: f64,
    /// Ticks of the controller.
    pub ticks: u64,
    /// How far the tool was from its reference.
    pub tip_error: TipError,
    /// The same for the same run under PD alone, where it was made.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pd_tip_error: Option<TipError>,
    /// Greatest torque of each motor, at its joint [N·m].
    pub peak_torque_nm: [f64; 2],
    /// Ticks in which a torque was limited.
    pub saturated_ticks: u64,
    /// Faults raised, by name.
    pub faults: Vec<String>,
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
    /// Simulated time per time taken, to two digits or more.
    pub fn speed(&self) -> String {
        let speed = self.simulated_s / self.wall_s;
        let decimals = if speed < 10.0 { 2 } else { 0 };
        format!("{speed:.decimals$}")
    }

    /// How many times as large the tip error is under PD; none where a fault cut the run
    /// short, so that there is too little to compare.
    pub fn times_as_large(&self, pd: TipError) -> Option<f64> {
        let is_whole = self.faults.is_empty() && self.tip_error.rms_m > 0.0;
        is_whole.then(|| pd.rms_m / self.tip_error.rms_m)
    }
}
