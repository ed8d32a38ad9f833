//! Vectors of the plane, with the two products that planar mechanics needs.

use crate::Scalar;
use core::ops::{Add, Mul, Neg, Sub};

/// A vector of the plane.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Vec2<S> {
    /// Component along +x.
    pub x: S,
    /// Component along +y.
    pub y: S,
}

impl<S: Scalar> Vec2<S> {
    /// The vector (x, y).
    #[inline]
    pub fn new(x: S, y: S) -> Self {
        Self { x, y }
    }

    /// The zero vector.
    #[inline]
    pub fn zero() -> Self {
        Self::new(S::ZERO, S::ZERO)
    }

    /// u(θ) = (cos θ, sin θ), θ in radians.
    #[inline]
    pub fn unit(angle: S) -> Self {
        let (sin, cos) = angle.sin_cos();
        Self::new(cos, sin)
    }

    /// a·b.
    #[inline]
    pub fn dot(self, other: Self) -> S {
        self.x * other.x + self.y * other.y
    }

    /// a×b = ax·by − ay·bx, positive where b lies to the left of a.
    #[inline]
    pub fn cross(self, other: Self) -> S {
        self.x * other.y - self.y * other.x
    }

    /// This vector turned by +90°: n(θ) = perp(u(θ)).
    #[inline]
    pub fn perp(self) -> Self {
        Self::new(-self.y, self.x)
    }

    /// The vector whose components along and to the left of the unit vector `axis` are
    /// this vector's: local coordinates of a link turned into the plane's.
    #[inline]
    pub fn rotated_to(self, axis: Self) -> Self {
        axis * self.x + axis.perp() * self.y
    }

    /// |a|².
    #[inline]
    pub fn norm_squared(self) -> S {
        self.dot(self)
    }

    /// |a|.
    #[inline]
    pub fn norm(self) -> S {
        self.norm_squared().sqrt()
    }

    /// The direction of this vector [rad], in (−π, π].
    #[inline]
    pub fn angle(self) -> S {
        self.y.atan2(self.x)
    }
}

impl<S: Scalar> Add for Vec2<S> {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        Self::new(self.x + other.x, self.y + other.y)
    }
}

impl<S: Scalar> Sub for Vec2<S> {
    type Output = Self;
    #[inline]
    fn sub(self, other: Self) -> Self {
        Self::new(self.x - other.x, self.y - other.y)
    }
}

impl<S: Scalar> Neg for Vec2<S> {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        Self::new(-self.x, -self.y)
    }
}

impl<S: Scalar> Mul<S> for Vec2<S> {
    type Output = Self;
    #[inline]
    fn mul(self, factor: S) -> Self {
        Self::new(self.x * factor, self.y * factor)
    }
}
