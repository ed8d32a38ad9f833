//! The region that both legs reach: its area and its boundary.
//!
//! Leg A–B–C reaches the annulus |l1 − l2| ≤ |rC − rA| ≤ l1 + l2, leg E–D–C likewise. With
//! r and R the radii of an annulus and L the area of the lens that two discs have in common,
//! the area of the intersection is L(R1,R4) − L(r1,R4) − L(R1,r4) + L(r1,r4). The boundary
//! consists of arcs.

use fivebar_kinematics::Scalar;
use fivebar_kinematics::five_bar::Geometry;
use nalgebra::Vector2;
use std::f64::consts::PI;

/// An arc of a circle, counter-clockwise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arc<S> {
    /// The circle's centre [m].
    pub centre: Vector2<S>,
    /// Its radius [m].
    pub radius: S,
    /// Direction of the start, seen from the centre [rad].
    pub from: S,
    /// Direction of the end, greater than `from` [rad].
    pub to: S,
    /// True for an outer limit of the reach (the region is within the circle), false for an
    /// inner limit (the region is outside).
    pub outer: bool,
}

/// The area that both legs reach [m²], above and below the base line.
pub fn reachable_area<S: Scalar>(geometry: &Geometry<S>) -> S {
    let [near1, far1] = geometry.leg1_radii();
    let [near4, far4] = geometry.leg4_radii();
    let lens = |radius1, radius4| lens_area(radius1, radius4, geometry.base());
    lens(far1, far4) - lens(near1, far4) - lens(far1, near4) + lens(near1, near4)
}

/// The arcs that bound the reachable region, at most eight, in no particular order. Circles
/// of radius zero give no arcs.
pub fn reach_boundary<S: Scalar>(geometry: &Geometry<S>) -> impl Iterator<Item = Arc<S>> {
    let [near1, far1] = geometry.leg1_radii();
    let [near4, far4] = geometry.leg4_radii();
    let (base, a, e) = (geometry.base(), Vector2::zeros(), geometry.e());
    let pi = S::from_f64(PI);
    [
        (a, far1, true, [near4, far4]),
        (a, near1, false, [near4, far4]),
        (e, far4, true, [near1, far1]),
        (e, near4, false, [near1, far1]),
    ]
    .into_iter()
    .filter(|&(_, radius, ..)| radius > S::ZERO)
    .flat_map(move |(centre, radius, outer, [near, far])| {
        // The distance from the other centre increases with the angle φ from the line to it.
        let low = angle_at_distance(radius, base, near);
        let high = angle_at_distance(radius, base, far);
        let ranges = if centre == a {
            [[low, high], [-high, -low]]
        } else {
            [[pi - high, pi - low], [pi + low, pi + high]]
        };
        ranges
            .into_iter()
            .filter(|[from, to]| from < to)
            .map(move |[from, to]| Arc {
                centre,
                radius,
                from,
                to,
                outer,
            })
    })
}

/// The angle φ [rad], 0…π, from the line to a second centre at the distance `base`, at which a
/// point of the circle has the given `distance` from that centre:
/// cos φ = (radius² + base² − distance²)/(2 radius base).
/// 0 if every point of the circle is farther, π if every point is nearer. Where the circles
/// coincide it is π/2, the limit for a small `base`: each of the two has half of what they share.
pub(super) fn angle_at_distance<S: Scalar>(radius: S, base: S, distance: S) -> S {
    let cos = if base == S::ZERO && radius == distance {
        S::ZERO
    } else {
        (radius * radius + base * base - distance * distance) / (S::TWO * radius * base)
    };
    if cos >= S::ONE {
        S::ZERO
    } else if cos <= -S::ONE {
        S::from_f64(PI)
    } else {
        (S::ONE - cos * cos).sqrt().atan2(cos)
    }
}

/// The area that two discs of these radii, with centres `base` apart, have in common: two
/// circular segments r² (φ − sin φ cos φ).
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
