//! The closed chain A–B–C–D–E in full coordinates, held together by constraint forces.
//!
//! Four bodies with three coordinates each; five joints, k = 0…4 for A…E, each between
//! body k−1 and body k (the ground stands at both ends). Joint k closes when
//!
//! gₖ = (pₖ + near) − (pₖ₋₁ + far) = 0,
//!
//! and Fₖ is the force that passes through it onto body k. With the accelerations a₀ that
//! the applied forces alone would give, g̈ = J a₀ + J M⁻¹Jᵀ F + (centripetal terms) = 0
//! makes F. Each joint shares a body with its two neighbours only, so J M⁻¹Jᵀ is
//! block-tridiagonal, five blocks of 2 × 2, and is solved by block elimination.
//!
//! This shares nothing with the controller's model: no partial velocities, no closed-form
//! solution of the loop.

use super::planar::{Body, Planar, perp, turn};
use nalgebra::{Matrix2, Vector2};
use std::array::from_fn;

/// Number of joints: A, B, C, D, E.
pub const JOINTS: usize = 5;

/// One vector for each joint, A to E.
pub type PerJoint = [Vector2<f64>; JOINTS];

/// The bodies and where the ends of the chain are held.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chain {
    /// Links 1, 2, 3, 4: from A to E along the chain.
    pub bodies: [Body; 4],
    /// The ground pivots A and E [m].
    pub pivots: [Vector2<f64>; 2],
    /// The joints that are held together by constraint; the others are left to whatever
    /// forces act in them.
    pub held: [bool; JOINTS],
}

/// The bodies' joints, seen from their centres of mass in the plane's directions.
#[derive(Clone, Copy, Debug)]
pub(super) struct Arms {
    pub(super) near: [Vector2<f64>; 4],
    pub(super) far: [Vector2<f64>; 4],
}

impl Arms {
    /// Adds what the joint forces do to the accelerations of the bodies.
    #[inline]
    fn push(&self, chain: &Chain, forces: &PerJoint, motion: &mut [Planar; 4]) {
        for i in 0..4 {
            let body = &chain.bodies[i];
            motion[i] = motion[i]
                + body.pushed(self.near[i], forces[i])
                + body.pushed(self.far[i], -forces[i + 1]);
        }
    }

