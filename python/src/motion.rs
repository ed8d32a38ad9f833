//! Forward and inverse velocities and accelerations; each row is a state.

use crate::batch::Field::{Number, Pair, Sign};
use crate::batch::{Answer, Argument as _, MATRIX, Pairs, Signs, common, solve};
use crate::positions::number;
use crate::robot::Robot;
use crate::status::Problem;
use fivebar_kinematics::five_bar::{Accelerations, Pose, Velocities};
use nalgebra::Vector2;
use pyo3::prelude::*;

/// A pose with all velocities and accelerations.
pub(crate) struct Motion {
    pub(crate) pose: Pose<f64>,
    pub(crate) velocities: Velocities<f64>,
    pub(crate) accelerations: Accelerations<f64>,
}

/// θ, ω, α of the driven joints to C, ṙC, r̈C, ω2, ω3, α2, α3, and the tool with its velocity and acceleration.
#[pyfunction]
pub(crate) fn motion<'py>(
    py: Python<'py>,
    robot: &Robot,
    theta: Pairs<'py>,
    omega: Pairs<'py>,
    alpha: Pairs<'py>,
    assembly: Signs<'py>,
) -> PyResult<Answer<'py>> {
    let tool = robot.tool(py)?;
    let count = common([
        theta.count(),
        omega.count(),
        alpha.count(),
        assembly.count(),
    ])?;
    let (theta, assembly) = (theta.rows()?, assembly.rows()?);
    let (omega, alpha) = (omega.rows()?, alpha.rows()?);
    let fields = [
        Pair, Pair, Pair, Number, Number, Number, Number, Pair, Pair, Pair,
    ];
    solve(py, count, &fields, |row| {
        let Motion {
            pose,
            velocities,
            accelerations,
        } = robot.move_joints(theta[row], omega[row], alpha[row], assembly[row])?;
        let [_, omega2, omega3, _] = velocities.omega;
        let [_, alpha2, alpha3, _] = accelerations.alpha;
        let (c, v, a) = (pose.c, velocities.c, accelerations.c);
        let t = tool.point(&pose);
        let tv = tool.velocity(&pose, &velocities);
        let ta = tool.acceleration(&pose, &velocities, &accelerations);
        Ok([
            c.x, c.y, v.x, v.y, a.x, a.y, omega2, omega3, alpha2, alpha3, t.x, t.y, tv.x, tv.y,
            ta.x, ta.y,
        ])
    })
}

/// θ of the driven joints to ∂(x, y)/∂(θ1, θ4) of C, or of the tool.
#[pyfunction]
pub(crate) fn jacobian<'py>(
    py: Python<'py>,
    robot: &Robot,
    theta: Pairs<'py>,
    assembly: Signs<'py>,
    of_tool: bool,
) -> PyResult<Answer<'py>> {
    let tool = robot.tool(py)?;
    let count = common([theta.count(), assembly.count()])?;
    let (theta, assembly) = (theta.rows()?, assembly.rows()?);
    solve(py, count, &[MATRIX], |row| {
        let pose = robot.pose(theta[row], assembly[row])?;
        let mut columns = [Vector2::zeros(); 2];
        for (column, [omega1, omega4]) in columns.iter_mut().zip([[1.0, 0.0], [0.0, 1.0]]) {
            let velocities = robot.geometry().forward_velocities(&pose, omega1, omega4)?;
            *column = match of_tool {
                true => tool.velocity(&pose, &velocities),
                false => velocities.c,
            };
        }
        let [by1, by4] = columns;
        Ok([by1.x, by4.x, by1.y, by4.y])
    })
}

/// The position, velocity and acceleration of C, or of the tool, and the elbows' signs to the angles of
/// links 1, 4, 2 and 3, the assembly, and the links' velocities and accelerations in the same order.
#[allow(clippy::too_many_arguments)]
#[pyfunction]
pub(crate) fn inverse_motion<'py>(
    py: Python<'py>,
    robot: &Robot,
    points: Pairs<'py>,
    velocity: Pairs<'py>,
    acceleration: Pairs<'py>,
    elbow1: Signs<'py>,
    elbow4: Signs<'py>,
    of_tool: bool,
) -> PyResult<Answer<'py>> {
    let placed = robot.placed(py, of_tool)?;
    let count = common([
        points.count(),
        velocity.count(),
        acceleration.count(),
        elbow1.count(),
        elbow4.count(),
    ])?;
    let (points, elbow1, elbow4) = (points.rows()?, elbow1.rows()?, elbow4.rows()?);
    let (velocity, acceleration) = (velocity.rows()?, acceleration.rows()?);
    let mut fields = [Number; 13];
    fields[4] = Sign;
    solve(py, count, &fields, |row| {
        let pose = placed.pose(points[row], elbow1[row], elbow4[row])?;
        let (velocities, accelerations) =
            placed.motion(&pose, velocity[row].into(), acceleration[row].into())?;
        let [t1, t2, t3, t4] = pose.angles();
        let [w1, w2, w3, w4] = velocities.omega;
        let [a1, a2, a3, a4] = accelerations.alpha;
        let assembly = number(pose.assembly());
        Ok([t1, t4, t2, t3, assembly, w1, w4, w2, w3, a1, a4, a2, a3])
    })
}

impl Robot {
    /// The motion of the driven joints, solved.
    pub(crate) fn move_joints(
        &self,
        theta: [f64; 2],
        [omega1, omega4]: [f64; 2],
        [alpha1, alpha4]: [f64; 2],
        assembly: [i8; 1],
    ) -> Result<Motion, Problem> {
        let geometry = self.geometry();
        let pose = self.pose(theta, assembly)?;
        let velocities = geometry.forward_velocities(&pose, omega1, omega4)?;
        let accelerations = geometry.forward_accelerations(&pose, &velocities, alpha1, alpha4)?;
        Ok(Motion {
            pose,
            velocities,
            accelerations,
        })
    }
}
