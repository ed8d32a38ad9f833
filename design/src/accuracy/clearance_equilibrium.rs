//! Kineto-static clearance (Tu 2005): every pin rests where its reaction presses it.
//!
//! In a joint of clearance r, the link on which the force F acts is displaced by −r F̂ from
//! the link that exerts it. The reactions at zero clearance give the first directions. The
//! pose is then solved with these offsets and gives new reactions, until the directions
//! converge. A link in tension becomes longer by the clearances at its ends, one in
//! compression shorter.
//!
//! The model holds while every joint stays in contact. Where a reaction reverses, the pin
//! crosses the bearing without contact; only a contact simulation shows that.

use super::arm::DrivenJointMotion;
use super::{AccuracyError, five_bar};
use fivebar_kinematics::PlanarVector;
use fivebar_kinematics::dynamics::Arm;
use fivebar_kinematics::five_bar::{Pose, Side};
use nalgebra::Vector2;

/// The offsets have converged when they change by less than this share of the clearances.
const CONVERGED: f64 = 1e-12;
/// Directions that have not converged after so many iterations do not converge: the direction
/// of a force near zero alternates.
const MAX_ITERATIONS: usize = 60;

/// The arm with its pins in clearance equilibrium.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClearanceEquilibrium {
    /// Offsets in the joints A, B, C, D, E [m]: in A, B, D and E of the link farther from the
    /// ground, in C of link 2 from link 3.
    pub offsets: [Vector2<f64>; 5],
    /// The reactions in A, B, C, D, E that press the pins [N], as
    /// [`Reactions`](fivebar_kinematics::dynamics::Reactions) has them.
    pub reactions: [Vector2<f64>; 5],
    /// The displacement of C from its ideal position [m].
    pub displacement: Vector2<f64>,
    /// The number of iterations.
    pub iterations: usize,
    /// Whether the directions converged; otherwise a joint is about to lose contact.
    pub converged: bool,
}

/// The clearance equilibrium of an arm in motion, with its driven links at their angles;
/// `radii` are the clearances of A, B, C, D, E [m].
///
/// # Errors
/// Where the arm has no pose or is singular.
pub fn clearance_equilibrium(
    arm: &Arm<f64>,
    assembly: Side,
    inputs: &DrivenJointMotion,
    external_force: Vector2<f64>,
    radii: [f64; 5],
) -> Result<ClearanceEquilibrium, AccuracyError> {
    let geometry = arm.geometry();
    let ideal = geometry.forward(inputs.theta[0], inputs.theta[1], assembly)?;
    let largest = radii.iter().fold(0.0_f64, |m, r| m.max(*r));
    let mut pose = ideal;
    let mut equilibrium = ClearanceEquilibrium {
        offsets: [Vector2::zeros(); 5],
        reactions: [Vector2::zeros(); 5],
        displacement: Vector2::zeros(),
        iterations: 0,
        converged: false,
    };
    while equilibrium.iterations < MAX_ITERATIONS && !equilibrium.converged {
        let reactions = reactions(arm, &pose, inputs, external_force)?;
        let [a, b, c, d, e] = core::array::from_fn(|i| pressed(reactions[i], radii[i]));
        // The reaction in C is that of link 2 on link 3: link 2 is displaced in the opposite direction.
        let offsets = [a, b, -c, d, e];
        let change = (0..5)
            .map(|i| (offsets[i] - equilibrium.offsets[i]).length())
            .fold(0.0, f64::max);
        equilibrium = ClearanceEquilibrium {
            offsets,
            reactions,
            iterations: equilibrium.iterations + 1,
            converged: change <= CONVERGED * largest,
            ..equilibrium
        };
        pose = equilibrium_pose(arm, &ideal, offsets)?;
    }
    equilibrium.displacement = pose.c - ideal.c;
    Ok(equilibrium)
}

/// −r F̂, or zero without a force.
fn pressed(force: Vector2<f64>, radius: f64) -> Vector2<f64> {
    let size = force.length();
    if size > 0.0 {
        force * (-radius / size)
    } else {
        Vector2::zeros()
    }
}

fn reactions(
    arm: &Arm<f64>,
    pose: &Pose<f64>,
    inputs: &DrivenJointMotion,
    external_force: Vector2<f64>,
) -> Result<[Vector2<f64>; 5], AccuracyError> {
    let geometry = arm.geometry();
    let [omega1, omega4] = inputs.omega;
    let [alpha1, alpha4] = inputs.alpha;
    let velocities = geometry.forward_velocities(pose, omega1, omega4)?;
    let accelerations = geometry.forward_accelerations(pose, &velocities, alpha1, alpha4)?;
    let forces = arm.reactions(pose, &velocities, &accelerations, external_force)?;
    Ok([forces.a, forces.b, forces.c, forces.d, forces.e])
}

/// The pose with the pins off their centres: links 2 and 3 turn until they meet.
fn equilibrium_pose(
    arm: &Arm<f64>,
    ideal: &Pose<f64>,
    offsets: [Vector2<f64>; 5],
) -> Result<Pose<f64>, AccuracyError> {
    let geometry = arm.geometry();
    let [a, b, c, d, e] = offsets;
    let tool = five_bar::tool_with_pin_offsets(geometry, ideal, offsets)?;
    Ok(Pose {
        u2: (tool - (ideal.b + a + b)) * (1.0 / geometry.l2()),
        u3: (tool - (ideal.d + c + d + e)) * (1.0 / geometry.l3()),
        c: tool,
        ..*ideal
    })
}
