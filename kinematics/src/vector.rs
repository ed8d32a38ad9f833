//! The operations of planar mechanics that nalgebra's vectors lack.

use crate::scalar::Scalar;
use nalgebra::Vector2;

/// The plane's products, directions and lengths, for [`Vector2`] of any [`Scalar`].
///
/// Sums, multiples and `a.dot(&b)` are nalgebra's. Its `norm` and `angle` need more than
/// [`Scalar`] provides; for generic code there are [`length`](PlanarVector::length) and
/// [`polar_angle`](PlanarVector::polar_angle).
///
/// ```
/// use fivebar_kinematics::PlanarVector;
/// use nalgebra::Vector2;
///
/// let u = Vector2::<f64>::unit(0.5);
/// assert!((u.length() - 1.0).abs() < 1e-15);
/// assert!((u.polar_angle() - 0.5).abs() < 1e-15);
/// // n(θ) lies to the left of u(θ), a quarter turn ahead.
/// assert_eq!(u.cross_z(u.perpendicular()), u.length_squared());
/// ```
pub trait PlanarVector<S>: Sized {
    /// u(θ) = (cos θ, sin θ), θ in radians.
    fn unit(angle: S) -> Self;

    /// u(θ) of two angles; one call takes fewer instructions than two.
    fn units(angles: [S; 2]) -> [Self; 2];

    /// a×b = ax·by − ay·bx, the z component of the spatial cross product: positive where b
    /// lies to the left of a.
    fn cross_z(self, other: Self) -> S;

    /// This vector turned by +90°: n(θ) is perpendicular to u(θ).
    #[must_use]
    fn perpendicular(self) -> Self;

    /// This vector, given along and to the left of a link, in the frame of the base; `axis`
    /// is the link's unit vector there.
    #[must_use]
    fn to_base_frame(self, axis: Self) -> Self;

    /// |a|².
    fn length_squared(self) -> S;

    /// |a|.
    fn length(self) -> S;

    /// The direction of this vector [rad], in (−π, π].
    fn polar_angle(self) -> S;
}

impl<S: Scalar> PlanarVector<S> for Vector2<S> {
    #[inline(always)]
    fn unit(angle: S) -> Self {
        let (sin, cos) = angle.sin_cos();
        Self::new(cos, sin)
    }

    #[inline(always)]
    fn units(angles: [S; 2]) -> [Self; 2] {
        let [(sin1, cos1), (sin2, cos2)] = S::sin_cos_both(angles);
        [Self::new(cos1, sin1), Self::new(cos2, sin2)]
    }

    #[inline(always)]
    fn cross_z(self, other: Self) -> S {
        self.x * other.y - self.y * other.x
    }

    #[inline(always)]
    fn perpendicular(self) -> Self {
        Self::new(-self.y, self.x)
    }

    #[inline(always)]
    fn to_base_frame(self, axis: Self) -> Self {
        axis * self.x + axis.perpendicular() * self.y
    }

    #[inline(always)]
    fn length_squared(self) -> S {
        self.dot(&self)
    }

    #[inline(always)]
    fn length(self) -> S {
        self.length_squared().sqrt()
    }

    #[inline(always)]
    fn polar_angle(self) -> S {
        self.y.atan2(self.x)
    }
}
