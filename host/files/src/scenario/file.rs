//! The scenario file: its keys and its reading.

use super::fault_entry::FaultEntry;
use super::{ControlLaw, Scenario, ScenarioError, wiring};
use crate::job::{self, JobOptions, JobReader};
use crate::refusal::Key;
use crate::robot::{BuiltIn, Robot};
use crate::source::{FileError, Source};
use crate::text_file;
use fivebar_plant::{Mismatch, PlantFault, Wiring};
use serde::Deserialize;
use std::io;
use std::path::{Path, PathBuf};

/// The whole file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct ScenarioFile {
    /// The scenario's name; none: the name of the file.
    name: Option<String>,
    /// A built-in robot, or a robot file relative to this file's folder.
    #[serde(default = "default_robot")]
    robot: String,
    /// The arm that the mismatch changes, named like the robot; none: the robot.
    arm: Option<String>,
    /// The G-code file, relative to this file's folder.
    job: String,
    /// The position of the job's (0, 0) [m].
    origin: Option<[f64; 2]>,
    /// Metres in the plane per metre in the job.
    #[serde(default = "one")]
    scale: f64,
    /// Seed of all pseudo-random numbers of the run.
    #[serde(default = "first")]
    seed: u64,
    /// Whether control is by computed torque; else by a PID at each joint with
    /// feed-forward of acceleration and friction.
    #[serde(default = "yes")]
    computed_torque: bool,
    /// How the arm differs from the controller's model.
    #[serde(default)]
    mismatch: Mismatch,
    /// Mistakes in the wiring.
    #[serde(default)]
    wiring: Wiring,
    /// The faults to inject.
    #[serde(default)]
    fault: Vec<FaultEntry>,
}

fn default_robot() -> String {
    BuiltIn::DEFAULT.into()
}
fn one() -> f64 {
    1.0
}
fn first() -> u64 {
    1
}
fn yes() -> bool {
    true
}

/// Refuses what is not simulated on an arm of this kind.
fn check_kind(source: &Source<'_>, file: &ScenarioFile, robot: &Robot) -> Result<(), FileError> {
    let (name, drives) = if robot.has_steppers() {
        (file.mismatch.effect_without_steppers(), "steppers")
    } else if robot.hobby_servos().is_some() {
        (file.mismatch.effect_without_steppers(), "hobby servos")
    } else if robot.can_drives().is_some() {
        (
            file.mismatch.effect_without_torque_drives(),
            "drives on a CAN bus",
        )
    } else {
        return Ok(());
    };
    let reason =
        format!("is simulated on brushed motors only, and this arm has {drives}: leave it out");
    if let Some(name) = name {
        return Err(source.refuse(Key::In("mismatch", name), reason));
    }
    let of_pulleys = file.mismatch.effect_of_pulleys();
    if let Some(name) = of_pulleys.filter(|_| robot.hobby_servos().is_some()) {
        let reason =
            "is of a belt between motor and joint, and a hobby servo has none: leave it out";
        return Err(source.refuse(Key::In("mismatch", name), reason));
    }
    Ok(())
}

