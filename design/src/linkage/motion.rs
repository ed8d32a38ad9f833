//! Position, velocity and acceleration of a coordinate, a point and a link.

use fivebar_kinematics::{PlanarVector, Scalar};
use nalgebra::Vector2;

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
    pub position: Vector2<S>,
    /// Velocity [m/s].
    pub velocity: Vector2<S>,
    /// Acceleration [m/s²].
    pub acceleration: Vector2<S>,
}

impl<S: Scalar> PointMotion<S> {
    /// A point at rest at `position` [m].
    pub fn fixed(position: Vector2<S>) -> Self {
        Self {
            position,
            velocity: Vector2::zeros(),
            acceleration: Vector2::zeros(),
        }
    }

    /// The same motion, shifted by `by` [m].
    #[inline]
    pub(super) fn moved(&self, by: Vector2<S>) -> Self {
        Self {
            position: self.position + by,
            ..*self
        }
    }
}

/// Position and motion of a rigid link's frame.
///
/// It also describes a guide, as a link whose frame lies on the guide with its axis along it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinkMotion<S> {
    /// The origin of the link's frame.
    pub origin: PointMotion<S>,
    /// u, the x axis of the link's frame, a unit vector.
    pub axis: Vector2<S>,
    /// ω, angular velocity [rad/s].
    pub omega: S,
    /// α, angular acceleration [rad/s²].
    pub alpha: S,
}

impl<S: Scalar> LinkMotion<S> {
    /// The frame of the plane, at rest.
    pub fn ground() -> Self {
        Self {
            origin: PointMotion::fixed(Vector2::zeros()),
            axis: Vector2::new(S::ONE, S::ZERO),
            omega: S::ZERO,
            alpha: S::ZERO,
        }
    }

    /// The motion of the link's point that is at `position` [m] at this instant:
    /// v = v₀ + ω r⊥, a = a₀ + α r⊥ − ω² r.
    #[inline]
    pub fn point_at(&self, position: Vector2<S>) -> PointMotion<S> {
        let r = position - self.origin.position;
        PointMotion {
            position,
            velocity: self.origin.velocity + r.perpendicular() * self.omega,
            acceleration: self.origin.acceleration + r.perpendicular() * self.alpha
                - r * (self.omega * self.omega),
        }
    }

    /// The motion of the link's point with coordinates `local` [m] in its frame.
    #[inline]
    pub fn local_point(&self, local: Vector2<S>) -> PointMotion<S> {
        self.point_at(self.origin.position + local.to_base_frame(self.axis))
    }

    /// The guide of this link through `point` along `direction`, a unit vector in the link's
    /// frame.
    #[inline]
    pub fn guide(&self, point: &PointMotion<S>, direction: Vector2<S>) -> Self {
        Self {
            origin: *point,
            axis: direction.to_base_frame(self.axis),
            ..*self
        }
    }

    /// A slider on this guide, displaced by `along` from the guide's origin:
    /// v = v_G + ṡ u, a = a_G + 2 ω ṡ n + s̈ u, with G the guide's point at the slider.
    #[inline]
    pub fn slider_at(&self, along: &Coordinate<S>) -> Self {
        let here = self.point_at(self.origin.position + self.axis * along.value);
        self.with_origin(self.slider_motion(&here, along))
    }

    /// The motion of a point that slides along this guide with the rates of `slide`; `here`
    /// is the motion of the guide's point at the same position.
    #[inline]
    pub(super) fn slider_motion(
        &self,
        here: &PointMotion<S>,
        slide: &Coordinate<S>,
    ) -> PointMotion<S> {
        let coriolis = self.axis.perpendicular() * (S::TWO * self.omega * slide.rate);
        PointMotion {
            position: here.position,
            velocity: here.velocity + self.axis * slide.rate,
            acceleration: here.acceleration + coriolis + self.axis * slide.acceleration,
        }
    }

    /// The same motion, shifted by `by` [m].
    #[inline]
    pub(super) fn moved(&self, by: Vector2<S>) -> Self {
        self.with_origin(self.origin.moved(by))
    }

    /// A link with the direction of this one and the given motion of its origin.
    #[inline]
    pub(super) fn with_origin(&self, origin: PointMotion<S>) -> Self {
        Self { origin, ..*self }
    }
}
