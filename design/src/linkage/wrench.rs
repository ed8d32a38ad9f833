//! A wrench: a force with its moment.

use super::motion::LinkMotion;
use core::ops::{Add, Neg};
use fivebar_kinematics::{PlanarVector, Scalar};
use nalgebra::Vector2;

/// A force and its moment about the plane's origin, which includes any couple.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wrench<S> {
    /// Force [N].
    pub force: Vector2<S>,
    /// Moment about the origin of the plane [N·m].
    pub moment: S,
}

impl<S: Scalar> Wrench<S> {
    /// No force and no moment.
    #[inline]
    pub fn zero() -> Self {
        Self::couple(S::ZERO)
    }

    /// A force [N] whose line passes through `point` [m].
    #[inline]
    pub fn at(point: Vector2<S>, force: Vector2<S>) -> Self {
        Self {
            force,
            moment: point.cross_z(force),
        }
    }

    /// A couple [N·m].
    #[inline]
    pub fn couple(moment: S) -> Self {
        Self {
            force: Vector2::zeros(),
            moment,
        }
    }

    /// The moment about `point` [N·m].
    #[inline]
    pub fn moment_about(&self, point: Vector2<S>) -> S {
        self.moment - point.cross_z(self.force)
    }

    /// The power [W] of the wrench on a moving link.
    #[inline]
    pub fn power(&self, link: &LinkMotion<S>) -> S {
        self.force.dot(&link.origin.velocity) + self.moment_about(link.origin.position) * link.omega
    }

    /// The same force and couple, with the line of action shifted by `by` [m].
    #[inline]
    pub(super) fn moved(&self, by: Vector2<S>) -> Self {
        Self {
            moment: self.moment + by.cross_z(self.force),
            ..*self
        }
    }

    #[inline]
    pub(super) fn scaled(&self, factor: S) -> Self {
        Self {
            force: self.force * factor,
            moment: self.moment * factor,
        }
    }
}

impl<S: Scalar> Add for Wrench<S> {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        Self {
            force: self.force + other.force,
            moment: self.moment + other.moment,
        }
    }
}

impl<S: Scalar> Neg for Wrench<S> {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        Self {
            force: -self.force,
            moment: -self.moment,
        }
    }
}
