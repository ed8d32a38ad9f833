//! The robot, as Python holds it.

use crate::error;
use fivebar_files::robot::{BUILT_IN, Robot as Described, text_of};
use fivebar_kinematics::five_bar::{Geometry, Side};
use fivebar_report::study::accuracy::without_tolerance;
use pyo3::prelude::*;

/// A robot as its file describes it, checked.
#[pyclass(frozen, module = "fivebar._native")]
pub(crate) struct Robot {
    pub(crate) described: Described,
    /// Its file's name and text.
    pub(crate) file: String,
    pub(crate) text: String,
}

impl Robot {
    pub(crate) fn geometry(&self) -> &Geometry<f64> {
        &self.described.geometry
    }
}

#[pymethods]
impl Robot {
    /// A built-in robot, or else a file.
    #[staticmethod]
    pub(crate) fn load(py: Python<'_>, name_or_path: &str) -> PyResult<Self> {
        let text = text_of(name_or_path);
        let text = text.map_err(|refusal| error::file(py, &refusal))?;
        Self::parse(py, name_or_path, &text)
    }

    /// The robot that `text` describes; `file` is the file's name in errors.
    #[staticmethod]
    fn parse(py: Python<'_>, file: &str, text: &str) -> PyResult<Self> {
        let described = Described::parse(file, text);
        let described = described.map_err(|refusal| error::file(py, &refusal))?;
        Ok(Self {
            described,
            file: file.into(),
            text: text.into(),
        })
    }

    /// Its file's name in errors.
    #[getter]
    fn file(&self) -> &str {
        &self.file
    }

    /// The text of its file.
    #[getter]
    fn text(&self) -> &str {
        &self.text
    }

    #[getter]
    fn name(&self) -> &str {
        &self.described.name
    }

    /// l1…l4 and the base [m].
    #[getter]
    fn lengths(&self) -> [f64; 5] {
        self.geometry().lengths()
    }

    /// The signs of the working mode of C.
    #[getter]
    fn elbows(&self) -> [i8; 2] {
        let mode = self.described.elbows;
        [sign(mode.elbow1), sign(mode.elbow4)]
    }

    /// The sign of the assembly at home, where the robot has a home.
    #[getter]
    fn assembly(&self) -> Option<i8> {
        let home = self.described.home_pose().ok()?;
        Some(sign(home.assembly()))
    }

    /// θ1, θ4 at the home switches [rad].
    #[getter]
    fn home(&self) -> [f64; 2] {
        self.described.home
    }

    /// Least and greatest θ1, then θ4 [rad].
    #[getter]
    fn joint_limits(&self) -> [[f64; 2]; 2] {
        self.described.limits.angle
    }

    /// The tool from C, along link 2 and to its left [m].
    #[getter]
    fn tool_offset(&self) -> [f64; 2] {
        self.described.tool.offset
    }

    /// Why its accuracy has no deviations, if its file has no tolerances.
    #[getter]
    fn without_tolerance(&self) -> Option<String> {
        without_tolerance(&self.described).map(|reason| format!("{}: {reason}", self.file))
    }

    #[getter]
    fn has_masses(&self) -> bool {
        self.described.arm().is_ok()
    }
}

/// The names of the robots that come with the package; the first is the default.
#[pyfunction]
pub(crate) fn built_in() -> Vec<&'static str> {
    BUILT_IN.iter().map(|robot| robot.name).collect()
}

/// +1 for left, −1 for right: the sign of the cross product.
pub(crate) fn sign(side: Side) -> i8 {
    match side {
        Side::Left => 1,
        Side::Right => -1,
    }
}
