// build.rs replaces `f32` by `f64` in this file for the functions in double precision.

use crate::answer::{answer, given, store};
use crate::opaque::{Opaque, prepared};
use crate::plain::{FootDrive, Geometry, Jacobian, Joints, Lengths, Offset, Pose, Side, Tool};
use crate::plain::{Vector, Velocities, WorkingMode, checked_side, side};
use crate::status::Status;
use core::mem::MaybeUninit;
use fivebar_kinematics::five_bar;
use fivebar_kinematics::nalgebra::Vector2;

/// Checks the lengths and prepares the arm for the other functions: call it once for each arm.
/// Refused: LENGTH_..., which names the length; CANNOT_ASSEMBLE.
#[unsafe(no_mangle)]
pub extern "C" fn fivebar_geometry_f32(
    lengths: Lengths<f32>,
    geometry: Option<&mut MaybeUninit<Geometry<f32>>>,
) -> Status {
    store(
        geometry,
        || {
            let Lengths {
                l1,
                l2,
                l3,
                l4,
                base,
            } = lengths;
            Ok(five_bar::Geometry::new([l1, l2, l3, l4, base])?)
        },
        Geometry::store,
    )
}

/// The pose of these angles of links 1 and 4 [rad]; assembly is FIVEBAR_LEFT for C to the left of the ray from B
/// to D. Refused: ELBOWS_..., SINGULAR_PARALLEL where B is on D, NOT_FINITE, NO_SUCH_SIDE.
#[unsafe(no_mangle)]
pub extern "C" fn fivebar_forward_f32(
    geometry: Option<&Geometry<f32>>,
    angle: Joints<f32>,
    assembly: Side,
    pose: Option<&mut MaybeUninit<Pose<f32>>>,
) -> Status {
    answer(pose, || {
        let assembly = checked_side(assembly)?;
        Ok(prepared(geometry)?.forward(angle.joint1, angle.joint4, assembly)?)
    })
}

/// The pose that has C at a point [m].
/// Refused: LEG1_... and LEG4_... out of reach, SINGULAR_LEG... where C is on A or E, NOT_FINITE, NO_SUCH_SIDE.
/// A straight or folded leg is no error here; its velocities are refused.
#[unsafe(no_mangle)]
pub extern "C" fn fivebar_inverse_f32(
    geometry: Option<&Geometry<f32>>,
    c: Vector<f32>,
    mode: WorkingMode,
    pose: Option<&mut MaybeUninit<Pose<f32>>>,
) -> Status {
    answer(pose, || {
        let mode = mode.checked()?;
        Ok(prepared(geometry)?.inverse(c.into(), mode)?)
    })
}

/// The angles of links 1 and 4 [rad], in (-pi, pi].
#[unsafe(no_mangle)]
pub extern "C" fn fivebar_angles_f32(
    pose: Option<&Pose<f32>>,
    angle: Option<&mut MaybeUninit<Joints<f32>>>,
) -> Status {
    answer(angle, || {
        let [theta1, _, _, theta4] = five_bar::Pose::from(given(pose)?).angles();
        Ok([theta1, theta4])
    })
}

/// The assembly of a pose, which fivebar_forward_f32 takes.
#[unsafe(no_mangle)]
pub extern "C" fn fivebar_assembly_f32(
    pose: Option<&Pose<f32>>,
    assembly: Option<&mut MaybeUninit<Side>>,
) -> Status {
    answer(assembly, || {
        Ok(side(five_bar::Pose::from(given(pose)?).assembly()))
    })
}

/// The working mode of a pose, which fivebar_inverse_f32 takes.
#[unsafe(no_mangle)]
pub extern "C" fn fivebar_working_mode_f32(
    pose: Option<&Pose<f32>>,
    mode: Option<&mut MaybeUninit<WorkingMode>>,
) -> Status {
    answer(mode, || {
        Ok(five_bar::Pose::from(given(pose)?).working_mode())
    })
}

/// All velocities from the rates of links 1 and 4 [rad/s].
/// Refused: SINGULAR_PARALLEL.
#[unsafe(no_mangle)]
pub extern "C" fn fivebar_forward_velocities_f32(
    geometry: Option<&Geometry<f32>>,
    pose: Option<&Pose<f32>>,
    rate: Joints<f32>,
    velocities: Option<&mut MaybeUninit<Velocities<f32>>>,
) -> Status {
    answer(velocities, || {
        let pose = given(pose)?.into();
        Ok(prepared(geometry)?.forward_velocities(&pose, rate.joint1, rate.joint4)?)
    })
}

/// All velocities from that of C [m/s].
/// Refused: SINGULAR_LEG1, SINGULAR_LEG4.
#[unsafe(no_mangle)]
pub extern "C" fn fivebar_inverse_velocities_f32(
    geometry: Option<&Geometry<f32>>,
    pose: Option<&Pose<f32>>,
    c_velocity: Vector<f32>,
    velocities: Option<&mut MaybeUninit<Velocities<f32>>>,
) -> Status {
    answer(velocities, || {
        let pose = given(pose)?.into();
        Ok(prepared(geometry)?.inverse_velocities(&pose, c_velocity.into())?)
    })
}

