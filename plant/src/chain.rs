//! The closed chain A–B–C–D–E in full coordinates with constraint forces.
//!
//! Four bodies have three coordinates each; five joints, k = 0…4 for A…E, connect body k−1
//! and body k (the ground is at both ends). Joint k is closed when
//!
//! gₖ = (pₖ + near) − (pₖ₋₁ + far) = 0,
//!
//! and Fₖ is the force of the joint on body k. a₀ are the accelerations that the applied
//! forces alone would give. F follows from g̈ = J a₀ + J M⁻¹Jᵀ F + (centripetal terms) = 0.
//! Each joint shares a body with its two neighbours only, so J M⁻¹Jᵀ is block-tridiagonal
//! with five 2 × 2 blocks on its diagonal, and block elimination solves it.
//!
//! This shares nothing with the controller's model: it has no partial velocities and no
//! closed-form solution of the loop.

use crate::planar::{Body, PlanarVector, perp, rotation, times, transpose_times};
use nalgebra::{Matrix2, Vector2};
use std::array::from_fn;

/// Number of joints: A, B, C, D, E.
pub const JOINTS: usize = 5;

/// One vector for each joint, A to E.
pub type PerJoint = [Vector2<f64>; JOINTS];

/// The bodies, and the ground pivots at the ends of the chain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chain {
    /// Links 1, 2, 3, 4: from A to E along the chain.
    pub bodies: [Body; 4],
    /// The ground pivots A and E [m].
    pub pivots: [Vector2<f64>; 2],
    /// Whether each joint is closed by a constraint. In the others only contact forces act.
    pub constrained: [bool; JOINTS],
}

/// The vectors from the bodies' centres of mass to their joints, in the frame of the base [m].
#[derive(Clone, Copy, Debug)]
pub(crate) struct LeverArms {
    pub(crate) near: [Vector2<f64>; 4],
    pub(crate) far: [Vector2<f64>; 4],
}

impl LeverArms {
    /// Adds the accelerations that the joint forces give to the bodies.
    #[inline(always)]
    fn apply(&self, chain: &Chain, forces: &PerJoint, motion: &mut [PlanarVector; 4]) {
        for i in 0..4 {
            let body = &chain.bodies[i];
            motion[i] = motion[i]
                + body.acceleration_by(self.near[i], forces[i])
                + body.acceleration_by(self.far[i], -forces[i + 1]);
        }
    }

    /// J v: the relative velocity of the two bodies at each joint; with accelerations, their
    /// relative acceleration without the centripetal terms.
    #[inline(always)]
    pub(crate) fn joint_motion(&self, motion: &[PlanarVector; 4]) -> PerJoint {
        let at = |i: usize, r: Vector2<f64>| motion[i].linear + perp(r) * motion[i].angular;
        [
            at(0, self.near[0]),
            at(1, self.near[1]) - at(0, self.far[0]),
            at(2, self.near[2]) - at(1, self.far[1]),
            at(3, self.near[3]) - at(2, self.far[2]),
            -at(3, self.far[3]),
        ]
    }
}

impl Chain {
    /// The lever arms at these coordinates.
    #[inline(always)]
    pub(crate) fn arms(&self, q: &[PlanarVector; 4]) -> LeverArms {
        let rotations = q.map(|q| rotation(q.angular));
        LeverArms {
            near: from_fn(|i| times(&rotations[i], self.bodies[i].near)),
            far: from_fn(|i| times(&rotations[i], self.bodies[i].far)),
        }
    }

    /// The gap gₖ of each joint [m].
    pub fn gaps(&self, q: &[PlanarVector; 4]) -> PerJoint {
        self.gaps_with(&self.arms(q), q)
    }

    #[inline(always)]
    pub(crate) fn gaps_with(&self, arms: &LeverArms, q: &[PlanarVector; 4]) -> PerJoint {
        let near = |i: usize| q[i].linear + arms.near[i];
        let far = |i: usize| q[i].linear + arms.far[i];
        [
            near(0) - self.pivots[0],
            near(1) - far(0),
            near(2) - far(1),
            near(3) - far(2),
            self.pivots[1] - far(3),
        ]
    }

    /// The matrix J M⁻¹Jᵀ at these lever arms.
    #[inline(always)]
    pub(crate) fn schur(&self, arms: &LeverArms) -> Tridiagonal {
        let body = &self.bodies;
        let (near, far) = (&arms.near, &arms.far);
        let mut matrix = Tridiagonal {
            diagonal: [Matrix2::zeros(); JOINTS],
            upper: [Matrix2::zeros(); JOINTS - 1],
        };
        for i in 0..4 {
            matrix.diagonal[i] += body[i].inverse_inertia(near[i], near[i]);
            matrix.diagonal[i + 1] += body[i].inverse_inertia(far[i], far[i]);
            matrix.upper[i] = -body[i].inverse_inertia(near[i], far[i]);
        }
        for k in (0..JOINTS).filter(|&k| !self.constrained[k]) {
            matrix.decouple(k);
        }
        matrix
    }

    /// Sets the entries of the joints without constraint to zero.
    #[inline(always)]
    fn constrained_only(&self, mut each: PerJoint) -> PerJoint {
        for (each, constrained) in each.iter_mut().zip(self.constrained) {
            if !constrained {
                *each = Vector2::zeros();
            }
        }
        each
    }

