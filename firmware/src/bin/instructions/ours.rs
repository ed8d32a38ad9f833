//! The library's solutions, each in a function that is not inlined, and the poses over which they
//! are counted.

use fivebar_kinematics::PlanarVector;
use fivebar_kinematics::dynamics::{Arm, Link};
use fivebar_kinematics::five_bar::{
    Accelerations, Geometry, Pose, PoseError, Side, Velocities, WorkingMode,
};
use nalgebra::Vector2;

/// Elbows out: leg 1's to the left of C, leg 4's to the right.
const MODE: WorkingMode = WorkingMode::new(Side::Right, Side::Left);

/// One pose in motion, with all inputs of the counted functions.
#[derive(Clone, Copy)]
pub(crate) struct Case {
    pub(crate) lengths: [f32; 5],
    pub(crate) driven: [f32; 2],
    pub(crate) c: Vector2<f32>,
    arm: Arm<f32>,
    assembly: Side,
    pose: Pose<f32>,
    velocities: Velocities<f32>,
    accelerations: Accelerations<f32>,
}

/// 16 poses over the working area of an arm with l = 0.12, 0.16, 0.16, 0.12, 0.10 m.
pub(crate) fn cases() -> [Case; 16] {
    core::array::from_fn(|index| {
        let c = Vector2::new(
            -0.03 + 0.05 * (index % 4) as f32,
            0.14 + 0.025 * (index / 4) as f32,
        );
        match case(c) {
            Ok(case) => case,
            Err(_) => panic!("every pose is within reach"),
        }
    })
}

fn case(c: Vector2<f32>) -> Result<Case, PoseError> {
    let lengths = [0.12, 0.16, 0.16, 0.12, 0.10];
    let Ok(geometry) = Geometry::new(lengths) else {
        return Err(PoseError::NotFinite);
    };
    let link = |com, inertia| Link {
        mass: 0.1,
        com: Vector2::new(com, 0.002),
        inertia,
    };
    let links = [
        link(0.06, 2e-4),
        link(0.068, 7e-4),
        link(0.068, 7e-4),
        link(0.06, 2e-4),
    ];
    let Ok(arm) = Arm::new(geometry, links, 0.05, Vector2::new(0.0, -9.81), [1e-4; 2]) else {
        return Err(PoseError::NotFinite);
    };
    let pose = geometry.inverse(c, MODE)?;
    let velocities = geometry.inverse_velocities(&pose, Vector2::new(0.2, -0.1))?;
    let accelerations =
        geometry.inverse_accelerations(&pose, &velocities, Vector2::new(-1.0, 2.0))?;
    Ok(Case {
        lengths,
        driven: [pose.u1.polar_angle(), pose.u4.polar_angle()],
        c,
        arm,
        assembly: pose.assembly(),
        pose,
        velocities,
        accelerations,
    })
}

/// The position of C from the driven angles.
#[inline(never)]
pub(crate) fn forward(case: &Case) -> Result<Vector2<f32>, PoseError> {
    let [theta1, theta4] = case.driven;
    let pose = case.arm.geometry().forward(theta1, theta4, case.assembly)?;
    Ok(pose.c)
}

/// The driven angles from the position of C.
#[inline(never)]
pub(crate) fn inverse(case: &Case) -> Result<[f32; 2], PoseError> {
    let pose = case.arm.geometry().inverse(case.c, MODE)?;
    Ok([pose.u1.polar_angle(), pose.u4.polar_angle()])
}

/// Joint rates and accelerations from the velocity and acceleration of C.
#[inline(never)]
pub(crate) fn inverse_motion(
    case: &Case,
) -> Result<(Velocities<f32>, Accelerations<f32>), PoseError> {
    let geometry = case.arm.geometry();
    let velocities = geometry.inverse_velocities(&case.pose, case.velocities.c)?;
    let accelerations =
        geometry.inverse_accelerations(&case.pose, &velocities, case.accelerations.c)?;
    Ok((velocities, accelerations))
}

/// The velocity and acceleration of C from those of the joints.
#[inline(never)]
pub(crate) fn forward_motion(
    case: &Case,
) -> Result<(Velocities<f32>, Accelerations<f32>), PoseError> {
    let geometry = case.arm.geometry();
    let [omega1, _, _, omega4] = case.velocities.omega;
    let [alpha1, _, _, alpha4] = case.accelerations.alpha;
    let velocities = geometry.forward_velocities(&case.pose, omega1, omega4)?;
    let accelerations = geometry.forward_accelerations(&case.pose, &velocities, alpha1, alpha4)?;
    Ok((velocities, accelerations))
}

/// The driving torques of a pose in motion.
#[inline(never)]
pub(crate) fn inverse_dynamics(case: &Case) -> Result<[f32; 2], PoseError> {
    case.arm.inverse_dynamics(
        &case.pose,
        &case.velocities,
        &case.accelerations,
        Vector2::new(0.0, 0.0),
    )
}
