//! Inverse and forward dynamics; each row is a state.

use crate::batch::Field::{Number, Pair};
use crate::batch::{Answer, Argument as _, Field, MATRIX, Pairs, Signs, common, solve};
use crate::error;
use crate::motion::Motion;
use crate::positions;
use crate::robot::Robot;
use crate::status::Problem;
use fivebar_design::derivatives::{
    QUANTITIES, State, VARIABLES, derivatives as derivatives_of, first_derivatives,
};
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
    theta: Pairs<'py>,
    omega: Pairs<'py>,
    alpha: Pairs<'py>,
    external_force: Pairs<'py>,
    assembly: Signs<'py>,
) -> PyResult<Answer<'py>> {
    let arm = masses(py, robot)?;
    let count = common([
        theta.count(),
        omega.count(),
        alpha.count(),
        assembly.count(),
        external_force.count(),
    ])?;
    let (theta, assembly) = (theta.rows()?, assembly.rows()?);
    let (omega, alpha, force) = (omega.rows()?, alpha.rows()?, external_force.rows()?);
    let fields = [Pair, MATRIX, Pair, Pair, Pair, Pair, Pair, Pair];
    solve(py, count, &fields, |row| {
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
    theta: Pairs<'py>,
    omega: Pairs<'py>,
    torque: Pairs<'py>,
    external_force: Pairs<'py>,
    assembly: Signs<'py>,
) -> PyResult<Answer<'py>> {
    let arm = masses(py, robot)?;
    let count = common([
        theta.count(),
        omega.count(),
        torque.count(),
        assembly.count(),
        external_force.count(),
    ])?;
    let (theta, assembly) = (theta.rows()?, assembly.rows()?);
    let (omega, torque, force) = (omega.rows()?, torque.rows()?, external_force.rows()?);
    solve(py, count, &[Number, Number], |row| {
        let pose = robot.pose(theta[row], assembly[row])?;
        let [omega1, omega4] = omega[row];
        let velocities = robot.geometry().forward_velocities(&pose, omega1, omega4)?;
        let force = vec2(force[row]);
        Ok(arm.forward_dynamics(&pose, &velocities, torque[row], force)?)
    })
}

/// θ, ω, α of the driven joints to C, its velocity and acceleration and the torques, with their first and, if they are
/// wanted, second derivatives, in the order of `derivatives::VARIABLE_NAMES`.
#[pyfunction]
#[allow(clippy::too_many_arguments)]
pub(crate) fn derivatives<'py>(
    py: Python<'py>,
    robot: &Robot,
    theta: Pairs<'py>,
    omega: Pairs<'py>,
    alpha: Pairs<'py>,
    assembly: Signs<'py>,
    second: bool,
) -> PyResult<Answer<'py>> {
    let arm = masses(py, robot)?;
    let count = common([
        theta.count(),
        omega.count(),
        alpha.count(),
        assembly.count(),
    ])?;
    let (theta, assembly) = (theta.rows()?, assembly.rows()?);
    let (omega, alpha) = (omega.rows()?, alpha.rows()?);
    const FIRST: usize = QUANTITIES * VARIABLES;
    const ALL: usize = QUANTITIES + FIRST + FIRST * VARIABLES;
    let state = |row: usize| {
        let [side] = assembly[row];
        Ok::<_, Problem>(State {
            theta: theta[row],
            omega: omega[row],
            alpha: alpha[row],
            assembly: positions::side(side)?,
        })
    };
    let fields = [
        Field::Table(&[QUANTITIES]),
        Field::Table(&[QUANTITIES, VARIABLES]),
        Field::Table(&[QUANTITIES, VARIABLES, VARIABLES]),
    ];
    if !second {
        return solve(py, count, &fields[..2], |row| {
            let (value, first) = first_derivatives(arm, &state(row)?)?;
            let mut numbers = [0.0; QUANTITIES + FIRST];
            let (values, firsts) = numbers.split_at_mut(QUANTITIES);
            values.copy_from_slice(&value);
            firsts.copy_from_slice(first.as_flattened());
            Ok(numbers)
        });
    }
    solve(py, count, &fields, |row| {
        let found = derivatives_of(arm, &state(row)?)?;
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
