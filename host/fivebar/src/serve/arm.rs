//! The description of the arm for pages, sent before the arm moves.

use fivebar_files::robot::{HomeError, Robot};
use fivebar_sim::drive_values::{DriveValue, DriveValues, tip_error_of};
use fivebar_sim::machine::{Machine, Signal};
use serde::Serialize;

/// Positions [m], angles [rad].
#[derive(Debug, Serialize)]
struct Arm<'a> {
    name: &'a str,
    /// Where its controller runs.
    place: &'a str,
    /// What turns its joints.
    motors: &'a str,
    /// What a state tells of its drives; the rest is 0.
    shows: Vec<Signal>,
    /// What a state has as `drives`, in this order.
    drives: &'static [DriveValue],
    /// What the tip error that a state shows is of.
    tip_error: &'static str,
    base: f64,
    tool_offset: [f64; 2],
    /// Least and greatest θ1 and θ4.
    angle_limits: [[f64; 2]; 2],
    /// The names of the macros.
    macros: Vec<&'a str>,
    /// B, C, D and the tool at home.
    home: [[f64; 2]; 4],
}

/// The description as JSON.
///
/// # Errors
/// The robot has no home pose.
pub(super) fn describe(
    robot: &Robot,
    place: &str,
    values: &DriveValues,
) -> Result<String, HomeError> {
    let pose = robot.home_pose()?;
    let [b, c, d] = [pose.b, pose.c, pose.d].map(|point| [point.x, point.y]);
    let machine = Machine::of(robot.drive_kind());
    let arm = Arm {
        name: &robot.name,
        place,
        motors: machine.motors,
        shows: (machine.shows.iter().copied())
            .filter(|signal| *signal != Signal::Current || values.knows_current())
            .collect(),
        drives: values.names(),
        tip_error: tip_error_of(robot),
        base: robot.geometry.base(),
        tool_offset: robot.tool.offset,
        angle_limits: robot.limits.angle,
        macros: robot.macros.keys().map(String::as_str).collect(),
        home: [b, c, d, robot.tool_at(&pose)],
    };
    Ok(serde_json::json!(arm).to_string())
}
