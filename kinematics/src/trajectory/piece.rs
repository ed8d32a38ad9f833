//! What the tick follows: one shape and one cubic time law.

use super::curve::Curve;
use super::reference::Reference;
use crate::Scalar;
use nalgebra::Vector2;

/// s(t) = s₀ + ṡ₀ t + ½ s̈₀ t² + ⅙ s⃛ t³, units per second.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimeLaw<S> {
    /// s₀, ṡ₀, ½ s̈₀, ⅙ s⃛.
    coefficients: [S; 4],
}

impl<S: Scalar> TimeLaw<S> {
    /// From place, rate and acceleration at t = 0, and a constant jerk.
    #[inline]
    pub fn new(place: S, rate: S, acceleration: S, jerk: S) -> Self {
        Self {
            coefficients: [
                place,
                rate,
                acceleration * S::HALF,
                jerk * S::from_f64(1.0 / 6.0),
            ],
        }
    }

    /// s, ṡ and s̈ at time `t` [s].
    #[inline(always)]
    pub fn at(&self, t: S) -> Progress<S> {
        let [c0, c1, c2, c3] = self.coefficients;
        // Horner's scheme thrice over: s, ṡ and ½ s̈.
        let (p, d) = (c3 * t + c2, c3);
        let (p, d, e) = (p * t + c1, d * t + p, c3);
        let (p, d, e) = (p * t + c0, d * t + p, e * t + d);
        Progress {
            place: p,
            rate: d,
            acceleration: e + e,
        }
    }
}

/// How far along its shape a piece is, and how fast; units of the shape's length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress<S> {
    /// s.
    pub place: S,
    /// ṡ [1/s].
    pub rate: S,
    /// s̈ [1/s²].
    pub acceleration: S,
}

impl<S: Scalar> Progress<S> {
    /// The same place passed with the piece's clock running at `rate` σ and changing by
    /// `slope` σ̇ [1/s]: at σ ṡ and σ² s̈ + σ̇ ṡ.
    #[inline(always)]
    #[must_use]
    pub fn clocked(self, rate: S, slope: S) -> Self {
        Self {
            place: self.place,
            rate: self.rate * rate,
            acceleration: self.acceleration * (rate * rate) + self.rate * slope,
        }
    }
}

/// What is moved along.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Shape<S> {
    /// The tool along a curve, s in metres.
    Path(Curve<S>),
    /// The tool at rest.
    Rest(Vector2<S>),
    /// The joints from `from` [rad] along `direction`, s in radians of the joint that
    /// turns further.
    Joint { from: [S; 2], direction: [S; 2] },
}

/// A time-bounded piece of motion, continuous with its neighbours in position, velocity
/// and acceleration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece<S> {
    pub(super) shape: Shape<S>,
    pub(super) law: TimeLaw<S>,
    pub(super) duration: S,
    pub(super) tag: u32,
}

impl<S: Scalar> Piece<S> {
    /// The tool at rest at `position` [m] for `duration` [s].
    pub fn rest(position: Vector2<S>, duration: S, tag: u32) -> Self {
        Self {
            shape: Shape::Rest(position),
            law: TimeLaw::new(S::ZERO, S::ZERO, S::ZERO, S::ZERO),
            duration,
            tag,
        }
    }

    /// How long it lasts [s]; may be shorter than a tick.
    #[inline]
    pub fn duration(&self) -> S {
        self.duration
    }

    /// The name that the mover gave the move this piece belongs to. A rounded corner
    /// carries the name of the move that it leads into.
    #[inline]
    pub fn tag(&self) -> u32 {
        self.tag
    }

    /// The curve that it moves the tool along, if it does.
    pub fn curve(&self) -> Option<&Curve<S>> {
        match &self.shape {
            Shape::Path(curve) => Some(curve),
            Shape::Rest(_) | Shape::Joint { .. } => None,
        }
    }

    /// s, ṡ and s̈ at time `t` [s] into the piece, 0 ≤ t ≤ duration.
    #[inline(always)]
    pub fn progress(&self, t: S) -> Progress<S> {
        self.law.at(t)
    }

    /// The reference at time `t` [s] into the piece, 0 ≤ t ≤ duration.
    #[inline(always)]
    pub fn evaluate(&self, t: S) -> Reference<S> {
        self.reference(self.progress(t))
    }

    /// The reference so far along the piece, and so fast.
    #[inline(always)]
    pub fn reference(&self, progress: Progress<S>) -> Reference<S> {
        let Progress {
            place,
            rate,
            acceleration,
        } = progress;
        match &self.shape {
            Shape::Path(curve) => {
                let [position, velocity, acceleration] = curve.motion(place, rate, acceleration);
                Reference::Tool {
                    position,
                    velocity,
                    acceleration,
                }
            }
            Shape::Rest(position) => Reference::Tool {
                position: *position,
                velocity: Vector2::zeros(),
                acceleration: Vector2::zeros(),
            },
            Shape::Joint { from, direction } => {
                let [from1, from4] = *from;
                let [d1, d4] = *direction;
                Reference::Joint {
                    angles: [from1 + d1 * place, from4 + d4 * place],
                    rates: [d1 * rate, d4 * rate],
                    accelerations: [d1 * acceleration, d4 * acceleration],
                }
            }
        }
    }
}
