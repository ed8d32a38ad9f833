//! Errors as the exceptions of `fivebar._errors`, with their attributes.

use fivebar_files::job::JobError;
use fivebar_files::scenario::{ModeChangeError, ScenarioError, place_in_job};
use fivebar_files::source::FileError;
use fivebar_kinematics::five_bar::PoseError;
use fivebar_sim::link::TargetError;
use fivebar_sim::simulation::RunError;
use pyo3::call::PyCallArgs;
use pyo3::prelude::*;
use std::fmt::Display;
use std::io;

/// The exception of that name, made from its arguments.
fn raise<'py>(py: Python<'py>, name: &str, arguments: impl PyCallArgs<'py>) -> PyErr {
    py.import("fivebar._errors")
        .and_then(|module| module.getattr(name))
        .and_then(|class| class.call1(arguments))
        .map_or_else(|error| error, PyErr::from_value)
}

/// A refused robot or scenario file, with its line.
pub(crate) fn file(py: Python<'_>, error: &FileError) -> PyErr {
    let FileError { file, line, .. } = error;
    raise(py, "RobotError", (error.to_string(), file, line))
}

/// An argument that is not valid.
pub(crate) fn invalid(py: Python<'_>, reason: String) -> PyErr {
    raise(py, "FivebarError", (reason,))
}

/// A robot that lacks data that the call needs.
pub(crate) fn robot(py: Python<'_>, error: impl Display) -> PyErr {
    raise(py, "RobotError", (error.to_string(),))
}

/// Angles at which the arm cannot be.
pub(crate) fn pose(py: Python<'_>, error: PoseError) -> PyErr {
    let kind = match error {
        PoseError::Unreachable(_) => "UnreachableError",
        PoseError::Singular(_) => "SingularError",
        PoseError::NotFinite => "InvalidError",
    };
    raise(py, kind, (error.to_string(),))
}

/// A study that cannot be done, or the file that describes it.
pub(crate) fn study(py: Python<'_>, error: impl Display) -> PyErr {
    raise(py, "StudyError", (error.to_string(),))
}

/// A simulated motion that cannot go on.
pub(crate) fn stopped(py: Python<'_>, error: impl Display) -> PyErr {
    raise(py, "RunError", (error.to_string(),))
}

/// A controller that refuses, or a connection that ended.
pub(crate) fn controller(py: Python<'_>, error: impl Display) -> PyErr {
    raise(py, "ControllerError", (error.to_string(),))
}

/// A fault that a controller has latched.
pub(crate) fn fault(py: Python<'_>, message: String, name: &str, number: u8) -> PyErr {
    raise(py, "FaultError", (message, name, number))
}

/// A call that its user stopped.
pub(crate) fn stopped_by_user(py: Python<'_>, message: String, line: Option<u32>) -> PyErr {
    raise(py, "StoppedError", (message, line))
}

/// A job that is refused on this line.
pub(crate) fn job(py: Python<'_>, message: String, line: u32) -> PyErr {
    raise(py, "JobError", (message, line))
}

/// A move that cannot be done, and where its path cannot be passed [m].
pub(crate) fn refused_move(
    py: Python<'_>,
    message: String,
    line: u32,
    point: Option<[f32; 2]>,
) -> PyErr {
    raise(py, "JobError", (message, line, point))
}

/// A scenario that cannot be run.
pub(crate) fn scenario(py: Python<'_>, error: ScenarioError) -> PyErr {
    let message = error.to_string();
    match error {
        // By its kind, Python raises FileNotFoundError if there is no such file.
        ScenarioError::Read { source, .. } => io::Error::new(source.kind(), message).into(),
        ScenarioError::File(error) => file(py, &error),
        ScenarioError::Job { error, .. } => match error {
            JobError::Line { line, .. } => raise(py, "JobError", (message, line)),
            _ => raise(py, "JobError", (message,)),
        },
        ScenarioError::HomeError(error) => robot(py, error),
        _ => raise(py, "RunError", (message,)),
    }
}

/// A change of the working mode that cannot be done.
pub(crate) fn mode_change(py: Python<'_>, error: ModeChangeError) -> PyErr {
    let kind = match error {
        ModeChangeError::Place { .. } | ModeChangeError::OtherAssembly { .. } => "UnreachableError",
        ModeChangeError::NoPlanner => "RobotError",
        _ => "SingularError",
    };
    raise(py, kind, (error.to_string(),))
}

/// A run that was refused or stopped.
pub(crate) fn run(py: Python<'_>, job_file: &str, error: RunError) -> PyErr {
    match error {
        RunError::Scenario(error) => scenario(py, error),
        RunError::Target(TargetError::Move(refusal)) => {
            let place = place_in_job(false, refusal.tag);
            let message = format!("{job_file}, {place}: {refusal}");
            raise(py, "JobError", (message, refusal.tag, refusal.point))
        }
        RunError::ModeChange(refused) => {
            let message = format!("{job_file}, {refused}");
            raise(py, "JobError", (message, refused.line))
        }
        RunError::Target(error) => raise(py, "RunError", (error.to_string(),)),
        RunError::MissingMasses(_)
        | RunError::HomeError(_)
        | RunError::ClearanceError(_)
        | RunError::Settings { .. } => robot(py, error),
        _ => raise(py, "RunError", (error.to_string(),)),
    }
}
