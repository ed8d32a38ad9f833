//! RPR: a bar that pivots at P1 and is a guide for a slider pivoting at P2.
//!
//! d = P2 − P1 = s u + e n: s = ±√(|d|² − e²), u = (s d − e d⊥)/|d|².
//!
//! ḋ = ṡ u + ω d⊥: ω = ḋ·n / s, ṡ = ḋ·u + e ω;
//! d̈ = s̈ u + 2 ω ṡ n + α d⊥ − ω² d: α = (d̈·n − 2 ω ṡ + e ω²) / s, s̈ = d̈·u + e α + s ω².

use super::{DyadError, DyadMotion, Singular, SlideBranch, Unreachable, finite, regular};
use crate::linkage::joint::Joint;
use crate::linkage::motion::{Coordinate, LinkMotion, PointMotion};
use fivebar_kinematics::{PlanarVector, Scalar};
use nalgebra::Vector2;

/// A bar that is a guide, and a slider on it.
///
/// The bar's frame starts at P1, its x axis along the guide; the slider's frame starts at
/// P2 with the same direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rpr<S> {
    /// e, the offset of the slider's pin to the left of the pivot P1 [m].
    pub offset: S,
    /// `Ahead` where the slider is ahead of the pivot along the bar's axis.
    pub branch: SlideBranch,
}

impl<S: Scalar> Rpr<S> {
    /// s [m] and u, the slider's displacement along the bar and the bar's direction.
    ///
    /// # Errors
    /// `Unreachable` where the ends are nearer than the offset, `Singular` where they
    /// coincide and the offset is zero.
    #[inline]
    pub fn position(&self, p1: Vector2<S>, p2: Vector2<S>) -> Result<(S, Vector2<S>), DyadError> {
        finite(&[p1, p2])?;
        let d = p2 - p1;
        let d_squared = d.length_squared();
        let radicand = d_squared - self.offset * self.offset;
        if radicand < S::ZERO {
            return Err(DyadError::Unreachable(Unreachable::InsideOffset));
        }
        if d_squared == S::ZERO {
            return Err(DyadError::Singular(Singular::EndsMeet));
        }
        let s = self.branch.sign(radicand.sqrt());
        Ok((
            s,
            (d * s - d.perpendicular() * self.offset) * (S::ONE / d_squared),
        ))
    }

    /// Position, velocity and acceleration from those of the ends.
    ///
    /// # Errors
    /// As [`Rpr::position`]; `Singular` where s = 0.
    #[inline]
    pub fn motion(
        &self,
        end1: &PointMotion<S>,
        end2: &PointMotion<S>,
    ) -> Result<DyadMotion<S>, DyadError> {
        let (s, u) = self.position(end1.position, end2.position)?;
        let n = u.perpendicular();
        let e = self.offset;
        let d = end2.position - end1.position;
        let sine = regular(s / d.length(), Singular::SliderAtPivot)?;

        let v = end2.velocity - end1.velocity;
        let omega = v.dot(&n) / s;
        let s_rate = v.dot(&u) + e * omega;

        let a = end2.acceleration - end1.acceleration;
        let alpha = (a.dot(&n) - S::TWO * omega * s_rate + e * omega * omega) / s;
        let slide = Coordinate {
            value: s,
            rate: s_rate,
            acceleration: a.dot(&u) + e * alpha + s * omega * omega,
        };
        let bar = LinkMotion {
            origin: *end1,
            axis: u,
            omega,
            alpha,
        };
        Ok(DyadMotion {
            links: [bar, bar.with_origin(*end2)],
            inner_point: *end2,
            slides: [Some(slide), None],
            joints: [
                Joint::Revolute { at: end1.position },
                Joint::Prismatic {
                    at: end2.position,
                    axis: u,
                },
                Joint::Revolute { at: end2.position },
            ],
            sine,
        })
    }
}