    /// Accelerations of the bodies and the joint forces; `free` are the accelerations by the
    /// applied forces alone, a₀ = M⁻¹ f.
    #[inline(always)]
    pub(crate) fn accelerations(
        &self,
        arms: &LeverArms,
        v: &[PlanarVector; 4],
        free: &[PlanarVector; 4],
    ) -> ([PlanarVector; 4], PerJoint) {
        let mut relative = arms.joint_motion(free);
        for i in 0..4 {
            // A point at r from the centre also accelerates by −ω² r.
            let omega_squared = v[i].angular * v[i].angular;
            relative[i] -= arms.near[i] * omega_squared;
            relative[i + 1] += arms.far[i] * omega_squared;
        }
        let relative = self.constrained_only(relative);
        let forces = negated(self.schur(arms).factored().solve(&relative));
        let mut accelerations = *free;
        arms.apply(self, &forces, &mut accelerations);
        (accelerations, forces)
    }

    /// Projects positions and velocities onto the constraints, by the least change in the
    /// metric of the bodies' inertia.
    pub(crate) fn close_joints(&self, q: &mut [PlanarVector; 4], v: &mut [PlanarVector; 4]) {
        // Newton's method. After an integration step the gaps are so small that one pass is
        // enough.
        for _ in 0..MAX_PASSES {
            let arms = self.arms(q);
            let gaps = self.constrained_only(self.gaps_with(&arms, q));
            let matrix = self.schur(&arms).factored();
            if gaps.iter().all(|gap| gap.amax() <= CLOSED) {
                let relative = self.constrained_only(arms.joint_motion(v));
                arms.apply(self, &negated(matrix.solve(&relative)), v);
                return;
            }
            arms.apply(self, &negated(matrix.solve(&gaps)), q);
        }
    }
}

/// A joint with a smaller gap is closed [m]: well below 1e-10 m, well above rounding.
const CLOSED: f64 = 1e-13;
/// Most passes; after an integration step one is enough.
const MAX_PASSES: usize = 20;

/// A symmetric block-tridiagonal matrix.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tridiagonal {
    diagonal: [Matrix2<f64>; JOINTS],
    /// Between joints k and k + 1; the lower blocks are their transposes.
    upper: [Matrix2<f64>; JOINTS - 1],
}

/// The matrix after block elimination: D′ₖ = Dₖ − Uₖ₋₁ᵀ D′ₖ₋₁⁻¹ Uₖ₋₁.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Factored {
    inverse: [Matrix2<f64>; JOINTS],
    upper: [Matrix2<f64>; JOINTS - 1],
}

impl Tridiagonal {
    /// Decouples joint k from the others: with a right-hand side of zero its force is zero.
    fn decouple(&mut self, k: usize) {
        self.diagonal[k] = Matrix2::identity();
        for beside in [k.checked_sub(1), Some(k)].into_iter().flatten() {
            if let Some(block) = self.upper.get_mut(beside) {
                *block = Matrix2::zeros();
            }
        }
    }

    #[inline(always)]
    pub(crate) fn factored(&self) -> Factored {
        let mut inverse = [Matrix2::zeros(); JOINTS];
        inverse[0] = inverted(self.diagonal[0]);
        for k in 1..JOINTS {
            let upper = self.upper[k - 1];
            // Uᵀ D′⁻¹ U, by columns.
            let left = by_columns(&inverse[k - 1], |column| transpose_times(&upper, column));
            let taken = by_columns(&upper, |column| times(&left, column));
            inverse[k] = inverted(self.diagonal[k] - taken);
        }
        Factored {
            inverse,
            upper: self.upper,
        }
    }
}

impl Factored {
    #[inline(always)]
    pub(crate) fn solve(&self, right: &PerJoint) -> PerJoint {
        let mut x = *right;
        for k in 1..JOINTS {
            x[k] -= transpose_times(&self.upper[k - 1], times(&self.inverse[k - 1], x[k - 1]));
        }
        x[JOINTS - 1] = times(&self.inverse[JOINTS - 1], x[JOINTS - 1]);
        for k in (0..JOINTS - 1).rev() {
            x[k] = times(&self.inverse[k], x[k] - times(&self.upper[k], x[k + 1]));
        }
        x
    }
}

/// The matrix whose columns are those of m, mapped.
#[inline(always)]
fn by_columns(m: &Matrix2<f64>, mapped: impl Fn(Vector2<f64>) -> Vector2<f64>) -> Matrix2<f64> {
    let first = mapped(Vector2::new(m[(0, 0)], m[(1, 0)]));
    let second = mapped(Vector2::new(m[(0, 1)], m[(1, 1)]));
    Matrix2::new(first.x, second.x, first.y, second.y)
}

/// The vectors in the opposite direction.
#[inline(always)]
fn negated(mut each: PerJoint) -> PerJoint {
    for vector in &mut each {
        *vector = Vector2::new(-vector.x, -vector.y);
    }
    each
}

/// The inverse of a symmetric positive definite block.
///
/// With all links in one line the last block is singular: the forces along the line are
/// undetermined. A determinant kept above its rounding error gives finite ones.
#[inline(always)]
fn inverted(m: Matrix2<f64>) -> Matrix2<f64> {
    let (a, b, c, d) = (m[(0, 0)], m[(0, 1)], m[(1, 0)], m[(1, 1)]);
    let per_determinant = 1.0 / (a * d - b * c).max(f64::EPSILON * a * d);
    Matrix2::new(d, -b, -c, a) * per_determinant
}
