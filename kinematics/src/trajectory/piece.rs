//! What the tick follows: one shape and one cubic time law.

use super::curve::Curve;
use super::reference::Reference;
use crate::{Scalar, Vec2};

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
    pub fn at(&self, t: S) -> (S, S, S) {
        let [c0, c1, c2, c3] = self.coefficients;
        let c3t = c3 * t;
        let two_c2 = c2 + c2;
        let three_c3t = c3t + c3t + c3t;
        (
            c0 + (c1 + (c2 + c3t) * t) * t,
            c1 + (two_c2 + three_c3t) * t,
            two_c2 + three_c3t + three_c3t,
        )
    }
}

/// What is moved along.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Shape<S> {
    /// The tool along a curve, s in metres.
    Path(Curve<S>),
    /// The tool at rest.
    Rest(Vec2<S>),
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

    /// The reference at time `t` [s] into the piece, 0 ≤ t ≤ duration.
    #[inline(always)]
    pub fn evaluate(&self, t: S) -> Reference<S> {
        let (s, rate, acceleration) = self.law.at(t);
        match &self.shape {
            Shape::Path(curve) => curve.follow(s, rate, acceleration),
            Shape::Rest(position) => Reference::Tool {
                position: *position,
                velocity: Vec2::zero(),
                acceleration: Vec2::zero(),
            },
            Shape::Joint { from, direction } => {
                let [from1, from4] = *from;
                let [d1, d4] = *direction;
                Reference::Joint {
                    angles: [from1 + d1 * s, from4 + d4 * s],
                    rates: [d1 * rate, d4 * rate],
                    accelerations: [d1 * acceleration, d4 * acceleration],
                }
            }
        }
    }
}