    /// Of each joint, the relative velocity of the bodies that move so, or their relative
    /// acceleration without the centripetal terms: J a.
    #[inline]
    pub(super) fn opening(&self, motion: &[Planar; 4]) -> PerJoint {
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
    /// The joints' places seen from the centres of mass, at these coordinates.
    #[inline]
    pub(super) fn arms(&self, q: &[Planar; 4]) -> Arms {
        let turns = q.map(|q| turn(q.angular));
        Arms {
            near: from_fn(|i| turns[i] * self.bodies[i].near),
            far: from_fn(|i| turns[i] * self.bodies[i].far),
        }
    }

    /// How far each joint has come apart, gₖ [m].
    pub fn gaps(&self, q: &[Planar; 4]) -> PerJoint {
        self.gaps_with(&self.arms(q), q)
    }

    #[inline]
    pub(super) fn gaps_with(&self, arms: &Arms, q: &[Planar; 4]) -> PerJoint {
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

    /// The matrix J M⁻¹Jᵀ at these arms.
    #[inline]
    pub(super) fn schur(&self, arms: &Arms) -> Tridiagonal {
        let body = &self.bodies;
        let (near, far) = (&arms.near, &arms.far);
        let mut matrix = Tridiagonal {
            diagonal: [Matrix2::zeros(); JOINTS],
            upper: [Matrix2::zeros(); JOINTS - 1],
        };
        for i in 0..4 {
            matrix.diagonal[i] += body[i].mobility(near[i], near[i]);
            matrix.diagonal[i + 1] += body[i].mobility(far[i], far[i]);
            matrix.upper[i] = -body[i].mobility(near[i], far[i]);
        }
        for k in (0..JOINTS).filter(|&k| !self.held[k]) {
            matrix.leave_out(k);
        }
        matrix
    }

    /// What the joint forces are made from, for the joints that are held.
    #[inline]
    fn of_held(&self, mut each: PerJoint) -> PerJoint {
        for (each, held) in each.iter_mut().zip(self.held) {
            if !held {
                *each = Vector2::zeros();
            }
        }
        each
    }

    /// Accelerations of the bodies, and the joint forces, when the applied forces alone
    /// would accelerate them by `free` (a₀ = M⁻¹ f).
    #[inline]
    pub(super) fn accelerations(
        &self,
        arms: &Arms,
        v: &[Planar; 4],
        free: &[Planar; 4],
    ) -> ([Planar; 4], PerJoint) {
        let mut opening = arms.opening(free);
        for i in 0..4 {
            // A point at r from the centre also accelerates by −ω² r.
            let omega_squared = v[i].angular * v[i].angular;
            opening[i] -= arms.near[i] * omega_squared;
            opening[i + 1] += arms.far[i] * omega_squared;
        }
        let opening = self.of_held(opening);
        let forces = self.schur(arms).factored().solve(&opening).map(|f| -f);
        let mut accelerations = *free;
        arms.push(self, &forces, &mut accelerations);
        (accelerations, forces)
    }

    /// Brings the joints that are held together again, places and speeds, by the least change in the
    /// sense of the bodies' inertia.
    pub(super) fn close(&self, q: &mut [Planar; 4], v: &mut [Planar; 4]) {
        // Newton's method; what is left after an integration step is so small that the
        // first pass ends it.
        for _ in 0..MAX_PASSES {
            let arms = self.arms(q);
            let gaps = self.of_held(self.gaps_with(&arms, q));
            let matrix = self.schur(&arms).factored();
            if gaps.iter().all(|gap| gap.amax() <= CLOSED) {
                let opening = self.of_held(arms.opening(v));
                arms.push(self, &matrix.solve(&opening).map(|f| -f), v);
                return;
            }
            arms.push(self, &matrix.solve(&gaps).map(|f| -f), q);
        }
    }
}

/// Joints nearer than this are together [m]: well below 1e-10 m, well above rounding.
const CLOSED: f64 = 1e-13;
/// Passes after which a chain is taken not to close; a step of integration needs one.
const MAX_PASSES: usize = 20;

/// A symmetric block-tridiagonal matrix.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tridiagonal {
    diagonal: [Matrix2<f64>; JOINTS],
    /// Between joints k and k + 1; the lower blocks are their transposes.
    upper: [Matrix2<f64>; JOINTS - 1],
}

/// The same after block elimination: D′ₖ = Dₖ − Uₖ₋₁ᵀ D′ₖ₋₁⁻¹ Uₖ₋₁.
#[derive(Clone, Copy, Debug)]
pub(super) struct Factored {
    inverse: [Matrix2<f64>; JOINTS],
    upper: [Matrix2<f64>; JOINTS - 1],
}

impl Tridiagonal {
    /// Parts joint k from the others: with nothing on the right, its force is nothing.
    fn leave_out(&mut self, k: usize) {
        self.diagonal[k] = Matrix2::identity();
        for beside in [k.checked_sub(1), Some(k)].into_iter().flatten() {
            if let Some(block) = self.upper.get_mut(beside) {
                *block = Matrix2::zeros();
            }
        }
    }

    #[inline]
    pub(super) fn factored(&self) -> Factored {
        let mut inverse = [Matrix2::zeros(); JOINTS];
        inverse[0] = inverted(self.diagonal[0]);
        for k in 1..JOINTS {
            let upper = self.upper[k - 1];
            inverse[k] = inverted(self.diagonal[k] - upper.transpose() * inverse[k - 1] * upper);
        }
        Factored {
            inverse,
            upper: self.upper,
        }
    }
}

impl Factored {
    #[inline]
    pub(super) fn solve(&self, right: &PerJoint) -> PerJoint {
        let mut x = *right;
        for k in 1..JOINTS {
            x[k] -= self.upper[k - 1].transpose() * (self.inverse[k - 1] * x[k - 1]);
        }
        x[JOINTS - 1] = self.inverse[JOINTS - 1] * x[JOINTS - 1];
        for k in (0..JOINTS - 1).rev() {
            x[k] = self.inverse[k] * (x[k] - self.upper[k] * x[k + 1]);
        }
        x
    }
}

/// The inverse of a symmetric positive definite block.
///
/// With all links in one line the last block loses its rank: the forces along the line
/// are not determined. Keeping the determinant above its rounding error picks finite ones.
#[inline]
fn inverted(m: Matrix2<f64>) -> Matrix2<f64> {
    let (a, b, c, d) = (m[(0, 0)], m[(0, 1)], m[(1, 0)], m[(1, 1)]);
    let per_determinant = 1.0 / (a * d - b * c).max(f64::EPSILON * a * d);
    Matrix2::new(d, -b, -c, a) * per_determinant
}