/// The Jacobian of C.
/// Refused: SINGULAR_PARALLEL.
#[unsafe(no_mangle)]
pub extern "C" fn fivebar_jacobian_f32(
    geometry: Option<&Geometry<f32>>,
    pose: Option<&Pose<f32>>,
    jacobian: Option<&mut MaybeUninit<Jacobian<f32>>>,
) -> Status {
    answer(jacobian, || {
        let pose = given(pose)?.into();
        Ok(prepared(geometry)?.jacobian(&pose)?)
    })
}

/// The torques [N m] with which the motors hold against a force [N] on C, or on T with the Jacobian of T: -J^T F.
/// Positive turns counter-clockwise.
#[unsafe(no_mangle)]
pub extern "C" fn fivebar_hold_torque_f32(
    jacobian: Option<&Jacobian<f32>>,
    force: Vector<f32>,
    torque: Option<&mut MaybeUninit<Joints<f32>>>,
) -> Status {
    answer(torque, || {
        let torque = five_bar::Jacobian::from(given(jacobian)?).torques(force.into());
        Ok(torque.map(|torque| -torque))
    })
}

/// A whole control period of a leg: angles, rates and holding torques of the motors for the foot C at a point [m]
/// with a velocity [m/s] and a force [N] of the ground on it. Faster than the functions above one after another.
/// Refused: as fivebar_inverse_f32, and every singularity.
#[unsafe(no_mangle)]
pub extern "C" fn fivebar_drive_foot_f32(
    geometry: Option<&Geometry<f32>>,
    foot: Vector<f32>,
    velocity: Vector<f32>,
    force: Vector<f32>,
    knees: WorkingMode,
    drive: Option<&mut MaybeUninit<FootDrive<f32>>>,
) -> Status {
    answer(drive, || {
        let knees = knees.checked()?;
        Ok(prepared(geometry)?.drive_foot(foot.into(), velocity.into(), force.into(), knees)?)
    })
}

/// Prepares an arm with a tool T beside C: call it once for each tool. The geometry is copied.
/// Refused: TOOL_OFFSET.
#[unsafe(no_mangle)]
pub extern "C" fn fivebar_tool_f32(
    geometry: Option<&Geometry<f32>>,
    offset: Offset<f32>,
    tool: Option<&mut MaybeUninit<Tool<f32>>>,
) -> Status {
    store(
        tool,
        || {
            let offset = Vector2::new(offset.along, offset.left);
            Ok(five_bar::Tool::new(*prepared(geometry)?, offset)?)
        },
        Tool::store,
    )
}

/// Where T is [m].
#[unsafe(no_mangle)]
pub extern "C" fn fivebar_tool_point_f32(
    tool: Option<&Tool<f32>>,
    pose: Option<&Pose<f32>>,
    point: Option<&mut MaybeUninit<Vector<f32>>>,
) -> Status {
    answer(point, || {
        let pose = given(pose)?.into();
        Ok(prepared(tool)?.point(&pose))
    })
}

/// The pose that has T at a point [m].
/// Refused: as fivebar_inverse_f32; leg 1 is A, B, T here.
#[unsafe(no_mangle)]
pub extern "C" fn fivebar_tool_inverse_f32(
    tool: Option<&Tool<f32>>,
    t: Vector<f32>,
    mode: WorkingMode,
    pose: Option<&mut MaybeUninit<Pose<f32>>>,
) -> Status {
    answer(pose, || {
        let mode = mode.checked()?;
        Ok(prepared(tool)?.inverse(t.into(), mode)?)
    })
}

/// The velocity of T [m/s] from those of the links and of C.
#[unsafe(no_mangle)]
pub extern "C" fn fivebar_tool_velocity_f32(
    tool: Option<&Tool<f32>>,
    pose: Option<&Pose<f32>>,
    velocities: Option<&Velocities<f32>>,
    velocity: Option<&mut MaybeUninit<Vector<f32>>>,
) -> Status {
    answer(velocity, || {
        let pose = given(pose)?.into();
        let velocities = given(velocities)?.into();
        Ok(prepared(tool)?.velocity(&pose, &velocities))
    })
}

/// All velocities from that of T [m/s].
/// Refused: SINGULAR_LEG1, where A, B, T are in line; SINGULAR_LEG4.
#[unsafe(no_mangle)]
pub extern "C" fn fivebar_tool_inverse_velocities_f32(
    tool: Option<&Tool<f32>>,
    pose: Option<&Pose<f32>>,
    t_velocity: Vector<f32>,
    velocities: Option<&mut MaybeUninit<Velocities<f32>>>,
) -> Status {
    answer(velocities, || {
        let pose = given(pose)?.into();
        Ok(prepared(tool)?.inverse_velocities(&pose, t_velocity.into())?)
    })
}

/// The Jacobian of T.
/// Refused: SINGULAR_PARALLEL.
#[unsafe(no_mangle)]
pub extern "C" fn fivebar_tool_jacobian_f32(
    tool: Option<&Tool<f32>>,
    pose: Option<&Pose<f32>>,
    jacobian: Option<&mut MaybeUninit<Jacobian<f32>>>,
) -> Status {
    answer(jacobian, || {
        let pose = given(pose)?.into();
        Ok(prepared(tool)?.jacobian(&pose)?)
    })
}
