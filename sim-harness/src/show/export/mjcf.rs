//! MuJoCo's MJCF: two chains from the base, their ends joined at C by an equality.

use super::{Body, bodies, escape};
use crate::input::robot::Robot;
use fivebar_kinematics::Vec2;
use std::f64::consts::PI;
use std::fmt::Write as _;

/// The robot as MJCF, at its home pose as keyframe `home`.
///
/// MuJoCo's constraints are soft; the loop's is given a time constant of two steps, as stiff
/// as MuJoCo allows, which leaves micrometres. Torque comes in as torque at the joints, up to
/// what the motors give at peak current, rotor inertia as armature, friction as damping and
/// friction loss.
///
/// # Errors
/// A sentence for a robot without masses or home.
pub fn mjcf(robot: &Robot) -> Result<String, String> {
    let [link1, link2, link3, link4] = bodies(robot).map_err(|error| error.to_string())?;
    let arm = robot.arm().map_err(|error| error.to_string())?;
    let drives = robot.drives().map_err(|error| error.to_string())?;
    let pose = robot.home_pose().map_err(|error| error.to_string())?;
    let name = escape(&robot.name);
    let gravity = arm.gravity();
    let (base, tool) = (robot.geometry.base(), robot.tool.offset);
    let l2 = link2.length;
    let driven = |index: usize, name: &str| {
        let friction = robot
            .actuators
            .map(|a| (a[index].viscous_friction, a[index].coulomb_friction));
        let (viscous, coulomb) = friction.unwrap_or((0.0, 0.0));
        let armature = arm.rotor_inertia()[index];
        format!(
            "<joint name=\"{name}\" axis=\"0 0 1\" armature=\"{armature}\" damping=\"{viscous}\" frictionloss=\"{coulomb}\"/>"
        )
    };
    let motor = |index: usize, name: &str, joint: &str| {
        let range = format!("{torque} {torque}", torque = drives[index].peak_torque());
        format!(
            "<motor name=\"{name}\" joint=\"{joint}\" ctrllimited=\"true\" ctrlrange=\"-{range}\" \
             forcelimited=\"true\" forcerange=\"-{range}\"/>"
        )
    };
    let free = |name: &str| format!("<joint name=\"{name}\" axis=\"0 0 1\"/>");
    let mut text = String::new();
    let _ = write!(
        text,
        "<mujoco model=\"{name}\">\n\
         \x20 <!-- A planar five-bar, exported by fivebar {version}. SI units, plane z = 0. -->\n\
         \x20 <compiler angle=\"radian\"/>\n\
         \x20 <option timestep=\"0.0001\" gravity=\"{gx} {gy} 0\" integrator=\"implicitfast\">\n\
         \x20   <flag contact=\"disable\"/>\n\
         \x20 </option>\n\
         \x20 <worldbody>\n",
        version = env!("CARGO_PKG_VERSION"),
        gx = gravity.x,
        gy = gravity.y,
    );
    let chain = |text: &mut String,
                 near: &Body,
                 far: &Body,
                 at: f64,
                 joints: [String; 2],
                 end: &str| {
        let [base_joint, elbow] = joints;
        let _ = write!(
            text,
            "    <body name=\"{}\" pos=\"{at} 0 0\">\n      {base_joint}\n      {}\n      {}\n\
             \x20     <body name=\"{}\" pos=\"{} 0 0\">\n        {elbow}\n        {}\n        {}\n{end}\
             \x20     </body>\n    </body>\n",
            near.name,
            inertial(near),
            capsule(near.length),
            far.name,
            near.length,
            inertial(far),
            capsule(far.length),
        );
    };
    let sites = format!(
        "        <site name=\"C\" pos=\"{l2} 0 0\" size=\"0.002\"/>\n\
         \x20       <site name=\"tool\" pos=\"{} {} 0\" size=\"0.002\"/>\n",
        l2 + tool[0],
        tool[1],
    );
    chain(
        &mut text,
        &link1,
        &link2,
        0.0,
        [driven(0, "A"), free("B")],
        &sites,
    );
    let site = format!(
        "        <site name=\"C_of_link3\" pos=\"{} 0 0\" size=\"0.002\"/>\n",
        link3.length
    );
    chain(
        &mut text,
        &link4,
        &link3,
        base,
        [driven(1, "E"), free("D")],
        &site,
    );
    let _ = write!(
        text,
        "  </worldbody>\n\
         \x20 <equality>\n\
         \x20   <connect name=\"C\" site1=\"C\" site2=\"C_of_link3\" solref=\"0.0002 1\" solimp=\"0.9999 0.9999 1e-6\"/>\n\
         \x20 </equality>\n\
         \x20 <actuator>\n\
         \x20   {}\n\
         \x20   {}\n\
         \x20 </actuator>\n\
         \x20 <sensor>\n\
         \x20   <jointpos name=\"theta1\" joint=\"A\"/>\n    <jointpos name=\"theta4\" joint=\"E\"/>\n\
         \x20   <jointvel name=\"omega1\" joint=\"A\"/>\n    <jointvel name=\"omega4\" joint=\"E\"/>\n\
         \x20   <framepos name=\"tool\" objtype=\"site\" objname=\"tool\"/>\n\
         \x20 </sensor>\n\
         \x20 <keyframe>\n\
         \x20   <key name=\"home\" qpos=\"{} {} {} {}\"/>\n\
         \x20 </keyframe>\n\
         </mujoco>\n",
        motor(0, "torque1", "A"),
        motor(1, "torque4", "E"),
        pose.u1.angle(),
        between(pose.u1, pose.u2),
        pose.u4.angle(),
        between(pose.u4, pose.u3),
    );
    Ok(text)
}

/// The angle from one direction to another [rad], in −π…π.
fn between(from: Vec2<f64>, to: Vec2<f64>) -> f64 {
    from.cross(to).atan2(from.dot(to)).clamp(-PI, PI)
}

fn inertial(body: &Body) -> String {
    let link = &body.inertia;
    // Only the moment about z matters in the plane; MuJoCo wants all three.
    let i = link.inertia;
    format!(
        "<inertial pos=\"{} {} 0\" mass=\"{}\" diaginertia=\"{i} {i} {i}\"/>",
        link.com.x, link.com.y, link.mass
    )
}

fn capsule(length: f64) -> String {
    format!(
        "<geom type=\"capsule\" fromto=\"0 0 0 {length} 0 0\" size=\"{}\" contype=\"0\" conaffinity=\"0\"/>",
        0.03 * length
    )
}
