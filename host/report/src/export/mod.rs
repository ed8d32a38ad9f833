//! Files for other programs: robots for MuJoCo, URDF readers and Graphviz, runs for Foxglove,
//! and tables.

mod dot;
mod linkage_csv;
#[cfg(feature = "mcap")]
mod mcap;
mod mjcf;
mod motion_log;
mod photo_csv;
#[cfg(feature = "mcap")]
mod scene;
mod table;
mod trace_csv;
mod urdf;
mod workspace_csv;
mod xml;

pub use dot::dot;
pub use linkage_csv::linkage_csv;
#[cfg(feature = "mcap")]
pub use mcap::mcap;
pub use mjcf::mjcf;
pub use motion_log::{motion_columns, motion_csv};
pub use photo_csv::{photo_csv, photo_points_csv};
pub use trace_csv::trace_csv;
pub use urdf::urdf;
pub use workspace_csv::workspace_csv;

use fivebar_files::robot::{Actuator, HomeError, MissingMasses, Robot};
use fivebar_kinematics::dynamics::{Arm, Link};
use nalgebra::Vector2;

/// Why a robot cannot be exported.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ExportError {
    /// The robot has lengths only, no masses.
    #[error(transparent)]
    MissingMasses(#[from] MissingMasses),
    /// The robot has no home pose.
    #[error(transparent)]
    HomeError(#[from] HomeError),
}

/// A link of an exported model.
struct NamedLink {
    name: &'static str,
    length: f64,
    inertia: Link<f64>,
}

/// Viscous [N·m·s/rad] and Coulomb friction [N·m] of a driven joint.
fn friction(robot: &Robot, index: usize) -> [f64; 2] {
    let of = |drive: Actuator| [drive.viscous_friction, drive.coulomb_friction];
    robot.actuators.map_or([0.0; 2], |drives| of(drives[index]))
}

/// Sentences about properties of the robot that a model of rigid links and joints has not; empty if there are none.
fn left_out(robot: &Robot) -> String {
    let Some(drives) = robot.actuators else {
        return String::new();
    };
    let mut text = String::new();
    if let [Some(one), Some(four)] = drives.map(|drive| drive.stiffness) {
        text += &format!(
            "\n     Not in this model: the stiffness of the drives, {one} and {four} N·m/rad. Its rotors turn with the \
             joints."
        );
    }
    if drives.iter().any(|drive| drive.brake_torque > 0.0) {
        let [one, four] = drives.map(|drive| drive.brake_torque);
        text += &format!("\n     Not in this model: the holding brakes, {one} and {four} N·m.");
    }
    text
}

/// Links 1 to 4; link 2 includes the payload.
fn bodies(robot: &Robot) -> Result<[NamedLink; 4], MissingMasses> {
    let arm = robot.arm()?;
    let [l1, l2, l3, l4, _] = robot.geometry.lengths();
    let [link1, link2, link3, link4] = *arm.links();
    let body = |name, length, inertia| NamedLink {
        name,
        length,
        inertia,
    };
    Ok([
        body("link1", l1, link1),
        body("link2", l2, with_payload(arm, link2, l2)),
        body("link3", l3, link3),
        body("link4", l4, link4),
    ])
}

/// A link with a point mass at its end: m = m2 + mp, moments about the common centre of mass.
fn with_payload(arm: &Arm<f64>, link: Link<f64>, length: f64) -> Link<f64> {
    let payload = arm.payload();
    let mass = link.mass + payload;
    if payload == 0.0 || mass == 0.0 {
        return link;
    }
    let end = Vector2::new(length, 0.0);
    let com = (link.com * link.mass + end * payload) * (1.0 / mass);
    let about = |point: Vector2<f64>, mass: f64| mass * (point - com).norm_squared();
    Link {
        mass,
        com,
        inertia: link.inertia + about(link.com, link.mass) + about(end, payload),
    }
}
