//! Rigid bodies in the plane: three numbers for a body's position, velocity or acceleration.

use nalgebra::{Matrix2, Vector2};
use std::ops::{Add, Mul};

/// Position of a body's centre of mass [m] and the body's angle [rad], or a time derivative
/// of both.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanarVector {
    /// The linear part, of the centre of mass.
    pub linear: Vector2<f64>,
    /// The angular part, counter-clockwise.
    pub angular: f64,
}

impl PlanarVector {
    /// Zero.
    pub const ZERO: Self = Self {
        linear: Vector2::new(0.0, 0.0),
        angular: 0.0,
    };
}

impl Add for PlanarVector {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self {
            linear: self.linear + other.linear,
            angular: self.angular + other.angular,
        }
    }
}

impl Mul<f64> for PlanarVector {
    type Output = Self;
    #[inline(always)]
    fn mul(self, factor: f64) -> Self {
        Self {
            linear: self.linear * factor,
            angular: self.angular * factor,
        }
    }
}

/// The vector rotated by +90°.
#[inline(always)]
pub(crate) fn perp(r: Vector2<f64>) -> Vector2<f64> {
    Vector2::new(-r.y, r.x)
}

/// The rotation by `angle` [rad]. libm gives the same bits on every platform, so that a
/// seed gives the same run everywhere.
#[inline(always)]
pub(crate) fn rotation(angle: f64) -> Matrix2<f64> {
    let (sin, cos) = libm::sincos(angle);
    Matrix2::new(cos, -sin, sin, cos)
}

/// m v. With nalgebra's product, lightly optimised builds call functions in the innermost loop; the
/// bits are the same.
#[inline(always)]
pub(crate) fn times(m: &Matrix2<f64>, v: Vector2<f64>) -> Vector2<f64> {
    Vector2::new(
        m[(0, 0)] * v.x + m[(0, 1)] * v.y,
        m[(1, 0)] * v.x + m[(1, 1)] * v.y,
    )
}

/// mᵀ v.
#[inline(always)]
pub(crate) fn transpose_times(m: &Matrix2<f64>, v: Vector2<f64>) -> Vector2<f64> {
    Vector2::new(
        m[(0, 0)] * v.x + m[(1, 0)] * v.y,
        m[(0, 1)] * v.x + m[(1, 1)] * v.y,
    )
}

/// A rigid body: its inertia, and its two joints from its centre of mass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Body {
    /// Mass [kg].
    pub mass: f64,
    /// Moment of inertia about the centre of mass [kg·m²].
    pub inertia: f64,
    /// The joint nearer to A along the chain A–B–C–D–E, in the body's frame [m].
    pub near: Vector2<f64>,
    /// The joint nearer to E, in the body's frame [m].
    pub far: Vector2<f64>,
}

impl Body {
    /// The acceleration of the point `r` per force at the point `s`, both from the centre of
    /// mass in the frame of the base: I/m + r⊥ s⊥ᵀ/J [1/kg].
    #[inline(always)]
    pub(crate) fn inverse_inertia(&self, r: Vector2<f64>, s: Vector2<f64>) -> Matrix2<f64> {
        let (r, s) = (perp(r) / self.inertia, perp(s));
        let per_mass = 1.0 / self.mass;
        Matrix2::new(
            per_mass + r.x * s.x,
            r.x * s.y,
            r.y * s.x,
            per_mass + r.y * s.y,
        )
    }

    /// The acceleration that a force [N] at `r` [m] gives.
    #[inline(always)]
    pub(crate) fn acceleration_by(&self, r: Vector2<f64>, force: Vector2<f64>) -> PlanarVector {
        PlanarVector {
            linear: force / self.mass,
            angular: perp(r).dot(&force) / self.inertia,
        }
    }
}
