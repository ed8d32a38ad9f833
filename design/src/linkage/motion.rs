//! Positions with their first two time derivatives: of a coordinate, a point, a link.

use fivebar_kinematics::{Scalar, Vec2};

/// An angle or a displacement with its rate and acceleration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coordinate<S> {
    /// The angle [rad] or displacement [m].
    pub value: S,
    /// Its rate [rad/s or m/s].
    pub rate: S,
    /// Its acceleration [rad/s² or m/s²].
    pub acceleration: S,
}

/// A point with its velocity and acceleration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointMotion<S> {
    /// Position [m].
    pub position: Vec2<S>,
    /// Velocity [m/s].
    pub velocity: Vec2<S>,
    /// Acceleration [m/s²].
    pub acceleration: Vec2<S>,
}

impl<S: Scalar> PointMotion<S> {
    /// A point at rest.
    pub fn fixed(position: Vec2<S>) -> Self {
        Self {
            position,
            velocity: Vec2::zero(),
            acceleration: Vec2::zero(),
        }
    }

    /// The same motion, `by` [m] away.
    #[inline]
    pub(super) fn moved(&self, by: Vec2<S>) -> Self {
        Self {
            position: self.position + by,
            ..*self
        }
    }
}

/// A rigid link: where its frame is, and how it moves.
///
/// A guide is described alike: a link whose frame lies on the guide, its axis along it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinkMotion<S> {
    /// The origin of the link's frame.
    pub origin: PointMotion<S>,
    /// u, the x axis of the link's frame, a unit vector.
    pub axis: Vec2<S>,
    /// ω, angular velocity [rad/s].
    pub omega: S,
    /// α, angular acceleration [rad/s²].
    pub alpha: S,
}

impl<S: Scalar> LinkMotion<S> {
    /// The frame of the plane, at rest.
    pub fn ground() -> Self {
        Self {
            origin: PointMotion::fixed(Vec2::zero()),
            axis: Vec2::new(S::ONE, S::ZERO),
            omega: S::ZERO,
            alpha: S::ZERO,
        }
    }

    /// The motion of the link's point that is at `position` [m] now:
    /// v = v₀ + ω r⊥, a = a₀ + α r⊥ − ω² r.
    #[inline]
    pub fn point_at(&self, position: Vec2<S>) -> PointMotion<S> {
        let r = position - self.origin.position;
        PointMotion {
            position,
            velocity: self.origin.velocity + r.perp() * self.omega,
            acceleration: self.origin.acceleration + r.perp() * self.alpha
                - r * (self.omega * self.omega),
        }
    }

    /// The motion of the link's point with coordinates `local` [m] in its frame.
    #[inline]
    pub fn local_point(&self, local: Vec2<S>) -> PointMotion<S> {
        self.point_at(self.origin.position + local.rotated_to(self.axis))
    }

    /// This link as a guide through `point`, along `direction` (a unit vector in the
    /// link's frame).
    #[inline]
    pub fn guide(&self, point: &PointMotion<S>, direction: Vec2<S>) -> Self {
        Self {
            origin: *point,
            axis: direction.rotated_to(self.axis),
            ..*self
        }
    }

    /// A slider on this guide, displaced by `along` from the guide's origin:
    /// v = v_G + ṡ u, a = a_G + 2 ω ṡ n + s̈ u, G being the guide's point now there.
    #[inline]
    pub fn slider_at(&self, along: &Coordinate<S>) -> Self {
        let here = self.point_at(self.origin.position + self.axis * along.value);
        self.with_origin(self.slider_motion(&here, along))
    }

    /// The motion of what slides along this guide with `slide`'s rates, where the guide's
    /// own point moves as `here`.
    #[inline]
    pub(super) fn slider_motion(
        &self,
        here: &PointMotion<S>,
        slide: &Coordinate<S>,
    ) -> PointMotion<S> {
        let coriolis = self.axis.perp() * (S::TWO * self.omega * slide.rate);
        PointMotion {
            position: here.position,
            velocity: here.velocity + self.axis * slide.rate,
            acceleration: here.acceleration + coriolis + self.axis * slide.acceleration,
        }
    }

    /// The same motion, `by` [m] away.
    #[inline]
    pub(super) fn moved(&self, by: Vec2<S>) -> Self {
        self.with_origin(self.origin.moved(by))
    }

    /// A link that keeps this one's direction, its origin moving as `origin`.
    #[inline]
    pub(super) fn with_origin(&self, origin: PointMotion<S>) -> Self {
        Self { origin, ..*self }
    }
}
