//! The robot in URDF. URDF describes trees only; therefore the loop is open at C.

use super::xml::{Xml, around, document, element};
use super::{ExportError, NamedLink, bodies, friction, left_out};
use fivebar_files::robot::Robot;
use quick_xml::events::{BytesDecl, BytesText, Event};
use std::io;

/// What a reader of the file must know and set.
fn note(robot: &Robot) -> Result<String, ExportError> {
    let arm = robot.arm()?;
    let gravity = arm.gravity();
    let [rotor1, rotor4] = arm.rotor_inertia();
    Ok(format!(
        " A planar five-bar in the plane z = 0, in SI units.
     URDF has no closed loops: this one is open at C. Join the frames c_of_link2 and c_of_link3 by a
     constraint of your simulator.
     URDF has no gravity: set it to ({}, {}, 0) m/s².
     The motors' rotors, {rotor1} and {rotor4} kg·m² at the joints A and E, are in the moments of inertia
     of link1 and link4, which turn with them: leave the joints' armature at 0.
     Friction of the joints A and E is in their dynamics: damping in N·m·s/rad, and Coulomb friction in
     N·m. Readers such as Pinocchio load it, but do not apply it by themselves.
     Torques act at the joints.{} ",
        gravity.x,
        gravity.y,
        left_out(robot)
    ))
}

/// The robot as URDF, with its loop open at C: link 3 ends at the frame `c_of_link3`, link 2 at
/// `c_of_link2`. The simulator that loads it must join the two.
///
/// URDF has no rotor inertia. A rotor on the base turns with its driven link, so that its inertia at the joint is that of
/// the link about the joint: it is added to the link's moment of inertia, and every reader has it.
///
/// # Errors
/// If the robot has no masses.
pub fn urdf(robot: &Robot) -> Result<String, ExportError> {
    let mut bodies = bodies(robot)?;
    let [rotor1, rotor4] = robot.arm()?.rotor_inertia();
    for (body, rotor) in [(0, rotor1), (3, rotor4)] {
        bodies[body].inertia.inertia += rotor;
    }
    let [l1, l2, l3, l4, base] = robot.geometry.lengths();
    let [along, left] = robot.tool.offset;
    let note = note(robot)?;
    let drives = robot.drives()?;
    let driven = [0, 1].map(|index| {
        let [low, high] = robot.limits.angle[index];
        let (speed, torque) = (robot.limits.max_speed[index], drives[index].peak_torque());
        let [damping, coulomb] = friction(robot, index);
        [low, high, speed, torque, damping, coulomb].map(|value| value.to_string())
    });
    let along_parent = |x: f64| [x, 0.0];
    Ok(document(|xml| {
        xml.write_event(Event::Decl(BytesDecl::new("1.0", None, None)))?;
        xml.write_event(Event::Comment(BytesText::from_escaped(&note)))?;
        around(xml, "robot", &[("name", &robot.name)], |xml| {
            element(xml, "link", &[("name", "base")])?;
            for body in &bodies {
                link(xml, body)?;
            }
            for end in ["c_of_link2", "c_of_link3", "tool"] {
                element(xml, "link", &[("name", end)])?;
            }
            let [drive1, drive4] = driven.each_ref().map(Some);
            let mut joint = |names, x, driven| joint(xml, names, along_parent(x), driven);
            joint(["A", "revolute", "base", "link1"], 0.0, drive1)?;
            joint(["B", "continuous", "link1", "link2"], l1, None)?;
            joint(["E", "revolute", "base", "link4"], base, drive4)?;
            joint(["D", "continuous", "link4", "link3"], l4, None)?;
            joint(["C2", "fixed", "link2", "c_of_link2"], l2, None)?;
            joint(["C3", "fixed", "link3", "c_of_link3"], l3, None)?;
            let tool = [l2 + along, left];
            self::joint(xml, ["T", "fixed", "link2", "tool"], tool, None)
        })
    }))
}

fn link(xml: &mut Xml, body: &NamedLink) -> io::Result<()> {
    let (link, length) = (&body.inertia, body.length);
    around(xml, "link", &[("name", body.name)], |xml| {
        around(xml, "inertial", &[], |xml| {
            let centre = format!("{} {} 0", link.com.x, link.com.y);
            element(xml, "origin", &[("xyz", &centre)])?;
            element(xml, "mass", &[("value", &link.mass.to_string())])?;
            let moment = link.inertia.to_string();
            let about = ["ixx", "iyy", "izz"].map(|axis| (axis, moment.as_str()));
            let products = ["ixy", "ixz", "iyz"].map(|axes| (axes, "0"));
            element(xml, "inertia", &[about, products].concat())
        })?;
        around(xml, "visual", &[], |xml| {
            element(xml, "origin", &[("xyz", &format!("{} 0 0", 0.5 * length))])?;
            around(xml, "geometry", &[], |xml| {
                let size = format!("{length} {} {}", 0.06 * length, 0.03 * length);
                element(xml, "box", &[("size", &size)])
            })
        })
    })
}

/// A joint at a place in its parent's frame [m]; a driven one with limits of angle, speed and torque, and friction.
fn joint(
    xml: &mut Xml,
    [name, kind, parent, child]: [&str; 4],
    [x, y]: [f64; 2],
    driven: Option<&[String; 6]>,
) -> io::Result<()> {
    around(xml, "joint", &[("name", name), ("type", kind)], |xml| {
        element(xml, "parent", &[("link", parent)])?;
        element(xml, "child", &[("link", child)])?;
        element(xml, "origin", &[("xyz", &format!("{x} {y} 0"))])?;
        if kind != "fixed" {
            element(xml, "axis", &[("xyz", "0 0 1")])?;
        }
        let Some([low, high, speed, torque, damping, coulomb]) = driven else {
            return Ok(());
        };
        let limit = [
            ("lower", low.as_str()),
            ("upper", high),
            ("velocity", speed),
            ("effort", torque),
        ];
        element(xml, "limit", &limit)?;
        element(
            xml,
            "dynamics",
            &[("damping", damping), ("friction", coulomb)],
        )
    })
}
