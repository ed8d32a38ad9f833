//! A path segment: a curve and its length.

use super::curve::{Curve, CurvePoint};
use crate::{PlanarVector, Scalar};
use core::fmt;
use nalgebra::Vector2;

/// A line, an arc or a blend of a given length.
///
/// ```
/// use fivebar_kinematics::nalgebra::Vector2;
/// use fivebar_kinematics::trajectory::PathSegment;
///
/// let line = PathSegment::line(Vector2::new(0.01_f64, 0.18), Vector2::new(0.04, 0.22))?; // m
/// assert!((line.length() - 0.05).abs() < 1e-15);
/// assert!((line.at(0.025).position - Vector2::new(0.025, 0.20)).norm() < 1e-15);
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathSegment<S> {
    curve: Curve<S>,
    length: S,
}

/// Why a path segment cannot be made.
///
/// ```
/// use fivebar_kinematics::nalgebra::Vector2;
/// use fivebar_kinematics::trajectory::{PathSegment, PathSegmentError, Sense};
///
/// let (from, to) = (Vector2::new(0.1, 0.0), Vector2::new(0.0, 0.1));
/// assert_eq!(PathSegment::line(from, from), Err(PathSegmentError::ZeroLength));
/// // 0.1 m and 0.09 m from the centre: more than the tolerance of 0.01 mm apart.
/// let centre = Vector2::new(0.0, 0.01);
/// let arc = PathSegment::arc(from, to, centre, Sense::Clockwise, 1e-5);
/// assert_eq!(arc, Err(PathSegmentError::RadiusMismatch));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum PathSegmentError {
    /// A number is infinite or not a number.
    NotFinite,
    /// The end is the start, so there is no direction. Such a segment can be skipped.
    ZeroLength,
    /// The start lies on the arc's centre.
    ZeroRadius,
    /// Start and end are not equally far from the centre.
    RadiusMismatch,
}

impl fmt::Display for PathSegmentError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NotFinite => "a number given is infinite or not a number",
            Self::ZeroLength => "the end is the start",
            Self::ZeroRadius => "the arc starts on its centre",
            Self::RadiusMismatch => "the arc's start and end are not equally far from its centre",
        })
    }
}

impl core::error::Error for PathSegmentError {}

/// Which way an arc turns.
///
/// ```
/// use fivebar_kinematics::nalgebra::Vector2;
/// use fivebar_kinematics::trajectory::{PathSegment, Sense};
///
/// let (from, to) = (Vector2::new(0.1, 0.0), Vector2::new(0.0, 0.1));
/// let length = |sense| PathSegment::arc(from, to, Vector2::zeros(), sense, 1e-6).map(|arc| arc.length());
/// // A quarter of the circle one way, three quarters the other way.
/// assert!((length(Sense::Clockwise)? / length(Sense::CounterClockwise)? - 3.0_f64).abs() < 1e-14);
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Sense {
    /// Counter-clockwise, G3.
    CounterClockwise,
    /// Clockwise, G2.
    Clockwise,
}

impl<S: Scalar> PathSegment<S> {
    /// Straight from `from` to `to` [m].
    ///
    /// # Errors
    /// `NotFinite`; `ZeroLength` where the points coincide.
    pub fn line(from: Vector2<S>, to: Vector2<S>) -> Result<Self, PathSegmentError> {
        let d = to - from;
        let length = d.length();
        if !(length.is_finite() && from.length_squared().is_finite()) {
            return Err(PathSegmentError::NotFinite);
        }
        // If |d|² is below the least normal number, d/|d| is not a unit vector.
        if length <= S::from_f64(1e-15) {
            return Err(PathSegmentError::ZeroLength);
        }
        let tangent = d * (S::ONE / length);
        Ok(Self {
            curve: Curve::Line {
                start: from,
                tangent,
            },
            length,
        })
    }

    /// Along the circle about `centre` from `from` to `to` [m]; the full circle where the
    /// two are equal.
    ///
    /// A file's centre is rounded, so the two radii may differ by up to `tolerance` [m].
    /// The centre is then moved along the chord until they agree, which keeps both ends
    /// exact; it may move no further than `tolerance` either.
    ///
    /// # Errors
    /// `NotFinite`, `ZeroRadius`, `RadiusMismatch`.
    pub fn arc(
        from: Vector2<S>,
        to: Vector2<S>,
        centre: Vector2<S>,
        sense: Sense,
        tolerance: S,
    ) -> Result<Self, PathSegmentError> {
        let sizes = from.length_squared() + to.length_squared() + centre.length_squared();
        if !(sizes.is_finite() && tolerance.is_finite()) {
            return Err(PathSegmentError::NotFinite);
        }
        let chord = to - from;
        let closed = chord.length_squared() == S::ZERO;
        let centre = if closed {
            centre
        } else {
            // Onto the chord's perpendicular bisector.
            let middle = from + chord * S::HALF;
            let share = (middle - centre).dot(&chord) / chord.length_squared();
            let shift = chord * share;
            let consistent = shift.length() <= tolerance;
            if !consistent {
                return Err(PathSegmentError::RadiusMismatch);
            }
            centre + shift
        };
        let (r0, r1) = (from - centre, to - centre);
        let radius = r0.length();
        if radius <= S::from_f64(1e-9) {
            return Err(PathSegmentError::ZeroRadius);
        }
        let turn = S::from_f64(core::f64::consts::TAU);
        let angle = r0.cross_z(r1).atan2(r0.dot(&r1));
        let (sweep, side) = match sense {
            Sense::CounterClockwise => (angle, S::ONE),
            Sense::Clockwise => (-angle, -S::ONE),
        };
        let sweep = if closed {
            turn
        } else if sweep > S::ZERO {
            sweep
        } else {
            sweep + turn
        };
        Ok(Self {
            curve: Curve::Arc {
                start: from,
                tangent: r0.perpendicular() * (side / radius),
                curvature: side / radius,
            },
            length: radius * sweep,
        })
    }

    pub(super) fn new(curve: Curve<S>, length: S) -> Self {
        Self { curve, length }
    }

    /// Length [m]; of a blend, of the corner it replaces.
    #[inline]
    pub fn length(&self) -> S {
        self.length
    }

    /// The shape.
    #[inline]
    pub fn curve(&self) -> &Curve<S> {
        &self.curve
    }

    /// Position and derivatives at length `s` [m] from the start.
    #[inline]
    pub fn at(&self, s: S) -> CurvePoint<S> {
        self.curve.at(s)
    }

    /// Where it starts [m].
    pub fn start(&self) -> Vector2<S> {
        self.at(S::ZERO).position
    }

    /// Where it ends [m].
    pub fn end(&self) -> Vector2<S> {
        self.at(self.length).position
    }

    /// From the start to the point at length `s` [m], without the rounding of places far
    /// from the origin.
    pub(super) fn displacement(&self, s: S) -> Vector2<S> {
        self.curve.displacement(s)
    }

    /// The part from `from` to `to` [m] along it.
    pub(super) fn part(&self, from: S, to: S) -> Self {
        Self {
            curve: self.curve.advanced(from),
            length: to - from,
        }
    }
}
