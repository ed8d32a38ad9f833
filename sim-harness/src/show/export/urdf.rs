//! URDF: a tree, so the loop is cut at C.

use super::{Body, bodies, escape};
use crate::input::robot::Robot;
use std::fmt::Write as _;

/// The robot as URDF, its loop cut at C: link 3 ends at the frame `c_of_link3`, link 2 at
/// `c_of_link2`, and whoever loads it must hold the two together.
///
/// # Errors
/// A sentence for a robot without masses.
pub fn urdf(robot: &Robot) -> Result<String, String> {
    let [link1, link2, link3, link4] = bodies(robot).map_err(|error| error.to_string())?;
    let name = escape(&robot.name);
    let mut text = format!(
        "<?xml version=\"1.0\"?>\n\
         <!-- A planar five-bar. URDF knows no closed loops: this one is cut at C. Keep the\n\
         \x20    frames c_of_link2 and c_of_link3 together by a constraint of your simulator. -->\n\
         <robot name=\"{name}\">\n  <link name=\"base\"/>\n"
    );
    for body in [&link1, &link2, &link3, &link4] {
        link(&mut text, body);
    }
    for end in ["c_of_link2", "c_of_link3"] {
        let _ = writeln!(text, "  <link name=\"{end}\"/>");
    }
    let base = robot.geometry.base();
    let drives = robot.drives().map_err(|error| error.to_string())?;
    let drive = |index: usize| {
        let [low, high] = robot.limits.angle[index];
        let speed = robot.limits.max_speed[index];
        let torque = drives[index].peak_torque();
        format!(
            "<limit lower=\"{low}\" upper=\"{high}\" velocity=\"{speed}\" effort=\"{torque}\"/>"
        )
    };
    joint(
        &mut text,
        ["A", "revolute", "base", "link1"],
        0.0,
        &drive(0),
    );
    joint(
        &mut text,
        ["B", "continuous", "link1", "link2"],
        link1.length,
        "",
    );
    joint(
        &mut text,
        ["E", "revolute", "base", "link4"],
        base,
        &drive(1),
    );
    joint(
        &mut text,
        ["D", "continuous", "link4", "link3"],
        link4.length,
        "",
    );
    joint(
        &mut text,
        ["C2", "fixed", "link2", "c_of_link2"],
        link2.length,
        "",
    );
    joint(
        &mut text,
        ["C3", "fixed", "link3", "c_of_link3"],
        link3.length,
        "",
    );
    text.push_str("</robot>\n");
    Ok(text)
}

fn link(text: &mut String, body: &Body) {
    let link = &body.inertia;
    let (i, length) = (link.inertia, body.length);
    let _ = write!(
        text,
        "  <link name=\"{}\">\n    <inertial>\n      <origin xyz=\"{} {} 0\"/>\n      <mass value=\"{}\"/>\n\
         \x20     <inertia ixx=\"{i}\" iyy=\"{i}\" izz=\"{i}\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/>\n    </inertial>\n\
         \x20   <visual>\n      <origin xyz=\"{} 0 0\"/>\n      <geometry><box size=\"{length} {} {}\"/></geometry>\n    </visual>\n  </link>\n",
        body.name,
        link.com.x,
        link.com.y,
        link.mass,
        0.5 * length,
        0.06 * length,
        0.03 * length,
    );
}

fn joint(text: &mut String, [name, kind, parent, child]: [&str; 4], at: f64, limit: &str) {
    let axis = if kind == "fixed" {
        ""
    } else {
        "<axis xyz=\"0 0 1\"/>"
    };
    let _ = writeln!(
        text,
        "  <joint name=\"{name}\" type=\"{kind}\"><parent link=\"{parent}\"/><child link=\"{child}\"/>\
         <origin xyz=\"{at} 0 0\"/>{axis}{limit}</joint>"
    );
}
