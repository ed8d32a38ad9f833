//! The three shapes a path is made of, each by its length s from its start.
//!
//! | shape | r(s) | r′(s) | r″(s) |
//! |---|---|---|---|
//! | line | r₀ + s t | t | 0 |
//! | arc, curvature κ | r₀ + (2/κ) sin(κs/2) · t(κs/2) | t(κs) | κ t⊥(κs) |
//! | blend | a quintic in s/ℓ | its derivative, \|r′\| ≤ 1 | its second derivative |
//!
//! t(φ) is the start's tangent t turned by φ. The chord form of the arc is
//! accurate also for flat arcs, where the coordinates of a distant centre would lose digits. For a blend
//! s is the length of the corner it replaces, so its own length is a little shorter.

use crate::{PlanarVector, Scalar};
use nalgebra::Vector2;

/// Position and its first two derivatives by path length.
///
/// ```
/// use fivebar_kinematics::nalgebra::Vector2;
/// use fivebar_kinematics::trajectory::{PathSegment, Sense};
///
/// // A quarter of a circle of 0.1 m about the origin.
/// let (from, to) = (Vector2::new(0.1, 0.0), Vector2::new(0.0, 0.1));
/// let arc = PathSegment::arc(from, to, Vector2::zeros(), Sense::CounterClockwise, 1e-6)?;
/// let start = arc.at(0.0);
/// assert!((start.tangent - Vector2::new(0.0, 1.0)).norm() < 1e-15);
/// // The curvature points to the centre, 1/(0.1 m) long.
/// assert!((start.curvature - Vector2::new(-10.0, 0.0)).norm() < 1e-13);
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurvePoint<S> {
    /// r [m].
    pub position: Vector2<S>,
    /// r′ [1]: the tangent, a unit vector on lines and arcs.
    pub tangent: Vector2<S>,
    /// r″ [1/m]: on lines and arcs, the curvature towards the centre.
    pub curvature: Vector2<S>,
}

/// A shape by its length.
///
/// ```
/// use fivebar_kinematics::nalgebra::Vector2;
/// use fivebar_kinematics::trajectory::Curve;
///
/// let (start, tangent) = (Vector2::new(0.1, 0.0), Vector2::new(0.0, 1.0));
/// // Turning left with a radius of 0.1 m, half a circle is π · 0.1 m long.
/// let arc = Curve::Arc { start, tangent, curvature: 10.0 };
/// let end = arc.at(core::f64::consts::PI * 0.1).position;
/// assert!((end - Vector2::new(-0.1, 0.0)).norm() < 1e-15);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Curve<S> {
    /// Straight.
    Line {
        /// r₀ [m].
        start: Vector2<S>,
        /// t, a unit vector.
        tangent: Vector2<S>,
    },
    /// Circular.
    Arc {
        /// r₀ [m].
        start: Vector2<S>,
        /// t at the start, a unit vector.
        tangent: Vector2<S>,
        /// κ [1/m], positive where the arc turns left.
        curvature: S,
    },
    /// A rounded corner, r = Σ cₖ (s/ℓ)ᵏ.
    Blend {
        /// c₀ … c₅ [m].
        coefficients: [Vector2<S>; 6],
        /// 1/ℓ [1/m].
        inverse_length: S,
    },
}

impl<S: Scalar> Curve<S> {
    /// Position, tangent and curvature at length `s` [m] from the start.
    // Large, and called in many places: not inlined, to save flash.
    #[inline(never)]
    pub fn at(&self, s: S) -> CurvePoint<S> {
        let [position, tangent, curvature] = self.motion(s, S::ONE, S::ZERO);
        CurvePoint {
            position,
            tangent,
            curvature,
        }
    }

    /// Position, velocity and acceleration at s, moving with ṡ [m/s] and s̈ [m/s²]:
    /// r, r′ ṡ and r″ ṡ² + r′ s̈.
    #[inline(always)]
    pub(super) fn motion(&self, s: S, s_dot: S, s_ddot: S) -> [Vector2<S>; 3] {
        match *self {
            Self::Line { start, tangent } => {
                [start + tangent * s, tangent * s_dot, tangent * s_ddot]
            }
            Self::Arc {
                start,
                tangent,
                curvature,
            } => {
                let (sin, cos) = (curvature * s * S::HALF).sin_cos();
                let chord = tangent * cos + tangent.perpendicular() * sin;
                // cos 2φ = 1 − 2 sin²φ, sin 2φ = 2 sin φ cos φ.
                let direction = chord * (cos + cos) - tangent;
                [
                    start + chord * (S::TWO * sin / curvature),
                    direction * s_dot,
                    direction.perpendicular() * (curvature * (s_dot * s_dot)) + direction * s_ddot,
                ]
            }
            Self::Blend {
                coefficients: [c0, c1, c2, c3, c4, c5],
                inverse_length,
            } => {
                let u = s * inverse_length;
                // Horner's scheme thrice over: r, dr/du and ½ d²r/du² in twelve steps.
                let (p, d) = (c5 * u + c4, c5);
                let (p, d, e) = (p * u + c3, d * u + p, c5);
                let (p, d, e) = (p * u + c2, d * u + p, e * u + d);
                let (p, d, e) = (p * u + c1, d * u + p, e * u + d);
                let (p, d, e) = (p * u + c0, d * u + p, e * u + d);
                // u̇ and ü.
                let (s_dot, s_ddot) = (s_dot * inverse_length, s_ddot * inverse_length);
                [p, d * s_dot, e * (S::TWO * s_dot * s_dot) + d * s_ddot]
            }
        }
    }

    /// From the start to the point at length `s` [m].
    pub(super) fn displacement(&self, s: S) -> Vector2<S> {
        match *self {
            Self::Line { tangent, .. } => tangent * s,
            Self::Arc {
                tangent, curvature, ..
            } => {
                Self::Arc {
                    start: Vector2::zeros(),
                    tangent,
                    curvature,
                }
                .at(s)
                .position
            }
            Self::Blend { coefficients, .. } => self.at(s).position - coefficients[0],
        }
    }

    /// The same curve started `s` further on.
    pub(super) fn advanced(self, s: S) -> Self {
        let CurvePoint {
            position: start,
            tangent,
            ..
        } = self.at(s);
        match self {
            Self::Line { .. } => Self::Line { start, tangent },
            Self::Arc { curvature, .. } => Self::Arc {
                start,
                tangent,
                curvature,
            },
            Self::Blend { .. } => self,
        }
    }
}
