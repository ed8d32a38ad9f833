//! The range that the driven links turn in: a servo's travel, or hard stops.
//!
//! The link's direction n lies between the directions e and f of the limits, which are π apart at most, where e × n ≥ 0 and
//! n × f ≥ 0. The leg from E is seen in a mirror, so that both legs of a symmetric arm turn alike.

use super::condition::{Condition, ELBOWS_OUT};
use super::interval::Interval;
use fivebar_kinematics::PlanarVector;
use nalgebra::Vector2;

/// By how much the search keeps away from each limit [rad]: its samples may miss so much.
const KEPT: f64 = 1e-4;

/// Limits of θ1, and of π − θ4 [rad].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CrankRange {
    /// The directions of the limits.
    directions: [Vector2<f64>; 2],
    /// Those that the search keeps.
    kept: [Vector2<f64>; 2],
}

impl CrankRange {
    /// The narrowest range [rad]: what the search keeps away from both limits is far less.
    pub const NARROWEST: f64 = 0.01;

    /// From the least to the greatest angle [rad]; none unless the range is [`CrankRange::NARROWEST`] to π.
    pub fn new([least, greatest]: [f64; 2]) -> Option<Self> {
        let direction = |angle: f64| Vector2::new(angle.cos(), angle.sin());
        let width = greatest - least;
        (Self::NARROWEST..=core::f64::consts::PI)
            .contains(&width)
            .then(|| Self {
                directions: [least, greatest].map(direction),
                kept: [least + KEPT, greatest - KEPT].map(direction),
            })
    }

    /// The sine of the angle by which the crank nearest to a limit is within it; negative beyond.
    pub(super) fn margin(&self, at: &Condition) -> f64 {
        let [low, high] = self.kept;
        let [one, other] = at.legs.map(|leg| leg.foot - leg.far);
        let mirrored = Vector2::new(-other.x, other.y);
        let within = |crank: Vector2<f64>| {
            let crank = crank / crank.norm();
            low.cross_z(crank).min(crank.cross_z(high))
        };
        within(one).min(within(mirrored))
    }

    /// Whether the cranks of a box of places are within the limits; none where it is open. For each leg: x of C from its
    /// pivot, and c and h of `proof`; y is the same for both.
    pub(super) fn is_kept(
        &self,
        legs: [(Interval, [Interval; 2]); 2],
        y: Interval,
    ) -> Option<bool> {
        let [low, high] = self.directions.map(|e| [e.x, e.y].map(Interval::from));
        let cross = |a: [Interval; 2], b: [Interval; 2]| a[0].mul(b[1]).sub(a[1].mul(b[0]));
        let mut all = Some(true);
        for (leg, (x, [c, h])) in legs.into_iter().enumerate() {
            let (rest, aside) = (Interval::from(1.0).sub(c), h.mul(ELBOWS_OUT[leg].into()));
            // n = (1 − c) p + σ h p⊥.
            let crank = [rest.mul(x).sub(aside.mul(y)), rest.mul(y).add(aside.mul(x))];
            let crank = match leg {
                0 => crank,
                _ => [crank[0].mul(Interval::from(-1.0)), crank[1]],
            };
            for side in [cross(low, crank), cross(crank, high)] {
                match side.sign() {
                    Some(true) => (),
                    Some(false) => return Some(false),
                    None => all = None,
                }
            }
        }
        all
    }
}
