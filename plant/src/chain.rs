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

use crate::lanes::{Lanes, Mask, Real};
use crate::planar::{Body, PlanarVector, perp, rotation, times, transpose_times};
use nalgebra::{Matrix2, Scalar, Vector2};
use std::array::from_fn;

/// Number of joints: A, B, C, D, E.
pub const JOINTS: usize = 5;

/// One vector for each joint, A to E.
pub type PerJoint<T = f64> = [Vector2<T>; JOINTS];

/// The bodies, and the ground pivots at the ends of the chain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chain<T: Scalar = f64> {
    /// Links 1, 2, 3, 4: from A to E along the chain.
    pub bodies: [Body<T>; 4],
    /// The ground pivots A and E [m].
    pub pivots: [Vector2<T>; 2],
    /// Whether each joint is closed by a constraint. In the others only contact forces act.
    pub constrained: [bool; JOINTS],
}

/// The vectors from the bodies' centres of mass to their joints, in the frame of the base [m].
#[derive(Clone, Copy, Debug)]
pub(crate) struct LeverArms<T: Scalar = f64> {
    pub(crate) near: [Vector2<T>; 4],
    pub(crate) far: [Vector2<T>; 4],
}

impl<T: Real> LeverArms<T> {
    /// Adds the accelerations that the joint forces give to the bodies.
    #[inline(always)]
    fn apply(&self, chain: &Chain<T>, forces: &PerJoint<T>, motion: &mut [PlanarVector<T>; 4]) {
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
    pub(crate) fn joint_motion(&self, motion: &[PlanarVector<T>; 4]) -> PerJoint<T> {
        let at = |i: usize, r: Vector2<T>| motion[i].linear + perp(r) * motion[i].angular;
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
    /// The gap gₖ of each joint [m].
    pub fn gaps(&self, q: &[PlanarVector; 4]) -> PerJoint {
        self.gaps_with(&self.arms(q), q)
    }
}

impl<const N: usize> Chain<Lanes<N>> {
    /// Several chains with the same constraints, side by side.
    #[inline(always)]
    pub(crate) fn beside(chains: [&Chain; N]) -> Self {
        Self {
            bodies: from_fn(|i| Body {
                mass: Lanes(chains.map(|chain| chain.bodies[i].mass)),
                inertia: Lanes(chains.map(|chain| chain.bodies[i].inertia)),
                near: vectors(chains.map(|chain| chain.bodies[i].near)),
                far: vectors(chains.map(|chain| chain.bodies[i].far)),
            }),
            pivots: from_fn(|end| vectors(chains.map(|chain| chain.pivots[end]))),
            constrained: chains[0].constrained,
        }
    }
}

#[inline(always)]
fn vectors<const N: usize>(vectors: [Vector2<f64>; N]) -> Vector2<Lanes<N>> {
    Vector2::new(
        Lanes(vectors.map(|vector| vector.x)),
        Lanes(vectors.map(|vector| vector.y)),
    )
}

impl<T: Real> Chain<T> {
    /// The lever arms at these coordinates.
    #[inline(always)]
    pub(crate) fn arms(&self, q: &[PlanarVector<T>; 4]) -> LeverArms<T> {
        // Loops: the functions of `core` that map arrays are not compiled into this one where it is of many lanes.
        let zero = Vector2::new(T::zero(), T::zero());
        let (mut near, mut far) = ([zero; 4], [zero; 4]);
        for i in 0..4 {
            let rotation = rotation(q[i].angular);
            near[i] = times(&rotation, self.bodies[i].near);
            far[i] = times(&rotation, self.bodies[i].far);
        }
        LeverArms { near, far }
    }

    #[inline(always)]
    pub(crate) fn gaps_with(&self, arms: &LeverArms<T>, q: &[PlanarVector<T>; 4]) -> PerJoint<T> {
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
    pub(crate) fn schur(&self, arms: &LeverArms<T>) -> Tridiagonal<T> {
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
    fn constrained_only(&self, mut each: PerJoint<T>) -> PerJoint<T> {
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
        arms: &LeverArms<T>,
        v: &[PlanarVector<T>; 4],
        free: &[PlanarVector<T>; 4],
    ) -> ([PlanarVector<T>; 4], PerJoint<T>) {
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
    #[inline(always)]
    pub(crate) fn close_joints(&self, q: &mut [PlanarVector<T>; 4], v: &mut [PlanarVector<T>; 4]) {
        // Newton's method. After an integration step the gaps are so small that one pass is
        // enough.
        let mut open = T::ALL;
        for _ in 0..MAX_PASSES {
            let arms = self.arms(q);
            let gaps = self.constrained_only(self.gaps_with(&arms, q));
            let matrix = self.schur(&arms).factored();
            let small =
                |closed, gap: &Vector2<T>| closed & gap.x.within(CLOSED) & gap.y.within(CLOSED);
            let closed = gaps.iter().fold(open, small);
            if closed != 0 {
                let relative = self.constrained_only(arms.joint_motion(v));
                let mut moved = *v;
                arms.apply(self, &negated(matrix.solve(&relative)), &mut moved);
                replace(v, &moved, closed);
            }
            open &= !closed;
            if open == 0 {
                return;
            }
            let mut moved = *q;
            arms.apply(self, &negated(matrix.solve(&gaps)), &mut moved);
            replace(q, &moved, open);
        }
    }
}

/// Takes the lanes that are in the mask.
#[inline(always)]
fn replace<T: Real>(own: &mut [PlanarVector<T>; 4], other: &[PlanarVector<T>; 4], mask: Mask) {
    for (own, other) in own.iter_mut().zip(other) {
        *own = own.with(*other, mask);
    }
}

/// A joint with a smaller gap is closed [m]: well below 1e-10 m, well above rounding.
const CLOSED: f64 = 1e-13;
/// Most passes; after an integration step one is enough.
const MAX_PASSES: usize = 20;

/// A symmetric block-tridiagonal matrix.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tridiagonal<T: Scalar> {
    diagonal: [Matrix2<T>; JOINTS],
    /// Between joints k and k + 1; the lower blocks are their transposes.
    upper: [Matrix2<T>; JOINTS - 1],
}

/// The matrix after block elimination: D′ₖ = Dₖ − Uₖ₋₁ᵀ D′ₖ₋₁⁻¹ Uₖ₋₁.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Factored<T: Scalar> {
    inverse: [Matrix2<T>; JOINTS],
    upper: [Matrix2<T>; JOINTS - 1],
}

impl<T: Real> Tridiagonal<T> {
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
    pub(crate) fn factored(&self) -> Factored<T> {
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

impl<T: Real> Factored<T> {
    #[inline(always)]
    pub(crate) fn solve(&self, right: &PerJoint<T>) -> PerJoint<T> {
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
fn by_columns<T: Real>(m: &Matrix2<T>, mapped: impl Fn(Vector2<T>) -> Vector2<T>) -> Matrix2<T> {
    let first = mapped(Vector2::new(m[(0, 0)], m[(1, 0)]));
    let second = mapped(Vector2::new(m[(0, 1)], m[(1, 1)]));
    Matrix2::new(first.x, second.x, first.y, second.y)
}

/// The vectors in the opposite direction.
#[inline(always)]
fn negated<T: Real>(mut each: PerJoint<T>) -> PerJoint<T> {
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
fn inverted<T: Real>(m: Matrix2<T>) -> Matrix2<T> {
    let (a, b, c, d) = (m[(0, 0)], m[(0, 1)], m[(1, 0)], m[(1, 1)]);
    let per_determinant = T::one() / (a * d - b * c).max(T::each(f64::EPSILON) * a * d);
    Matrix2::new(d, -b, -c, a) * per_determinant
}
