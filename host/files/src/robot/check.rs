//! Makes a robot of the values of its file, and refuses those that are not valid.

use super::actuators::read_actuators;
use super::can_torque::with_latency;
use super::consistency::check_together;
use super::file::RobotFile;
use super::home::default_home;
use super::links::read_links;
use super::macros::check_macros;
use super::tolerance::read_tolerance;
use super::tool_output::read_tool_output;
use super::{Actuator, DriveKind, HomeMethod, Robot};
use crate::refusal::{Key, Refusal, Refusals};
use crate::source::Source;
use fivebar_kinematics::dynamics::Arm;
use fivebar_kinematics::five_bar::{self, Side, WorkingMode};
use nalgebra::Vector2;

/// The robot of a file. The source only tells which keys the file gives.
pub(super) fn robot(source: &Source<'_>, mut file: RobotFile) -> Result<Robot, Refusal> {
    // Every value is checked before the first refusal ends the reading.
    let mut refusals = Refusals::default();
    file.check_top(&mut refusals);
    let links = read_links(&file.link, file.base, &mut refusals);
    let actuators = read_actuators(&file.actuator, &mut refusals);
    let actuators = actuators.map(|all| with_latency(all, &mut file.control));
    let [elbow1, elbow4] = file
        .working_mode
        .each_ref()
        .map(|name| refusals.noted(side(name)));
    let tool_output = refusals.noted(read_tool_output(&file.tool_output));
    refusals.note(check_macros(&file.macros));
    let tolerance = refusals.noted(read_tolerance(&file.tolerance));
    file.check_sections(&mut refusals);
    refusals.done()?;

    let (geometry, inertias) = links?;
    let actuators = actuators?;
    let elbows = WorkingMode::new(elbow1?, elbow4?);
    let (tool_output, tool_speeds) = tool_output?;
    let gravity = Vector2::from(file.gravity);
    let arm = |inertias| {
        let rotor = |a: Actuator| a.rotor_inertia * a.gear_ratio * a.gear_ratio;
        let rotors = actuators.map_or([0.0; 2], |actuators| actuators.map(rotor));
        let payload = file.payload.ok_or_else(missing_payload)?;
        let arm = Arm::new(geometry, inertias, payload, gravity, rotors);
        arm.map_err(|error| Key::Top("link").refused(error))
    };
    let arm = inertias.map(arm).transpose()?;
    let tool = five_bar::Tool::new(geometry, file.tool.offset.into())
        .map_err(|_| Key::In("tool", "offset").refused("must not put the tool on B"))?;
    let home = file
        .home
        .unwrap_or_else(|| default_home(&tool, elbows, &file.limits));
    let control = file.control.given();
    let mut robot = Robot {
        name: file.name,
        geometry,
        gravity,
        arm,
        elbows,
        home,
        actuators,
        tool: file.tool,
        tool_output,
        tool_speeds,
        macros: file.macros,
        limits: file.limits,
        motion: file.motion,
        rigid_control: control,
        control,
        supply: file.supply,
        protection: file.protection,
        homing: file.homing,
        tolerance: tolerance?,
        contact: file.contact,
        crossing: file.crossing,
        advanced: file.advanced,
        belts: None,
    };
    robot.close_loops(&file.control);
    // The angles of servos are absolute.
    if robot.drive_kind() == DriveKind::Servo && !source.holds(Key::In("homing", "method")) {
        robot.homing.method = HomeMethod::Absolute;
    }
    check_together(source, &robot)?;
    Ok(robot)
}

fn missing_payload() -> Refusal {
    let reason = "is missing: links with masses need it; write 0.0 for no payload";
    Key::Top("payload").refused(reason)
}

fn side(name: &str) -> Result<Side, Refusal> {
    match name {
        "left" => Ok(Side::Left),
        "right" => Ok(Side::Right),
        other => Err(Key::Top("working_mode").refused(format!(
            "must name two sides, \"left\" or \"right\", not \"{other}\""
        ))),
    }
}
