//! The record of a commissioning: which steps are done, and every value with its origin. It is
//! written whole after each step, so a run that is killed goes on where it stopped.

use super::StepError;
use fivebar_report::output::write_in;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// The record's file in its folder.
const RECORD: &str = "record.json";
/// The robot file with what was measured so far, in the same folder.
const ROBOT: &str = "robot.toml";
/// What the simulated arm itself went through, in the same folder.
const SIMULATED: &str = "simulated.json";

/// A measured value.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Value {
    /// Its name, with the unit at its end.
    pub(super) name: String,
    /// The value.
    pub(super) value: f64,
    /// Its standard deviation; none if it was not estimated.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) sd: Option<f64>,
    /// How it was found.
    pub(super) origin: String,
}

impl Value {
    /// A value without a deviation.
    pub(super) fn new(name: impl Into<String>, value: f64, origin: &str) -> Self {
        Self {
            name: name.into(),
            value,
            sd: None,
            origin: origin.into(),
        }
    }

    /// The same with a standard deviation.
    pub(super) fn with_sd(self, sd: f64) -> Self {
        Self {
            sd: sd.is_finite().then_some(sd),
            ..self
        }
    }
}

/// A step that is done.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Done {
    /// The step's name.
    pub(crate) step: String,
    /// The day on which it was done (UTC).
    pub(crate) date: String,
    /// What was found, as a sentence.
    pub(crate) found: String,
    /// What was measured.
    pub(super) values: Vec<Value>,
    /// Whether it changed the robot file.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub(super) in_robot_file: bool,
    /// Whether this arm has nothing that the step could measure.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub(crate) left_out: bool,
}

impl Done {
    /// The sign before what was found: of a step that was done, or left out.
    pub(crate) fn sign(&self) -> &'static str {
        if self.left_out { "–" } else { "✓" }
    }
}

/// The whole record.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Record {
    /// The robot, as the user named it.
    robot: String,
    /// A checksum of its file as it was at the beginning.
    robot_file: u64,
    /// The steps, in the order in which they were done.
    pub(super) steps: Vec<Done>,
    #[serde(skip)]
    folder: PathBuf,
}

impl Record {
    /// The record in `folder`; a new one for this robot if there is none.
    ///
    /// # Errors
    /// The folder holds something else, or the record of another robot.
    pub(super) fn open(folder: &Path, robot: &str, text: &str) -> Result<Self, StepError> {
        let path = folder.join(RECORD);
        let shown = path.display();
        let sum = checksum(text);
        if !path.exists() {
            if folder.join(ROBOT).exists() {
                return Err(StepError::other(format_args!(
                    "{} has a {ROBOT} and no {RECORD}: give another folder with --out",
                    folder.display()
                )));
            }
            return Ok(Self {
                robot: robot.into(),
                robot_file: sum,
                steps: Vec::new(),
                folder: folder.into(),
            });
        }
        let read = std::fs::read_to_string(&path)
            .map_err(|error| StepError::other(format_args!("cannot read {shown}: {error}")))?;
        let mut record: Self = serde_json::from_str(&read).map_err(|error| {
            StepError::other(format_args!(
                "{shown} is no record of a commissioning: {error}; nothing was changed"
            ))
        })?;
        if record.robot_file != sum {
            return Err(StepError::other(format_args!(
                "{shown} is the record of another robot file ({}), or that file has changed since: \
                 give another folder with --out; nothing was changed",
                record.robot
            )));
        }
        record.folder = folder.into();
        let measured = record.steps.iter().find(|done| done.in_robot_file);
        if let Some(done) = measured.filter(|_| !record.robot_path().exists()) {
            return Err(StepError::other(format_args!(
                "{} is not there, although step {} of {shown} changed it: put it back, or begin again in \
                 another folder with --out",
                record.robot_path().display(),
                done.step
            )));
        }
        Ok(record)
    }

    /// Which of the files there are, for the user.
    pub(super) fn files(&self) -> String {
        let folder = self.folder.display();
        let is_there = |name| self.folder.join(name).is_file();
        match (is_there(RECORD), is_there(ROBOT)) {
            (true, true) => format!("the record and robot.toml are in {folder}"),
            (true, false) => format!(
                "the record is in {folder}; robot.toml comes with the first step that measures a value of it"
            ),
            (false, _) => {
                format!("{folder} has no record yet; each step that is done is written there")
            }
        }
    }

    /// The robot file with what was measured so far; none before the first measured value.
    pub(super) fn robot_text(&self) -> Result<Option<String>, StepError> {
        let path = self.robot_path();
        if !path.exists() {
            return Ok(None);
        }
        std::fs::read_to_string(&path).map(Some).map_err(|error| {
            StepError::other(format_args!("cannot read {}: {error}", path.display()))
        })
    }

    /// Where the touched holes are.
    pub(super) fn holes_path(&self) -> PathBuf {
        self.folder.join("holes.csv")
    }

    /// Where the robot file with what was measured is.
    pub(super) fn robot_path(&self) -> PathBuf {
        self.folder.join(ROBOT)
    }

    /// The step, if it is done.
    pub(super) fn done(&self, step: &str) -> Option<&Done> {
        self.steps.iter().find(|done| done.step == step)
    }

    /// The place of the touched plate in the arm's frame as measured: x, y [m], φ [rad]. A point C
    /// of the arm is R(φ) C + (x, y) on the plate. Zeros before the geometry is measured.
    pub(super) fn placement(&self) -> [f64; 3] {
        ["plate_x_m", "plate_y_m", "plate_phi_rad"].map(|name| {
            let mut values = self.steps.iter().flat_map(|done| &done.values);
            // A later step may know better.
            values
                .rfind(|value| value.name == name)
                .map_or(0.0, |value| value.value)
        })
    }

    /// Forgets this step and those after it.
    pub(super) fn forget_from(&mut self, steps: &[&str]) {
        self.steps
            .retain(|done| !steps.contains(&done.step.as_str()));
    }

    /// Writes the picture of a step, `STEP.svg`.
    pub(super) fn draw(&self, step: &str, picture: &str) -> Result<(), StepError> {
        write_in(&self.folder, &format!("{step}.svg"), picture).map_err(StepError::other)
    }

    /// Writes what the simulated arm went through since this run began.
    pub(super) fn write_simulated(&self, seen: &str) -> Result<(), StepError> {
        write_in(&self.folder, SIMULATED, seen).map_err(StepError::other)
    }

    /// Writes the robot file, then the record with this step. Killed between the two, the next run
    /// does the step again.
    pub(super) fn add(&mut self, done: Done, robot: Option<&str>) -> Result<(), StepError> {
        if let Some(text) = robot {
            write_in(&self.folder, ROBOT, text).map_err(StepError::other)?;
        }
        self.steps.push(done);
        let text = serde_json::to_string_pretty(self).map_err(StepError::other)?;
        write_in(&self.folder, RECORD, text + "\n").map_err(StepError::other)
    }
}

/// FNV-1a over the bytes of a text.
fn checksum(text: &str) -> u64 {
    text.bytes().fold(0xcbf2_9ce4_8422_2325, |sum, byte| {
        (sum ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    })
}
