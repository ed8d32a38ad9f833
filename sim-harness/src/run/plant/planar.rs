//! Rigid motion in the plane: three numbers a body, for its place, its speed or its
//! acceleration.

use nalgebra::{Matrix2, Vector2};
use std::ops::{Add, Mul};

/// The body's centre of mass [m] and its turn [rad], or a time derivative of both.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Planar {
    /// Of the centre of mass.
    pub linear: Vector2<f64>,
    /// About it, counter-clockwise.
    pub angular: f64,
}

impl Planar {
    /// Nothing moved.
    pub const ZERO: Self = Self {
        linear: Vector2::new(0.0, 0.0),
        angular: 0.0,
    };
}

impl Add for Planar {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        Self {
            linear: self.linear + other.linear,
            angular: self.angular + other.angular,
        }
    }
}

impl Mul<f64> for Planar {
    type Output = Self;
    #[inline]
    fn mul(self, factor: f64) -> Self {
        Self {
            linear: self.linear * factor,
            angular: self.angular * factor,
        }
    }
}

/// The vector turned by +90°.
#[inline]
pub(super) fn perp(r: Vector2<f64>) -> Vector2<f64> {
    Vector2::new(-r.y, r.x)
}

/// The rotation by `angle` [rad]. By libm, the same bits on every platform, so that a seed
/// gives one run everywhere.
#[inline]
pub(super) fn turn(angle: f64) -> Matrix2<f64> {
    let (sin, cos) = libm::sincos(angle);
    Matrix2::new(cos, -sin, sin, cos)
}

/// A rigid body: its inertia, and its two joints as seen from its centre of mass.
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
    /// How a force at `s` accelerates the point `r` (both from the centre of mass, in the
    /// plane): I/m + r⊥ s⊥ᵀ/J [1/kg].
    #[inline]
    pub(super) fn mobility(&self, r: Vector2<f64>, s: Vector2<f64>) -> Matrix2<f64> {
        let (r, s) = (perp(r) / self.inertia, perp(s));
        let per_mass = 1.0 / self.mass;
        Matrix2::new(
            per_mass + r.x * s.x,
            r.x * s.y,
            r.y * s.x,
            per_mass + r.y * s.y,
        )
    }

    /// The acceleration that a force at `r` gives.
    #[inline]
    pub(super) fn pushed(&self, r: Vector2<f64>, force: Vector2<f64>) -> Planar {
        Planar {
            linear: force / self.mass,
            angular: perp(r).dot(&force) / self.inertia,
        }
    }
}
