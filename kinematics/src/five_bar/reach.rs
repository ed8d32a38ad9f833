//! Where C can be at all: the ring each leg reaches, and the region common to both.
//!
//! Leg A–B–C reaches the annulus |l1 − l2| ≤ |rC − rA| ≤ l1 + l2, leg E–D–C likewise.
//! The area of their common part by inclusion and exclusion of circular lenses,
//! L(R1,R4) − L(r1,R4) − L(R1,r4) + L(r1,r4), and its boundary as arcs.

use super::dyad::Dyad;
use super::inverse::{refusal1, refusal4};
use super::{Geometry, PoseError, Side};
use crate::{Scalar, Vec2};
use core::f64::consts::PI;

/// An arc of a circle, counter-clockwise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arc<S> {
    /// The circle's centre [m].
    pub center: Vec2<S>,
    /// Its radius [m].
    pub radius: S,
    /// Direction of the start from the centre [rad].
    pub from: S,
    /// Direction of the end, greater than `from` [rad].
    pub to: S,
    /// Whether the region lies within the circle (an outer limit of reach) or without.
    pub outer: bool,
}

impl<S: Scalar> Geometry<S> {
    /// Whether both legs reach `c` [m]; then every working mode has a pose there, unless
    /// it is a base pivot that its leg folds onto.
    ///
    /// # Errors
    /// `Unreachable` with the leg and the side of its annulus that `c` is beyond,
    /// `NotFinite`.
    pub fn reach(&self, c: Vec2<S>) -> Result<(), PoseError> {
        let leg1 = Dyad::joint(self.leg1().close(c, Side::Left)).map_err(refusal1);
        let leg4 = Dyad::joint(self.leg4().close(c - self.e(), Side::Left)).map_err(refusal4);
        for leg in [leg1, leg4] {
            match leg {
                Ok(_) | Err(PoseError::Singular(_)) => {}
                Err(other) => return Err(other),
            }
        }
        Ok(())
    }

    /// |l1 − l2| and l1 + l2 [m].
    pub fn leg1_radii(&self) -> [S; 2] {
        [(self.l1() - self.l2()).abs(), self.l1() + self.l2()]
    }

    /// |l4 − l3| and l4 + l3 [m].
    pub fn leg4_radii(&self) -> [S; 2] {
        [(self.l4() - self.l3()).abs(), self.l4() + self.l3()]
    }

    /// The area that both legs reach [m²], above and below the base line.
    pub fn reachable_area(&self) -> S {
        let [near1, far1] = self.leg1_radii();
        let [near4, far4] = self.leg4_radii();
        let lens = |radius1, radius4| lens_area(radius1, radius4, self.base());
        lens(far1, far4) - lens(near1, far4) - lens(far1, near4) + lens(near1, near4)
    }

    /// The arcs that bound the reachable region, at most eight, in no order; those of
    /// circles without extent are left out.
    pub fn reach_boundary(&self) -> impl Iterator<Item = Arc<S>> {
        let [near1, far1] = self.leg1_radii();
        let [near4, far4] = self.leg4_radii();
        let (base, a, e) = (self.base(), Vec2::zero(), self.e());
        let pi = S::from_f64(PI);
        [
            (a, far1, true, [near4, far4]),
            (a, near1, false, [near4, far4]),
            (e, far4, true, [near1, far1]),
            (e, near4, false, [near1, far1]),
        ]
        .into_iter()
        .filter(|&(_, radius, ..)| radius > S::ZERO)
        .flat_map(move |(center, radius, outer, [near, far])| {
            // The distance from the other centre grows with the angle φ from the line to it.
            let low = angle_at_distance(radius, base, near);
            let high = angle_at_distance(radius, base, far);
            let ranges = if center == a {
                [[low, high], [-high, -low]]
            } else {
                [[pi - high, pi - low], [pi + low, pi + high]]
            };
            ranges
                .into_iter()
                .filter(|[from, to]| from < to)
                .map(move |[from, to]| Arc {
                    center,
                    radius,
                    from,
                    to,
                    outer,
                })
        })
    }
}

/// The angle φ in 0…π, from the line to a second centre `base` away, at which a circle's
/// point is `distance` from that centre: cos φ = (radius² + base² − distance²)/(2 radius base).
/// 0 or π where every point is farther or nearer.
pub(crate) fn angle_at_distance<S: Scalar>(radius: S, base: S, distance: S) -> S {
    let cos = (radius * radius + base * base - distance * distance) / (S::TWO * radius * base);
    if cos >= S::ONE {
        S::ZERO
    } else if cos <= -S::ONE {
        S::from_f64(PI)
    } else {
        (S::ONE - cos * cos).sqrt().atan2(cos)
    }
}

/// Area common to two discs of these radii, `base` apart: two circular segments
/// r² (φ − sin φ cos φ).
fn lens_area<S: Scalar>(radius1: S, radius4: S, base: S) -> S {
    if radius1 == S::ZERO || radius4 == S::ZERO {
        return S::ZERO;
    }
    let segment = |radius: S, other: S| {
        let phi = angle_at_distance(radius, base, other);
        let (sin, cos) = phi.sin_cos();
        radius * radius * (phi - sin * cos)
    };
    segment(radius1, radius4) + segment(radius4, radius1)
}
