//! Forward and inverse positions; each row is a point.

use crate::batch::Field::{Number, Pair, Sign};
use crate::batch::{Answer, Argument as _, Pairs, Signs, common, solve};
use crate::error;
use crate::robot::{Robot, sign};
use crate::status::Problem;
use fivebar_files::scenario::change_of_mode;
use fivebar_firmware::Planner;
use fivebar_kinematics::five_bar::{
    Accelerations, Pose, PoseError, Side, Tool, Velocities, WorkingMode,
};
use nalgebra::Vector2;
use pyo3::prelude::*;

/// C, or the tool, and the elbows' signs to θ1, θ4, θ2, θ3, assembly.
#[pyfunction]
pub(crate) fn inverse<'py>(
    py: Python<'py>,
    robot: &Robot,
    points: Pairs<'py>,
    elbow1: Signs<'py>,
    elbow4: Signs<'py>,
    of_tool: bool,
) -> PyResult<Answer<'py>> {
    let placed = robot.placed(py, of_tool)?;
    let count = common([points.count(), elbow1.count(), elbow4.count()])?;
    let (points, elbow1, elbow4) = (points.rows()?, elbow1.rows()?, elbow4.rows()?);
    solve(py, count, &[Number, Number, Number, Number, Sign], |row| {
        let pose = placed.pose(points[row], elbow1[row], elbow4[row])?;
        let [theta1, theta2, theta3, theta4] = pose.angles();
        Ok([theta1, theta4, theta2, theta3, number(pose.assembly())])
    })
}

/// θ1, θ4 and the assembly's sign to C, θ2, θ3, elbow 1, elbow 4, the tool.
#[pyfunction]
pub(crate) fn forward<'py>(
    py: Python<'py>,
    robot: &Robot,
    theta: Pairs<'py>,
    assembly: Signs<'py>,
) -> PyResult<Answer<'py>> {
    let tool = robot.tool(py)?;
    let count = common([theta.count(), assembly.count()])?;
    let (theta, assembly) = (theta.rows()?, assembly.rows()?);
    solve(
        py,
        count,
        &[Pair, Number, Number, Sign, Sign, Pair],
        |row| {
            let pose = robot.pose(theta[row], assembly[row])?;
            let [_, theta2, theta3, _] = pose.angles();
            let WorkingMode { elbow1, elbow4 } = pose.working_mode();
            let ([x, y], [tool_x, tool_y]) = (pose.c.into(), tool.point(&pose).into());
            let elbows = [number(elbow1), number(elbow4)];
            Ok([x, y, theta2, theta3, elbows[0], elbows[1], tool_x, tool_y])
        },
    )
}

/// θ1, θ4 at the corners of the path from these angles to the working mode of these elbows, with the
/// tool where it is.
#[pyfunction]
pub(crate) fn mode_change(
    py: Python<'_>,
    robot: &Robot,
    theta: [f64; 2],
    elbow1: i8,
    elbow4: i8,
) -> PyResult<Vec<[f64; 2]>> {
    let settings = robot.described.settings();
    let settings = settings.map_err(|refusal| error::robot(py, refusal))?;
    let settings = settings
        .check()
        .map_err(|refusal| error::robot(py, refusal))?;
    let side = |sign: i8| if sign > 0 { Side::Left } else { Side::Right };
    let mode = WorkingMode::new(side(elbow1), side(elbow4));
    let from = theta.map(|angle| angle as f32);
    let corners = change_of_mode(&Planner::new(&settings), from, mode);
    let corners = corners.map_err(|refusal| error::mode_change(py, refusal))?;
    Ok(corners
        .into_iter()
        .map(|corner| corner.map(f64::from))
        .collect())
}

/// An arm of which a point is placed: C, or the tool.
pub(crate) struct Placed(Tool<f64>);

impl Placed {
    /// The pose with the point at a place.
    pub(crate) fn pose(
        &self,
        [x, y]: [f64; 2],
        [elbow1]: [i8; 1],
        [elbow4]: [i8; 1],
    ) -> Result<Pose<f64>, Problem> {
        let mode = WorkingMode::new(side(elbow1)?, side(elbow4)?);
        let point = Vector2::new(x, y);
        Ok(match self.is_c() {
            true => self.0.geometry().inverse(point, mode)?,
            false => self.0.inverse(point, mode)?,
        })
    }

    /// All velocities and accelerations from those of the point [m/s, m/s²].
    pub(crate) fn motion(
        &self,
        pose: &Pose<f64>,
        velocity: Vector2<f64>,
        acceleration: Vector2<f64>,
    ) -> Result<(Velocities<f64>, Accelerations<f64>), PoseError> {
        let (tool, geometry) = (&self.0, self.0.geometry());
        Ok(match self.is_c() {
            true => {
                let velocities = geometry.inverse_velocities(pose, velocity)?;
                let accelerations =
                    geometry.inverse_accelerations(pose, &velocities, acceleration)?;
                (velocities, accelerations)
            }
            false => {
                let velocities = tool.inverse_velocities(pose, velocity)?;
                let accelerations = tool.inverse_accelerations(pose, &velocities, acceleration)?;
                (velocities, accelerations)
            }
        })
    }

    fn is_c(&self) -> bool {
        self.0.offset() == Vector2::zeros()
    }
}

impl Robot {
    /// The tool on its arm.
    pub(crate) fn tool(&self, py: Python<'_>) -> PyResult<Tool<f64>> {
        let tool = self.described.tool_on_link();
        tool.map_err(|refusal| error::robot(py, refusal))
    }

    /// The arm with the point that is placed: the tool, or else C.
    pub(crate) fn placed(&self, py: Python<'_>, of_tool: bool) -> PyResult<Placed> {
        if of_tool {
            return self.tool(py).map(Placed);
        }
        let at_c = Tool::new(*self.geometry(), Vector2::zeros());
        at_c.map(Placed)
            .map_err(|refusal| error::robot(py, refusal))
    }

    /// The pose with the driven joints at their angles.
    pub(crate) fn pose(
        &self,
        [theta1, theta4]: [f64; 2],
        [assembly]: [i8; 1],
    ) -> Result<Pose<f64>, Problem> {
        Ok(self.geometry().forward(theta1, theta4, side(assembly)?)?)
    }
}

pub(crate) fn side(sign: i8) -> Result<Side, Problem> {
    match sign {
        1 => Ok(Side::Left),
        -1 => Ok(Side::Right),
        _ => Err(Problem::NoSide),
    }
}

/// A side's sign as a number.
pub(crate) fn number(side: Side) -> f64 {
    sign(side).into()
}
