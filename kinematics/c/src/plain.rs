//! The structs of the header, and the kinematics' types that they stand for.

use crate::status::Status;
use fivebar_kinematics::nalgebra::Vector2;
use fivebar_kinematics::{Scalar, five_bar};

/// A side of a directed line, with the plane's normal towards the viewer: FIVEBAR_LEFT or FIVEBAR_RIGHT.
pub type Side = u8;
/// To the left.
pub const LEFT: Side = 0;
/// To the right.
pub const RIGHT: Side = 1;

/// The five lengths of an arm [m].
#[repr(C)]
#[derive(Clone, Copy)]
pub struct Lengths<S> {
    /// A to B: the link that motor 1 turns.
    pub l1: S,
    /// B to C.
    pub l2: S,
    /// D to C.
    pub l3: S,
    /// E to D: the link that motor 4 turns.
    pub l4: S,
    /// A to E; 0 for coaxial motors.
    pub base: S,
}

/// A vector in the frame of the base: x from A to E, y to its left. The unit is that of the argument or field.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct Vector<S> {
    /// Along the base.
    pub x: S,
    /// To the left of the base.
    pub y: S,
}

/// A value of each driven joint. The unit is that of the argument or field.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct Joints<S> {
    /// Of the joint at A.
    pub joint1: S,
    /// Of the joint at E.
    pub joint4: S,
}

/// Which way each leg's elbow turns: the branch of the inverse solution.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct WorkingMode {
    /// FIVEBAR_LEFT where AB x BC > 0; with an offset tool T, where AB x BT > 0.
    pub elbow1: Side,
    /// FIVEBAR_LEFT where ED x DC > 0.
    pub elbow4: Side,
}

/// Where the tool T is from C [m]; both 0 put it on C.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct Offset<S> {
    /// Along link 2, away from B.
    pub along: S,
    /// To the left of link 2.
    pub left: S,
}

/// An arm of checked lengths. Only fivebar_geometry_... writes it; copy it freely, and leave its fields alone.
#[repr(C)]
pub struct Geometry<S> {
    fixed: [u64; 9],
    // An even number: C sees no padding, which it need not copy.
    real: [S; 34],
}

/// An arm with its tool. Only fivebar_tool_... writes it; copy it freely, and leave its fields alone.
#[repr(C)]
pub struct Tool<S> {
    fixed: [u64; 12],
    // Even too.
    real: [S; 50],
}

/// A closed configuration of the arm.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct Pose<S> {
    /// Unit vector of link 1, A to B.
    pub u1: Vector<S>,
    /// Unit vector of link 2, B to C.
    pub u2: Vector<S>,
    /// Unit vector of link 3, D to C.
    pub u3: Vector<S>,
    /// Unit vector of link 4, E to D.
    pub u4: Vector<S>,
    /// Elbow of leg 1 [m].
    pub b: Vector<S>,
    /// Where links 2 and 3 meet [m].
    pub c: Vector<S>,
    /// Elbow of leg 4 [m].
    pub d: Vector<S>,
}

/// Angular velocities of the links, and the velocity of C.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct Velocities<S> {
    /// Of link 1 [rad/s].
    pub omega1: S,
    /// Of link 2 [rad/s].
    pub omega2: S,
    /// Of link 3 [rad/s].
    pub omega3: S,
    /// Of link 4 [rad/s].
    pub omega4: S,
    /// Of C [m/s].
    pub c: Vector<S>,
}

/// The Jacobian J of C, or of the tool T: velocity = J (rate of joint 1, rate of joint 4).
#[repr(C)]
#[derive(Clone, Copy)]
pub struct Jacobian<S> {
    /// Its first column: the velocity for each unit of joint 1's rate [m].
    pub joint1: Vector<S>,
    /// Its second column: the velocity for each unit of joint 4's rate [m].
    pub joint4: Vector<S>,
}

/// What the motors of a leg need in a control period.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct FootDrive<S> {
    /// Angles of links 1 and 4 [rad], in (-pi, pi].
    pub angle: Joints<S>,
    /// Their rates [rad/s].
    pub rate: Joints<S>,
    /// Torques that hold against the force [N m].
    pub torque: Joints<S>,
}

