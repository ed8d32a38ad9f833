//! The simulated arm step by step, with torques at its joints.

use crate::error;
use crate::robot::Robot;
use crate::simulation::{Figure, change};
use fivebar_kinematics::five_bar::{Joint, Side};
use fivebar_plant::{Mismatch, TorquePlant};
use pyo3::prelude::*;
use std::collections::BTreeMap;

/// An arm that makes the torques that it is told.
#[pyclass(module = "fivebar._native")]
pub(crate) struct Plant {
    arm: TorquePlant,
}

#[pymethods]
impl Plant {
    /// At rest at these angles [rad] in this assembly, or else at home.
    #[new]
    fn new(
        py: Python<'_>,
        robot: &Robot,
        theta: Option<[f64; 2]>,
        assembly: i8,
        mismatch: BTreeMap<String, Figure>,
    ) -> PyResult<Self> {
        let described = &robot.described;
        let parameters = described.plant_parameters();
        let parameters = parameters.map_err(|refusal| error::robot(py, refusal))?;
        let pose = match theta {
            Some([theta1, theta4]) => {
                let side = match assembly {
                    1 => Side::Left,
                    _ => Side::Right,
                };
                let pose = robot.geometry().forward(theta1, theta4, side);
                pose.map_err(|refusal| error::pose(py, refusal))?
            }
            None => {
                let pose = described.home_pose();
                pose.map_err(|refusal| error::robot(py, refusal))?
            }
        };
        let mut differs = Mismatch::NONE;
        change(&mut differs, mismatch)?;
        let arm = TorquePlant::new(&parameters, &differs, &pose);
        Ok(Self { arm })
    }

    /// Advances by `time` [s] with these torques at the joints [N·m] and this force on the tool [N].
    /// After an error its state is that of before.
    fn step(
        &mut self,
        py: Python<'_>,
        torque: [f64; 2],
        time: f64,
        force: [f64; 2],
    ) -> PyResult<()> {
        self.arm.set_tool_force(force.into());
        let done = self.arm.step(torque, time);
        done.map_err(|refusal| error::stopped(py, refusal))
    }

    /// θ1, θ4 [rad].
    #[getter]
    fn theta(&self) -> [f64; 2] {
        Joint::ALL.map(|joint| self.arm.angle(joint))
    }

    /// ω1, ω4 [rad/s].
    #[getter]
    fn omega(&self) -> [f64; 2] {
        Joint::ALL.map(|joint| self.arm.velocity(joint))
    }

    /// The tool's position [m].
    #[getter]
    fn tool(&self) -> [f64; 2] {
        self.arm.tool().into()
    }

    /// Since the start [s].
    #[getter]
    fn time(&self) -> f64 {
        self.arm.time()
    }
}