impl Scenario {
    /// Reads a scenario file with its robot and job.
    ///
    /// # Errors
    /// A file that cannot be read, or a key or a value that is not valid.
    pub fn load(path: &str) -> Result<Self, ScenarioError> {
        let text = read(path)?;
        let source = Source::new(path, &text);
        let file: ScenarioFile = source.parse().map_err(|error| {
            if Robot::parse(path, &text).is_err() {
                return error;
            }
            let reason = format!("this is a robot file, no scenario: give it as --robot {path}");
            FileError {
                line: None,
                reason,
                ..error
            }
        })?;
        check(&source, &file)?;
        let (mut initial_faults, mut faults) = (Vec::new(), Vec::new());
        for (index, entry) in file.fault.iter().enumerate() {
            match entry.fault(&source, index)? {
                (None, kind) => initial_faults.push(kind),
                (Some(at), kind) => faults.push(PlantFault { at, kind }),
            }
        }
        let load = |name: &str| match BuiltIn::find(name) {
            Some(built_in) => built_in.robot(),
            None => Robot::load(&beside(path, name)),
        };
        let robot = load(&file.robot)?;
        let arm = file.arm.as_deref().map(load).transpose()?;
        if let Some(arm) = &arm
            && arm.drive_kind() != robot.drive_kind()
        {
            let reason = format!(
                "`{}` and the robot `{}` have drives of different kinds",
                arm.name, robot.name
            );
            return Err(source.refuse(Key::Top("arm"), reason).into());
        }
        if let Ok(parameters) = arm.as_ref().unwrap_or(&robot).plant_parameters() {
            let fits = file.mismatch.check_for(&parameters);
            fits.map_err(|invalid| source.refuse(Key::In("mismatch", invalid.name), invalid))?;
            check_kind(&source, &file, &robot)?;
            wiring::check_for(&file.wiring, &robot, &source)?;
            for (index, entry) in file.fault.iter().enumerate() {
                entry.check_for(&parameters, &robot, &source, index)?;
            }
        }
        let job_file = beside(path, &file.job);
        let job_text = read_job(&job_file)?;
        Ok(Self {
            reader: JobReader::default(),
            name: file.name.unwrap_or_else(|| stem(path)),
            robot,
            arm,
            job_file,
            job_text,
            origin: file.origin,
            scale: file.scale,
            turn: 0.0,
            anywhere: false,
            margin: 0.0,
            from_line: None,
            options: JobOptions::default(),
            seed: file.seed,
            mismatch: file.mismatch,
            wiring: file.wiring,
            clearance: None,
            initial_faults,
            faults,
            control_law: ControlLaw::from_key(file.computed_torque),
            time_optimal: None,
            tolerance: None,
        })
    }

    /// A scenario with the job of a G-code file, or of the standard input if the path is `-`, and the
    /// declared mismatch.
    ///
    /// # Errors
    /// A file that cannot be read.
    pub fn of_job(path: &str, robot: Robot) -> Result<Self, ScenarioError> {
        let text = read_job(path)?;
        if path == text_file::STANDARD_INPUT {
            return Ok(Self::new("standard input", robot, "standard input", text));
        }
        Ok(Self::new(&stem(path), robot, path, text))
    }
}

fn check(source: &Source<'_>, file: &ScenarioFile) -> Result<(), FileError> {
    if !(file.scale > 0.0 && file.scale.is_finite()) {
        let reason = format!("must be a positive finite number, not {:?}", file.scale);
        return Err(source.refuse(Key::Top("scale"), reason));
    }
    if let Some([x, y]) = file.origin
        && !(x.is_finite() && y.is_finite())
    {
        let reason = format!("must be finite, not [{x:?}, {y:?}]");
        return Err(source.refuse(Key::Top("origin"), reason));
    }
    file.wiring
        .check()
        .map_err(|(name, reason)| source.refuse(Key::In("wiring", name), reason))?;
    file.mismatch
        .check()
        .map_err(|invalid| source.refuse(Key::In("mismatch", invalid.name), invalid))
}

/// The path of a file that `file` names relative to its own folder.
fn beside(file: &str, named: &str) -> String {
    let folder = Path::new(file)
        .parent()
        .map_or_else(PathBuf::new, Path::to_path_buf);
    folder.join(named).to_string_lossy().into_owned()
}

fn stem(path: &str) -> String {
    let stem = Path::new(path).file_stem().unwrap_or_default();
    stem.to_string_lossy().into_owned()
}

fn read(path: &str) -> Result<String, ScenarioError> {
    text_file::read_text(path.as_ref(), text_file::LARGEST_TOML)
        .map_err(|source| unread(path, source))
}

fn read_job(path: &str) -> Result<String, ScenarioError> {
    job::read(Path::new(path)).map_err(|source| unread(path, source))
}

fn unread(file: &str, source: io::Error) -> ScenarioError {
    ScenarioError::Read {
        file: file.into(),
        source,
    }
}