impl WorkingMode {
    /// The kinematics' own, if both sides exist.
    pub(crate) fn checked(self) -> Result<five_bar::WorkingMode, Status> {
        let [elbow1, elbow4] = [checked_side(self.elbow1)?, checked_side(self.elbow4)?];
        Ok(five_bar::WorkingMode::new(elbow1, elbow4))
    }
}

/// The kinematics' own side, if it exists.
pub(crate) fn checked_side(side: Side) -> Result<five_bar::Side, Status> {
    match side {
        LEFT => Ok(five_bar::Side::Left),
        RIGHT => Ok(five_bar::Side::Right),
        _ => Err(Status::NoSuchSide),
    }
}

pub(crate) fn side(side: five_bar::Side) -> Side {
    match side {
        five_bar::Side::Left => LEFT,
        five_bar::Side::Right => RIGHT,
    }
}

impl From<five_bar::WorkingMode> for WorkingMode {
    fn from(mode: five_bar::WorkingMode) -> Self {
        let [elbow1, elbow4] = [mode.elbow1, mode.elbow4].map(side);
        Self { elbow1, elbow4 }
    }
}

impl<S> From<Vector<S>> for Vector2<S> {
    fn from(Vector { x, y }: Vector<S>) -> Self {
        Self::new(x, y)
    }
}

impl<S: Scalar> From<Vector2<S>> for Vector<S> {
    fn from(vector: Vector2<S>) -> Self {
        let [x, y] = vector.into();
        Self { x, y }
    }
}

impl<S> From<[S; 2]> for Joints<S> {
    fn from([joint1, joint4]: [S; 2]) -> Self {
        Self { joint1, joint4 }
    }
}

impl<S: Scalar> From<five_bar::Pose<S>> for Pose<S> {
    fn from(pose: five_bar::Pose<S>) -> Self {
        Self {
            u1: pose.u1.into(),
            u2: pose.u2.into(),
            u3: pose.u3.into(),
            u4: pose.u4.into(),
            b: pose.b.into(),
            c: pose.c.into(),
            d: pose.d.into(),
        }
    }
}

impl<S: Scalar> From<&Pose<S>> for five_bar::Pose<S> {
    fn from(pose: &Pose<S>) -> Self {
        Self {
            u1: pose.u1.into(),
            u2: pose.u2.into(),
            u3: pose.u3.into(),
            u4: pose.u4.into(),
            b: pose.b.into(),
            c: pose.c.into(),
            d: pose.d.into(),
        }
    }
}

impl<S: Scalar> From<five_bar::Velocities<S>> for Velocities<S> {
    fn from(velocities: five_bar::Velocities<S>) -> Self {
        let [omega1, omega2, omega3, omega4] = velocities.omega;
        Self {
            omega1,
            omega2,
            omega3,
            omega4,
            c: velocities.c.into(),
        }
    }
}

impl<S: Scalar> From<&Velocities<S>> for five_bar::Velocities<S> {
    fn from(from: &Velocities<S>) -> Self {
        Self {
            omega: [from.omega1, from.omega2, from.omega3, from.omega4],
            c: from.c.into(),
        }
    }
}

impl<S: Scalar> From<five_bar::Jacobian<S>> for Jacobian<S> {
    fn from(jacobian: five_bar::Jacobian<S>) -> Self {
        Self {
            joint1: jacobian.c1.into(),
            joint4: jacobian.c4.into(),
        }
    }
}

impl<S: Scalar> From<&Jacobian<S>> for five_bar::Jacobian<S> {
    fn from(jacobian: &Jacobian<S>) -> Self {
        Self {
            c1: jacobian.joint1.into(),
            c4: jacobian.joint4.into(),
        }
    }
}

impl<S> From<five_bar::FootDrive<S>> for FootDrive<S> {
    fn from(drive: five_bar::FootDrive<S>) -> Self {
        Self {
            angle: drive.angle.into(),
            rate: drive.rate.into(),
            torque: drive.torque.into(),
        }
    }
}
