//! Positions, motion, torques and joint forces of the arm as functions of its inputs and their
//! rates, its lengths and its masses.

use super::DifferentiableModel;
use core::fmt;
use fivebar_kinematics::Scalar;
use fivebar_kinematics::dynamics::{Arm, Link, ModelError};
use fivebar_kinematics::five_bar::{Geometry, GeometryError, PoseError, Side};
use nalgebra::Vector2;

/// The names of the primitives, in the order of [`ArmAccuracyModel::primitives`].
pub const PRIMITIVES: [&str; 15] = [
    "θ1", "θ4", "ω1", "ω4", "α1", "α4", "l1", "l2", "l3", "l4", "base", "m1", "m2", "m3", "m4",
];

/// The names of the results of an [`ArmAccuracyModel`], in their order: C and its rates from
/// the middle of the base [m, m/s, m/s²], torques [N·m], joint forces [N].
pub const RESULTS: [&str; 18] = [
    "position x",
    "position y",
    "velocity x",
    "velocity y",
    "acceleration x",
    "acceleration y",
    "τ1",
    "τ4",
    "force A x",
    "force A y",
    "force B x",
    "force B y",
    "force C x",
    "force C y",
    "force D x",
    "force D y",
    "force E x",
    "force E y",
];

/// The inputs of a state: angles [rad], speeds [rad/s], accelerations [rad/s²] of joints 1
/// and 4.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DrivenJointMotion {
    /// θ1, θ4.
    pub theta: [f64; 2],
    /// ω1, ω4.
    pub omega: [f64; 2],
    /// α1, α4.
    pub alpha: [f64; 2],
}

/// An arm in one assembly mode, under a force on C, as a function of its
/// primitives. A link's moment of inertia scales with its mass.
#[derive(Clone, Copy, Debug)]
pub struct ArmAccuracyModel<'a> {
    /// The nominal arm.
    pub arm: &'a Arm<f64>,
    /// The forward branch.
    pub assembly: Side,
    /// A force on C [N].
    pub external_force: Vector2<f64>,
}

/// Why an arm with these dimensions has no result.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum ArmAccuracyError {
    /// The lengths are not a five-bar.
    Geometry(GeometryError),
    /// A mass or an inertia is not valid.
    Model(ModelError),
    /// There is no such pose.
    Pose(PoseError),
}

impl fmt::Display for ArmAccuracyError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Geometry(error) => error.fmt(f),
            Self::Model(error) => error.fmt(f),
            Self::Pose(error) => error.fmt(f),
        }
    }
}

impl core::error::Error for ArmAccuracyError {}

impl From<PoseError> for ArmAccuracyError {
    fn from(error: PoseError) -> Self {
        Self::Pose(error)
    }
}

impl ArmAccuracyModel<'_> {
    /// The nominal values of the primitives at a state, in the order of [`PRIMITIVES`].
    pub fn primitives(&self, inputs: &DrivenJointMotion) -> [f64; 15] {
        let [l1, l2, l3, l4, base] = self.arm.geometry().lengths();
        let [m1, m2, m3, m4] = self.arm.links().map(|link| link.mass);
        let DrivenJointMotion {
            theta: [theta1, theta4],
            omega: [omega1, omega4],
            alpha: [alpha1, alpha4],
        } = *inputs;
        [
            theta1, theta4, omega1, omega4, alpha1, alpha4, l1, l2, l3, l4, base, m1, m2, m3, m4,
        ]
    }

    /// The arm with other lengths and masses.
    fn with<S: Scalar>(&self, lengths: [S; 5], masses: [S; 4]) -> Result<Arm<S>, ArmAccuracyError> {
        let number = S::from_f64;
        let vector = |v: Vector2<f64>| Vector2::new(number(v.x), number(v.y));
        let geometry = Geometry::new(lengths).map_err(ArmAccuracyError::Geometry)?;
        let links = core::array::from_fn(|index| {
            let (mass, nominal) = (masses[index], self.arm.links()[index]);
            let inertia = if nominal.mass > 0.0 {
                mass * number(nominal.inertia / nominal.mass)
            } else {
                number(nominal.inertia)
            };
            Link {
                mass,
                com: vector(nominal.com),
                inertia,
            }
        });
        Arm::new(
            geometry,
            links,
            number(self.arm.payload()),
            vector(self.arm.gravity()),
            self.arm.rotor_inertia().map(number),
        )
        .map_err(ArmAccuracyError::Model)
    }

    /// The results, in the order of [`RESULTS`], at these values of the primitives.
    ///
    /// # Errors
    /// Where there is no such arm or no such pose.
    pub(super) fn results<S: Scalar>(
        &self,
        primitives: [S; 15],
    ) -> Result<[S; 18], ArmAccuracyError> {
        let [
            theta1,
            theta4,
            omega1,
            omega4,
            alpha1,
            alpha4,
            l1,
            l2,
            l3,
            l4,
            base,
            m1,
            m2,
            m3,
            m4,
        ] = primitives;
        let arm = self.with([l1, l2, l3, l4, base], [m1, m2, m3, m4])?;
        let geometry = arm.geometry();
        let pose = geometry.forward(theta1, theta4, self.assembly)?;
        let velocities = geometry.forward_velocities(&pose, omega1, omega4)?;
        let accelerations = geometry.forward_accelerations(&pose, &velocities, alpha1, alpha4)?;
        let force = Vector2::new(
            S::from_f64(self.external_force.x),
            S::from_f64(self.external_force.y),
        );
        let forces = arm.reactions(&pose, &velocities, &accelerations, force)?;
        let tool = pose.c - Vector2::new(S::HALF * base, S::ZERO);
        let ([c1, c2], [torque1, torque4]) = ([velocities.c, accelerations.c], forces.torque);
        let [a, b, c, d, e] = [forces.a, forces.b, forces.c, forces.d, forces.e];
        Ok([
            tool.x, tool.y, c1.x, c1.y, c2.x, c2.y, torque1, torque4, a.x, a.y, b.x, b.y, c.x, c.y,
            d.x, d.y, e.x, e.y,
        ])
    }
}

impl DifferentiableModel for ArmAccuracyModel<'_> {
    type Error = ArmAccuracyError;

    fn evaluate<S: Scalar>(&self, primitives: &[S]) -> Result<Vec<S>, ArmAccuracyError> {
        let not_all = |_| ArmAccuracyError::Pose(PoseError::NotFinite);
        let primitives = primitives.try_into().map_err(not_all)?;
        self.results(primitives).map(Vec::from)
    }
}
