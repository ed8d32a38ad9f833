//! Rigid bodies in the plane: three numbers for a body's position, velocity or acceleration.

use crate::lanes::{Lanes, Mask, Real};
use nalgebra::{Matrix2, Scalar, Vector2};
use std::ops::{Add, Mul};

/// Position of a body's centre of mass [m] and the body's angle [rad], or a time derivative
/// of both.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanarVector<T: Scalar = f64> {
    /// The linear part, of the centre of mass.
    pub linear: Vector2<T>,
    /// The angular part, counter-clockwise.
    pub angular: T,
}

impl PlanarVector {
    /// Zero.
    pub const ZERO: Self = Self {
        linear: Vector2::new(0.0, 0.0),
        angular: 0.0,
    };
}

impl<T: Real> PlanarVector<T> {
    /// The lanes of `other` that are in the mask, and the rest of its own.
    #[inline(always)]
    pub(crate) fn with(self, other: Self, mask: Mask) -> Self {
        let of = |own: T, other: T| own.with(other, mask);
        Self {
            linear: self.linear.zip_map(&other.linear, of),
            angular: of(self.angular, other.angular),
        }
    }
}

impl<const N: usize> PlanarVector<Lanes<N>> {
    /// That of one arm.
    #[inline(always)]
    pub(crate) fn lane(&self, i: usize) -> PlanarVector {
        PlanarVector {
            linear: Vector2::new(self.linear.x.0[i], self.linear.y.0[i]),
            angular: self.angular.0[i],
        }
    }
}

impl<T: Real> Add for PlanarVector<T> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self {
            linear: self.linear + other.linear,
            angular: self.angular + other.angular,
        }
    }
}

impl<T: Real> Mul<T> for PlanarVector<T> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, factor: T) -> Self {
        Self {
            linear: self.linear * factor,
            angular: self.angular * factor,
        }
    }
}

/// The vector rotated by +90°.
#[inline(always)]
pub(crate) fn perp<T: Real>(r: Vector2<T>) -> Vector2<T> {
    Vector2::new(-r.y, r.x)
}

/// The rotation by `angle` [rad].
#[inline(always)]
pub(crate) fn rotation<T: Real>(angle: T) -> Matrix2<T> {
    let (sin, cos) = angle.sin_cos();
    Matrix2::new(cos, -sin, sin, cos)
}

/// m v. With nalgebra's product, lightly optimised builds call functions in the innermost loop; the
/// bits are the same.
#[inline(always)]
pub(crate) fn times<T: Real>(m: &Matrix2<T>, v: Vector2<T>) -> Vector2<T> {
    Vector2::new(
        m[(0, 0)] * v.x + m[(0, 1)] * v.y,
        m[(1, 0)] * v.x + m[(1, 1)] * v.y,
    )
}

/// mᵀ v.
#[inline(always)]
pub(crate) fn transpose_times<T: Real>(m: &Matrix2<T>, v: Vector2<T>) -> Vector2<T> {
    Vector2::new(
        m[(0, 0)] * v.x + m[(1, 0)] * v.y,
        m[(0, 1)] * v.x + m[(1, 1)] * v.y,
    )
}

/// A rigid body: its inertia, and its two joints from its centre of mass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Body<T: Scalar = f64> {
    /// Mass [kg].
    pub mass: T,
    /// Moment of inertia about the centre of mass [kg·m²].
    pub inertia: T,
    /// The joint nearer to A along the chain A–B–C–D–E, in the body's frame [m].
    pub near: Vector2<T>,
    /// The joint nearer to E, in the body's frame [m].
    pub far: Vector2<T>,
}

impl<T: Real> Body<T> {
    /// The acceleration of the point `r` per force at the point `s`, both from the centre of
    /// mass in the frame of the base: I/m + r⊥ s⊥ᵀ/J [1/kg].
    #[inline(always)]
    pub(crate) fn inverse_inertia(&self, r: Vector2<T>, s: Vector2<T>) -> Matrix2<T> {
        let (r, s) = (perp(r) / self.inertia, perp(s));
        let per_mass = T::one() / self.mass;
        Matrix2::new(
            per_mass + r.x * s.x,
            r.x * s.y,
            r.y * s.x,
            per_mass + r.y * s.y,
        )
    }

    /// The acceleration that a force [N] at `r` [m] gives.
    #[inline(always)]
    pub(crate) fn acceleration_by(&self, r: Vector2<T>, force: Vector2<T>) -> PlanarVector<T> {
        PlanarVector {
            linear: force / self.mass,
            angular: perp(r).dot(&force) / self.inertia,
        }
    }
}
