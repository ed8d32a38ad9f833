//! One control period of a leg, as in the example `torque_from_tip_force`, for a microcontroller and a desktop.
#![no_std]

use fivebar_kinematics::Scalar;
use fivebar_kinematics::five_bar::{FootDrive, Geometry, PoseError, Side, WorkingMode};
use fivebar_kinematics::nalgebra::Vector2;

/// Thighs, shanks and the distance of the motors: l1 to l4 and the base [m].
pub const LENGTHS: [f32; 5] = [0.09, 0.16, 0.16, 0.09, 0.04];
/// Velocity of the foot [m/s].
pub const VELOCITY: [f32; 2] = [0.3, -0.2];
/// Force of the ground on the foot [N].
pub const GROUND: [f32; 2] = [-3.0, 20.0];
/// Places of the foot below the hip [m].
pub const FEET: [[f32; 2]; 6] = [
    [0.02, -0.14],
    [0.02, -0.16],
    [0.02, -0.18],
    [0.02, -0.20],
    [0.02, -0.22],
    [0.02, -0.24],
];

/// What the motors need with the knees outwards; places and velocities in m and m/s, the force in N.
///
/// # Errors
/// As [`Geometry::drive_foot`].
pub fn period<S: Scalar>(
    leg: &Geometry<S>,
    [foot, velocity, force]: [[S; 2]; 3],
) -> Result<FootDrive<S>, PoseError> {
    let knees_out = WorkingMode::new(Side::Left, Side::Right);
    let [foot, velocity, force] = [foot, velocity, force].map(Vector2::from);
    leg.drive_foot(foot, velocity, force, knees_out)
}
