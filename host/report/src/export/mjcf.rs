//! The robot in MuJoCo's format MJCF: two chains from the base, whose ends are joined at C by an
//! equality constraint.

use super::xml::{Xml, around, document, element};
use super::{ExportError, NamedLink, bodies, friction, left_out};
use fivebar_files::robot::Robot;
use fivebar_kinematics::PlanarVector;
use nalgebra::Vector2;
use quick_xml::events::{BytesText, Event};
use std::f64::consts::PI;
use std::io;

/// The robot as MJCF, with its home pose as keyframe `home`.
///
/// MuJoCo's constraints are soft. That of the loop has a time constant of two steps, the
/// stiffest that MuJoCo allows; C then opens by micrometres. The actuators are torques at the
/// joints, limited to the torque at the motors' peak current. Rotor inertia becomes armature;
/// friction becomes damping and friction loss.
///
/// # Errors
/// If the robot has no masses or no home pose.
pub fn mjcf(robot: &Robot) -> Result<String, ExportError> {
    let [link1, link2, link3, link4] = bodies(robot)?;
    let [drive1, drive4] = robot.drives()?;
    let gravity = robot.arm()?.gravity();
    let pose = robot.home_pose()?;
    let angles = [
        pose.u1.polar_angle(),
        between(pose.u1, pose.u2),
        pose.u4.polar_angle(),
        between(pose.u4, pose.u3),
    ];
    let [joint_a, joint_e] = [driven(robot, 0)?, driven(robot, 1)?];
    let [along, left] = robot.tool.offset;
    let tool = [link2.length + along, left];
    let leg1 = [("C", [link2.length, 0.0]), ("tool", tool)];
    let leg4 = [("C_of_link3", [link3.length, 0.0])];
    let note = format!(
        " A planar five-bar, exported by fivebar {}. SI units, plane z = 0.{} ",
        env!("CARGO_PKG_VERSION"),
        left_out(robot)
    );
    let of_world = format!("{} {} 0", gravity.x, gravity.y);
    Ok(document(|xml| {
        around(xml, "mujoco", &[("model", &robot.name)], |xml| {
            xml.write_event(Event::Comment(BytesText::new(&note)))?;
            element(xml, "compiler", &[("angle", "radian")])?;
            let option = [
                ("timestep", "0.0001"),
                ("gravity", &of_world),
                ("integrator", "implicitfast"),
            ];
            around(xml, "option", &option, |xml| {
                element(xml, "flag", &[("contact", "disable")])
            })?;
            around(xml, "worldbody", &[], |xml| {
                leg(xml, [&link1, &link2], 0.0, &joint_a, "B", &leg1)?;
                let base = robot.geometry.base();
                leg(xml, [&link4, &link3], base, &joint_e, "D", &leg4)
            })?;
            around(xml, "equality", &[], |xml| {
                let connect = [
                    ("name", "C"),
                    ("site1", "C"),
                    ("site2", "C_of_link3"),
                    ("solref", "0.0002 1"),
                    ("solimp", "0.9999 0.9999 1e-6"),
                ];
                element(xml, "connect", &connect)
            })?;
            around(xml, "actuator", &[], |xml| {
                motor(xml, "torque1", "A", drive1.peak_torque())?;
                motor(xml, "torque4", "E", drive4.peak_torque())
            })?;
            around(xml, "sensor", &[], sensors)?;
            around(xml, "keyframe", &[], |xml| {
                let angles = angles.map(|angle| angle.to_string()).join(" ");
                element(xml, "key", &[("name", "home"), ("qpos", &angles)])
            })
        })
    }))
}

/// The angle from one direction to another [rad], in −π…π.
fn between(from: Vector2<f64>, to: Vector2<f64>) -> f64 {
    from.cross_z(to).atan2(from.dot(&to)).clamp(-PI, PI)
}

/// The attributes of a driven joint: name, armature, damping and friction loss.
type JointAttributes = [(&'static str, String); 4];

fn driven(robot: &Robot, index: usize) -> Result<JointAttributes, ExportError> {
    let [viscous, coulomb] = friction(robot, index);
    let armature = robot.arm()?.rotor_inertia()[index];
    Ok([
        ("name", ["A", "E"][index].into()),
        ("armature", armature.to_string()),
        ("damping", viscous.to_string()),
        ("frictionloss", coulomb.to_string()),
    ])
}

/// The two links of a leg, from its ground pivot at `base` [m] from A. `sites` are in the far
/// link's frame.
fn leg(
    xml: &mut Xml,
    [near, far]: [&NamedLink; 2],
    base: f64,
    driven: &JointAttributes,
    elbow: &str,
    sites: &[(&str, [f64; 2])],
) -> io::Result<()> {
    let [pivot, end] = [base, near.length].map(|x| format!("{x} 0 0"));
    around(
        xml,
        "body",
        &[("name", near.name), ("pos", &pivot)],
        |xml| {
            let driven = driven.each_ref().map(|(key, value)| (*key, value.as_str()));
            element(xml, "joint", &[&driven[..], &[("axis", "0 0 1")]].concat())?;
            inertia_and_shape(xml, near)?;
            around(xml, "body", &[("name", far.name), ("pos", &end)], |xml| {
                element(xml, "joint", &[("name", elbow), ("axis", "0 0 1")])?;
                inertia_and_shape(xml, far)?;
                for (name, [x, y]) in sites {
                    let place = format!("{x} {y} 0");
                    let site = [("name", *name), ("pos", &place), ("size", "0.002")];
                    element(xml, "site", &site)?;
                }
                Ok(())
            })
        },
    )
}

/// A link's inertia and shape.
fn inertia_and_shape(xml: &mut Xml, body: &NamedLink) -> io::Result<()> {
    let (link, length) = (&body.inertia, body.length);
    let centre = format!("{} {} 0", link.com.x, link.com.y);
    // The motion in the plane uses the moment about z only; MuJoCo requires all three.
    let moments = [link.inertia; 3].map(|i| i.to_string()).join(" ");
    let inertial = [
        ("pos", centre.as_str()),
        ("mass", &link.mass.to_string()),
        ("diaginertia", &moments),
    ];
    element(xml, "inertial", &inertial)?;
    let capsule = [
        ("type", "capsule"),
        ("fromto", &format!("0 0 0 {length} 0 0")),
        ("size", &(0.03 * length).to_string()),
        ("contype", "0"),
        ("conaffinity", "0"),
    ];
    element(xml, "geom", &capsule)
}

fn motor(xml: &mut Xml, name: &str, joint: &str, peak: f64) -> io::Result<()> {
    let range = format!("-{peak} {peak}");
    let motor = [
        ("name", name),
        ("joint", joint),
        ("ctrllimited", "true"),
        ("ctrlrange", &range),
        ("forcelimited", "true"),
        ("forcerange", &range),
    ];
    element(xml, "motor", &motor)
}

fn sensors(xml: &mut Xml) -> io::Result<()> {
    for (kind, name, joint) in [
        ("jointpos", "theta1", "A"),
        ("jointpos", "theta4", "E"),
        ("jointvel", "omega1", "A"),
        ("jointvel", "omega4", "E"),
    ] {
        element(xml, kind, &[("name", name), ("joint", joint)])?;
    }
    let tool = [("name", "tool"), ("objtype", "site"), ("objname", "tool")];
    element(xml, "framepos", &tool)
}
