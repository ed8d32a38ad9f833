//! Inverse and forward dynamics; each row is a state.

use crate::batch::{Answer, common, rows, solve};
use crate::error;
use crate::motion::Motion;
use crate::positions::{self, Numbers, Signs};
use crate::robot::Robot;
use fivebar_design::derivatives::{QUANTITIES, State, VARIABLES, derivatives as derivatives_of};
use fivebar_kinematics::dynamics::Arm;
use nalgebra::Vector2;
use pyo3::prelude::*;

/// θ, ω, α of the driven joints and the force on C to τ, M, h and the reactions in A
/// to E.
#[pyfunction]
#[allow(clippy::too_many_arguments)]
pub(crate) fn inverse_dynamics<'py>(
    py: Python<'py>,
    robot: &Robot,
    theta: Numbers<'py>,
    omega: Numbers<'py>,
    alpha: Numbers<'py>,
    assembly: Signs<'py>,
    external_force: Numbers<'py>,
) -> PyResult<Answer<'py>> {
    let arm = masses(py, robot)?;
    let (theta, assembly) = (rows(&theta)?, rows(&assembly)?);
    let (omega, alpha, force) = (rows(&omega)?, rows(&alpha)?, rows(&external_force)?);
    let count = common([
        theta.len(),
        omega.len(),
        alpha.len(),
        assembly.len(),
        force.len(),
    ])?;
    solve(py, count, &[2, 4, 2, 2, 2, 2, 2, 2], |row| {
        let Motion {
            pose,
            velocities,
            accelerations,
        } = robot.move_joints(theta[row], omega[row], alpha[row], assembly[row])?;
        let force = vec2(force[row]);
        let [t1, t4] = arm.inverse_dynamics(&pose, &velocities, &accelerations, force)?;
        let m = arm.mass_matrix(&pose)?;
        let [h1, h4] = arm.nonlinear_effects(&pose, &velocities, force)?;
        let r = arm.reactions(&pose, &velocities, &accelerations, force)?;
        Ok([
            t1, t4, m.m11, m.m12, m.m21, m.m22, h1, h4, r.a.x, r.a.y, r.b.x, r.b.y, r.c.x, r.c.y,
            r.d.x, r.d.y, r.e.x, r.e.y,
        ])
    })
}

/// θ, ω of the driven joints, τ and the force on C to α1, α4.
#[pyfunction]
#[allow(clippy::too_many_arguments)]
pub(crate) fn forward_dynamics<'py>(
    py: Python<'py>,
    robot: &Robot,
    theta: Numbers<'py>,
    omega: Numbers<'py>,
    torque: Numbers<'py>,
    assembly: Signs<'py>,
    external_force: Numbers<'py>,
) -> PyResult<Answer<'py>> {
    let arm = masses(py, robot)?;
    let (theta, assembly) = (rows(&theta)?, rows(&assembly)?);
    let (omega, torque, force) = (rows(&omega)?, rows(&torque)?, rows(&external_force)?);
    let count = common([
        theta.len(),
        omega.len(),
        torque.len(),
        assembly.len(),
        force.len(),
    ])?;
    solve(py, count, &[1, 1], |row| {
        let pose = robot.pose(theta[row], assembly[row])?;
        let [omega1, omega4] = omega[row];
        let velocities = robot.geometry().forward_velocities(&pose, omega1, omega4)?;
        let force = vec2(force[row]);
        Ok(arm.forward_dynamics(&pose, &velocities, torque[row], force)?)
    })
}

/// θ, ω, α of the driven joints to C, its velocity and acceleration and the torques, with their first and second
/// derivatives, in the order of `derivatives::VARIABLE_NAMES`.
#[pyfunction]
pub(crate) fn derivatives<'py>(
    py: Python<'py>,
    robot: &Robot,
    theta: Numbers<'py>,
    omega: Numbers<'py>,
    alpha: Numbers<'py>,
    assembly: Signs<'py>,
) -> PyResult<Answer<'py>> {
    let arm = masses(py, robot)?;
    let (theta, assembly) = (rows(&theta)?, rows(&assembly)?);
    let (omega, alpha) = (rows(&omega)?, rows(&alpha)?);
    let count = common([theta.len(), omega.len(), alpha.len(), assembly.len()])?;
    const FIRST: usize = QUANTITIES * VARIABLES;
    const ALL: usize = QUANTITIES + FIRST + FIRST * VARIABLES;
    solve(py, count, &[QUANTITIES, FIRST, FIRST * VARIABLES], |row| {
        let [side] = assembly[row];
        let state = State {
            theta: theta[row],
            omega: omega[row],
            alpha: alpha[row],
            assembly: positions::side(side)?,
        };
        let found = derivatives_of(arm, &state)?;
        let first = found.first.as_flattened();
        let second = found.second.as_flattened().as_flattened();
        let mut numbers = [0.0; ALL];
        let all = found.value.iter().chain(first).chain(second);
        for (number, value) in numbers.iter_mut().zip(all) {
            *number = *value;
        }
        Ok(numbers)
    })
}

fn masses<'a>(py: Python<'_>, robot: &'a Robot) -> PyResult<&'a Arm<f64>> {
    let arm = robot.described.arm();
    arm.map_err(|unknown| error::robot(py, unknown))
}

fn vec2([x, y]: [f64; 2]) -> Vector2<f64> {
    Vector2::new(x, y)
}
