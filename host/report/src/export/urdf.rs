//! The robot in URDF. URDF describes trees only; therefore the loop is open at C.

use super::xml::{Xml, around, document, element};
use super::{ExportError, NamedLink, bodies};
use fivebar_files::robot::Robot;
use quick_xml::events::{BytesDecl, BytesText, Event};
use std::io;

const NOTE: &str = " A planar five-bar. URDF has no closed loops: this one is open at C. Join the
     frames c_of_link2 and c_of_link3 by a constraint of your simulator. ";

/// The robot as URDF, with its loop open at C: link 3 ends at the frame `c_of_link3`, link 2 at
/// `c_of_link2`. The simulator that loads it must join the two.
///
/// # Errors
/// If the robot has no masses.
pub fn urdf(robot: &Robot) -> Result<String, ExportError> {
    let bodies = bodies(robot)?;
    let [l1, l2, l3, l4, base] = robot.geometry.lengths();
    let drives = robot.drives()?;
    let limits = [0, 1].map(|index| {
        let [low, high] = robot.limits.angle[index];
        let (speed, torque) = (robot.limits.max_speed[index], drives[index].peak_torque());
        [low, high, speed, torque].map(|limit| limit.to_string())
    });
    Ok(document(|xml| {
        xml.write_event(Event::Decl(BytesDecl::new("1.0", None, None)))?;
        xml.write_event(Event::Comment(BytesText::from_escaped(NOTE)))?;
        around(xml, "robot", &[("name", &robot.name)], |xml| {
            element(xml, "link", &[("name", "base")])?;
            for body in &bodies {
                link(xml, body)?;
            }
            for end in ["c_of_link2", "c_of_link3"] {
                element(xml, "link", &[("name", end)])?;
            }
            let [limit1, limit4] = limits.each_ref().map(Some);
            joint(xml, ["A", "revolute", "base", "link1"], 0.0, limit1)?;
            joint(xml, ["B", "continuous", "link1", "link2"], l1, None)?;
            joint(xml, ["E", "revolute", "base", "link4"], base, limit4)?;
            joint(xml, ["D", "continuous", "link4", "link3"], l4, None)?;
            joint(xml, ["C2", "fixed", "link2", "c_of_link2"], l2, None)?;
            joint(xml, ["C3", "fixed", "link3", "c_of_link3"], l3, None)
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

/// A joint at distance `at` [m] along its parent, with limits of angle, speed and torque.
fn joint(
    xml: &mut Xml,
    [name, kind, parent, child]: [&str; 4],
    at: f64,
    limits: Option<&[String; 4]>,
) -> io::Result<()> {
    around(xml, "joint", &[("name", name), ("type", kind)], |xml| {
        element(xml, "parent", &[("link", parent)])?;
        element(xml, "child", &[("link", child)])?;
        element(xml, "origin", &[("xyz", &format!("{at} 0 0"))])?;
        if kind != "fixed" {
            element(xml, "axis", &[("xyz", "0 0 1")])?;
        }
        let Some([low, high, speed, torque]) = limits else {
            return Ok(());
        };
        let limit = [
            ("lower", low.as_str()),
            ("upper", high),
            ("velocity", speed),
            ("effort", torque),
        ];
        element(xml, "limit", &limit)
    })
}
