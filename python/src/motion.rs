//! Forward and inverse velocities and accelerations; each row is a state.

use crate::batch::Field::{Number, Pair, Sign};
use crate::batch::{Answer, Argument as _, Pairs, Signs, common, solve};
use crate::positions::number;
use crate::robot::Robot;
use crate::status::Problem;
use fivebar_kinematics::five_bar::{Accelerations, Pose, Velocities};
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

/// The position, velocity and acceleration of C, or of the tool, and the elbows' signs to the angles, velocities and accelerations of
/// links 1 to 4, and the assembly.
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
    fields[12] = Sign;
    solve(py, count, &fields, |row| {
        let pose = placed.pose(points[row], elbow1[row], elbow4[row])?;
        let (velocities, accelerations) =
            placed.motion(&pose, velocity[row].into(), acceleration[row].into())?;
        let [t1, t2, t3, t4] = pose.angles();
        let [w1, w2, w3, w4] = velocities.omega;
        let [a1, a2, a3, a4] = accelerations.alpha;
        let assembly = number(pose.assembly());
        Ok([t1, t2, t3, t4, w1, w2, w3, w4, a1, a2, a3, a4, assembly])
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
